#!/usr/bin/env python3
"""Mechanisms by an independent way: maximal coordinates.

Each body has its own (x, z, angle) of its centre of mass; joints are constraints J X'' = bias, and

    [ M  J' ] [ X''     ]   [ F    ]
    [ J  0  ] [ -forces ] = [ bias ]

gives accelerations, with contacts that stick among the constraints. Derivatives are taken by complex
steps in extended precision (18 digits), on the manifold of the constraints. Nothing of the engine's
formulas is used. Compared: inertia, energy, contacts' gaps, points and speeds at random states;
equilibria (nothing accelerates, stationary torques); A, B and contact forces of linearisations; and of
the kernels' algebra accelerations, how contacts answer forces, and the inverse of a step's matrix.

    mechanism_oracle.py PROGRAM      PROGRAM: build/tests/mechanism_numbers; speaks TAP
"""
import itertools
import subprocess
import sys

import numpy as np

REAL, COMPLEX = np.longdouble, np.clongdouble
STEP = REAL(1e-30)
STEP2 = STEP * 1j


def solve(A, b):
    """A x = b by Gauss with row pivots, in extended precision."""
    A, b = np.array(A, dtype=COMPLEX), np.array(b, dtype=COMPLEX)
    b = b.reshape(len(b), -1)
    W = np.hstack([A, b])
    n = len(A)
    for k in range(n):
        p = k + int(np.argmax(np.abs(W[k:, k])))
        W[[k, p]] = W[[p, k]]
        W[k + 1:] -= np.outer(W[k + 1:, k] / W[k, k], W[k])
    for k in range(n - 1, -1, -1):
        W[k, n:] = (W[k, n:] - W[k, k + 1:n] @ W[k + 1:n, n:]) / W[k, k]
    return W[:, n:]


def body(name, joint, parent, mass, inertia, centre, at=(0, 0), **more):
    return dict(name=name, joint=joint, parent=parent, mass=mass, inertia=inertia, centre=centre, at=at, **more)


class Mechanism:
    def __init__(self, name, bodies, contacts=(), actuators=(), gravity=9.81, slope=0.0, reference=(0, 0)):
        self.reference, self.may_refuse = reference, False
        self.name, self.bodies, self.actuators = name, bodies, actuators
        self.gravity, self.slope = REAL(gravity), REAL(slope)
        self.index = {b["name"]: k for k, b in enumerate(bodies)}
        self.contacts, self.declared = [], contacts  # a stop: (0, its lower limit) or (1, its upper one)
        for c in contacts:  # (kind, name, body, at, radius, or to and radius)
            kind, label, on, at, *rest = c
            if kind == "sole":
                first, radius = len(self.contacts), rest[1] if rest[1:] else 0
                self.contacts += [dict(body=on, at=at, radius=radius, grip=first),
                                  dict(body=on, at=rest[0], radius=radius, grip=first)]
            else:
                self.contacts.append(dict(body=on, at=at, radius=rest[0] if rest else 0, grip=len(self.contacts)))
        for b in bodies:
            for side, limit in enumerate(b.get("limits", ())):
                if np.isfinite(limit):
                    self.contacts.append(dict(body=b["name"], grip=None, stop=(side, limit)))
        self.joint = []  # (body, kind) of each coordinate
        for k, b in enumerate(bodies):
            if b["joint"] == "free":
                self.joint += [(k, "x"), (k, "z"), (k, "angle")]
            elif b["joint"] in ("hinge", "slide"):
                self.joint.append((k, b["joint"]))
        self.n = len(self.joint)
        self.postures = list(range(2 if bodies[0]["joint"] == "free" else 0, self.n))
        s = REAL(slope)
        self.normal = np.array([np.sin(s), np.cos(s)])
        self.tangent = np.array([np.cos(s), -np.sin(s)])

    def text(self):
        lines = []
        for b in self.bodies:
            words = ["body", b["name"], b["joint"], b["parent"] or "-", b["mass"], b["inertia"], *b["centre"], *b["at"]]
            for key in ("axis", "angle", "stiffness", "damping", "rest", "armature", "limits"):
                if key in b:
                    words += [key, *(b[key] if isinstance(b[key], tuple) else [b[key]])]
            lines.append(words)
        for kind, label, on, at, *rest in self.declared:
            more = [*rest[0], *rest[1:]] if kind == "sole" else rest
            lines.append([kind, label, on, *at, *more])
        for name, on, limit in self.actuators:
            lines.append(["actuator", name, on, limit])
        lines.append(["reference", *self.reference])
        lines.append(["world", float(self.gravity), float(self.slope)])
        return "\n".join(" ".join(map(str, w)) for w in lines) + "\n"

    # ---- points and joints in maximal coordinates: value, row of X', bias of the acceleration --------
    def point(self, k, local, X, V, way):
        """way . point of body k, its rows and -(rows' X') of a rate constraint."""
        size = len(X)
        e = np.array(local, dtype=COMPLEX) - np.array(self.bodies[k]["centre"], dtype=COMPLEX)
        c, s = np.cos(X[3 * k + 2]), np.sin(X[3 * k + 2])
        arm = np.array([c * e[0] - s * e[1], s * e[0] + c * e[1]])
        row = np.zeros(size, dtype=COMPLEX)
        row[3 * k:3 * k + 2] = way
        row[3 * k + 2] = way[1] * arm[0] - way[0] * arm[1]
        return way @ (X[3 * k:3 * k + 2] + arm), row, (way @ arm) * V[3 * k + 2] ** 2

    def angle(self, k, X):
        """What body k is turned against its parent, or the world, beyond its own angle."""
        row = np.zeros(len(X), dtype=COMPLEX)
        row[3 * k + 2] = 1
        value = X[3 * k + 2] - REAL(self.bodies[k].get("angle", 0))
        if self.bodies[k]["parent"] is not None:
            up = self.index[self.bodies[k]["parent"]]
            row[3 * up + 2] = -1
            value = value - X[3 * up + 2]
        return value, row, 0

    def sliding(self, k, direction, X, V):
        """The way of body k from where its joint is in the parent's frame, along a direction there."""
        up = self.index[self.bodies[k]["parent"]]
        c, s = np.cos(X[3 * up + 2]), np.sin(X[3 * up + 2])
        x, z = np.array(direction, dtype=COMPLEX)
        way, turned = np.array([c * x - s * z, s * x + c * z]), np.array([-s * x - c * z, c * x - s * z])

        def apart(direction):
            return self.minus(self.point(k, (0, 0), X, V, direction),
                              self.point(up, self.bodies[k]["at"], X, V, direction))

        value, row, bias = apart(way)
        off, rates, _ = apart(turned)
        row[3 * up + 2] += off
        rate = V[3 * up + 2]
        return value, row, bias - 2 * rate * (rates @ V) + rate ** 2 * value

    @staticmethod
    def minus(a, b):
        return tuple(x - y for x, y in zip(a, b))

    def constraints(self, X, V):
        out = []
        ways = np.eye(2, dtype=COMPLEX)
        for k, b in enumerate(self.bodies):
            if b["joint"] == "free":
                continue
            if b["parent"] is not None:
                up = self.index[b["parent"]]
                if b["joint"] == "slide":
                    across = (-b["axis"][1], b["axis"][0])
                    out += [self.sliding(k, across, X, V), self.angle(k, X)]
                    continue
                out += [self.minus(self.point(k, (0, 0), X, V, w), self.point(up, b["at"], X, V, w)) for w in ways]
                if b["joint"] == "fixed":
                    out.append(self.angle(k, X))
            elif b["joint"] == "hinge":
                for w in ways:
                    value, row, bias = self.point(k, (0, 0), X, V, w)
                    out.append((value - w @ np.array(b["at"], dtype=COMPLEX), row, bias))
            else:
                axis = np.array(b["axis"], dtype=COMPLEX)
                across = np.array([-axis[1], axis[0]])
                value, row, bias = self.point(k, (0, 0), X, V, across)
                out += [(value - across @ np.array(b["at"], dtype=COMPLEX), row, bias), self.angle(k, X)]
        return out

    def coordinate(self, i, X, V):
        k, kind = self.joint[i]
        b = self.bodies[k]
        if kind in "xz":
            return self.point(k, self.reference, X, V, np.array([kind == "x", kind == "z"], dtype=COMPLEX))
        if kind == "slide":
            axis = np.array(b["axis"], dtype=COMPLEX)
            axis = axis / np.sqrt(axis @ axis)
            if b["parent"] is not None:
                return self.sliding(k, axis, X, V)
            value, row, bias = self.point(k, (0, 0), X, V, axis)
            return value - axis @ np.array(b["at"], dtype=COMPLEX), row, bias
        return self.angle(k, X)

    def contact(self, c, X, V, direction):
        """Gap (0) or tangential travel (1) of a contact."""
        d = self.contacts[c]
        k = self.index[d["body"]]
        if "stop" in d:
            i = [j for j, (on, kind) in enumerate(self.joint) if on == k][0]
            value, row, bias = self.coordinate(i, X, V)
            side, limit = d["stop"]
            return (limit - value, -row, -bias) if side else (value - limit, row, bias)
        way = (self.normal, self.tangent)[direction].astype(COMPLEX)
        value, row, bias = self.point(k, d["at"], X, V, way)
        radius = REAL(d["radius"])
        if direction == 0:
            return value - radius, row, bias
        row[3 * k + 2] += radius
        return value + radius * X[3 * k + 2], row, bias

    def sticking(self, supports):
        out = []
        gripped = set()
        for c, d in enumerate(self.contacts):
            if not supports >> c & 1:
                continue
            out.append((c, 0))
            if d["grip"] is not None and d["grip"] not in gripped:
                gripped.add(d["grip"])
                out.append((c, 1))
        return out

    # ---- states ---------------------------------------------------------------------------------------
    def start(self, q):
        """X near q, along the tree."""
        X = np.zeros(3 * len(self.bodies), dtype=COMPLEX)
        at = {k: i for i, (k, kind) in enumerate(self.joint) if kind in ("angle", "hinge", "slide")}
        origin = {}
        for k, b in enumerate(self.bodies):
            up = self.index[b["parent"]] if b["parent"] is not None else None
            a = X[3 * up + 2] if up is not None else 0
            p = np.array(b["at"], dtype=COMPLEX)
            if up is not None:
                c, s = np.cos(a), np.sin(a)
                p = origin[up] + np.array([c * p[0] - s * p[1], s * p[0] + c * p[1]])
            a = a + REAL(b.get("angle", 0))
            if b["joint"] == "free":
                a = a + q[2]
                c, s, r = np.cos(a), np.sin(a), self.reference
                p = np.array([q[0] - c * r[0] + s * r[1], q[1] - s * r[0] - c * r[1]], dtype=COMPLEX)
            elif b["joint"] == "slide":
                axis = np.array(b["axis"], dtype=COMPLEX)
                axis = axis / np.sqrt(axis @ axis) * q[at[k]]
                turn = X[3 * up + 2] if up is not None else 0
                c, s = np.cos(turn), np.sin(turn)
                p = p + np.array([c * axis[0] - s * axis[1], s * axis[0] + c * axis[1]])
            elif b["joint"] == "hinge":
                a = a + q[at[k]]
            origin[k] = p
            c, s = np.cos(a), np.sin(a)
            e = np.array(b["centre"], dtype=COMPLEX)
            X[3 * k:3 * k + 3] = p[0] + c * e[0] - s * e[1], p[1] + s * e[0] + c * e[1], a
        return X

    def rates(self, X, q_rates):
        zero = np.zeros_like(X)
        rows = [r for _, r, _ in self.constraints(X, zero)]
        S = [self.coordinate(i, X, zero)[1] for i in range(self.n)]
        right = np.zeros((len(X), np.shape(q_rates)[1]), dtype=COMPLEX)
        right[len(rows):] = q_rates
        return solve(np.array(rows + S), right)

    def masses(self):
        return np.array([m for b in self.bodies for m in (b["mass"], b["mass"], b["inertia"])], dtype=COMPLEX)

    def inertia(self, q):
        X = self.start(q)
        V = self.rates(X, np.eye(self.n))
        A = V.T @ (self.masses()[:, None] * V)
        for i, (k, kind) in enumerate(self.joint):
            if kind in ("hinge", "slide"):
                A[i, i] += self.bodies[k].get("armature", 0)
        return A

    def energy(self, q, v):
        X = self.start(q)
        V = self.rates(X, np.array(v, dtype=COMPLEX)[:, None])[:, 0]
        total = (V @ (self.masses() * V)) / 2 + self.gravity * sum(b["mass"] * X[3 * k + 1] for k, b in
                                                                    enumerate(self.bodies))
        for i, (k, kind) in enumerate(self.joint):
            if kind in ("hinge", "slide"):
                b = self.bodies[k]
                total += b.get("armature", 0) * v[i] ** 2 / 2
                total += b.get("stiffness", 0) * (q[i] - b.get("rest", 0)) ** 2 / 2
        return total

    def accelerate(self, X, V, torque, supports=0, force=None, extra=0):
        """X'' and the forces of the sticking rows; `force`: given ones instead; `extra`: on X."""
        size = len(X)
        M = np.diag(self.masses())
        F = np.zeros(size, dtype=COMPLEX) + extra
        F[1::3] -= self.masses()[1::3] * self.gravity
        for i, (k, kind) in enumerate(self.joint):
            if kind not in ("hinge", "slide"):
                continue
            b = self.bodies[k]
            q, row, bias = self.coordinate(i, X, V)
            pull = -b.get("stiffness", 0) * (q - b.get("rest", 0)) - b.get("damping", 0) * (row @ V)
            pull += sum(t for t, (_, on, _) in zip(torque, self.actuators) if on == b["name"])
            F = F + row * (pull + b.get("armature", 0) * bias)
            M = M + b.get("armature", 0) * np.outer(row, row)
        rows = self.constraints(X, V)
        joints = len(rows)
        ground = [self.contact(c, X, V, d) for c, d in self.sticking(supports)]
        if force is None:
            rows = rows + ground
        else:
            F = F + sum((f * row for f, (_, row, _) in zip(force, ground)), np.zeros(size, dtype=COMPLEX))
        J = np.array([r for _, r, _ in rows]).reshape(len(rows), size)
        K = np.block([[M, J.T], [J, np.zeros((len(rows), len(rows)))]])
        x = solve(K, np.concatenate([F, np.array([b for _, _, b in rows], dtype=COMPLEX)]))[:, 0]
        return x[:size], -x[size + joints:]

    def q_rates(self, X, V):
        return np.array([self.coordinate(i, X, V)[1] @ V for i in range(self.n)])

    def q_accelerations(self, X, V, XX):
        """Of coordinates: row X'' minus the bias, which constraints carry with the other sign."""
        out = []
        for i in range(self.n):
            _, row, bias = self.coordinate(i, X, V)
            out.append(row @ XX - bias)
        return np.array(out)

    # ---- about an equilibrium -------------------------------------------------------------------------
    def settle(self, X0, supports, chosen, y):
        """X on the manifold of joints and contacts that stick as at X0, with these coordinates."""
        zero = np.zeros_like(X0)
        stick = self.sticking(supports)
        travel = [self.contact(c, X0, zero, d)[0] if d else 0 for c, d in stick]
        X = X0.copy()
        for _ in range(6):
            rows = self.constraints(X, zero)
            rows += [(v - t, r, b) for (v, r, b), t in zip((self.contact(c, X, zero, d) for c, d in stick), travel)]
            rows += [(v - w, r, b) for (v, r, b), w in zip((self.coordinate(i, X, zero) for i in chosen), y)]
            X = X - solve(np.array([r for _, r, _ in rows]), np.array([v for v, _, _ in rows]))[:, 0]
        return X

    def linearise(self, q, torque, supports, chosen):
        zero = np.zeros(3 * len(self.bodies), dtype=COMPLEX)
        X0 = self.start(q)
        y0 = np.array([q[i] for i in chosen], dtype=COMPLEX)
        p, m = len(chosen), len(torque)
        X0 = self.settle(X0, supports, chosen, y0)
        columns, forces = [], []
        for j in range(2 * p + m):
            X, V, u = X0, zero, np.array(torque, dtype=COMPLEX)
            if j < p:
                y = y0.copy()
                y[j] += STEP2
                X = self.settle(X0, supports, chosen, y)
            elif j < 2 * p:
                rows = [r for _, r, _ in self.constraints(X, zero)]
                rows += [self.contact(c, X, zero, d)[1] for c, d in self.sticking(supports)]
                rows += [self.coordinate(i, X, zero)[1] for i in chosen]
                right = np.zeros(len(X), dtype=COMPLEX)
                right[len(rows) - p + j - p] = STEP2
                V = solve(np.array(rows), right)[:, 0]
            else:
                u[j - 2 * p] += STEP2
            XX, carried = self.accelerate(X, V, u, supports)
            columns.append(self.q_accelerations(X, V, XX)[chosen].imag / STEP)
            forces.append(carried.imag / STEP)
        D, lam = np.array(columns).T, np.array(forces).T
        A, B = np.zeros((2 * p, 2 * p), dtype=REAL), np.zeros((2 * p, m), dtype=REAL)
        A[:p, p:] = np.eye(p)
        A[p:], B[p:] = D[:, :2 * p], D[:, 2 * p:]
        return A, B, lam


# ---- ten mechanisms, and more ----------------------------------------------------------------------
def rabbit(name, feet, slope=0.0, **more):
    bodies = [body("trunk", "free", None, 20, 2.22, (0, 0.2)),
              body("thigh1", "hinge", "trunk", 6.8, 1.08, (0, -0.163)),
              body("thigh2", "hinge", "trunk", 6.8, 1.08, (0, -0.163)),
              body("shank1", "hinge", "thigh1", 3.2, 0.93, (0, -0.128), (0, -0.4), **more),
              body("shank2", "hinge", "thigh2", 3.2, 0.93, (0, -0.128), (0, -0.4), **more)]
    actuators = [("hip1", "thigh1", 150), ("knee1", "shank1", 150), ("hip2", "thigh2", 150), ("knee2", "shank2", 150)]
    contacts = [("point", "foot1", "shank1", (0, -0.4)), ("point", "foot2", "shank2", (0, -0.4))]
    if feet:
        bodies += [body(f"foot{k}", "hinge", f"shank{k}", 1.1, 0.01, (0.05, -0.03), (0, -0.4)) for k in (1, 2)]
        actuators += [("ankle1", "foot1", 80), ("ankle2", "foot2", 80)]
        contacts = [("sole", f"sole{k}", f"foot{k}", (-0.08, -0.06), (0.17, -0.06)) for k in (1, 2)]
    return Mechanism(name, bodies, contacts, actuators, slope=slope)


def mechanisms():
    legs = [body(f"leg{k}", "hinge", "hip", 1.8, 0, (0, -0.535)) for k in (1, 2)]
    yield Mechanism(
        "star", [body("trunk", "free", None, 1.8, 0, (0, 0)), body("hip", "fixed", "trunk", 5.4, 0, (0, 0), (0, -0.535)),
                 *legs], [("point", "foot1", "leg1", (0, -0.535)), ("point", "foot2", "leg2", (0, -0.535))],
        [("hip1", "leg1", 10), ("hip2", "leg2", 10)]), [
            (1, [-0.41, None, 0.82]), (2, [-0.41, 0.82, None]), (1, [0.2, None, -0.3]), (3, [None, 0.3, None])]
    yield rabbit("RABBIT on a slope", False, 0.1, limits=(-2.5, 0)), [
        (1, [-0.1, None, 0.6, -0.3, -0.5]), (2, [0.05, 0.5, None, -0.4, -0.2]), (3, [None, 0.4, None, -0.4, -0.3]),
        (3, [0.0, None, None, None, -0.3]), (1, [-0.1, None, 0.6, None, -0.5]), (9, [-0.1, None, 0.6, None, -0.5])]
    yield Mechanism("triple pendulum", [
        body("a", "hinge", None, 1, 0.02, (0, -0.5), (0.1, 2)), body("b", "hinge", "a", 0.7, 0.01, (0.05, -0.3), (0, -1)),
        body("c", "hinge", "b", 0.4, 0.005, (0, -0.2), (0, -0.6))], [("point", "tip", "c", (0, -0.4))]), [
            (0, [None] * 3), (0, [None] * 3, 3), (0, [None] * 3, 7)]
    yield Mechanism("cart-pole on a tilted rail", [
        body("cart", "slide", None, 1, 0, (0, 0), (0.3, 0.2), axis=(2, 0.7), limits=(-2, 2), armature=0.3, damping=0.4),
        body("pole", "hinge", "cart", 0.1, 0.00833, (0.02, 0.5), (0, 0.1), damping=0.01)], [],
        [("push", "cart", 20)]), [(0, [0.5, None]), (0, [0.0, None], 1), (0, [None, None])]
    tree = [body("base", "free", None, 3, 0.1, (0.05, 0.1)),
            body("arm", "hinge", "base", 1, 0.02, (0.1, 0.2), (0.1, 0.3), stiffness=30, rest=0.4, damping=0.7),
            body("hand", "hinge", "arm", 0.3, 0.004, (0.1, -0.02), (0.3, 0.1), armature=0.05, stiffness=5, rest=-0.3),
            body("pack", "fixed", "base", 0.8, 0.03, (-0.1, 0.05), (-0.1, 0.2)),
            body("leg1", "hinge", "base", 2, 0.05, (0.03, -0.2), (-0.1, -0.1), armature=0.2, damping=0.3),
            body("leg2", "hinge", "base", 2, 0.05, (0.03, -0.2), (0.15, -0.1), armature=0.2)]
    yield Mechanism(
        "tree with springs", tree, [("point", "foot1", "leg1", (0, -0.5)), ("disc", "foot2", "leg2", (0.02, -0.45), 0.06)],
        [("hip1", "leg1", 60), ("hip2", "leg2", 60)], slope=-0.15, reference=(0.2, -0.1)), [
            (1, [None, None, None, 0.1, 0.2]), (2, [0.1, None, None, 0.4, None]), (3, [None, None, None, 0.2, None]),
            (3, [None, None, None, None, None])]
    yield Mechanism("pinned tree", [
        body("post", "hinge", None, 2, 0.1, (0.1, 0.3), (0, 0.2), stiffness=80, rest=0.1, damping=2),
        body("plate", "fixed", "post", 1, 0.02, (0.1, 0), (0.1, 0.6)),
        body("left", "hinge", "plate", 1, 0.02, (-0.2, 0.05), (-0.2, 0.1), armature=0.1),
        body("right", "hinge", "plate", 1.5, 0.03, (0.25, 0), (0.2, 0.1), stiffness=20, rest=0.3, limits=(-1, 0.25)),
        body("end", "hinge", "left", 0.5, 0.01, (-0.1, 0.1), (-0.4, 0.1), damping=0.05)],
        [("point", "tip", "end", (-0.2, 0.2))], [("shoulder", "left", 30), ("wrist", "end", 10)], gravity=5), [
            (0, [None, 0.4, None, -0.3]), (0, [None] * 4)]
    yield rabbit("RABBIT with feet", True, 0.05), [
        (3, [0.0, None, 0.4, -0.3, -0.5, None, 0.2]), (15, [None, None, 0.4, -0.5, None, None, None]),
        (1, [0.0, None, 0.4, -0.3, -0.5, 0.1, 0.2])]
    chain = [body("link1", "free", None, 1, 0.02, (0, 0.25))]
    for k in range(2, 7):
        chain.append(body(f"link{k}", "hinge", f"link{k - 1}", 1 / k, 0.02 / k, (0.01 * k, 0.25), (0, 0.5)))
    yield Mechanism("chain of 6", chain, [("point", "root", "link1", (0, 0)), ("point", "tip", "link6", (0, 0.5))],
                    [(f"joint{k}", f"link{k}", 40 if k % 2 else float("inf")) for k in range(2, 7)]), [
                        (1, [0.2, -0.3, 0.4, None, 0.1, -0.2]), (1, [None, 0.5, -0.3, 0.2, 0.1, -0.2]),
                        (1, [0.3, None, None, None, None, None])]
    yield Mechanism("compass gait with discs", [
        body("leg1", "free", None, 5, 0.05, (0, -0.5)), body("hip", "fixed", "leg1", 10, 0, (0, 0)),
        body("leg2", "hinge", "leg1", 5, 0.05, (0, -0.5))],
        [("disc", "foot1", "leg1", (0, -0.7), 0.3), ("disc", "foot2", "leg2", (0, -0.7), 0.3)], [("hip", "leg2", 50)],
        slope=0.0523598775598299), [(1, [None, 0.3]), (1, [None, None]), (3, [None, 0.4])]
    yield Mechanism("acrobot", [
        body("upper", "hinge", None, 1, 0.083, (0, -0.5)), body("lower", "hinge", "upper", 1, 0.33, (0, -1), (0, -1))],
        [], [("elbow", "lower", 30)]), [(0, [None, None]), (0, [None, None], 3), (0, [None, 0.5]), (0, [None, 0.5], 1)]


def sliding():
    yield Mechanism("hopper", [
        body("leg", "free", None, 4, 0.1, (0.02, 0.1)),
        body("shoe", "slide", "leg", 0.5, 0.001, (0.01, 0), (0, -0.3), axis=(0, -1), stiffness=3000, damping=5,
             rest=0.2, limits=(0, 0.25), armature=0.1)],
        [("point", "foot", "shoe", (0, -0.05))], [("thrust", "shoe", 500)], slope=0.1), [(1, [None, None]), (1, [None, 0.12])]
    yield Mechanism("two slides with a hinge beyond", [
        body("base", "free", None, 3, 0.1, (0.05, 0.1)),
        body("boom", "slide", "base", 1, 0.02, (0.1, 0.02), (0.1, 0.3), axis=(3, 1), damping=0.7, stiffness=40, rest=0.2),
        body("mast", "slide", "boom", 0.7, 0.03, (0.05, 0.2), (0.2, 0.1), axis=(-0.5, 1), armature=0.2),
        body("plate", "fixed", "mast", 0.4, 0.02, (0.1, 0.1), (0.1, 0.1)),
        body("hand", "hinge", "plate", 0.5, 0.01, (0.1, -0.2), (0.05, 0.3), stiffness=5),
        body("nail", "slide", "hand", 0.2, 0.002, (0.03, 0.02), (0.1, 0.05), axis=(1, 0), stiffness=80),
        body("leg", "hinge", "boom", 1.5, 0.04, (0, -0.3), (0.02, -0.1))],
        [("point", "tip", "nail", (0.1, 0.02)), ("disc", "foot", "leg", (0, -0.5), 0.06),
         ("sole", "pad", "boom", (-0.1, -0.3), (0.2, -0.35))],
        [("push", "boom", 100), ("lift", "mast", 100), ("hip", "leg", 30)], slope=-0.2), [
            (2, [None] * 6), (2, [None, 0.1, 0.3, None, None, None]), (12, [None, 0.1, None, None, None, 0.2])]
    yield Mechanism("gantry", [
        body("bridge", "slide", None, 3, 0, (0, 0), (0.1, 2), axis=(1, 0.1), damping=1),
        body("trolley", "slide", "bridge", 1, 0.1, (0.1, 0.2), (0.2, 0.1), axis=(0.2, -1), stiffness=30),
        body("load", "hinge", "trolley", 0.6, 0.02, (0.01, -0.5), (0.1, -0.1))],
        [("point", "hook", "load", (0, -0.6)), ("disc", "wheel", "trolley", (0.1, -0.2), 0.1)],
        [("drive", "bridge", 50), ("winch", "trolley", 80)]), [(0, [0.2, None, None]), (0, [0.2, 0.4, None], 1)]


def random_mechanism(random, number, slides):
    """Any tree, a share of its joints slides: its equilibria may be refused."""
    def pair(size):
        return tuple(float(x) for x in np.where(random.random(2) < 0.3, 0, random.uniform(-size, size, 2)))

    root = ("free", "free", "hinge", "slide")[number % 4]
    bodies, contacts, actuators = [], [], []
    turning = 0
    for k in range(random.integers(2, 9)):
        joint = root if k == 0 else "fixed" if random.random() < 0.2 else "hinge"
        if joint == "hinge" and k > 0 and slides > 0 and random.random() < slides:
            joint = "slide"
        turning += joint in ("hinge", "free") or (joint == "slide" and k > 0)
        if turning > 7:
            break
        more = {}
        if random.random() < 0.3:
            more["angle"] = random.uniform(-3, 3)
        if joint in ("hinge", "slide"):
            if random.random() < 0.3:
                more.update(stiffness=random.uniform(0, 50), damping=random.uniform(0, 5), rest=random.uniform(-1, 1))
            if random.random() < 0.3:
                more["armature"] = random.uniform(0, 0.5)
            if random.random() < 0.2 and len(contacts) < 3:
                more["limits"] = (random.uniform(-3, -2), random.choice([float("inf"), 2.5]))
            actuators += [(f"motor{k}", f"b{k}", random.choice([100, float("inf")]))] if random.random() < 0.6 else []
        if joint == "slide":
            more["axis"] = (random.uniform(0.2, 1), random.uniform(-1, 1))
        parent = f"b{random.integers(k)}" if k else None
        bodies.append(body(f"b{k}", joint, parent, random.uniform(0.1, 5), random.uniform(0.01, 1), pair(0.5),
                           (0, 0) if joint == "free" else pair(0.7), **more))
        if len(contacts) < 3 and (root != "slide" or joint == "hinge") and random.random() < 0.5:
            shape = ("point", "disc", "sole", "capsule")[random.integers(4)]
            rest = {"point": [], "disc": [random.uniform(0.05, 0.4)], "sole": [pair(0.5)],
                    "capsule": [pair(0.5), random.uniform(0.05, 0.4)]}[shape]
            kind = "sole" if shape == "capsule" else shape
            contacts.append((kind, f"c{k}", f"b{k}", pair(0.5), *rest))
    m = Mechanism(f"random tree {number}, {root}{', slides' if slides else ''}", bodies, contacts, actuators[:6], random.uniform(1, 20),
                  random.uniform(-0.3, 0.3), pair(0.3) if root == "free" else (0, 0))
    m.may_refuse = True
    cases = []
    for _ in range(6):
        given = [None if random.random() < 0.5 else float(random.uniform(-1, 1)) for _ in m.postures]
        mask = random.integers(1, 1 << len(contacts)) if root == "free" and contacts else 0
        cases.append((mask, given))
    return m, cases


LISTS = "point", "speed", "contact", "answer"  # lines of which there are several


# ---- comparison -------------------------------------------------------------------------------------
def answers(program, text):
    out, block = [], None
    for line in subprocess.run([program], input=text, text=True, capture_output=True, check=True).stdout.splitlines():
        name, _, rest = line.partition(" ")
        if name == "begin":
            block = {name: [] for name in LISTS}
            out.append(block)
        elif name in ("refused", "remark"):
            block[name] = rest
        else:
            numbers = np.array([REAL(x) for x in rest.split()])
            block[name] = block[name] + [numbers] if name in LISTS else numbers
    return out


class Check:
    def __init__(self):
        self.worst = {}

    def near(self, what, got, wanted, scale=None):
        got, wanted = np.asarray(got, dtype=REAL).ravel(), np.asarray(wanted, dtype=REAL).ravel()
        assert got.shape == wanted.shape, f"{what}: {got.shape} instead of {wanted.shape}"
        if len(got) == 0:
            return
        scale = max(1e-300, float(np.max(np.abs(wanted)))) if scale is None else scale
        off = float(np.max(np.abs(got - wanted))) / scale
        self.worst[what] = max(self.worst.get(what, 0), off)
        assert off <= 1e-12, f"{what}: off by {off:.3g} of {scale:.3g}"


def random_states(m, random, count):
    for _ in range(count):
        yield random.uniform(-2, 2, m.n), random.uniform(-5, 5, m.n)


def compare_state(m, check, q, v, a):
    q, v = q.astype(REAL), v.astype(REAL)
    X = m.start(q)
    zero = np.zeros_like(X)
    V = m.rates(X, v.astype(COMPLEX)[:, None])[:, 0]
    check.near("joints close", [abs(c[0]) for c in m.constraints(X, zero)], np.zeros(len(m.constraints(X, zero))), 1)
    check.near("inertia", a["inertia"], m.inertia(q).real)
    check.near("energy", a["energy"], [m.energy(q, v).real], scale=float(abs(m.energy(q, v)) + 1))
    check.near("gap", a["gap"], [m.contact(c, X, zero, 0)[0].real for c in range(len(m.contacts))], 5)
    for c, d in enumerate(m.contacts):
        rates = [(m.contact(c, X, zero, k)[1] @ V).real for k in (1, 0)]
        if "stop" in d:
            rates[0] = 0
        else:
            p = [m.point(m.index[d["body"]], d["at"], X, zero, w)[0] for w in np.eye(2, dtype=COMPLEX)]
            check.near("contact point", a["point"][c], (np.array(p) - REAL(d["radius"]) * m.normal).real, 5)
        check.near("contact speed", a["speed"][c], rates, 10)


def compare_push(m, check, q, v, torque, a):
    X = m.start(q.astype(REAL))
    V = m.rates(X, v.astype(REAL).astype(COMPLEX)[:, None])[:, 0]
    XX, _ = m.accelerate(X, V, torque)
    wanted = m.q_accelerations(X, V, XX).real
    scale = float(np.max(np.abs(wanted)))
    check.near("acceleration", a["acceleration"], wanted)

    def row(c, direction):  # friction of a sole acts at its lower end
        ends = [k for k, d in enumerate(m.contacts) if d["grip"] is not None and d["grip"] == m.contacts[c]["grip"]]
        if direction == 1 and len(ends) > 1:
            c = min(ends, key=lambda k: m.contact(k, X, V, 0)[0].real)
        if direction == 1 and not ends:
            return np.zeros_like(X), 0
        return m.contact(c, X, V, direction)[1:]

    rows = [[row(c, d) for d in (0, 1)] for c in range(len(m.contacts))]
    for c, pair in enumerate(rows):
        check.near("contact's acceleration", a["contact"][c], [(r @ XX - b).real for r, b in pair], scale)
    answer = iter(a["answer"])
    for c, d in enumerate(m.contacts):
        for direction in range(2 if d["grip"] == c else 1):
            push, _ = m.accelerate(X, V, torque, extra=rows[c][direction][0])
            D = np.array([[(r @ (push - XX)).real for r, _ in pair] for pair in rows])
            for k, line in enumerate(D):
                check.near("answer to a force", next(answer), line, max(float(np.max(np.abs(D))), 1e-3))


def compare_step(m, check, theta, h, q, before, after, impulse, a):
    """The inverse of dP/dw, P = A(u) (w - w0) - h F(u, v) - H' r, against complex steps."""
    J = []
    for k in range(m.n):
        w = np.array(after, dtype=COMPLEX)
        w[k] += STEP2
        v = (1 - REAL(theta)) * before + REAL(theta) * w
        u = q + REAL(h) * REAL(theta) * v
        X = m.start(u)
        basis = m.rates(X, np.eye(m.n))
        V = basis @ v
        XX, _ = m.accelerate(X, V, [0] * len(m.actuators))
        P = m.inertia(u) @ (w - before - REAL(h) * m.q_accelerations(X, V, XX))
        for c, d in enumerate(m.contacts):
            for direction in range(2 if d["grip"] == c else 1):
                on = c
                if direction == 1:  # a sole's at its lower end
                    on = min((e for e, o in enumerate(m.contacts) if o["grip"] == d["grip"]),
                             key=lambda e: m.contact(e, X, V, 0)[0].real)
                P = P - basis.T @ m.contact(on, X, V, direction)[1] * REAL(impulse[2 * c + direction])
        J.append(P.imag / STEP)
    J = np.array(J).T
    check.near("inverse of the step's matrix", a["inverse"], solve(J, np.eye(m.n)).real.T)


def free_conditions(m, given, supports, q0, torque, force):
    """Conditions on u = (free coordinates, torques, forces), in their gradient at the equilibrium."""
    free = [i for i in m.postures if given[m.postures.index(i)] is None] + ([1] if m.bodies[0]["joint"] == "free" else [])
    stick = m.sticking(supports)
    u0 = np.concatenate([[q0[i] for i in free], torque, force]).astype(COMPLEX)

    def conditions(u):
        q = np.array(q0, dtype=COMPLEX)
        q[free] = u[:len(free)]
        X = m.start(q)
        zero = np.zeros_like(X)
        XX, _ = m.accelerate(X, zero, u[len(free):len(free) + len(torque)], supports, u[len(free) + len(torque):])
        return np.concatenate([m.q_accelerations(X, zero, XX), [m.contact(c, X, zero, 0)[0] for c, d in stick if d == 0]])

    J = []
    for k in range(len(u0)):
        u = u0.copy()
        u[k] += STEP2
        J.append(conditions(u).imag / STEP)
    return np.array(J, dtype=float).T, len(free)


def compare_rest(m, check, case, a):
    supports, given = case[0], case[1]
    assert "refused" not in a, a.get("refused")
    q, torque = a["position"], a["torque"]
    stick = m.sticking(supports)
    force = np.array([a["force"][2 * c + d] for c, d in stick], dtype=REAL)
    X = m.start(q)
    zero = np.zeros_like(X)
    for value, i in zip(given, m.postures):
        assert value is None or value == float(q[i]), "given coordinates stay"
    XX, _ = m.accelerate(X, zero, torque, supports, force)
    check.near("nothing accelerates", m.q_accelerations(X, zero, XX).real, np.zeros(m.n), 100)
    gaps = [m.contact(c, X, zero, 0)[0].real for c, d in stick if d == 0]
    check.near("supports touch", gaps, np.zeros(len(gaps)), 1)
    # The torques are stationary among all equilibria.
    # One without a limit weighs as the strongest of the others, forces with the mechanism's size.
    size = sum(np.sum(np.abs(b["centre"])) + np.sum(np.abs(b["at"])) * (k > 0) for k, b in enumerate(m.bodies)) or 1
    unit = np.array([1 if m.bodies[m.index[on]]["joint"] == "slide" else size for _, on, _ in m.actuators])
    limit = np.array([x for _, _, x in m.actuators])
    finite = np.isfinite(limit)
    limit = np.where(finite, limit, unit * (max((limit / unit)[finite]) if any(finite) else 1))
    J, free = free_conditions(m, given, supports, q, torque, force)
    if len(torque):
        scale = np.concatenate([np.ones(free), limit, 100 * np.ones(len(force))])
        _, s, Vt = np.linalg.svd(J * scale)
        Z = Vt[np.sum(s > 1e-9 * s[0]):] * scale
        gradient = np.concatenate([np.zeros(free), np.array(torque / limit**2, dtype=float), np.zeros(len(force))])
        if len(Z):
            stationary = Z @ gradient
            worst = float(np.max(np.abs(stationary)))
            check.worst["stationary"] = max(check.worst.get("stationary", 0), worst)
            assert worst < 1e-8, f"torques not stationary: {worst:.3g}"
    chosen = [int(i) for i in a["freedom"]]
    if m.may_refuse and len(m.constraints(X, zero)) + len(stick) + len(chosen) != len(X):
        return  # supports that strain each other
    A, B, lam = m.linearise(q, torque, supports, chosen)
    check.near("A", a["A"], A)
    check.near("B", a["B"], B)
    if stick:
        where = [c for c in range(len(m.contacts)) if supports >> c & 1]
        wanted = np.zeros((2 * len(where), lam.shape[1]), dtype=REAL)
        for row, (c, d) in zip(lam, stick):
            wanted[2 * where.index(c) + d] = row
        states = 2 * len(chosen)
        check.near("force by state", a["by_state"], wanted[:, :states])
        check.near("force by torque", a["by_torque"], wanted[:, states:])


def self_check(m, random):
    """The oracle's own accelerations: power in, energy out."""
    q, v = random.uniform(-2, 2, m.n).astype(REAL), random.uniform(-5, 5, m.n).astype(REAL)
    torque = random.uniform(-5, 5, len(m.actuators)).astype(REAL)
    X = m.start(q)
    V = m.rates(X, v.astype(COMPLEX)[:, None])[:, 0]
    XX, _ = m.accelerate(X, V, torque)
    a = m.q_accelerations(X, V, XX).real
    gained = m.energy(q + STEP2 * v, v + STEP2 * a).imag / STEP
    power = sum(t * v[m.joint.index((m.index[on], m.bodies[m.index[on]]["joint"]))]
                for t, (_, on, _) in zip(torque, m.actuators))
    power -= sum(m.bodies[k].get("damping", 0) * v[i]**2 for i, (k, kind) in enumerate(m.joint) if kind in ("hinge", "slide"))
    assert abs(gained - power) < 1e-14 * (1 + abs(power) + np.sum(np.abs(a * v))), f"power {power}, energy {gained}"


def main():
    random, chance = np.random.default_rng(1), np.random.default_rng(2)
    bad = 0
    random_ones = (random_mechanism(random, k, 0.4 * (k >= 20)) for k in range(40))
    for number, (m, cases) in enumerate(itertools.chain(mechanisms(), random_ones, sliding()), 1):
        check = Check()
        try:
            for _ in range(5):
                self_check(m, random)
            states = list(random_states(m, random, 5 if m.may_refuse else 20))
            lines = [" ".join(["state", *map(repr, map(float, [*q, *v]))]) for q, v in states]
            pushes = [(q, v, random.uniform(-20, 20, len(m.actuators))) for q, v in states]
            lines += [" ".join(["push", *map(repr, map(float, [*q, *v, *t]))]) for q, v, t in pushes]
            lines += [" ".join(["rest", str(c[0]), str(c[2] if len(c) > 2 else 0),
                                *("nan" if x is None else repr(x) for x in c[1])]) for c in cases]
            steps = [(chance.choice([0.5, 1]), 10 ** chance.uniform(-4, -1.5), q, v, v + chance.uniform(-1, 1, m.n),
                      chance.uniform(-1, 1, 2 * len(m.contacts)))
                     for q, v in states if m.reference == (0, 0)]
            lines += [" ".join(["step", *(repr(float(x)) for x in np.hstack(step))]) for step in steps]
            said = answers(sys.argv[1], m.text() + "\n".join(lines) + "\n")
            for (q, v), a in zip(states, said):
                compare_state(m, check, q, v, a)
            for (q, v, t), a in zip(pushes, said[len(states):]):
                compare_push(m, check, q, v, t, a)
            for step, a in zip(steps, said[2 * len(states) + len(cases):]):
                q = tuple(np.asarray(x, dtype=REAL) for x in step[2:5])
                compare_step(m, check, *step[:2], *q, step[5], a)
            for case, a in zip(cases, said[2 * len(states):]):
                if m.may_refuse and "refused" in a:
                    continue
                try:
                    compare_rest(m, check, case, a)
                except AssertionError as error:
                    raise AssertionError(f"rest {case}: {error}") from None
            print(f"ok {number} - {m.name}")
        except AssertionError as error:
            bad += 1
            print(f"not ok {number} - {m.name}\n# {error}")
        print("# " + ", ".join(f"{k} {v:.1e}" for k, v in check.worst.items()))
    print(f"1..{number}")
    return bad > 0


sys.exit(main())
