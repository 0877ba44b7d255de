"""Event-driven reference of both drops: DOP853 at rtol 1e-12 between events, impacts solved exactly.

Modes of each foot: open, stick, slip forward (f), slip backward (b). Run: python3 drop.py > drop.json
"""
import itertools
import json

import numpy as np
from scipy.integrate import solve_ivp

from robot import Robot, distinct, impact_solutions


class Drop:
    def __init__(self, robot, mu, kp, kd, q0):
        self.robot, self.mu, self.kp, self.kd, self.q0 = robot, mu, kp, kd, np.array(q0, float)

    def accelerate(self, q, v, modes):
        """Acceleration and (N, T) of each foot in given modes."""
        M, bias, feet = self.robot.dynamics(q, v)
        tau = np.zeros(5)
        tau[3:] = -self.kp * (q[3:] - self.q0[3:]) - self.kd * v[3:]
        rows, columns, want = [], [], []
        for (_, J, jv), mode in zip(feet, modes):
            if mode == 'o':
                continue
            rows.append(J[1]); want.append(-jv[1])
            if mode == 's':
                rows.append(J[0]); want.append(-jv[0])
                columns += [J[1], J[0]]
            else:
                columns.append(J[1] + (-self.mu if mode == 'f' else self.mu) * J[0])
        n = len(rows)
        K = np.zeros((5 + n, 5 + n))
        K[:5, :5] = M
        rhs = np.concatenate([tau - bias, want])
        if n:
            K[:5, 5:] = -np.array(columns).T
            K[5:, :5] = np.array(rows)
        x, *_ = np.linalg.lstsq(K, rhs, rcond=None) if n == 4 else (np.linalg.solve(K, rhs),)
        forces, i = [], 5
        for mode in modes:
            if mode == 'o':
                forces.append((0.0, 0.0))
            elif mode == 's':
                forces.append((x[i], x[i + 1])); i += 2
            else:
                forces.append((x[i], (-self.mu if mode == 'f' else self.mu) * x[i])); i += 1
        return x[:5], forces, feet

    def choose(self, q, v, closed):
        """The modes that the accelerations are consistent with."""
        options = []
        _, _, feet = self.robot.dynamics(q, v)
        for c, (_, J, _) in zip(closed, feet):
            vt, vn = J[0] @ v, J[1] @ v
            if not c or vn > 1e-9:
                options.append('o')
            elif abs(vt) < 1e-8:
                options.append('sfbo')
            else:
                options.append('fo' if vt > 0 else 'bo')
        for modes in itertools.product(*options):
            a, forces, feet = self.accelerate(q, v, modes)
            ok = True
            for k, mode in enumerate(modes):
                _, J, jv = feet[k]
                an, at = J[1] @ a + jv[1], J[0] @ a + jv[0]
                N, T = forces[k]
                vt = J[0] @ v
                if mode == 'o':
                    ok &= not closed[k] or J[1] @ v > 1e-9 or an > -1e-9
                else:
                    ok &= N >= -1e-9
                    if mode == 's':
                        ok &= abs(T) <= self.mu * N + 1e-9
                    elif abs(vt) < 1e-8:
                        ok &= at > 0 if mode == 'f' else at < 0
            if ok:
                return modes
        raise RuntimeError("no consistent mode")

    def run(self, v0, end, sample):
        t, y = 0.0, np.concatenate([self.q0, v0])
        modes, events, out = ('o', 'o'), [], []
        times = np.arange(0, end + sample / 2, sample)
        nxt = 0
        while t < end:
            def rhs(_, y, modes=modes):
                a, _, _ = self.accelerate(y[:5], y[5:], modes)
                return np.concatenate([y[5:], a])

            def watch(k, kind, modes=modes):
                def f(_, y):
                    q, v = y[:5], y[5:]
                    if kind == 'gap':
                        return self.robot.points(q, v)[2 + k][1][1]
                    if kind == 'slip':
                        return self.robot.points(q, v)[2 + k][2][0] @ v
                    N, T = self.accelerate(q, v, modes)[1][k]
                    return N if kind == 'normal' else self.mu * N - abs(T)
                f.terminal = True
                # a slip that has just begun starts from zero: only its end counts
                f.direction = 1 if kind == 'slip' and modes[k] == 'b' else -1
                f.what = (k, kind)
                return f

            watches = []
            for k, mode in enumerate(modes):
                if mode == 'o':
                    watches.append(watch(k, 'gap'))
                else:
                    watches.append(watch(k, 'normal'))
                    watches.append(watch(k, 'margin' if mode == 's' else 'slip'))
            s = solve_ivp(rhs, (t, end), y, method='DOP853', rtol=1e-12, atol=1e-13,
                          events=watches, dense_output=True, max_step=2e-3)
            while nxt < len(times) and times[nxt] <= s.t[-1] + 1e-15:
                out.append(s.sol(times[nxt])); nxt += 1
            t, y = s.t[-1], s.y[:, -1].copy()
            if s.status == 0:
                break
            k, kind = [w.what for w, te in zip(watches, s.t_events) if len(te)][0]
            q, v = y[:5], y[5:]
            closed = [m != 'o' for m in modes]
            if kind == 'gap':
                closed[k] = True
                M, _, feet = self.robot.dynamics(q, v)
                touching = [J for (_, J, _), c in zip(feet, closed) if c]
                solutions = distinct(impact_solutions(M, touching, v, self.mu))
                v = solutions[0][2]
            elif kind == 'normal':
                closed[k] = False
            elif kind == 'slip':  # comes to rest: exactly zero, so that sticking is considered
                _, _, feet = self.robot.dynamics(q, v)
                J = feet[k][1][0]
                M = self.robot.dynamics(q, v)[0]
                Mi = np.linalg.inv(M)
                v = v - Mi @ J * (J @ v) / (J @ Mi @ J)
            y[5:] = v
            if kind == 'margin':  # stick ends: the direction follows from the force that held
                T = self.accelerate(q, v, modes)[1][k][1]
                modes = tuple(('b' if T > 0 else 'f') if j == k else m for j, m in enumerate(modes))
            else:
                modes = self.choose(q, v, closed)
            events.append({"t": t, "foot": k + 1, "kind": kind, "modes": ''.join(modes)})
        return events, times, np.array(out)


def state(times, path, t):
    i = int(round(t / (times[1] - times[0])))
    return {"q": path[i, :5].tolist(), "v": path[i, 5:].tolist()}


second = Drop(Robot(0.5, 0.5, 1, 1, 3), 0.3, 200, 20, [0, 1.5, -0.5, 0.9, -1])
ev2, times, path = second.run([1, 0, 0, 0, 0], 1.2, 1e-3)
first = Drop(Robot(0.535, 0.535, 1.8, 1.8, 5.4), 0.5, 500, 50, [0, 1.5, -0.5, 0.9, -1])
ev1, times1, path1 = first.run([2, 0, 0, 0, 0], 0.87, 1e-3)
print(json.dumps({
    "second": {"events": ev2,
               "states": {f"{k/10:.1f}": state(times, path, k / 10) for k in range(1, 13)},
               "velocity_1ms": [[float(f"{x:.9g}") for x in row] for row in path[:, 5:]]},
    "first": {"events": ev1}}))
