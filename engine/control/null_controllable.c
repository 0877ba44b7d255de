/* null_controllable.c - from which states bounded torques can bring a linear robot back.
 *
 * x' = A x + B u, low <= u <= high. What no torque moves and does not decay of itself must not be
 * there (unreached.h): the set is flat, and all that follows is of the states without it. Modes
 * that decay need no torque, undamped ones no more than is left over, however little; what counts
 * are the unstable ones. With real left eigenvectors W, z = W x moves as z' = L z + G u, L =
 * diag(lambda) or, of a pair a +- ib, the blocks [a -b; b a]. z can be brought to 0 when -z is some
 * integral of exp(-L t) G u (Hu and Lin, Control Systems with Actuator Saturation, Birkhaeuser
 * 2001, ch. 2): the closure of these z is a convex set with the support function
 *
 *   h(eta) = integral over 0 ... infinity of  sum over j of max(s_j low_j, s_j high_j),
 *   s_j(t) = -eta' exp(-L t) g_j = sum over modes of exp(-a t) (p cos b t + q sin b t),
 *
 * and its point that eta touches, the gradient of h, is minus the integral of exp(-L t) G u with u
 * at the bound that s_j asks for. Both are integrals of exponentials between the sign changes of
 * s_j, which are looked for on a grid that resolves the modes still alive, with their derivatives,
 * so that two changes within an interval are seen, too. Of real modes there are no more than
 * between their amplitudes, from the slowest to the fastest (one mode: none; two: one): Descartes'
 * rule of signs, for powers of exp(-t).
 *
 * The gauge of z, 1 on the boundary, is the least sum of mu >= 0 with z = sum of mu_i p_i over
 * points of the set: a linear programme whose columns are the set's points. The simplex method
 * finds it; which column comes in next the support function knows, for the point farthest along the
 * present prices eta is the one that eta touches. Each step bounds the gauge: eta' z / h(eta)
 * below, the sum of mu above.
 */
#include "unreached.h"

#include <lapacke.h>
#include <limits.h>
#include <string.h>

#define MODE_GROWS 1e-9 /* of the largest eigenvalue: a real part that is not zero */
#define LOOK 0.1        /* of 1 / |lambda|: how closely sign changes are looked for */
#define ALIVE 34.0      /* a mode that has fallen by exp(-34) against the slowest counts no more */
#define SWINGS 1e3      /* a mode's |lambda| against its growth, at most */
#define DIRECTIONS 64   /* whose points are the first columns, for two modes ... */
#define DIRECTIONS_ALL 1024 /* and for more */
#define TINY 1e-12          /* a first point, in the set for certain */
#define TOGETHER 1e-12      /* bounds of the gauge that are one */
#define ROUNDS 1000

enum { N = STANCE_PLANT_MOST, MOST = STANCE_NULL_MODES };

struct stance_null_set {
    int n, m, k; /* states, inputs, real coordinates of unstable modes */
    struct unreached unreached;
    double W[MOST * N]; /* [k][n], scaled so that the set touches 1 along each coordinate */
    double G[MOST * N]; /* [k][m] */
    double low[N], high[N];
    double re[MOST], im[MOST]; /* of coordinate i; a pair stands in two places, im > 0 first */
    double size[MOST];         /* of re + i im */
    int order[MOST];           /* the coordinates by re */
    double slowest;            /* least re */
    int directions;            /* of the table: [directions][k], ... */
    double eta[DIRECTIONS_ALL * MOST];   /* ... scaled to h = 1 ... */
    double point[DIRECTIONS_ALL * MOST]; /* ... where they touch the set */
};

/* ---- the support function -------------------------------------------------------------------- */

/* exp(-(a + i b) t) of each mode; of a pair in its first place. */
struct waves {
    double re[MOST], im[MOST];
};

static void waves_at(const stance_null_set *s, double t, struct waves *w)
{
    for (int i = 0; i < s->k; i++) {
        const double decay = exp(-s->re[i] * t);
        w->re[i] = s->im[i] > 0 ? decay * cos(s->im[i] * t) : decay;
        w->im[i] = s->im[i] > 0 ? -decay * sin(s->im[i] * t) : 0;
    }
}

/* Waves after another time. */
static void waves_go_on(const stance_null_set *s, const struct waves *later, struct waves *w)
{
    for (int i = 0; i < s->k; i++) {
        const double re = w->re[i];
        w->re[i] = re * later->re[i] - w->im[i] * later->im[i];
        w->im[i] = re * later->im[i] + w->im[i] * later->re[i];
    }
}

/* s_j and its derivative: amplitudes p and, of a pair in its second place, q. */
static double signal_of(const stance_null_set *s, const double *amplitude, const struct waves *w,
                        double *slope)
{
    double sum = 0;
    *slope = 0;
    for (int i = 0; i < s->k; i++) {
        const double a = s->re[i], b = s->im[i], p = amplitude[i], re = w->re[i], im = w->im[i];
        if (b > 0) {
            const double q = amplitude[++i];
            sum += p * re - q * im;
            *slope += (b * q - a * p) * re + (b * p + a * q) * im;
        } else {
            sum += re * p;
            *slope -= a * re * p;
        }
    }
    return sum;
}

static double signal(const stance_null_set *s, const double *amplitude, double t, double *slope)
{
    struct waves w;
    waves_at(s, t, &w);
    return signal_of(s, amplitude, &w, slope);
}

/* out[k] += factor times the integral of exp(-L t) g_j from `from` to `to`. A pair's block is
 * multiplication by a + ib. */
static void add_integral(const stance_null_set *s, int j, double from, double to, double factor,
                         double *out)
{
    for (int i = 0; i < s->k; i++) {
        const double complex rate = CMPLX(s->re[i], s->im[i]);
        const double complex end = isinf(to) ? 0 : cexp(-rate * to);
        const double complex whole = factor * (cexp(-rate * from) - end) / rate;
        const bool pair = s->im[i] > 0;
        const double complex y =
            whole * CMPLX(s->G[i * s->m + j], pair ? s->G[(i + 1) * s->m + j] : 0);
        out[i] += creal(y);
        if (pair)
            out[++i] += cimag(y);
    }
}

/* Where s_j, or (bend) its derivative, changes its sign between t0 and t1. */
static double change_between(const stance_null_set *s, const double *amplitude, bool bend,
                             double t0, double t1)
{
    double slope;
    double at = signal(s, amplitude, t0, &slope);
    const bool negative = (bend ? slope : at) < 0;
    for (;;) {
        const double middle = t0 + 0.5 * (t1 - t0);
        if (!(middle > t0 && middle < t1))
            return middle;
        at = signal(s, amplitude, middle, &slope);
        if (((bend ? slope : at) < 0) == negative)
            t0 = middle;
        else
            t1 = middle;
    }
}

/* How long a look may reach at t: the fastest mode that is alive is resolved. */
static double reach_at(const stance_null_set *s, double t)
{
    double fastest = 0;
    for (int i = 0; i < s->k; i++)
        if ((s->re[i] - s->slowest) * t <= ALIVE)
            fastest = fmax(fastest, s->size[i]);
    return LOOK / fastest;
}

/* How often s_j can change its sign. */
static int most_changes(const stance_null_set *s, const double *amplitude)
{
    int changes = 0;
    double last = 0;
    for (int k = 0; k < s->k; k++) {
        const int i = s->order[k];
        if (s->im[i] != 0)
            return INT_MAX;
        changes += last * amplitude[i] < 0;
        last = amplitude[i] != 0 ? copysign(1, amplitude[i]) : last;
    }
    return changes;
}

/* Sign changes of s_j between t and t + step, where it and its slope are as given; at most two, in
 * order. */
static int changes_between(const stance_null_set *s, const double *amplitude, double t, double step,
                           const double at[2], const double slope[2], double *change)
{
    double ignored;
    if ((at[0] < 0) != (at[1] < 0)) {
        change[0] = change_between(s, amplitude, false, t, t + step);
        return 1;
    }
    if ((slope[0] < 0) == (slope[1] < 0) || (slope[0] < 0) == (at[0] < 0))
        return 0; /* it does not turn, or away from zero */
    const double turn = change_between(s, amplitude, true, t, t + step);
    if ((signal(s, amplitude, turn, &ignored) < 0) == (at[0] < 0))
        return 0;
    change[0] = change_between(s, amplitude, false, t, turn);
    change[1] = change_between(s, amplitude, false, turn, t + step);
    return 2;
}

/* point[k] += what input j adds to the point that eta touches. */
static void add_input(const stance_null_set *s, int j, const double *eta, double *point)
{
    double amplitude[MOST] = {0}, at[2], slope[2], from = 0;
    for (int i = 0; i < s->k; i++) {
        const double g = s->G[i * s->m + j];
        amplitude[i] = -eta[i] * g;
        if (s->im[i] > 0) {
            const double g2 = s->G[(i + 1) * s->m + j];
            amplitude[i] -= eta[i + 1] * g2;
            amplitude[i + 1] = eta[i + 1] * g - eta[i] * g2;
            i++;
        }
    }
    const double begin = 1e-9 * reach_at(s, 0); /* at 0 itself s_j may be zero */
    int left = most_changes(s, amplitude);
    struct waves w, later = {{0}, {0}};
    waves_at(s, begin, &w);
    at[0] = signal_of(s, amplitude, &w, &slope[0]);
    bool up = !(at[0] < 0);
    for (double t = begin, step = 0; left > 0 && t * s->slowest < ALIVE; t += step) {
        const double reach = reach_at(s, t);
        double change[2];
        if (reach != step)
            waves_at(s, step = reach, &later);
        waves_go_on(s, &later, &w);
        at[1] = signal_of(s, amplitude, &w, &slope[1]);
        const int changes = changes_between(s, amplitude, t, step, at, slope, change);
        left -= changes;
        at[0] = at[1], slope[0] = slope[1];
        for (int c = 0; c < changes; c++) {
            add_integral(s, j, from, change[c], up ? -s->high[j] : -s->low[j], point);
            from = change[c];
            up = !up;
        }
    }
    add_integral(s, j, from, INFINITY, up ? -s->high[j] : -s->low[j], point);
}

double stance_null_set_support(const stance_null_set *s, const double *eta, double *point)
{
    double h = 0;
    for (int i = 0; i < s->k; i++)
        point[i] = 0;
    for (int j = 0; j < s->m; j++)
        add_input(s, j, eta, point);
    for (int i = 0; i < s->k; i++)
        h += eta[i] * point[i];
    return h;
}

/* ---- the set --------------------------------------------------------------------------------- */

/* Left eigenvectors of A[n][n], of states y = rest x or (NULL) x, as rows of W. */
static stance_error find_modes(stance_null_set *s, int n, const double *A, const double *rest,
                               stance_message *message)
{
    double copy[N * N], V[N * N], other[N * N], re[N], im[N], scaling[N], s_of[N], ignored[N];
    double largest = 0, norm;
    lapack_int low, high;
    memcpy(copy, A, (size_t)(n * n) * sizeof *A); /* by columns: the transpose; right ones of it */
    if (n > 0 && LAPACKE_dgeevx(LAPACK_COL_MAJOR, 'B', 'V', 'V', 'E', n, copy, n, re, im, other, n,
                                V, n, &low, &high, scaling, &norm, s_of, ignored) != 0)
        return stance_refuse(message, STANCE_NUMERICAL, "no eigenvectors");
    for (int i = 0; i < n; i++)
        largest = fmax(largest, hypot(re[i], im[i]));
    s->slowest = INFINITY;
    for (int i = 0; i < n; i++) {
        if (!(re[i] > fmax(MODE_GROWS * largest, rounding_of_eigenvalue(norm, s_of[i]))))
            continue;
        if (s->k == MOST)
            return stance_refuse(message, STANCE_BAD_ARGUMENT, "more than %d unstable modes", MOST);
        if (hypot(re[i], im[i]) > SWINGS * re[i])
            return stance_refuse(message, STANCE_NUMERICAL,
                                 "an unstable mode swings too often while it grows");
        /* Of a pair the columns are real and imaginary part, im > 0 first. */
        if (rest)
            matrix_multiply(1, n, s->n, V + i * n, rest, s->W + s->k * s->n);
        else
            memcpy(s->W + s->k * n, V + i * n, (size_t)n * sizeof *V);
        s->re[s->k] = re[i];
        s->im[s->k] = im[i];
        s->size[s->k] = hypot(re[i], im[i]);
        s->slowest = fmin(s->slowest, re[i]);
        int place = s->k++;
        for (; place > 0 && s->re[s->order[place - 1]] > re[i]; place--)
            s->order[place] = s->order[place - 1];
        s->order[place] = s->k - 1;
    }
    return STANCE_OK;
}

/* Rows of W and G so that the set reaches 1 along each coordinate, of a pair along the farther. */
static stance_error scale(stance_null_set *s, stance_message *message)
{
    double reach[MOST] = {0}, eta[MOST], point[MOST] = {0};
    for (int i = 0; i < s->k; i++) {
        reach[i] = 0;
        for (int sign = -1; sign <= 1; sign += 2) {
            memset(eta, 0, sizeof eta);
            eta[i] = sign;
            reach[i] = fmax(reach[i], stance_null_set_support(s, eta, point));
        }
        if (s->im[i] < 0)
            reach[i] = reach[i - 1] = fmax(reach[i], reach[i - 1]);
    }
    for (int i = 0; i < s->k; i++) {
        if (!(reach[i] > 0) || !isfinite(reach[i]))
            return stance_refuse(message, STANCE_UNCONTROLLABLE,
                                 "no torque reaches the unstable mode %.6g 1/s", s->re[i]);
        for (int j = 0; j < s->n; j++)
            s->W[i * s->n + j] /= reach[i];
        for (int j = 0; j < s->m; j++)
            s->G[i * s->m + j] /= reach[i];
    }
    return STANCE_OK;
}

/* Direction d of the table, of any length: two, a circle, or normal numbers from Halton's points.
 */
static void direction_of(const stance_null_set *s, int d, double *eta)
{
    static const int prime[MOST] = {2, 3, 5, 7, 11, 13, 17, 19};
    if (s->k == 1) {
        eta[0] = d ? -1 : 1;
    } else if (s->k == 2) {
        const double angle = 2 * M_PI * d / s->directions;
        eta[0] = cos(angle), eta[1] = sin(angle);
    } else {
        for (int i = 0; i < s->k; i++) {
            double u = 0, part = 1;
            for (int at = d + 1; at > 0; at /= prime[i]) {
                part /= prime[i];
                u += part * (at % prime[i]);
            }
            eta[i] = log(u / (1 - u)); /* as good as normal for a direction */
        }
    }
}

/* Directions that are spread evenly once the set is about round: eta becomes R eta with R R' the
 * inverse of the points' second moments. */
static bool spread_out(stance_null_set *s)
{
    const int k = s->k;
    double P[MOST * MOST] = {0};
    for (int d = 0; d < s->directions; d++)
        for (int i = 0; i < k; i++)
            for (int j = 0; j <= i; j++)
                P[i * k + j] += s->point[d * k + i] * s->point[d * k + j] / s->directions;
    if (LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', k, P, k) != 0)
        return false;
    for (int d = 0; d < s->directions; d++) { /* L' eta = direction */
        double *const eta = s->eta + d * k;
        direction_of(s, d, eta);
        for (int i = k - 1; i >= 0; i--) {
            for (int j = i + 1; j < k; j++)
                eta[i] -= P[j * k + i] * eta[j];
            eta[i] /= P[i * k + i];
        }
    }
    return true;
}

/* Which directions touch the set where; false: somewhere it has no size. */
static bool make_table(stance_null_set *s)
{
    s->directions = s->k == 1 ? 2 : s->k == 2 ? DIRECTIONS : DIRECTIONS_ALL;
    for (int d = 0; d < s->directions; d++) {
        direction_of(s, d, s->eta + d * s->k);
        stance_null_set_support(s, s->eta + d * s->k, s->point + d * s->k);
    }
    if (!spread_out(s))
        return false;
    for (int d = 0; d < s->directions; d++) {
        double *const eta = s->eta + d * s->k;
        const double h = stance_null_set_support(s, eta, s->point + d * s->k);
        if (!(h > 0))
            return false;
        for (int i = 0; i < s->k; i++)
            eta[i] /= h;
    }
    return true;
}

static stance_error make(stance_null_set *s, const stance_plant *plant, stance_message *message)
{
    const struct unreached *const unreached = &s->unreached;
    stance_error error = stance_unreached_find(plant, &s->unreached);
    if (error != STANCE_OK)
        return stance_refuse(message, error, "what no torque moves: %s", stance_error_text(error));
    error = unreached->count > 0
                ? find_modes(s, s->n - unreached->count, unreached->A, unreached->rest, message)
                : find_modes(s, s->n, plant->A, NULL, message);
    if (error != STANCE_OK || s->k == 0)
        return error;
    matrix_multiply(s->k, s->n, s->m, s->W, plant->B, s->G);
    error = scale(s, message);
    if (error != STANCE_OK || make_table(s))
        return error;
    return stance_refuse(message, STANCE_UNCONTROLLABLE,
                         "the torques do not reach all unstable modes");
}

stance_error stance_null_set_make(const stance_plant *plant, const double *low, const double *high,
                                  stance_null_set **set, stance_message *message)
{
    *set = NULL;
    stance_error error = stance_check_plant(plant, message);
    for (int j = 0; error == STANCE_OK && j < plant->inputs; j++)
        if (isinf(low[j]) || isinf(high[j]))
            error = stance_refuse(message, STANCE_BAD_ARGUMENT, "a torque has no limit");
        else if (!(low[j] < 0 && high[j] > 0))
            error = stance_refuse(message, STANCE_BAD_ARGUMENT,
                                  "the equilibrium takes more torque than there is");
    if (error != STANCE_OK)
        return error;
    stance_null_set *const s = calloc(1, sizeof *s);
    if (!s)
        return stance_refuse(message, STANCE_NO_MEMORY, "no memory");
    s->n = plant->states, s->m = plant->inputs;
    memcpy(s->low, low, (size_t)s->m * sizeof *low);
    memcpy(s->high, high, (size_t)s->m * sizeof *high);
    error = make(s, plant, message);
    if (error == STANCE_OK)
        *set = s;
    else
        free(s);
    return error;
}

void stance_null_set_free(stance_null_set *s)
{
    free(s);
}

int stance_null_set_modes(const stance_null_set *s, double *re, double *im)
{
    for (int i = 0; i < s->k && re; i++)
        re[i] = s->re[i], im[i] = s->im[i];
    return s->k;
}

int stance_null_set_unreached(const stance_null_set *s, double *re, double *im)
{
    const struct unreached *const unreached = &s->unreached;
    for (int i = 0; i < unreached->count && re; i++)
        re[i] = unreached->re[i], im[i] = unreached->im[i];
    return unreached->count;
}

/* ---- the gauge ------------------------------------------------------------------------------- */

/* z as a sum of k points of the set, mu >= 0 of each: its gauge is at most the sum of mu. */
struct hull {
    double z[MOST], point[MOST][MOST], mu[MOST];
};

/* x of M x = b (by_points: M' x = b), M the points as rows; false: they depend on each other. */
static bool hull_solve(const struct hull *hull, int k, bool by_points, const double *b, double *x)
{
    double M[MOST][MOST + 1] = {{0}};
    for (int i = 0; i < k; i++) {
        for (int j = 0; j < k; j++)
            M[i][j] = by_points ? hull->point[j][i] : hull->point[i][j];
        M[i][k] = b[i];
    }
    for (int c = 0; c < k; c++) {
        int row = c;
        for (int i = c + 1; i < k; i++)
            row = fabs(M[i][c]) > fabs(M[row][c]) ? i : row;
        if (M[row][c] == 0)
            return false;
        for (int j = c; j <= k; j++) {
            const double swap = M[c][j];
            M[c][j] = M[row][j], M[row][j] = swap;
        }
        for (int i = c + 1; i < k; i++)
            for (int j = k; j >= c; j--)
                M[i][j] -= M[i][c] / M[c][c] * M[c][j];
    }
    for (int i = k - 1; i >= 0; i--) {
        x[i] = M[i][k];
        for (int j = i + 1; j < k; j++)
            x[i] -= M[i][j] * x[j];
        x[i] /= M[i][i];
    }
    return true;
}

static double hull_sum(const struct hull *hull, int k)
{
    double sum = 0;
    for (int i = 0; i < k; i++)
        sum += hull->mu[i];
    return sum;
}

/* The direction in which all points of the hull reach 1. */
static bool hull_normal(const struct hull *hull, int k, double *eta)
{
    static const double one[MOST] = {1, 1, 1, 1, 1, 1, 1, 1};
    return hull_solve(hull, k, false, one, eta);
}

/* Takes a point in for the one that leaves first. */
static bool hull_take(struct hull *hull, int k, const double *point)
{
    double share[MOST];
    int leaves = -1;
    if (!hull_solve(hull, k, true, point, share))
        return false;
    for (int i = 0; i < k; i++)
        if (share[i] > 0 &&
            (leaves < 0 || hull->mu[i] * share[leaves] < hull->mu[leaves] * share[i]))
            leaves = i;
    if (leaves < 0)
        return false;
    memcpy(hull->point[leaves], point, sizeof(double) * (size_t)k);
    if (!hull_solve(hull, k, true, hull->z, hull->mu))
        return false;
    for (int i = 0; i < k; i++)
        hull->mu[i] = fmax(0, hull->mu[i]);
    return true;
}

/* The table's point farthest along eta, if it is beyond 1 by more than rounding. */
static const double *table_farthest(const stance_null_set *s, const double *eta)
{
    const double *farthest = NULL;
    double most = 1 + 1e-9;
    for (int d = 0; d < s->directions; d++) {
        const double along = matrix_dot(s->k, eta, s->point + d * s->k);
        if (along > most)
            most = along, farthest = s->point + d * s->k;
    }
    return farthest;
}

/* Bounds of the gauge of x, until they are together or (decide) on one side of 1. */
static void gauge_bounds(const stance_null_set *s, const double *x, bool decide, double bound[2])
{
    const int k = s->k;
    struct hull hull;
    double eta[MOST] = {0}, point[MOST] = {0};
    bound[0] = bound[1] = 0;
    memset(&hull, 0, sizeof hull);
    for (int i = 0; i < k; i++) {
        hull.z[i] = matrix_dot(s->n, s->W + i * s->n, x);
        hull.point[i][i] = hull.z[i] < 0 ? -TINY : TINY;
        hull.mu[i] = fabs(hull.z[i]) / TINY;
    }
    if (hull_sum(&hull, k) == 0)
        return;
    const double *next;
    for (int round = 0; round < ROUNDS && hull_normal(&hull, k, eta) &&
                        (next = table_farthest(s, eta)) && hull_take(&hull, k, next);
         round++)
        ;
    for (int d = 0; d < s->directions; d++)
        bound[0] = fmax(bound[0], matrix_dot(k, s->eta + d * k, hull.z));
    bound[1] = hull_sum(&hull, k);
    if (decide && (bound[0] >= 1 || bound[1] < 1))
        return;
    for (int round = 0; round < ROUNDS && hull_normal(&hull, k, eta); round++) {
        const double h = stance_null_set_support(s, eta, point);
        bound[0] = fmax(bound[0], matrix_dot(k, eta, hull.z) / h);
        bound[1] = fmin(bound[1], hull_sum(&hull, k));
        if (bound[1] - bound[0] <= TOGETHER * bound[1] ||
            (decide && (bound[0] >= 1 || bound[1] < 1)) || !hull_take(&hull, k, point))
            return;
    }
}

double stance_null_set_gauge(const stance_null_set *s, const double *x)
{
    double bound[2] = {0, INFINITY};
    if (!stance_unreached_has(&s->unreached, x))
        gauge_bounds(s, x, false, bound);
    return bound[1];
}

bool stance_null_set_holds(const stance_null_set *s, const double *x)
{
    double bound[2] = {0, INFINITY};
    if (!stance_unreached_has(&s->unreached, x))
        gauge_bounds(s, x, true, bound);
    return bound[1] < 1;
}
