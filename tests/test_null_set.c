/* The null-controllable set: its support function against quadrature, its gauge against closed
 * forms, against all directions, and against torques that steer a point just inside home. */
#define DENSE_ROWS 10
#include "dense.h"
#include "linear.h"
#include "long.h"

#include "runner/plan/design.h"

enum { K = DENSE_ROWS, INPUTS = 4 }; /* states and torques at most */

/* out[rows][columns] = a[rows][inner] b[inner][columns], of neither of which it may be part. */
static void multiply(int rows, int inner, int columns, const double *a, const double *b,
                     double *out)
{
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            out[i * columns + j] = 0;
            for (int k = 0; k < inner; k++)
                out[i * columns + j] += a[i * inner + k] * b[k * columns + j];
        }
}

/* A = T D T^-1 in a random basis T. */
static void random_basis(uint64_t *seed, int n, const double *D, double *T, double *A)
{
    double inverse[K * K], product[K * K];
    for (int i = 0; i < n * n; i++)
        T[i] = uniform(seed, -1, 1) + (i % (n + 1) == 0 ? 2 : 0);
    assert_true(dense_inverse(n, n, T, inverse));
    multiply(n, n, n, T, D, product);
    multiply(n, n, n, product, inverse, A);
}

/* x' = A x + B u with the given eigenvalues (of pairs one) in a random basis, and random B. */
static void random_plant(uint64_t *seed, int n, int m, const double *re, const double *im,
                         double *A, double *B)
{
    double D[K * K] = {0}, T[K * K];
    for (int i = 0; i < n; i++) {
        D[i * n + i] = re[i];
        if (im[i] > 0) {
            D[i * n + i + 1] = -im[i], D[(i + 1) * n + i] = im[i], D[(i + 1) * n + i + 1] = re[i];
            i++;
        }
    }
    random_basis(seed, n, D, T, A);
    for (int i = 0; i < n * m; i++)
        B[i] = uniform(seed, -1, 1);
}

static stance_null_set *made(int n, int m, const double *A, const double *B, const double *low,
                             const double *high)
{
    stance_null_set *set;
    stance_message message = {""};
    if (stance_null_set_make(PLANT(n, m, A, B), low, high, &set, &message) != STANCE_OK)
        fail_msg("%s", message.text);
    return set;
}

static void set_gone(stance_null_set *const *set)
{
    stance_null_set_free(*set);
}
#define NULL_SET FREED(set_gone) stance_null_set

/* x' = a x + b u: |x| < b u / a, by sides. */
TEST(one_mode)
{
    const double a = 2, b = 3, low = -1, high = 5;
    NULL_SET *set = made(1, 1, &a, &b, &low, &high);
    double re[K], im[K];
    assert_int_equal(stance_null_set_modes(set, re, im), 1);
    assert_near(re[0], 2, 1e-14, "mode");
    for (double x = -8; x < 8; x += 0.37) {
        const double wanted = x > 0 ? x / 1.5 : -x / 7.5; /* positive x takes negative torque */
        assert_near(stance_null_set_gauge(set, &x), wanted, 1e-13, "gauge");
        assert_true(stance_null_set_holds(set, &x) == (wanted < 1));
    }
}

/* diag(l1, l2), one symmetric torque |u| <= 1, b = (1, 1): the boundary is traced by u switching
 * once at time T: z = -(1/l) (1 - 2 exp(-l T)) of each mode (Hu and Lin, section 2.4). */
TEST(two_modes)
{
    const double A[4] = {3, 0, 0, 1.2}, B[2] = {1, 1}, low = -1, high = 1;
    NULL_SET *set = made(2, 1, A, B, &low, &high);
    for (double T = 0; T < 6; T += 0.01) {
        double z[2];
        for (int i = 0; i < 2; i++)
            z[i] = -(1 - 2 * exp(-A[3 * i] * T)) / A[3 * i];
        assert_near(stance_null_set_gauge(set, z), 1, 1e-12, "boundary");
        z[0] *= -0.5, z[1] *= -0.5;
        assert_near(stance_null_set_gauge(set, z), 0.5, 1e-12, "inside");
    }
}

struct plant {
    int n, m, k;
    double A[K * K], B[K * INPUTS], low[INPUTS], high[INPUTS];
    double unstable[K * K]; /* projector on the modes that are, of rows from the right */
};

/* E[n][n] = exp(-A t) by Taylor and squaring. */
static void flow(const struct plant *p, double t, double E[K * K])
{
    const int n = p->n, parts = 1 << 10;
    double next[K * K], power[K * K], part[K * K], fact = 1;
    for (int i = 0; i < n * n; i++) {
        E[i] = power[i] = i % (n + 1) == 0;
        part[i] = -p->A[i] * (t / parts);
    }
    for (int order = 1; order < 14; order++) {
        multiply(n, n, n, power, part, next);
        memcpy(power, next, sizeof power);
        fact *= order;
        for (int i = 0; i < n * n; i++)
            E[i] += power[i] / fact;
    }
    for (int s = 1; s < parts; s *= 2) {
        multiply(n, n, n, E, E, next);
        memcpy(E, next, sizeof next);
    }
}

/* Of plants of unstable modes alone the set has an inside in x itself, with the support function
 * integral of max over u of -eta' exp(-A t) B u; by Simpson's rule, an interval in which the torque
 * changes in its two parts. */
static double part_of(const struct plant *p, int j, const double s[3], double h)
{
    const double bound[2] = {p->low[j], p->high[j]};
    if ((s[0] > 0) == (s[2] > 0))
        return h / 6 * (s[0] + 4 * s[1] + s[2]) * bound[s[1] > 0];
    const double at = h * s[0] / (s[0] - s[2]);
    return 0.5 * (s[0] * at * bound[s[0] > 0] + s[2] * (h - at) * bound[s[2] > 0]);
}

static void march(int n, const double *E, double *row)
{
    double next[K];
    multiply(1, n, n, row, E, next);
    memcpy(row, next, sizeof(double) * (size_t)n);
}

static double quadrature(const struct plant *p, const double *eta, double slowest)
{
    enum { PARTS = 20000 };
    const double h = 36 / slowest / PARTS;
    double row[K], E[K * K], s[INPUTS][3], sum = 0;
    flow(p, h / 2, E);
    for (int i = 0; i < p->n; i++) /* rounding must not grow along the others */
        march(p->n, p->unstable, E + i * p->n);
    memcpy(row, eta, sizeof(double) * (size_t)p->n);
    for (int t = 0; t < PARTS; t++) {
        for (int part = 0; part < 3; part++) {
            double along[INPUTS];
            multiply(1, p->n, p->m, row, p->B, along);
            for (int j = 0; j < p->m; j++)
                s[j][part] = -along[j];
            if (part < 2)
                march(p->n, E, row);
        }
        for (int j = 0; j < p->m; j++)
            sum += part_of(p, j, s[j], h);
    }
    return sum;
}

/* How far off 1 the gauge is against quadrature at some points, and the integral in other
 * directions above it. */
struct errors {
    int points;
    double worst, above;
};

/* Along x, the largest eta' x / h(eta) over directions near the one that the set itself gives is
 * its gauge, h by quadrature. */
static void compare(uint64_t *seed, const struct plant *p, const stance_null_set *set,
                    double slowest, int points, struct errors *e)
{
    for (int k = 0; k < points; k++) {
        double x[K], eta[K], along;
        for (int i = 0; i < p->n; i++)
            x[i] = uniform(seed, -1, 1);
        const double gauge = stance_null_set_gauge(set, x);
        if (gauge > 1e3) /* a torque hardly reaches some mode: no differences, then */
            continue;
        e->points++;
        /* The normal at the boundary point x / gauge, by differences of the gauge. */
        for (int i = 0; i < p->n; i++) {
            double high[K], low[K];
            memcpy(high, x, sizeof x), memcpy(low, x, sizeof x);
            high[i] += 1e-5, low[i] -= 1e-5;
            eta[i] = (stance_null_set_gauge(set, high) - stance_null_set_gauge(set, low)) / 2e-5;
        }
        march(p->n, p->unstable, eta);
        multiply(1, p->n, 1, eta, x, &along);
        e->worst = fmax(e->worst, fabs(along / quadrature(p, eta, slowest) / gauge - 1));
        /* No direction gives more. */
        for (int d = 0; d < 2; d++) {
            double other[K];
            for (int i = 0; i < p->n; i++)
                other[i] = eta[i] * (1 + uniform(seed, -0.3, 0.3));
            march(p->n, p->unstable, other);
            multiply(1, p->n, 1, other, x, &along);
            e->above = fmax(e->above, along / quadrature(p, other, slowest) / gauge - 1);
        }
        for (int i = 0; i < p->n; i++)
            x[i] /= gauge * 1.000001;
        assert_true(stance_null_set_holds(set, x));
        for (int i = 0; i < p->n; i++)
            x[i] *= 1.000002;
        assert_false(stance_null_set_holds(set, x));
    }
}

/* Of 1 to 5 modes, pairs among them. */
TEST(support_is_the_integral)
{
    uint64_t seed = 3;
    struct errors e = {0};
    const int rounds = long_tests() ? 10 : 3;
    for (int round = 0; round < rounds; round++) {
        struct plant p = {.n = 1 + round % 5, .m = 1 + round % 3};
        double re[K] = {0}, im[K] = {0}, slowest = INFINITY;
        for (int i = 0; i < p.n; i++) {
            re[i] = uniform(&seed, 0.5, 5);
            if (i + 1 < p.n && uniform(&seed, 0, 1) < 0.4) {
                im[i] = uniform(&seed, 0.1, 6), im[i + 1] = -im[i], re[i + 1] = re[i];
                slowest = fmin(slowest, re[i]);
                i++;
            }
            slowest = fmin(slowest, re[i]);
        }
        random_plant(&seed, p.n, p.m, re, im, p.A, p.B);
        for (int i = 0; i < p.n; i++)
            p.unstable[i * p.n + i] = 1;
        for (int j = 0; j < p.m; j++)
            p.low[j] = -uniform(&seed, 0.2, 2), p.high[j] = uniform(&seed, 0.2, 2);
        NULL_SET *set = made(p.n, p.m, p.A, p.B, p.low, p.high);
        assert_int_equal(stance_null_set_modes(set, NULL, NULL), p.n);
        compare(&seed, &p, set, slowest, 5, &e);
    }
    print_message("# %d points: gauge by quadrature off by %.1e; another direction above by %.1e\n",
                  e.points, e.worst, e.above);
    assert_true(e.points > 3 * rounds && e.worst < 1e-6 && e.above < 1e-6);
}

/* The projector on eigenvalues beyond `shift`: (1 + sign(A - shift)) / 2, the sign by Newton's
 * iteration (Roberts 1980). */
static void project(struct plant *p, double shift)
{
    const int n = p->n;
    double S[K * K], inverse[K * K], moved = INFINITY;
    for (int i = 0; i < n * n; i++)
        S[i] = p->A[i] - (i % (n + 1) == 0 ? shift : 0);
    for (int round = 0; round < 100 && moved > 1e-14; round++) {
        moved = 0;
        assert_true(dense_inverse(n, n, S, inverse));
        for (int i = 0; i < n * n; i++) {
            const double next = 0.5 * (S[i] + inverse[i]);
            moved = fmax(moved, fabs(next - S[i]) / (1 + fabs(next)));
            S[i] = next;
        }
    }
    assert_true(moved < 1e-11);
    for (int i = 0; i < n * n; i++)
        p->unstable[i] = 0.5 * (S[i] + (i % (n + 1) == 0));
}

static stance_null_set *design_set(struct design_report *r, const struct scenario *s,
                                   const char *what)
{
    stance_message message = {""};
    stance_null_set *const set = design_plant(r, s, &message) ? design_null_set(r, &message) : NULL;
    if (!set)
        fail_msg("%s: %s", what, message.text);
    return set;
}

/* Robots with random numbers, of one, two and three unstable modes beside others. */
TEST(robots)
{
    static const struct {
        const char *file, *robot;
        int modes;
        struct {
            const char *path;
            double value;
        } number[4];
    } kinds[] = {
        {"scenarios/mechanisms/cart_pole.yaml",
         "cart and pole",
         1,
         {{"robot.bodies.cart.mass", 1},
          {"robot.bodies.pole.mass", 0.1},
          {"robot.bodies.pole.inertia", 0.00833},
          {"robot.actuators.push.limit", 20}}},
        {"scenarios/balance_recovers.yaml",
         "biped on one foot",
         2,
         {{"robot.trunk_mass", 1.8},
          {"robot.foot_mass", 1.8},
          {"robot.leg_length", 0.535},
          {"controller.torque_limit", 30}}},
        {"scenarios/mechanisms/rabbit.yaml",
         "RABBIT on one foot",
         3,
         {{"robot.bodies.trunk.mass", 20},
          {"robot.bodies.thigh1.mass", 6.8},
          {"robot.bodies.shank1.inertia", 0.93},
          {"robot.actuators.knee1.limit", 150}}},
    };
    uint64_t seed = 7;
    for (size_t kind = 0; kind < COUNT(kinds); kind++) {
        struct errors e = {0};
        for (int round = 0; round < 4; round++) {
            static struct scenario s;
            static struct design_report r;
            struct plant p = {0};
            char text[4][96];
            const char *sets[4];
            double re[K], im[K], slowest = INFINITY;
            for (int k = 0; k < 4; k++) {
                snprintf(text[k], sizeof text[k], "%s=%.17g", kinds[kind].number[k].path,
                         kinds[kind].number[k].value * uniform(&seed, 0.7, 1.4));
                sets[k] = text[k];
            }
            assert_true(scenario_read(&s, kinds[kind].file, NULL, sets, 4, stderr));
            NULL_SET *set = design_set(&r, &s, kinds[kind].robot);
            assert_int_equal(stance_null_set_modes(set, re, im), kinds[kind].modes);
            for (int i = 0; i < kinds[kind].modes; i++)
                slowest = fmin(slowest, re[i]);
            p.n = r.states, p.m = r.inputs;
            memcpy(p.A, r.A, sizeof(double) * (size_t)(p.n * p.n));
            memcpy(p.B, r.B, sizeof(double) * (size_t)(p.n * p.m));
            double limit[STANCE_MAX_ACTUATORS];
            stance_torque_limits(s.scene, r.model, s.base.torque_limit, s.base.torque_limits,
                                 limit);
            for (int j = 0; j < p.m; j++) {
                p.low[j] = -limit[j] - r.equilibrium.torque[j];
                p.high[j] = limit[j] - r.equilibrium.torque[j];
            }
            project(&p, 0.5 * slowest);
            compare(&seed, &p, set, slowest, 3, &e);
            scenario_free(&s);
        }
        print_message("## %s, %d unstable mode%s, %d points of 4 random robots: support function "
                      "off by %.1e at most; another direction above by %.1e\n",
                      kinds[kind].robot, kinds[kind].modes, kinds[kind].modes > 1 ? "s" : "",
                      e.points, e.worst, e.above);
        assert_true(e.points > 9 && e.worst < 1e-6 && e.above < 1e-6);
    }
}

/* ---- what no torque moves -------------------------------------------------------------------- */

enum { UNSTABLE, SWINGING_UP, RESTING, DRIFTING, SWINGING, DECAYING, SWINGING_DOWN, KINDS };

/* Modes side by side, in modal coordinates: D and B of them; of each coordinate, whether torques
 * reach it and of which kind it is. */
struct modal {
    int n, m;
    double D[K * K], B[K * INPUTS];
    bool reached[K];
    int kind[K];
};

static void add_mode(uint64_t *seed, struct modal *p, int kind, bool reached, double rate)
{
    const double re = kind <= SWINGING_UP ? rate : kind >= DECAYING ? -rate : 0;
    const bool swings = kind == SWINGING_UP || kind == SWINGING || kind == SWINGING_DOWN;
    const double im = swings ? uniform(seed, 0.3, 4) : 0;
    const int i = p->n, size = swings || kind == DRIFTING ? 2 : 1;
    for (int k = i; k < i + size; k++) {
        p->D[k * K + k] = re;
        p->reached[k] = reached;
        p->kind[k] = kind;
        for (int j = 0; j < p->m; j++) /* a sign, so that none is hardly reached */
            p->B[k * INPUTS + j] =
                reached ? uniform(seed, 0.3, 1) * (uniform(seed, -1, 1) < 0 ? -1 : 1) : 0;
    }
    if (swings)
        p->D[i * K + i + 1] = -im, p->D[(i + 1) * K + i] = im;
    if (kind == DRIFTING)
        p->D[i * K + i + 1] = 1;
    p->n += size;
}

/* Some that torques reach, of kinds that are all apart, and some that they do not, now and then
 * with the same eigenvalue, which then drive the others. */
static void random_modes(uint64_t *seed, struct modal *p)
{
    memset(p, 0, sizeof *p);
    p->m = 1 + (int)uniform(seed, 0, 2.999);
    const double rate = uniform(seed, 0.5, 2);
    add_mode(seed, p, UNSTABLE, true, rate);
    if (uniform(seed, 0, 1) < 0.5)
        add_mode(seed, p, (int)uniform(seed, 0, 1.999), true, rate + uniform(seed, 0.5, 2));
    if (uniform(seed, 0, 1) < 0.5)
        add_mode(seed, p, (int)uniform(seed, RESTING, DECAYING - 0.001), true, 0);
    if (uniform(seed, 0, 1) < 0.5)
        add_mode(seed, p, DECAYING, true, uniform(seed, 0.1, 5));
    const int reached = p->n;
    for (int more = 0; more < 3 && p->n + 2 <= K; more++) {
        const int kind = (int)uniform(seed, 0, KINDS - 0.001);
        add_mode(seed, p, kind, false, kind == UNSTABLE && uniform(seed, 0, 1) < 0.5 ? rate : 1.3);
    }
    for (int i = 0; i < reached; i++)
        for (int j = reached; j < p->n; j++)
            if (p->D[i * K + i] == p->D[j * K + j])
                p->D[i * K + j] = uniform(seed, -1, 1);
}

/* The set of all of it, in a random basis, against that of the unstable modes that torques reach
 * alone, wherever what they do not reach and what lasts is 0; and nothing elsewhere. */
TEST(unreached_modes)
{
    uint64_t seed = 11;
    int lasting[KINDS] = {0}, decaying = 0;
    double worst = 0;
    const int rounds = long_tests() ? 150 : 30;
    for (int round = 0; round < rounds; round++) {
        struct modal p;
        double D[K * K], T[K * K], A[K * K], B[K * INPUTS], low[INPUTS], high[INPUTS];
        double L[K * K], G[K * INPUTS], modal_B[K * INPUTS], re[K], im[K];
        int unstable[K], k = 0, wanted = 0;
        random_modes(&seed, &p);
        const int n = p.n, m = p.m;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++)
                D[i * n + j] = p.D[i * K + j];
            for (int j = 0; j < m; j++)
                modal_B[i * m + j] = p.B[i * INPUTS + j];
            const bool lasts = !p.reached[i] && p.kind[i] < DECAYING;
            lasting[p.kind[i]] += lasts;
            decaying += !p.reached[i] && !lasts;
            wanted += lasts;
            if (p.reached[i] && p.kind[i] <= SWINGING_UP)
                unstable[k++] = i;
        }
        for (int i = 0; i < k; i++) {
            for (int j = 0; j < k; j++)
                L[i * k + j] = p.D[unstable[i] * K + unstable[j]];
            for (int j = 0; j < m; j++)
                G[i * m + j] = p.B[unstable[i] * INPUTS + j];
        }
        for (int j = 0; j < m; j++)
            low[j] = -uniform(&seed, 0.2, 2), high[j] = uniform(&seed, 0.2, 2);
        random_basis(&seed, n, D, T, A);
        multiply(n, n, m, T, modal_B, B);
        stance_null_set *const set = made(n, m, A, B, low, high), *const alone =
                                                                      made(k, m, L, G, low, high);
        assert_int_equal(stance_null_set_modes(set, NULL, NULL), k);
        assert_int_equal(stance_null_set_unreached(set, re, im), wanted);
        for (int i = 0; i < wanted; i++)
            assert_true(re[i] >= 0);
        for (int point = 0; point < 4; point++) {
            double modal[K], z[K], x[K], off = 0;
            for (int i = 0; i < n; i++) {
                const bool lasts = !p.reached[i] && p.kind[i] < DECAYING;
                modal[i] =
                    lasts ? point == 3 ? uniform(&seed, -1e-5, 1e-5) : 0 : uniform(&seed, -1, 1);
                off = fmax(off, lasts ? fabs(modal[i]) : 0);
            }
            for (int i = 0; i < k; i++)
                z[i] = modal[unstable[i]];
            multiply(n, n, 1, T, modal, x);
            const double gauge = stance_null_set_gauge(set, x);
            if (off > 1e-7) {
                assert_true(isinf(gauge) && !stance_null_set_holds(set, x));
            } else {
                const double other = stance_null_set_gauge(alone, z);
                worst = fmax(worst, fabs(gauge / other - 1));
                for (int i = 0; i < n; i++)
                    x[i] /= other * 1.001;
                assert_true(stance_null_set_holds(set, x));
            }
        }
        stance_null_set_free(alone);
        stance_null_set_free(set);
    }
    print_message("# gauge against the unstable modes alone: off by %.1e\n", worst);
    for (int kind = 0; kind < DECAYING; kind++)
        assert_true(lasting[kind] > rounds / 10);
    assert_true(decaying > rounds / 10 && worst < 1e-6);
}

/* How little of a torque counts: far less than what moves a robot, more than rounding. With x2 = 0
 * the boundary is where exp(-2 T) = 1/2 (two_modes): x1 = b (sqrt(2) - 1). */
TEST(hardly_reached)
{
    const double A[4] = {1, 0, 0, 2}, low = -1, high = 1, x[2] = {1e-7, 0};
    for (int i = 0; i < 2; i++) {
        const double B[2] = {i ? 1e-14 : 1e-7, 1};
        NULL_SET *set = made(2, 1, A, B, &low, &high);
        assert_int_equal(stance_null_set_unreached(set, NULL, NULL), i);
        if (i)
            assert_true(isinf(stance_null_set_gauge(set, x)));
        else
            assert_near(stance_null_set_gauge(set, x), 1 + sqrt(2), 1e-9, "gauge");
    }
}

/* Robots with a part that no motor moves, from which of three states they come back: with a pole
 * off by half of the angle up to which its motor carries it, m g l theta < 5 N m; with the first
 * body moved as well, a cart so that the centre of mass stays where it was, a wheel so that its own
 * angle does; and the first with a speed. Without anything else to hold it the cart keeps place and
 * momentum of the centre of mass, with damping d the momentum + d times its place. */
TEST(drifting_robots)
{
    static const struct {
        const char *what, *first, *parent;
        int poles, unreached;
        bool back[3];
        double moved, gauge; /* by which part of the pole's angle; NAN: not half of the way */
    } robots[] = {
#define CART "cart: {joint: slide, axis: [1, 0], mass: 1"
        {"pole, cart", CART, "cart", 1, 2, {false, true, false}, 0.25 / 1.5, 0.5},
        {"damped", CART ", damping: 1", "cart", 1, 1, {true, false, false}, 0.25 / 1.5, NAN},
        {"with a spring",
         CART ", damping: 1, stiffness: 4",
         "cart",
         1,
         0,
         {true, true, true},
         0.25 / 1.5,
         NAN},
        {"two poles", CART, "cart", 2, 2, {false, true, false}, 0.25 / 2, NAN},
        {"flywheel",
         "wheel: {joint: hinge, parent: p0, mass: 1, inertia: 0.1",
         "",
         1,
         2,
         {false, true, false},
         -1,
         0.5},
#undef CART
    };
    for (size_t k = 0; k < COUNT(robots); k++) {
        static struct scenario s;
        static struct design_report r;
        const int poles = robots[k].poles;
        const double off = 0.5 * 5 / (0.5 * 9.81 * 0.5);
        char text[1000];
        int used =
            snprintf(text, sizeof text, "stance: 1\nscene: mechanism\nrobot:\n  bodies:\n    %s}\n",
                     robots[k].first);
        for (int i = 0; i < poles; i++)
            used += snprintf(text + used, sizeof text - (size_t)used,
                             "    p%d: {joint: hinge%s%s, mass: 0.5, inertia: 0.02, "
                             "centre: [0, 0.5]}\n",
                             i, robots[k].parent[0] ? ", parent: " : "", robots[k].parent);
        used += snprintf(text + used, sizeof text - (size_t)used, "  actuators:\n");
        for (int i = 0; i < poles; i++)
            used += snprintf(text + used, sizeof text - (size_t)used,
                             "    m%d: {body: p%d, limit: 5}\n", i, i);
        snprintf(text + used, sizeof text - (size_t)used,
                 "initial: {equilibrium: {}}\ncontroller: {kind: none}\nstop: {time: 1}\n");
        assert_true(scenario_read(&s, "robot.yaml", text, NULL, 0, stderr));
        NULL_SET *set = design_set(&r, &s, robots[k].what);
        assert_int_equal(stance_null_set_unreached(set, NULL, NULL), robots[k].unreached);
        assert_int_equal(stance_null_set_modes(set, NULL, NULL), poles);
        for (int at = 0; at < 3; at++) {
            double x[K] = {at == 1 ? robots[k].moved * off : 0, off};
            x[r.states / 2] = at == 2 ? 1e-4 : 0;
            const double gauge = stance_null_set_gauge(set, x);
            if (isfinite(gauge) != robots[k].back[at])
                fail_msg("%s, state %d: gauge %g", robots[k].what, at, gauge);
            if (isfinite(gauge) && !isnan(robots[k].gauge))
                assert_near(gauge, robots[k].gauge, 1e-12, robots[k].what);
        }
        scenario_free(&s);
    }
}

TEST(refusals)
{
    const double A[4] = {1, 0, 0, 2}, B[2] = {0, 1}, low = -1, high = 1, none = -INFINITY, up = 0.1;
    NULL_SET *set;
    stance_message message;
    assert_int_equal(stance_null_set_make(PLANT(2, 1, A, B), &none, &high, &set, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "a torque has no limit");
    assert_int_equal(stance_null_set_make(PLANT(2, 1, A, B), &up, &high, &set, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "the equilibrium takes more torque than there is");
    const double calm[4] = {-1, 0, 0, -2}, x[2] = {1e9, 1e9};
    set = made(2, 1, calm, B, &low, &high);
    assert_true(stance_null_set_holds(set, x) && stance_null_set_gauge(set, x) == 0);
}
