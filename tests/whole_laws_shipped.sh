#!/usr/bin/env bash
# The laws that ship, in short runs of their studies: a hopper hops at the speed that it is asked for, survives strokes and
# floors; an acrobot swings up with weak motors and slow computers; a network recovers from more starts than the linear law.
# about: runner/objects runner/scenario runner/run
. "$(dirname "$0")/scratch.sh"
export XDG_CONFIG_HOME=$PWD/config XDG_CACHE_HOME=$PWD/cache
laws=$shipped/laws

expect "a law is not run before it is trusted" 2 "$stance" run "$laws/swing_up.yaml" --quiet -o none.h5 \
    tells 'add --trust' is [ ! -e none.h5 ]
for law in raibert_hopper swing_up network; do
    is "$law.c has less than 80 lines" [ "$(wc -l <"$laws/$law.c")" -lt 80 ]
    expect "... and its scenario a plan" 0 "$stance" check "$laws/$law.yaml"
done

runs() { # NAME LAW WORDS...: into NAME.h5
    local name=$1 law=$2
    shift 2
    expect "$law: $name" 0 "$stance" run --trust "$laws/$law.yaml" --quiet -o "$name.h5" "$@"
}
asks() { # NAME, on standard input a program in Python: it asserts something
    is "$1" '"$python" - >log 2>&1'
}
cat >told.py <<'END'
import h5py
import numpy as np


def of(name):
    f = h5py.File(name + ".h5")
    words = f["outcome"].attrs["flag_meanings"]
    return f, np.array((words.decode() if isinstance(words, bytes) else words).split())[f["outcome"][...]]
END

# ---- a hopper ------------------------------------------------------------------------------------
runs speeds raibert_hopper --set 'sweep.grid=[{path: controller.speed, values: [-0.5, 0, 1, 1.5, 2.5]},
    {path: stop.time, values: [10, 31]}]'
asks "... are those that are asked for, up to where it falls" <<'END'
from told import *
f, outcome = of("speeds")
x = f["final_state"][..., 0]
speed = (x[:, 1] - x[:, 0]) / 21
assert (outcome[:4] == "undecided").all() and outcome[4, 1] == "fell", outcome
assert (abs(speed[:4] - f["controller.speed"][:4]) < 0.03).all(), speed
END
runs heights raibert_hopper --set 'sweep={}' --set stop.time=6 --trace
asks "... are what is asked for" <<'END'
from told import *
f = h5py.File("heights.h5")["trajectory"]
z = f["position"][0, f["time"][...] > 3, 1]
assert 0.98 < z.max() < 1.01 and 0.4 < z.min() < 0.6, (z.max(), z.min())
END
runs strokes raibert_hopper --set stop.time=9 --set 'sweep.grid=[{path: robot.points.hip.from, values: [5.15, 5.47]},
    {path: "robot.points.hip.impulse[0]", values: [-28, -20, 4, 8, 24, 30]}]'
asks "... are survived best in the air" <<'END'
from told import *
hops = of("strokes")[1] == "undecided"
assert hops.tolist() == [[False, True, True, False, False, False], [True, True, True, True, True, False]], hops
END
runs floors raibert_hopper --set stop.time=10 --set 'sweep.grid=[{path: ground.friction, values: [0.06, 0.2]},
    {path: controller.speed, values: [0.25, 1, 1.5]}]'
asks "... need friction for speed" <<'END'
from told import *
hops = of("floors")[1] == "undecided"
assert hops.tolist() == [[True, False, False], [True, True, True]], hops
END

# ---- an acrobot ----------------------------------------------------------------------------------
runs swings swing_up --set 'sweep.grid=[{path: initial.offset.arms, values: [3.141592653589793, 2, 5, 1]},
    {path: initial.offset.legs, from: -2, to: 2, count: 3}]'
asks "... end upright, whatever they begin from" <<'END'
from told import *
f, outcome = of("swings")
assert (outcome == "stabilised").all() and 15 < f["settle_time"][0, 1] < 35, (outcome, f["settle_time"][...])
assert abs(f["final_state"][..., :2]).max() < 0.05
END
runs limits swing_up --set stop.time=90 --set 'sweep.grid=[{path: robot.actuators.waist.limit, values: [2, 3.3, 5]},
    {path: controller.bend, values: [0.8, 1.1]}]'
asks "... may be less than what holds the legs level, if they bend enough" <<'END'
from told import *
up = of("limits")[1] == "stabilised"
assert up.tolist() == [[False, False], [False, True], [False, True]], up
END
runs samples swing_up --set 'sweep.grid=[{path: controller.sample_time, values: [0.03, 0.1]}]'
asks "... may be 30 ms apart, and not 100" <<'END'
from told import *
assert of("samples")[1].tolist() == ["stabilised", "undecided"], of("samples")[1]
END

# ---- a network -----------------------------------------------------------------------------------
runs starts network --set sweep.sample.count=1024
linear='controller={kind: state-feedback, design: place, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6], sample_time: 0.001,
    torque_limit: 10}'
expect "the linear law from the same ones" 0 "$stance" run "$laws/network.yaml" --quiet -o linear.h5 \
    --set sweep.sample.count=1024 --set "$linear"
asks "... of which the network recovers more" <<'END'
from told import *
network, linear = (of(name)[1] == "stabilised" for name in ("starts", "linear"))
assert network.mean() > 0.37 and 0.2 < linear.mean() < 0.26, (network.mean(), linear.mean())
END
expect "a network of two hidden units, made anew" 0 sh -c "cp '$laws'/network.* '$laws'/train_network.py . &&
    '$python' train_network.py '$stance' 1 2" tells '^first: 0\.2'
expect "weights of another network are none" 1 "$stance" run "$laws/network.yaml" --set 'sweep={}' \
    --set 'controller.data=[2, 1, 2, 1, 1, 0, 0, 0, 0, 0]' -o wrong.h5
