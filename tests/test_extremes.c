/* test_extremes - falls and largest values between the ends of steps, by the methods that look
 * there, against closed forms; and at the ends alone, by the others.
 */
#include "long.h"
#include "motions.h"

static const double steps[] = {0.02, 0.004, 0.001};
enum { STEPS = COUNT(steps) };

/* Both methods that look inside, in steps of each length. */
#define EACH_LOOK(m, k)                                                                            \
    for (const stance_method *const *m = stance_methods(); *m; m++)                                \
        for (int k = 0; k < ((*m)->tolerance > 0 ? STEPS : 0); k++)

/* ---- falls ------------------------------------------------------------------------------------*/

static double first_down(double (*height)(double t, const double *x), const double *x, double T,
                         double *least)
{
    enum { PARTS = 3000 };
    double first = INFINITY;
    *least = INFINITY;
    for (int k = 0; k <= PARTS; k++) {
        const double t = T * k / PARTS, h = height(t, x);
        *least = fmin(h, *least);
        if (h > 0 || first < INFINITY)
            continue;
        double low = t - T / PARTS, high = t;
        for (int n = 0; n < 60; n++) {
            const double half = (low + high) / 2;
            *(height(half, x) > 0 ? &low : &high) = half;
        }
        first = high;
    }
    return first;
}

/* A stick is thrown: its tip, x = z, vz, angle, rate. */
static double tip_above(double t, const double *x)
{
    return x[0] + x[1] * t - G / 2 * t * t + cos(x[2] + x[3] * t) - 0.2;
}
TEST(thrown)
{
    ROBOT r = robot_of("body stick free - 1 0.1 0 0 0 0\nnamed tip stick 0 1 0.2\n", 0);
    uint64_t seed = 7;
    int fell[2] = {0}, between = 0;
    for (int i = 0; i < 1000; i++) {
        const double x[4] = {uniform(&seed, 1.1, 1.3), uniform(&seed, 1, 2),
                             uniform(&seed, -0.5, 0.5), uniform(&seed, 12, 24)};
        double least;
        const double T = 0.3, when = first_down(tip_above, x, T, &least);
        r.c.position[1] = x[0], r.c.velocity[1] = x[1];
        r.c.position[2] = x[2], r.c.velocity[2] = x[3];
        if (fabs(least) < 1e-5 || fabs(least) > 0.02)
            continue;
        fell[when < INFINITY]++;
        const double end = ceil(when / 0.02) * 0.02;
        between += when < INFINITY && tip_above(end, x) > 0;
        EACH_LOOK(m, k)
        {
            const stance_result e = run(&r, *m, steps[k], T);
            assert_int_equal(e.outcome, when < INFINITY ? STANCE_FELL : STANCE_UNDECIDED);
            assert_int_equal(e.fall_cause, when < INFINITY);
            if (when == INFINITY)
                continue;
            near((*m)->name, "fall time", e.fall_time, when, 1e-9);
            assert_true(e.fall_time <= e.end_time && e.end_time < e.fall_time + 1.001 * steps[k]);
        }
    }
    print_message("# %d fell, %d did not; %d were up again at the end of a step of 20 ms\n",
                  fell[1], fell[0], between);
    assert_true(fell[0] > 20 && fell[1] > 20 && between > 5);
}

/* A wheel on a spring that may turn a little less, or more, than it does; the fixed steps that
 * their method names are judged at their ends. */
TEST(turned)
{
    const double A = 0.7, w = sqrt(30 / 0.5);
    int seen = 0, tried = 0;
    for (int i = -2; i <= 2; i++) {
        char text[200];
        const double turn = i == 0 ? A / 2 : A * (1 - 1e-5 * i);
        snprintf(text, sizeof text, "body wheel hinge - 1 0.5 0 0 0 0 stiffness 30 turn %.17g\n",
                 turn);
        ROBOT r = robot_of(text, 0);
        r.c.velocity[0] = A * w;
        for (const stance_method *const *m = stance_methods(); *m; m++)
            for (int k = 0; k < STEPS; k++) {
                const stance_result e = run(&r, *m, steps[k], 0.22);
                if ((*m)->tolerance <= 0) {
                    if (e.outcome == STANCE_FELL)
                        assert_true(e.fall_time == e.end_time);
                    if (steps[k] == 0.02)
                        seen += i > 0 && e.outcome == STANCE_FELL, tried += i > 0;
                    continue;
                }
                assert_int_equal(e.outcome, i >= 0 ? STANCE_FELL : STANCE_UNDECIDED);
                if (i >= 0)
                    near((*m)->name, "fall time", e.fall_time, asin(turn / A) / w,
                         i > 0 ? 2e-6 : 2e-7);
            }
    }
    assert_true(seen < tried);
}

/* ---- largest values ---------------------------------------------------------------------------*/

/* Largest of `count` values over [0, T]. */
static void largest_of(void (*values)(double t, const double *x, double *v), const double *x,
                       double T, int count, double *most)
{
    enum { PARTS = 20000 };
    double v[4];
    for (int i = 0; i < count; i++)
        most[i] = -INFINITY;
    for (int k = 0; k <= PARTS; k++) {
        values(T * k / PARTS, x, v);
        for (int i = 0; i < count; i++)
            most[i] = fmax(v[i], most[i]);
    }
}

/* A wheel that a motor holds, x = angle, rate, kp, kd: |angle|, |torque|. */
#define WHEEL 0.4
static void wheel_held(double t, const double *x, double *v)
{
    const double decay = x[3] / 2 / WHEEL, w = sqrt(x[2] / WHEEL - decay * decay);
    const double e = exp(-decay * t), b = (x[1] + decay * x[0]) / w;
    const double q = e * (x[0] * cos(w * t) + b * sin(w * t));
    const double rate = -decay * q + w * e * (b * cos(w * t) - x[0] * sin(w * t));
    v[0] = fabs(q);
    v[1] = fabs(x[2] * q + x[3] * rate);
}
TEST(held)
{
    ROBOT r = robot_of("body wheel hinge - 1 0.4 0 0 0 0\nactuator motor wheel 1000\n", 0);
    uint64_t seed = 11;
    double worst[2] = {0};
    for (int i = 0; i < (long_tests() ? 40 : 10); i++) {
        const double target = 0.3, T = ceil(uniform(&seed, 1, 10)) * 0.1;
        const double x[4] = {uniform(&seed, -1, 1), uniform(&seed, -10, 10), uniform(&seed, 10, 60),
                             uniform(&seed, 0, 3)};
        double most[2];
        largest_of(wheel_held, x, T, 2, most);
        r.c.position[0] = target + x[0], r.c.velocity[0] = x[1];
        r.c.near.target[0] = target, r.c.has_target = true;
        r.c.near.gain[0][0] = x[2], r.c.near.gain[0][1] = x[3];
        EACH_LOOK(m, k)
        {
            const stance_result e = run(&r, *m, steps[k], T);
            worst[0] = fmax(worst[0], fabs(e.excursion - most[0]));
            worst[1] = fmax(worst[1], fabs(e.peak_torque - most[1]) / most[1]);
        }
        r.c.torque_limit = most[1] / 2;
        EACH_LOOK(m, k)
        assert_true(run(&r, *m, steps[k], T).peak_torque == r.c.torque_limit);
        r.c.torque_limit = INFINITY;
    }
    print_message("# excursion off by %.1e, torque by %.1e\n", worst[0], worst[1]);
    assert_true(worst[0] < 5e-7 && worst[1] < 1e-5);
}

/* A mass on a spring in a box that stands, x = where it begins, how its way leans: |rT| / rN and,
 * where it does not lean, less than nothing at either end of the sole. */
static void mass_sprung(double t, const double *x, double *v)
{
    const double cosine = 1 / sqrt(1 + x[1] * x[1]), w = sqrt(3000. / 2);
    const double a = -w * w * (x[0] + 2 * G * cosine / 3000) * cos(w * t);
    const double normal = 3 * G + 2 * a * cosine;
    v[0] = fabs(2 * a * x[1] * cosine) / normal;
    v[1] = -normal / 2;
}
TEST(sprung)
{
    uint64_t seed = 13;
    double worst[3] = {0};
    for (int leans = 0; leans < 2; leans++) {
        ROBOT r =
            robot_of(leans ? "body box free - 1 0.05 0 0.02 0 0\n"
                             "body mass slide box 2 0.05 0 0 0 0.1 axis 0.3 1 stiffness 3000\n"
                             "sole s box -0.3 0 0.3 0\n"
                           : "body box free - 1 0.05 0 0.02 0 0\n"
                             "body mass slide box 2 0.05 0 0 0 0.1 axis 0 1 stiffness 3000\n"
                             "sole s box -0.3 0 0.3 0\n",
                     0);
        r.c.supports = 3;
        for (int i = 0; i < 30; i++) {
            const double x[2] = {uniform(&seed, -0.012, 0), leans ? 0.3 : 0};
            const bool peaks = i % 2; /* at 0.081 s; else it ends on the way there */
            const double T = ceil(uniform(&seed, peaks ? 4.1 : 0, peaks ? 10 : 3.9)) * 0.02;
            double most[2];
            largest_of(mass_sprung, x, T, 2, most);
            r.c.position[3] = x[0];
            EACH_LOOK(m, k)
            {
                const stance_result e = run(&r, *m, steps[k], T);
                worst[0] = fmax(worst[0], fabs(e.friction_used - most[0]));
                if (!leans)
                    worst[1 + peaks] = fmax(worst[1 + peaks], fabs(e.least_normal_force + most[1]));
            }
        }
    }
    print_message("# friction off by %.1e, normal force by %.1e N at a peak, %.1e N on the way\n",
                  worst[0], worst[2], worst[1]);
    /* On the way standing steps know the last force of all to order 3. */
    assert_true(worst[0] < 5e-6 && worst[2] < 1e-5 && worst[1] < 5e-3);
}

/* An arm that hangs is thrown at a stop, and falls back: the furthest place is that of the impact,
 * inside a step. */
TEST(struck)
{
    ROBOT r = robot_of("body arm hinge - 1 0.1 0 -0.5 0 0 limits -inf 0.3\n", 0);
    r.c.has_target = true;
    for (int i = 0; i < 10; i++) {
        r.c.velocity[0] = 2 + 0.2 * i;
        EACH_LOOK(m, k)
        {
            const stance_result end = run(&r, *m, steps[k], 0.4);
            assert_true(end.position[0] < 0.299 && fabs(end.excursion - 0.3) < 1e-7);
        }
    }
}
