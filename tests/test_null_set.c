/* The null-controllable set: its support function against quadrature, its gauge against closed
 * forms, against all directions, and against torques that steer a point just inside home. */
#include "linear.h"

#include "engine/control/design.h"

enum { K = STANCE_NULL_MODES };

/* x' = A x + B u with the given eigenvalues (of pairs one) in a random basis, and random B. */
static void random_plant(uint64_t *seed, int n, int m, const double *re, const double *im,
                         double *A, double *B)
{
    double D[K * K] = {0}, T[K * K], inverse[K * K], product[K * K];
    for (int i = 0; i < n; i++) {
        D[i * n + i] = re[i];
        if (im[i] > 0) {
            D[i * n + i + 1] = -im[i], D[(i + 1) * n + i] = im[i], D[(i + 1) * n + i + 1] = re[i];
            i++;
        }
    }
    for (int i = 0; i < n * n; i++)
        T[i] = uniform(seed, -1, 1) + (i % (n + 1) == 0 ? 2 : 0);
    double work[K * 2 * K];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < 2 * n; j++)
            work[i * 2 * n + j] = j < n ? T[i * n + j] : (j - n == i);
    for (int c = 0; c < n; c++) { /* Gauss and Jordan, with pivots */
        int row = c;
        for (int i = c; i < n; i++)
            row = fabs(work[i * 2 * n + c]) > fabs(work[row * 2 * n + c]) ? i : row;
        for (int j = 0; j < 2 * n; j++) {
            const double swap = work[c * 2 * n + j];
            work[c * 2 * n + j] = work[row * 2 * n + j], work[row * 2 * n + j] = swap;
        }
        const double pivot = work[c * 2 * n + c];
        for (int j = 0; j < 2 * n; j++)
            work[c * 2 * n + j] /= pivot;
        for (int i = 0; i < n; i++) {
            const double factor = work[i * 2 * n + c];
            for (int j = 0; j < 2 * n && i != c; j++)
                work[i * 2 * n + j] -= factor * work[c * 2 * n + j];
        }
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            inverse[i * n + j] = work[i * 2 * n + n + j];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            product[i * n + j] = 0;
            for (int k = 0; k < n; k++)
                product[i * n + j] += T[i * n + k] * D[k * n + j];
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            A[i * n + j] = 0;
            for (int k = 0; k < n; k++)
                A[i * n + j] += product[i * n + k] * inverse[k * n + j];
        }
    for (int i = 0; i < n * m; i++)
        B[i] = uniform(seed, -1, 1);
}

static stance_null_set *made(int n, int m, const double *A, const double *B, const double *low,
                             const double *high)
{
    stance_null_set *set;
    stance_message message = {""};
    if (stance_null_set_make(n, m, A, B, low, high, &set, &message) != STANCE_OK)
        fail_msg("%s", message.text);
    return set;
}

/* x' = a x + b u: |x| < b u / a, by sides. */
static void one_mode(void **state)
{
    (void)state;
    const double a = 2, b = 3, low = -1, high = 5;
    stance_null_set *const set = made(1, 1, &a, &b, &low, &high);
    double re[K], im[K];
    assert_int_equal(stance_null_set_modes(set, re, im), 1);
    assert_near(re[0], 2, 1e-14, "mode");
    for (double x = -8; x < 8; x += 0.37) {
        const double wanted = x > 0 ? x / 1.5 : -x / 7.5; /* positive x takes negative torque */
        assert_near(stance_null_set_gauge(set, &x), wanted, 1e-13, "gauge");
        assert_true(stance_null_set_holds(set, &x) == (wanted < 1));
    }
    stance_null_set_free(set);
}

/* diag(l1, l2), one symmetric torque |u| <= 1, b = (1, 1): the boundary is traced by u switching
 * once at time T: z = -(1/l) (1 - 2 exp(-l T)) of each mode (Hu and Lin, section 2.4). */
static void two_modes(void **state)
{
    (void)state;
    const double A[4] = {3, 0, 0, 1.2}, B[2] = {1, 1}, low = -1, high = 1;
    stance_null_set *const set = made(2, 1, A, B, &low, &high);
    for (double T = 0; T < 6; T += 0.01) {
        double z[2];
        for (int i = 0; i < 2; i++)
            z[i] = -(1 - 2 * exp(-A[3 * i] * T)) / A[3 * i];
        assert_near(stance_null_set_gauge(set, z), 1, 1e-12, "boundary");
        z[0] *= -0.5, z[1] *= -0.5;
        assert_near(stance_null_set_gauge(set, z), 0.5, 1e-12, "inside");
    }
    stance_null_set_free(set);
}

struct plant {
    int n, m, k;
    double A[K * K], B[K * 3], low[3], high[3];
};

/* exp(-A t) by Taylor and squaring, times B. */
static void flow(const struct plant *p, double t, double *out)
{
    const int n = p->n, parts = 1 << 10;
    double E[K * K], next[K * K];
    for (int i = 0; i < n * n; i++)
        E[i] = i % (n + 1) == 0;
    double power[K * K];
    memcpy(power, E, sizeof power);
    double fact = 1;
    for (int order = 1; order < 14; order++) {
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                next[i * n + j] = 0;
                for (int k = 0; k < n; k++)
                    next[i * n + j] -= power[i * n + k] * p->A[k * n + j] * (t / parts);
            }
        memcpy(power, next, sizeof power);
        fact *= order;
        for (int i = 0; i < n * n; i++)
            E[i] += power[i] / fact;
    }
    for (int s = 1; s < parts; s *= 2) {
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                next[i * n + j] = 0;
                for (int k = 0; k < n; k++)
                    next[i * n + j] += E[i * n + k] * E[k * n + j];
            }
        memcpy(E, next, sizeof E);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < p->m; j++) {
            out[i * p->m + j] = 0;
            for (int k = 0; k < n; k++)
                out[i * p->m + j] += E[i * n + k] * p->B[k * p->m + j];
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
    for (int i = 0; i < n; i++) {
        next[i] = 0;
        for (int k = 0; k < n; k++)
            next[i] += row[k] * E[k * n + i];
    }
    memcpy(row, next, sizeof(double) * (size_t)n);
}

static double quadrature(const struct plant *p, const double *eta, double slowest)
{
    enum { PARTS = 20000 };
    const double h = 36 / slowest / PARTS;
    double row[K], E[K * K], s[3][3], sum = 0;
    for (int c = 0; c < p->n; c++) { /* columns of exp(-A h / 2) */
        struct plant one = *p;
        double column[K];
        one.m = 1;
        for (int i = 0; i < p->n; i++)
            one.B[i] = i == c;
        flow(&one, h / 2, column);
        for (int i = 0; i < p->n; i++)
            E[i * p->n + c] = column[i];
    }
    memcpy(row, eta, sizeof(double) * (size_t)p->n);
    for (int t = 0; t < PARTS; t++) {
        for (int part = 0; part < 3; part++) {
            for (int j = 0; j < p->m; j++) {
                s[j][part] = 0;
                for (int i = 0; i < p->n; i++)
                    s[j][part] -= row[i] * p->B[i * p->m + j];
            }
            if (part < 2)
                march(p->n, E, row);
        }
        for (int j = 0; j < p->m; j++)
            sum += part_of(p, j, s[j], h);
    }
    return sum;
}

/* Of 1 to 5 modes, pairs among them: along x, the largest eta' x / h(eta) over directions near the
 * one that the set itself gives is its gauge, h by quadrature. */
static void support_is_the_integral(void **state)
{
    (void)state;
    uint64_t seed = 3;
    double worst = 0, above = 0;
    int points = 0;
    for (int round = 0; round < 10; round++) {
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
        for (int j = 0; j < p.m; j++)
            p.low[j] = -uniform(&seed, 0.2, 2), p.high[j] = uniform(&seed, 0.2, 2);
        stance_null_set *const set = made(p.n, p.m, p.A, p.B, p.low, p.high);
        assert_int_equal(stance_null_set_modes(set, NULL, NULL), p.n);
        for (int k = 0; k < 5; k++) {
            double x[K], best = 0;
            for (int i = 0; i < p.n; i++)
                x[i] = uniform(&seed, -1, 1);
            const double gauge = stance_null_set_gauge(set, x);
            if (gauge > 1e3) /* a torque hardly reaches some mode: no differences, then */
                continue;
            points++;
            /* The normal at the boundary point x / gauge, by differences of the gauge. */
            double eta[K];
            for (int i = 0; i < p.n; i++) {
                double high[K], low[K];
                memcpy(high, x, sizeof x), memcpy(low, x, sizeof x);
                high[i] += 1e-5, low[i] -= 1e-5;
                eta[i] =
                    (stance_null_set_gauge(set, high) - stance_null_set_gauge(set, low)) / 2e-5;
            }
            double along = 0;
            for (int i = 0; i < p.n; i++)
                along += eta[i] * x[i];
            best = along / quadrature(&p, eta, slowest);
            worst = fmax(worst, fabs(best / gauge - 1));
            /* No direction gives more. */
            for (int d = 0; d < 2; d++) {
                double other[K];
                along = 0;
                for (int i = 0; i < p.n; i++)
                    along += (other[i] = eta[i] * (1 + uniform(&seed, -0.3, 0.3))) * x[i];
                above = fmax(above, along / quadrature(&p, other, slowest) / gauge - 1);
            }
            for (int i = 0; i < p.n; i++)
                x[i] /= gauge * 1.000001;
            assert_true(stance_null_set_holds(set, x));
            for (int i = 0; i < p.n; i++)
                x[i] *= 1.000002;
            assert_false(stance_null_set_holds(set, x));
        }
        stance_null_set_free(set);
    }
    print_message("# %d points: gauge by quadrature off by %.1e; another direction above by %.1e\n",
                  points, worst, above);
    assert_true(points > 35 && worst < 1e-6 && above < 1e-6);
}

static void refusals(void **state)
{
    (void)state;
    const double A[4] = {1, 0, 0, 2}, B[2] = {0, 1}, low = -1, high = 1, none = -INFINITY, up = 0.1;
    stance_null_set *set;
    stance_message message;
    assert_int_equal(stance_null_set_make(2, 1, A, B, &low, &high, &set, &message),
                     STANCE_UNCONTROLLABLE);
    assert_text(message.text, "no torque reaches the unstable mode 1 1/s");
    assert_int_equal(stance_null_set_make(2, 1, A, B, &none, &high, &set, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "a torque has no limit");
    assert_int_equal(stance_null_set_make(2, 1, A, B, &up, &high, &set, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "the equilibrium takes more torque than there is");
    const double calm[4] = {-1, 0, 0, -2}, x[2] = {1e9, 1e9};
    set = made(2, 1, calm, B, &low, &high);
    assert_true(stance_null_set_holds(set, x) && stance_null_set_gauge(set, x) == 0);
    stance_null_set_free(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_mode),
        cmocka_unit_test(two_modes),
        cmocka_unit_test(support_is_the_integral),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
