#!/usr/bin/env bash
# Scenes that the program carries are descriptions: what those get is theirs, the same comes of both;
# coordinates with names of their own, bodies turned against their parents, forces that swing.
# about: runner/run runner/plan analysis/compare
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache

# ---- the biped as the program carries it, and as a scenario describes it ----------------------------
grid='sweep={grid: [{path: ground.gravity, values: [1.62, 9.81]},
    {path: "robot.points.hip.impulse[0]", from: -1, to: 4, count: 11},
    {path: "robot.points.hip.impulse[1]", from: -4, to: 4, count: 5}]}'
cat >own.yaml <<END
stance: 1
scene: biped
robot: {points: {hip: {lowest: 0.1, impulse: [0, 0], from: 0.1}}}
ground: {friction: 0.8, contacts: [foot1], slope: 0.02}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: state-feedback, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6], sample_time: 0.001, torque_limit: 10}
method: {name: midpoint, step: 0.001}
stop: {time: 8}
END
expect "a biped, struck at the hip, on a slope, on the moon" 0 "$stance" run own.yaml --set "$grid" -o own.h5
expect "the same described" 0 "$stance" run "$shipped/mechanisms/pushed.yaml" --set "$grid" --set ground.slope=0.02 --set stop.time=8 -o described.h5
holds "the same becomes of every case" <<END
import h5py, numpy as np
a, b = h5py.File("own.h5"), h5py.File("described.h5")
assert set(np.unique(a["outcome"][...])) == {1, 2} and np.array_equal(a["outcome"][...], b["outcome"][...])
for k in ("settle_time", "fall_time", "peak_torque", "slip_distance", "excursion", "final_state"):
    x, y = a[k][...], b[k][...]
    if k == "final_state":  # x and z are of the trunk's mass, of its origin
        x, y = x[..., 2:5], y[..., 2:5]
    off = np.nanmax(np.abs(x - y) / (1 + np.abs(x)))
    assert off < 1e-5 and np.array_equal(np.isnan(x), np.isnan(y)), (k, off)
END

# ---- the block's slope, and the ball's ---------------------------------------------------------------
cat >slopes.py <<END
import sys, h5py
from math import sin, cos
f, g, slope = h5py.File("slopes.h5"), 9.81, 0.4
pull = g * (sin(slope) - 0.1 * cos(slope))
x, z = f["final_state"][0, :2]
if sys.argv[1] == "block":
    assert abs(x - pull / 2) < 1e-9 and abs(z) < 1e-12, (x, z)
else:  # upright axes; the centre a radius off the plane
    assert abs(x - pull / 2 * cos(slope)) < 1e-9, x
    assert abs(x * sin(slope) + z * cos(slope) - 0.1) < 1e-12, z
END
end="stop: {time: 1, settle: off}
ground: {friction: 0.1"
printf 'stance: 1\nscene: block\nrobot: {slope: 0.4}\ninitial: {state: {}}\n%s}\n' "$end" >block.yaml
printf 'stance: 1\nscene: ball\ninitial: {state: {z: %s}}\n%s, slope: 0.4}\n' \
    "$("$python" -c 'import math; print(0.1 / math.cos(0.4))')" "$end" >ball.yaml
for scene in block ball; do
    expect "a $scene on a slope" 0 "$stance" run $scene.yaml --force -o slopes.h5
    is "... slides as it must" '"$python" slopes.py $scene >log 2>&1'
done
expect "the block has robot.slope, not the ground's" 2 "$stance" check block.yaml --set ground.slope=0.1 \
    says "ground: .*'slope'"

# ---- what descriptions may say -----------------------------------------------------------------------
cat >swing.yaml <<END
stance: 1
scene: mechanism
robot:
  bodies:
    cart: {joint: slide, axis: [1, 0], mass: 1, coordinate: s}
    pole: {joint: hinge, parent: cart, mass: 0.2, inertia: 0.01, centre: [0, -0.5], coordinate: phi, angle: 0}
  points:
    pull: {body: cart, force: [2, 0], from: 0, frequency: 0.8}
initial: {state: {s: 0, phi: 0.1}}
stop: {time: 3, settle: off}
END
expect "a cart that is pulled to and fro" 0 "$stance" run swing.yaml -o swing.h5
expect "its pole described upside down, and turned" 0 "$stance" run swing.yaml --set 'robot.bodies.pole.centre=[0, 0.5]' \
    --set robot.bodies.pole.angle=3.141592653589793 -o turned.h5
holds "moves the same" <<END
import h5py, numpy as np
a, b = (h5py.File(n) for n in ("swing.h5", "turned.h5"))
assert list(a["state"].asstr()) == ["s", "phi", "vs", "vphi"], list(a["state"])
assert np.abs(a["final_state"][...] - b["final_state"][...]).max() < 1e-12
assert abs(a["final_state"][0, 0]) > 0.1
END
for wrong in "pole.coordinate=s:the coordinate of cart" "pole.coordinate=x:'x' is no name" "pole.coordinate=vs:the coordinate of cart" \
    "cart.coordinate=a b:is no name"; do
    expect "robot.bodies.${wrong%:*} is refused" 2 "$stance" check swing.yaml --set "robot.bodies.${wrong%:*}" \
        says "${wrong##*:}"
done
expect "a point of a carried scene needs a body" 2 "$stance" check own.yaml --set 'robot.points.knee={at: [0, -0.3]}' \
    says "robot.points.knee.body is missing"
expect "... and a name of its own" 2 "$stance" check own.yaml --set 'robot.points.leg1={body: leg1}' \
    says "a part of the scene is called so"
expect "a push that does not swing has an end" 2 "$stance" check own.yaml --set 'robot.points.trunk={force: [1, 0]}' \
    says "robot.points.trunk.to is missing"
