#!/usr/bin/python3
"""Reference figures for the linear designs of tests/test_design.c, by other means than the engine's.

    /usr/bin/python3 tests/reference/design.py         writes tests/reference/design.json

Needs numpy and scipy. The robot is that of control.py: five coordinates, body Jacobians, the pinned
foot by Lagrange multipliers, derivatives by complex steps; the force on the foot is a multiplier of
the same system. What else differs from the engine:
  cost           discretised by Gauss-Legendre quadrature of exp(F't) W exp(F t), not by Van Loan;
  Riccati        scipy.linalg.solve_continuous_are and solve_discrete_are;
  Lyapunov       solve_continuous_lyapunov, solve_discrete_lyapunov (direct method);
  sublevel sets  the largest multiple of the unit sphere, seen through a Cholesky factor;
  sampling       expm of the augmented matrix; T* by Brent's method behind a fine scan, the delayed
                 loop as a difference equation of x and the torques computed one sample before.
"""
import json
import math
import os

import numpy as np
from scipy.linalg import (cholesky, expm, solve_continuous_are, solve_continuous_lyapunov,
                          solve_discrete_are, solve_discrete_lyapunov)
from scipy.optimize import brentq

import control

ROBOTS = [("default", control.DEFAULT), ("uneven", [0.44, 0.37, 1.98, 2.68, 5.6]),
          ("long trunk", [0.51, 0.74, 2.51, 2.46, 7.18]), ("light hip", [0.6, 0.4, 1.2, 3.0, 2.0]),
          ("large", [0.9, 0.8, 6.0, 35.0, 20.0])]
# name, theta, q2, guess of q1: the paper's figure 14
POSTURES = [("balance", -0.41, 0.82, 0.5), ("right angle", math.pi / 2, 0.0, -1.5),
            ("upright", 0.0, 0.0, 0.01)]
WEIGHTS = [1.0, 2.0, 0.5, 0.1, 0.2, 0.3], [0.01, 0.04]
POLES = [-3 + 1j, -3 - 1j, -3.5, -4, -4.5, -5]
T = 0.02
TOLERANCES = [0.05] * 3 + [0.5] * 3  # rad, rad/s
FRICTION = 0.8


def contact_force(robot, support, q, torque):
    """(normal, tangential) by posture and by torque; rates enter with their squares only."""
    def force(y, t):
        _, weight, jacobians = control.masses(robot, y)
        M = sum(m * J.T @ J for m, J in zip(weight, jacobians))
        J = jacobians[2 + support]
        right = np.concatenate([control.statics(robot, support, y, t, np.zeros(2)), np.zeros(2)])
        return np.linalg.solve(np.block([[M, -J.T], [J, np.zeros((2, 2))]]), right)[[6, 5]]
    posture = q[2:].real
    by_posture = control.complex_step(
        lambda y: force(control.on_foot(robot, support, y), torque.astype(complex)), posture)
    by_torque = control.complex_step(lambda t: force(q.astype(complex), t), torque)

    h = 1e-6  # the same by central differences: catches a slip in the use of complex steps
    for i in range(3):
        y, z = posture.copy(), posture.copy()
        y[i] += h
        z[i] -= h
        slope = (force(control.on_foot(robot, support, y), torque.astype(complex)) -
                 force(control.on_foot(robot, support, z), torque.astype(complex))).real / (2 * h)
        assert np.allclose(slope, by_posture[:, i], rtol=1e-6, atol=1e-4)
    return (force(q.astype(complex), torque.astype(complex)).real,
            np.hstack([by_posture, np.zeros((2, 3))]), by_torque)


def sampled_model(A, B, T):
    F = np.zeros((8, 8))
    F[:6, :6], F[:6, 6:] = A, B
    E = expm(F * T)
    return E[:6, :6], E[:6, 6:]


def sampled_cost(A, B, T, Q, R):
    F, W0, W = np.zeros((8, 8)), np.zeros((8, 8)), np.zeros((8, 8))
    F[:6, :6], F[:6, 6:] = A, B
    W0[:6, :6], W0[6:, 6:] = Q, R
    for t, w in zip(*np.polynomial.legendre.leggauss(30)):
        E = expm(F * T * (t + 1) / 2)
        W += w * T / 2 * E.T @ W0 @ E
    return W[:6, :6], W[6:, 6:], W[:6, 6:]


def radius(A, B, K, T, delay):
    Ad, Bd = sampled_model(A, B, T)
    if not delay:
        return max(abs(np.linalg.eigvals(Ad - Bd @ K)))
    # x' = Ad x + Bd w, w' = -K x: columns are the images of unit vectors
    def step(v):
        return np.concatenate([Ad @ v[:6] + Bd @ v[6:], -K @ v[:6]])
    return max(abs(np.linalg.eigvals(np.array([step(e) for e in np.eye(8)]).T)))


def critical(A, B, K, delay):
    t = 5e-4
    while radius(A, B, K, t, delay) < 1:
        t += 5e-4
        if t > 10:
            return None
    if t == 5e-4:
        return None
    return brentq(lambda s: radius(A, B, K, s, delay) - 1, t - 5e-4, t, xtol=1e-15, rtol=1e-14)


def sublevel(P, K, torque, limit, by_state, by_torque, weight):
    """Half spaces a x <= d in the engine's order of `stance design`; their level and the least."""
    normal, tangential = by_state - by_torque @ K
    rows = []
    for k, t in zip(K, torque):
        rows += [(-k, limit - t), (k, limit + t)]
    rows += [(s * tangential - FRICTION * normal, FRICTION * weight) for s in (1, -1)]
    rows += [(-normal, weight)]
    L = cholesky(P, lower=True)
    levels = []
    for a, d in rows:
        y = np.linalg.solve(L, a)
        reach = np.linalg.norm(y)
        levels.append(0.0 if d <= 0 else None if reach < 1e-12 else (d / reach)**2)
    return rows, levels


def cplx(z):
    return [[complex(v).real, complex(v).imag] for v in z]


def main():
    out = []
    Q, R = np.diag(WEIGHTS[0]), np.diag(WEIGHTS[1])
    S = np.diag([1 / t**2 for t in TOLERANCES])
    for index, (robot_name, robot) in enumerate(ROBOTS):
        for name, theta, q2, guess in POSTURES:
            support = index % 2
            given = (theta, None, q2) if support == 0 else (theta, q2, None)
            q, torque, _ = control.equilibrium(robot, support, given, guess)
            A, B = control.linearise(robot, support, q, torque)
            force, by_state, by_torque = contact_force(robot, support, q, torque)
            X = solve_continuous_are(A, B, Q, R)
            K = np.linalg.solve(R, B.T @ X)
            Ad, Bd = sampled_model(A, B, T)
            Qd, Rd, Sd = sampled_cost(A, B, T, Q, R)
            Xd = solve_discrete_are(Ad, Bd, Qd, Rd, s=Sd)
            Kd = np.linalg.solve(Rd + Bd.T @ Xd @ Bd, (Sd + Ad.T @ Xd @ Bd).T)
            P = solve_continuous_lyapunov((A - B @ K).T, -S)
            Pd = solve_discrete_lyapunov((Ad - Bd @ Kd).T, S, method="direct")
            limit = 1.5 * max(10, *abs(torque))
            rows, levels = sublevel(P, K, torque, limit, by_state, by_torque, force[0])
            kalman = np.hstack([np.linalg.matrix_power(A / 5, k) @ B for k in range(6)])
            record = {
                "name": f"{robot_name}, {name}", "robot": robot, "support": support,
                "given": list(given), "force": force.tolist(), "by_state": by_state.tolist(),
                "by_torque": by_torque.tolist(),
                "rank": int(np.linalg.matrix_rank(kalman, tol=1e-9 * np.linalg.norm(kalman, 2))),
                "state_weights": WEIGHTS[0], "torque_weights": WEIGHTS[1], "sample_time": T,
                "gain": K.tolist(), "eigenvalues": cplx(np.linalg.eigvals(A - B @ K)),
                "sampled_gain": Kd.tolist(),
                "sampled_eigenvalues": cplx(np.linalg.eigvals(Ad - Bd @ Kd)),
                "poles": cplx(POLES), "sampled_poles": cplx(np.exp(np.array(POLES) * T)),
                "critical": [critical(A, B, K, delay) for delay in (0, 1)],
                "sampled_critical": [critical(A, B, Kd, delay) for delay in (0, 1)],
                "delayed_radius": radius(A, B, Kd, T, 1),
                "tolerances": TOLERANCES, "lyapunov": P.tolist(), "sampled_lyapunov": Pd.tolist(),
                "torque_limit": limit, "friction": FRICTION, "levels": levels,
            }
            out.append(record)
            print(f"{record['name']}: rank {record['rank']}, gain {K[0, 0]:.5f}, sampled "
                  f"{Kd[0, 0]:.5f}, T* {record['critical']}, level {min(x for x in levels if x is not None):.5f}")
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "design.json")
    with open(path, "w") as file:
        json.dump({"made_by": "/usr/bin/python3 tests/reference/design.py", "cases": out}, file,
                  indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
