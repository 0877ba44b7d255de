#!/usr/bin/env bash
# `stance ranges`: what it proposes holds the domain, for scenarios with axes and for those without; where there
# is no domain it says why.
# about: runner/run analysis/basin
# shellcheck disable=SC2016,SC2034
. "$(dirname "$0")/scratch.sh"
map=$shipped/basin_one_foot.yaml

cat >own.yaml <<'YAML'
stance: 1
title: A leg and a trunk on a point foot
scene: mechanism
robot:
  bodies:
    leg:   {joint: free, mass: 5, inertia: 0.4, centre: [0, 0.5]}
    trunk: {joint: hinge, parent: leg, at: [0, 1], mass: 10, inertia: 0.6, centre: [0, 0.3]}
  contacts:
    foot: {body: leg, at: [0, 0]}
  points:
    head: {body: trunk, at: [0, 0.6], lowest: 0.8}
  actuators:
    hip: {body: trunk, limit: 60}
initial: {equilibrium: {leg: 0.1}, support: [foot], offset: {trunk: 0.01}}
controller: {kind: state-feedback, design: lqr, sample_time: 0.005}
method: {name: midpoint, step: 0.005}
stop: {time: 8}
YAML

# What is printed, put into the scenario in place of its sweep: the domain is bounded there, not empty, and the
# equilibrium is a case.
pasted() { # name, scenario
    "$stance" ranges "$2" >"$1.txt" 2>log # where a kernel is compiled, that is said
    result $? "ranges of $1"
    sed '/^sweep:/,/^seed:/d' "$2" | cat - "$1.txt" >"$1.yaml"
    expect "... are a sweep" 0 "$stance" run --quiet -o "$1.h5" "$1.yaml"
    "$stance" basin --json "$1.h5" >"$1.json"
    holds "... that holds the domain, the equilibrium and about that share" - "$1" <<'PY'
row = said(sys.argv[1] + ".json")["rows"][0]
assert row["bounded"] and not row["cut"] and row["connected"] > 0, row
f = h5py.File(sys.argv[1] + ".h5")
axes = [k for k in f if k.startswith("initial.offset.")]
assert len(axes) == 2, axes
for k in axes:
    assert numpy.abs(f[k][...]).min() < 1e-12, k
share = float(open(sys.argv[1] + ".txt").read().split("domain: about ")[1].split(" %")[0])
assert abs(share - 100 * row["share"]) < 4, (share, row["share"])
PY
}
pasted one_foot "$map"
sed '/^sweep:/,$d' "$shipped/mechanisms/cart_pole.yaml" >cart.yaml
pasted newcomer cart.yaml
# One that is too thin for a map of all of it.
expect "a thin domain" 0 "$stance" ranges own.yaml says "with too few points to show it"
"$stance" ranges own.yaml 2>ignored | cat own.yaml - >thin.yaml
expect "... and shown about the equilibrium" 0 "$stance" run --quiet -o thin.h5 thin.yaml
expect "... a part of it" 0 "$stance" basin --json thin.h5 holds 'assert said()["rows"][0]["share"] > 0.05'

"$stance" ranges --json "$map" >one.json
holds "JSON: where the domain ends along an axis, in ranges that meet the equilibrium" <<'PY'
r = said("one.json")
theta = r["axes"][0]
assert theta["paths"] == ["initial.offset.theta"] and not r["chosen"] and r["not_lost"] == 0
# along it alone: the README's extent
assert abs(theta["alone"][0] + 0.0935) < 0.004 and abs(theta["alone"][1] - 0.0195) < 0.001, theta
for k in "whole", "close":
    (low,), (high,), n = theta[k]["from"], theta[k]["to"], theta[k]["count"]
    assert low < theta["alone"][0] and high > theta["alone"][1] and n % 2 == 1, theta
    zero = -low / (high - low) * (n - 1)
    assert abs(zero - round(zero)) < 1e-9, (k, zero)
assert theta["whole"]["from"][0] < theta["reach"][0] and theta["reach"][1] < theta["whole"]["to"][0]
PY

expect "a sample's axes" 0 "$stance" ranges "$shipped/sampled.yaml" \
    says '^      - {paths: \[initial.offset.q1, initial.offset.q2\], from: \[-[0-9.]*, [0-9.]*\], to: '
expect "other axes" 0 "$stance" ranges "$shipped/sample_time_sweep.yaml" \
    says "At 1 of 3 points of the other axes the equilibrium itself is not stabilised"
if long_tests; then
    expect "another outcome, about a state" 0 "$stance" ranges "$shipped/mechanisms/compass_gait.yaml" --of undecided \
        says "path: initial.state.vleg1, from: -1.9"
fi

# ---- axes along a line of several paths ---------------------------------------------------------
sed '/^sweep:/,$d' "$map" >line.yaml
cat >>line.yaml <<'YAML'
sweep:
  grid:
    - {paths: [initial.offset.theta, initial.offset.vtheta], from: [-1.5, 5.2], to: [1.5, -5.2], count: 65}
    - {path: initial.offset.q1, from: -0.3, to: 0.3, count: 33}
YAML
expect "an oblique axis" 0 "$stance" run --quiet -o line.h5 line.yaml
expect "... is told in the summary" 0 "$stance" summary line.h5 \
    says "initial.offset.theta  -1.5 ... 1.5 rad, 65 values.*; with initial.offset.vtheta"
expect "... and by basin" 0 "$stance" basin line.h5 \
    says "distances in units of 1 rad of initial.offset.theta with initial.offset.vtheta"
expect "a start by the other path" 0 "$stance" replay line.h5 --near vtheta=2.6,q1=0 -o line.svg \
    says "initial.offset.theta = -0.75 rad"
expect "its picture" 0 "$stance" plot line.h5 --picture map is grep -q "with vtheta" line-map.svg
"$stance" basin --json line.h5 >line.json
# The same cases one by one.
expect "the same points as a list" 0 "$stance" run --quiet -o list.h5 line.yaml --set "sweep.grid[0]={paths: [initial.offset.theta, initial.offset.vtheta], values: $("$python" -c 'print([[-1.5 + i / 64 * 3.0, 5.2 + i / 64 * -10.4] for i in range(64)] + [[1.5, -5.2]])')}"
holds "... are the same cases, and the domain is whole" <<'PY'
a, b = h5py.File("line.h5"), h5py.File("list.h5")
for k in a:
    if isinstance(a[k], h5py.Dataset) and a[k].dtype.kind == "f" and k != "seconds":
        assert numpy.array_equal(a[k][...], b[k][...], equal_nan=True), k
assert (a["outcome"][...] == b["outcome"][...]).all() and a["outcome"].shape == (65, 33)
rate = a["initial.offset.vtheta"]
assert rate.shape == (65,) and numpy.allclose(rate[...], -5.2 / 1.5 * a["initial.offset.theta"][...])
row = said("line.json")["rows"][0]
assert row["bounded"] and row["connected"] > 0.1 and row["nearest_at"]["initial.offset.theta"] == 0, row
PY
expect "ranges of it" 0 "$stance" ranges line.yaml \
    says '^    - {paths: \[initial.offset.theta, initial.offset.vtheta\], from: \[-1.[0-9]*, 5.[0-9]*\], to: \[1.'
expect "a line beside the equilibrium" 0 "$stance" check line.yaml --set 'sweep.grid[0].from=[-1.5, 0]' \
    says "the line of initial.offset.theta misses the equilibrium: it has initial.offset.vtheta = -2.6 where that is 0"
expect "a first path that stays" 2 "$stance" check line.yaml --set 'sweep.grid[0].from=[1.5, 0]' \
    says "from and to are equal in the first path, whose values name the points"
expect "a logarithmic line" 0 "$stance" check line.yaml --set 'sweep.grid[0]={paths: [ground.friction, controller.torque_limit], from: [0.1, 5], to: [1, 20], count: 5, spacing: log}'
expect "... of numbers below 0" 2 "$stance" check line.yaml --set 'sweep.grid[0].spacing=log' \
    says "spacing log needs from and to above 0"

# ---- what cuts the domain -----------------------------------------------------------------------
expect "a rail that ends" 0 "$stance" ranges "$shipped/mechanisms/cart_pole.yaml" \
    says "^# These ranges cut the domain: about"
for side in -1 1; do says "... at $side.97 m" "^#   cut at initial.offset.cart = $side.9[0-9]* m: where starts cease to exist"; done
is "... which the ranges do not hold" ! grep -q "hold the domain" log
expect "a rail without ends" 0 "$stance" ranges "$shipped/mechanisms/cart_pole.yaml" --set 'robot.bodies.cart.limits=[none, none]'
says "... is followed so far" "^#   cut at initial.offset.cart = [0-9.]* m: rays were followed no further"
is "... and no further" ! grep -q "hold the domain" log
expect "JSON: what is held" 0 "$stance" ranges --json "$map" \
    holds 'assert [a["cut"] for a in said()["axes"]] == [[False, False]] * 2'

# ---- samples ------------------------------------------------------------------------------------
for sample in topple sampled; do
    expect "a sample, $sample" 0 "$stance" ranges "$shipped/$sample.yaml" says "^    method: "
    [ "$sample" != topple ] || says "... with the scale along its rays" "^    - {path: initial.offset.scale, from: 0, to: 1, count: 257}"
    "$stance" ranges "$shipped/$sample.yaml" >lines 2>ignored
    sed '/^sweep:/,/^[a-rt-z]/{/^[a-rt-z]/!d}' "$shipped/$sample.yaml" | cat - lines >pasted.yaml
    expect "... that is whole" 0 "$stance" check pasted.yaml
done

expect "nothing that stands" 2 "$stance" ranges "$shipped/ball_bounce.yaml" \
    says "initial.state itself ends as rested, so no domain of stabilised starts is about it"
expect "settle off" 2 "$stance" ranges "$shipped/drop.yaml" says 'stop.settle is "off": set it'
expect "a loop that does not hold" 2 "$stance" ranges "$map" --set controller.sample_time=0.3 \
    says "the equilibrium itself ends as fell, so no domain of stabilised starts is about it"
expect "no equilibrium" 2 "$stance" ranges own.yaml --set robot.actuators.hip.limit=1 \
    says "own.yaml:[0-9]*:[0-9]*: no equilibrium" lines 1
if long_tests; then
    expect "a start in the ground" 2 "$stance" ranges "$shipped/mechanisms/hopper.yaml" \
        says "initial.state itself is no start: sole_heel would start 0.5 m inside the ground"
fi
expect "an unknown outcome" 2 "$stance" ranges "$map" --of fel
expect "no file" 3 "$stance" ranges none.yaml
# ---- how long it takes ----------------------------------------------------------------------------
for limited in "ranges $map" "design $map" "build $map" "basin one_foot.h5" "sensitivity one_foot.h5"; do
    expect "$limited without time" 4 "$stance" $limited --time-limit 0 \
        says "^stance ${limited%% *}: stopped after 0, its time limit"
done
expect "a time that is none" 2 "$stance" ranges "$map" --time-limit soon \
    says "--time-limit takes a duration such as 90s, 55m or 1h30m, not 'soon'"
# Who waits at a terminal is told how far it is, and for how long it goes on.
holds "ranges of what takes long say how far they are" - "$map" <<'PY'
import os, pty, re, subprocess, sys
ours, theirs = pty.openpty()
command = [os.environ["STANCE"], "ranges", sys.argv[1], "--set", "method.step=2e-6", "--set", "controller.sample_time=0.01"]
said = ""
with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=theirs) as ran:
    os.close(theirs) # so that its end is one of what is read
    while not re.search(r"[0-9]+ of about [0-9]+ simulations(, about [^ ]+ (s|min|h) left)?\x1b", said):
        assert ran.poll() is None, said
        said += os.read(ours, 4000).decode()
    ran.terminate()
PY
