#!/usr/bin/env python3
"""What is known from outside, by independent programs, and what every method makes of it (bench_truths).

TRUTHS has, for each row of scenarios/truth/truths.yaml, the number from its closed form, from quadrature or
from an integration of equations written down here once more; where the truth itself is uncertain its
error bar. Nothing of it is the engine's.

    truths.py         prints them: what a new row's value is to be
    truths.py BENCH   (bench_truths) compares with the list, and holds the methods to it; speaks TAP, without numbers
"""
import json
import os
import pathlib
import subprocess
import sys
from math import acosh, asin, atan, cos, cosh, exp, pi, sin, sqrt, tan

import numpy as np
import yaml
from scipy.integrate import quad, solve_ivp
from scipy.special import ellipk

from compass_oracle import Walker

G = 9.81
EXACT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}
HERE = os.path.dirname(os.path.abspath(__file__))


# ---- ball, block, discs -----------------------------------------------------------------------------
def bounces(gap, e, at):
    """Height above the ground at a time after the first landing."""
    t, v = sqrt(2 * gap / G), sqrt(2 * G * gap)
    while True:
        v *= e
        if at < t + 2 * v / G:
            return v * (at - t) - G * (at - t) ** 2 / 2
        t += 2 * v / G


def zeno(gap, e, rate):
    """The end of all bounces; for how long at most they are slower than the rate before it."""
    return sqrt(2 * gap / G) * (1 + e) / (1 - e), 2 * rate / G / (1 - e)


def disc_slides(v, mu, t):
    rolls = v / (3 * mu * G)
    return v * rolls - mu * G * rolls**2 / 2 + 2 / 3 * v * (t - rolls)


# ---- rod ----------------------------------------------------------------------------------------------
def rod_turns(mu, e, theta=1.0, v=-2.0, a=0.5):
    """Rate after the impact of its lower end, mass 1."""
    s, c = sin(theta), cos(theta)
    D = np.array([[1 + 3 * c * c, -3 * s * c], [-3 * s * c, 1 + 3 * s * s]])
    normal, along = np.linalg.solve(D, [-(1 + e) * v, 0.0])
    if abs(along) > mu * normal:
        side = 1 if along > 0 else -1
        normal = -(1 + e) * v / (D[0, 0] + side * mu * D[0, 1])
        along = side * mu * normal
    return 3 / a * (-c * normal + s * along)


# ---- pendulums ------------------------------------------------------------------------------------------
def pendulum(amplitude):
    w = sqrt(3 * G / 2)
    return 4 * ellipk(sin(amplitude / 2) ** 2) / w, w * sqrt(2 * (1 - cos(amplitude)))


def oscillator(m, d, k, x, t):
    s = d / (2 * m)
    w = sqrt(k / m - s * s)
    return x * exp(-s * t) * (cos(w * t) + s / w * sin(w * t))


def cart_pole(A, M=1.0, m=0.5, c=0.5, I=0.5 / 12):
    """A quarter of the period; by p = A sin u, which takes the root out of the quadrature."""
    J = I + m * c * c

    def rate(u):
        p = A * sin(u)
        rise = 2 * sin((A + p) / 2) * sin((A - p) / 2)
        return sqrt((J - (m * c * cos(p)) ** 2 / (M + m)) / (2 * m * G * c * rise)) * A * cos(u)
    return quad(rate, 0, pi / 2 - 1e-9, epsabs=1e-13, epsrel=1e-13, limit=200)[0] + 1e-9 * rate(pi / 2 - 1e-5)


def slow_mode():
    square = (3 - 6 / sqrt(7)) * G
    return sqrt(square), (1.5 - 4 / 3 * square / G) / (square / G / 2)


def double_pendulum(p, q, seconds):
    """The upper angle by Lagrange's equations, both against the vertical."""
    def rates(_, y):
        s, c = sin(y[0] - y[1]), cos(y[0] - y[1])
        A = np.array([[4 / 3, c / 2], [c / 2, 1 / 3]])
        force = [-1.5 * G * sin(y[0]) - s / 2 * y[3] ** 2, -0.5 * G * sin(y[1]) + s / 2 * y[2] ** 2]
        return [y[2], y[3], *np.linalg.solve(A, force)]
    return solve_ivp(rates, (0, seconds), [p, q, 0, 0], **EXACT).y[0, -1]


def double_pendulum_energy(p, q):
    return -G * (1.5 * cos(p) + 0.5 * cos(q))


# ---- rocking block ------------------------------------------------------------------------------------
class Block:
    def __init__(self, b, h):
        self.R, self.alpha, self.h = sqrt(b * b + h * h), atan(b / h), h
        self.square = 3 * G / (4 * self.R)
        self.kept = 1 - 1.5 * sin(self.alpha) ** 2

    def state(self, tilt, seconds, linear=False):
        """Tilt and its rate, from rest, through impacts; linear: of Housner's slender block."""
        def rates(_, y):
            side = 1 if sign > 0 else -1
            angle = self.alpha - side * y[0]
            return [y[1], -side * self.square * (angle if linear else sin(angle))]

        def flat(_, y):
            return sign * y[0]
        flat.terminal, flat.direction = True, -1
        t, y, sign = 0.0, [tilt, 0.0], 1
        while True:
            out = solve_ivp(rates, (t, seconds), y, events=flat, **EXACT)
            if not out.t_events[0].size:
                return out.y[:, -1]
            t, y, sign = out.t_events[0][0], [0.0, self.kept * out.y_events[0][0][1]], -sign

    def energy_after(self, tilt):
        """After the first impact, mass 1."""
        return G * (self.h + self.kept**2 * (self.R * cos(self.alpha - tilt) - self.h))

    def quarter(self, tilt):
        """Housner's quarter period."""
        return acosh(1 / (1 - tilt / self.alpha)) / sqrt(self.square)


# ---- walkers -----------------------------------------------------------------------------------------------
class Wheel:
    """Mass 1, spokes of length 1."""
    def __init__(self, I, spokes, slope):
        self.J, self.a, self.slope = I + 1, pi / spokes, slope
        self.kept = (I + cos(2 * self.a)) / self.J
        gain = 4 * G * sin(self.a) * sin(slope) / self.J
        self.after = sqrt(self.kept**2 / (1 - self.kept**2) * gain)
        self.top = sqrt(self.after**2 - 2 * G * (1 - cos(self.a - slope)) / self.J)

    def period(self):
        """From one impact to the next."""
        def rate(p):
            return 1 / sqrt(self.top**2 + 2 * G * (1 - cos(p)) / self.J)
        return quad(rate, self.slope - self.a, self.slope + self.a, epsabs=1e-13, epsrel=1e-13)[0]


LONG = 0.200310900544, -0.199832473005  # Garcia's long cycle at 0.009: angle and rate as a step begins


def simplest(seconds, begin=LONG, events=None):
    """Leg that stands and angle between the legs, with their rates, feet without mass, from a step's beginning."""
    def rates(_, y):
        t = sin(y[0] - 0.009)
        return [y[1], t, y[3], t + (y[1] ** 2 - cos(y[0] - 0.009)) * sin(y[2])]
    t, v = begin
    out = solve_ivp(rates, (0, seconds), [t, v, 2 * t, (1 - cos(2 * t)) * v], events=events, **EXACT)
    return (out.t_events[0][0], out.y_events[0][0]) if events else out.y[:, -1]


def simplest_strike(begin=LONG):
    """When the step ends, and in what state."""
    def ends(_, y):
        return y[2] - 2 * y[0] if y[2] < -0.05 else 1.0
    ends.terminal, ends.direction = True, 1
    return simplest(6, begin, ends)


def simplest_following(begin):
    t, v = simplest_strike(begin)[1][:2]
    return np.array([-t, cos(2 * t) * v])


def simplest_trace():
    """1 and the squares of the eigenvalues of the map from step to step."""
    h = 1e-5
    J = np.array([simplest_following(LONG + h * e) - simplest_following(LONG - h * e) for e in np.eye(2)]).T / (2 * h)
    return 1 + np.trace(J @ J)


class Light:
    """The simplest walker with feet that weigh something, from where the one without begins."""
    def __init__(self, feet):
        self.w = Walker(1, 1, feet, 1, 0, 0.009, 1.0)
        t, v = LONG
        self.x = np.array([t, v, v - (1 - cos(2 * t)) * v])

    def late(self, seconds):
        """Angle of the leg that stands, two impacts later."""
        x = self.x
        for _ in range(2):
            x, spent = self.w.step(x)
            seconds -= spent
        return self.w.go(np.array([x[0], -x[0], x[1], x[2]]), seconds)[0]

    def trace(self, period):
        """Of the derivative of the state two steps later by the state, 0.3 of a step after its beginning."""
        t, v, f, w = simplest(0.3 * period)
        begin = np.array([t, t - f, v, v - w])

        def later(y, seconds=2 * period):
            while True:
                end, spent = self.w.swing(y)
                if spent > seconds:
                    return self.w.go(y, seconds)
                y, seconds = self.w.impact(end)[0], seconds - spent
        return sum((later(begin + 1e-5 * e) - later(begin - 1e-5 * e)) @ e / 2e-5 for e in np.eye(4))


class Goswami:
    def __init__(self):
        self.w = Walker(1, 0.5, 5, 10, 0, np.deg2rad(3))
        self.x, self.period = self.w.cycle(np.array([0.27, -1.09, -0.38]))
        # By differences, and by others, twice as wide: what they are uncertain by.
        self.trace, other = (1 + np.trace(J @ J) for J in (self.w.derivative(self.x), self.w.derivative(self.x, 4e-4)))
        self.bar = abs(other - self.trace)
        self.begin = self.w.go(np.array([self.x[0], -self.x[0], self.x[1], self.x[2]]), 0.15 * self.period)

    def state(self):
        t1, t2, v1, v2 = self.begin
        return t1 - self.w.slope, t2 - t1, v1, v2 - v1


# ---- the paper's biped -----------------------------------------------------------------------------------
def biped_eigenvalues(l=0.535, m=1.8, mt=1.8, mh=5.4, theta=-0.41, q2=0.82):
    """About the foot that stands, absolute angles: trunk p, leg f1, leg f2; q1 by the balance of moments."""
    total = mt + mh + m
    f2 = theta + q2
    f1 = asin((mt * -sin(theta) + m * sin(f2)) / total)  # centre of mass over the foot
    hip = np.array([[0, -cos(f1), 0], [0, -sin(f1), 0]])  # hip = -l (sin f1, -cos f1)
    trunk = hip + np.array([[-cos(theta), 0, 0], [-sin(theta), 0, 0]])
    foot = hip + np.array([[0, 0, cos(f2)], [0, 0, sin(f2)]])
    A = l * l * sum(w * J.T @ J for w, J in ((mt, trunk), (mh, hip), (m, foot)))
    # Potential: l g (total cos f1 + mt cos theta - m cos f2); torques of the joints are constant.
    K = -l * G * np.diag([mt * cos(theta), total * cos(f1), -m * cos(f2)])
    return f1 - theta, np.linalg.eigvals(-np.linalg.solve(A, K))


def biped_trace(seconds):
    return sum(2 * (cosh(sqrt(z) * seconds) if z > 0 else cos(sqrt(-z) * seconds)) for z in biped_eigenvalues()[1].real)


with open(os.path.join(HERE, "reference", "drop.json"), encoding="utf-8") as drop_file:
    DROP = json.load(drop_file)

# ---- the rows ------------------------------------------------------------------------------------------------
goswami = Goswami()
step, light = simplest_strike()[0], Light(1e-6)
wheel = Wheel(0.1, 6, 0.2)
wide, slender = Block(0.1, 0.3), Block(0.02, 0.4)
swing = pendulum(2)
slow, shape = slow_mode()

TRUTHS = {
    "ball thrown, height": 1 + 3 * 0.8 - G * 0.8**2 / 2,
    "ball thrown, energy": 0.5 * 18 + G,
    "bouncing ball, after three impacts": 0.1 + bounces(0.5, 0.5, 0.875),
    "bouncing ball, Zeno time": zeno(0.5, 0.5, 0.002),
    "bouncing ball, Zeno time, e 0.8": zeno(0.5, 0.8, 0.002),
    "block slides to rest, distance": 4 / (2 * 0.3 * G),
    "block slides down": G * (sin(0.5) - 0.3 * cos(0.5)) / 2,
    "block holds, friction used": tan(0.2),
    "block, critical friction": (tan(0.3), 1e-6),
    "disc rolls down, distance": 0.1 * sin(0.2) + G * sin(0.2) * cos(0.2) / 3,
    "disc rolls down, rate": -2 / 3 * G * sin(0.2) / 0.1,
    "disc rolls down, friction used": tan(0.2) / 3,
    "disc slides then rolls, distance": disc_slides(2, 0.2, 1),
    "disc slides then rolls, speed": 4 / 3,
    "disc slides then rolls, slip": 4 / (6 * 0.2 * G),
    "rod strikes and sticks": rod_turns(0.8, 0),
    "rod strikes and slips": rod_turns(0.2, 0),
    "rod strikes and rebounds": rod_turns(0.2, 0.5),
    "Painlevé's rod, critical friction": 4 / 3,
    "Painlevé's rod jams, rate": -3 * 4 * sin(2.0344439357957027) / 2,
    "pendulum, exact period": 0.0,
    "pendulum, rate at the bottom": -swing[1],
    "oscillator, damped": oscillator(2, 1, 80, 0.5, 2),
    "pole on a free cart, exact period": 0.0,
    "pole on a free cart, the cart": 0.5 * 0.5 * sin(1) / 1.5,
    "double pendulum, slow mode": (0.001 * cos(2 * slow), abs(double_pendulum(0.001, 0.001 * shape, 2) - 0.001 * cos(2 * slow))),
    "double pendulum, energy in chaos": double_pendulum_energy(2, 5),
    "rocking block, energy left": wide.energy_after(0.1),
    "rocking block, after two impacts": wide.state(0.1, 0.5)[0],
    "slender block, Housner's period": (0.0, abs(slender.state(0.02, slender.quarter(0.02))[0])),
    "rimless wheel, limit cycle": -4 * pi / 3,
    "rimless wheel, rate": -wheel.top,
    "rimless wheel, eigenvalue": 1 + wheel.kept**2,
    "simplest walker, angle after 2.5 steps": (simplest(step / 2)[0] - 0.009, abs(light.late(2.5 * step) - simplest(step / 2)[0])),
    "simplest walker, eigenvalues": (simplest_trace(), abs(light.trace(step) - simplest_trace())),
    "compass gait, angle after two steps": goswami.state()[0],
    "compass gait, eigenvalues": (goswami.trace, goswami.bar),
    "paper: q1 at equilibrium": biped_eigenvalues()[0],
    "paper: eigenvalues at equilibrium": biped_trace(0.2),
    "paper: foot 1 lands": DROP["first"]["events"][0]["t"],
    "paper: test 1 recovers, outcome": 1.0,  # as results files have it
    "paper: test 2 falls, outcome": 2.0,
    "drop, pitch at 0.4 s": DROP["second"]["states"]["0.4"]["q"][2],
    "drop, pitch at 1.2 s": DROP["second"]["states"]["1.2"]["q"][2],
}


# ---- the methods held to them ---------------------------------------------------------------------------------
GIVES_UP = {"bouncing ball, Zeno time": "events", "bouncing ball, Zeno time, e 0.8": "events", "Painlevé's rod jams, rate": "painleve"}
SOLVES_ACCELERATIONS = "lagrange", "event-driven"  # which is why they do
# What a method may be off by beyond the error bar, of a number of the size of 1, in steps four times as long as the
# scenarios': to a tolerance, or of order 4 in the step.
BOUND = {"capturing": 1e-6, "event-driven": 1e-6, "lagrange": 2e-3}
# What has no bar is a closed form or integrated to 1e-13 here: no machine's libraries move it by so much, a
# thousandth of the least bound.
ROUNDING = 1e-9
# settle_time counts steps, bounces end at those shorter than one, and jams are where forces have no bound.
ROUGH = {"bouncing ball, Zeno time": 0.01, "bouncing ball, Zeno time, e 0.8": 0.03, "Painlevé's rod, critical friction": 1e-5}
# Feet of no mass: among steps longer than a thousandth of a second implicit ones stumble here and there, more or
# less by chance. Held to steps so many times as short as the scenario's.
ERRATIC, ERRATIC_TIMES = "simplest walker, angle after 2.5 steps", 16


class Tap:
    bad = 0

    def check(self, name, good, more=""):
        self.bad += not good
        print(f"{'ok' if good else 'not ok'} - {name}" + (f"\n# {more}" if more else ""), flush=True)


class Bench:
    """Runs beside what else there is to do."""
    def __init__(self, *command):
        self.process = subprocess.Popen([command[0], "--json", *command[1:]], stdout=subprocess.PIPE)

    def rows(self):
        out, _ = self.process.communicate()
        assert self.process.returncode == 0
        return {(row["truth"], row["method"]): row for row in json.loads(out)}


def known(tap, rows):
    """The list against the programs here."""
    listed = {name: row for (name, _), row in rows.items()}
    tap.check("the list has what is computed here, and nothing else", set(listed) == set(TRUTHS), set(listed) ^ set(TRUTHS))
    tap.check("at least 20 truths", len(listed) >= 20)
    off = np.abs(simplest_following(LONG) - LONG).max()
    tap.check("the simplest walker's cycle is one", off < 1e-11, f"off by {off:.1e}")
    for name in sorted(set(listed) & set(TRUTHS)):
        truth, bar = TRUTHS[name] if isinstance(TRUTHS[name], tuple) else (TRUTHS[name], 0.0)
        row = listed[name]
        off = abs(row["value"] - truth)
        tap.check(f"{name}: the number", off <= row["bar"] + ROUNDING * max(1, abs(truth)) and row["bar"] >= bar,
                  f"listed {row['value']!r} +- {row['bar']}, computed {truth!r} +- {bar}")


def controlled(tap, rows):
    for (name, method), row in rows.items():
        if method not in BOUND:
            continue
        if name in GIVES_UP and method in SOLVES_ACCELERATIONS:
            tap.check(f"{name}, {method}: gives up", row["why_none"] == GIVES_UP[name], row["why_none"])
        elif name == "Painlevé's rod, critical friction" and method not in SOLVES_ACCELERATIONS:
            tap.check(f"{name}, {method}: passes it", row["why_none"] == "none")
        else:
            most = row["bar"] + ROUGH.get(name, BOUND[method] * max(1, abs(row["value"])))
            tap.check(f"{name}, {method}", row["error"] is not None and row["error"] <= most, f"off by {row['error']}, may be {most:.1e}")


def first_order(tap, coarse, fine, times):
    """Fixed steps: not far off, nearer with shorter ones; derivatives by differences have none."""
    for (name, method), row in fine.items():
        if "eigenvalue" in name or name in ROUGH or (name == ERRATIC and times != ERRATIC_TIMES):
            continue
        off = coarse[name, method]["error"], row["error"]
        good = None not in off and off[0] <= 200 * coarse[name, method]["step"] * max(1, abs(row["value"])) + row["bar"] and \
            off[1] <= max(2 * off[0] / times, 2 * row["step"]) + row["bar"]
        tap.check(f"{name}, {method}: nearer with shorter steps", good, f"off by {off[0]}, {off[1]} with steps {times} times as short")


def main():
    if len(sys.argv) == 1:
        for name, truth in TRUTHS.items():
            print(name, truth)
        return 0
    tap, bench = Tap(), sys.argv[1]
    fixed = "--method", "implicit", "--method", "midpoint"
    everything, coarse, fine = Bench(bench, "--finer", "0.25"), Bench(bench, *fixed), Bench(bench, *fixed, "--finer", "4")
    with open("erratic.yaml", "w", encoding="utf-8") as out:
        listed = yaml.safe_load(pathlib.Path("scenarios/truth/truths.yaml").read_text(encoding="utf-8"))["truths"]
        yaml.safe_dump({"truths": [dict(row, scenario="scenarios/truth/" + row["scenario"]) for row in listed if row["truth"] == ERRATIC]}, out)
    finest = Bench(bench, "erratic.yaml", *fixed, "--finer", str(ERRATIC_TIMES))
    coarse = coarse.rows()
    first_order(tap, coarse, fine.rows(), 4)
    first_order(tap, coarse, finest.rows(), ERRATIC_TIMES)
    rows = everything.rows()
    known(tap, rows)
    controlled(tap, rows)
    return tap.bad > 0


if __name__ == "__main__":
    sys.exit(main())
