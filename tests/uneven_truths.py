"""Ground in plates by programs that share nothing with stance: heights, balls, blocks, a wheel and walkers on it.

Heights and places are in the axes of the ground: x along it, z normal to it; a slope only turns gravity. Events
are roots of closed forms, or of dense output of order 8 by Brent's method, to rounding.

The rule of edges: what is above a plate lands on it; what slides over an edge that goes down has lost what it stood
on; what comes into a riser has no ground there, if it came through the air, and goes on at its height, if it stood.
"""
from math import acos, asin, cos, floor, hypot, inf, isinf, pi, sin, sqrt

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

G = 9.81
EXACT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}


# ---- the ground -------------------------------------------------------------------------------------------------
def philox(counter, key):
    """Philox4x64-10: J. K. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC11."""
    whole = 2**64 - 1
    c, k = list(counter), list(key)
    for _ in range(10):
        one, other = 0xD2E7470EE14C6C93 * c[0], 0xCA5A826395121157 * c[2]
        c = [other >> 64 ^ c[1] ^ k[0], other & whole, one >> 64 ^ c[3] ^ k[1], one & whole]
        k = [k[0] + 0x9E3779B97F4A7C15 & whole, k[1] + 0xBB67AE8584CAA73B & whole]
    return c


PLATES = 0x706C6174


class Ground:
    """Pieces as a scenario has them, a dict by name. `begins`: where those before a footfall begin."""
    def __init__(self, plates=None, seed=1, sample=0, begins=None):
        self.pieces = list((plates or {}).values())
        self.place = seed, sample
        given = iter(begins or [])
        self.begin = [next(given, inf) if p.get("footfall") else p["from"] for p in self.pieces]

    def random(self, k, number):
        """-1 ... 1, of a plate of piece k."""
        seed, sample = self.place
        own = self.pieces[k].get("seed")
        counter = (sample if own is None else int(own), own is None, number % 2**64, k)
        return (philox(counter, (seed, PLATES))[0] >> 11) / 2**52 - 1

    def at(self, x, pieces=None):
        """Height, friction by the ground's, and between which places that is so (if nothing ends it earlier)."""
        within = range(len(self.pieces) if pieces is None else pieces)
        here = [k for k in within if self.begin[k] <= x]
        if not here:
            return 0.0, 1.0, -inf, min([self.begin[k] for k in within], default=inf)
        k = here[-1]
        piece, begin = self.pieces[k], self.begin[k]
        low, high = begin, min([self.begin[i] for i in within if i > k and self.begin[i] > x], default=inf)
        height, factor = piece["height"], piece.get("friction_factor", 1)
        if piece.get("kind", "plate") == "plate":
            return height, factor, low, high
        width, count = piece["width"], piece.get("count", inf)
        number = floor((x - begin) / width)
        while x < begin + number * width:
            number -= 1
        while x >= begin + (number + 1) * width:
            number += 1
        past = number >= count
        low, high = begin + (count if past else number) * width, min(high, inf if past else begin + (number + 1) * width)
        before = self.at(begin, k)[0]
        if piece["kind"] == "stairs":
            return before + (count if past else number + 1) * height, factor, low, high
        return before + (0 if past else height * self.random(k, number)), factor, low, high

    def height(self, x):
        return self.at(x)[0]


def root(a, b, c):
    """The first time > 0 at which a t^2 + b t + c is 0, and grows if a sign is asked for. c: 0 is now, and does not count."""
    if a == 0:
        return -c / b if b and -c / b > 0 else inf
    inside = b * b - 4 * a * c
    if inside < 0:
        return inf
    half = -(b + (1 if b >= 0 else -1) * sqrt(inside)) / 2
    times = [half / a] + ([c / half] if half else [])
    return min([t for t in times if t > 0 and (c or t == max(times, key=abs))], default=inf)


# ---- a point in the air and on the ground -------------------------------------------------------------------------
class Point:
    """Mass 1. e: restitution, mu: friction. Landings with friction are plastic."""
    def __init__(self, ground, e=0.0, mu=0.0, slope=0.0):
        assert not (e and mu)
        self.ground, self.e, self.mu = ground, e, mu
        self.pull, self.weight = G * sin(slope), G * cos(slope)
        self.landings, self.inside, self.lay = [], 0.0, False  # inside: how deep a plate it came; did bounces accumulate?

    def move(self, t, ax, az):
        x, z, vx, vz = self.state
        self.state = [x + t * (vx + ax * t / 2), z + t * (vz + az * t / 2), vx + ax * t, vz + az * t]
        self.left -= t
        self.now += t

    def over(self):
        """The plate that it is over, or beyond whose edge it is about to come."""
        x, _, vx, _ = self.state
        at = self.ground.at(x)
        if x == at[2] and vx < 0:
            return self.ground.at(np.nextafter(x, -inf))
        return at

    def edge(self, ax, low, high):
        """When it comes to the end of its plate, and that."""
        x, _, vx, _ = self.state
        return min((root(ax / 2, vx, x - end), end) for end in (low, high) if not isinf(end)) if low > -inf or high < inf else (inf, 0)

    def come_to(self, end):
        self.state[0] = end

    def fly(self):
        """To the next landing, or to the end. A floor that it has it keeps below a surface, if it dropped off an edge."""
        if self.floor is None and self.state[1] >= self.over()[0] - 1e-15:
            self.floor = self.over()[0]
        while self.left > 0:
            height, _, low, high = self.over()
            there, end = self.edge(self.pull, low, high)
            _, z, _, vz = self.state
            fall = inf if self.floor is None else (vz + sqrt(vz * vz + 2 * self.weight * (z - self.floor))) / self.weight
            rise = root(-self.weight / 2, vz, z - height) if z < height and vz > 0 else inf
            t = min(there, fall, rise, self.left)
            self.deeper(self.floor is not None, height, t)
            self.move(t, self.pull, -self.weight)
            if t == there:
                self.come_to(end)
                if self.state[1] >= self.over()[0]:
                    self.floor = self.over()[0]
                elif not self.drops:
                    self.floor = None
            elif t == rise:
                self.state[1] = self.floor = height
            elif t == fall:
                self.state[1] = self.floor
                return self.land(self.floor)
        return None

    def deeper(self, has, height, t):
        if not has:
            _, z, _, vz = self.state
            self.inside = max(self.inside, height - (z + t * (vz - self.weight * t / 2)), height - z)

    def land(self, height):
        x, _, vx, vz = self.state
        self.drops = self.floor < self.over()[0]  # what has come down in a riser keeps that floor there
        self.landings.append((self.now, x, height))
        factor = self.over()[1]
        self.state[2] = vx - (1 if vx > 0 else -1) * min(abs(vx), -self.mu * factor * vz)
        self.state[3] = -self.e * vz

    def rest_of_bounces(self):
        """All that are left, where they end before the next edge and the end; else None."""
        height, (_, _, low, high) = self.floor, self.over()
        seconds = 2 * self.state[3] / (self.weight * (1 - self.e)) if self.e < 1 else inf
        if not (self.state[1] == height and self.state[3] > 0 and seconds < min(self.left, self.edge(self.pull, low, high)[0])):
            return False
        self.lay = True
        self.move(seconds, self.pull, 0)
        self.state[1], self.state[3] = height, 0.0
        return True

    def slide(self):
        """To where it has no ground any more, or to the end."""
        height, (_, factor, low, high) = self.floor, self.over()
        while self.left > 0:
            vx = self.state[2]
            way = (vx > 0) - (vx < 0)
            ax = self.pull - way * self.mu * factor * self.weight
            if way == 0:
                if abs(self.pull) <= self.mu * factor * self.weight:
                    self.left = 0
                    return
                ax = self.pull - (1 if self.pull > 0 else -1) * self.mu * factor * self.weight
            stops = -vx / ax if ax * vx < 0 and self.mu else inf
            there, end = self.edge(ax, low, high)
            if min(stops, there) >= self.left:
                self.move(self.left, ax, 0)
            elif stops <= there:
                self.move(stops, ax, 0)
                self.state[2] = 0.0
            else:
                self.move(there, ax, 0)
                self.come_to(end)
                new, _, low, high = self.over()
                if new < height:
                    self.floor, self.drops = new, True
                    return
                if new > height:
                    self.inside = max(self.inside, new - height)
                else:
                    factor = self.over()[1]

    def go(self, state, seconds):
        """The state after so many seconds."""
        self.state, self.left, self.now = list(map(float, state)), float(seconds), 0.0
        self.floor, self.drops = self.ground.height(self.state[0]), False
        if self.state[1] < self.floor - 1e-15:
            self.floor = None
        while self.left > 0:
            lies = self.state[1] == self.floor and self.state[3] == 0
            if lies or self.rest_of_bounces():
                self.slide()
            else:
                self.fly()
        return np.array(self.state)


# ---- a block on two ends --------------------------------------------------------------------------------------------
class Block:
    """Half as wide as b, half as high as h, in plane motion on the two ends of its underside, which slide on (+x) with
    friction mu. Plastic impacts. States: x, z, angle of the centre, counter-clockwise, and rates."""
    def __init__(self, ground, b, h, mass, inertia, mu):
        self.ground, self.b, self.h, self.m, self.I, self.mu = ground, b, h, mass, inertia, mu

    def arm(self, y, end):
        """From the centre to an end: 0 behind, 1 ahead."""
        s, c, X = sin(y[2]), cos(y[2]), (self.b if end else -self.b)
        return np.array([c * X + s * self.h, s * X - c * self.h])

    def end(self, y, k):
        """Place and velocity of an end."""
        r = self.arm(y, k)
        return y[0] + r[0], y[1] + r[1], y[3] - y[5] * r[1], y[4] + y[5] * r[0]

    def pushes(self, y, k):
        """What a unit of normal force at end k, with the friction of one that slides on, accelerates."""
        r = self.arm(y, k)
        return np.array([-self.mu / self.m, 1 / self.m, (r[0] + self.mu * r[1]) / self.I])

    def normal(self, y, k):
        """How the normal velocity of end k depends on rates."""
        return np.array([0, 1, self.arm(y, k)[0]])

    def forces(self, y, on):
        """Normal forces of the ends that are on."""
        free = np.array([0, -G, 0])
        A = np.array([[self.normal(y, i) @ self.pushes(y, j) for j in on] for i in on])
        b = np.array([self.normal(y, i) @ free - y[5] ** 2 * self.arm(y, i)[1] for i in on])
        return np.linalg.solve(A, -b) if on else np.zeros(0)

    def rates(self, y, on):
        force = self.forces(y, on)
        return np.concatenate([y[3:], np.array([0, -G, 0]) + sum((f * self.pushes(y, k) for k, f in zip(on, force)), np.zeros(3))])

    def strike(self, y, k, on):
        """End k comes down: the plastic impact of those that touch, of all answers the one that holds."""
        touch = sorted(set(on) | {k})
        for some in (touch, [k], [i for i in touch if i != k]):
            A = np.array([[self.normal(y, i) @ self.pushes(y, j) for j in some] for i in some])
            b = np.array([self.normal(y, i) @ y[3:] for i in some])
            P = np.linalg.solve(A, -b)
            after = y[3:] + sum(p * self.pushes(y, i) for i, p in zip(some, P))
            if (P >= 0).all() and all(self.normal(y, i) @ after > -1e-12 for i in touch):
                y = np.concatenate([y[:3], after])
                assert all(self.end(y, i)[2] > 0 for i in some), "an end stops"
                return y, sorted(some)
        raise AssertionError("no impact")

    def go(self, y, seconds):
        """From rest of both ends on their plates; the state after so many seconds, and what happened."""
        y, t, log = np.array(y, dtype=float), 0.0, []
        on = [k for k in (0, 1) if abs(self.end(y, k)[1] - self.ground.height(self.end(y, k)[0])) < 1e-12]
        plate = [list(self.ground.at(self.end(y, k)[0])) for k in (0, 1)]
        while t < seconds:
            events = []
            for k in (0, 1):
                events.append(("edge", k, lambda _, y, k=k: self.end(y, k)[0] - min(plate[k][3], 1e9)))
                if k in on:
                    events.append(("lifts", k, lambda _, y, k=k: -self.forces(y, on)[on.index(k)]))
                    events.append(("stops", k, lambda _, y, k=k: -self.end(y, k)[2]))
                else:
                    events.append(("lands", k, lambda _, y, k=k: plate[k][0] - self.end(y, k)[1]))
            for _, _, event in events:
                event.terminal, event.direction = True, 1
            out = solve_ivp(lambda _, y: self.rates(y, on), (t, seconds), y, events=[e[2] for e in events], **EXACT)
            t, y = out.t[-1], out.y[:, -1]
            if out.status == 0:
                break
            what, k, _ = events[[i for i, e in enumerate(out.t_events) if e.size][0]]
            log.append((what, k, t))
            assert what != "stops", f"end {k} stops at {t}"
            if what == "edge":
                x, z = self.end(y, k)[:2]
                plate[k] = list(self.ground.at(max(x, plate[k][3])))
                assert z > plate[k][0] - 1e-12, "comes into a riser"
                on = [i for i in on if i != k]
            elif what == "lifts":
                on = [i for i in on if i != k]
            else:
                y, on = self.strike(y, k, on)
        return y, log


# ---- a rimless wheel ------------------------------------------------------------------------------------------------
class Wheel:
    """Mass 1, spokes of length 1 in the angle 2 a, inertia I about the hub. Angles of the spoke that stands are against
    the ground's normal, the hub ahead of its foot where they are positive; rates forwards."""
    def __init__(self, ground, inertia, spokes, slope):
        self.ground, self.J, self.a, self.slope = ground, inertia + 1, pi / spokes, slope
        self.kept, self.chord = (inertia + cos(2 * self.a)) / self.J, 2 * sin(self.a)

    def lands(self, x, z):
        """Where the next foot lands that turns about one at x, z: place, height, by how much that is turned down."""
        found, edge = [], x
        while edge < x + self.chord:
            height, _, low, high = self.ground.at(edge)
            down = asin(min(max((z - height) / self.chord, -1), 1))
            place = x + self.chord * cos(down)
            if low <= place < high:
                found.append((place, height, down))
            if low > x and z + sqrt(self.chord**2 - (low - x) ** 2) < height:
                found.append((low, None, -acos((low - x) / self.chord)))
            edge = high
        place, height, down = min(found, key=lambda f: f[2])
        assert height is not None, f"comes into the riser at {place}"
        return place, height, down

    def rate(self, begin, rate, angle):
        """At another angle; 0: it does not come there."""
        square = rate * rate + 2 * G / self.J * (cos(begin + self.slope) - cos(angle + self.slope))
        top = rate * rate + 2 * G / self.J * (cos(begin + self.slope) - 1)
        return 0.0 if square <= 0 or (begin + self.slope < 0 < angle + self.slope and top <= 0) else sqrt(square)

    def seconds(self, begin, rate, angle):
        return quad(lambda p: 1 / self.rate(begin, rate, p), begin, angle, epsabs=1e-13, epsrel=1e-12)[0]

    def stands(self, angle, rate):
        """Normal and tangential force of the foot, whose spoke has this angle and rate."""
        out, on = G * cos(angle + self.slope) - rate * rate, G * sin(angle + self.slope) * (1 / self.J - 1)
        return out * cos(angle) - on * sin(angle), out * sin(angle) + on * cos(angle)

    def struck(self, angle, after):
        """The same of the impulse of a foot that lands, its spoke at this angle then; the hub's change of velocity."""
        before, behind = after / self.kept, angle + 2 * self.a
        return before * sin(behind) - after * sin(angle), after * cos(angle) - before * cos(behind)

    def roll(self, rate, footfalls, x=0.0, angle=0.0, timed=True):
        """From a spoke that stands at x: of each footfall time, place, height, turned so far, rate just after it. None: it
        does not come there."""
        t, z, turned, rows = 0.0, self.ground.height(x), 0.0, []
        for _ in range(footfalls):
            x1, z1, down = self.lands(x, z)
            end = self.a + down
            if not self.rate(angle, rate, end):
                return rows + [None]
            t += self.seconds(angle, rate, end) if timed else 0
            turned += end - angle
            rate = self.kept * self.rate(angle, rate, end)
            forces = [self.stands(p, self.rate(end, rate / self.kept, p)) for p in np.linspace(angle, end, 50)]
            assert all(f[0] > 0 for f in forces), "it lifts off"
            assert all(abs(t) < 3 * n for n, t in forces + [self.struck(end - 2 * self.a, rate)]), "it slips"
            x, z, angle = x1, z1, end - 2 * self.a
            rows.append((t, x, z, turned, rate, angle))
        return rows


# ---- walkers ----------------------------------------------------------------------------------------------------------
class Compass:
    """Straight legs of length l to point feet, a mass m at c below the hip in each, M at the hip. Angles t1 (of the leg
    that stands), t2 against the ground's normal, positive where the foot is ahead of the hip; forward is t1' < 0. A foot
    lands where it is ahead of the one that stands and above the plate that it is over."""
    tolerance = 1e-12

    def __init__(self, l, c, m, M, slope, g=G):
        self.l, self.c, self.m, self.M, self.slope, self.g = l, c, m, M, slope, g
        self.D11, self.D12, self.D22 = (M + m) * l * l + m * (l - c) ** 2, -m * l * c, m * c * c
        self.up, self.down = g * ((M + m) * l + m * (l - c)), g * m * c

    def accelerations(self, y):
        t1, t2, v1, v2 = y
        d, s = self.D12 * cos(t1 - t2), self.D12 * sin(t1 - t2)
        f1 = self.up * sin(t1 - self.slope) - s * v2 * v2
        f2 = s * v1 * v1 - self.down * sin(t2 - self.slope)
        over = self.D11 * self.D22 - d * d
        return (self.D22 * f1 - d * f2) / over, (self.D11 * f2 - d * f1) / over

    def rates(self, _, y):
        return (y[2], y[3], *self.accelerations(y))

    def load(self, y):
        """Normal force, by the weight."""
        (a1, a2), (s1, s2), (c1, c2) = self.accelerations(y), np.sin(y[:2]), np.cos(y[:2])
        hip = -self.l * (s1 * a1 + c1 * y[2] ** 2)
        leg1, leg2 = hip * (self.l - self.c) / self.l, hip + self.c * (s2 * a2 + c2 * y[3] ** 2)
        total = self.M + 2 * self.m
        return (self.M * hip + self.m * (leg1 + leg2)) / (total * self.g) + cos(self.slope)

    def foot(self, y):
        """Of the leg that swings, from the one that stands."""
        return self.l * (sin(y[1]) - sin(y[0])), self.l * (cos(y[0]) - cos(y[1]))

    def impact(self, y):
        """After the foot struck, legs exchanged; how fast the other leaves, and tangential by normal impulse."""
        (s1, s2), (c1, c2), l, c, m = np.sin(y[:2]), np.cos(y[:2]), self.l, self.c, self.m
        hip = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0]])
        one, two = hip + c * np.array([[0, 0, c1, 0], [0, 0, s1, 0]]), hip + c * np.array([[0, 0, 0, c2], [0, 0, 0, s2]])
        A = self.M * hip.T @ hip + m * (one.T @ one + two.T @ two)
        stands, lands = hip + l * np.array([[0, 0, c1, 0], [0, 0, s1, 0]]), hip + l * np.array([[0, 0, 0, c2], [0, 0, 0, s2]])
        before = np.array([-l * c1 * y[2], -l * s1 * y[2], y[2], y[3]])
        after = np.linalg.solve(np.block([[A, -lands.T], [lands, np.zeros((2, 2))]]), np.concatenate([A @ before, [0, 0]]))
        return np.array([y[1], y[0], after[3], after[2]]), stands[1] @ after[:4], after[4] / after[5]

    def swing(self, y, ground, x):
        """The foot that stands at x: (state at the footfall, s), or why there is none."""
        base, heights, edge = ground.height(x), set(), x
        while edge < x + 2 * self.l:
            heights.add(ground.height(edge))
            edge = ground.at(edge)[3]

        def lies(_, y):
            return 1.3 - max(abs(y[0]), abs(y[1]) / 2)

        def turns(_, y):
            """The foot is highest, or lowest: between these it meets a height once."""
            return sin(y[1]) * y[3] - sin(y[0]) * y[2]
        lies.terminal = True
        for seconds in 0.35, 1.3:
            out = solve_ivp(self.rates, (0, seconds * sqrt(self.l * G / self.g) * 3), y, events=[lies, turns], method="DOP853",
                            rtol=self.tolerance, atol=self.tolerance / 10, dense_output=True)
            times, found = [0, *out.t_events[1], out.t[-1]], []
            for begin, end in zip(times, times[1:]):
                for h in heights:
                    above = [self.foot(out.sol(t))[1] - (h - base) for t in (begin, end)]
                    if above[0] > 0 >= above[1]:
                        t = brentq(lambda t, h=h: self.foot(out.sol(t))[1] - (h - base), begin, end, xtol=1e-15, rtol=1e-14)
                        ahead = self.foot(out.sol(t))[0]
                        if ahead > 1e-6 and ground.height(x + ahead) == h:
                            found.append((t, out.sol(t)))
            if found or out.t_events[0].size:
                break
        if not found:
            return None, "it falls"
        t, state = min(found, key=lambda f: f[0])
        if min(self.load(v) for v, s in zip(out.y.T, out.t) if s <= t) <= 0:
            return None, "it flies"
        return (state, t), None

    def walk(self, y, ground, steps, x=0.0):
        """So many steps, or fewer: of each time, place, height, state just after it; and why no more. ground: one, or the one
        of a number of footfalls and where the foot stands then."""
        rows, t = [], 0.0
        y = np.array(y, dtype=float)
        for k in range(steps):
            here = ground(k, x) if callable(ground) else ground
            step, why = self.swing(y, here, x)
            if why:
                return rows, why
            y, seconds = step
            x += self.foot(y)[0]
            y, leaves, _ = self.impact(y)
            if leaves <= 0:
                return rows, "both feet stand"
            t += seconds
            rows.append((t, x, here.height(x), y))
        return rows, None
