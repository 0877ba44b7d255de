"""The biped in the paper's own coordinates, derived from body Jacobians: an oracle for the tests.

q = (x, z, theta, q1, q2). Every body's position is written down, differentiated by hand, and
M = sum m J^T J, bias = sum m J^T (dJ/dt v) + gravity. Shares nothing with the C engine, which works
in hip coordinates with an arrow-shaped inertia matrix.
"""
import numpy as np

G = 9.81


class Robot:
    def __init__(self, l, lt, m, mt, mh):
        self.l, self.lt, self.m, self.mt, self.mh = l, lt, m, mt, mh

    def points(self, q, v):
        """[(mass, position, J (2x5), dJ/dt v)] of trunk, hip, foot 1, foot 2."""
        x, z, th, q1, q2 = q
        dth = v[2]
        l, lt = self.l, self.lt
        J = np.zeros((2, 5))
        J[0, 0] = J[1, 1] = 1
        out = [(self.mt, np.array([x, z]), J.copy(), np.zeros(2))]
        s, c = np.sin(th), np.cos(th)
        hip = np.array([x + lt * s, z - lt * c])
        Jh = J.copy()
        Jh[:, 2] = lt * np.array([c, s])
        bias_hip = lt * dth**2 * np.array([-s, c])
        out.append((self.mh, hip, Jh, bias_hip))
        for k in (0, 1):
            phi, dphi = th + q[3 + k], dth + v[3 + k]
            s, c = np.sin(phi), np.cos(phi)
            Jf = Jh.copy()
            Jf[:, 2] += l * np.array([c, s])
            Jf[:, 3 + k] = l * np.array([c, s])
            out.append((self.m, hip + l * np.array([s, -c]), Jf,
                        bias_hip + l * dphi**2 * np.array([-s, c])))
        return out

    def dynamics(self, q, v):
        """M, bias with M a + bias = torque + forces; and (position, J, dJ/dt v) of the feet."""
        M, bias = np.zeros((5, 5)), np.zeros(5)
        pts = self.points(q, v)
        for mass, _, J, jv in pts:
            M += mass * J.T @ J
            bias += mass * J.T @ (jv + np.array([0, G]))
        return M, bias, [p[1:] for p in pts[2:]]

    def energy(self, q, v):
        return sum(mass * (0.5 * np.sum((J @ v)**2) + G * p[1]) for mass, p, J, _ in self.points(q, v))


def impact_solutions(M, feet, v, mu, e=0.0, tol=1e-9):
    """Every solution of the frictional impact problem of the feet given as Jacobians (2x5; row 0
    tangential x, row 1 normal z): modes, impulses, velocity after, kinetic energy change."""
    import itertools
    Minv = np.linalg.inv(M)
    found = []
    for modes in itertools.product('osfb', repeat=len(feet)):
        rows, columns, want = [], [], []
        for J, mode in zip(feet, modes):
            un = -e * min(J[1] @ v, 0)
            if mode == 'o':
                continue
            rows.append(J[1]); want.append(un)
            if mode == 's':
                columns += [J[1], J[0]]
                rows.append(J[0]); want.append(0.0)
            else:
                columns.append(J[1] + (-mu if mode == 'f' else mu) * J[0])
        if rows:
            R, C = np.array(rows), np.array(columns).T
            K = R @ Minv @ C
            rhs = np.array(want) - R @ v
            lam, *_ = np.linalg.lstsq(K, rhs, rcond=1e-12)
            if np.max(np.abs(K @ lam - rhs)) > tol * (1 + np.max(np.abs(rhs))):
                continue
            dv = Minv @ C @ lam
        else:
            lam, dv = np.zeros(0), np.zeros(5)
        vp = v + dv
        ok, i, impulses = True, 0, []
        for J, mode in zip(feet, modes):
            un, ut = J[1] @ vp + e * min(J[1] @ v, 0), J[0] @ vp
            if mode == 'o':
                ok &= un >= -tol
                impulses.append((0.0, 0.0))
            elif mode == 's':
                n, t = lam[i], lam[i + 1]; i += 2
                ok &= n >= -tol and abs(t) <= mu * n + tol
                impulses.append((n, t))
            else:
                n = lam[i]; i += 1
                ok &= n >= -tol and (ut >= -tol if mode == 'f' else ut <= tol)
                impulses.append((n, (-mu if mode == 'f' else mu) * n))
        if ok:
            found.append((''.join(modes), impulses, vp, 0.5 * (vp @ M @ vp - v @ M @ v)))
    return found


def distinct(solutions, tol=1e-7):
    """Solutions that differ in velocity, least kinetic energy first."""
    out = []
    for s in sorted(solutions, key=lambda s: s[3]):
        if all(np.max(np.abs(s[2] - o[2])) > tol for o in out):
            out.append(s)
    return out
