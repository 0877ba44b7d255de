/* lane.h - the contact problem of one lane, in plain arithmetic: what is rare, the same bits
 * everywhere.
 *
 * Elements are grips with the contacts that lean on them, and joint stops. Each is open, or one or
 * more of its ends carry and it sticks, slips forward or slips backward: 4 modes of a point, 10 of
 * a sole, 2 of a stop. lane_enumerate tries every mode of all, by eliminating element after
 * element; modes whose equations are singular are skipped, for of all solutions there is one whose
 * columns are independent (vertex of the set of them).
 *
 * Choice among several solutions (frictional impacts have them): the one that leaves the least
 * kinetic energy, or, `prefer` < 0, the most of it. The impulses add r.v + r.D r / 2 with v the
 * true free velocity, uf without the restitution term. Without such a term the minimum of that over
 * all r is at D r = -uf: all contacts sticking, whenever it lies in the cones, leaves the least.
 * Ties go to all contacts sticking, then to the earlier mode in the order open, stick, forward,
 * backward of the first element, then of the next. Where the operator is indefinite it is the
 * solution with the most contacts that carry, ties as before.
 *
 * Where all stick the operator may be singular: legs that are parallel, feet of two points.
 * Velocities stay unique; of the impulses that do the same those of least norm are taken (each in
 * units of its own diagonal of D) and moved, one redundancy after the other, to the middle of what
 * the cones admit.
 */
#ifndef STANCE_CORE_CONTACT_LANE_H
#define STANCE_CORE_CONTACT_LANE_H

#include "contact.h"

#define LANE_PARALLEL                                                                              \
    1e-9 /* pivots this small, of a unit diagonal, are looked at: see lane_hold                    \
          */
#define LANE_ENDLESS 1e300
#define LANE_ROUNDING 1e6 /* tolerances: what an elimination may lose by cancellation */
#define LANE_SWEEPS 4     /* over redundancies */

enum { LANE_ROWS = 2 * CONTACTS };

/* Dense equations: the last column is what is given. */
typedef double lane_matrix[LANE_ROWS][LANE_ROWS + 1];

/* Modes of an element's grip: NONE where it is open, or a stop. */
enum lane_mode { LANE_NONE, LANE_STICK, LANE_FORWARD, LANE_BACKWARD };

/* Rows tangent ... end of the problem: the tangential impulse, then the normal ones of its ends. */
struct lane_element {
    int first;    /* row of the tangential impulse, or, of a stop, of the normal one */
    int end;      /* row after the last one */
    bool grips;   /* no stop */
    double slide; /* sign of a slip that goes on, or 0 */
};

/* One lane's problem: velocities u = uf + D r in its rows. */
struct lane_problem {
    int rows, elements;
    int contact[LANE_ROWS], axis[LANE_ROWS], of[LANE_ROWS]; /* of each row; of: its element */
    struct lane_element element[CONTACTS];
    double D[LANE_ROWS][LANE_ROWS], uf[LANE_ROWS];
    double shift[LANE_ROWS];
    double friction, prefer;
    double tolerance, exact; /* violations, m/s, see contact_tolerance: the most, and none */
    bool indefinite;
};

/* The best solution found so far. */
struct lane_choice {
    double r[LANE_ROWS], u[LANE_ROWS];
    double violation; /* largest of a law, as a velocity */
    double energy;    /* kinetic energy added */
    bool ambiguous;   /* another solution with other velocities exists */
};

/* A mode of all elements: of each its grip's, and which normals carry. */
struct lane_modes {
    enum lane_mode grip[CONTACTS];
    bool closed[LANE_ROWS]; /* of rows of normal impulses */
};

/* ---- the problem ----------------------------------------------------------------------------- */

/* The problem of a lane, of the contacts in `active`. */
static void lane_gather(const struct contact_problem *of, contact_set active, int lane,
                        struct lane_problem *p)
{
    double largest = 0;
    p->rows = p->elements = 0;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const contact_set ends = contact_ends(c);
        if ((contact_grip(c) >= 0 && contact_grip(c) != c) || !(active & ends))
            continue;
        struct lane_element *const e = &p->element[p->elements++];
        e->grips = contact_grip(c) == c;
        e->first = p->rows;
        e->slide = e->grips && of->sliding ? lane_get(&of->sliding[c], lane) : 0;
        if (e->grips)
            p->contact[p->rows] = c, p->axis[p->rows++] = 1;
        for (int k = c; k < OWN_CONTACTS; k++)
            if (active & ends & 1u << k)
                p->contact[p->rows] = k, p->axis[p->rows++] = 0;
        e->end = p->rows;
        for (int i = e->first; i < e->end; i++)
            p->of[i] = p->elements - 1;
    }
    for (int i = 0; i < p->rows; i++) {
        const int c = p->contact[i], a = p->axis[i];
        p->uf[i] = lane_get(&of->uf[c][a], lane);
        p->shift[i] = of->shift ? lane_get(&of->shift[c][a], lane) : 0;
        largest = fmax(fabs(p->uf[i]), largest);
        for (int j = 0; j < p->rows; j++)
            p->D[i][j] = lane_get(&of->D[c][p->contact[j]][a][p->axis[j]], lane);
    }
    p->friction = lane_get(&of->friction, lane);
    p->prefer = lane_get(&of->prefer, lane);
    p->tolerance = CONTACT_TOLERANCE * fmax(largest, 1);
    p->exact = CONTACT_TOLERANCE * fmax(largest, CONTACT_STILL);
    p->indefinite = of->indefinite;
}

/* ---- candidates ------------------------------------------------------------------------------ */

static void lane_velocities(const struct lane_problem *p, const double *r, double *u)
{
    for (int i = 0; i < p->rows; i++) {
        u[i] = p->uf[i];
        for (int j = 0; j < p->rows; j++)
            u[i] += p->D[i][j] * r[j];
    }
}

/* Sum of the normal impulses that an element's grip leans on. */
static double lane_load(const struct lane_element *e, const double *r)
{
    double load = 0;
    for (int i = e->first + (e->grips ? 1 : 0); i < e->end; i++)
        load += r[i];
    return load;
}

/* fmax, but a call no library is asked for. */
static double lane_max(double a, double b)
{
    return a > b ? a : b;
}
static double lane_min(double a, double b)
{
    return a < b ? a : b;
}

/* Largest violation of a law by the impulses r alone. */
static double lane_beyond(const struct lane_problem *p, const double *r)
{
    double worst = 0;
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        for (int i = e->first; i < e->end; i++) {
            const double beyond =
                p->axis[i] == 0 ? -r[i] : fabs(r[i]) - p->friction * lane_load(e, r);
            worst = lane_max(beyond * fabs(p->D[i][i]), worst);
        }
    }
    return worst;
}

/* Largest violation of a law by r, which alone violates `beyond`, with the velocities u; NAN where
 * they are. */
static double lane_violation(const struct lane_problem *p, const double *r, const double *u,
                             double beyond)
{
    double worst = beyond, sum = 0;
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        for (int i = e->first; i < e->end; i++) {
            const double scale = fabs(p->D[i][i]);
            sum += r[i] + u[i];
            if (p->axis[i] == 0) { /* what is apart must not push */
                worst = lane_max(-u[i], worst);
                worst = lane_max(lane_min(fabs(u[i]), fabs(r[i] * scale)), worst);
                continue;
            }
            /* Maximum dissipation: slip means an impulse at the edge of the cone, against it. No
             * acceleration turns a slip around at once. */
            const double bound = p->friction * lane_load(e, r);
            const double slip = e->slide != 0 ? LANE_ENDLESS * e->slide : u[i];
            const double room = slip < 0 ? bound - r[i] : bound + r[i];
            worst = lane_max(lane_min(fabs(slip), room * scale), worst);
        }
    }
    return isfinite(sum) ? worst : NAN;
}

/* What is compared between solutions: the least is taken. */
static double lane_energy(const struct lane_problem *p, const double *r, const double *u)
{
    double energy = 0;
    if (p->indefinite) { /* no energy to compare: stay on the ground where that is possible */
        for (int i = 0; i < p->rows; i++)
            energy -= p->axis[i] == 0 && r[i] > 0;
        return energy;
    }
    for (int i = 0; i < p->rows; i++)
        energy += 0.5 * (r[i] * (p->uf[i] + u[i])) - r[i] * p->shift[i];
    return p->prefer * energy;
}

/* Takes a candidate where it is better than the choice: all laws are checked here, so that a
 * candidate from a meaningless elimination is just a bad one. Returns its violation. */
static double lane_offer(const struct lane_problem *p, const double *r, struct lane_choice *best)
{
    double u[LANE_ROWS], apart = 0;
    /* Most candidates push or pull so wrongly that the velocities do not matter. */
    const double beyond = lane_beyond(p, r);
    if (beyond > LANE_ROUNDING * p->tolerance &&
        (best->violation <= p->tolerance || beyond >= best->violation))
        return INFINITY;
    lane_velocities(p, r, u);
    const double violation = lane_violation(p, r, u, beyond), energy = lane_energy(p, r, u);
    if (!isfinite(violation) || !isfinite(energy))
        return INFINITY;
    for (int i = 0; i < p->rows; i++)
        apart = lane_max(fabs(u[i] - best->u[i]), apart);
    const bool valid = violation <= p->tolerance, have = best->violation <= p->tolerance;
    const bool exact = violation <= p->exact, known = best->violation <= p->exact;
    const double tie = 1e-12 * (fabs(energy) + fabs(best->energy));
    /* With the same velocities it is the same solution, whatever rounding makes of its energy. */
    const bool first = (valid && !have) || (exact && !known);
    const bool other = valid && have && exact == known && 16 * p->tolerance < apart;
    best->ambiguous = (best->ambiguous && !first) || other;
    if (first || (other && energy < best->energy - tie) ||
        (!valid && !have && violation < best->violation)) {
        memcpy(best->r, r, sizeof best->r);
        memcpy(best->u, u, sizeof best->u);
        best->violation = violation, best->energy = energy;
    }
    return violation;
}

/* ---- dense equations ------------------------------------------------------------------------- */

/* A factored by elimination with complete pivoting, rows and columns in the order of the pivots. */
struct lane_factors {
    int n, rank, row[LANE_ROWS], column[LANE_ROWS];
    lane_matrix A;
};

/* Takes A[n][n]; pivots not above `small` times the first end it. */
static void lane_factor(int n, double small, struct lane_factors *f)
{
    f->n = n;
    for (int i = 0; i < n; i++)
        f->row[i] = f->column[i] = i;
    for (f->rank = 0; f->rank < n; f->rank++) {
        const int k = f->rank;
        int p = k, q = k;
        for (int i = k; i < n; i++)
            for (int j = k; j < n; j++)
                if (fabs(f->A[f->row[i]][f->column[j]]) > fabs(f->A[f->row[p]][f->column[q]]))
                    p = i, q = j;
        const int r = f->row[p], c = f->column[q];
        f->row[p] = f->row[k], f->row[k] = r;
        f->column[q] = f->column[k], f->column[k] = c;
        if (!(fabs(f->A[r][c]) > small * fabs(f->A[f->row[0]][f->column[0]])))
            return;
        for (int i = k + 1; i < n; i++) {
            double *const other = f->A[f->row[i]];
            other[c] /= f->A[r][c];
            for (int j = k + 1; j < n; j++)
                other[f->column[j]] -= other[c] * f->A[r][f->column[j]];
        }
    }
}

/* Adds a solution of A x = b; unknowns that nothing determines are left as they are. */
static void lane_solve(const struct lane_factors *f, const double *b, double *x)
{
    double left[LANE_ROWS] = {0}, add[LANE_ROWS];
    for (int i = 0; i < f->rank; i++) {
        left[i] = b[f->row[i]];
        for (int k = 0; k < i; k++)
            left[i] -= f->A[f->row[i]][f->column[k]] * left[k];
    }
    for (int i = f->rank - 1; i >= 0; i--) {
        add[i] = left[i];
        for (int j = i + 1; j < f->rank; j++)
            add[i] -= f->A[f->row[i]][f->column[j]] * add[j];
        add[i] /= f->A[f->row[i]][f->column[i]];
        x[f->column[i]] += add[i];
    }
}

/* What column k, beyond the rank, can be exchanged for: n with A n = 0, n of the column 1. */
static void lane_null(const struct lane_factors *f, int rank, int k, double *n)
{
    for (int i = 0; i < f->n; i++)
        n[i] = 0;
    n[f->column[k]] = 1;
    for (int i = rank - 1; i >= 0; i--) {
        double sum = -f->A[f->row[i]][f->column[k]];
        for (int j = i + 1; j < rank; j++)
            sum -= f->A[f->row[i]][f->column[j]] * n[f->column[j]];
        n[f->column[i]] = sum / f->A[f->row[i]][f->column[i]];
    }
}

/* ---- all stick ------------------------------------------------------------------------------- */

/* Moves r by a multiple of n where that changes no velocity. */
static void lane_exchange(const struct lane_problem *p, double by, const double *n, double *r)
{
    double change = 0;
    for (int i = 0; i < p->rows; i++) {
        double u = 0;
        for (int j = 0; j < p->rows; j++)
            u += p->D[i][j] * n[j];
        change = fmax(fabs(by * u), change);
    }
    for (int i = 0; i < p->rows && change <= 0.25 * p->tolerance; i++)
        r[i] += by * n[i];
}

/* Moves r along n to the middle of what the laws admit. */
static void lane_share(const struct lane_problem *p, const double *n, double *r)
{
    double low = -INFINITY, high = INFINITY;
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        const int ends = e->end - e->first - (e->grips ? 1 : 0);
        /* Both edges of the cone; each end of its own where that does not follow. */
        for (int i = e->first - 1; i < e->end; i++) {
            double room, rate;
            if (i <= e->first && e->grips) {
                const double side = i < e->first ? -1 : 1;
                room = p->friction * lane_load(e, r) + side * r[e->first];
                rate = p->friction * lane_load(e, n) + side * n[e->first];
            } else if (i >= e->first && (ends > 1 || !e->grips)) {
                room = r[i], rate = n[i];
            } else {
                continue;
            }
            if (rate > 0)
                low = fmax(-room / rate, low);
            else if (rate < 0)
                high = fmin(-room / rate, high);
        }
    }
    const double middle = 0.5 * (low + high);
    if (low <= high && isfinite(middle))
        lane_exchange(p, middle, n, r);
}

/* Impulses with which all contacts stick, whatever the operator; see above of those that are not
 * unique. Returns whether they obey the laws. */
static bool lane_hold(const struct lane_problem *p, double *r)
{
    double scale[LANE_ROWS], u[LANE_ROWS], null[LANE_ROWS][LANE_ROWS];
    struct lane_factors f;
    const int n = p->rows;
    for (int i = 0; i < n; i++) {
        scale[i] = 1 / sqrt(fmax(fabs(p->D[i][i]), 1e-300));
        r[i] = 0;
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            f.A[i][j] = scale[i] * p->D[i][j] * scale[j];
    lane_factor(n, CONTACT_RANK_GUARD, &f);
    for (int round = 0; round < 2; round++) { /* once more with what is left */
        double b[LANE_ROWS] = {0}, x[LANE_ROWS] = {0};
        lane_velocities(p, r, u);
        for (int i = 0; i < n; i++)
            b[i] = -(scale[i] * u[i]);
        lane_solve(&f, b, x);
        for (int i = 0; i < n; i++)
            r[i] += scale[i] * x[i];
    }
    int rank = f.rank, free = 0;
    while (rank > 0 && fabs(f.A[f.row[rank - 1]][f.column[rank - 1]]) <= LANE_PARALLEL)
        rank--;
    for (int k = rank; k < n; k++) { /* an orthonormal family, in scaled units */
        double *const own = null[free], length = 0;
        lane_null(&f, rank, k, own);
        for (int m = 0; m < free; m++) {
            double along = 0;
            for (int i = 0; i < n; i++)
                along += own[i] * null[m][i];
            for (int i = 0; i < n; i++)
                own[i] -= along * null[m][i];
        }
        for (int i = 0; i < n; i++)
            length += own[i] * own[i];
        for (int i = 0; i < n; i++)
            own[i] /= sqrt(length);
        free++;
    }
    for (int m = 0; m < free;
         m++) { /* least norm, where the middle is not the same from anywhere */
        double along = 0;
        for (int i = 0; i < n; i++) {
            along += null[m][i] * (r[i] / scale[i]);
            null[m][i] *= scale[i];
        }
        if (free > 1)
            lane_exchange(p, -along, null[m], r);
    }
    for (int sweep = 0; sweep < (free > 1 ? LANE_SWEEPS : 1); sweep++)
        for (int m = 0; m < free; m++)
            lane_share(p, null[m], r);
    lane_velocities(p, r, u);
    bool good = true;
    for (int i = 0; i < n; i++)
        good &= fabs(u[i]) <= p->tolerance;
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        if (e->grips)
            good &= fabs(r[e->first]) <= p->friction * lane_load(e, r);
        for (int i = e->first; i < e->end; i++)
            good &= p->axis[i] == 1 || r[i] >= 0;
    }
    return good;
}

/* ---- all modes ------------------------------------------------------------------------------- */

/* r_T by the sum of r_N in a mode of a grip. */
static double lane_edge(const struct lane_problem *p, enum lane_mode mode)
{
    return mode == LANE_FORWARD ? -p->friction : mode == LANE_BACKWARD ? p->friction : 0;
}

/* Impulses r in one mode of all, by dense elimination; false: its equations are singular. */
static bool lane_in_modes(const struct lane_problem *p, const struct lane_modes *modes, double *r)
{
    int row[LANE_ROWS], n = 0;
    double edge[LANE_ROWS] = {0}, u[LANE_ROWS]; /* of rows of normal impulses */
    struct lane_factors f;
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        if (e->grips && modes->grip[k] == LANE_STICK)
            row[n++] = e->first;
        for (int i = e->first; i < e->end; i++)
            if (p->axis[i] == 0 && modes->closed[i])
                row[n++] = i, edge[i] = e->grips ? lane_edge(p, modes->grip[k]) : 0;
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            f.A[i][j] =
                p->D[row[i]][row[j]] + edge[row[j]] * p->D[row[i]][p->element[p->of[row[j]]].first];
    lane_factor(n, CONTACT_RANK_GUARD, &f);
    if (f.rank < n)
        return false;
    for (int i = 0; i < p->rows; i++)
        r[i] = 0;
    for (int round = 0; round < 2; round++) {
        double b[LANE_ROWS], x[LANE_ROWS] = {0};
        lane_velocities(p, r, u);
        for (int i = 0; i < n; i++)
            b[i] = -u[row[i]];
        lane_solve(&f, b, x);
        for (int i = 0; i < n; i++) {
            r[row[i]] += x[i];
            if (edge[row[i]] != 0)
                r[p->element[p->of[row[i]]].first] += edge[row[i]] * x[i];
        }
    }
    return true;
}

/* Rows eliminated so far: each gives its unknown by those after it. */
struct lane_path {
    int n, row[LANE_ROWS];
    lane_matrix pivot; /* rows as those before have left them */
    struct lane_modes modes;
};

/* All are eliminated: the candidate of this mode. */
static void lane_arrive(const struct lane_problem *p, const struct lane_path *path,
                        struct lane_choice *best)
{
    double r[LANE_ROWS] = {0};
    for (int k = path->n - 1; k >= 0; k--) {
        const int row = path->row[k], of = p->of[row];
        const double *const equation = path->pivot[k];
        double sum = equation[p->rows];
        for (int j = row + 1; j < p->rows; j++)
            sum += equation[j] * r[j];
        r[row] = -sum / equation[row];
        /* Most candidates pull so hard that no other row can make them a solution. */
        if (p->axis[row] == 0 && r[row] * fabs(p->D[row][row]) < -LANE_ROUNDING * p->tolerance)
            return;
        if (path->modes.grip[of] > LANE_STICK) /* before the rows of other elements are reached */
            r[p->element[of].first] =
                lane_edge(p, path->modes.grip[of]) * lane_load(&p->element[of], r);
    }
    const double violation = lane_offer(p, r, best);
    /* Anew, with care, where that may be rounding: a contact may slide on the verge of having no
     * answer. (To offer the same twice changes nothing.) */
    if (violation > p->exact && violation < LANE_ROUNDING * p->tolerance &&
        lane_in_modes(p, &path->modes, r))
        lane_offer(p, r, best);
}

/* Eliminates an unknown from the rows after it; false: it is singular. */
static bool lane_eliminate(const struct lane_problem *p, int row, lane_matrix A,
                           struct lane_path *path)
{
    const double pivot = A[row][row];
    if (!(fabs(pivot) > CONTACT_RANK_GUARD * fabs(p->D[row][row])))
        return false;
    memcpy(path->pivot[path->n], A[row], sizeof A[row]);
    path->row[path->n++] = row;
    for (int i = row + 1; i < p->rows; i++) {
        const double factor = A[i][row] / pivot;
        for (int j = row + 1; j <= p->rows; j++)
            A[i][j] -= factor * A[row][j];
    }
    return true;
}

/* Every mode of element k and those after it, of the equations A that those before have left. */
static void lane_visit(const struct lane_problem *p, int k, lane_matrix A, struct lane_path *path,
                       struct lane_choice *best)
{
    if (k == CONTACTS || k == p->elements) {
        lane_arrive(p, path, best);
        return;
    }
    const struct lane_element *const e = &p->element[k];
    const int normal = e->first + (e->grips ? 1 : 0), ends = e->end - normal, before = path->n;
    path->modes.grip[k] = LANE_NONE;
    for (int i = normal; i < e->end; i++)
        path->modes.closed[i] = false;
    lane_visit(p, k + 1, A, path, best);
    for (enum lane_mode mode = e->grips ? LANE_STICK : LANE_NONE;
         mode <= (e->grips ? LANE_BACKWARD : LANE_NONE); mode++) {
        if (e->slide != 0 && mode != (e->slide > 0 ? LANE_FORWARD : LANE_BACKWARD))
            continue;
        for (int set = 1; set < 1 << ends; set++) {
            lane_matrix left;
            bool regular = true;
            const double edge = lane_edge(p, mode);
            for (int i = e->first; i < p->rows; i++)
                memcpy(left[i], A[i], sizeof left[i]);
            path->n = before;
            path->modes.grip[k] = mode;
            for (int i = e->first; i < p->rows; i++)
                for (int j = normal; j < e->end && edge != 0; j++)
                    left[i][j] += edge * left[i][e->first];
            if (mode == LANE_STICK)
                regular = lane_eliminate(p, e->first, left, path);
            for (int i = 0; i < ends; i++) {
                path->modes.closed[normal + i] = set >> i & 1;
                if (set >> i & 1)
                    regular = regular && lane_eliminate(p, normal + i, left, path);
            }
            if (regular)
                lane_visit(p, k + 1, left, path, best);
        }
    }
    path->n = before;
}

/* Puts r, whose velocities are u, exactly inside the cones, and of what slides onto their edge: the
 * impulses of a very short step are so small that the tolerance is much of them. */
static void lane_clip(const struct lane_problem *p, const double *u, double *r)
{
    for (int i = 0; i < p->rows; i++)
        if (p->axis[i] == 0)
            r[i] = r[i] > 0 ? r[i] : 0;
    for (int k = 0; k < p->elements; k++) {
        const struct lane_element *const e = &p->element[k];
        const double bound = p->friction * lane_load(e, r);
        if (!e->grips)
            continue;
        double *const along = &r[e->first];
        *along = *along > bound ? bound : *along < -bound ? -bound : *along;
        const double slip = u[e->first], edge = slip < 0 ? bound : -bound;
        if (e->slide == 0 && fabs(*along) < CONTACT_STICKS * bound && fabs(slip) > p->tolerance &&
            fabs(edge - *along) * fabs(p->D[e->first][e->first]) <= p->tolerance)
            *along = edge;
    }
}

static void lane_choose_none(struct lane_choice *best)
{
    memset(best, 0, sizeof *best);
    best->violation = best->energy = INFINITY;
}

/* Tries all modes. The solution violates no law by more than p->tolerance where violation says so.
 */
static void lane_enumerate(const struct lane_problem *p, struct lane_choice *best)
{
    double r[LANE_ROWS] = {0};
    lane_matrix A;
    struct lane_path path = {0};
    lane_choose_none(best);
    const bool holds = lane_hold(p, r);
    lane_offer(p, r, best);
    if (holds && best->violation <= p->tolerance) /* as exact as redundant contacts let it be */
        best->violation = 0;
    for (int i = 0; i < p->rows; i++) {
        memcpy(A[i], p->D[i], sizeof p->D[i]);
        A[i][p->rows] = p->uf[i];
    }
    lane_visit(p, 0, A, &path, best);
}

#endif
