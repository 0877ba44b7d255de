"""500 frictional impacts solved exactly by enumeration. Run: python3 impacts.py > impacts.json"""
import json

import numpy as np

from robot import Robot, distinct, impact_solutions

rng = np.random.default_rng(20240501)
robot = Robot(0.535, 0.535, 1.8, 1.8, 5.4)
problems = []
while len(problems) < 500:
    both = len(problems) % 2 == 1
    e = 0.0 if both else float(rng.choice([0, 0, 0.5, 1]))
    mu = float(rng.uniform(0, 2))
    th, q1, q2 = rng.uniform(-np.pi, np.pi, 3)
    if both:  # feet at equal height: phi2 = -phi1
        q2 = -(th + q1) - th
    q = np.array([0, 0, th, q1, q2])
    v = np.concatenate([rng.uniform(-3, 3, 2), rng.uniform(-6, 6, 3)])
    low = min(p[1] for _, p, _, _ in robot.points(q, v)[2:])
    if robot.points(q, v)[0][1][1] <= low:  # the trunk would lie on the ground: fallen
        continue
    q[1] = -low
    M, _, feet = robot.dynamics(q, v)
    touching = [J for p, J, _ in feet if p[1] < 1e-9]
    if len(touching) != (2 if both else 1) or min(J[1] @ v for J in touching) > -1e-2:
        continue
    found = distinct(impact_solutions(M, touching, v, mu, e))
    if not found or (len(found) > 1 and found[1][3] - found[0][3] < 1e-6):
        continue
    best = found[0]
    problems.append({
        "q": q.tolist(), "v": v.tolist(), "mu": mu, "e": e, "modes": best[0],
        "v_plus": best[2].tolist(), "energy": best[3], "distinct": len(found)})
print(json.dumps({"problems": problems}))
