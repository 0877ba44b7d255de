#!/usr/bin/env python3
"""The passive compass gait by an independent program: its limit cycle and that cycle's eigenvalues.

Two straight legs of length l to the centres of round feet of radius r (0: points), a mass m at c below
the hip in each, a mass M at the hip; on a slope g down which it walks, all in the slope's axes. Angles
t1 (of the leg that stands) and t2 against the slope's normal, positive where the foot is ahead of the
hip. The foot that stands rolls:

    hip = (-r t1 - l sin t1, r + l cos t1),    mass of leg i = hip + c (sin ti, -cos ti).

Swing: Lagrange's equations from these points' Jacobians, by Dormand and Prince's formula of order 8 to
1e-13. It ends where both centres are level again with the swing foot ahead, t1 + t2 = 0 < t2. Impact:
plastic, without slip, in the coordinates of hip and both angles; the other foot leaves. The fixed point
of the map from step to step by Newton's iteration, its derivative by central differences of order 6: steps
are good to 1e-14 or so, the differences to 1e-10.

Compared with `stance run` of the same walker (ground.lands: ahead), begun on the cycle after a part of
the step: the state a period later; the derivative of that state by the one it begins with, whose
eigenvalues are those of the map and 1.

    compass_oracle.py STANCE      speaks TAP, without numbers
"""
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from scipy.integrate import solve_ivp


def ends(_, t):
    """The strike: behind the foot that stands the other one passes as it likes."""
    return t[0] + t[1] if t[1] > 0 else 1.0


ends.terminal, ends.direction = True, -1


class Walker:
    def __init__(self, leg, centre, mass, hip, radius, slope, gravity=9.81):
        self.l, self.c, self.m, self.M, self.r, self.slope, self.g = leg, centre, mass, hip, radius, slope, gravity

    def points(self, t):
        """(mass, Jacobian by t, acceleration without t'') of hip, leg 1, leg 2 at t = (t1, t2, t1', t2')."""
        (s1, s2), (c1, c2), (v1, v2) = np.sin(t[:2]), np.cos(t[:2]), t[2:]
        hip = np.array([[-self.r - self.l * c1, 0], [-self.l * s1, 0]])
        bias = np.array([self.l * s1, -self.l * c1]) * v1**2
        one = hip + self.c * np.array([[c1, 0], [s1, 0]])
        two = hip + self.c * np.array([[0, c2], [0, s2]])
        return ((self.M, hip, bias),
                (self.m, one, bias + self.c * np.array([-s1, c1]) * v1**2),
                (self.m, two, bias + self.c * np.array([-s2, c2]) * v2**2))

    def rates(self, _, t):
        weight = self.g * np.array([np.sin(self.slope), -np.cos(self.slope)])
        A = sum(m * J.T @ J for m, J, _ in self.points(t))
        F = sum(m * J.T @ (weight - bias) for m, J, bias in self.points(t))
        return np.concatenate([t[2:], np.linalg.solve(A, F)])

    def impact(self, t):
        """After the swing foot struck, with the legs' parts exchanged; and how fast the other leaves."""
        (s1, s2), (c1, c2) = np.sin(t[:2]), np.cos(t[:2])
        points = [(self.M, np.array([[1, 0, 0, 0], [0, 1, 0, 0]])),
                  (self.m, np.array([[1, 0, self.c * c1, 0], [0, 1, self.c * s1, 0]])),
                  (self.m, np.array([[1, 0, 0, self.c * c2], [0, 1, 0, self.c * s2]]))]
        A = sum(m * J.T @ J for m, J in points)
        foot = [np.array([[1, 0, self.l * c1 + self.r, 0], [0, 1, self.l * s1, 0]]),
                np.array([[1, 0, 0, self.l * c2 + self.r], [0, 1, 0, self.l * s2]])]
        before = np.array([(-self.r - self.l * c1) * t[2], -self.l * s1 * t[2], t[2], t[3]])
        K = np.block([[A, -foot[1].T], [foot[1], np.zeros((2, 2))]])
        after = np.linalg.solve(K, np.concatenate([A @ before, [0, 0]]))
        return np.array([t[1], t[0], after[3], after[2]]), foot[0][1] @ after[:4]

    def go(self, t, seconds):
        return solve_ivp(self.rates, (0, seconds), t, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]

    def swing(self, t):
        """To the end of the step: (state there, s)."""
        out = solve_ivp(self.rates, (0, 3 * np.sqrt(9.81 / self.g)), t, method="DOP853", rtol=1e-13, atol=1e-14, events=ends)
        assert out.t_events[0].size, "no step"
        return out.y_events[0][0], out.t_events[0][0]

    def step(self, x):
        """The map: x = (t1, t1', t2') just after an impact, where t2 = -t1."""
        end, seconds = self.swing(np.array([x[0], -x[0], x[1], x[2]]))
        after, leaves = self.impact(end)
        assert end[1] > 0 and leaves > 0
        return after[[0, 2, 3]], seconds

    def derivative(self, x, h=2e-4):
        return np.array([sum(c / h * (self.step(x + k * h * e)[0] - self.step(x - k * h * e)[0])
                             for k, c in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))) for e in np.eye(3)]).T

    def cycle(self, x):
        for _ in range(30):
            off = self.step(x)[0] - x
            x = x + np.linalg.solve(np.eye(3) - self.derivative(x), off)
            if np.abs(off).max() < 1e-12:
                break
        return x, self.step(x)[1]

SCENARIO = """stance: 1
scene: mechanism
robot:
  bodies:
    leg1: {{joint: free, mass: {m!r}, centre: [0, {centre!r}]}}
    hip: {{joint: fixed, parent: leg1, mass: {M!r}}}
    leg2: {{joint: hinge, parent: leg1, like: leg1}}
  contacts:
    foot1: {{body: leg1, at: [0, {foot!r}], radius: {radius!r}}}
    foot2: {{body: leg2, at: [0, {foot!r}], radius: {radius!r}}}
ground: {{slope: {slope!r}, friction: 10, lands: ahead}}
initial: {{state: {{leg1: 0}}, support: [foot1]}}
method: {{name: {method}, step: {step!r}{tolerance}}}
stop: {{time: {time!r}, settle: off}}
sweep:
  grid:
    - paths: [initial.state.leg1, initial.state.leg2, initial.state.vleg1, initial.state.vleg2]
      values: {values}
"""


CONTROLLED = "capturing", "event-driven"  # methods that control their error


def stance(w, starts, seconds, steps, method, folder):
    """States after `seconds`, as the oracle counts them, and footfalls. An odd number of steps."""
    values = [[float(a) for a in (t[0] - w.slope, t[1] - t[0], t[2], t[3] - t[2])] for t in starts]
    scenario, results = os.path.join(folder, "walker.yaml"), os.path.join(folder, "walker.h5")
    with open(scenario, "w", encoding="utf-8") as file:
        file.write(SCENARIO.format(m=float(w.m), M=float(w.M), centre=-float(w.c), foot=-float(w.l), radius=float(w.r),
                                   tolerance=", tolerance: 1.0e-12" if method in CONTROLLED else "",
                                   slope=float(w.slope), method=method, step=float(seconds / steps),
                                   time=float(seconds), values=values))
    # Without a compiler: by the kernels whose structure is read at run time.
    subprocess.run([sys.argv[1], "run", scenario, "--force", "--quiet", "-o", results], check=True,
                   env=dict(os.environ, CC="false"), stderr=subprocess.DEVNULL)
    with h5py.File(results) as file:
        state, falls = file["final_state"][...].reshape(len(starts), -1), file["footfalls"][...].ravel()
    leg1, leg2, v1, v2 = state[:, 2], state[:, 3], state[:, 6], state[:, 7]
    return np.array([leg1 + leg2 + w.slope, leg1 + w.slope, v1 + v2, v1]).T, falls


class Tap:
    bad = 0

    def check(self, name, good, more=""):
        self.bad += not good
        print(f"{'ok' if good else 'not ok'} - {name}\n# {more}", flush=True)


def ordered(values):
    return np.array(sorted(values, key=lambda z: (round(z.real, 4), z.imag)))


def compare(tap, name, w, guess, folder):
    x, period = w.cycle(np.array(guess))
    own = ordered(np.append(np.linalg.eigvals(w.derivative(x)), 1))
    begin = w.go(np.array([x[0], -x[0], x[1], x[2]]), 0.15 * period)
    tap.check(f"{name}: a stable cycle", np.abs(own[:-1]).max() < 1,
              f"t1 {x[0]:.9f}, t1' {x[1]:.9f}, t2' {x[2]:.9f}, period {period:.9f} s, eigenvalues {own[:-1]}")
    h = 1e-3
    starts = [begin] + [begin + k * h * e for e in np.eye(4) for k in (-2, -1, 1, 2)]
    for method in CONTROLLED:
        end, falls = stance(w, starts, period, 400, method, folder)
        off = np.abs(end[0] - begin).max()
        tap.check(f"{name}, {method}: the same state a period later", off < 1e-8 and (falls == 1).all(), f"off by {off:.1e}")
        near = end[1:].reshape(4, 4, 4)  # of each coordinate the four places, the state
        Phi = ((near[:, 0] - near[:, 3]) + 8 * (near[:, 2] - near[:, 1])).T / (12 * h)
        found = ordered(np.linalg.eigvals(Phi))
        off = np.abs(found - own).max()
        tap.check(f"{name}, {method}: the same eigenvalues", off < 1e-6, f"{found}, off by {off:.1e}")
        walked, falls = stance(w, [begin], 11 * period, 4400, method, folder)
        off = np.abs(walked[0] - begin).max()
        tap.check(f"{name}, {method}: 11 steps", off < 1e-8 and falls[0] == 11, f"off by {off:.1e}")
    for method in ("implicit", "midpoint", "lagrange"):
        off = []
        for steps in (1000, 8000):
            end, falls = stance(w, [begin], period, steps, method, folder)
            off.append(np.abs(end[0] - begin).max())
        tap.check(f"{name}, {method}: nearer with shorter steps", falls[0] == 1 and off[1] < max(off[0] / 4, 1e-10),
                  f"off by {off[0]:.1e}, {off[1]:.1e} with steps an eighth as long")


def main():
    tap = Tap()
    slope = np.deg2rad(3)
    with tempfile.TemporaryDirectory() as folder:
        compare(tap, "round feet", Walker(0.7, 0.5, 5, 10, 0.3, slope), [0.38, -1.4, -0.45], folder)
        # Of A. Goswami, B. Thuilot and B. Espiau, INRIA RR-2996 (1996).
        compare(tap, "point feet", Walker(1, 0.5, 5, 10, 0, slope), [0.27, -1.09, -0.38], folder)
    return tap.bad > 0


if __name__ == "__main__":
    sys.exit(main())
