/* test_contact - contact problems of random robots, solved by the kernel's own functions (one lane)
 * and by a program that shares nothing with them: every mode of every contact as one dense system,
 * eliminated with full pivoting, laws checked on the operator itself, energies compared. Operator
 * and velocities are made here from the robot's masses and lengths, too. */
#define STANCE_LANES 1
#define STANCE_SCENE biped
#define STANCE_ISA inside
#define STANCE_SCENE_LANES "engine/scenes/biped_lanes.h"
#include "engine/methods/implicit.c"
#define DENSE_ROWS 4
#include "dense.h"
#include "long.h"
#include "support.h"
#include "tests.h"

struct problem {
    double D[4][4], v[4], e[2], friction; /* v: velocities without impulses; e: restitution terms */
};

/* What an impulse violates, as a velocity; *energy: the kinetic energy that it adds. */
static double violation(const struct problem *p, int contacts, const double *r, double *energy)
{
    double worst = 0;
    *energy = 0;
    for (int c = 0; c < contacts; c++) {
        double u[2];
        for (int a = 0; a < 2; a++) {
            u[a] = p->v[2 * c + a];
            for (int j = 0; j < 2 * contacts; j++)
                u[a] += p->D[2 * c + a][j] * r[j];
            *energy += 0.5 * r[2 * c + a] * (p->v[2 * c + a] + u[a]);
        }
        u[0] += p->e[c];
        const double normal = p->D[2 * c][2 * c], along = p->D[2 * c + 1][2 * c + 1];
        const double room = p->friction * r[2 * c];
        worst = fmax(worst, -u[0]);
        worst = fmax(worst, -normal * r[2 * c]);
        worst = fmax(worst, fmin(fabs(u[0]), normal * fabs(r[2 * c])));
        worst = fmax(worst, along * (fabs(r[2 * c + 1]) - room));
        const double against = u[1] < 0 ? room - r[2 * c + 1] : room + r[2 * c + 1];
        worst = fmax(worst, fmin(fabs(u[1]), along * fabs(against)));
    }
    return worst;
}

/* All modes: number of solutions with different velocities, the least energy and its impulses. */
static int enumerate(const struct problem *p, int contacts, double tolerance, double *least,
                     double *best)
{
    int found = 0;
    double seen[16][4];
    *least = INFINITY;
    for (int mode = 0; mode < (contacts == 2 ? 16 : 4); mode++) {
        const int of[2] = {mode % 4, mode / 4};
        double a[4][5] = {{0}}, r[4] = {0}, energy;
        for (int c = 0; c < contacts; c++)
            for (int i = 0; i < 2; i++) {
                const int row = 2 * c + i;
                if (of[c] == 0 || (of[c] > 1 && i == 1)) { /* an impulse that is given */
                    a[row][row] = 1;
                    if (of[c] > 1)
                        a[row][2 * c] = of[c] == 2 ? p->friction : -p->friction;
                    continue;
                }
                for (int j = 0; j < 2 * contacts; j++)
                    a[row][j] = p->D[row][j];
                a[row][2 * contacts] = -(p->v[row] + (i == 0 ? p->e[c] : 0));
            }
        if (!dense_solve(2 * contacts, a, r) || violation(p, contacts, r, &energy) > tolerance)
            continue;
        double u[4];
        bool again = false;
        for (int i = 0; i < 2 * contacts; i++) {
            u[i] = p->v[i];
            for (int j = 0; j < 2 * contacts; j++)
                u[i] += p->D[i][j] * r[j];
        }
        for (int k = 0; k < found; k++) {
            double apart = 0;
            for (int i = 0; i < 2 * contacts; i++)
                apart = fmax(apart, fabs(u[i] - seen[k][i]));
            again |= apart < 1e-7;
        }
        if (!again)
            memcpy(seen[found++], u, sizeof u);
        if (energy < *least) {
            *least = energy;
            memcpy(best, r, sizeof r);
        }
    }
    return found;
}

/* Two feet on the ground at random, H A^-1 H^T of them. The angles couple to the hip alone. */
static void random_problem(uint64_t *seed, bool default_robot, bool rebounds, struct problem *p)
{
    double l = 0.535, lt = 0.535, m = 1.8, mt = 1.8, mh = 5.4;
    if (!default_robot) {
        l = uniform(seed, 0.2, 1), lt = uniform(seed, 0.2, 1);
        m = uniform(seed, 0.3, 5), mt = uniform(seed, 0.3, 20), mh = uniform(seed, 0.3, 20);
    }
    const double theta = uniform(seed, -M_PI, M_PI);
    double phi[2] = {uniform(seed, -1.3, 1.3), 0};
    phi[1] = uniform(seed, 0, 1) < 0.5 ? -phi[0] : uniform(seed, -1.3, 1.3);
    const double k[3] = {-mt * lt, m * l, m * l}, inertia[3] = {mt * lt * lt, m * l * l, m * l * l};
    const double angle[3] = {theta, phi[0], phi[1]};
    double hip[2][2] = {{mt + mh + 2 * m, 0}, {0, mt + mh + 2 * m}}, w[5];
    for (int i = 0; i < 3; i++) { /* the Schur complement of the angles */
        const double n[2] = {k[i] * cos(angle[i]), k[i] * sin(angle[i])};
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                hip[a][b] -= n[a] * n[b] / inertia[i];
    }
    const double det = hip[0][0] * hip[1][1] - hip[0][1] * hip[1][0];
    for (int i = 0; i < 5; i++)
        w[i] = uniform(seed, -3, 3);
    /* Rows: foot c normal, tangential; x of the hip first. */
    double H[4][5] = {{0}}, R[4][5];
    for (int c = 0; c < 2; c++) {
        H[2 * c][1] = 1, H[2 * c][3 + c] = l * sin(phi[c]);
        H[2 * c + 1][0] = 1, H[2 * c + 1][3 + c] = l * cos(phi[c]);
    }
    for (int j = 0; j < 4; j++) { /* R = A^-1 H^T */
        double f[2] = {H[j][0], H[j][1]};
        for (int i = 0; i < 3; i++) {
            f[0] -= k[i] * cos(angle[i]) * H[j][2 + i] / inertia[i];
            f[1] -= k[i] * sin(angle[i]) * H[j][2 + i] / inertia[i];
        }
        R[j][0] = (hip[1][1] * f[0] - hip[0][1] * f[1]) / det;
        R[j][1] = (hip[0][0] * f[1] - hip[1][0] * f[0]) / det;
        for (int i = 0; i < 3; i++)
            R[j][2 + i] =
                (H[j][2 + i] - k[i] * (cos(angle[i]) * R[j][0] + sin(angle[i]) * R[j][1])) /
                inertia[i];
    }
    for (int i = 0; i < 4; i++) {
        p->v[i] = 0;
        for (int a = 0; a < 5; a++)
            p->v[i] += H[i][a] * w[a];
        for (int j = 0; j < 4; j++) {
            p->D[i][j] = 0;
            for (int a = 0; a < 5; a++)
                p->D[i][j] += H[i][a] * R[j][a];
        }
    }
    p->friction = uniform(seed, 0, 1) < 0.1 ? 0 : uniform(seed, 0, 2);
    const double e = rebounds ? uniform(seed, 0, 1) : 0;
    for (int c = 0; c < 2; c++)
        p->e[c] = e * fmin(p->v[2 * c], 0);
}

/* The kernel's solution: as from a step that is not ordinary, or with contacts that stood before.
 */
static void solve(const struct problem *p, int contacts, bool stood, bool most, double *r,
                  bool *ambiguous, bool *unsolved)
{
    double D[2][2][2][2], uf[2][2], out[2][2], shift[2][2] = {{0}};
    const double last[2][2] = {{1, 0}, {1, 0}};
    const bool active[2] = {true, contacts == 2};
    struct contact_verdict verdict;
    for (int c = 0; c < 2; c++) {
        shift[c][0] = p->e[c];
        for (int a = 0; a < 2; a++) {
            uf[c][a] = p->v[2 * c + a] + (a == 0 ? p->e[c] : 0);
            for (int j = 0; j < 4; j++)
                D[c][j / 2][a][j % 2] = p->D[2 * c + a][j];
        }
    }
    struct contact_problem problem =
        contact_pose(D, uf, contacts == 2 ? 3 : 1, active, p->friction, most ? -1 : 1);
    problem.shift = shift;
    problem.last = stood ? last : NULL, problem.known = true;
    solve_contacts(&problem, LANES_ALL, out, &verdict);
    *ambiguous = verdict.ambiguous, *unsolved = verdict.unsolved;
    for (int i = 0; i < 2 * contacts; i++)
        r[i] = out[i / 2][i % 2];
}

static void least_energy(const char *name, bool default_robot, bool rebounds, int n)
{
    uint64_t seed = 31;
    int several = 0, missed = 0, unflagged = 0, unsolved = 0, none = 0;
    double worst = 0;
    for (int i = 0; i < n; i++) {
        struct problem p;
        const int contacts = i % 4 ? 2 : 1;
        double r[4] = {0}, best[4], least, most, energy, scale = 1;
        bool ambiguous, failed;
        random_problem(&seed, default_robot, rebounds, &p);
        for (int k = 0; k < 4; k++)
            scale = fmax(scale, fabs(p.v[k]));
        const int found = enumerate(&p, contacts, 1e-9 * scale, &least, best);
        solve(&p, contacts, false, false, r, &ambiguous, &failed);
        unsolved += failed;
        none += found == 0;
        if (found == 0 || failed)
            continue;
        several += found > 1;
        unflagged += found > 1 && !ambiguous;
        worst = fmax(worst, violation(&p, contacts, r, &energy) / scale);
        const double kinetic = fabs(least) + 1e-3;
        missed += energy > least + 1e-8 * kinetic;
        /* What stood goes on standing where it can, and that is the same solution at e = 0. */
        double stays[4] = {0};
        solve(&p, contacts, true, false, stays, &ambiguous, &failed);
        violation(&p, contacts, stays, &most);
        if (!rebounds && !failed)
            missed += most > least + 1e-8 * kinetic;
        solve(&p, contacts, false, true, stays, &ambiguous, &failed);
        violation(&p, contacts, stays, &most);
        missed += !failed && most < energy - 1e-8 * kinetic;
    }
    print_message("# %s: %d problems, %d with several solutions; not the least energy %d, not "
                  "counted %d, unsolved %d (no solution: %d), laws violated by %.1e at most\n",
                  name, n, several, missed, unflagged, unsolved, none, worst);
    assert_int_equal(missed, 0);
    assert_int_equal(unflagged, 0);
    assert_int_equal(unsolved, 0);
    assert_true(several > n / 1000);
    assert_true(worst < 1e-9);
}

static int problems(void)
{
    return long_tests() ? 1000000 : 30000;
}
TEST(problems_of_the_default_robot)
{
    least_energy("default robot, e = 0", true, false, problems());
}
TEST(default_robot_rebounds)
{
    least_energy("default robot, e > 0", true, true, problems());
}
TEST(random_robots)
{
    least_energy("random robots, e = 0", false, false, problems());
}
TEST(random_robots_rebound)
{
    least_energy("random robots, e > 0", false, true, problems());
}
