#!/usr/bin/env bash
# What `stance design` says of described robots: forces on a slope, the set within the friction cone
# there, units of what slides.
# about: runner/plan
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache

# ---- on a slope ------------------------------------------------------------------------------------
# A leg on a wheel: on a slope s friction carries the weight's share tan(s), which leaves the less of
# the cone the nearer the coefficient is to tan(s) = 0.0801711.
cat >slope.yaml <<END
stance: 1
scene: mechanism
robot:
  bodies:
    hip: {joint: free, mass: 5, inertia: 0.1}
    leg: {joint: hinge, parent: hip, mass: 2, inertia: 0.1, centre: [0, -0.3]}
    wheel: {joint: hinge, parent: leg, at: [0, -0.6], mass: 1, inertia: 0.01}
  contacts: {rim: {body: wheel, at: [0, 0], radius: 0.1}}
  actuators: {hip1: {body: leg}, drive: {body: wheel}}
ground: {slope: 0.08, friction: 0.9}
initial: {equilibrium: {hip: 0, wheel: 0}, support: [rim]}
controller: {kind: state-feedback, design: lqr, sample_time: 0.002}
stop: {time: 1}
END
expect "design" 0 "$stance" design slope.yaml says "force  *78.2289.. N .* across the slope"
holds "the set ends where the cone does, which the slope takes a share of" - "$stance" <<'END'
def level(friction):
    out = subprocess.run([sys.argv[1], "design", "slope.yaml", "--json", "--set", f"ground.friction={friction}"],
                         check=True, capture_output=True).stdout
    design = json.loads(out)
    assert abs(design["equilibrium"]["normal_force"] - 8 * 9.81 * math.cos(0.08)) < 1e-9
    set = design["controller"]["lyapunov"]
    assert set["binding"] == "friction cone, force backward", set["binding"]
    return set["level"]
wide, near = level(math.tan(0.08) + 1e-3), level(math.tan(0.08) + 1e-5)
assert 0.99e-4 < near / wide < 1.01e-4, (wide, near)
END

# ---- what slides -----------------------------------------------------------------------------------
expect "a cart" 0 "$stance" design "$shipped/mechanisms/cart_pole.yaml" \
    says "push .* N    force that holds it" "(rad, m and their rates), u that of the forces (N)" "axis\[0\]  *1$"
