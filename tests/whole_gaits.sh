#!/usr/bin/env bash
# What a newcomer types to walk: a compass down a slope, its cycle, multipliers and basin, other hips, where it flips; the
# paper's biped, its starts, pushes and a film; and what is wrong, said in one line with its place.
# about: analysis/gait analysis/summary analysis/plot runner/run
. "$(dirname "$0")/scratch.sh"
compass=$shipped/mechanisms/compass_gait.yaml
walks=$shipped/gaits/walks.yaml
exact=(--set method.name=event-driven)

has() { # NAME PATTERN COMMAND... [clause ...]: its output has the pattern, whatever its exit code
    local words=()
    before_clause "${@:3}"
    "${words[@]}" >log 2>&1 </dev/null
    tells "$1" "$2"
    clauses "${@:3}"
}

# ---- the first half hour, in the order of scenarios/gaits/README.md -------------------------------
# A compass down a slope: its cycle, how fast departures from it die, a scenario begun on it.
has "a compass has a gait" '^  period +0\.744928150? s$' "$stance" gait "$compass" "${exact[@]}" \
    tells '^  0\.5241[0-9]+  0\.12528[0-9]* \+- 0\.50896[0-9]*i '
has "that holds" 'the gait is stable' "$stance" gait "$compass"
expect "a scenario begun on it" 0 "$stance" gait "$compass" -o cycle.yaml
has "walks by itself" '1 walks' "$stance" run cycle.yaml --set stop.walks.steps=10 --set stop.time=20 -o cycle.h5
has "in steps of the cycle's length" '^  step_length +0\.75921[0-9]* m$' "$stance" summary cycle.h5
has "its cycle is where it began" '^  vleg1 +-1\.41932714' "$stance" gait cycle.yaml --settle 1 "${exact[@]}"
# From where it comes to it.
walking=(--set stop.walks.steps=10 --set stop.time=30)
has "ranges of starts that show its basin" 'cease to be walks' "$stance" ranges "$compass" "${walking[@]}"
cp log ranges
grep -qE '^# These ranges hold the domain: about [23][0-9] %' ranges && [ "$(grep -c 'path: initial.state.vleg' ranges)" = 2 ]
result $? "... both rates, of which a third walk"
has "its basin" ' [1-9][0-9]* walks' "$stance" run "$compass" "${walking[@]}" --set 'sweep.grid[0].count=17' \
    --set 'sweep.grid[1].count=17' -o basin.h5
has "is measured" '^ +1[0-9]\.[0-9]+ %' "$stance" basin basin.h5
# A hip of one's own, and a steeper slope.
has "a heavier hip walks otherwise" '^  period +0\.75644[0-9]* s$' "$stance" gait "$compass" --set robot.bodies.hip.mass=12
has "a much lighter one is reached along the way" '^ +2 +0\.61337[0-9]* .* holds$' "$stance" gait "$compass" \
    --along robot.bodies.hip.mass=10..2 --count 5
has "... which is told where the start does not walk" 'falls after 1 footfall, by waist; .*--along' "$stance" gait "$compass" \
    --set robot.bodies.hip.mass=2
points=(--set 'robot.contacts={foot1: {body: leg1, at: [0, -1]}, foot2: {body: leg2, at: [0, -1]}}' --settle 1
    --set 'initial.state={leg1: 0.2302, leg2: -0.6172, vleg1: -1.152995, vleg2: 1.0019}')
has "on point feet steps begin to alternate, by an independent program at 0.0766356315753 rad" \
    '^0\.07663563157[0-9]*,.*,flip' "$stance" gait "$compass" "${points[@]}" "${exact[@]}" --along ground.slope=0.076..0.077 \
    --count 2 --csv
has "steeper it does not hold" 'NOT stable' "$stance" gait "$compass" "${points[@]}" --set ground.slope=0.0785
# The paper's biped: its gait, its starts, its pushes, a film.
has "the paper's biped walks" '^  period +0\.66823[0-9]* s$' "$stance" gait "$walks"
has "programs get it as JSON" '"stable": true' "$stance" gait "$walks" --json
has "from one start in nine" '(3[0-9]|4[0-9]) walks' "$stance" run "$walks" --set 'sweep.grid[0].count=19' \
    --set 'sweep.grid[1].count=19' -o map.h5
expect "which is drawn" 0 "$stance" plot map.h5 --picture map
has "a basin is measured" 'Starts that end as walks' "$stance" basin map.h5
has "summaries tell of steps" '^  step_time \(s\) +0\.66' "$stance" summary map.h5 tells '^  walks +[34][0-9] '
expect "pushes at the hip" 0 "$stance" run "$shipped/gaits/walk_pushes.yaml" --set 'sweep.grid[0].count=3' \
    --set 'sweep.grid[1].count=9' -o pushes.h5
holds "... are survived best in mid-step, and better forwards" <<'END'
f = h5py.File("pushes.h5")
words = f["outcome"].attrs["flag_meanings"]
walks = (words.decode() if isinstance(words, bytes) else words).split().index("walks")
for row, (weakest, strongest) in zip(f["outcome"][...], [(0, 15), (-30, 45), (0, 15)]):
    survived = [-60 + 15 * k for k in range(9) if row[k] == walks]
    assert survived == list(range(weakest, strongest + 1, 15)), (survived, weakest, strongest)
END
for force in 0 20; do
    "$stance" run "$shipped/gaits/walk_pushes.yaml" --set 'sweep={}' --set "robot.points.waist.force=[$force, 0]" \
        --set robot.points.waist.from=0 --set stop.time=0.01 --trace --quiet -o "first$force.h5" >log 2>&1
done
holds "a law with a model feels a push from its beginning on" '
first = [h5py.File(f"first{force}.h5")["trajectory/torque"][0, 0] for force in (0, 20)]
assert abs(first[0] - first[1]).max() > 0.01, first'
expect "which is drawn, too" 0 "$stance" plot pushes.h5 --picture map
has "a film of one" 'waist.from = 0.33 s.*force\[0\] = 30 N: walks' "$stance" replay pushes.h5 --near \
    'from=0.33,force[0]=30' --set stop.time=2 -o push.gif tells 'case 15: was walks in the file, and is undecided now'
is "... that moves" '[ "$(head -c 6 push.gif)" = GIF89a ] && [ "$(wc -c <push.gif)" -gt 100000 ]'

# ---- pushes --------------------------------------------------------------------------------------
# Cases that end while they are pushed leave nothing to those that take their lanes.
pushed=("$shipped/gaits/walk_pushes.yaml" --set stop.time=0.02 --set 'sweep.grid[0].count=12'
    --set 'sweep.grid[1].count=7' --quiet --force)
"$stance" run "${pushed[@]}" -o one.h5 >log 2>&1 && mpirun -n 3 "$stance" run "${pushed[@]}" -o three.h5 >>log 2>&1
has "cases after pushed ones are what they are elsewhere" identical "$stance" compare one.h5 three.h5

# ---- costs, margins, sensitivity ---------------------------------------------------------------
has "a gait has its cost, and what its impact asks for" '^  cost of transport  0\.0612[0-9]* *$' "$stance" gait "$walks" \
    --sensitivity ground.slope=-0.001..0.001 --sensitivity controller.torque_limit=9.9..10.1
tells "... and varies on ground that is another one in each step" "^  the impact's +0\.566" \
    '^  ground.slope +-0.001 +0.001 +4\.2[0-9]*e-03 '
has "programs get that, too" '"path": "ground.slope", "from": -0.0+1[0-9]*, "to": 0.0+1[0-9]*, "period": 0.004' sh -c \
    "'$stance' gait '$walks' --json --sensitivity ground.slope=-0.001..0.001 | tr -d '\n' | tr -s ' '"
has "its phase by the clock is told" '^  controller.phase.clock=\[-0.26' "$stance" gait "$walks" --clock \
    --set controller.sample_time=0
clock=$(sed -n 's/^  controller.phase.clock=//p' log)
has "... and to follow that does not hold" '^  5\.[0-9]+  -5\.' "$stance" gait "$walks" --settle 1 \
    --set "controller.phase={clock: $clock, from: -0.25, to: 0.25}" --set controller.sample_time=0 tells 'NOT stable'
has "two steps of a gait of one are told" 'A gait of 2 steps, by capturing; it repeats after 1 already' "$stance" gait "$walks" \
    --steps 2 --set controller.sample_time=0
expect "footfalls as a table" 0 "$stance" run "$walks" --set stop.walks.steps=0 --quiet -o footfalls.h5 \
    --set 'sweep={grid: [{path: stop.footfalls, from: 1, to: 6, count: 6}]}'
holds "... of times and states, a leg ahead in turn" <<'END'
import h5py, numpy as np
f = h5py.File("footfalls.h5")
when, state = f["end_time"][...], f["final_state"][...]
assert (np.abs(np.diff(when) - 0.669) < 1e-3).all(), when
phi = state[:, 2:3] + state[:, 3:5]  # of both legs: as far ahead as behind, in turn
assert (np.abs(phi.sum(1)) < 1e-6).all() and (np.diff(np.sign(phi[:, 0])) != 0).all(), phi
END
has "what comes to a gait of one step from both of its sides is no gait of two" '^0,1' sh -c "'$stance' run '$shipped/gaits/compass_cascade.yaml' \
    --set 'sweep={}' --set ground.slope=0.075 --set 'stop.walks={steps: 16, angle: 1e-4, rate: 1e-3}' --quiet -o near.h5 &&
    '$stance' table near.h5 --answer gait_period"
cat >search.yaml <<END
$(sed '/^optimise:/,$d' "$shipped/gaits/walk_search.yaml" | sed 's/count: 256/count: 32/')
optimise:
  vary: [{path: 'controller.outputs.y1.along[0]', from: -0.4, to: 0}]
  candidates: 8
  confirm: 32
END
expect "a search of gaits" 0 "$stance" optimise search.yaml -o search.h5 --quiet
has "tells how many walk" 'share of the starts that walk' "$stance" summary search.h5 \
    tells 'first candidate +0 +[1-9][0-9.]* \('

# ---- pictures ----------------------------------------------------------------------------------
expect "two steps of the cycle, recorded" 0 "$stance" run cycle.yaml --trace --set stop.footfalls=2 -o two.h5 --quiet
expect "are drawn" 0 "$stance" plot two.h5 --format svg
expect "a gait along a number is drawn, and what it comes to" 0 "$stance" gait "$compass" "${points[@]}" \
    --along ground.slope=0.0725..0.08 --count 2 -o along.svg
has "which is a number, too" '^0\.08,.*,,,2' "$stance" gait "$compass" "${points[@]}" --along ground.slope=0.08..0.081 \
    --count 2 --settled --csv
"$stance" run "$shipped/balance_recovers.yaml" --trace --quiet -o none.h5 >/dev/null 2>&1
expect "what does not step has no phases" 2 "$stance" plot none.h5 --picture phase tells "has no picture 'phase'"
holds "a gait is a closed curve, has a figure each fifth of a step, and alternates behind a flip" - "$tests" <<'EOF'
sys.path.insert(0, sys.argv[1])
from drawn import Picture
import numpy as np

def meets(a, b):
    return math.dist(a, b) < 1.5

# Each line ends where a jump begins, at one angle, which leads to where a line begins.
p = Picture("two-phase.svg")
assert len(p.panels) == 2 and "leg1, leg1 + leg2 (rad)" in p.said(), p.said()
for panel, hue in zip(p.panels, ("0072b2", "009e73")):
    lines = [q[2] for q in panel.lines if q[0] == hue and not q[1]]
    jumps = [q[2] for q in panel.lines if q[0] == hue and q[1]]
    assert len(lines) == 2 and len(jumps) == 2, (len(lines), len(jumps))
    for line in lines:
        jump = [j for j in jumps if meets(j[0], line[-1])]
        assert jump and abs(jump[0][0][0] - jump[0][-1][0]) < 1, line[-1]
        assert any(meets(jump[0][-1], other[0]) for other in lines), jump
p = Picture("two-strip.svg")
assert "A figure each fifth of a step" in p.said()
marks = sorted({q[2][0][0] for q in p.panels[1].lines if q[0] == "606060" and q[1]})
assert np.allclose(p.panels[-1].x(marks), [0, 0.744928, 2 * 0.744928], atol=2e-3), p.panels[-1].x(marks)
assert len(p.panels) == 3 and p.panels[0].left == p.panels[2].left
feet = p.panels[0].marks("0072b2")
assert len(feet) == 11, len(feet)
p = Picture("along.svg")
assert any(re.fullmatch(r"dotted: flip at 0\.07663\d+", t) for t in p.said()), p.said()
dots = p.panels[0].marks("d55e00")
times = [sorted({round(float(p.panels[0].y(y)), 3) for x, y in dots if abs(x - at) < 1}) for at in sorted(set(dots[:, 0]))]
assert [len(t) for t in times] == [1, 2], times
EOF

# ---- what is wrong -----------------------------------------------------------------------------
outputs="controller.outputs"
wrong() { # NAME SAYS SETS...
    local sets=('sweep={}' "${@:3}")
    expect "$1" 2 "$stance" run "$walks" "${sets[@]/#/--set=}" -o wrong.h5 lines 1 is grep -qF -- "$2" log
}
wrong "three outputs for two actuators" "unknown key 'y3'; did you mean 'y1'? (known: y1, y2)" "$outputs.y3={of: {theta: 1}, along: [0]}"
wrong "an unknown coordinate" "unknown key 'q3'" "$outputs.y1.of={q3: 1}"
wrong "a row without coordinates" "y1: of is missing" "$outputs.y1={along: [0.1]}"
wrong "nothing to follow" "y2: along is missing" "$outputs.y2={of: {q1: 1}}"
wrong "ten coefficients" "expected" "$outputs.y1.along=[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]"
wrong "a coefficient that is none" "expected a number" "$outputs.y1.along=[0, x]"
wrong "an output that is the phase" "depend on each other" "$outputs.y1.of={theta: 2, q1: 2}"
wrong "outputs that are one" "depend on each other" "$outputs.y1.of={theta: 4, q1: 2, q2: 2}"
wrong "a phase without length" "from and to are the same" controller.phase.to=-0.25
wrong "no phase" "phase.of is missing" "controller.phase={from: 0, to: 1}"
wrong "two phases" "give one of of and clock" "controller.phase.clock=[0, 1]"
wrong "torques of one output" "torques of some outputs and not of all" "$outputs.y1.torques={q1: 1}"
wrong "a negative gain" "out of range" "$outputs.y1.proportional=-1"
wrong "keys of another law" "is used only with controller.kind outputs" 'controller={kind: none, phase: {to: 1}}'
wrong "how steps are judged, of none" "is used only with stop.walks.steps above 0" "stop.walks={length: 0.1}"
wrong "a fraction of a step" "expected a whole number" stop.walks.steps=2.5
wrong "footfalls below nothing" "out of range" stop.footfalls=-1
wrong "a step of no length" "out of range" stop.walks.length=0
gait() { # NAME SAYS OPTIONS...
    expect "$1" 2 "$stance" gait "$walks" "${@:3}" lines 1 is grep -qF -- "$2" log
}
gait "a method that does not stop at footfalls" "midpoint puts footfalls at the end of a step" --set method.name=midpoint
gait "noise" "a gait with noise has no cycle" --set controller.noise=0.1
gait "late torques" "remember the step before" --set controller.delay=1
gait "a start that falls" "it falls after 0 footfalls, by hip; give a start that walks" --set initial.state.vq1=0
gait "a number that is drawn, without an end" "--sensitivity takes PATH=FROM..TO" --sensitivity ground.slope=1
gait "one that ends the gait" "with ground.friction" --sensitivity ground.friction=0.02..0.06
gait "a range about another value" "the gait is not one of the middle, ground.slope=0.011" --sensitivity ground.slope=0.01..0.012
gait "a number that the gait never meets" "from 0.7 to 0.9 changes nothing in the gait's returns" --sensitivity ground.friction=0.7..0.9
gait "a range below what is known" "changes nothing in the gait's returns beyond" --sensitivity ground.slope=-1e-13..1e-13
gait "a path that is none" "unknown key 'slop'" --along ground.slop=0..1
gait "a picture of no kind" "a file that ends in svg, png or pdf" --along ground.slope=0..0.1 -o along.txt
gait "how a picture looks of none" "pictures are drawn by -o FILE with --along" --for column
gait "a path without an end" "takes PATH=FROM..TO" --along ground.slope=1
gait "a bad count" "--steps" --steps 0
gait "a floor that is too slippery" "the foot that lands slides" --set ground.friction=0.05
"$stance" gait "$shipped/mechanisms/compass_gait.yaml" --set robot.bodies.leg2.mass=5.5 >log 2>&1
tells "legs that differ are told" 'the legs, or what drives them, differ.*--steps 2'
expect "a file that cannot be written" 3 "$stance" gait "$walks" -o /nonexistent/file.yaml tells 'cannot write'
