#!/usr/bin/python3
"""Event-driven reference of two drops, for the tests of the stepping methods.

    /usr/bin/python3 tests/reference/drop.py        writes tests/reference/drop.json

Coordinates are the paper's q = (x, z, theta, q1, q2). Between events the motion in a fixed contact
mode is a smooth differential equation, with the contact forces as multipliers of a saddle-point
system on accelerations; DOP853 integrates it (rtol 1e-12, atol 1e-13) and each event is located on
its dense output. Impacts (e = 0) are solved exactly, by enumeration with the inertia of the instant
(robot.impact_solutions). After an event the next mode is the one whose accelerations and forces
obey Signorini's and Coulomb's laws; another one that does too, with other accelerations, stops the
program. The servo tau_i = -kp (q_i - q_i(0)) - kd q_i' acts continuously.

Modes, one letter a foot: o open, s stick, f slips forward (+x), b slips backward.
"""
import itertools
import json
import os

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from robot import Robot, distinct, impact_solutions

RTOL, ATOL, MAX_STEP = 1e-12, 1e-13, 2e-3
SPEED_ZERO = 1e-8  # m/s: below it a foot counts as at rest when a mode is chosen
LAW = 1e-8         # N, m/s^2: admitted violation when a mode is chosen
SIDE = {'f': -1.0, 'b': 1.0}  # sign of the friction force


class Drop:
    def __init__(self, robot, friction, kp, kd, q0, v0):
        self.robot, self.friction, self.kp, self.kd = robot, friction, kp, kd
        self.q0, self.v0 = np.array(q0, float), np.array(v0, float)

    def accelerate(self, q, v, modes):
        """Accelerations, [(normal, tangential) force of each foot], feet as robot.dynamics."""
        M, bias, feet = self.robot.dynamics(q, v)
        torque = np.zeros(5)
        torque[3:] = -self.kp * (q[3:] - self.q0[3:]) - self.kd * v[3:]
        rows, columns, want, place = [], [], [], []
        for (_, J, jv), mode in zip(feet, modes):
            place.append(5 + len(columns))
            if mode == 'o':
                continue
            rows.append(J[1])
            want.append(-jv[1])
            if mode == 's':
                rows.append(J[0])
                want.append(-jv[0])
                columns += [J[1], J[0]]
            else:
                columns.append(J[1] + SIDE[mode] * self.friction * J[0])
        n = len(rows)
        saddle = np.zeros((5 + n, 5 + n))
        saddle[:5, :5] = M
        if n:
            saddle[:5, 5:] = -np.array(columns).T
            saddle[5:, :5] = np.array(rows)
        x = np.linalg.solve(saddle, np.concatenate([torque - bias, want]))
        forces = []
        for mode, i in zip(modes, place):
            if mode == 'o':
                forces.append((0.0, 0.0))
            elif mode == 's':
                forces.append((x[i], x[i + 1]))
            else:
                forces.append((x[i], SIDE[mode] * self.friction * x[i]))
        return x[:5], forces, feet

    def lawful(self, q, v, closed, modes):
        """Accelerations in these modes where they obey the contact laws, else None."""
        a, forces, feet = self.accelerate(q, v, modes)
        for (_, J, jv), mode, (N, T), touches in zip(feet, modes, forces, closed):
            apart = not touches or J[1] @ v > SPEED_ZERO
            slip = J[0] @ v
            if mode == 'o':
                if not apart and J[1] @ a + jv[1] < -LAW:
                    return None
                continue
            if apart or N < -LAW:
                return None
            if mode == 's':
                if abs(slip) > SPEED_ZERO or abs(T) > self.friction * N + LAW:
                    return None
                continue
            # a slip that is to begin is judged by its acceleration, one under way by its speed
            along = slip if abs(slip) > SPEED_ZERO else J[0] @ a + jv[0]
            if along * SIDE[mode] > 0:
                return None
        return a

    def choose(self, q, v, closed):
        found = []
        for modes in itertools.product('osfb', repeat=2):
            a = self.lawful(q, v, closed, modes)
            if a is not None and all(np.max(np.abs(a - b)) > 1e-5 for b, _ in found):
                found.append((a, modes))
        if len(found) != 1:
            raise RuntimeError(f"{len(found)} lawful modes at q = {q}, v = {v}")
        return found[0][1]

    def watches(self, modes):
        """Event functions of a mode, each with what = (foot, kind)."""
        def watch(foot, kind, direction, value):
            def f(_, y):
                return value(y[:5], y[5:])
            f.terminal, f.direction, f.what = True, direction, (foot, kind)
            return f

        out = []
        for k, mode in enumerate(modes):
            def gap(q, v, k=k):
                return self.robot.points(q, v)[2 + k][1][1]

            def slip(q, v, k=k):
                return self.robot.points(q, v)[2 + k][2][0] @ v

            def normal(q, v, k=k):
                return self.accelerate(q, v, modes)[1][k][0]

            def margin(q, v, k=k):
                N, T = self.accelerate(q, v, modes)[1][k]
                return self.friction * N - abs(T)

            if mode == 'o':
                out.append(watch(k, 'touchdown', -1, gap))
                continue
            out.append(watch(k, 'lift-off', -1, normal))
            if mode == 's':
                out.append(watch(k, 'slip begins', -1, margin))
            else:  # a slip that has just begun starts from zero: only its end counts
                out.append(watch(k, 'slip ends', int(SIDE[mode]), slip))
        return out

    def after(self, foot, kind, q, v, modes):
        """Velocity and modes after an event."""
        if kind in ('slip begins', 'lift-off'):  # accelerations are continuous: one letter changes
            T = self.accelerate(q, v, modes)[1][foot][1]
            letter = 'o' if kind == 'lift-off' else 'b' if T > 0 else 'f'
            return v, tuple(letter if k == foot else m for k, m in enumerate(modes))
        closed = [m != 'o' or k == foot for k, m in enumerate(modes)]
        M, _, feet = self.robot.dynamics(q, v)
        if kind == 'touchdown':
            touching = [J for (_, J, _), c in zip(feet, closed) if c]
            solutions = distinct(impact_solutions(M, touching, v, self.friction))
            if len(solutions) != 1:
                raise RuntimeError(f"{len(solutions)} solutions of the impact at q = {q}, v = {v}")
            v = solutions[0][2]
        else:  # exactly at rest, so that sticking is considered
            row = feet[foot][1][0]
            response = np.linalg.solve(M, row)
            v = v - response * (row @ v) / (row @ response)
        return v, self.choose(q, v, closed)

    def run(self, end, sample):
        """Events; times [n] and states [n][10] every `sample` seconds; instants at which x' = 0."""
        t, y, modes = 0.0, np.concatenate([self.q0, self.v0]), ('o', 'o')
        times = np.minimum(np.arange(round(end / sample) + 1) * sample, end)
        events, path, turns = [], [], []
        while True:
            watches = self.watches(modes)
            s = solve_ivp(lambda _, y: np.concatenate([y[5:], self.accelerate(y[:5], y[5:],
                                                                              modes)[0]]),
                          (t, end), y, method='DOP853', rtol=RTOL, atol=ATOL, events=watches,
                          dense_output=True, max_step=MAX_STEP)
            if s.status < 0:
                raise RuntimeError(s.message)
            path += [s.sol(at) for at in times[len(path):] if at <= s.t[-1]]
            turns += [brentq(lambda at: s.sol(at)[5], a, b, xtol=1e-14)
                      for a, b, va, vb in zip(s.t, s.t[1:], s.y[5], s.y[5, 1:]) if va * vb < 0]
            if s.status == 0:
                break
            t, y = s.t[-1], s.y[:, -1].copy()
            foot, kind = next(w.what for w, at in zip(watches, s.t_events) if len(at))
            before = y.copy()
            y[5:], modes = self.after(foot, kind, y[:5], y[5:], modes)
            events.append({"t": t, "foot": foot + 1, "kind": kind, "modes": ''.join(modes),
                           "q": y[:5].tolist(), "v_before": before[5:].tolist(),
                           "v": y[5:].tolist()})
        return events, times, np.array(path), turns


def tenths(times, path):
    """States at 0.1, 0.2, ... s."""
    rows = [k for k in range(1, len(times)) if abs(10 * times[k] - round(10 * times[k])) < 1e-9]
    return {f"{times[k]:.1f}": {"q": path[k, :5].tolist(), "v": path[k, 5:].tolist()} for k in rows}


def short(rows):
    return [[float(f"{value:.9g}") for value in row] for row in rows]


def main():
    start = [0, 1.5, -0.5, 0.9, -1]
    second = Drop(Robot(0.5, 0.5, 1, 1, 3), 0.3, 200, 20, start, [1, 0, 0, 0, 0])
    first = Drop(Robot(0.535, 0.535, 1.8, 1.8, 5.4), 0.5, 500, 50, start, [2, 0, 0, 0, 0])
    out = {"made_by": "/usr/bin/python3 tests/reference/drop.py"}
    for name, drop in (("second", second), ("first", first)):
        events, times, path, turns = drop.run(1.2, 1e-3)
        out[name] = {
            "robot": {"leg_length": drop.robot.l, "trunk_length": drop.robot.lt,
                      "foot_mass": drop.robot.m, "trunk_mass": drop.robot.mt,
                      "hip_mass": drop.robot.mh},
            "friction": drop.friction, "kp": drop.kp, "kd": drop.kd,
            "position": drop.q0.tolist(), "velocity": drop.v0.tolist(),
            "events": events, "x_turns": turns, "states": tenths(times, path)}
        if name == "second":
            out[name]["position_1ms"] = short(path[:, :5])
            out[name]["velocity_1ms"] = short(path[:, 5:])
        print(name)
        for e in events:
            print(f"  {e['t']:.9f} s  foot {e['foot']} {e['kind']:12s} -> {e['modes']}")
        print("  x turns at", [round(t, 9) for t in turns])
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "drop.json")
    text = json.dumps(out)  # whole before the file is opened: a failure leaves the old one
    with open(path, "w") as file:
        file.write(text + "\n")


if __name__ == "__main__":
    main()
