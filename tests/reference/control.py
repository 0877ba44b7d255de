#!/usr/bin/python3
"""Reference figures for tests/test_control.c, by other means than the engine's.

    /usr/bin/python3 tests/reference/control.py        writes tests/reference/control.json

Needs numpy and scipy. What differs from the engine:
  dynamics       all five coordinates of the paper's q, inertia from geometric Jacobians of the
                 five masses, the pinned foot by Lagrange multipliers (a saddle-point system);
  equilibrium    Newton's method on the five static equations, for the unknown angle, both torques
                 and both components of the ground's force;
  derivatives    complex steps along the pinned manifold: exact to rounding;
  gains          scipy.signal.place_poles: KNV0 for real poles, YT where there are pairs, in several
                 rotated state spaces. The determinant of the unit eigenvectors does not see a
                 rotation, but the starting point does: so all maxima are met. Of equally high ones
                 the gain of larger norm is kept, which is the engine's documented choice;
  sampling       scipy.linalg.expm of the augmented matrix, Brent's method behind a fine scan.
"""
import json
import math
import os
import warnings

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.signal import place_poles

G = 9.81
PAPER_POLES = [-3, -3.3, -3.6, -3.9, -4.2, -4.6]
PAIR_POLES = [-3 + 2j, -3 - 2j, -3.5, -4 + 1j, -4 - 1j, -5]


def masses(robot, q):
    """Positions [5][2], masses [5], Jacobians [5][2][5] of trunk, hip, foot 1, foot 2."""
    l, lt, m, mt, mh = robot
    x, z, theta = q[0], q[1], q[2]
    trunk = np.array([x, z])
    hip = trunk - lt * np.array([-np.sin(theta), np.cos(theta)])
    feet = [hip + l * np.array([np.sin(theta + qi), -np.cos(theta + qi)]) for qi in q[3:]]

    def turned(r):  # derivative of a vector by its angle
        return np.array([-r[1], r[0]])

    def jacobian(point, leg=None):
        J = np.zeros((2, 5), dtype=complex)
        J[0, 0] = J[1, 1] = 1
        J[:, 2] = turned(point - trunk)
        if leg is not None:
            J[:, 3 + leg] = turned(point - hip)
        return J

    points = [trunk, hip, feet[0], feet[1]]
    jacobians = [jacobian(trunk), jacobian(hip), jacobian(feet[0], 0), jacobian(feet[1], 1)]
    return points, [mt, mh, m, m], jacobians


def statics(robot, support, q, torque, force):
    """Residual of the five static equations."""
    _, weight, jacobians = masses(robot, q)
    total = np.concatenate([np.zeros(3), torque]).astype(complex)
    for m, J in zip(weight, jacobians):
        total = total + J.T @ np.array([0, -m * G])
    return total + jacobians[2 + support].T @ force


def on_foot(robot, support, posture):
    """q with the support foot at the origin; complex postures are welcome."""
    q = np.concatenate([np.zeros(2), posture]).astype(complex)
    points, _, _ = masses(robot, q)
    q[:2] = -points[2 + support]
    return q


def complex_step(f, x):
    h = 1e-40
    columns = []
    for i in range(len(x)):
        y = np.array(x, dtype=complex)
        y[i] += 1j * h
        columns.append(f(y).imag / h)
    return np.array(columns).T


def equilibrium(robot, support, given, guess):
    unknown = [i for i in range(3) if given[i] is None]
    assert len(unknown) == 1

    def residual(u):
        posture = np.array([0 if g is None else g for g in given], dtype=complex)
        posture[unknown[0]] = u[0]
        return statics(robot, support, on_foot(robot, support, posture), u[1:3], u[3:5])

    u = np.array([guess, 0, 0, 0, G * (2 * robot[2] + robot[3] + robot[4])], dtype=float)
    for _ in range(50):
        step = np.linalg.solve(complex_step(residual, u), residual(u.astype(complex)).real)
        u = u - step
    assert np.max(abs(step)) < 1e-11, step
    posture = np.array([u[0] if g is None else g for g in given])
    return on_foot(robot, support, posture).real, u[1:3], u[3:5]


def accelerations(robot, support, q, torque):
    """From rest, foot pinned: [M -J^T; J 0] [q''; force] = [forces; 0]."""
    _, weight, jacobians = masses(robot, q)
    M = sum(m * J.T @ J for m, J in zip(weight, jacobians))
    J = jacobians[2 + support]
    right = np.concatenate([statics(robot, support, q, torque, np.zeros(2)), np.zeros(2)])
    saddle = np.block([[M, -J.T], [J, np.zeros((2, 2))]])
    return np.linalg.solve(saddle, right)[2:5]


def linearise(robot, support, q, torque):
    posture = q[2:].real
    by_posture = complex_step(
        lambda y: accelerations(robot, support, on_foot(robot, support, y), torque), posture)
    by_torque = complex_step(lambda t: accelerations(robot, support, q.astype(complex), t), torque)
    A, B = np.zeros((6, 6)), np.zeros((6, 2))
    A[:3, 3:] = np.eye(3)
    A[3:, :3] = by_posture
    B[3:] = by_torque
    return A, B


def eigenvectors(A, B, K):
    X = np.linalg.eig(A - B @ K)[1]
    return abs(np.linalg.det(X)), np.linalg.cond(X)


def place(A, B, poles, sweeps, tries, rng):
    """The best gain and whether others of another norm are as good."""
    method = "YT" if np.iscomplexobj(np.array(poles)) else "KNV0"
    found = []
    for k in range(tries):
        Q = np.eye(6) if k == 0 else np.linalg.qr(rng.standard_normal((6, 6)))[0]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            K = place_poles(Q @ A @ Q.T, Q @ B, poles, method=method, rtol=0,
                            maxiter=sweeps).gain_matrix @ Q
        found.append((eigenvectors(A, B, K), K))
    highest = max(f[0][0] for f in found)
    best = [f for f in found if f[0][0] > highest * (1 - 1e-7)]
    best.sort(key=lambda f: -np.linalg.norm(f[1]))
    norms = [float(np.linalg.norm(f[1])) for f in best]
    return best[0][1], best[0][0][1], norms


def critical_sample_time(A, B, K):
    augmented = np.zeros((8, 8))
    augmented[:6, :6], augmented[:6, 6:] = A, B

    def excess(T):
        E = expm(augmented * T)
        return max(abs(np.linalg.eigvals(E[:6, :6] - E[:6, 6:] @ K))) - 1

    T = 5e-4
    while excess(T) < 0:
        T += 5e-4
    return brentq(excess, T - 5e-4, T, xtol=1e-15, rtol=1e-14)


DEFAULT = [0.535, 0.535, 1.8, 1.8, 5.4]
HALF_PI = math.pi / 2
# name, robot, support, (theta, q1, q2), lower, guess of the unknown, poles, sweeps, tries
CASES = [
    ("default", DEFAULT, 0, (-0.41, None, 0.82), False, 0.57, PAPER_POLES, 800, 8),
    ("default, q2 unknown", DEFAULT, 0, (-0.41, 0.55, None), False, 0.8, PAPER_POLES, 800, 8),
    ("default, theta unknown", DEFAULT, 0, (None, 0.5, 0.9), False, -0.3, PAPER_POLES, 800, 8),
    ("second foot", DEFAULT, 1, (-0.41, 0.82, None), False, 0.57, PAPER_POLES, 800, 8),
    ("uneven robot", [0.44, 0.37, 1.98, 2.68, 5.6], 0, (0.515, None, -0.352), False, -0.6,
     PAPER_POLES, 2500, 8),
    ("long trunk, second foot", [0.51, 0.74, 2.51, 2.46, 7.18], 1, (-0.199, -0.386, None), False,
     0.14, PAPER_POLES, 2500, 8),
    ("light hip", [0.6, 0.4, 1.2, 3.0, 2.0], 0, (-0.25, None, 0.5), False, 0.3, PAPER_POLES, 2500,
     8),
    ("free leg up", DEFAULT, 0, (-0.1, 0.2, None), True, 3.0, PAPER_POLES, 2500, 8),
    ("complex pairs", DEFAULT, 0, (-0.41, None, 0.82), False, 0.57, PAIR_POLES, 3000, 12),
    ("complex pairs, uneven robot", [0.44, 0.37, 1.98, 2.68, 5.6], 1, (0.515, -0.352, None), False,
     -0.6, PAIR_POLES, 3000, 12),
    ("upright", DEFAULT, 0, (0.0, None, 0.0), False, 0.01, PAPER_POLES, 1500, 8),
    ("right angle", DEFAULT, 0, (HALF_PI, None, 0.0), False, -1.5, PAPER_POLES, 8000, 2),
]


def main():
    rng = np.random.default_rng(20)
    out = []
    for name, robot, support, given, lower, guess, poles, sweeps, tries in CASES:
        q, torque, force = equilibrium(robot, support, given, guess)
        A, B = linearise(robot, support, q, torque)
        K, condition, norms = place(A, B, poles, sweeps, tries, rng)
        w = np.linalg.eigvals(A)
        kalman = np.hstack([np.linalg.matrix_power(A, k) @ B for k in range(6)])
        record = {
            "name": name, "robot": robot, "support": support, "given": list(given),
            "lower": lower, "position": q.tolist(), "torque": torque.tolist(),
            "force": force.tolist(), "A": A.tolist(), "B": B.tolist(),
            "eigenvalues": [[e.real, e.imag] for e in w],
            "rank": int(np.linalg.matrix_rank(kalman)),
            "poles": [[complex(p).real, complex(p).imag] for p in poles],
            # robust gains at the right angle are too flat a maximum to be compared as numbers
            "compare_gain": name != "right angle",
            "gain": K.tolist(), "condition": condition,
            "critical_sample_time": critical_sample_time(A, B, K),
        }
        out.append(record)
        print(f"{name}: gains {K[0, 0]:.4f} {K[1, 0]:.4f}, condition {condition:.4f}, "
              f"T* {record['critical_sample_time']:.9f}, norms met {sorted(set(np.round(norms, 3)))}")
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "control.json")
    with open(path, "w") as file:
        json.dump({"made_by": "/usr/bin/python3 tests/reference/control.py", "cases": out}, file,
                  indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
