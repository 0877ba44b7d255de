#!/usr/bin/python3
"""Stability domain of the robot that balances on foot 1, pinned: 64 x 64 labels and what the foot
feels.

    /usr/bin/python3 tests/reference/pinned_basin.py   writes tests/reference/pinned_basin.json

Foot 1 is a bilateral pin at the origin, which leaves three coordinates. The equations are
Lagrange's in the absolute angles (a, b, c) = (theta, theta + q1, theta + q2), where the inertia
matrix is tridiagonal in the order (a, b, c):

  hip   = l (-sin b, cos b),   trunk = hip + lt (-sin a, cos a),   foot 2 = hip + l (sin c, -cos c)

State feedback with robust gains (Kautsky, Nichols, Van Dooren 1985, method 0, iterated until it no
longer changes), torques clipped to 10 N m and held for 1 ms; derivatives by complex steps, exact to
rounding; RK4 with two substeps a sample. No noise. At each sampling instant the outcome rules of
the scenario format are applied: `stabilised` (s) where angles and rates have been within 0.05 rad
and 0.5 rad/s of the target for 0.5 s and the error, the largest of them in those units, is not
larger than when that began, else the window begins anew; `fell` (f) where the hip is lower than
0.2 leg lengths or the trunk not above the ground; `undecided` (u) after 8 s.

A real foot can only push: the least normal force and the largest |tangential|/normal ratio while it
pushes, up to the decision, tell which labels the pin owes to pulling or to a given friction. Forces
are sampled on both sides of each change of torque.
"""
import json
import os
import warnings

import numpy as np
from scipy.signal import place_poles

G, LEG, TRUNK, FOOT_MASS, TRUNK_MASS, HIP_MASS = 9.81, 0.535, 0.535, 1.8, 1.8, 5.4
THETA, Q2 = -0.41, 0.82
POLES = [-3, -3.3, -3.6, -3.9, -4.2, -4.6]
LIMIT, SAMPLE, HORIZON = 10.0, 1e-3, 8.0
ANGLE, RATE, HOLD, FALL = 0.05, 0.5, 0.5, 0.2
FLOOR = 1e-9  # an error that grows below this is rounding, as it does at the equilibrium itself
POINTS, THETA_RANGE, RATE_RANGE = 64, (-0.12, 0.06), (-0.6, 0.6)


def accelerate(q, v, torque):
    """q'' [3][n], force of the pin (x, z) [2][n]; q, v [3][n] in (theta, q1, q2), torque [2][n]."""
    a, b, c = q[0], q[0] + q[1], q[0] + q[2]
    va, vb, vc = v[0]**2, (v[0] + v[1])**2, (v[0] + v[2])**2
    upper = TRUNK_MASS + HIP_MASS + FOOT_MASS  # all that foot 1 carries
    trunk, foot = TRUNK_MASS * LEG * TRUNK, FOOT_MASS * LEG**2
    # tridiagonal M [a'', b'', c''] = f; torques act as (-(T1 + T2), T1, T2) on (a, b, c)
    maa, mbb, mcc = TRUNK_MASS * TRUNK**2, upper * LEG**2, foot
    mab, mbc = trunk * np.cos(a - b), -foot * np.cos(b - c)
    fa = (-torque[0] - torque[1] - trunk * np.sin(a - b) * vb
          + TRUNK_MASS * TRUNK * G * np.sin(a))
    fb = (torque[0] + trunk * np.sin(a - b) * va + foot * np.sin(b - c) * vc
          + upper * LEG * G * np.sin(b))
    fc = torque[1] - foot * np.sin(b - c) * vb - FOOT_MASS * LEG * G * np.sin(c)
    ab = (fb - mab / maa * fa - mbc / mcc * fc) / (mbb - mab**2 / maa - mbc**2 / mcc)
    aa, ac = (fa - mab * ab) / maa, (fc - mbc * ab) / mcc
    # the pin carries the weight and accelerates the centre of mass
    hip_x = LEG * (np.sin(b) * vb - np.cos(b) * ab)
    hip_z = -LEG * (np.cos(b) * vb + np.sin(b) * ab)
    trunk_x = TRUNK * (np.sin(a) * va - np.cos(a) * aa)
    trunk_z = -TRUNK * (np.cos(a) * va + np.sin(a) * aa)
    foot_x = LEG * (np.cos(c) * ac - np.sin(c) * vc)
    foot_z = LEG * (np.sin(c) * ac + np.cos(c) * vc)
    force = np.array([upper * hip_x + TRUNK_MASS * trunk_x + FOOT_MASS * foot_x,
                      upper * hip_z + TRUNK_MASS * trunk_z + FOOT_MASS * foot_z
                      + (upper + FOOT_MASS) * G])
    return np.array([aa, ab - aa, ac - aa]), force


def design():
    """Equilibrium angles [3], torques [2], gains [2][6]."""
    second = LEG * FOOT_MASS * G * np.sin(THETA + Q2)
    torque = np.array([TRUNK * TRUNK_MASS * G * np.sin(THETA) - second, second])
    weight = (TRUNK_MASS + FOOT_MASS + HIP_MASS) * G
    q = np.array([THETA, np.arcsin(-torque[0] / (LEG * weight)) - THETA, Q2])

    def derivative(of):
        h = 1e-40
        return of(1j * h).imag / h

    def at(dq, dt):
        return accelerate((q + dq)[:, None], np.zeros((3, 1)), (torque + dt)[:, None])[0][:, 0]

    A, B = np.zeros((6, 6)), np.zeros((6, 2))
    A[:3, 3:] = np.eye(3)
    for i, unit in enumerate(np.eye(3)):
        A[3:, i] = derivative(lambda h, unit=unit: at(h * unit, np.zeros(2)))
    for i, unit in enumerate(np.eye(2)):
        B[3:, i] = derivative(lambda h, unit=unit: at(np.zeros(3), h * unit))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that rtol = 0 is not reached
        placed = place_poles(A, B, POLES, method='KNV0', rtol=0, maxiter=2000)
    return q, torque, placed.gain_matrix


def simulate(theta, vtheta, controller, substeps=2):
    """Labels, instants of decision, least normal force, largest force ratio; offsets [n]."""
    target, feedforward, gain = (controller[0][:, None], controller[1][:, None], controller[2])
    n, steps = theta.size, round(HORIZON / SAMPLE)
    q, v = np.repeat(target, n, 1), np.zeros((3, n))
    q[0] += theta
    v[0] += vtheta
    label, decided = np.full(n, 'u'), np.full(n, HORIZON)
    least, ratio = np.full(n, np.inf), np.zeros(n)
    begin, first = np.full(n, -1), np.zeros(n)
    live = np.arange(n)

    def feel(force):
        least[live] = np.minimum(least[live], force[1])
        pushes = force[1] > 0
        who = live[pushes]
        ratio[who] = np.maximum(ratio[who], np.abs(force[0][pushes]) / force[1][pushes])

    for k in range(steps + 1):
        error = np.maximum(np.abs(q - target).max(0) / ANGLE, np.abs(v).max(0) / RATE)
        hip = LEG * np.cos(q[0] + q[1])
        fell = (hip < FALL * LEG) | (hip + TRUNK * np.cos(q[0]) <= 0)
        inside = error <= 1
        full = inside & (begin[live] >= 0) & (k - begin[live] >= round(HOLD / SAMPLE))
        done = full & (error <= np.maximum(first[live], FLOOR))
        anew = inside & ~done & (full | (begin[live] < 0))
        begin[live[~inside]] = -1
        begin[live[anew]], first[live[anew]] = k, error[anew]
        label[live[done]], label[live[fell]] = 's', 'f'
        decided[live[done | fell]] = k * SAMPLE
        go = ~(done | fell)
        live, q, v = live[go], q[:, go], v[:, go]
        if live.size == 0 or k == steps:
            break
        torque = np.clip(feedforward - gain[:, :3] @ (q - target) - gain[:, 3:] @ v, -LIMIT, LIMIT)
        h = SAMPLE / substeps
        for _ in range(substeps):
            k1, force = accelerate(q, v, torque)
            feel(force)
            v2 = v + h / 2 * k1
            k2, _ = accelerate(q + h / 2 * v, v2, torque)
            v3 = v + h / 2 * k2
            k3, _ = accelerate(q + h / 2 * v2, v3, torque)
            v4 = v + h * k3
            k4, _ = accelerate(q + h * v3, v4, torque)
            q, v = (q + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
        feel(accelerate(q, v, torque)[1])
    return label, decided, least, ratio


def interval(controller, substeps=2):
    """Ends of the stabilised interval of theta offsets at vtheta = 0, to 1e-8 rad; it is one."""
    grid = np.linspace(*THETA_RANGE, 361)
    label = simulate(grid, np.zeros_like(grid), controller, substeps)[0]
    change = np.flatnonzero((label[1:] == 's') != (label[:-1] == 's'))
    if len(change) != 2:
        raise RuntimeError(f"{len(change)} ends of the interval at rest")
    ends = []
    for i in change:
        low, high = grid[i], grid[i + 1]
        while high - low > 1e-8:
            cut = np.linspace(low, high, 257)
            label = simulate(cut, np.zeros_like(cut), controller, substeps)[0]
            j = np.flatnonzero((label[1:] == 's') != (label[:-1] == 's'))[0]
            low, high = cut[j], cut[j + 1]
        ends.append((low + high) / 2)
    return ends


def rows(values, digits=4):
    return [[float(f"{x:.{digits}g}") for x in row] for row in values.reshape(POINTS, POINTS)]


def main():
    controller = design()
    theta, vtheta = (x.ravel() for x in np.meshgrid(
        np.linspace(*THETA_RANGE, POINTS), np.linspace(*RATE_RANGE, POINTS), indexing='ij'))
    label, decided, least, ratio = simulate(theta, vtheta, controller)
    other, at, _, _ = simulate(theta, vtheta, controller, substeps=4)
    ends = interval(controller)
    out = {
        "made_by": "/usr/bin/python3 tests/reference/pinned_basin.py",
        "robot": {"leg_length": LEG, "trunk_length": TRUNK, "foot_mass": FOOT_MASS,
                  "trunk_mass": TRUNK_MASS, "hip_mass": HIP_MASS},
        "equilibrium": controller[0].tolist(), "torques": controller[1].tolist(),
        "gains": controller[2].tolist(), "poles": POLES, "torque_limit": LIMIT,
        "sample_time": SAMPLE, "horizon": HORIZON, "theta": [*THETA_RANGE, POINTS],
        "vtheta": [*RATE_RANGE, POINTS], "interval": ends,
        "labels": ["".join(r) for r in label.reshape(POINTS, POINTS)],
        "decided": rows(decided), "least_normal_force": rows(least), "largest_ratio": rows(ratio)}
    lines = []
    for key, value in out.items():
        nested = isinstance(value, list) and len(value) == POINTS
        text = ("[\n" + ",\n".join(json.dumps(r) for r in value) + "\n]" if nested
                else json.dumps(value))
        lines.append(f"{json.dumps(key)}: {text}")
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pinned_basin.json")
    with open(path, "w") as file:
        file.write("{\n" + ",\n".join(lines) + "\n}\n")

    print("labels:", {x: int(np.sum(label == x)) for x in "sfu"})
    print("at rest, stabilised from %.9f to %.9f rad" % tuple(ends))
    print("half the substep changes", int(np.sum(label != other)), "labels and moves decisions by",
          np.max(np.abs(decided - at)), "s; interval by",
          np.max(np.abs(np.subtract(ends, interval(controller, 4)))))
    for x in "sf":
        who = label == x
        print(f"{x}: would lift {int(np.sum(who & (least <= 0)))}; least normal force "
              f"{least[who].min():.4g} N; ratio median {np.median(ratio[who]):.4f}, 90 % "
              f"{np.quantile(ratio[who], 0.9):.4f}, 99 % {np.quantile(ratio[who], 0.99):.4f}, "
              f"largest {ratio[who].max():.4f}; beyond 0.8: {int(np.sum(ratio[who] > 0.8))}")


if __name__ == "__main__":
    main()
