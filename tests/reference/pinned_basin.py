"""Stability domain of the robot pinned at foot 1 (three coordinates, bilateral pin): 64 x 64 labels.

Reduced dynamics from the positions relative to the pin, RK4 with the torques held for 1 ms (one
substep; half a step moves no label). State feedback with the robust gains (Kautsky, Nichols, Van
Dooren as scipy computes them), 10 N m, no noise, 8 s. Labels: s stabilised, f fell, u undecided, by
the outcome rules of the scenario format. Run: python3 pinned_basin.py > pinned_basin.json
"""
import json
import sys

import numpy as np
from scipy.signal import place_poles

G, l, lt, m, mt, mh = 9.81, 0.535, 0.535, 1.8, 1.8, 5.4
LIMIT, T = 10.0, 1e-3


def accelerate(q, v, tau):
    """q, v: (3, n) theta, q1, q2; tau (2, n). Absolute angles th, p1, p2; hip = -l (sin p1, -cos p1)."""
    th, p1, p2 = q[0], q[0] + q[1], q[0] + q[2]
    w, w1, w2 = v[0], v[0] + v[1], v[0] + v[2]
    # in (th, p1, p2): hip moves with p1 alone, d hip/dp1 = -l (cos p1, sin p1)
    M = np.zeros((3, 3) + th.shape)
    M[0, 0] = mt * lt**2
    M[1, 1] = (mt + mh + m) * l**2
    M[2, 2] = m * l**2
    M[0, 1] = M[1, 0] = mt * l * lt * np.cos(th - p1)   # (-l n1).(-lt n)
    M[1, 2] = M[2, 1] = -m * l * l * np.cos(p1 - p2)    # (-l n1).(l n2)
    b = np.zeros((3,) + th.shape)
    # Lagrange: d/dt dT/dw - dT/da
    b[0] = mt * l * lt * np.sin(th - p1) * w1**2 - mt * lt * G * np.sin(th)
    b[1] = (-mt * l * lt * np.sin(th - p1) * w**2 - m * l * l * np.sin(p1 - p2) * w2**2
            - (mt + mh + m) * G * l * np.sin(p1))
    b[2] = m * l * l * np.sin(p1 - p2) * w1**2 + m * G * l * np.sin(p2)
    f = np.array([-(tau[0] + tau[1]), tau[0], tau[1]]) - b
    a = np.linalg.solve(np.moveaxis(M, (0, 1), (-2, -1)), np.moveaxis(f, 0, -1)[..., None])[..., 0]
    a = np.moveaxis(a, -1, 0)
    return np.array([a[0], a[1] - a[0], a[2] - a[0]])


def design():
    th, q2 = -0.41, 0.82
    g2 = l * m * G * np.sin(th + q2)
    g1 = lt * mt * G * np.sin(th) - g2
    q1 = np.arcsin(-g1 / (l * (mt + m + mh) * G)) - th
    q0, u0 = np.array([th, q1, q2]), np.array([g1, g2])
    A, B = np.zeros((6, 6)), np.zeros((6, 2))
    A[:3, 3:] = np.eye(3)
    h = 1e-5
    def f(q, u):
        return accelerate(q[:, None], np.zeros((3, 1)), u[:, None])[:, 0]
    for i in range(3):
        e = np.eye(3)[i] * h
        A[3:, i] = (8 * (f(q0 + e, u0) - f(q0 - e, u0)) - (f(q0 + 2 * e, u0) - f(q0 - 2 * e, u0))) / (12 * h)
    for i in range(2):
        e = np.eye(2)[i]
        B[3:, i] = (f(q0, u0 + e) - f(q0, u0 - e)) / 2
    K = place_poles(A, B, [-3, -3.3, -3.6, -3.9, -4.2, -4.6], method='KNV0', rtol=1e-12,
                    maxiter=5000).gain_matrix
    return q0, u0, K


def label(theta, vtheta, q0, u0, K, substeps=1, horizon=8.0):
    n = theta.size
    q = np.repeat(q0[:, None], n, 1); q[0] += theta
    v = np.zeros((3, n)); v[0] = vtheta
    out = np.full(n, 'u')
    begin, measure = np.full(n, -1.0), np.zeros(n)
    live = np.arange(n)
    for k in range(int(round(horizon / T)) + 1):
        t = k * T
        err = np.maximum(np.max(np.abs(q - q0[:, None]), 0) / 0.05, np.max(np.abs(v), 0) / 0.5)
        hip = l * np.cos(q[0] + q[1])
        fell = (hip < 0.2 * l) | (hip + lt * np.cos(q[0]) <= 0)
        inside = err <= 1
        full = inside & (begin[live] >= 0) & (t - begin[live] >= 0.5 - 1e-9)
        calm = err <= measure[live]
        restart = inside & ((begin[live] < 0) | (full & ~calm))
        out[live[fell]] = 'f'
        out[live[full & calm & ~fell]] = 's'
        begin[live[~inside]] = -1
        begin[live[restart]] = t
        measure[live[restart]] = err[restart]
        keep = ~fell & ~(full & calm)
        live, q, v = live[keep], q[:, keep], v[:, keep]
        if live.size == 0:
            break
        tau = np.clip(u0[:, None] - K[:, :3] @ (q - q0[:, None]) - K[:, 3:] @ v, -LIMIT, LIMIT)
        h = T / substeps
        for _ in range(substeps):
            k1 = accelerate(q, v, tau); v2 = v + h / 2 * k1
            k2 = accelerate(q + h / 2 * v, v2, tau); v3 = v + h / 2 * k2
            k3 = accelerate(q + h / 2 * v2, v3, tau); v4 = v + h * k3
            k4 = accelerate(q + h * v3, v4, tau)
            q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
            v = v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return out


def main():
    q0, u0, K = design()
    th, vt = np.meshgrid(np.linspace(-0.12, 0.06, 64), np.linspace(-0.6, 0.6, 64), indexing='ij')
    labels = label(th.ravel(), vt.ravel(), q0, u0, K).reshape(64, 64)
    fine = np.linspace(-0.12, 0.06, 1801)
    line = label(fine, np.zeros_like(fine), q0, u0, K)
    inside = fine[line == 's']
    json.dump({"equilibrium": q0.tolist(), "torques": u0.tolist(), "gains": K.tolist(),
               "interval": [inside.min(), inside.max()],
               "labels": ["".join(r) for r in labels]}, sys.stdout, indent=1)


main()
