#!/usr/bin/python3
"""500 frictional impacts solved exactly by enumeration, for the tests of the contact solver.

    /usr/bin/python3 tests/reference/impacts.py     writes tests/reference/impacts.json

The default robot in random postures with one foot or both exactly on the ground, approaching it at
random velocities. Every combination of open, stick and slip is solved with the inertia of the
posture and kept where it obeys Signorini's and Coulomb's laws (robot.impact_solutions); `solutions`
are those that differ in velocity, least kinetic energy first. The trunk is above the ground in each
posture, else the case has fallen before it begins; the hip may be anywhere. Two feet on the ground
stand either apart, with the hip midway, or on one spot, legs parallel, where the problem is
singular (rank 3 of 4): there the impulses are not unique and only velocities can be compared.
Restitution is Newton's, other than 0 for one foot alone.
"""
import json
import os
from collections import Counter

import numpy as np

from robot import Robot, distinct, impact_solutions

COUNT = 500
TOUCHES = 1e-12      # m
APPROACH = -1e-2     # m/s: the fastest foot approaches at least so fast
TRUNK = 1e-3         # m: least height
ENERGY_GAP = 1e-6    # J: solutions nearer than this leave no clear choice


def draw(rng, robot, index):
    """A random problem as (kind, q, v, friction, restitution)."""
    kind = ('one', 'apart', 'one', 'parallel' if index % 12 == 3 else 'apart')[index % 4]
    restitution = float(rng.choice([0, 0, 0.5, 1])) if kind == 'one' else 0.0
    friction = 0.0 if index % 25 == 7 else float(rng.uniform(0, 2))
    theta, q1, q2 = rng.uniform(-np.pi, np.pi, 3)
    if kind == 'apart':
        q2 = -(theta + q1) - theta
    elif kind == 'parallel':
        q2 = q1
    q = np.array([0, 0, theta, q1, q2])
    v = np.concatenate([rng.uniform(-3, 3, 2), rng.uniform(-6, 6, 3)])
    q[1] = -min(foot[1][1] for foot in robot.points(q, v)[2:])
    return kind, q, v, friction, restitution


def short(values):
    return [float(f"{value:.12g}") for value in values]


def record(solution):
    modes, impulses, after, energy = solution
    return {"modes": modes, "impulses": [short(r) for r in impulses], "v_plus": short(after),
            "energy": short([energy])[0]}


def main():
    rng = np.random.default_rng(20240501)
    robot = Robot(0.535, 0.535, 1.8, 1.8, 5.4)
    problems, skipped = [], Counter()
    while len(problems) < COUNT:
        kind, q, v, friction, restitution = draw(rng, robot, len(problems))
        M, _, feet = robot.dynamics(q, v)
        touching = [k for k in (0, 1) if abs(feet[k][0][1]) < TOUCHES]
        jacobians = [feet[k][1] for k in touching]
        if q[1] < TRUNK or len(touching) != (1 if kind == 'one' else 2) or \
                min(J[1] @ v for J in jacobians) > APPROACH:
            skipped['posture or velocity'] += 1
            continue
        valid = impact_solutions(M, jacobians, v, friction, restitution)
        found = distinct(valid)
        if not found:
            raise RuntimeError(f"no solution at q = {q}, v = {v}, friction {friction}")
        if len(found) > 1 and found[1][3] - found[0][3] < ENERGY_GAP:
            skipped['two solutions of equal energy'] += 1
            continue
        problems.append({
            "q": q.tolist(), "v": v.tolist(), "mu": friction, "e": restitution, "kind": kind,
            "touching": [k + 1 for k in touching], "valid": [s[0] for s in valid],
            "distinct": len(found), "v_plus": found[0][2].tolist(),
            "solutions": [record(s) for s in found]})
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "impacts.json")
    lines = ",\n".join(json.dumps(p) for p in problems)
    with open(path, "w") as file:
        file.write('{"made_by": "/usr/bin/python3 tests/reference/impacts.py", "problems": [\n'
                   + lines + "\n]}\n")
    print("skipped:", dict(skipped))
    print("kind, restitution, distinct solutions:")
    for key, n in sorted(Counter((p["kind"], p["e"], p["distinct"]) for p in problems).items()):
        print("  ", *key, ":", n)
    print("modes of the least energy:",
          dict(Counter(p["solutions"][0]["modes"] for p in problems)))
    print("touching:", dict(Counter(str(p["touching"]) for p in problems)),
          " energy gained:", sum(p["solutions"][0]["energy"] > 1e-9 for p in problems),
          "with e =", sorted({p["e"] for p in problems if p["solutions"][0]["energy"] > 1e-9}))


if __name__ == "__main__":
    main()
