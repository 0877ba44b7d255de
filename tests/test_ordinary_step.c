/* test_ordinary_step - the ordinary step against the step in full, and direct contact solutions
 * against the trial of every mode: the kernel's own functions, one lane wide.
 */
#define STANCE_LANES 1
#define STANCE_SCENE biped
#define STANCE_ISA inside
#define STANCE_SCENE_LANES "engine/scenes/biped_lanes.h"
#include "engine/methods/implicit.c"
#include "inside.h"

/* A random operator: symmetric and positive, of condition up to 1e4, bent a little. */
static void random_operator(uint64_t *seed, int n, double bend, double D[2][2][2][2])
{
    double root[4][6];
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 6; k++)
            root[i][k] = uniform(seed, -1, 1) * (k == i ? 1 : 0.6);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = i == j ? 1e-3 : 0;
            for (int k = 0; k < 6; k++)
                sum += root[i][k] * root[j][k];
            D[i / 2][j / 2][i % 2][j % 2] = sum + (i == j ? 0 : bend * uniform(seed, -1, 1));
        }
}

/* Where direct solutions call themselves certain, trying every mode finds the same and no other. */
TEST(direct_is_exact)
{
    enum { TRIES = 200000 };
    uint64_t seed = 5;
    for (int contacts = 1; contacts <= 2; contacts++) {
        int certain = 0, modes[3] = {0};
        double worst = 0;
        for (int i = 0; i < TRIES; i++) {
            double D[2][2][2][2] = {{{{0}}}}, uf[2][2], r[2][2] = {{0}}, sliding[2];
            const double friction = i % 7 == 0 ? 0 : uniform(&seed, 0, 1.5);
            const bool slides = i % 3 == 0;
            random_operator(&seed, 2 * contacts, i % 2 ? 1e-2 : 0, D);
            for (int c = 0; c < 2; c++) {
                uf[c][0] = uniform(&seed, -1, 0.5), uf[c][1] = uniform(&seed, -1, 1);
                sliding[c] = floor(uniform(&seed, -1, 2)); /* -1, 0, 1 */
            }
            const double *const goes_on = slides ? sliding : NULL;
            const contact_set touching = contacts == 1 ? 1 : 3;
            const mask active[2] = {true, contacts == 2};
            struct contact_problem asked = contact_pose(D, uf, touching, active, friction, 1);
            asked.sliding = goes_on;
            struct direct_mode mode;
            bool sure = false;
            direct_mode_of(&asked, false, &mode);
            if (contacts == 1)
                sure = direct_one(D[0][0], uf[0], friction, goes_on, r[0]);
            else if (direct_unique(&asked))
                for (int round = 0; round < DIRECT_ROUNDS && !sure; round++)
                    sure = direct_try(&asked, 1e-11, true, false, &mode, r);
            if (!sure)
                continue;
            struct lane_problem problem;
            struct lane_choice best;
            double found[2][2] = {{0}};
            lane_gather(&asked, touching, 0, &problem);
            lane_choose_none(&best);
            lane_enumerate(&problem, &best);
            for (int row = 0; row < problem.rows; row++)
                found[problem.contact[row]][problem.axis[row]] = best.r[row];
            certain++;
            assert_true(best.violation <= 1e-8);
            for (int c = 0; c < contacts; c++) {
                modes[r[c][0] <= 0 ? 0 : fabs(r[c][1]) < friction * r[c][0] * (1 - 1e-9) ? 1 : 2]++;
                for (int a = 0; a < 2; a++) {
                    const double scale = 1 + fabs(found[c][0]) + fabs(found[c][1]);
                    worst = fmax(worst, fabs(r[c][a] - found[c][a]) / scale);
                }
            }
            assert_false(best.ambiguous);
        }
        print_message("# %d contact%s: %d of %d certain (contacts open %d, stick %d, slip %d), "
                      "impulses off by %.1e at most\n",
                      contacts, contacts > 1 ? "s" : "", certain, TRIES, modes[0], modes[1],
                      modes[2], worst);
        assert_true(worst < 1e-8);
        assert_true(certain > TRIES / 2);
        assert_true(modes[0] > TRIES / 20 && modes[1] > TRIES / 20 && modes[2] > TRIES / 20);
    }
}

/* Every mode of two points in lanes finds what trying every mode alone does, and says the same of
 * other solutions: operators of any kind, legs that are parallel, slips that go on, impacts. */
TEST(pairs_are_exact)
{
    enum { TRIES = 100000 };
    uint64_t seed = 11;
    int found = 0, several = 0, solved = 0, unlike = 0;
    double worst = 0;
    for (int i = 0; i < TRIES; i++) {
        double D[2][2][2][2], uf[2][2], r[2][2] = {{0}}, sliding[2], shift[2][2];
        const double friction = i % 7 == 0 ? 0 : uniform(&seed, 0, 3);
        random_operator(&seed, 4, i % 5 == 0 ? 0.5 : i % 2 ? 1e-2 : 0, D);
        if (i % 4 == 0) /* both at one place, seen from two legs */
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++)
                    D[0][1][a][b] = D[1][0][b][a] = D[1][1][a][b] = D[0][0][a][b];
        for (int c = 0; c < 2; c++) {
            uf[c][0] = uniform(&seed, -1, 0.5), uf[c][1] = uniform(&seed, -1, 1);
            shift[c][0] = -uniform(&seed, 0, 0.5), shift[c][1] = 0;
            sliding[c] = floor(uniform(&seed, -1, 2));
        }
        if (i % 4 == 0) {
            memcpy(uf[1], uf[0], sizeof uf[0]);
            sliding[1] = sliding[0];
        }
        const mask active[2] = {true, i % 13 != 0};
        struct contact_problem asked =
            contact_pose(D, uf, 3, active, friction, i % 11 == 0 ? -1 : 1);
        asked.sliding = i % 3 == 0 ? sliding : NULL;
        asked.shift = i % 3 == 1 ? shift : NULL;
        asked.indefinite = i % 5 == 0 && i % 4 != 0;
        struct lane_problem problem;
        struct lane_choice best;
        double alone[2][2] = {{0}};
        mask ambiguous = false;
        lane_gather(&asked, active[1] ? 3 : 1, 0, &problem);
        lane_choose_none(&best);
        lane_enumerate(&problem, &best);
        lane_clip(&problem, best.u, best.r);
        for (int row = 0; row < problem.rows; row++)
            alone[problem.contact[row]][problem.axis[row]] = best.r[row];
        const bool valid = best.violation <= problem.tolerance;
        solved += valid;
        const struct contact_tolerance tolerance = {problem.exact, problem.tolerance};
        if (!pair_enumerate(&asked, (const int[2]){0, 1}, &tolerance, true, r, &ambiguous))
            continue;
        found++;
        several += ambiguous;
        assert_true(best.violation <= 1e3 * problem.tolerance);
        double off = 0, u[2][2], v[2][2];
        direct_velocities(D, uf, 3, r, u);
        direct_velocities(D, uf, 3, alone, v);
        for (int c = 0; c < 2; c++)
            for (int a = 0; a < 2 && active[c]; a++)
                off = fmax(off, fabs(u[c][a] - v[c][a]));
        unlike += off > 1e-6 || ambiguous != best.ambiguous;
        worst = off > 1e-6 ? worst : fmax(off, worst);
    }
    print_message("# two points: %d of %d found, %d have a solution, %d several; velocities off by "
                  "%.1e, %d unlike\n",
                  found, TRIES, solved, several, worst, unlike);
    assert_true(found > 0.99 * solved && several > TRIES / 100);
    assert_true(unlike <= 1e-4 * found && worst < 1e-8);
}

/* Over a very short time velocities are as small as what a solution may be off by. What is found
 * is one to rounding all the same, where there is one: the laws have no scale. */
TEST(small_ones_are_exact)
{
    enum { TRIES = 50000 };
    const double small = 1e-9, admitted = 1e-4 * small;
    uint64_t seed = 23;
    int solved = 0;
    double worst = 0;
    for (int i = 0; i < TRIES; i++) {
        double D[2][2][2][2], large[2][2], uf[2][2], u[2][2], r[2][2];
        random_operator(&seed, 4, i % 2 ? 1e-2 : 0, D);
        for (int c = 0; c < 2; c++) {
            large[c][0] = uniform(&seed, -1, 0.5), large[c][1] = uniform(&seed, -1, 1);
            uf[c][0] = small * large[c][0], uf[c][1] = small * large[c][1];
        }
        const mask active[2] = {true, true};
        struct contact_problem asked = contact_pose(D, large, 3, active, uniform(&seed, 0, 1.5), 1);
        struct contact_verdict verdict;
        struct lane_problem problem;
        struct lane_choice best;
        lane_gather(&asked, 3, 0, &problem);
        lane_enumerate(&problem, &best);
        if (best.violation > problem.exact)
            continue;
        solved++;
        asked.uf = uf;
        solve_contacts(&asked, true, r, &verdict);
        direct_velocities(D, uf, 3, r, u);
        worst = fmax(worst, direct_violation(&asked, r, u));
    }
    print_message("# two points at %.0e m/s: %d of %d have a solution, laws violated by %.1e at "
                  "most\n",
                  small, solved, TRIES, worst);
    assert_true(solved > 0.9 * TRIES);
    assert_true(worst <= admitted);
}

/* A law that acts inside the step: gains of either sign, limits that are reached now and then. */
static void random_law(uint64_t *seed, struct law *law)
{
    for (int i = 0; i < 2; i++) {
        law->near.feedforward[i] = uniform(seed, -5, 5);
        law->limit[i] = uniform(seed, 2, 10);
        for (int j = 0; j < 2 * POSTURES; j++)
            law->near.gain[i][j] = uniform(seed, -1, 3) * (j < POSTURES ? 10 : 2);
    }
}

/* Every ordinary step ends where the full iteration ends, to what ordinary_step.h promises; and it
 * is what nearly all steps are. */
TEST(ordinary_steps_are_converged)
{
    static const double steps[] = {1e-4, 1e-3, 5e-3, 2e-2};
    enum { TRIES = 600, LENGTH = 100, STEPS = COUNT(steps) };
    uint64_t seed = 17;
    for (size_t n = 0; n < 2 * STEPS; n++) {
        const bool coupled = n >= STEPS;
        const double h = steps[n % STEPS];
        if (n == STEPS)
            seed = 17;
        double worst = 0, most = 0, total = 0, iterations = 0;
        int taken = 0, ordinary = 0, redundant = 0, contested = 0,
            grazed = 0; /* by an iterate of the full iteration alone */
        for (int i = 0; i < TRIES; i++) {
            struct bundle b;
            double torque[2] = {uniform(&seed, -5, 5), uniform(&seed, -5, 5)};
            random_motion(&seed, i % 3 == 2 ? 3 : (uint32_t)(i % 3), 0, 1.2, h, &b);
            if (coupled)
                random_law(&seed, &b.set.law);
            for (int j = 0; j < LENGTH; j++) {
                struct iterate it;
                struct step_report quick, full;
                struct motion next = b.now;
                for (int a = 0; a < 2; a++) /* torques change as a law's would */
                    torque[a] += h * uniform(&seed, -20, 20);
                struct iterate raw;
                const contact_set touching = step_touching(&b.set, b.now.gap, true);
                const struct step step = {&b.set, &b.now, torque, coupled, h, STEP_MAX_ITERATIONS,
                                          NULL};
                ordinary_reach(&b.advance.quick, &step, true, touching, false, &raw);
                const bool good =
                    ordinary_try(&b.advance.quick, &step, true, touching, false, &it, &quick);
                const bool there = take_step(&step, true, &next, &full);
                taken++;
                if (!there)
                    break;
                if (good) {
                    ordinary++;
                    iterations += quick.iterations;
                    const double speed = iterate_speed(&it);
                    double mended = 0, off = 0;
                    grazed += full.landed;
                    for (int a = 0; a < 5; a++) {
                        mended = fmax(mended, fabs(it.w[a] - raw.w[a]));
                        off = fmax(off, fabs(it.w[a] - next.w[a]));
                    }
                    /* On parallel legs the iteration's way decides on what the feet do. */
                    const bool parallel =
                        it.active[0] && it.active[1] && fabs(sin(b.now.s[3] - b.now.s[4])) < 1e-3;
                    redundant += parallel;
                    /* Of several modes that would go on, the two may take different ones. */
                    const bool another =
                        off > 1e-3 * speed &&
                        fmax(quick.signorini_residual, quick.dissipation_residual) < 1e-10;
                    contested += another;
                    if (full.landed == 0 && !parallel && !another)
                        worst = fmax(worst, (off - 1e-4 * mended) / speed);
                    most = fmax(most, mended / speed);
                    total = fmax(total, off / speed);
                    ordinary_keep(&b.advance.quick, &it, h, true, true, &b.now);
                } else {
                    ordinary_forget(&b.advance.quick, true);
                    b.now = next;
                }
            }
        }
        print_message(
            "# %s, h = %g: %d of %d steps ordinary, %.2f iterations each, velocities off by "
            "%.1e of the speed at most, of the mending by %.1e where it is up to %.1e\n",
            coupled ? "a law inside" : "torques held", h, ordinary, taken, iterations / ordinary,
            worst, total, most);
        /* The longest steps leave up to 2.7e-9 in one of five seeds: 1e-4 of what is mended is what
         * it may usually be off. */
        assert_true(worst <= (h < 0.01 ? 1e-11 : 5e-9));
        assert_true(grazed <= 1e-4 * ordinary);
        assert_true(redundant <= 0.05 * ordinary);
        assert_true(contested <= 1e-4 * ordinary);
        assert_true(ordinary > 0.8 * taken);
    }
}
