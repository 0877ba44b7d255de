/* place.c - robust pole assignment by state feedback.
 *
 * Kautsky, Nichols, Van Dooren, "Robust pole assignment in linear state feedback", Int. J. Control
 * 41 (1985) 1129-1155. With B = U0 S V^T (rank r) and U1 spanning the rest, A - B K can have x as
 * eigenvector to the pole p exactly when x lies in S_p, the null space of U1^T (A - p I), of
 * dimension r. Given independent unit vectors x_j of the S_j, X = (x_1 ... x_n),
 *
 *   K = V S^-1 U0^T (A - X diag(p) X^-1).
 *
 * The poles are the less sensitive to errors of A, B and K the better X is conditioned. Method 0
 * replaces one x_j after the other by the projection on S_j of the normal of all other vectors.
 * That is the best x_j can do for |det X|, so the sweeps climb |det X|; they are repeated here
 * until the vectors stand still. A conjugate pair x = S w, with q1, q2 an orthonormal basis of the
 * complement of the other vectors, contributes
 *
 *   |Im(conj(q1^T x) (q2^T x))| = |w^H H w|,   H = (a b^H - b a^H) / 2i,   a = S^H q1, b = S^H q2,
 *
 * and the eigenvector of the Hermitian H to its largest eigenvalue is the best both can do at once
 * (compare Tits and Yang, IEEE TAC 41 (1996) 1432-1452). In store, a pair is its real and its
 * imaginary part, so that X and K stay real.
 *
 * The maximum need not be unique. A mechanical system of p degrees of freedom without damping
 * under p - 1 torques has S_j = {(v, p_j v)}, where v is orthogonal to p_j^2 u - G^T u, u the
 * direction without torque and p'' = G p: all these normals lie in one plane. The reflection of v
 * in that plane maps each S_j to itself and keeps |det X| and the condition number, so that
 * maxima come as mirror images whose gains differ. place() therefore
 *   1. climbs from several fixed starts and takes the highest maximum,
 *   2. finds the reflection from the S_j alone and climbs from the mirror image too,
 *   3. of maxima equally high (1e-9) takes the one with the larger Frobenius norm of K: a choice
 *      that changes continuously with the robot, which "where the iteration happens to end" does
 *      not.
 * For the default biped on one foot this is the gain that other programs' usual start leads to,
 * and the better one: with 10 N m it recovers from tilts of -0.094 ... 0.020 rad, its mirror image
 * from -0.051 ... 0.021 rad only.
 *
 * Sampling breaks the symmetry a little, of the order of T^2, and would let such a trifle choose
 * between the twins. stance_place_robust then climbs from the eigenvectors of a solved neighbour
 * instead, so that the gain of the sampled model continues that of continuous time.
 */
#include "control.h"

#include <complex.h>
#include <lapacke.h>
#include <stdio.h>
#include <string.h>

#define STARTS 4
#define SCREEN_TOLERANCE 1e-7 /* change of a unit vector in one sweep that tells maxima apart */
#define SCREEN_SWEEPS 2000
#define TOLERANCE 1e-13 /* change that counts as none */
#define ROUNDING 1e-9   /* below it, no progress in PATIENCE sweeps means rounding */
#define PATIENCE 100
#define MAX_SWEEPS 20000
#define FLAT 1e-6         /* change still admitted after MAX_SWEEPS: a degenerate maximum */
#define EQUAL_HEIGHT 1e-9 /* relative difference of |det X| between mirror images */
#define WORST_CONDITION 1e13

typedef double _Complex number;

enum { N = STANCE_PLANT_MOST };

typedef struct problem {
    int n, m, r;
    const double *A, *B;
    number pole[N];          /* a pair in two places in a row, the one with im > 0 first */
    double range[N * N];     /* [n][n] columns of U: r for U0, then U1 (column-major) */
    double pseudo[N * N];    /* [m][r] V S^-1 */
    number space[N * N * N]; /* [n][n r] orthonormal basis of S_j, column-major */
    number vector[N * N];    /* [n][n] x_j; the conjugate's place in a pair is unused */
    number best[N * N];      /* [n][n] the highest maximum so far */
    double X[N * N];         /* [n][n] column-major: x_j, or real and imaginary part */
    double rhs[N * N], factor[N * N], real[N * N]; /* scratch, like these: */
    number image[N * N], small[4 * N * N];
    lapack_int pivot[N];
} problem;

static bool is_pair(const problem *p, int j)
{
    return cimag(p->pole[j]) > 0;
}

/* ---- the poles that are wanted --------------------------------------------------------------- */

static stance_error check_multiplicity(const problem *p, stance_message *message)
{
    for (int j = 0; j < p->n; j++) {
        int times = 0;
        for (int k = 0; k < p->n; k++)
            times += stance_same_pole(p->pole[j], p->pole[k]);
        if (times > p->r) {
            char text[64];
            return stance_refuse(message, STANCE_BAD_POLES,
                                 "the pole %s is wanted %d times, but the number of independent "
                                 "inputs, %d, is the most that one pole can be repeated",
                                 stance_complex_text(p->pole[j], text), times, p->r);
        }
    }
    return STANCE_OK;
}

/* ---- what can be placed ---------------------------------------------------------------------- */

static const number *space_of(const problem *p, int j)
{
    return p->space + j * p->n * p->r;
}

/* Orthonormal bases of the S_j. */
static stance_error find_spaces(problem *p)
{
    const int n = p->n, rows = n - p->r;
    number *M = p->image, *vt = p->small;
    double *sv = p->real, *unused = sv + n;

    for (int j = 0; j < n; j++) {
        number *space = p->space + j * n * p->r;
        for (int i = 0; i < n * n; i++)
            vt[i] = i % (n + 1) == 0;
        for (int i = 0; i < rows; i++) {
            const double *u = p->range + (p->r + i) * n;
            for (int k = 0; k < n; k++) {
                double sum = 0;
                for (int l = 0; l < n; l++)
                    sum += u[l] * p->A[l * n + k];
                M[k * rows + i] = sum - p->pole[j] * u[k];
            }
        }
        if (rows > 0 && LAPACKE_zgesvd(LAPACK_COL_MAJOR, 'N', 'A', rows, n, M, rows, sv, NULL, 1,
                                       vt, n, unused) != 0)
            return STANCE_NUMERICAL;
        for (int k = 0; k < p->r; k++)
            for (int i = 0; i < n; i++)
                space[k * n + i] = conj(vt[i * n + rows + k]);
    }
    return STANCE_OK;
}

/* ---- climbing |det X| ------------------------------------------------------------------------ */

static void store_columns(problem *p, int j)
{
    const number *x = p->vector + j * p->n;
    for (int i = 0; i < p->n; i++) {
        p->X[j * p->n + i] = creal(x[i]);
        if (is_pair(p, j))
            p->X[(j + 1) * p->n + i] = cimag(x[i]);
    }
}

/* x_j = S_j w, scaled to length 1; false when w is zero. */
static bool combine(const problem *p, int j, const number *w, number *x)
{
    const number *space = space_of(p, j);
    double norm = 0;
    for (int i = 0; i < p->n; i++) {
        x[i] = 0;
        for (int k = 0; k < p->r; k++)
            x[i] += space[k * p->n + i] * w[k];
        norm = hypot(norm, cabs(x[i]));
    }
    for (int i = 0; i < p->n; i++)
        x[i] /= norm;
    return norm > 0 && isfinite(norm);
}

/* w = S_j^H y. */
static void project(const problem *p, int j, const double *y, number *w)
{
    const number *space = space_of(p, j);
    for (int k = 0; k < p->r; k++) {
        w[k] = 0;
        for (int i = 0; i < p->n; i++)
            w[k] += conj(space[k * p->n + i]) * y[i];
    }
}

static bool normalise(int n, double *y)
{
    const double norm = matrix_norm(n, y);
    for (int i = 0; i < n; i++)
        y[i] /= norm;
    return norm > 0 && isfinite(norm);
}

/* Orthonormal basis, in y, of the complement of all columns of X but `count` from column j. */
static bool complement(problem *p, int j, int count, double *y)
{
    const int n = p->n;
    matrix_transpose(n, n, p->X, p->factor);
    memset(y, 0, (size_t)(count * n) * sizeof *y);
    for (int c = 0; c < count; c++)
        y[c * n + j + c] = 1;
    if (LAPACKE_dgesv(LAPACK_COL_MAJOR, n, count, p->factor, n, p->pivot, y, n) != 0 ||
        !normalise(n, y))
        return false;
    if (count == 1)
        return true;
    double *z = y + n;
    if (!normalise(n, z))
        return false;
    for (int again = 0; again < 2; again++) {
        const double along = matrix_dot(n, y, z);
        for (int i = 0; i < n; i++)
            z[i] -= along * y[i];
    }
    return normalise(n, z);
}

/* w: eigenvector of H of the largest |eigenvalue|; of two equal ones the positive. */
static bool best_pair(problem *p, const number *a, const number *b, number *w)
{
    const int r = p->r;
    number *H = p->small + 3 * r;
    double *value = p->real;
    for (int i = 0; i < r; i++)
        for (int k = 0; k < r; k++)
            H[k * r + i] = (a[i] * conj(b[k]) - b[i] * conj(a[k])) / CMPLX(0, 2);
    if (LAPACKE_zheev(LAPACK_COL_MAJOR, 'V', 'U', r, H, r, value) != 0)
        return false;
    const int best = -value[0] > value[r - 1] * (1 + 1e-9) ? 0 : r - 1;
    memcpy(w, H + best * r, (size_t)r * sizeof *w);
    return true;
}

/* Replaces x_j (and its conjugate) by the best choice; *change grows to how far it moved. */
static bool improve(problem *p, int j, double *change)
{
    const int n = p->n, count = is_pair(p, j) ? 2 : 1;
    number *x = p->vector + j * n, *fresh = p->image, *w = p->small, *a = w + p->r, *b = a + p->r;
    if (!complement(p, j, count, p->rhs))
        return false;
    if (count == 1) {
        project(p, j, p->rhs, w);
    } else {
        project(p, j, p->rhs, a);
        project(p, j, p->rhs + n, b);
        if (!best_pair(p, a, b, w))
            return false;
    }
    if (!combine(p, j, w, fresh))
        return false;
    /* A vector's phase means nothing: compare after turning the new one to the old. */
    number overlap = 0;
    for (int i = 0; i < n; i++)
        overlap += conj(fresh[i]) * x[i];
    const number phase = cabs(overlap) > 0 ? overlap / cabs(overlap) : 1;
    double moved = 0;
    for (int i = 0; i < n; i++) {
        fresh[i] *= phase;
        moved = hypot(moved, cabs(fresh[i] - x[i]));
        x[i] = fresh[i];
    }
    *change = fmax(*change, moved);
    store_columns(p, j);
    return true;
}

/* Sweeps until nothing moves by more than `tolerance`; false: singular, or not there yet. */
static bool climb(problem *p, double tolerance, int most, double admitted, int *sweeps)
{
    double least = INFINITY;
    int progress = 0;
    for (*sweeps = 1;; ++*sweeps) {
        double change = 0;
        for (int j = 0; j < p->n; j += is_pair(p, j) ? 2 : 1)
            if (!improve(p, j, &change))
                return false;
        if (change < least) {
            least = change;
            progress = *sweeps;
        }
        if (change <= tolerance || (change <= ROUNDING && *sweeps >= progress + PATIENCE))
            return true;
        if (*sweeps >= most)
            return change <= admitted;
    }
}

/* log |det X|; -INFINITY for a singular X. */
static double log_height(problem *p)
{
    const int n = p->n;
    memcpy(p->factor, p->X, (size_t)(n * n) * sizeof *p->X);
    if (LAPACKE_dgetrf(LAPACK_COL_MAJOR, n, n, p->factor, n, p->pivot) != 0)
        return -INFINITY;
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += log(fabs(p->factor[i * (n + 1)]));
    return sum;
}

/* ---- starts and mirror images ---------------------------------------------------------------- */

/* x_j: re + i im (NULL: none) projected on S_j; false when that is zero. */
static bool put_projection(problem *p, int j, const double *re, const double *im)
{
    number *w = p->small, *part = w + p->r;
    project(p, j, re, w);
    if (im)
        project(p, j, im, part);
    for (int k = 0; k < p->r && im; k++)
        w[k] += CMPLX(0, 1) * part[k];
    if (!combine(p, j, w, p->vector + j * p->n))
        return false;
    store_columns(p, j);
    return true;
}

/* x_j: fixed scattered vectors projected on S_j, so that the start does not depend on the bases. */
static bool scatter(problem *p, int start)
{
    uint64_t state = 0x9e3779b97f4a7c15u * (uint64_t)(start + 1);
    for (int j = 0, count; j < p->n; j += count) {
        count = is_pair(p, j) ? 2 : 1;
        for (int i = 0; i < count * p->n; i++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            p->rhs[i] = (double)(state >> 11) * 0x1p-52 - 1;
        }
        if (!put_projection(p, j, p->rhs, count == 2 ? p->rhs + p->n : NULL))
            return false;
    }
    return true;
}

/* M[r][r] (column-major) = S_i^H S_j. */
static void cross_gram(const problem *p, int i, int j, number *M)
{
    const int n = p->n, r = p->r;
    const number *Si = space_of(p, i), *Sj = space_of(p, j);
    for (int a = 0; a < r; a++) {
        for (int b = 0; b < r; b++) {
            number sum = 0;
            for (int k = 0; k < n; k++)
                sum += conj(Si[a * n + k]) * Sj[b * n + k];
            M[b * r + a] = sum;
        }
    }
}

/* Direction in S_0, as coefficients, that a reflection common to all S_j turns round: where such a
 * reflection exists it is a singular vector of S_0^H S_j; the j that shows it best is taken. */
static bool mirror_direction(problem *p, number *direction)
{
    const int r = p->r;
    number *M = p->small + r, *u = M + r * r;
    double *sv = p->real, *unused = sv + r;
    double clearest = 1 - 1e-9;
    for (int j = 1; j < p->n; j++) {
        cross_gram(p, 0, j, M);
        if (LAPACKE_zgesvd(LAPACK_COL_MAJOR, 'A', 'N', r, r, M, r, sv, u, r, NULL, 1, unused) != 0)
            return false;
        if (sv[r - 1] < clearest * sv[0]) {
            clearest = sv[r - 1] / sv[0];
            memcpy(direction, u + (r - 1) * r, (size_t)r * sizeof *direction);
        }
    }
    return clearest < 1 - 1e-9;
}

/* Reflects every x_j: with w_j its coefficients and M = S_0^H S_j, M w_j is turned in S_0 and
 * brought back by M^-1. false where there is nothing to reflect; X may be spoilt then. */
static bool reflect(problem *p)
{
    const int n = p->n, r = p->r;
    number *direction = p->image;
    if (r < 2 || !mirror_direction(p, direction))
        return false;
    number *w = p->small, *image = w + r, *M = image + r;
    for (int j = 0; j < n; j += is_pair(p, j) ? 2 : 1) {
        const number *space = space_of(p, j);
        number *x = p->vector + j * n;
        for (int k = 0; k < r; k++) {
            w[k] = 0;
            for (int i = 0; i < n; i++)
                w[k] += conj(space[k * n + i]) * x[i];
        }
        cross_gram(p, 0, j, M);
        number along = 0;
        for (int a = 0; a < r; a++) {
            image[a] = 0;
            for (int b = 0; b < r; b++)
                image[a] += M[b * r + a] * w[b];
            along += conj(direction[a]) * image[a];
        }
        for (int a = 0; a < r; a++)
            image[a] -= 2 * along * direction[a];
        if (LAPACKE_zgesv(LAPACK_COL_MAJOR, r, 1, M, r, p->pivot, image, r) != 0 ||
            !combine(p, j, image, x))
            return false;
        store_columns(p, j);
    }
    return true;
}

/* ---- gains ----------------------------------------------------------------------------------- */

/* K[m][n] = V S^-1 U0^T (A - M), M X = X Lambda in real form. */
static bool gains(problem *p, double *K, double *norm)
{
    const int n = p->n, r = p->r;
    double *M = p->rhs, *XT = p->factor, *U0M = p->real;
    matrix_transpose(n, n, p->X, XT);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            const double a = creal(p->pole[j]), b = cimag(p->pole[j]);
            const double *column = p->X + j * n;
            M[i * n + j] = b == 0  ? a * column[i]
                           : b > 0 ? a * column[i] - b * column[n + i]
                                   : -b * column[i - n] + a * column[i];
        }
    }
    /* X^T M^T = (X Lambda)^T: column i of the solution is row i of M. */
    if (LAPACKE_dgesv(LAPACK_COL_MAJOR, n, n, XT, n, p->pivot, M, n) != 0)
        return false;
    for (int i = 0; i < n * n; i++)
        M[i] = p->A[i] - M[i];
    matrix_multiply(r, n, n, p->range, M, U0M);
    matrix_multiply(p->m, r, n, p->pseudo, U0M, K);
    *norm = matrix_norm(p->m * n, K);
    return isfinite(*norm);
}

/* 2-norm condition number of the unit eigenvectors; (x, conj x) is (u, v) times sqrt(2) times a
 * unitary matrix. */
static double condition_number(problem *p)
{
    const int n = p->n;
    double *sv = p->real, *unused = sv + n;
    for (int j = 0; j < n; j++) {
        const double scale = cimag(p->pole[j]) != 0 ? sqrt(2) : 1;
        for (int i = 0; i < n; i++)
            p->factor[j * n + i] = scale * p->X[j * n + i];
    }
    if (LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'N', n, n, p->factor, n, sv, NULL, 1, NULL, 1,
                       unused) != 0)
        return INFINITY;
    return sv[0] / sv[n - 1];
}

/* ---- the whole ------------------------------------------------------------------------------- */

static stance_error not_independent(stance_message *message)
{
    return stance_refuse(message, STANCE_BAD_POLES,
                         "these poles cannot be placed: no independent eigenvectors were found; "
                         "poles that repeat or nearly coincide are spread over too few inputs");
}

/* The highest maximum that the starts lead to is left in p->vector and p->X; *taken: sweeps from
 * its start. */
static bool screen(problem *p, int *taken)
{
    number *best = p->best;
    double highest = -INFINITY;
    int sweeps;
    for (int start = 0; start < STARTS; start++) {
        if (!scatter(p, start) || !climb(p, SCREEN_TOLERANCE, SCREEN_SWEEPS, 1, &sweeps))
            continue;
        const double height = log_height(p);
        if (height > highest + (isfinite(highest) ? EQUAL_HEIGHT : 0)) {
            highest = height;
            *taken = sweeps;
            memcpy(best, p->vector, sizeof p->best);
        }
    }
    if (!isfinite(highest))
        return false;
    memcpy(p->vector, best, sizeof p->best);
    for (int j = 0; j < p->n; j += is_pair(p, j) ? 2 : 1)
        store_columns(p, j);
    return true;
}

/* One finished candidate: K and how it rates. */
typedef struct candidate {
    double height, norm, condition;
    int sweeps;
} candidate;

static stance_error finish(problem *p, double *K, candidate *c, stance_message *message)
{
    if (!climb(p, TOLERANCE, MAX_SWEEPS, FLAT, &c->sweeps)) {
        return c->sweeps >= MAX_SWEEPS
                   ? stance_refuse(
                         message, STANCE_NOT_CONVERGED,
                         "pole placement did not converge in %d sweeps: set the poles further "
                         "apart, or take controller.design place-schur, which does not "
                         "iterate",
                         MAX_SWEEPS)
                   : not_independent(message);
    }
    c->height = log_height(p);
    c->condition = condition_number(p);
    if (!(c->condition < WORST_CONDITION) || !gains(p, K, &c->norm))
        return not_independent(message);
    return STANCE_OK;
}

/* Climbs from the vectors `start` of a neighbouring problem, projected on the S_j. */
static bool solve_from(problem *p, const number *start, double *K, candidate *c)
{
    for (int j = 0; j < p->n; j += is_pair(p, j) ? 2 : 1) {
        double *re = p->rhs, *im = re + p->n;
        for (int i = 0; i < p->n; i++) {
            re[i] = creal(start[j * p->n + i]);
            im[i] = cimag(start[j * p->n + i]);
        }
        if (!put_projection(p, j, re, im))
            return false;
    }
    return finish(p, K, c, NULL) == STANCE_OK;
}

/* The vectors of the solution are left in p->best. */
static stance_error solve(problem *p, double *K, candidate *c, stance_message *message)
{
    candidate mirrored = {0};
    double other[N * N] = {0};
    int before = 0;
    const stance_error error =
        screen(p, &before) ? finish(p, K, c, message) : not_independent(message);
    memcpy(p->best, p->vector, sizeof p->best);
    if (error == STANCE_OK && reflect(p) && finish(p, other, &mirrored, NULL) == STANCE_OK) {
        const double higher = mirrored.height - c->height;
        if (higher > EQUAL_HEIGHT || (higher >= -EQUAL_HEIGHT && mirrored.norm > c->norm)) {
            mirrored.sweeps += c->sweeps;
            *c = mirrored;
            memcpy(K, other, (size_t)(p->n * p->m) * sizeof *K);
            memcpy(p->best, p->vector, sizeof p->best);
        }
    }
    c->sweeps += before;
    return error;
}

/* Fills *p with all but a solution. */
static stance_error prepare(problem *p, const placement *of, stance_message *message)
{
    const stance_plant *const plant = of->plant;
    stance_error error = stance_check_plant(plant, message);
    if (error != STANCE_OK)
        return error;
    *p = (problem){.n = plant->states, .m = plant->inputs, .A = plant->A, .B = plant->B};
    error = stance_pair_poles(p->n, of->poles, p->pole, message);
    if (error == STANCE_OK)
        error = stance_input_range(p->n, p->m, p->B, p->range, p->pseudo, &p->r);
    if (error == STANCE_OK && p->r == 0)
        return stance_refuse(message, STANCE_UNCONTROLLABLE,
                             "the inputs have no effect: the matrix B is zero");
    if (error == STANCE_OK)
        error = check_multiplicity(p, message);
    if (error == STANCE_OK)
        error = stance_check_controllable(plant, message);
    return error == STANCE_OK ? find_spaces(p) : error;
}

stance_error stance_place_robust(const placement *wanted, const placement *near, double *K,
                                 stance_robustness *robustness, stance_message *message)
{
    problem p, q;
    candidate c = {0}, ignored = {0};
    stance_error error = prepare(&p, wanted, message);
    if (error == STANCE_OK) {
        const bool followed = near && prepare(&q, near, NULL) == STANCE_OK && q.r == p.r &&
                              solve(&q, K, &ignored, NULL) == STANCE_OK &&
                              solve_from(&p, q.best, K, &c);
        error = followed ? STANCE_OK : solve(&p, K, &c, message);
    }
    if (error == STANCE_OK)
        *robustness = (stance_robustness){c.sweeps, c.condition};
    if (error == STANCE_NUMERICAL)
        stance_refuse(message, error, "pole placement: %s", stance_error_text(error));
    return error;
}
