#!/usr/bin/env bash
# What answers mean outside: missing ones and true zeros in other readers and in files of earlier
# versions, recoveries that are none, energy that drifts, axes whose points are one.
# about: runner/run analysis/basin analysis/compare analysis/summary
. "$(dirname "$0")/scratch.sh"
looks() { # name, file
    "$python" "$tests/open_results.py" answers "$2" >log 2>&1
    result $? "$1"
}

# ---- counts that there are none of -------------------------------------------------------------
{
    balance 0.001 0
    echo "stop: {time: 1}
sweep:
  grid:
    - {path: initial.equilibrium.theta, values: [-0.41, 1.4]}
    - {path: initial.offset.theta, from: -0.12, to: 0.06, count: 17}
    - {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 17}
  refine: {start: 4}"
} >map.yaml
expect "a refined map" 0 "$stance" run map.yaml -o map.h5 --quiet
looks "all readers see its zeros, and what is missing" map.h5
cp map.h5 old.h5
"$python" "$tests/results_tools.py" age old.h5 0
"$stance" table map.h5 --answer steps --answer events --answer footfalls >new.csv 2>log
expect "our own in a file of an earlier version, too" 0 "$stance" table old.h5 --answer steps --answer events --answer footfalls
is "... the same" 'cmp log new.csv >>log 2>&1'
expect "which is the same map" 0 "$stance" compare --labels map.h5 old.h5
"$stance" summary map.h5 | grep -q 'settle.place 0.5 m' && ! "$stance" summary old.h5 | grep -q settle.place
result $? "of which none was judged by a rule that came later"
cp old.h5 half.h5
"$python" "$tests/results_tools.py" age old.h5 300
expect "of which the rest is computed now" 0 mpirun -n 2 "$stance" run map.yaml -o old.h5 --resume --quiet
tool "... as that version would have said it" same half.h5 old.h5

# ---- recoveries that are none ------------------------------------------------------------------
# What slides at 2 m/s with friction 0.5 comes 0.408 m far; the arm hangs where it is held.
cat >sled.yaml <<'END'
stance: 1
scene: mechanism
robot:
  bodies:
    sled: {joint: free, mass: 1000, inertia: 100, centre: [0, 0.1]}
    arm: {joint: hinge, parent: sled, at: [0, 0.5], mass: 1, inertia: 0.1, centre: [0, -0.3]}
  contacts:
    sole: {body: sled, from: [-0.5, 0], to: [0.5, 0]}
    keel: {body: sled, at: [0, -0.015625]}
  actuators: {shoulder: {body: arm}}
ground: {friction: 0.5, contacts: [sole]}
initial: {equilibrium: {arm: 0}, support: [sole], offset: {vx: 2}}
controller: {kind: state-feedback, design: lqr}
stop: {time: 4}
sweep:
  grid:
    - {path: stop.settle.place, values: [0.404, 0.412, none]}
    - {path: method.name, values: [implicit, midpoint, capturing, lagrange, event-driven]}
END
expect "a robot that slides away" 0 "$stance" run sled.yaml -o sled.h5 \
    says "warning: keel, which ground.contacts leaves out, begins 0.0156 m below the ground$"
holds "beyond stop.settle.place it is rested, else stabilised" <<'END'
f = h5py.File("sled.h5")
slid = f["final_state"][..., 0] - 0.5 # the heel began at 0
assert (abs(slid - 4 / (2 * 0.5 * 9.81)) < 2e-3).all(), slid
assert (f["outcome"][0] == 3).all() and (f["outcome"][1:] == 1).all(), f["outcome"][...]
assert (abs(f["through_ground"][...] - 0.015625) < 1e-9).all(), f["through_ground"][...]
END
expect "judged at the end" 0 "$stance" run sled.yaml -o end.h5 --set stop.settle=off --set 'sweep.grid=[{path: method.name, values: [implicit, capturing]}]' --set stop.time=2
expect "... the same" 0 "$stance" table end.h5 --answer outcome says "capturing,stabilised"
"$stance" summary sled.h5 --json >summary.json && "$stance" summary sled.h5 >log 2>&1
says "the summary counts them" "Through the ground, with a contact that ground.contacts leaves out: 15 cases, of which 10 stabilised"
holds "... as JSON, too" 'assert said("summary.json")["through_ground"] == {"cases": 15, "judged": 10}'

cat >dive.yaml <<'END'
stance: 1
scene: mechanism
robot:
  bodies:
    post: {joint: free, mass: 2, inertia: 0.1}
    vane: {joint: hinge, parent: post, mass: 0.5, inertia: 0.02, centre: [0.125, 0], damping: 0.25}
  contacts:
    low: {body: post, at: [0, -0.5]}
    high: {body: post, at: [0, 5]}
ground: {contacts: [high]}
initial: {state: {z: 1, post: 0.3, vvane: 3}}
method: {step: 0.001}
stop: {time: 0.5}
sweep: {grid: [{path: method.name, values: [capturing, lagrange, event-driven, midpoint, implicit]}]}
record: {every: 0.001, cases: all}
END
expect "a point that dives, a damped vane" 0 "$stance" run dive.yaml -o dive.h5
holds "how deep is told; what a damper takes is no drift" <<'END'
f = h5py.File("dive.h5")
gap = f["trajectory/gap"][:, :, 0]
assert (f["through_ground"][...] == -gap.min(axis=1)).all() and (f["through_ground"][...] > 0.5).all()
drift = f["energy_drift"][...]
assert (drift[:3] < 1e-8).all() and 1e-9 < drift[3] < 1e-4 and 1e-4 < drift[4] < 0.1, drift
END

# ---- energy in free motion ---------------------------------------------------------------------
cat >ball.yaml <<'END'
stance: 1
scene: ball
ground: {friction: 0, restitution: 1}
initial: {state: {z: 1.5}}
method: {step: 0.001}
stop: {time: 0.5, settle: "off"}
sweep: {grid: [{path: method.name, values: [implicit, midpoint, capturing, lagrange, event-driven]}]}
END
expect "a ball that falls" 0 "$stance" run ball.yaml -o ball.h5 \
    says "warning: restitution 1 with implicit: .*(case 0; so it is in 2 of 5 cases)"
holds "how much implicit loses on the way is told" <<'END'
f = h5py.File("ball.h5")
drift, mass = f["energy_drift"][...], 1
lost = 500 * 0.5 * mass * (9.81 * 0.001) ** 2 # of implicit Euler, in each step
assert abs(drift[0] / lost - 1) < 1e-9 and (drift[1:] < 1e-12).all(), (drift, lost)
END
expect "an elastic ball for 100 s" 0 "$stance" run ball.yaml -o long.h5 --set stop.time=100
holds "... where a third is gone" <<'END'
f = h5py.File("long.h5")
start = 1.5 * 9.81
left = 9.81 * f["final_state"][..., 1] + 0.5 * f["final_state"][..., 3] ** 2
assert abs(start - left[0]) > 0.2 * start, left
assert f["energy_drift"][0] > 0.2 * start and f["energy_drift"][2] < 1e-9, f["energy_drift"][...]
END
expect "through an axis" 0 "$stance" check ball.yaml --set method.name=midpoint --set 'sweep.grid=[{path: ground.restitution, values: [0, 0.5, 0.995]}]'
says "... it is said, too" "warning: restitution 0.995 with midpoint: .*(case 2; so it is in 1 of 3 cases)"
expect "by another method" 0 "$stance" check ball.yaml --set method.name=capturing --set 'sweep.grid=[{path: ground.restitution, values: [0, 0.5, 1]}]'
is "... nothing is" ! grep -q warning log

# ---- axes --------------------------------------------------------------------------------------
expect "an axis that is not sorted" 0 "$stance" check ball.yaml \
    --set 'sweep.grid=[{path: ground.restitution, values: [0.5, 0.1, 0.8, 0.3]}]' says "4  0.1 ... 0.8  *(not sorted)"
expect "a run of it" 0 "$stance" run ball.yaml -o axis.h5 --set 'sweep.grid=[{path: ground.restitution, values: [0.5, 0.1, 0.8, 0.3]}]'
expect "its summary" 0 "$stance" summary axis.h5 says "0.1 ... 0.8, 4 values, not sorted"
expect "one that falls" 0 "$stance" check ball.yaml \
    --set 'sweep.grid=[{path: ground.restitution, values: [0.8, 0.5, 0.1]}]' says "3  0.8 ... 0.1 *$"

# ---- what is fixed -----------------------------------------------------------------------------
expect "a law of two laws, designed for another robot" 0 "$stance" run "$shipped/controllers/switching.yaml" --only 0 --quiet \
    -o fixed.h5 --set controller.model.hip_mass=6 --set 'controller.torque_limits=[5, none]'
expect "its summary" 0 "$stance" summary fixed.h5 \
    says "model.hip_mass 6 kg" "target.q1 0.570127 rad, target.q2 0.82 rad" "torque_limits\[0\] 5 N m"
! grep -q 'torque_limits\[1\]\|slope\|branch\|proportional\|delay' log
result $? "... and nothing that is not used, or as it is anyway"

# ---- at least ----------------------------------------------------------------------------------
sed '/refine/d; s/values: \[-0.41, 1.4\]/values: [-0.41, -0.3]/' map.yaml >full.yaml
expect "a full map" 0 "$stance" run full.yaml -o full.h5 --quiet
i=0
for within in settle_time=0.3 settle_time=0.3.. settle_time=0.2..0.4; do
    "$stance" basin full.h5 --within $within --json >within$i.json 2>>log
    i=$((i + 1))
done
holds "the basin of what settles within a time, not before it, between two" <<'END'
f = h5py.File("full.h5")
time = f["settle_time"][f["outcome"][...] == 1]
for k, (low, high) in enumerate([(0, 0.3), (0.3, 9), (0.2, 0.4)]):
    basin = said(f"within{k}.json")
    inside = sum(r["inside"] for r in basin["rows"])
    assert 0 < inside == ((low <= time) & (time <= high)).sum() < len(time), (basin["within"], inside)
    assert basin["within"] == ["settle_time <= 0.3", "settle_time >= 0.3", "0.2 <= settle_time <= 0.4"][k]
END
expect "a larger map, refined" 0 "$stance" run "$shipped/basin_one_foot.yaml" -o part.h5 --quiet \
    --set 'sweep.grid[0].count=64' --set 'sweep.grid[1].count=64' --set 'sweep.refine={start: 8}'
expect "numbers that inferred cases have not" 2 "$stance" basin part.h5 --within settle_time=0.3 \
    says '^stance basin: --within settle_time: [0-9]* cases were inferred and have no such number: it takes a map without sweep.refine$'
expect "... nor a sample" 0 "$stance" basin part.h5 --answer settle_time \
    says 'warning: [0-9]* of these cases were inferred and have no settle_time'
for wrong in settle_time=2..1 settle_time=.. settle_time=1..x; do
    expect "--within $wrong" 2 "$stance" basin full.h5 --within $wrong
done
