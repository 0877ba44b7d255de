#!/usr/bin/env bash
# Robots of discs, soles and joint stops, let go: several of these meet at one instant, legs coincide,
# and the impact has many answers. The default method gets over it, and what it tells of the contact
# laws is true of the state. The kernels that are built in compute.
# about: runner/objects runner/run analysis/summary
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache CC=false

# Gym's walker2d, with a head by which it falls.
sed '/^ground:/,$d' "$tests/robots/walker2d.yaml" >walker.yaml
cat >>walker.yaml <<END
  points: {head: {body: torso, at: [0, 0], lowest: 0.8}}
ground: {friction: 0.9}
initial: {state: {z: 1.25}}
method: {step: 0.002}
stop: {time: 0.9, settle: "off"}
sweep:
  grid:
    - {path: initial.state.torso, values: [-0.2, -0.02, 0.06, 0.08, 0.14]}
    - {path: initial.state.vtorso, values: [-1, -0.8, -0.7, -0.4, -0.1]}
END
cat >humanoid.yaml <<END
stance: 1
title: A humanoid on two soles, let go
scene: mechanism
robot:
  bodies:
    pelvis:  {joint: free, mass: 30, inertia: 1.6, centre: [0, 0.25]}
    thigh1:  {joint: hinge, parent: pelvis, mass: 8, inertia: 0.13, centre: [0, -0.2], limits: [-0.5, none]}
    shank1:  {joint: hinge, parent: thigh1, at: [0, -0.42], mass: 4, inertia: 0.06, centre: [0, -0.2], limits: [-2.4, 0]}
    foot1:   {joint: hinge, parent: shank1, at: [0, -0.4], mass: 1, inertia: 0.004, centre: [0.04, -0.04], limits: [-0.8, none]}
    thigh2:  {joint: hinge, parent: pelvis, like: thigh1}
    shank2:  {joint: hinge, parent: thigh2, like: shank1}
    foot2:   {joint: hinge, parent: shank2, like: foot1}
  contacts:
    sole1: {body: foot1, from: [-0.06, -0.07], to: [0.16, -0.07]}
    sole2: {body: foot2, from: [-0.06, -0.07], to: [0.16, -0.07]}
  points: {head: {body: pelvis, at: [0, 0.7], lowest: 0.5}}
  actuators:
    hip1: {body: thigh1, limit: 100}
ground: {friction: 0.8}
initial: {state: {z: 0.9}}
method: {step: 0.002}
stop: {time: 0.8, settle: "off"}
sweep:
  grid:
    - {path: initial.state.pelvis, from: 0, to: 0.06, count: 5}
    - {path: initial.state.vpelvis, from: -1, to: 1, count: 6}
END
cat >quadruped.yaml <<END
stance: 1
title: Four feet in a plane, thrown
scene: mechanism
robot:
  bodies:
    trunk:  {joint: free, mass: 10, inertia: 0.5}
    hthigh: {joint: hinge, parent: trunk, at: [-0.25, 0], mass: 1, inertia: 0.005, centre: [0, -0.1], damping: 0.2, limits: [-1, 2]}
    hshank: {joint: hinge, parent: hthigh, at: [0, -0.2], mass: 0.3, inertia: 0.001, centre: [0, -0.1], damping: 0.2, limits: [-2.6, -0.3]}
    fthigh: {joint: hinge, parent: trunk, like: hthigh, at: [0.25, 0]}
    fshank: {joint: hinge, parent: fthigh, like: hshank}
  contacts:
    hfoot: {body: hshank, at: [0, -0.2], radius: 0.02}
    ffoot: {body: fshank, at: [0, -0.2], radius: 0.02}
    rump:  {body: trunk, at: [-0.3, 0], radius: 0.05}
    nose:  {body: trunk, at: [0.3, 0], radius: 0.05}
  points: {back: {body: trunk, at: [0, 0], lowest: 0.06}}
  actuators:
    hip: {body: fthigh, limit: 20}
ground: {friction: 0.6, restitution: 0.4}
initial: {state: {}}
method: {step: 0.002}
stop: {time: 0.8, settle: "off"}
sweep:
  sample:
    method: random
    count: 40
    vary:
      - {path: initial.state.z, from: 0.57, to: 0.8}
      - {path: initial.state.vz, from: -2, to: 1}
      - {path: initial.state.trunk, from: -0.8, to: 0.8}
      - {path: initial.state.vtrunk, from: -3, to: 3}
      - {path: initial.state.hthigh, from: -0.8, to: 1}
      - {path: initial.state.hshank, from: -2, to: -0.3}
      - {path: initial.state.fthigh, from: -0.8, to: 1}
      - {path: initial.state.fshank, from: -2, to: -0.3}
END

for robot in walker humanoid quadruped; do
    # The laws hold in what is stored, and little is moved by mending.
    expect "$robot, let go" 0 "$stance" run $robot.yaml -o $robot.h5 holds - $robot.h5 <<'END'
f = h5py.File(sys.argv[1])
for answer, most in (("signorini_residual", 1e-9), ("coulomb_residual", 1e-12),
                     ("dissipation_residual", 1e-9), ("max_penetration", 1e-9),
                     ("impact_energy", 1e-9), ("energy_gain", 1e-9), ("projection_energy", 0.05)):
    worst = f[answer][...].max()
    assert worst <= most, (answer, worst)
END
done

# ---- contacts that throw each other up ---------------------------------------------------------------
# The end of a fall: both feet flat, the left one a hair off that. What comes down throws up another
# contact, less each time, which ends where that is too low to count: it took 31822 evaluations.
sed -n '1,/^ground:/p' walker.yaml >feet.yaml
cat >>feet.yaml <<END
initial:
  state: {z: 1.03569592125, torso: 0.55778192654, foot: -0.5577819265463682,
          vx: -1.7972099171260858, vz: -1.1212143859472363, vtorso: 1.8419750573428904, vfoot: -1.8419779935780385}
method: {step: 0.01}
stop: {time: 0.02, settle: "off"}
sweep:
  sample:
    method: random
    count: 20
    vary:
      - {path: initial.state.foot_left, from: -0.55778192654, to: -0.5577818}
      - {path: initial.state.vfoot_left, from: -1.86, to: -1.842}
      - {path: initial.state.vthigh_left, from: -1e-3, to: 0}
      - {path: initial.state.vthigh, from: -1e-3, to: 0}
END
expect "feet side by side, nearly flat, come to rest" 0 "$stance" run feet.yaml -o feet.h5 holds \
    'most = h5py.File("feet.h5")["evaluations"][...].max(); assert most <= 5000, most'

# ---- feet that come to rest in turn --------------------------------------------------------------------
# A foot that stops as the other begins to slide: what crossed that event took all of the load off one of
# them, and pulled it into the ground by less than 1e-11 m/s, which is much in 5e-10 s.
expect "legs that slide apart" 0 "$stance" run "$shipped/controllers/walk_gains.yaml" --set sweep.grid[2].count=15 \
    --set sweep.grid[3].count=15 --only 1195 -o apart.h5

# ---- what bounced is judged by the impact ----------------------------------------------------------
expect "bouncing, in steps of fixed length" 0 "$stance" run walker.yaml --set method.name=midpoint --set ground.restitution=0.3 -o bounces.h5
holds "slips against their friction are what a foot turns by in the step" "
worst = h5py.File('bounces.h5')['dissipation_residual'][...].max()
assert worst <= 2e-5, worst"

expect "legs side by side, of which either may take the blow" 0 "$stance" run walker.yaml --set method.name=midpoint --set ground.restitution=0.6 -o mirror.h5

# ---- a case that fails says when, where, and what to try -------------------------------------------
expect "a tolerance that cannot be had" 1 "$stance" run walker.yaml --set method.tolerance=1e-17 --only 12 -o fails.h5
expect "summary of what fails" 0 "$stance" summary fails.h5 \
    says "try another step" "in the step from [0-9.]* s" "touching  *toe, toe_left, thigh_high"
