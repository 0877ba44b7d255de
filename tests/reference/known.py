#!/usr/bin/python3
"""Motions of ball, block, rod and biped with known answers, for the tests of scenes and methods.

    /usr/bin/python3 tests/reference/known.py       writes tests/reference/known.json

Laws: g = 9.81 m/s^2; Signorini's; Newton's restitution, u_N+ = -e u_N-; Coulomb's friction, at an
impact with the velocity at its end; of several solutions of an impact the one of least kinetic
energy. Coordinates and contact names are the scenes'. Nothing here comes from the engine.

Ball and block (Particle, Pulled) are closed forms throughout, the rod in flight (Clatter) too. The
rest is Motion: the smooth equation of each contact mode, integrated with DOP853 (rtol 1e-13, atol
1e-14) and cut at events located on its dense output; impacts by enumeration. Motion is compared
with the closed forms, energy is balanced, and the program stops where a check fails. `error` of an
entry is the largest deviation that its checks found.

Modes, one letter a contact: o open, s stick, f slips forward (+x), b slips backward, n touches
without friction.
"""
import itertools
import json
import math
import os

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from robot import Robot

G = 9.81
RTOL, ATOL, MAX_STEP = 1e-13, 1e-14, 2e-3
AT_REST = 1e-8     # m/s: below it a contact counts as at rest when a mode is chosen
LAW = 1e-8         # N, m/s^2, N s, m/s: admitted violation when a mode is chosen
TOUCHES = 1e-11    # m
SLIDES = {'f': 1.0, 'b': -1.0}


def require(what, error, limit):
    if not abs(error) <= limit:
        raise RuntimeError(f"{what}: {error} exceeds {limit}")
    return abs(float(error))


# --------------------------------------------------------------------------------------------------
# Ball and block: a point under a constant acceleration (along, -down), ground at z = floor.


class Particle:
    """Phases of the motion, each uniformly accelerated, in closed form.

    Flight ends at the larger root of (z - floor) + v_z d - down d^2 / 2. An impact turns v_z into
    -e v_z with the impulse (1 + e) |v_z| per unit mass, so x' loses at most friction times that,
    and at most itself. Flights after it last 2 e^k v / down: their sum is finite for e < 1 (the
    "zeno" event: bouncing ends). On the ground x'' = along - sign(x') friction down until x' = 0,
    then rest if |along| <= friction down, else a slide the other way.
    """

    def __init__(self, along, down, floor, friction, restitution, position, velocity, end):
        self.along, self.down, self.floor = along, down, floor
        self.friction = friction
        self.phases, self.events, self.bounces = [], [], []
        self.build(np.array(position, float), np.array(velocity, float), restitution, end)

    def event(self, t, kind, x, before, after):
        self.events.append({"t": t, "kind": kind, "position": list(x),
                            "velocity_before": list(before), "velocity": list(after)})

    def phase(self, t, x, v, a):
        self.phases.append((t, np.array(x), np.array(v), np.array(a)))

    def build(self, x, v, restitution, end):
        t, first = 0.0, None
        if x[1] > self.floor or v[1] > 0:
            while t < end:
                a = np.array([self.along, -self.down])
                height = x[1] - self.floor
                root = math.sqrt(v[1]**2 + 2 * self.down * height)
                d = (v[1] + root) / self.down
                if first is None:
                    first = (t + d, root)
                elif d < 1e-17 * first[0]:
                    break
                self.phase(t, x, v, a)
                x = np.array([x[0] + v[0] * d + self.along * d**2 / 2, self.floor])
                before = np.array([v[0] + self.along * d, -root])
                t += d
                grip = self.friction * (1 + restitution) * root
                along = before[0] - math.copysign(min(grip, abs(before[0])), before[0])
                v = np.array([along, restitution * root])
                if t <= end:
                    self.event(t, "touchdown", x, before, v)
                    self.bounces.append(t)
                if restitution == 0:
                    break
            if restitution > 0 and t < end:
                ends = first[0] + 2 * first[1] * restitution / (self.down * (1 - restitution))
                require("sum of the flights", (t - ends) / ends, 1e-14)
                t, v = ends, np.array([v[0], 0.0])
                self.event(t, "zeno", x, v, v)
        v[1] = 0
        while t < end:
            sign = np.sign(v[0]) or np.sign(self.along)
            resist = self.friction * self.down
            if v[0] == 0 and abs(self.along) <= resist:
                self.phase(t, x, v, [0, 0])
                return
            a = self.along - sign * resist
            self.phase(t, x, v, [a, 0])
            if a * sign >= 0:
                return
            d = -v[0] / a
            x = x + np.array([v[0] * d / 2, 0])
            t, v = t + d, np.zeros(2)
            if t <= end:
                self.event(t, "slip ends" if abs(self.along) <= resist else "slip turns", x, v, v)

    def state(self, at):
        t, x, v, a = [p for p in self.phases if p[0] <= at][-1]
        d = at - t
        return np.concatenate([x + v * d + a * d**2 / 2, v + a * d])


class Pulled:
    """Block on a slope, pulled by `pull` sin(w t): slips have closed forms between their ends.

    Applied acceleration a(t) = g sin(slope) + (pull / m) sin(w t), resistance r = mu g cos(slope).
    Rest lasts while |a| <= r and ends where sin(w t) = (+-r - g sin(slope)) m / pull, outwards. In
    a slip of sign s: x' = v + (g sin(slope) - s r) d - pull / (m w) (cos w t - cos w t0); its
    extrema are known, x' is monotonic between them, so that the first zero is bracketed.
    """

    def __init__(self, mass, slope, friction, pull, frequency, velocity, end):
        self.w, self.p = 2 * math.pi * frequency, pull / mass
        self.slide, self.resist = G * math.sin(slope), friction * G * math.cos(slope)
        self.phases, self.events = [], []
        t, x, v = 0.0, 0.0, velocity
        while t < end:
            a = self.applied(t)
            if v == 0 and abs(a) <= self.resist:
                self.phases.append((t, x, 0.0, 0))
                t, s = self.rest_ends(t)
                if s is None or t > end:
                    return
                self.events.append({"t": t, "kind": "slip begins", "mode": "fb"[s < 0], "x": x})
            else:
                s = int(np.sign(v)) or int(np.sign(a))
            phase = (t, x, v, s)
            self.phases.append(phase)
            t = self.slip_ends(phase, end)
            if t is None:
                return
            x, v = self.slip(phase, t)[0], 0.0
            kind = "slip ends" if abs(self.applied(t)) <= self.resist else "slip turns"
            mode = "s" if kind == "slip ends" else "fb"[self.applied(t) < 0]
            self.events.append({"t": t, "kind": kind, "mode": mode, "x": x})

    def applied(self, t):
        return self.slide + self.p * math.sin(self.w * t)

    def crossings(self, level, t, count):
        """Instants after t at which sin(w t) = level, with the sign of the cosine there."""
        if abs(level) > 1:
            return []
        turn = math.floor(self.w * t / (2 * math.pi)) - 1
        out = []
        for n in range(turn, turn + count):
            for angle, sign in ((math.asin(level), 1), (math.pi - math.asin(level), -1)):
                at = (angle + 2 * math.pi * n) / self.w
                if at > t + 1e-12:
                    out.append((at, sign))
        return sorted(out)

    def rest_ends(self, t):
        if self.p == 0:
            return t, None
        out = [(at, s) for s in (1, -1)
               for at, c in self.crossings((s * self.resist - self.slide) / self.p, t, 4) if c == s]
        return min(out) if out else (t, None)

    def slip(self, phase, t):
        t0, x0, v0, s = phase
        a, d, w, p = self.slide - s * self.resist, t - t0, self.w, self.p
        c = math.cos(w * t0)
        return (x0 + v0 * d + a * d**2 / 2 + p / w * c * d
                - p / w**2 * (math.sin(w * t) - math.sin(w * t0)),
                v0 + a * d - p / w * (math.cos(w * t) - c))

    def slip_ends(self, phase, end):
        t, _, _, s = phase
        a = self.slide - s * self.resist
        count = math.ceil((end - t) * self.w / (2 * math.pi)) + 3
        marks = [t] + [at for at, _ in self.crossings(-a / self.p, t, count) if at < end] + [end]
        for low, high in zip(marks, marks[1:]):
            if s * self.slip(phase, high)[1] < 0:
                return brentq(lambda at: self.slip(phase, at)[1], low, high, xtol=1e-15)
        return None

    def state(self, at):
        phase = [p for p in self.phases if p[0] <= at][-1]
        x, v = self.slip(phase, at) if phase[3] else (phase[1], 0.0)
        return np.array([x, 0.0, v, 0.0])


# --------------------------------------------------------------------------------------------------
# Systems for Motion: dynamics() is (M, applied forces, [(gap, J, dJ/dt v)] of the contacts), J of a
# contact [2][n] with the tangential row first; power() is that of the forces without a potential.


class Point:
    contacts = ("base",)

    def __init__(self, mass, floor, slope=0.0, pull=0.0, frequency=1.0):
        self.mass, self.floor, self.slope = mass, floor, slope
        self.pull, self.w = pull, 2 * math.pi * frequency

    def dynamics(self, t, q, v):
        weight = self.mass * G * np.array([math.sin(self.slope), -math.cos(self.slope)])
        force = weight + np.array([self.pull * math.sin(self.w * t), 0])
        return self.mass * np.eye(2), force, [(q[1] - self.floor, np.eye(2), np.zeros(2))]

    def power(self, t, q, v):
        return self.pull * math.sin(self.w * t) * v[0]

    def energy(self, q, v):
        height = q[1] * math.cos(self.slope) - q[0] * math.sin(self.slope)
        return self.mass * (0.5 * v @ v + G * height)


class Rod:
    contacts = ("end1", "end2")

    def __init__(self, length=1.0, mass=1.0, ratio=1 / 12):
        self.length, self.half, self.mass = length, length / 2, mass
        self.ratio, self.inertia = ratio, ratio * mass * length**2

    def robot(self):
        return {"length": self.length, "mass": self.mass, "inertia_ratio": self.ratio}

    def dynamics(self, t, q, v):
        c, s = self.half * math.cos(q[2]), self.half * math.sin(q[2])
        ends = [(q[1] + e * s, np.array([[1, 0, -e * s], [0, 1, e * c]]),
                 -e * v[2]**2 * np.array([c, s])) for e in (-1, 1)]
        return (np.diag([self.mass, self.mass, self.inertia]),
                np.array([0, -self.mass * G, 0]), ends)

    def power(self, t, q, v):
        return 0.0

    def energy(self, q, v):
        return 0.5 * self.mass * (v[0]**2 + v[1]**2) + 0.5 * self.inertia * v[2]**2 \
            + self.mass * G * q[1]

    def on_end1(self, angle, rate=0.0, slip=0.0):
        """Position and velocity with end 1 at the origin, not leaving the ground."""
        c, s = self.half * math.cos(angle), self.half * math.sin(angle)
        return [c, s, angle], [slip - s * rate, c * rate, rate]


class Biped:
    contacts = ("foot1", "foot2")

    def __init__(self, robot, servo=None):
        self.model, self.servo, self.held = robot, servo, np.zeros(2)

    def torque(self, q, v):
        if self.servo is None:
            return np.concatenate([np.zeros(3), self.held])
        kp, kd, target = self.servo
        return np.concatenate([np.zeros(3), -kp * (q[3:] - target) - kd * v[3:]])

    def dynamics(self, t, q, v):
        M, bias, feet = self.model.dynamics(q, v)
        return M, self.torque(q, v) - bias, [(p[1], J, jv) for p, J, jv in feet]

    def power(self, t, q, v):
        return self.torque(q, v) @ v

    def energy(self, q, v):
        return self.model.energy(q, v)


def closing(modes, friction, M, contacts, start, wanted):
    """Forces (or impulses) that make J . result = wanted on the touching contacts.

    start: velocity or acceleration without them. Returns (result, [(normal, tangential)]) or None
    where no forces do. Least norm where they are not unique."""
    rows, want, columns = [], [], []
    for (_, J, _), mode, (tangential, normal) in zip(contacts, modes, wanted):
        if mode == 'o':
            continue
        rows.append(J[1])
        want.append(normal)
        if mode == 's':
            rows.append(J[0])
            want.append(tangential)
            columns += [J[1], J[0]]
        else:
            columns.append(J[1] - SLIDES.get(mode, 0) * friction * J[0])
    pushes, result = [(0.0, 0.0)] * len(modes), start
    if rows:
        respond = np.linalg.solve(M, np.array(columns).T)
        K, right = np.array(rows) @ respond, np.array(want) - np.array(rows) @ start
        sizes = np.linalg.lstsq(K, right, rcond=1e-11)[0]
        if np.max(np.abs(K @ sizes - right)) > 1e-9 * (1 + np.max(np.abs(right))):
            return None
        result, i = start + respond @ sizes, 0
        for k, mode in enumerate(modes):
            if mode == 's':
                pushes[k] = (sizes[i], sizes[i + 1])
                i += 2
            elif mode != 'o':
                pushes[k] = (sizes[i], -SLIDES.get(mode, 0) * friction * sizes[i])
                i += 1
    return result, pushes


def impact(M, contacts, touching, v, friction, restitution):
    """Velocities that obey the impact law, least kinetic energy first, as (energy, modes, v+)."""
    letters = 'sfbo' if friction > 0 else 'no'
    found = []
    for modes in itertools.product(*[letters if k in touching else 'o'
                                     for k in range(len(contacts))]):
        rebound = [(0.0, -restitution * min(J[1] @ v, 0)) for _, J, _ in contacts]
        solved = closing(modes, friction, M, contacts, v, rebound)
        if solved is None:
            continue
        after, pushes = solved
        lawful = True
        for k in touching:
            J, mode, (normal, tangential) = contacts[k][1], modes[k], pushes[k]
            lawful &= normal >= -LAW and J[1] @ after >= rebound[k][1] - LAW
            lawful &= abs(tangential) <= friction * normal + LAW
            lawful &= mode not in SLIDES or SLIDES[mode] * (J[0] @ after) >= -LAW
        if lawful and all(np.max(np.abs(after - f[2])) > 1e-7 for f in found):
            found.append((0.5 * after @ M @ after, ''.join(modes), after))
    return sorted(found, key=lambda f: f[0])


class Motion:
    """Event-driven motion of a system: `events`, and states with the work done at given times."""

    def __init__(self, system, friction, restitution=0.0, active=None, max_step=MAX_STEP):
        self.system, self.friction, self.restitution = system, friction, restitution
        self.n = len(system.contacts)
        self.active = range(self.n) if active is None else active
        self.letters = 'sfbo' if friction > 0 else 'no'
        self.max_step, self.several, self.drift = max_step, 0, 0.0

    def forces(self, t, q, v, modes):
        M, force, contacts = self.system.dynamics(t, q, v)
        keep = [-bias for _, _, bias in contacts]
        solved = closing(modes, self.friction, M, contacts, np.linalg.solve(M, force), keep)
        if solved is None:
            return None, None, contacts
        return solved[0], solved[1], contacts

    def lawful(self, t, q, v, touching, modes):
        a, pushes, contacts = self.forces(t, q, v, modes)
        if a is None:
            return None
        for k in touching:
            (_, J, bias), mode, (normal, tangential) = contacts[k], modes[k], pushes[k]
            apart, slip = J[1] @ v > AT_REST, J[0] @ v
            if mode == 'o':
                if not apart and J[1] @ a + bias[1] < -LAW:
                    return None
                continue
            if apart or normal < -LAW:
                return None
            if mode == 's' and (abs(slip) > AT_REST
                                or abs(tangential) > self.friction * normal + LAW):
                return None
            # a slip that is to begin is judged by its acceleration, one under way by its speed
            along = slip if abs(slip) > AT_REST else J[0] @ a + bias[0]
            if mode in SLIDES and along * SLIDES[mode] < 0:
                return None
        return a

    def choose(self, t, q, v, touching):
        found = []
        for modes in itertools.product(*[self.letters if k in touching else 'o'
                                         for k in range(self.n)]):
            a = self.lawful(t, q, v, touching, modes)
            if a is not None and all(np.max(np.abs(a - f[0])) > 1e-5 for f in found):
                found.append((a, ''.join(modes)))
        if len(found) != 1:
            raise RuntimeError(f"{len(found)} lawful modes at t = {t}, q = {q}, v = {v}: {found}")
        return found[0][1]

    def watches(self, modes):
        def watch(k, kind, direction, value):
            def f(t, y):
                return value(t, y[:m], y[m:2 * m])
            f.terminal, f.direction, f.what = True, direction, (k, kind)
            return f

        m, out = self.size, []
        for k in self.active:
            def gap(t, q, v, k=k):
                return self.system.dynamics(t, q, v)[2][k][0]

            def slip(t, q, v, k=k):
                return self.system.dynamics(t, q, v)[2][k][1][0] @ v

            def normal(t, q, v, k=k):
                return self.forces(t, q, v, modes)[1][k][0]

            def margin(t, q, v, k=k):
                push = self.forces(t, q, v, modes)[1][k]
                return self.friction * push[0] - abs(push[1])

            if modes[k] == 'o':
                out.append(watch(k, 'touchdown', -1, gap))
                continue
            out.append(watch(k, 'lift-off', -1, normal))
            if modes[k] == 's':
                out.append(watch(k, 'slip begins', -1, margin))
            elif modes[k] in SLIDES:
                out.append(watch(k, 'slip ends', int(-SLIDES[modes[k]]), slip))
        return out

    def after(self, t, k, kind, q, v, modes):
        """Velocity and modes after an event, and the energy lost."""
        M, _, contacts = self.system.dynamics(t, q, v)
        if kind in ('slip begins', 'lift-off'):  # accelerations are continuous: one letter changes
            push = self.forces(t, q, v, modes)[1][k][1]
            letter = 'o' if kind == 'lift-off' else 'b' if push > 0 else 'f'
            return v, modes[:k] + letter + modes[k + 1:], 0.0
        touching = [i for i in self.active
                    if modes[i] != 'o' or i == k or abs(contacts[i][0]) < TOUCHES]
        before = 0.5 * v @ M @ v
        if kind == 'touchdown':
            solutions = impact(M, contacts, touching, v, self.friction, self.restitution)
            if not solutions:
                raise RuntimeError(f"no solution of the impact at t = {t}, q = {q}, v = {v}")
            self.several += len(solutions) > 1
            v = solutions[0][2]
        else:  # exactly at rest, so that sticking is considered
            row = contacts[k][1][0]
            respond = np.linalg.solve(M, row)
            v = v - respond * (row @ v) / (row @ respond)
        return v, self.choose(t, q, v, touching), before - 0.5 * v @ M @ v

    def start(self, t, q, v):
        """Modes that begin at a state; contacts on the ground must not approach it."""
        contacts = self.system.dynamics(t, q, v)[2]
        return self.choose(t, q, v, [k for k in self.active if abs(contacts[k][0]) < TOUCHES])

    def run(self, q, v, times, begin=0.0, modes=None, limit=100):
        """States at `times` (increasing, the last is the end); energy must balance."""
        q, v = np.array(q, float), np.array(v, float)
        self.size = m = len(q)
        t, y, modes = begin, np.concatenate([q, v, [0.0]]), modes or self.start(begin, q, v)
        self.first, self.events, states, times = modes, [], [], list(times)
        total = self.system.energy(q, v)

        def slope(t, y, modes):
            q, v = y[:m], y[m:2 * m]
            a, pushes, contacts = self.forces(t, q, v, modes)
            work = self.system.power(t, q, v) + sum(
                p[1] * (c[1][0] @ v) for p, c in zip(pushes, contacts))
            return np.concatenate([v, a, [work]])

        while len(states) < len(times):
            if len(self.events) > limit:
                raise RuntimeError("too many events")
            watches = self.watches(modes)
            s = solve_ivp(lambda t, y, modes=modes: slope(t, y, modes), (t, times[-1]), y,
                          method='DOP853', rtol=RTOL, atol=ATOL, events=watches,
                          dense_output=True, max_step=self.max_step,
                          first_step=min(self.max_step / 4, times[-1] - t))
            if s.status < 0:
                raise RuntimeError(s.message)
            states += [s.sol(at)[:2 * m] for at in times[len(states):]
                       if at < s.t[-1] or s.status == 0]
            t, y = s.t[-1], s.y[:, -1].copy()
            contacts = self.system.dynamics(t, y[:m], y[m:2 * m])[2]
            self.drift = max([self.drift] + [abs(contacts[k][0]) for k in range(self.n)
                                             if modes[k] != 'o'])
            if s.status == 0:
                break
            k, kind = next(w.what for w, at in zip(watches, s.t_events) if len(at))
            before = y[m:2 * m].copy()
            y[m:2 * m], modes, lost = self.after(t, k, kind, y[:m], before, modes)
            y[2 * m] -= lost
            self.events.append({"t": t, "contact": self.system.contacts[k], "kind": kind,
                                "modes": modes, "position": y[:m].tolist(),
                                "velocity_before": before.tolist(),
                                "velocity": y[m:2 * m].tolist()})
        gained = self.system.energy(y[:m], y[m:2 * m]) - total
        self.balance = require("energy", gained - y[2 * m], 1e-11 * (1 + abs(total)))
        require("drift of the contacts", self.drift, 1e-12)
        self.modes, self.last = modes, y
        return np.array(states)


# --------------------------------------------------------------------------------------------------
# The rod.


class Clatter:
    """Rod with restitution e > 0: flights in closed form, impacts one after the other.

    The gap of an end, z -+ l sin(theta + w d) + v_z d - g d^2 / 2 with l = length / 2, has a second
    derivative of at least -(g + l w^2): from gap p with speed p' it stays positive for the larger
    root of p + p' d - (g + l w^2) d^2 / 2. Steps of that size approach the first root from below.
    """

    def __init__(self, rod, friction, restitution, position, velocity, end, least=1e-9):
        self.rod, self.flights, self.events, self.several = rod, [], [], 0
        self.stays = None
        t, q, v = 0.0, np.array(position, float), np.array(velocity, float)
        while t < end:
            self.flights.append((t, q, v))
            d, k = min((self.hits(q, v, k), k) for k in (0, 1))
            if t + d > end or len(self.events) > 1000:
                return
            if d < least and len({e["contact"] for e in self.events[-8:]} | {rod.contacts[k]}) == 1:
                M, _, ends = rod.dynamics(t, q, v)
                self.stays = (t, q, impact(M, ends, [k], v, friction, 0.0)[0][2])
                return
            t += d
            q, before = self.fly(q, v, d)
            M, _, ends = rod.dynamics(t, q, before)
            solutions = impact(M, ends, [k], before, friction, restitution)
            self.several += len(solutions) > 1
            _, mode, v = solutions[0]
            q[1] -= ends[k][0]
            self.events.append({"t": t, "contact": rod.contacts[k], "kind": "impact",
                                "modes": mode, "position": q.tolist(),
                                "velocity_before": before.tolist(), "velocity": v.tolist()})
            speeds = [abs(J[1] @ v) for _, J, _ in ends]
            if max(speeds) < least and max(abs(c[0]) for c in ends) < least**2:
                return

    @staticmethod
    def fly(q, v, d):
        fall = np.array([0, -G, 0])
        return q + v * d + fall * d**2 / 2, v + fall * d

    def hits(self, q, v, k):
        curve = G + self.rod.half * v[2]**2
        total, fresh = 0.0, True
        for _ in range(10000):
            p, u = self.fly(q, v, total)
            gap, J, _ = self.rod.dynamics(0, p, u)[2][k]
            speed = J[1] @ u
            if fresh and abs(gap) < 1e-15 and speed > 0:
                gap = 0.0
            fresh = False
            if gap < 0:
                return total
            step = (speed + math.sqrt(speed**2 + 2 * curve * gap)) / curve
            total += step
            if step <= 1e-16 * total:
                return total
        raise RuntimeError("no impact found")

    def state(self, at):
        t, q, v = [f for f in self.flights if f[0] <= at][-1]
        return np.concatenate(self.fly(q, v, at - t))


def elapsed(rate_squared, start, end):
    """Time from rest at angle `start` down to `end` where theta'^2 = rate_squared(theta).

    theta = start - u^2 takes the root of the denominator away at the start."""
    def density(u):
        angle = start - u * u
        return 2 * u / math.sqrt(rate_squared(angle))
    value, _ = quad(density, 0, math.sqrt(start - end), epsabs=1e-15, epsrel=1e-13, limit=200)
    return value


def painleve(rod, theta, friction, rate, sign):
    """Sliding on end 1, slip of the given sign: (A, B) of the end's normal acceleration A N + B.

    End 1 is at -l (cos, sin), l = length / 2, from the centre and feels N upwards and -sign mu N
    along x. Its moment about the centre is -l N (cos + sign mu sin), and its normal acceleration
    z'' - l cos theta'' + l sin theta'^2, so with k = m l^2 / I
        A = (1 + k cos (cos + sign mu sin)) / m,    B = l sin theta'^2 - g.
    N >= 0, A N + B >= 0, N (A N + B) = 0: unique for A > 0; for A < 0 none where B < 0, two where
    B > 0 (lift off, or N = -B / A)."""
    k = rod.mass * rod.half**2 / rod.inertia
    c, s = math.cos(theta), math.sin(theta)
    return ((1 + k * c * (c + sign * friction * s)) / rod.mass, rod.half * s * rate**2 - G)


# --------------------------------------------------------------------------------------------------
# Entries.


def number(value):
    """To 12 digits; what is below the accuracy of the entries is zero."""
    return 0 if abs(value) < 1e-13 else float(f"{value:.12g}")


def tidy(value):
    if isinstance(value, dict):
        return {k: tidy(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [tidy(v) for v in value]
    return number(value) if isinstance(value, (float, np.floating)) else value


def rows(times, states):
    states = np.array(states)
    n = states.shape[1] // 2
    return {"times": list(times), "positions": states[:, :n], "velocities": states[:, n:]}


def entry(name, scene, robot, friction, restitution, position, velocity, states, events, error,
          **more):
    for e in events:
        if e.get("velocity_before") is not None and np.max(np.abs(np.array(
                e["velocity_before"]) - e["velocity"])) < 1e-12:
            del e["velocity_before"]
    print(f"  {scene:6s}{name:46s}{len(states['times']):4d} states {len(events):3d} events, "
          f"error {error:.1e}")
    given = {"name": name, "robot": robot, "friction": friction,
             "restitution": restitution, "position": [float(x) for x in position],
             "velocity": [float(x) for x in velocity], "error": max(float(f"{error:.0e}"), 1e-12)}
    return {**given, **tidy({**more, **states, "events": events})}


def deviation(closed, motion, times, position, velocity):
    """Largest difference between a closed form and Motion at times below the last one."""
    found = motion.run(position, velocity, times)
    return max(np.max(np.abs(closed(t) - s)) for t, s in zip(times, found))


def particle(name, scene, robot, friction, restitution, position, velocity, end, count=8):
    if scene == "ball":
        along, down, floor, slope = 0.0, G, robot["radius"], 0.0
    else:
        floor, slope = 0.0, robot["slope"]
        along, down = G * math.sin(slope), G * math.cos(slope)
    exact = Particle(along, down, floor, friction, restitution, position, velocity, end)
    # Motion cannot follow bounces without end: it is compared up to the middle of the fourth flight
    until = end
    if restitution > 0 and len(exact.bounces) > 4:
        until = 0.5 * (exact.bounces[3] + exact.bounces[4])
    motion = Motion(Point(robot["mass"], floor, slope), friction, restitution, max_step=0.02)
    times = [until * (k + 1) / 12 for k in range(12)]
    error = require(name, deviation(exact.state, motion, times, position, velocity), 1e-12)
    bounces = exact.bounces[:10]
    marks = [e["t"] for e in exact.events]
    times = []
    for k in range(1, count + 1):  # away from the events, where velocities jump
        t = end * k / count
        while any(abs(t - at) < 1e-3 * end for at in marks):
            t -= 1.1e-3 * end
        times.append(round(t, 6))
    events = [e for e in exact.events if e["kind"] != "touchdown" or e["t"] in bounces[:3]]
    more = {"bounces": bounces} if restitution > 0 else {}
    x, v = exact.phases[-1][1], exact.phases[-1][2]
    if not v.any() and not exact.phases[-1][3].any():
        more.update({"rest": {"t": exact.phases[-1][0], "position": x}})
    return entry(name, scene, robot, friction, restitution, position, velocity,
                 rows(times, [exact.state(t) for t in times]), events, error, **more), exact


def balls():
    out = []
    ball = {"mass": 1.0, "radius": 0.1}
    for arguments in (
            ("lands, slips, slides to rest", ball, 0.3, 0.0, [0, 1.1], [3, 1], 2.0),
            ("lands and sticks", ball, 0.3, 0.0, [0.5, 0.6], [-0.9, 0], 1.0, 6),
            ("point, slides without friction", {"mass": 2.5, "radius": 0.0}, 0.0, 0.0, [0, 0.4],
             [-2, 0.5], 1.0, 6),
            ("bounces, e 0.5", ball, 0.0, 0.5, [0, 1.1], [1, 0], 2.0),
            ("bounces, e 0.8", ball, 0.0, 0.8, [0, 1.1], [-0.5, 0], 5.0),
            ("bounces, e 0.5, slides on", ball, 0.1, 0.5, [0, 1.1], [2, 0], 3.0),
            ("bounces, e 0.8, stops sliding", ball, 0.1, 0.8, [0, 1.1], [2, 0], 5.0)):
        name, robot, *rest = arguments
        out.append(particle(name, "ball", robot, *rest)[0])
    # e = 1: every flight after the first impact lasts 2 v / g, and energy never changes
    end, q, v = 120.0, [0, 1.1], [0.25, 0]
    record, exact = particle("bounces for ever, e 1", "ball", ball, 0.0, 1.0, q, v, end, 8)
    first, period = math.sqrt(2 * 1.0 / G), 2 * math.sqrt(2 * 1.0 / G)
    t = first + 100 * period
    require("bounce 101", exact.bounces[100] - t, 1e-12)
    for k, at in enumerate(record["times"]):  # without the rounding summed over bounces
        d = math.remainder(at, period)
        state = [0.25 * at, 1.1 - G * d**2 / 2, 0.25, -G * d]
        require("e 1", np.max(np.abs(exact.state(at) - state)), 1e-11)
        record["positions"][k], record["velocities"][k] = tidy([state[:2], state[2:]])
    record.update(tidy({"period": period, "bounce_101": t, "energy": G * 1.1}))
    return out + [record]


def blocks():
    out = []

    def block(slope, mass=1.0):
        return {"mass": mass, "slope": slope}

    for slope, friction, v, end, mass in (
            (0.0, 0.3, 2.0, 1.0, 1.0), (0.0, 0.5, -1.5, 0.6, 3.0), (0.3, 0.5, 1.0, 1.0, 1.0),
            (0.3, 0.2, 1.0, 1.0, 1.0), (0.3, 0.5, -2.0, 0.6, 2.0), (0.5, 0.2, -2.0, 1.0, 1.0),
            (-0.4, 0.3, 2.0, 1.5, 0.5), (0.2, 0.0, -1.0, 1.5, 1.0), (1.2, 0.8, -3.0, 1.0, 1.0),
            (0.35, math.tan(0.35) * 0.999, 0.0, 1.0, 1.0),
            (0.35, math.tan(0.35) * 1.001, 0.0, 1.0, 1.0)):
        record, exact = particle(f"slope {slope}, friction {friction:.4f}, speed {v}", "block",
                                 block(slope, mass), friction, 0.0, [0, 0], [v, 0], end, 5)
        along, resist = G * math.sin(slope), friction * G * math.cos(slope)
        if v and v * along - abs(v) * resist < 0:  # v^2 = 2 a d, v = a t against the slip
            a = resist - along * math.copysign(1, v)
            first = exact.events[0]
            require("time to the stop", first["t"] - abs(v) / a, 1e-14)
            require("distance", first["position"][0] - v * abs(v) / (2 * a), 1e-14)
            record.update(tidy({"first_stop": abs(v) / a, "distance": v * abs(v) / (2 * a)}))
        record["stops"] = "rest" in record
        out.append(record)
    out.append(particle("dropped on a slope, slides", "block", block(0.3), 0.4, 0.0, [0, 0.2],
                        [1.5, 0], 1.5, 8)[0])
    out.append(particle("bounces down a slope, e 0.5", "block", block(0.3), 0.2, 0.5, [0, 0.2],
                        [-1, 0], 2.0, 10)[0])
    limit = 0.4 * 2 * G
    for name, slope, friction, mass, pull, frequency, v, end in (
            ("pulled, sticks between slips both ways", 0.0, 0.4, 2.0, 10.0, 1.0, 0.0, 3.0),
            ("pulled, turns without sticking", 0.0, 0.2, 1.0, 20.0, 2.0, 0.0, 1.5),
            ("pulled, ratchets downhill", 0.2, 0.3, 1.0, 2.5, 1.0, 0.0, 3.0),
            ("pulled on a slope, both ways", 0.15, 0.35, 1.0, 8.0, 0.7, -1.0, 4.0),
            ("pulled below the threshold", 0.0, 0.4, 2.0, 0.99 * limit, 1.0, 0.0, 1.0),
            ("pulled above the threshold", 0.0, 0.4, 2.0, 1.02 * limit, 1.0, 0.0, 1.0)):
        exact = Pulled(mass, slope, friction, pull, frequency, v, end)
        motion = Motion(Point(mass, 0.0, slope, pull, frequency), friction, max_step=0.01)
        times = [round(end * (k + 1) / 10, 6) for k in range(10)]
        # the events of Motion, where a reversal without rest is a slip that ends
        error = require(name, deviation(exact.state, motion, times, [0, 0], [v, 0]), 1e-11)
        kinds = [(e["t"], e["modes"]) for e in motion.events]
        if [k[1] for k in kinds] != [e["mode"] for e in exact.events]:
            raise RuntimeError(f"{name}: {kinds} and {exact.events}")
        require(name, max([abs(k[0] - e["t"]) for k, e in zip(kinds, exact.events)] + [0]), 1e-7)
        out.append(entry(name, "block",
                         {"mass": mass, "slope": slope, "pull": pull, "pull_frequency": frequency},
                         friction, 0.0, [0, 0], [v, 0],
                         rows(times, [exact.state(t) for t in times]), exact.events, error,
                         pull_threshold=mass * (exact.resist - abs(exact.slide))))
    return out


def rod_motion(name, rod, friction, position, velocity, times, error=0.0, restitution=0.0, **more):
    """A rod by Motion: half the step and the mirrored rod must agree."""
    motion = Motion(rod, friction, restitution)
    states = motion.run(position, velocity, times)
    half = Motion(rod, friction, restitution, max_step=MAX_STEP / 2)
    error = max(error, np.max(np.abs(half.run(position, velocity, times) - states)))
    turn = np.array([-1, 1, -1])
    mirror = Motion(rod, friction, restitution)
    other = mirror.run(turn * position + [0, 0, math.pi], turn * np.array(velocity), times)
    other[:, :3] = turn * (other[:, :3] - [0, 0, math.pi])
    other[:, 3:] *= turn
    error = max(error, np.max(np.abs(other - states)))
    error = max([error] + [abs(a["t"] - b["t"]) for o in (half, mirror)
                           for a, b in zip(o.events, motion.events)])
    require(name, error, 1e-11)
    if motion.several:
        more["several_solutions"] = motion.several
    return entry(name, "rod", rod.robot(), friction, restitution, position, velocity,
                 rows(times, states), motion.events, error, first_modes=motion.first,
                 **more), motion


def tenths(end, step=0.1):
    return [round(step * k, 6) for k in range(1, round(end / step) + 1)]


def falls(rod=Rod()):
    """A rod let go at 60 degrees with end 1 on the ground."""
    out, angle, l = [], math.pi / 3, rod.half
    position, velocity = rod.on_end1(angle)
    m, I = rod.mass, rod.inertia
    # without friction x stays, z = l sin theta, and energy gives theta'^2
    def smooth(th):
        return 2 * m * G * l * (math.sin(angle) - math.sin(th)) / (I + m * (l * math.cos(th))**2)
    record, motion = rod_motion("falls, no friction", rod, 0.0, position, velocity, tenths(1.0))
    landing = motion.events[0]
    require("landing", landing["t"] - elapsed(smooth, angle, 0.0), 1e-12)
    require("rate", landing["velocity_before"][2] + math.sqrt(smooth(0.0)), 1e-12)
    record.update(tidy({"landing": elapsed(smooth, angle, 0.0), "rate": -math.sqrt(smooth(0.0))}))
    out.append(record)

    for friction in (0.1, 0.3):
        record, motion = rod_motion(f"falls, friction {friction}", rod, friction, position,
                                    velocity, tenths(1.0))
        check_landing(rod, friction, motion.events)
        out.append(record)
    sliding = rod.on_end1(angle, 0.0, 3.0)
    record, motion = rod_motion("falls while it slides, friction 0.1", rod, 0.1, *sliding,
                                tenths(3.6, 0.36))
    check_landing(rod, 0.1, motion.events)
    out.append(record)

    # sticking: a pendulum about end 1, theta'^2 = 2 w (sin(angle) - sin), theta'' = -w cos; the
    # force is m (centre's acceleration) + weight, and it leaves the cone where -T = mu N
    w, friction = m * G * l / (I + m * l * l), 2.0
    def pendulum(th):
        return 2 * w * (math.sin(angle) - math.sin(th))
    def force(th):
        bend, square = -w * math.cos(th), pendulum(th)
        return (m * G + m * l * (bend * math.cos(th) - square * math.sin(th)),
                m * l * (-bend * math.sin(th) - square * math.cos(th)))
    leaves = brentq(lambda th: force(th)[1] + friction * force(th)[0], 0.2, 0.8, xtol=1e-15)
    record, motion = rod_motion("falls, friction 2", rod, friction, position, velocity, tenths(1.0))
    slip = motion.events[0]
    require("slip begins", slip["position"][2] - leaves, 1e-12)
    require("slip begins", slip["t"] - elapsed(pendulum, angle, leaves), 1e-12)
    check_landing(rod, friction, motion.events)
    record.update(tidy({"slip_angle": leaves, "slip_time": elapsed(pendulum, angle, leaves)}))
    out.append(record)
    return out


def check_landing(rod, friction, events):
    """The landing on end 2 with e = 0, flat: the normal problem does not see friction. With
    a = 1/m + l^2/I > b = l^2/I - 1/m >= 0 (inertia_ratio <= 1/4) impulses a r1 - b r2 = 0,
    a r2 - b r1 = V are positive: both ends stay, whatever the friction, so a rod never rocks. Their
    sum is m |z'|, hence x' loses at most friction |z'|."""
    landing = [e for e in events if e["contact"] == "end2"][0]
    x, z, _ = landing["velocity_before"]
    expect = np.array([x - math.copysign(min(friction * abs(z), abs(x)), x), 0, 0])
    require("landing", np.max(np.abs(expect - landing["velocity"])), 1e-11)


def drops():
    out = []
    rod = Rod(0.8, 2.5, 0.15)
    # centre on a parabola, theta at a constant rate
    q, v = np.array([0.2, 3.0, 0.4]), np.array([1.5, 2.0, 7.0])
    times = tenths(0.8)
    states = [np.concatenate([q + v * t - [0, G * t * t / 2, 0], v - [0, G * t, 0]]) for t in times]
    error = np.max(np.abs(Motion(rod, 0.5).run(q, v, times) - states))
    out.append(entry("free flight with spin", "rod", rod.robot(), 0.5, 0.0, q, v,
                     rows(times, states), [], require("flight", error, 1e-12)))
    uniform = Rod()
    small = uniform.on_end1(0.05)
    out.append(rod_motion("tips from 0.05, e 0", uniform, 0.5, *small, tenths(0.4, 0.05))[0])
    out.append(rod_motion("dropped nearly flat, e 0", uniform, 0.5, [0, 0.3, 0.05], [0, 0, 0],
                          tenths(0.4, 0.05))[0])
    for friction, ratio, angle, rate in ((0.5, 1 / 12, 1.0, 2.0), (0.2, 0.2, 0.7, -3.0)):
        out.append(rod_motion(f"dropped on end 1 with spin, friction {friction}",
                              Rod(1.0, 1.0, ratio), friction, [0, 0.9, angle], [0.5, 0, rate],
                              tenths(1.5, 0.15))[0])
    for name, friction, restitution, q, v, end in (
            ("clatters, e 0.5, no friction", 0.0, 0.5, [0, 0.3, 0.05], [0, 0, 0], 0.44),
            ("clatters, e 0.5, friction 0.3", 0.3, 0.5, [0, 0.3, 0.05], [0, 0, 0], 0.44),
            ("dropped on end 1 with spin, e 0.5", 0.5, 0.5, [0, 0.9, 1.0], [0.5, 0, 2.0], 1.0)):
        out.append(clatters(name, uniform, friction, restitution, q, v, end))
    return out


def clatters(name, rod, friction, restitution, q, v, end):
    exact = Clatter(rod, friction, restitution, q, v, end)
    if exact.several:
        raise RuntimeError(f"{name}: several solutions")
    events = exact.events[:6]
    last = events[-1]["t"] if len(exact.events) > 6 else end
    marks = [0] + [e["t"] for e in events]
    times = [round(0.5 * (a + b), 6) for a, b in zip(marks, marks[1:]) if b <= last]
    motion = Motion(rod, friction, restitution)
    error = deviation(exact.state, motion, times, q, v)
    error = max([error] + [abs(a["t"] - b["t"]) for a, b in zip(motion.events, exact.events)])
    return entry(name, "rod", rod.robot(), friction, restitution, q, v,
                 rows(times, [exact.state(t) for t in times]), events,
                 require(name, error, 1e-10))


def paradox():
    """Classification of random slides on end 1, the boundary curve, and jams."""
    rng = np.random.default_rng(1895)
    cases, jams = [], []
    while len(cases) < 165:
        ratio = round(1 / 12, 6) if len(cases) < 130 else round(rng.uniform(0.02, 0.25), 4)
        theta, friction = round(rng.uniform(0.02, math.pi - 0.02), 3), round(rng.uniform(0, 4), 3)
        rate, sign = round(rng.uniform(-8, 8), 2), int(rng.choice([-1, 1]))
        # half of the points where the paradox can be: the rod leans against its slip
        if len(cases) % 2 and sign * math.cos(theta) > 0:
            continue
        rod = Rod(1.0, 1.0, ratio)
        A, B = painleve(rod, theta, friction, rate, sign)
        if abs(A) < 0.02 or abs(B) < 0.05:
            continue
        q, v = (np.array(x) for x in rod.on_end1(theta, rate, float(sign)))
        M, free, ends = rod.dynamics(0, q, v)
        _, J, bias = ends[0]
        push = np.linalg.solve(M, J[1] - sign * friction * J[0])
        require("A", A - J[1] @ push, 1e-12)
        require("B", B - J[1] @ np.linalg.solve(M, free) - bias[1], 1e-12)
        motion = Motion(rod, friction)
        lawful = [m for m in ('fo', 'bo', 'so', 'oo') if motion.lawful(0, q, v, [0], m) is not None]
        kind = ("contact" if B < 0 else "lift-off") if A > 0 else "none" if B < 0 else "two"
        count = {"none": 0, "two": 2}.get(kind, 1)
        if len(lawful) != count:
            raise RuntimeError(f"{lawful} where {kind} was expected")
        force = -B / A if kind in ("contact", "two") else 0.0
        digits = [float(f"{A:.6g}"), float(f"{force:.6g}") if force else 0]
        cases.append([ratio, theta, friction, rate, sign, *digits, kind])
        if kind == "none" and len(jams) < 8:  # an impact without a collision: the end stops dead
            after = [s for s in impact(M, ends, [0], v, friction, 0.0)
                     if np.max(np.abs(s[2] - v)) > 1e-3]
            if len(after) != 1:
                raise RuntimeError(f"{len(after)} jams")
            energy, mode, after = after[0]
            jams.append({"inertia_ratio": ratio, "friction": friction, "position": q.tolist(),
                         "velocity": v.tolist(), "mode": mode[0], "velocity_after": tidy(after),
                         "energy_change": number(energy - 0.5 * v @ M @ v)})
    # A = 0 at mu = (1 + k cos^2) / (k |cos| sin) = (1 + 1/k + tan^2 / k) / |tan|, least at
    # tan^2 = k + 1: 2 sqrt(k + 1) / k, which is 4/3 for the uniform rod (k = 3)
    critical = []
    for ratio in (1 / 12, 0.05, 0.2):
        k = 1 / (4 * ratio)
        at = math.atan(math.sqrt(k + 1))
        curve = [[theta, (1 + k * math.cos(theta)**2) / (k * math.cos(theta) * math.sin(theta))]
                 for theta in (0.2, 0.4, 0.6, 0.8, 1.0, at, 1.2, 1.3, 1.4, 1.5)]
        for theta, friction in curve:
            require("boundary", painleve(Rod(1.0, 1.0, ratio), theta, friction, 0, -1)[0], 1e-13)
        least = 2 * math.sqrt(k + 1) / k
        require("critical friction", min(c[1] for c in curve) - least, 1e-14)
        critical.append({"inertia_ratio": ratio, "friction": least, "theta": at,
                         "boundary": tidy(curve)})
    kinds = [c[-1] for c in cases]
    print("  painleve:", {k: kinds.count(k) for k in sorted(set(kinds))}, "jams of modes",
          ''.join(j["mode"] for j in jams))
    return {"columns": ["inertia_ratio", "theta", "friction", "theta_rate", "slip_sign", "A",
                             "normal_force", "solutions"],
                 "critical": critical, "jams": jams, "cases": cases}


def bipeds():
    out = []
    q, v = [0, 1.5, -0.5, 0.9, -1], [1, 0, 0, 0, 0]
    servo = (200.0, 20.0, np.array(q[3:]))
    system = Biped(Robot(0.5, 0.5, 1, 1, 3), servo)
    times = [round(0.06 * k, 6) for k in range(1, 21)]
    motion = Motion(system, 0.3)
    states = motion.run(q, v, times)
    half = Motion(system, 0.3, max_step=MAX_STEP / 2)
    error = np.max(np.abs(half.run(q, v, times) - states))
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "drop.json")) as file:
        other = json.load(file)["second"]  # by accelerations and forces at once, solved as a saddle
    for t, state in zip(times, states):
        if f"{t:.1f}" in other["states"] and abs(t * 10 - round(t * 10)) < 1e-9:
            row = other["states"][f"{t:.1f}"]
            error = max(error, np.max(np.abs(np.array(row["q"] + row["v"]) - state)))
    error = max([error] + [abs(a["t"] - b["t"]) for a, b in zip(other["events"], motion.events)])
    robot = {"leg_length": 0.5, "trunk_length": 0.5, "foot_mass": 1.0, "trunk_mass": 1.0,
             "hip_mass": 3.0}
    out.append(entry("drop of section 5", "biped", robot, 0.3, 0.0, q, v, rows(times, states),
                     motion.events, require("drop", error, 1e-11), kp=200.0, kd=20.0,
                     target=q[3:], sample_time=0.0, contacts=["foot1", "foot2"]))
    out.append(held())
    return out


def held(kp=200.0, kd=20.0, sample=0.01, count=100):
    """The default robot on foot 1, joint torques sampled every 10 ms and held, foot 2 ignored."""
    l, m = 0.535, 1.8
    robot = Robot(l, l, m, m, 5.4)
    posture = np.array([-0.41, 0.57, 0.82])
    def standing(angles):  # foot 1 at the origin
        trunk, leg = angles[0], angles[0] + angles[1]
        return np.concatenate([[-l * (math.sin(trunk) + math.sin(leg)),
                                l * (math.cos(trunk) + math.cos(leg))], angles])

    start, v, target = standing(posture), np.zeros(5), posture[1:]
    q = start

    def torque(q, v):
        return -kp * (q[3:] - target) - kd * v[3:]

    system, states, margin = Biped(robot), [], math.inf
    motion = Motion(system, 0.8, active=[0])
    for k in range(count):
        system.held = torque(q, v)
        state = motion.run(q, v, [(k + 1) * sample], begin=k * sample)[-1]
        if motion.events or motion.modes != 'so':
            raise RuntimeError("the foot does not stick")
        q, v = state[:5], state[5:]
        push = motion.forces(0, q, v, 'so')[1][0]
        margin = min(margin, 0.8 * push[0] - abs(push[1]))
        states.append(state)

    # the same with the foot's constraint eliminated: v = N w, w the rates of the three angles
    def reduced(t, y, held):
        x = standing(y[:3])
        J = robot.points(x, np.zeros(5))[2][2]
        N = np.vstack([-J[:, 2:], np.eye(3)])
        M, bias, feet = robot.dynamics(x, N @ y[3:])
        turn = np.concatenate([-feet[0][2], np.zeros(3)])
        right = np.concatenate([np.zeros(3), held]) - bias - M @ turn
        return np.concatenate([y[3:], np.linalg.solve(N.T @ M @ N, N.T @ right)])

    y, error = np.concatenate([posture, np.zeros(3)]), 0.0
    for k in range(count):
        held_torque = -kp * (y[1:3] - target) - kd * y[4:]
        y = solve_ivp(reduced, (0, sample), y, method='DOP853', rtol=RTOL, atol=ATOL,
                      args=(held_torque,)).y[:, -1]
        error = max(error, np.max(np.abs(y - np.concatenate([states[k][2:5], states[k][7:]]))))
    every = count // 10
    chosen = [states[k] for k in range(every - 1, count, every)]
    return entry("stands on foot 1, held torques", "biped",
                 {"leg_length": l, "trunk_length": l, "foot_mass": m, "trunk_mass": m,
                  "hip_mass": 5.4}, 0.8, 0.0, start, np.zeros(5),
                 rows(tenths(count * sample, every * sample), chosen), [],
                 require("held", error, 1e-11), kp=kp, kd=kd, target=target, sample_time=sample,
                 contacts=["foot1"], least_margin=margin)


def main():
    out = {"made_by": "/usr/bin/python3 tests/reference/known.py", "gravity": G,
           "ball": balls(), "block": blocks(), "rod": falls() + drops(), "painleve": paradox(),
           "biped": bipeds()}
    parts = []
    for key, value in out.items():
        if isinstance(value, list):
            lines = ",\n".join(json.dumps(v, separators=(',', ':')) for v in value)
            parts.append(f'"{key}": [\n{lines}\n]')
        else:
            parts.append(f'"{key}": {json.dumps(value, separators=(",", ":"))}')
    text = "{" + ",\n".join(parts) + "}\n"
    json.loads(text)  # whole before the file is opened: a failure leaves the old one
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "known.json")
    with open(path, "w") as file:
        file.write(text)
    print(f"known.json: {len(text)} bytes")


if __name__ == "__main__":
    main()
