#!/usr/bin/env bash
# Feet that land ahead: walkers on their limit cycles against an independent program, the same bits on
# every instruction set, what is refused, what is counted; and by what robots fall.
# about: runner/run analysis/compare analysis/summary
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache

"$python" "$tests/compass_oracle.py" "$stance"
oracle=$?
((oracle <= 1)) || result 1 "the oracle ends"

# ---- what is refused, and where one may begin ------------------------------------------------------
walker=$shipped/mechanisms/compass_gait.yaml
expect "one foot cannot be ahead" 2 "$stance" check "$walker" --set 'ground.contacts=[foot1]' \
    says "ground.lands: ahead needs two contacts that may touch the ground, there is 1"
expect "nor can a ball" 2 "$stance" check "$shipped/ball_bounce.yaml" --set ground.lands=ahead
expect "swept" 2 "$stance" check "$walker" --set 'ground.contacts=[foot1]' --set ground.lands=anywhere \
    --set 'sweep.grid=[{path: ground.lands, values: [anywhere, ahead]}]'
expect "a foot behind may begin in the ground" 0 "$stance" check "$walker" --set initial.state.leg2=-0.7 --set 'sweep.grid=[{path: ground.friction, values: [1]}]'
expect "one ahead may not" 2 "$stance" check "$walker" --set initial.state.leg2=0.05 --set initial.state.leg1=-0.3 \
    --set 'sweep.grid=[{path: ground.friction, values: [1]}]' says "foot2 would start .* m inside the ground"

# ---- steps counted ---------------------------------------------------------------------------------
few=(--set 'sweep.grid[0].count=5' --set 'sweep.grid[1].count=5' --set stop.time=8)
expect "walkers" 0 "$stance" run "$walker" "${few[@]}" -o walkers.h5
holds "those that do not fall have walked" <<END
f = h5py.File("walkers.h5")
steps, outcome = f["footfalls"][...], f["outcome"][...]
assert (steps[outcome == 4] >= 10).any() and (steps[outcome == 2] < 10).all(), (steps, outcome)
assert f["max_penetration"][...].max() < 1e-9
END
expect "the one on the cycle, feet landing anywhere" 0 "$stance" run "$walker" --only 4009 --set ground.lands=anywhere -o scuffs.h5
holds "it scuffs and falls" "assert h5py.File('scuffs.h5')['outcome'][...].ravel()[0] == 2"

# ---- by what robots fall ---------------------------------------------------------------------------
cat >falls.yaml <<END
stance: 1
scene: mechanism
robot:
  bodies:
    post: {joint: free, mass: 2, inertia: 0.1, centre: [0, 0.5], turn: 1}
  contacts:
    foot: {body: post, at: [0, 0]}
  points:
    top: {body: post, at: [0, 1], lowest: 0.8}
    end: {body: post, at: [0, 1.2], lowest: 0}
initial: {state: {post: 0.1}, support: [foot]}
method: {name: midpoint, step: 0.001}
stop: {time: 5}
sweep: {grid: [{path: robot.points.top.lowest, values: [0.8, -1]}, {path: robot.bodies.post.turn, values: [1, 2]}]}
END
expect "what falls by a point, by a body, by another point" 0 "$stance" run falls.yaml -o falls.h5
holds "... the file names it" <<END
cause = h5py.File("falls.h5")["fall_cause"]
words = [w.decode() if isinstance(w, bytes) else w for w in cause.attrs["flag_meanings"].split()]
assert words == ["none", "top", "end", "post"], words
assert [words[k] for k in cause[...].ravel()] == ["top", "top", "post", "end"], cause[...]
END
expect "... the summary counts it" 0 "$stance" summary falls.h5 \
    tells "fell by  *2  *50.000 %  *top" "fell by  *1  *25.000 %  *post"
expect "... as JSON" 0 "$stance" summary --json falls.h5 \
    holds 'assert said()["fall_causes"] == {"top": 2, "end": 1, "post": 1}'
expect "the biped falls" 0 "$stance" run "$shipped/balance_falls.yaml" -o biped-falls.h5
expect "... and on what" 0 "$stance" summary biped-falls.h5 says "fell by  *trunk"

# ---- the same bits ---------------------------------------------------------------------------------
# Bipeds that stumble with all methods, and walkers with kernels that are compiled for them.
cat >biped.yaml <<END
stance: 1
scene: biped
ground: {lands: ahead}
initial: {state: {z: 1.09, q1: 0.3, q2: -0.3, vx: 1}}
controller: {kind: hold, kp: 50, kd: 2}
method: {name: implicit, step: 0.002}
stop: {time: 2, settle: off}
sweep:
  grid:
    - {path: method.name, values: [implicit, midpoint, capturing, lagrange]}
    - {path: initial.state.vq1, from: -3, to: 3, count: 9}
    - {path: initial.state.vx, from: -1, to: 3, count: 9}
END
isas=$("$stance" --version | sed -n "s/^instruction sets \(.*\); in use.*/\1/p" | tr -d ,)
for isa in $isas; do
    STANCE_ISA=$isa expect "bipeds, $isa" 0 "$stance" run biped.yaml -o "biped-$isa.h5" --quiet
    [ -e biped.h5 ] || cp "biped-$isa.h5" biped.h5
    expect "... the same bits" 0 "$stance" compare biped.h5 "biped-$isa.h5"
    STANCE_ISA=$isa expect "walkers, $isa" 0 "$stance" run "$walker" "${few[@]}" --set stop.time=2 -o "walkers-$isa.h5" --quiet
    [ -e walker.h5 ] || cp "walkers-$isa.h5" walker.h5
    expect "... the same bits" 0 "$stance" compare walker.h5 "walkers-$isa.h5"
done
exit $((failed > 0 || oracle > 0))
