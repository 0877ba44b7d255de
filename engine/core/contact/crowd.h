/* crowd.h - the contact problem of one lane with more elements than are enumerated: a solution,
 * though not certainly the one that is preferred.
 *
 * First Newton's iteration on modes from all sticking, each contact taking the mode that its
 * impulse and its velocity point to. Where that does not arrive, Lemke's algorithm (Cottle, Pang
 * and Stone, The Linear Complementarity Problem, section 4.4) on the problem of Stewart and Trinkle
 * (Int. J. Numer. Meth. Engng. 39, 1996) with r_T = b+ - b-,
 *
 *   w_N  = u_N  _|_  N  >= 0,      w_+- = +-u_T + l >= 0  _|_  b+- >= 0,
 *   w_l  = mu (sum of N) - b+ - b-  _|_  l  >= 0,
 *
 * whose matrix is copositive where D is positive. (The smaller one with the two edges of the cone
 * for unknowns is not, and ends on rays where solutions exist.) Then all modes, which takes long.
 */
#ifndef STANCE_CORE_CONTACT_CROWD_H
#define STANCE_CORE_CONTACT_CROWD_H

#include "lane.h"

#define CROWD_ROUNDS 24 /* modes that Newton's iteration tries */
#define CROWD_PIVOTS 50 /* of Lemke's, for each row, at most */
#define CROWD_PIVOT 1e-11

enum { CROWD_ROOM = 4 * CONTACTS };

/* The mode that slides with r_T = edge r_N where edge has the sign of `tangential`. */
static enum lane_mode crowd_slips(double tangential)
{
    return tangential < 0 ? LANE_FORWARD : LANE_BACKWARD;
}

/* Every contact closed, and sticking unless its slip goes on. */
static void crowd_all(const struct lane_problem *p, struct lane_modes *modes)
{
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        modes->grip[k] = !e->grips       ? LANE_NONE
                         : e->slide != 0 ? crowd_slips(-e->slide)
                                         : LANE_STICK;
        for (int i = e->first; i < e->end; i++)
            modes->closed[i] = p->axis[i] == 0;
    }
}

/* The mode that impulses r are in. */
static void crowd_modes_of(const struct lane_problem *p, const double *r, struct lane_modes *modes)
{
    crowd_all(p, modes);
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        for (int i = e->first; i < e->end; i++)
            modes->closed[i] = p->axis[i] == 0 && r[i] > 0;
        if (e->grips && e->slide == 0 &&
            fabs(r[e->first]) >= CONTACT_STICKS * (p->friction * lane_load(e, r)))
            modes->grip[k] = crowd_slips(r[e->first]);
    }
}

/* The impulses of that mode of r; true: they are a solution. */
static bool crowd_offer_mode(const struct lane_problem *p, const double *r,
                             struct lane_choice *best)
{
    struct lane_modes modes;
    double exact[LANE_ROWS] = {0};
    crowd_modes_of(p, r, &modes);
    return lane_in_modes(p, &modes, exact) && lane_offer(p, exact, best) <= p->exact;
}

/* Newton's iteration on modes; true: it arrived. */
static bool crowd_newton(const struct lane_problem *p, struct lane_choice *best)
{
    struct lane_modes modes;
    crowd_all(p, &modes);
    for (int round = 0; round < CROWD_ROUNDS; round++) {
        double r[LANE_ROWS] = {0}, u[LANE_ROWS];
        if (!lane_in_modes(p, &modes, r))
            return false;
        if (lane_offer(p, r, best) <= p->exact)
            return true;
        lane_velocities(p, r, u);
        for (int k = 0; k < p->elements; k++) {
            const struct lane_element *const e = &p->element[k];
            const int t = e->first;
            if (e->grips && e->slide == 0) {
                const double load = lane_load(e, r);
                const bool sticks = modes.grip[k] == LANE_STICK;
                if (sticks && load > 0 && fabs(r[t]) > p->friction * load)
                    modes.grip[k] = crowd_slips(r[t]);
                else if (!sticks && lane_edge(p, modes.grip[k]) * u[t] > 0)
                    modes.grip[k] = LANE_STICK;
            }
            for (int i = e->first; i < e->end; i++)
                if (p->axis[i] == 0)
                    modes.closed[i] = modes.closed[i] ? r[i] > 0 : u[i] < 0;
        }
    }
    return false;
}

/* The problem of Stewart and Trinkle: w = M z + q, of n rows; row[i], sign[i]: what z[i] adds to
 * which impulse, sign 0 for l. Units: each impulse by its diagonal of D. */
struct crowd {
    int n, row[CROWD_ROOM];
    double sign[CROWD_ROOM], scale[CROWD_ROOM];
    double A[CROWD_ROOM][2 * CROWD_ROOM + 2]; /* columns w, z, z_0, q */
};

static void crowd_pose(const struct lane_problem *p, struct crowd *c)
{
    c->n = 0;
    for (int i = 0; i < p->rows; i++) {
        const struct lane_element *const e = &p->element[p->of[i]];
        if (p->axis[i] == 1 && e->slide != 0)
            continue;
        for (int part = 0; part < (p->axis[i] == 0 ? 1 : 3); part++) {
            c->row[c->n] = i;
            c->sign[c->n] = part == 0 ? 1 : part == 1 ? -1 : 0;
            c->scale[c->n++] = 1 / sqrt(fmax(fabs(p->D[i][i]), 1e-300));
        }
    }
    for (int i = 0; i < c->n; i++) {
        memset(c->A[i], 0, sizeof(double[2]) * ((size_t)c->n + 1));
        const int ri = c->row[i];
        for (int j = 0; j < c->n; j++) {
            const int rj = c->row[j];
            const struct lane_element *const e = &p->element[p->of[rj]];
            double m = 0;
            if (c->sign[i] != 0 && c->sign[j] != 0) {
                m = p->D[ri][rj];
                if (p->axis[rj] == 0 && e->slide != 0)
                    m -= p->friction * e->slide * p->D[ri][e->first];
                m *= c->sign[i] * c->scale[i] * c->sign[j] * c->scale[j];
            } else if (p->of[ri] == p->of[rj] && c->sign[i] != c->sign[j]) {
                if (c->sign[i] != 0) /* w_+- by l */
                    m = p->axis[ri] == 1;
                else if (p->axis[rj] == 0)
                    m = p->friction * c->scale[j] / c->scale[i];
                else
                    m = -1;
            }
            c->A[i][c->n + j] = -m;
        }
        c->A[i][i] = 1;
        c->A[i][2 * c->n] = -1;
        c->A[i][2 * c->n + 1] = c->sign[i] * c->scale[i] * p->uf[ri];
    }
}

/* Makes column `enters` basic in row `leaves`. */
static void crowd_pivot(struct crowd *c, int leaves, int enters)
{
    const int columns = 2 * c->n + 2;
    const double pivot = c->A[leaves][enters];
    for (int j = 0; j < columns; j++)
        c->A[leaves][j] /= pivot;
    for (int i = 0; i < c->n; i++) {
        const double factor = c->A[i][enters];
        for (int j = 0; j < columns && i != leaves && factor != 0; j++)
            c->A[i][j] -= factor * c->A[leaves][j];
    }
}

static void crowd_lemke(const struct lane_problem *p, struct lane_choice *best)
{
    struct crowd c;
    int basic[CROWD_ROOM], leaves = 0;
    crowd_pose(p, &c);
    const int n = c.n, artificial = 2 * n, given = 2 * n + 1;
    for (int i = 0; i < n; i++) {
        basic[i] = i;
        if (c.A[i][given] < c.A[leaves][given])
            leaves = i;
    }
    if (n > 0 && c.A[leaves][given] < 0) {
        int enters = artificial;
        for (int count = 0; count < CROWD_PIVOTS * n; count++) {
            crowd_pivot(&c, leaves, enters);
            const int left = basic[leaves];
            basic[leaves] = enters;
            if (left == artificial)
                break;
            enters = left < n ? left + n : left - n;
            leaves = -1;
            double least = INFINITY;
            for (int i = 0; i < n; i++) { /* of equal ratios z_0, else the largest pivot */
                if (!(c.A[i][enters] > CROWD_PIVOT))
                    continue;
                const double ratio = c.A[i][given] / c.A[i][enters];
                const double tie = 1e-12 * (fabs(ratio) + fabs(least));
                if (leaves < 0 || ratio < least - tie ||
                    (ratio <= least + tie && basic[leaves] != artificial &&
                     (basic[i] == artificial || c.A[i][enters] > c.A[leaves][enters])))
                    leaves = i, least = ratio;
            }
            if (leaves < 0) /* a ray: none was found */
                return;
        }
    }
    double r[LANE_ROWS] = {0};
    for (int i = 0; i < n; i++) {
        const int z = basic[i] - n;
        if (z >= 0 && z < n && c.sign[z] != 0)
            r[c.row[z]] += c.sign[z] * c.scale[z] * (c.A[i][given] > 0 ? c.A[i][given] : 0);
    }
    for (int k = 0; k < p->elements; k++)
        if (p->element[k].slide != 0)
            r[p->element[k].first] =
                -p->friction * p->element[k].slide * lane_load(&p->element[k], r);
    double u[LANE_ROWS];
    lane_velocities(p, r, u);
    lane_clip(p, u, r);
    crowd_offer_mode(p, r, best); /* with more care */
    lane_offer(p, r, best);
}

/* Some solution, with the violation that is left. */
static void crowd_solve(const struct lane_problem *p, struct lane_choice *best)
{
    lane_choose_none(best);
    if (!p->indefinite && !crowd_newton(p, best))
        crowd_lemke(p, best);
    if (!(best->violation <= 1e3 * p->tolerance))
        lane_enumerate(p, best);
}

#endif
