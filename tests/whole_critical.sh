#!/usr/bin/env bash
# Critical values: 200 whose truth is known in closed form, bracketed by runs of the program; a push that a resonance
# makes too much at some frequencies and not beyond; the same file whatever the ranks, stops and resumes; samples; what
# is printed, in all forms; and what is wrong, said in one line.
# Speaks TAP.
# about: analysis/critical runner/run runner/scenario
set -u
. "$(dirname "$0")/scratch.sh"
critical() { # file, scenario, PATH=FROM..TO, option ...: its JSON
    local file=$1 scenario=$2 of=$3
    shift 3
    timeout "$patience" "$stance" critical "$scenario" --of "$of" -o "$file.h5" --json "$@" >"$file.json" 2>log </dev/null
    local code=$?
    ((code == 0)) || { echo "exit code $code: $file" >>log; cat log >&2; }
}
printed() { # name, pattern: somewhere in what was printed
    grep -qE -- "$2" log
    result $? "$1"
}

# ---- 200 known values -----------------------------------------------------------------------------
# A block on a slope sticks while tan(slope) <= friction, against a pull that swings, and with any mass.
cat >block.yaml <<'END'
stance: 1
scene: block
robot: {mass: 1}
initial: {state: {x: 0}}
ground: {friction: 0.4}
method: {name: capturing, step: 0.01}
stop: {time: 1, settle: {rate: 0.0001, hold: 0.5}}
END
# A slab on its sole topples down a slope whose tangent is beyond the sole's half length by the height of its centre, and
# from a stroke whose turn about an edge lifts the centre over it.
cat >slab.yaml <<'END'
stance: 1
scene: mechanism
robot:
  bodies: {slab: {joint: free, mass: 2, inertia: 0.5, centre: [0, 0.5]}}
  contacts: {sole: {body: slab, from: [-0.2, 0], to: [0.2, 0]}}
  points: {centre: {body: slab, at: [0, 0.5], lowest: 0.2, impulse: [0, 0], from: 0.05}}
ground: {friction: 10}
initial: {state: {x: 0, z: 0, slab: 0}}
method: {name: capturing, step: 0.002}
stop: {time: 6, settle: {rate: 0.0001, hold: 0.5}}
END
critical friction block.yaml ground.friction=1..0 --set 'sweep={grid: [{path: robot.slope, from: 0.02, to: 0.6, count: 40}]}'
critical slope block.yaml robot.slope=0..0.7 --set 'sweep={grid: [{path: ground.friction, from: 0.02, to: 0.7, count: 40}]}'
critical pull block.yaml robot.pull=0..10 --set 'sweep={grid: [{path: ground.friction, from: 0.3, to: 0.8, count: 5},
    {path: robot.mass, values: [0.5, 0.7, 0.9, 1.1]}, {path: robot.slope, values: [0, 0.1]}]}'
critical mass block.yaml robot.mass=4..0.1 --set robot.pull=1 --log --set 'sweep={grid: [
    {path: ground.friction, from: 0.3, to: 0.8, count: 8}, {path: robot.slope, from: -0.1, to: 0.1, count: 5}]}'
critical sole slab.yaml 'robot.contacts.sole.to[0]=0.4..0.01' --set 'sweep={grid: [{paths: [ground.slope,
    initial.state.slab], from: [0.05, -0.05], to: [0.6, -0.6], count: 30}]}'
critical stroke slab.yaml 'robot.points.centre.impulse[0]=5..0.2' --outcome fell --count 513 --set 'sweep={grid: [{paths:
    ["robot.contacts.sole.to[0]", "robot.contacts.sole.from[0]"], from: [0.3, -0.3], to: [0.1, -0.1], count: 10}]}'
"$python" - >log 2>&1 <<'END'
import json
from math import atan, cos, hypot, sin, sqrt, tan

g, count = 9.81, 0
def values(name):
    for row in json.load(open(name + ".json"))["rows"]:
        yield row, row["at"]
def is_within(row, truth):
    global count
    assert row["end"] == "lost" and row["exact"], row
    low, high = sorted([row["kept"], row["lost"]])
    assert low <= truth <= high and [row["low"], row["high"]] == [row["kept"], row["lost"]], (row, truth)
    count += 1
for row, at in values("friction"):
    is_within(row, tan(at["robot.slope"]))
for row, at in values("slope"):
    is_within(row, atan(at["ground.friction"]))
for row, at in values("pull"):
    slope = at["robot.slope"]
    is_within(row, at["robot.mass"] * g * (at["ground.friction"] * cos(slope) - abs(sin(slope))))
for row, at in values("mass"):
    slope = at["robot.slope"]
    is_within(row, 1 / (g * (at["ground.friction"] * cos(slope) - abs(sin(slope)))))
for row, at in values("sole"):
    is_within(row, 0.5 * tan(at["ground.slope"]))
for row, at in values("stroke"):
    a, m, h = at["robot.contacts.sole.to[0]"], 2, 0.5
    inertia = 0.5 + m * (a * a + h * h)
    is_within(row, inertia / h * sqrt(2 * m * g * (hypot(a, h) - h) / inertia))
print(count)
assert count >= 200, count
END
result $? "brackets of 200 values with known answers hold"
