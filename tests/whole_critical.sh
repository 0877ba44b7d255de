#!/usr/bin/env bash
# Critical values: 200 whose truth is known in closed form, bracketed by runs of the program; a push that a resonance
# makes too much at some frequencies and not beyond; the same file whatever the ranks, stops and resumes; samples; what
# is printed, in all forms; and what is wrong, said in one line.
# about: analysis/critical runner/run runner/scenario
. "$(dirname "$0")/scratch.sh"
critical() { # file, scenario, PATH=FROM..TO, option ...: its JSON
    expect "$1" 0 bash -c "$stdout_alone" - "$stance" critical "$2" --of "$3" -o "$1.h5" --json "${@:4}"
    cp log "$1.json"
}
identical() { # file, file
    "$stance" compare "$1" "$2" >log 2>&1 && grep -qx identical log
    result $? "... and the same bits"
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
holds "brackets of 200 values with known answers hold" <<'END'
from math import atan, cos, hypot, sin, sqrt, tan

g, count = 9.81, 0
def values(name):
    for row in said(name + ".json")["rows"]:
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

# ---- a pocket ---------------------------------------------------------------------------------------
# A mass on a spring, swung: near its own 1.59 Hz it is lost, and from 1.78 Hz on kept again. 1.39 Hz is the number.
cat >swing.yaml <<'END'
stance: 1
title: A mass on a spring, swung
scene: mechanism
robot:
  bodies: {mass: {joint: slide, axis: [0, 1], mass: 1, inertia: 0, stiffness: 100, damping: 1, rest: 0}}
  points: {tip: {body: mass, lowest: -0.2, force: [0, 4], frequency: 1, from: 0, to: 6}}
ground: {gravity: 0}
initial: {state: {mass: 0}}
method: {name: midpoint, step: 0.002}
stop: {time: 20, settle: {rate: 0.01, hold: 0.5}}
END
hz=robot.points.tip.frequency
expect "a swing that a resonance makes too much" 0 "$stance" critical swing.yaml --of $hz=0.2..4 -o swing.h5 \
    tells '^ +1\.38[0-9]+ +1\.39[0-9]+  fell +1\.7[0-9]+ \.\.\.$' \
        'again: values beyond at which it is kept, too, which do not count' 'narrower than 0\.1188 Hz\)'
expect "in full" 0 "$stance" run swing.yaml --set "sweep={grid: [{path: $hz, from: 0.2, to: 4, count: 1025}]}" -o full.h5 --quiet
for file in swing full; do "$stance" critical $file.h5 --csv | cut -d, -f 2-4,10 >$file.csv; done
is "... it is the same" cmp -s swing.csv full.csv
# A strength that grows: at no frequency is one above a lost one kept.
critical strengths swing.yaml 'robot.points.tip.force[1]=0..10' --set "sweep={grid: [{path: $hz, from: 0.5, to: 3, count: 11}]}"
holds "strengths are a curve with its least at the resonance" <<'END'
rows = said("strengths.json")["rows"]
lost = [row["lost"] or 99 for row in rows]
assert lost.index(min(lost)) == 4 and lost[:5] == sorted(lost[:5], reverse=True) and lost[4:] == sorted(lost[4:]), lost
assert [row["end"] for row in rows].count("kept") == 6 and not any(row["islands"] for row in rows), rows
END

# ---- the same file ------------------------------------------------------------------------------------
search=("$stance" critical block.yaml --of ground.friction=1..0 --set
    'sweep={grid: [{path: robot.slope, from: 0.02, to: 0.6, count: 400}]}')
expect "one rank" 0 "${search[@]}" -o one.h5
cp log one
for n in 2 3; do
    expect "$n ranks" 0 mpirun -n $n "${search[@]}" -o ranks.h5 --force
    [ "$(grep -c '^How far' log)" = 1 ] && # what a slow run says of its progress stands before that
        [ "$(sed -n '/^How far/,$p' one)" = "$("$stance" critical ranks.h5 | sed -n '/^How far/,$p')" ]
    result $? "... the same numbers, said once"
    identical one.h5 ranks.h5
done
expect "a time that is too short" 4 "${search[@]}" -o resumed.h5 --time-limit 0.001 \
    says "^stance critical: stopped.*; go on with: .*stance critical block.yaml --of ground.friction=1..0 .* --resume$"
expect "is gone on with" 0 "${search[@]}" -o resumed.h5 --resume
identical one.h5 resumed.h5
expect "a file that is there is left alone" 3 "${search[@]}" -o one.h5
{
    cat block.yaml
    echo 'sweep: {grid: [{path: ground.friction, from: 1, to: 0, count: 1025}, {path: robot.slope, from: 0.02, to: 0.6, count: 9}],'
    echo '  refine: {along: ground.friction, start: 33, margin: 0}}'
} >own.yaml
expect "a scenario that says along which number by itself" 0 "$stance" critical own.yaml
[ -e results/own.h5 ] && [ "$(grep -c ' undecided$' log)" = 9 ]
result $? "... has its file and numbers"
expect "its axis is replaced" 0 "$stance" critical own.yaml --of ground.friction=1..0 --count 33 -o replaced.h5 \
    tells '^replaced.h5: 297 cases: .* undecided; [0-9.]* s on'

# ---- samples ----------------------------------------------------------------------------------------
# Slopes of evenly distributed angles: of all of them nine in ten hold down to tan(0.1 + 0.9 * 0.4).
sample='sweep={sample: {method: random, count: 64, vary: [{path: robot.slope, from: 0.1, to: 0.5}]}}'
for seed in $(seq 25); do
    critical "sample$seed" block.yaml ground.friction=1..0 --set "$sample" --set "seed=$seed"
done
holds "intervals of samples hold" <<'END'
from math import tan
held = 0
for seed in range(1, 26):
    study = said(f"sample{seed}.json")
    (row,) = study["rows"]
    assert study["share"] == 0.9 and study["points"] == 64 and not row["exact"], study
    assert row["high"] < row["low"] and row["lost"] < row["kept"], row
    held += row["high"] <= tan(0.46) <= row["low"]
print(held)
assert 21 <= held, held
END
cp sample1.h5 sample.h5
expect "its text" 0 "$stance" critical sample.h5 \
    tells 'at least 90 % of the 64 points' '^ +0\.[0-9]+ +0\.[0-9]+  undecided +0\.[0-9]+ \.\.\. 0\.[0-9]+ *$'
expect "of all points" 0 "$stance" critical sample.h5 --share 1 tells '^ +0\.5[0-9]+ +0\.5[0-9]+  undecided +95\.43 %$'
expect "of so many that few points tell nothing" 0 "$stance" critical sample.h5 --share 0.95 \
    tells '  - \.\.\. 0\.[0-9]+'
critical blocks block.yaml ground.friction=1..0 --set "${sample/random, count: 64/saltelli, count: 8}"
grep -q '"low": null' blocks.json && "$stance" critical blocks.h5 | grep -q 'no interval: points hang together in blocks'
result $? "points in blocks have none"

# ---- what is not known ------------------------------------------------------------------------------
expect "another outcome, another way" 0 "$stance" critical one.h5 --of robot.slope=0.6..0.02 --outcome undecided \
    tells '^How far robot.slope may go from 0.6 rad towards 0.02 rad, up to which cases end as undecided'
"$python" - >log 2>&1 <<'END'
import h5py
f = h5py.File("full.h5", "r+")
f["status"][30] = 0  # pending
f["status"][322:330] = 0
END
"$stance" critical full.h5 >log 2>&1
tells "values that are not known widen the bracket" '^ +0\.307[0-9]* +1\.3[0-9]+  fell .* some unknown$'
expect "a number that a case has beside its outcome" 0 "$stance" critical full.h5 --within end_time=10 \
    tells 'end as rested with end_time <= 10$'

# ---- pictures -----------------------------------------------------------------------------------------
drawn() { # file, what the script has
    mkdir -p scripts
    STANCE_SCRIPTS=$scratch/scripts "$stance" plot "$1" --picture critical >log 2>&1 &&
        grep -qE -- "$2" "$scratch/scripts/${1%.h5}-critical/"*
    result $? "$1 is drawn"
    head -c 8 "${1%.h5}-critical.png" | grep -q PNG
    result $? "... as a picture"
}
critical curves block.yaml ground.friction=1..0 --set "$sample" --set robot.pull=1 \
    --set 'sweep.grid=[{path: robot.mass, values: [1, 2, 3]}]'
critical plane block.yaml ground.friction=1..0 --set 'sweep={grid: [{path: robot.mass, from: 1, to: 3, count: 8},
    {path: robot.slope, from: 0, to: 0.5, count: 8}]}' --set robot.pull=1
drawn friction.h5 'Up to which ground.friction, from 1 on, cases end as rested'
drawn strengths.h5 'from 0 N on, cases end as rested'
drawn curves.h5 'band: interval \(95 %\)'
drawn plane.h5 "bar_text = 'ground.friction'"
critical rows swing.yaml "$hz=0.2..4" --set 'sweep={grid: [{path: "robot.points.tip.force[1]", from: 2, to: 6, count: 9}]}'
drawn rows.h5 'light: rested again beyond it'

# ---- what is wrong ----------------------------------------------------------------------------------
wrong() { # name, pattern, argument ...: exit code 2 and one line
    expect "$1" 2 bash -c "$stderr_alone" - "$stance" critical "${@:3}" lines 1 is grep -qE -- "$2" log is [ ! -s out ]
}
wrong "a scenario without a number" 'block.yaml does not say along which number \(sweep.refine.along\): --of PATH=FROM..TO' block.yaml
wrong "a number without a range" "of a scenario --of takes PATH=FROM..TO, .*, not 'ground.friction'" block.yaml --of ground.friction
wrong "a number that there is not" "unknown field 'ground.frction'; did you mean 'ground.friction'" block.yaml --of ground.frction=1..0
wrong "a range of nothing" "not 'ground.friction=1..1'" block.yaml --of ground.friction=1..1
wrong "an axis that a file has not" "whose values rise or fall, not 'robot.slop'" one.h5 --of robot.slop
wrong "a range beyond the file's" 'robot.slope goes from 0.02 to 0.6 in this file' one.h5 --of robot.slope=1..2
wrong "what a results file does not take" 'holds results' one.h5 --count 5
wrong "a share above 1" '--share takes' one.h5 --share 2
wrong "an axis to refine that there is not" "sweep.refine.along: no axis of numbers on the grid is robot.mass" own.yaml \
    --set sweep.refine.along=robot.mass
