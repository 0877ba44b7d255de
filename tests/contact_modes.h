/* contact_modes.h - contact problems solved as the kernel that is included before does (one lane),
 * and by a program that shares nothing with it: every mode of every element as one dense system,
 * eliminated with full pivoting, singular ones skipped, laws checked on the operator itself,
 * energies compared. DENSE_ROWS: of the largest problem. */
#ifndef STANCE_TESTS_CONTACT_MODES_H
#define STANCE_TESTS_CONTACT_MODES_H

#include "dense.h"
#include "long.h"
#include "support.h"

enum { ROWS = DENSE_ROWS, MOST = 8 };

/* Rows of an element: tangential (-1: none), then its normal ones. */
struct element {
    int tangential, ends, normal[2];
};

struct problem {
    int rows, elements;
    struct element element[MOST];
    int contact[ROWS]; /* of each row, as the kernel counts; tangential rows: of the first end */
    double D[ROWS][ROWS], v[ROWS], e[ROWS], friction; /* e: restitution terms */
};

/* What an impulse violates, as a velocity; *energy: the kinetic energy that it adds; u: velocities.
 */
static double violation(const struct problem *p, const double *r, double *energy, double *u)
{
    double worst = 0;
    *energy = 0;
    for (int i = 0; i < p->rows; i++) {
        u[i] = p->v[i];
        for (int j = 0; j < p->rows; j++)
            u[i] += p->D[i][j] * r[j];
        *energy += 0.5 * r[i] * (p->v[i] + u[i]);
        u[i] += p->e[i];
    }
    for (int k = 0; k < p->elements; k++) {
        const struct element *const e = &p->element[k];
        double load = 0;
        for (int i = 0; i < e->ends; i++) {
            const int n = e->normal[i];
            load += r[n];
            worst = fmax(worst, fmax(-u[n], -p->D[n][n] * r[n]));
            worst = fmax(worst, fmin(fabs(u[n]), fabs(p->D[n][n] * r[n])));
        }
        const int t = e->tangential;
        if (t < 0)
            continue;
        const double room = p->friction * load, against = u[t] < 0 ? room - r[t] : room + r[t];
        worst = fmax(worst, p->D[t][t] * (fabs(r[t]) - room));
        worst = fmax(worst, fmin(fabs(u[t]), p->D[t][t] * fabs(against)));
    }
    return worst;
}

/* Modes of an element: open, or some of its ends closed and (but for stops) stick, forward,
 * backward.
 */
static int modes_of(const struct element *e)
{
    return 1 + ((1 << e->ends) - 1) * (e->tangential < 0 ? 1 : 3);
}

/* All modes: number of solutions with different velocities (at most 9), the least energy. */
static int enumerate(const struct problem *p, double tolerance, double *least)
{
    int found = 0, total = 1;
    double seen[9][ROWS];
    *least = INFINITY;
    for (int k = 0; k < p->elements; k++)
        total *= modes_of(&p->element[k]);
    for (int mode = 0; mode < total; mode++) {
        double a[ROWS][ROWS + 1] = {{0}}, r[ROWS] = {0}, u[ROWS], energy;
        int rest = mode;
        for (int k = 0; k < p->elements; k++) {
            const struct element *const e = &p->element[k];
            const int own = rest % modes_of(e), all = (1 << e->ends) - 1;
            const int closed = own == 0 ? 0 : 1 + (own - 1) % all, grip = (own - 1) / all;
            rest /= modes_of(e);
            for (int row = 0; row < p->rows; row++) {
                bool is_end = false, carries = false;
                for (int i = 0; i < e->ends; i++)
                    if (row == e->normal[i])
                        is_end = true, carries = closed >> i & 1;
                if (row != e->tangential && !is_end)
                    continue;
                if ((is_end && carries) || (!is_end && closed && grip == 0)) { /* velocity zero */
                    for (int j = 0; j < p->rows; j++)
                        a[row][j] = p->D[row][j];
                    a[row][p->rows] = -(p->v[row] + p->e[row]);
                    continue;
                }
                a[row][row] = 1; /* an impulse that is given */
                if (!is_end && closed)
                    for (int i = 0; i < e->ends; i++)
                        a[row][e->normal[i]] = grip == 1 ? p->friction : -p->friction;
            }
        }
        if (!dense_solve(p->rows, a, r) || violation(p, r, &energy, u) > tolerance)
            continue;
        bool again = false;
        for (int k = 0; k < found; k++) {
            double apart = 0;
            for (int i = 0; i < p->rows; i++)
                apart = fmax(apart, fabs(u[i] - seen[k][i]));
            again |= apart < 1e-7;
        }
        if (!again && found < 9)
            memcpy(seen[found++], u, sizeof u);
        *least = fmin(energy, *least);
    }
    return found;
}

/* Problems of one kind. */
struct family {
    const char *name;
    void (*random)(uint64_t *seed, const struct family *f, struct problem *p);
    int points, soles, stops;
    int feet; /* points stand on so many rigid feet; 0: each on a leg of its own */
    bool rebounds;
    int n;          /* problems */
    double several; /* least share of those with several solutions that is expected */
};

/* The kernel's solution, by contact and by row. last: NULL, or impulses of a mode to try. */
static struct contact_verdict solve(const struct problem *p, bool most, const double (*last)[2],
                                    double (*out)[2], double *r, bool *unique)
{
    static double D[CONTACTS][CONTACTS][2][2];
    double uf[CONTACTS][2] = {{0}}, shift[CONTACTS][2] = {{0}};
    bool active[CONTACTS] = {false};
    int axis[ROWS] = {0};
    contact_set touching = 0;
    struct contact_verdict verdict;
    memset(D, 0, sizeof D);
    for (int k = 0; k < p->elements; k++)
        if (p->element[k].tangential >= 0)
            axis[p->element[k].tangential] = 1;
    for (int i = 0; i < p->rows; i++) {
        const int c = p->contact[i];
        uf[c][axis[i]] = p->v[i] + p->e[i];
        if (axis[i] == 0)
            active[c] = true, shift[c][0] = p->e[i];
        touching |= contact_with(c);
        for (int j = 0; j < p->rows; j++)
            D[c][p->contact[j]][axis[i]][axis[j]] = p->D[i][j];
    }
    struct contact_problem problem =
        contact_pose(D, uf, touching, active, p->friction, most ? -1 : 1);
    problem.shift = shift;
    problem.last = last, problem.known = true;
    solve_contacts(&problem, LANES_ALL, out, &verdict);
    if (unique)
        *unique = direct_unique(&problem);
    for (int i = 0; i < p->rows; i++)
        r[i] = out[p->contact[i]][axis[i]];
    return verdict;
}

/* What each family is held to: the kernel's own functions find a solution wherever there is one, of
 * least energy, say whether there are others, and go on with what they are told. */
static void family(const struct family *f)
{
    uint64_t seed = 7;
    const int n = long_tests() ? 10 * f->n : f->n / 3;
    int several = 0, certified = 0, missed = 0, unflagged = 0, unsolved = 0, none = 0, unranked = 0;
    int apart = 0, wrong = 0, left = 0, decided = 0;
    double worst = 0;
    for (int i = 0; i < n; i++) {
        struct problem p;
        double r[ROWS], other[ROWS], u[ROWS], v[ROWS], least, energy, more, scale = 1;
        double out[CONTACTS][2], last[CONTACTS][2];
        bool unique;
        f->random(&seed, f, &p);
        for (int k = 0; k < p.rows; k++)
            scale = fmax(scale, fabs(p.v[k]));
        const int found = enumerate(&p, 1e-9 * scale, &least);
        const double kinetic = fabs(least) + 1e-3;
        const struct contact_verdict said = solve(&p, false, NULL, out, r, &unique);
        none += found == 0;
        if (found == 0)
            continue;
        unsolved += said.unsolved;
        unranked += said.unranked;
        several += found > 1;
        certified += unique;
        wrong += unique && found > 1;
        if (said.unsolved)
            continue;
        worst = fmax(worst, violation(&p, r, &energy, u) / scale);
        missed += !said.unranked && energy > least + 1e-8 * kinetic;
        unflagged += p.elements <= 4 && found > 1 && !said.ambiguous;
        /* What stood goes on standing where it can, and that is the same solution at e = 0; a mode
         * to begin with changes nothing where solutions are unique. */
        for (int c = 0; c < CONTACTS; c++)
            last[c][0] = 1, last[c][1] = 0;
        const struct contact_verdict stays =
            solve(&p, false, (const double(*)[2])last, out, other, NULL);
        worst = fmax(worst, violation(&p, other, &more, v) / scale);
        missed += !f->rebounds && !stays.unranked && more > least + 1e-8 * kinetic;
        for (int c = 0; c < CONTACTS; c++)
            last[c][0] = uniform(&seed, -0.5, 1), last[c][1] = uniform(&seed, -1, 1);
        solve(&p, false, (const double(*)[2])last, out, other, NULL);
        worst = fmax(worst, violation(&p, other, &more, v) / scale);
        for (int k = 0; k < p.rows; k++)
            apart += found == 1 && fabs(u[k] - v[k]) > 1e-7 * scale;
        const struct contact_verdict opposite = solve(&p, true, NULL, out, other, NULL);
        worst = fmax(worst, violation(&p, other, &more, v) / scale);
        missed += !opposite.unranked && !said.unranked && more < energy - 1e-8 * kinetic;
        /* Of several elements the mode of any solution goes on in which one carries: nothing is
         * decided then. */
        bool carries = false;
        for (int c = 0; c < CONTACTS; c++)
            carries = carries || out[c][0] > 0;
        carries = carries && p.elements > 1 && !opposite.unsolved;
        memcpy(last, out, sizeof last);
        const struct contact_verdict goes_on =
            solve(&p, false, (const double(*)[2])last, out, r, NULL);
        violation(&p, r, &energy, u);
        for (int k = 0; k < p.rows && carries; k++)
            left += fabs(u[k] - v[k]) > 1e-7 * scale;
        decided += carries && goes_on.ambiguous;
    }
    print_message(
        "# %s: %d problems, %d with several solutions, %d certified (%d wrongly); not the "
        "least energy %d, not counted %d, other velocities %d, does not go on %d, decides %d, "
        "unranked %d, unsolved %d (no "
        "solution: %d), laws violated by %.1e at most\n",
        f->name, n, several, certified, wrong, missed, unflagged, apart, left, decided, unranked,
        unsolved, none, worst);
    assert_int_equal(missed + unflagged + unsolved + wrong + apart + left + decided, 0);
    assert_true(several >= f->several * n);
    assert_true(worst < 1e-9);
}

#endif
