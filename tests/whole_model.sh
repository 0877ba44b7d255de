#!/usr/bin/env bash
# `stance plot --model` draws the robot of every scene: each angle from where it is 0 to its link, with its
# sign, each coordinate, actuator and contact by name.
# about: analysis/plot
. "$(dirname "$0")/scratch.sh"
mkdir scripts
cat >model.py <<'END'
"""What the picture of a model is drawn from: arcs turn by the angles that stand beside it, from the dashed
line of the angle 0 to a segment of the stick figure."""
import re
import subprocess
import sys
import numpy as np

data = open(f"scripts/{sys.argv[1]}-model/data.gp").read()
wanted = sys.argv[2].split(",")
def block(style):
    """The rows of the series that is drawn in a style."""
    number = re.search(rf"'\$series(\d+)' using [^']*{style}", data).group(1)
    text = re.search(rf"\$series{number} << EOD\n(.*?)EOD", data, re.S).group(1)
    return np.array([[float(x) for x in line.split()] for line in text.split("\n") if line])
labels = dict(re.findall(r"label_text\[(\d+)\] = '(.*)'", data))
assert sorted(text for text in labels.values() if text != "(x, z)") == sorted(wanted), sorted(labels.values())
words = re.findall(r"legend_text\[legends\] = '(\S+) = (\S+) rad'", data)
arrows = block("vectors nohead lw 2")
arcs, run = [], []
for row in arrows[arrows[:, 4] == 0]:
    run.append(row)
    if row[5] == 1:
        if len(run) > 1:
            arcs.append(np.array(run))
        run = []
assert len(arcs) == len(words), (len(arcs), words)
lines = block("lines dt 2").reshape(-1, 2, 2)
segments = block("lines lw 3.4")
for arc, line, (name, value) in zip(arcs, lines, words):
    first, last = arc[0, :2] - line[0], arc[-1, :2] + arc[-1, 2:4] - line[0]
    turn = np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
    angle = float(value)
    angle = np.remainder(angle + np.pi, 2 * np.pi) - np.pi
    assert abs(turn - (angle if abs(angle) >= 0.1 else 0.6)) < 1e-3, (name, turn, angle)
    dashed = line[1] - line[0]
    assert abs(first[0] * dashed[1] - first[1] * dashed[0]) < 1e-6, name
    if abs(angle) >= 0.1: # the arc ends on the figure
        ends = np.hypot(*np.diff(segments, axis=0).T)
        off = min(abs(np.cross(b - a, arc[-1, :2] + arc[-1, 2:4] - a)) / n for a, b, n in zip(segments, segments[1:], ends) if n > 0)
        assert off < 1e-3, (name, off)
END
draws() { # scenario, its labels, settings ...
    local scenario=$1 labels=$2 name
    name=$(basename "$scenario" .yaml)
    shift 2
    STANCE_SCRIPTS=$scratch/scripts timeout "$patience" "$stance" plot --model "$shipped/$scenario" "$@" -o . >log 2>&1
    result $? "$scenario"
    [ -s "$name-model.png" ] && [ "$(cat log)" = "$name-model.svg
$name-model.png" ]
    result $? "... both files, and no more words"
    is "... angles with their signs, names of all" '"$python" -W ignore model.py "$name" "$labels" >log 2>&1'
}
draws balance_recovers.yaml theta,q1,q2,hip1,hip2,foot1,foot2 --set 'initial.offset={}'
draws ball_bounce.yaml bottom
draws block_threshold.yaml base
draws rod_fall.yaml theta,end1,end2
draws mechanisms/rabbit.yaml trunk,thigh1,shank1,thigh2,shank2,hip1,knee1,hip2,knee2,foot1,foot2
draws mechanisms/hopper.yaml body,shoe,sole_heel,sole_toe
draws mechanisms/cart_pole.yaml cart,pole,push
draws mechanisms/acrobot.yaml arms,legs,waist
cp scripts/cart_pole-model/data.gp log
holds "the way of a force on a slide" \
    'assert re.search(r"= .push.\n.*\n.*about = .positive pushes cart along its axis, to the right", open("log").read())'
draws mechanisms/rolling_disc.yaml disc,rim
draws mechanisms/compass_gait.yaml leg1,leg2,foot1,foot2
expect "a results file is no model" 2 "$stance" plot --model "$scratch/scripts"
expect "--case is of results files" 2 "$stance" plot --model "$shipped/drop.yaml" --case 1
expect "--set is of models" 2 "$stance" plot results.h5 --set stop.time=1
"$stance" describe initial.offset.q1 >log
says "describe tells signs" "angle of leg 1 against the trunk, counter-clockwise, 0 in"
