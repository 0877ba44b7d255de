/* unreached.c - what no input moves and what does not decay of itself.
 *
 * A left vector w of x' = A x + B u with w' A^k B = 0 for all k reads of a state what goes its own
 * way whatever the inputs: y = w' x of all of them together obeys y' = H y. Of H what decays needs
 * no input; the rest has to be 0 in a state that is to be brought back, and is reported.
 *
 * These vectors are the largest subspace that A' maps into itself within those that B' maps to 0.
 * It falls apart by eigenvalues: it is looked for in the invariant subspace of A' of each group of
 * them alone, few vectors at a time, so that ranks are not decided at the end of long chains of
 * products. There: those that B' maps to 0, of these those that stay among them, and so on until
 * all do (the staircase of Van Dooren, IEEE Trans. Automatic Control 26, 1981, by its dual).
 *
 * Tolerances are of states balanced by powers of two, with norm |A| (Frobenius) and an orthonormal
 * basis of the range of B instead of B: neither units of states nor of inputs matter. An input
 * counts that has a part above UNREACHED in such a vector: structure leaves 1e-15 where there is
 * none. An eigenvalue decays whose real part is further below 0 than rounding may move it.
 */
#include "unreached.h"

#include <lapacke.h>
#include <string.h>

#define UNREACHED 1e-10
#define NEAR 1e-2  /* of the larger: eigenvalues of a group */
#define SMALL 1e-3 /* of the largest: how large the larger is taken to be at least */
#define OFF 1e-9   /* of the state: what is not 0 along a vector */

/* Matrices of this file are by columns, LAPACK's way: A by rows is A'. */
struct plant {
    int n, r;        /* states, rank of B */
    double norm;     /* of A */
    double *A, *U;   /* A' balanced, [n][n]; range of B, [n][r] */
    double *T, *Z;   /* A' Z = Z T, real Schur form */
    double *re, *im; /* eigenvalues */
};

/* C[n][p] = A[n][m] B[m][p] or (flip) A[m][n]' B[m][p]. */
static void multiply(bool flip, int n, int m, int p, const double *A, const double *B, double *C)
{
    for (int j = 0; j < p; j++)
        for (int i = 0; i < n; i++) {
            double sum = 0;
            for (int k = 0; k < m; k++)
                sum += (flip ? A[i * m + k] : A[k * n + i]) * B[j * m + k];
            C[j * n + i] = sum;
        }
}

/* Orthonormal V[k][*left] of what M[rows][k] maps to 0, singular values up to `zero` counting as
 * it; at least `least` of them. M is spent. */
static stance_error null_space(int rows, int k, double *M, double zero, int least, double *V,
                               int *left)
{
    const int values = rows < k ? rows : k;
    double *const room = matrix_room(2 * (size_t)values + (size_t)k * (size_t)k + 2);
    if (!room)
        return STANCE_NO_MEMORY;
    double *const sv = room, *const work = sv + values, *const VT = work + values + 1;
    int rank = 0;
    if (rows == 0) /* LAPACK takes none */
        for (int i = 0; i < k; i++)
            VT[i * k + i] = 1;
    const int info = rows == 0 ? 0
                               : LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'A', rows, k, M, rows, sv,
                                                NULL, 1, VT, k, work);
    while (rank < values && sv[rank] > zero && rank < k - least)
        rank++;
    *left = k - rank;
    for (int j = 0; j < *left; j++)
        for (int i = 0; i < k; i++)
            V[j * k + i] = VT[i * k + rank + j];
    free(room);
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

/* N[k][*d], orthonormal: what C[r][k] maps to 0 and T[k][k] into itself. room: 4 k k. */
static stance_error stay_unreached(int r, int k, double *C, const double *T, double norm, double *N,
                                   int *d, double *room)
{
    const size_t kk = (size_t)k * (size_t)k;
    double *const S = room, *const P = S + kk, *const V = P + kk, *const next = V + kk;
    stance_error error = null_space(r, k, C, UNREACHED, 0, N, d);
    for (int before = k; error == STANCE_OK && *d > 0 && *d < before;) {
        before = *d;
        multiply(false, k, k, before, T, N, S); /* what leaves: (1 - N N') T N */
        multiply(true, before, k, before, N, S, P);
        multiply(false, k, before, before, N, P, next);
        for (int i = 0; i < k * before; i++)
            S[i] -= next[i];
        error = null_space(k, before, S, UNREACHED * norm, 0, V, d);
        multiply(false, k, before, *d, N, V, next);
        memcpy(N, next, (size_t)k * (size_t)*d * sizeof *N);
    }
    return error;
}

/* Moves what `takes` selects to the front of T, Q: the first *count columns of Q. */
static stance_error to_front(int n, const lapack_logical *takes, double *T, double *Q, double *re,
                             double *im, int *count)
{
    double s, sep, work[UNREACHED_MOST];
    lapack_int m = 0, whole; /* LAPACKE's own wrapper writes where `whole` is not */
    const int info = LAPACKE_dtrsen_work(LAPACK_COL_MAJOR, 'N', 'V', takes, n, T, n, Q, n, re, im,
                                         &m, &s, &sep, work, n, &whole, 1);
    *count = (int)m;
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

static stance_error schur(int n, double *T, double *Q, double *re, double *im)
{
    lapack_int ignored;
    const int info =
        LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'N', NULL, n, T, n, &ignored, re, im, Q, n);
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

/* Which eigenvalues of H = Q T Q' do not decay; what is nothing but rounding in them becomes 0.
 * room: 2 d d + 2 d. */
static stance_error select_lasting(int d, double norm, const double *T, double *re, double *im,
                                   lapack_logical *lasts, double *room)
{
    double *const left = room, *const right = left + d * d, *const s = right + d * d,
                  *const sep = s + d;
    lapack_int m = 0;
    int info = LAPACKE_dtrevc(LAPACK_COL_MAJOR, 'B', 'A', NULL, d, T, d, left, d, right, d, d, &m);
    if (info == 0)
        info = LAPACKE_dtrsna(LAPACK_COL_MAJOR, 'E', 'A', NULL, d, T, d, left, d, right, d, s, sep,
                              d, &m);
    for (int i = 0; i < d; i++) {
        const double rounding = rounding_of_eigenvalue(norm, s[i]);
        lasts[i] = re[i] >= -rounding;
        re[i] = fabs(re[i]) <= rounding ? 0 : re[i];
        im[i] = fabs(im[i]) <= rounding ? 0 : im[i];
    }
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

/* Of the group of eigenvalues that are selected: adds rows to `out`, of balanced states. */
static stance_error look_at_group(const struct plant *p, const lapack_logical *group,
                                  struct unreached *out, double *room)
{
    const int n = p->n;
    const size_t nn = (size_t)n * (size_t)n;
    double *const T = room, *const Z = T + nn, *const L = Z + nn, *const N = L + nn,
                  *const H = N + nn, *const Q = H + nn, *const C = Q + nn, *const re = C + nn,
                  *const im = re + n, *const more = im + n;
    lapack_logical lasts[UNREACHED_MOST];
    int k, d = 0, count = 0;
    memcpy(T, p->T, nn * sizeof *T);
    memcpy(Z, p->Z, nn * sizeof *Z);
    stance_error error = to_front(n, group, T, Z, re, im, &k);
    for (int j = 0; j < k; j++)
        memcpy(L + j * k, T + j * n, (size_t)k * sizeof *L);
    multiply(true, p->r, n, k, p->U, Z, C);
    if (error == STANCE_OK)
        error = stay_unreached(p->r, k, C, L, p->norm, N, &d, more);
    if (error != STANCE_OK || d == 0)
        return error;
    multiply(false, k, k, d, L, N, C); /* H = N' L N */
    multiply(true, d, k, d, N, C, H);
    error = schur(d, H, Q, re, im);
    if (error == STANCE_OK)
        error = select_lasting(d, p->norm, H, re, im, lasts, more);
    if (error == STANCE_OK)
        error = to_front(d, lasts, H, Q, more, more + d, &count);
    multiply(false, k, d, count, N, Q, C);
    multiply(false, n, k, count, Z, C, out->row + out->count * n);
    for (int i = 0; error == STANCE_OK && i < d; i++) {
        if (lasts[i]) {
            out->re[out->count] = re[i];
            out->im[out->count++] = im[i];
        }
    }
    return error;
}

/* Eigenvalues a and b belong together. */
static bool near(const struct plant *p, double largest, int a, int b)
{
    const double size = fmax(hypot(p->re[a], p->im[a]), hypot(p->re[b], p->im[b]));
    return hypot(p->re[a] - p->re[b], fabs(p->im[a]) - fabs(p->im[b])) <=
           NEAR * fmax(size, SMALL / NEAR * largest);
}

static stance_error look_at_groups(const struct plant *p, struct unreached *out, double *room)
{
    const int n = p->n;
    bool seen[UNREACHED_MOST] = {false};
    double largest = 0;
    stance_error error = STANCE_OK;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, hypot(p->re[i], p->im[i]));
    for (int first = 0; first < n && error == STANCE_OK; first++) {
        lapack_logical group[UNREACHED_MOST] = {0};
        if (seen[first])
            continue;
        group[first] = 1;
        for (bool grew = true; grew;) {
            grew = false;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n && !group[i]; j++)
                    if (group[j] && near(p, largest, i, j))
                        group[i] = grew = true;
        }
        for (int i = 0; i < n; i++)
            seen[i] = seen[i] || group[i];
        error = look_at_group(p, group, out, room);
    }
    return error;
}

/* A' balanced and its Schur form, the range of B; scale[n]: balanced states are scale x. */
static stance_error make_plant(struct plant *p, int m, const double *A, const double *B,
                               double *scale)
{
    const int n = p->n;
    lapack_int low, high;
    double *const scaled = matrix_room((size_t)n * (size_t)m);
    if (!scaled)
        return STANCE_NO_MEMORY;
    memcpy(p->A, A, (size_t)n * (size_t)n * sizeof *A);
    int info = LAPACKE_dgebal(LAPACK_COL_MAJOR, 'S', n, p->A, n, &low, &high, scale);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++)
            scaled[i * m + j] = scale[i] * B[i * m + j];
    p->norm = matrix_norm(n * n, p->A);
    memcpy(p->T, p->A, (size_t)n * (size_t)n * sizeof *A);
    stance_error error = info == 0 ? schur(n, p->T, p->Z, p->re, p->im) : STANCE_NUMERICAL;
    if (error == STANCE_OK)
        error = stance_input_range(n, m, scaled, p->U, &p->r);
    free(scaled);
    return error;
}

/* The plant of the states without a part along the rows, in an orthonormal basis of theirs. */
static stance_error make_rest(const struct plant *p, struct unreached *out, double *room)
{
    const int n = p->n, rest = n - out->count;
    const size_t nn = (size_t)n * (size_t)n;
    double *const rows = room, *const V = rows + nn, *const AV = V + nn;
    int left;
    for (int i = 0; i < out->count; i++)
        for (int j = 0; j < n; j++)
            rows[j * out->count + i] = out->row[i * n + j];
    const stance_error error = null_space(out->count, n, rows, -1, rest, V, &left);
    multiply(true, n, n, rest, p->A, V, AV); /* A' by columns, flipped: A V */
    multiply(true, rest, n, rest, V, AV, rows);
    matrix_transpose(rest, rest, rows, out->A);
    for (int i = 0; i < rest; i++)
        for (int j = 0; j < n; j++)
            out->rest[i * n + j] = V[i * n + j] * out->scale[j];
    return error;
}

stance_error stance_unreached_find(int n, int m, const double *A, const double *B,
                                   struct unreached *out)
{
    const size_t nn = (size_t)n * (size_t)n, side = (size_t)n;
    *out = (struct unreached){.n = n};
    if (n > UNREACHED_MOST)
        return STANCE_BAD_ARGUMENT;
    out->row = matrix_room(3 * nn + 3 * side);
    double *const room = matrix_room(16 * nn + 4 * side);
    stance_error error = out->row && room ? STANCE_OK : STANCE_NO_MEMORY;
    if (error == STANCE_OK) {
        out->rest = out->row + nn;
        out->A = out->rest + nn;
        out->scale = out->A + nn;
        out->re = out->scale + side;
        out->im = out->re + side;
        double *const work = room + 4 * nn + 2 * side;
        struct plant p = {
            .n = n, .A = room, .U = room + nn, .T = room + 2 * nn, .Z = room + 3 * nn};
        p.re = room + 4 * nn;
        p.im = p.re + side;
        error = make_plant(&p, m, A, B, out->scale);
        if (error == STANCE_OK)
            error = look_at_groups(&p, out, work);
        if (error == STANCE_OK && out->count > 0)
            error = make_rest(&p, out, work);
    }
    if (error != STANCE_OK)
        stance_unreached_free(out);
    free(room);
    return error;
}

void stance_unreached_free(struct unreached *out)
{
    free(out->row);
    *out = (struct unreached){0};
}

bool stance_unreached_has(const struct unreached *out, const double *x)
{
    double size = 0;
    for (int j = 0; out->count > 0 && j < out->n; j++)
        size = hypot(size, out->scale[j] * x[j]);
    for (int i = 0; i < out->count; i++) {
        double along = 0;
        for (int j = 0; j < out->n; j++)
            along += out->row[i * out->n + j] * out->scale[j] * x[j];
        if (fabs(along) > OFF * size)
            return true;
    }
    return false;
}
