/* test_standing_step - the standing step against itself in small parts: its order, what its
 * estimate says of its error, and that it is what most steps of such robots are; the kernel's own
 * functions, one lane wide.
 */
#define STANCE_LANES 1
#define STANCE_SCENE biped
#define STANCE_ISA inside
#define STANCE_SCENE_LANES "engine/scenes/biped_lanes.h"
#include "engine/methods/capturing.c"
#include "inside.h"

enum { PARTS = 32 };

/* A robot at random, and torques. */
static contact_set random_robot(uint64_t *seed, contact_set on, double h, struct bundle *b,
                                double *torque)
{
    random_motion(seed, on, 0.5, 1.5, h, b);
    for (int a = 0; a < 2; a++)
        torque[a] = uniform(seed, -5, 5);
    return step_touching(&b->set, b->now.gap, true);
}

/* One step of length h in `parts`; false: not of this kind. */
static bool take(contact_set touching, const struct bundle *b, const double *torque, double h,
                 int parts, struct motion *to, struct step_report *sum, double *error)
{
    struct motion here = b->now;
    report_clear(sum);
    for (int k = 0; k < parts; k++) {
        struct step_report part;
        const struct step step = {&b->set, &here, torque, .h = h / parts};
        if (!standing_take(touching, &step, true, true, to, &part, error))
            return false;
        report_add(sum, &part);
        here = *to;
    }
    return true;
}

static double apart(const struct motion *a, const struct motion *b)
{
    double most = 0;
    for (int i = 0; i < 5; i++)
        most = fmax(most, fmax(fabs(a->s[i] - b->s[i]), fabs(a->w[i] - b->w[i])));
    return most;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Errors of steps h and h / 2 against 32 parts: order 4 makes them 32 times smaller in a step. And
 * an estimate below the error is what a tolerance cannot bear. */
TEST(errors_are_estimated)
{
    static const double steps[] = {1e-3, 5e-3, 2e-2};
    enum { TRIES = 3000 };
    static double ratio[TRIES];
    uint64_t seed = 23;
    for (size_t k = 0; k < COUNT(steps); k++)
        for (contact_set which = 0; which < 2; which++) {
            int taken = 0, tried = 0, low = 0, counted = 0;
            double worst = 0, works = 0;
            for (int i = 0; i < TRIES; i++) {
                struct bundle b;
                double torque[2], error, other;
                struct motion one, two, many;
                struct step_report report, fine;
                const contact_set touching = random_robot(&seed, which, steps[k], &b, torque);
                assert_int_equal(touching, which);
                tried++;
                if (!take(touching, &b, torque, steps[k], 1, &one, &report, &error) ||
                    !take(touching, &b, torque, steps[k] / 2, 1, &two, &fine, &other) ||
                    !take(touching, &b, torque, steps[k], PARTS, &many, &fine, &other))
                    continue;
                taken++;
                const double off = apart(&one, &many);
                low += off > fmax(error, 1e-13);
                worst = fmax(worst, off / fmax(error, 1e-13));
                works = fmax(works, fabs(report.work - fine.work) / fmax(error, 1e-13));
                struct motion half;
                assert_true(take(touching, &b, torque, steps[k] / 2, PARTS, &half, &fine, &other));
                const double less = apart(&two, &half);
                if (less > 1e-14)
                    ratio[counted++] = off / less;
            }
            qsort(ratio, (size_t)counted, sizeof *ratio, by_size);
            const double middle = counted > 100 ? ratio[counted / 2] : NAN;
            print_message("# h = %g, %s: %d of %d taken, error %.2g of the estimate at most, above "
                          "it in %d, work %.2g; half the step: 1 / %.1f (%d)\n",
                          steps[k], which ? "one foot" : "flight", taken, tried, worst, low, works,
                          middle, counted);
            assert_true(taken > 0.5 * tried);
            assert_true(low <= 3e-3 * taken);
            assert_true(counted <= 100 || (middle > 27 && middle < 37));
        }
}

/* What stands is held: gaps, contact velocities, and no energy but the work of the torques. */
TEST(standing_is_exact)
{
    enum { TRIES = 300, LENGTH = 200 };
    uint64_t seed = 29;
    double gap = 0, slip = 0, drift = 0;
    int taken = 0;
    for (int i = 0; i < TRIES; i++) {
        struct bundle b;
        double torque[2], work = 0, error;
        const contact_set touching = random_robot(&seed, 1, 1e-3, &b, torque);
        struct motion next;
        struct step_report report;
        const double before = b.now.energy;
        for (int n = 0; n < LENGTH; n++) {
            const struct step step = {&b.set, &b.now, torque, .h = 1e-3};
            if (!standing_take(touching, &step, true, n % 32 == 0, &next, &report, &error))
                break;
            taken++;
            b.now = next;
            work += report.work;
            motion_energy(&b.set, &b.now);
            gap = fmax(gap, fabs(b.now.gap[0]));
            slip = fmax(slip, fmax(report.signorini_residual, report.dissipation_residual));
            drift = fmax(drift, fabs(b.now.energy - before - work));
            for (int a = 0; a < 2; a++)
                torque[a] += 1e-3 * uniform(&seed, -20, 20);
        }
    }
    print_message("# %d steps: gap %.1e m, contact velocity %.1e m/s, energy %.1e J\n", taken, gap,
                  slip, drift);
    assert_true(taken > TRIES * LENGTH / 4);
    assert_true(gap < 1e-14 && slip < 1e-13 && drift < 1e-7);
}
