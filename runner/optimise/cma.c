/* cma.c - evolution strategy with covariance matrix adaptation, see cma.h. */
#include "cma.h"

#include <Random123/philox.h>
#include <float.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double small_step = 1e-3, most_condition = 1e14, most_growth = 1e4;
/* Beyond these no state of use is: what keeps all numbers finite. */
static const double farthest = 1e100, least_step = 1e-150, most_step = 1e150;

const char *const cma_stop_words[CMA_STOPS] = {"", "step is small", "C is ill-conditioned",
                                               "step diverges"};

struct ranked {
    int64_t score;
    int candidate;
};

/* ---- ranges ------------------------------------------------------------------------------------
 */

/* Whether u and x are the same there. */
static bool plain(const struct bounds *b, double u)
{
    return b->low + b->margin <= u && u <= b->high - b->margin;
}

/* Of u from the nearest vertex of the lower bound, or of the upper one where it is the only one;
 * then there is one vertex: remainder by infinity changes nothing. */
static double from_vertex(const struct bounds *b, double u)
{
    const double vertex = isinf(b->low) ? b->high + b->margin : b->low - b->margin;
    return remainder(u - vertex, 2 * (b->high - b->low + 2 * b->margin));
}

double bounds_image(const struct bounds *b, double u)
{
    if (plain(b, u))
        return u;
    const double d = fabs(from_vertex(b, u)), span = b->high - b->low, a = b->margin;
    const double rest = span + 2 * a - d; /* to the other bound's vertex */
    if (rest < 2 * a)
        return b->high - fmin(rest * rest / (4 * a), span);
    const double inward = d < 2 * a ? d * d / (4 * a) : d - a;
    return isinf(b->low) ? b->high - inward : b->low + fmin(inward, span);
}

double bounds_preimage(const struct bounds *b, double x, double beside)
{
    if (bounds_image(b, beside) == x)
        return beside;
    if (plain(b, x) && plain(b, beside))
        return x;
    const double r = from_vertex(b, beside), span = b->high - b->low, a = b->margin;
    const double inward = isinf(b->low) ? b->high - x : x - b->low;
    double d = inward < a ? 2 * sqrt(a * inward) : inward + a;
    if (b->high - x < a && !isinf(b->low))
        d = span + 2 * a - 2 * sqrt(a * (b->high - x));
    return beside - r + copysign(d, r);
}

/* ---- eigenvectors -----------------------------------------------------------------------------
 */

/* Convergence is quadratic: about ten are needed for n = 64. */
enum { MOST_SWEEPS = 60 };

/* The rotation of rows and columns p < q after which a[p][q] is 0. */
static void rotate(int n, double *a, double *vector, int p, int q)
{
    double *const row_p = a + p * n, *const row_q = a + q * n;
    const double off = row_p[q], app = row_p[p], aqq = row_q[q];
    const double theta = (aqq - app) / (2 * off);
    const double t = copysign(1 / (fabs(theta) + sqrt(theta * theta + 1)), theta);
    const double c = 1 / sqrt(t * t + 1), s = t * c;

    for (int k = 0; k < n; k++) {
        const double g = row_p[k], h = row_q[k], v = vector[p * n + k], w = vector[q * n + k];
        a[k * n + p] = row_p[k] = c * g - s * h;
        a[k * n + q] = row_q[k] = s * g + c * h;
        vector[p * n + k] = c * v - s * w;
        vector[q * n + k] = s * v + c * w;
    }
    row_p[p] = app - t * off;
    row_q[q] = aqq + t * off;
    row_p[q] = row_q[p] = 0;
}

/* Whether anything was left to rotate. */
static bool sweep(int n, double *a, double *vector)
{
    bool rotated = false;
    for (int p = 0; p < n; p++) {
        for (int q = p + 1; q < n; q++) {
            const double beside = sqrt(fabs(a[p * n + p])) * sqrt(fabs(a[q * n + q]));
            if (fabs(a[p * n + q]) > DBL_EPSILON / 2 * beside) {
                rotate(n, a, vector, p, q);
                rotated = true;
            }
        }
    }
    return rotated;
}

static void sort(int n, double *value, double *vector)
{
    for (int k = 0; k < n; k++) {
        int least = k;
        for (int i = k + 1; i < n; i++)
            least = value[i] < value[least] ? i : least;
        const double swapped = value[k];
        value[k] = value[least];
        value[least] = swapped;
        for (int j = 0; j < n; j++) {
            const double element = vector[k * n + j];
            vector[k * n + j] = vector[least * n + j];
            vector[least * n + j] = element;
        }
    }
}

void symmetric_eigen(int n, double *a, double *value, double *vector)
{
    memset(vector, 0, (size_t)n * n * sizeof *vector);
    for (int k = 0; k < n; k++)
        vector[k * n + k] = 1;
    for (int i = 0; i < MOST_SWEEPS && sweep(n, a, vector); i++) {
    }
    for (int k = 0; k < n; k++)
        value[k] = a[k * n + k];
    sort(n, value, vector);
}

/* ---- the state ------------------------------------------------------------------------------- */

int cma_default_lambda(int n)
{
    return 4 + (int)(3 * log(n));
}

static double square(double x)
{
    return x * x;
}

/* The parameters of Table 1; the weights are of candidates by rank. */
static void parameters(struct cma *s)
{
    const double n = s->n;
    double sum[2] = {0}, squares[2] = {0}; /* of the better half, of the worse */
    s->better = s->lambda / 2;
    for (int i = 0; i < s->lambda; i++) {
        s->weight[i] = log((s->lambda + 1) / 2.0) - log(i + 1);
        sum[i >= s->better] += fabs(s->weight[i]);
        squares[i >= s->better] += square(s->weight[i]);
    }
    const double mu = square(sum[0]) / squares[0], worse = square(sum[1]) / squares[1];
    s->mu = mu;
    s->c_step = (mu + 2) / (n + mu + 5);
    s->damping = 1 + 2 * fmax(0, sqrt((mu - 1) / (n + 1)) - 1) + s->c_step;
    s->c_path = (4 + mu / n) / (n + 4 + 2 * mu / n);
    s->c_one = 2 / (square(n + 1.3) + mu);
    s->c_mu = fmin(1 - s->c_one, 2 * (0.25 + mu + 1 / mu - 2) / (square(n + 2) + mu));
    s->chi = sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));

    const double negative = fmin(fmin(1 + s->c_one / s->c_mu, 1 + 2 * worse / (mu + 2)),
                                 (1 - s->c_one - s->c_mu) / (n * s->c_mu));
    s->weights = 0;
    for (int i = 0; i < s->lambda; i++) {
        s->weight[i] *= i < s->better ? 1 / sum[0] : negative / sum[1];
        s->weights += s->weight[i];
    }
}

/* No standard deviation above a third of the range of its coordinate: beyond, candidates are all
 * over the range whatever the step is, and nothing brings it back. */
static void confine(struct cma *s)
{
    const int n = s->n;
    for (int j = 0; j < n; j++) {
        const double most = (s->bounds[j].high - s->bounds[j].low) / 3;
        const double share = most / (s->step * sqrt(s->covariance[j * n + j]));
        for (int k = 0; share < 1 && k < n; k++) {
            s->covariance[j * n + k] *= share;
            s->covariance[k * n + j] *= share;
        }
    }
}

/* Axes and roots of C. */
static void decompose(struct cma *s)
{
    const int n = s->n;
    memcpy(s->work, s->covariance, (size_t)n * n * sizeof *s->work);
    symmetric_eigen(n, s->work, s->axis, s->vector);
    /* Rounding may leave what is 0 or less, long after CMA_CONDITION was said. */
    const double least = fmax(DBL_EPSILON * DBL_EPSILON * s->axis[n - 1], DBL_MIN);
    for (int k = 0; k < n; k++)
        s->axis[k] = sqrt(fmax(s->axis[k], least));
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double root = 0, back = 0;
            for (int k = 0; k < n; k++) {
                const double product = s->vector[k * n + i] * s->vector[k * n + j];
                root += product * s->axis[k];
                back += product / s->axis[k];
            }
            s->root[i * n + j] = s->root[j * n + i] = root;
            s->back[i * n + j] = s->back[j * n + i] = back;
        }
    }
}

static bool sensible(const struct cma_start *s)
{
    bool good = s->n >= 1 && s->n <= CMA_MAX_COORDINATES && s->lambda != 1 && s->lambda >= 0 &&
                s->lambda <= CMA_MAX_CANDIDATES && s->step >= least_step && s->step <= most_step;
    for (int j = 0; good && j < s->n; j++) {
        const double low = s->low[j], high = s->high[j];
        good = fabs(s->mean[j]) <= farthest && low <= s->mean[j] && s->mean[j] <= high &&
               high - low >= 1 / farthest && (isinf(low) || low >= -farthest) &&
               (isinf(high) || high <= farthest);
    }
    return good;
}

struct cma *cma_make(const struct cma_start *start)
{
    if (!sensible(start))
        return NULL;
    const int lambda = start->lambda > 0 ? start->lambda : cma_default_lambda(start->n);
    const size_t of_n = (size_t)start->n, of_lambda = (size_t)lambda, matrix = of_n * of_n;
    const size_t numbers = of_lambda + 5 * of_n + 5 * matrix + of_lambda * of_n;
    struct cma *s = calloc(1, sizeof *s + numbers * sizeof *s->memory);
    if (s) {
        s->rank = calloc(of_lambda, sizeof *s->rank);
        s->bounds = calloc(of_n, sizeof *s->bounds);
    }
    if (!s || !s->rank || !s->bounds) {
        cma_free(s);
        return NULL;
    }
    double *next = s->memory;
    double **const vectors[] = {&s->centre, &s->mean, &s->path, &s->path_step, &s->axis};
    double **const matrices[] = {&s->covariance, &s->root, &s->back, &s->vector, &s->work};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++, next += of_n)
        *vectors[i] = next;
    for (size_t i = 0; i < sizeof matrices / sizeof *matrices; i++, next += matrix)
        *matrices[i] = next;
    s->weight = next;
    s->y = next + of_lambda;
    s->n = start->n;
    s->lambda = lambda;
    s->seed = start->seed;
    s->restart = start->restart;
    s->first_step = s->step = start->step;
    memcpy(s->mean, start->mean, of_n * sizeof *s->mean);
    for (int j = 0; j < s->n; j++) {
        const double low = start->low[j], high = start->high[j];
        s->bounds[j] = (struct bounds){low, high, fmin(s->step, (high - low) / 4)};
        s->centre[j] = bounds_preimage(&s->bounds[j], s->mean[j], s->mean[j]);
        s->covariance[j * s->n + j] = 1;
    }
    confine(s);
    parameters(s);
    decompose(s);
    return s;
}

void cma_free(struct cma *s)
{
    if (s) {
        free(s->rank);
        free(s->bounds);
    }
    free(s);
}

/* ---- asking ---------------------------------------------------------------------------------- */

/* y = matrix x. */
static void multiply(int n, const double *matrix, const double *x, double *y)
{
    for (int i = 0; i < n; i++) {
        y[i] = 0;
        for (int k = 0; k < n; k++)
            y[i] += matrix[i * n + k] * x[k];
    }
}

/* Candidate i, in coordinates without bounds. Deviates are the odd multiples of 2^-53 through the
 * inverse of the normal distribution. */
static void draw(const struct cma *s, int i, double *u)
{
    double z[CMA_MAX_COORDINATES] = {0};
    const philox4x64_key_t key = {{s->seed, 0x636d61}};
    philox4x64_ctr_t random = {{0}};
    for (int j = 0; j < s->n; j++) {
        const philox4x64_ctr_t counter = {
            {s->restart, s->generation, (uint64_t)i, (uint64_t)j / 4}};
        if (j % 4 == 0)
            random = philox4x64(counter, key);
        z[j] = gsl_cdf_ugaussian_Pinv((double)(random.v[j % 4] >> 11 | 1) * 0x1p-53);
    }
    multiply(s->n, s->root, z, u);
    for (int j = 0; j < s->n; j++)
        u[j] = s->centre[j] + s->step * u[j];
}

void cma_ask(const struct cma *s, double *x)
{
    for (int i = 0; i < s->lambda; i++, x += s->n) {
        draw(s, i, x);
        for (int j = 0; j < s->n; j++)
            x[j] = bounds_image(&s->bounds[j], x[j]);
    }
}

/* ---- telling --------------------------------------------------------------------------------- */

static int better_first(const void *a, const void *b)
{
    const struct ranked *const p = a, *const q = b;
    if (p->score != q->score)
        return p->score > q->score ? -1 : 1;
    return p->candidate < q->candidate ? -1 : 1;
}

/* C += weight y y'. */
static void add(struct cma *s, double weight, const double *y)
{
    for (int i = 0; i < s->n; i++)
        for (int j = 0; j < s->n; j++)
            s->covariance[i * s->n + j] += weight * (y[i] * y[j]);
}

/* Both paths after the mean's step y; whether h is 1. */
static bool follow(struct cma *s, const double *y)
{
    const int n = s->n;
    const double c = s->c_step, of_step = sqrt(c * (2 - c) * s->mu);
    const double of_path = sqrt(s->c_path * (2 - s->c_path) * s->mu);
    double length = 0, z[CMA_MAX_COORDINATES] = {0};
    multiply(n, s->back, y, z);
    for (int i = 0; i < n; i++) {
        s->path_step[i] = (1 - c) * s->path_step[i] + of_step * z[i];
        length += square(s->path_step[i]);
    }
    length = sqrt(length) / s->chi;
    /* The length that a path still short of its stationary one would have. */
    const double grown = sqrt(1 - pow(1 - c, 2.0 * (double)(s->generation + 1)));
    const bool h = length < (1.4 + 2 / (n + 1.0)) * grown;
    for (int j = 0; j < n; j++)
        s->path[j] = (1 - s->c_path) * s->path[j] + (h ? of_path * y[j] : 0);
    s->step *= exp(fmin(1, c / s->damping * (length - 1)));
    s->step = fmin(fmax(s->step, least_step), most_step);
    return h;
}

static void adapt(struct cma *s, bool h)
{
    const double lost = h ? 0 : s->c_path * (2 - s->c_path);
    const double kept = 1 + s->c_one * lost - s->c_one - s->c_mu * s->weights;
    for (int k = 0; k < s->n * s->n; k++)
        s->covariance[k] *= kept;
    add(s, s->c_one, s->path);
    for (int i = 0; i < s->lambda; i++) {
        const double *const y = s->y + (size_t)s->rank[i].candidate * s->n;
        double weight = s->c_mu * s->weight[i];
        if (weight < 0) { /* by the square of y's length in the metric of C */
            double length = 0, z[CMA_MAX_COORDINATES] = {0};
            multiply(s->n, s->back, y, z);
            for (int k = 0; k < s->n; k++)
                length += z[k] * z[k];
            weight *= length > 0 ? s->n / length : 0;
        }
        add(s, weight, y);
    }
}

/* y of all candidates; whether they are what can be told. */
static bool differences(struct cma *s, const double *x)
{
    double asked[CMA_MAX_COORDINATES], *y = s->y;
    for (int i = 0; i < s->lambda; i++) {
        draw(s, i, asked);
        for (int j = 0; j < s->n; j++, x++, y++) {
            const struct bounds *const b = &s->bounds[j];
            if (!(isfinite(*x) && b->low <= *x && *x <= b->high))
                return false;
            *y = (bounds_preimage(b, *x, asked[j]) - s->centre[j]) / s->step;
            if (fabs(*y) > farthest)
                return false;
        }
    }
    return true;
}

bool cma_tell(struct cma *s, const double *x, const int64_t *score)
{
    const int n = s->n;
    double y[CMA_MAX_COORDINATES] = {0};
    if (!differences(s, x))
        return false;
    for (int i = 0; i < s->lambda; i++)
        s->rank[i] = (struct ranked){score[i], i};
    qsort(s->rank, (size_t)s->lambda, sizeof *s->rank, better_first);
    for (int i = 0; i < s->better; i++)
        for (int j = 0; j < n; j++)
            y[j] += s->weight[i] * s->y[(size_t)s->rank[i].candidate * n + j];
    for (int j = 0; j < n; j++) {
        s->centre[j] += s->step * y[j];
        s->mean[j] = bounds_image(&s->bounds[j], s->centre[j]);
    }
    const bool h = follow(s, y);
    adapt(s, h);
    confine(s);
    decompose(s);
    s->generation++;
    return true;
}

/* ---- what it is like ------------------------------------------------------------------------- */

enum cma_stop cma_stop(const struct cma *s)
{
    double widest = 0;
    for (int j = 0; j < s->n; j++)
        widest = fmax(widest, s->step * sqrt(s->covariance[j * s->n + j]));
    if (widest < small_step)
        return CMA_SMALL;
    if (s->axis[s->n - 1] > sqrt(most_condition) * s->axis[0])
        return CMA_CONDITION;
    return s->step * s->axis[s->n - 1] > most_growth * s->first_step ? CMA_DIVERGED : CMA_GOES_ON;
}
