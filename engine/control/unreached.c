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

enum { N = STANCE_PLANT_MOST };

/* Matrices of this file are by columns, LAPACK's way: A by rows is A'. */
struct balanced {
    int n, r;                  /* states, rank of B */
    double norm;               /* of A */
    double A[N * N], U[N * N]; /* A' balanced, [n][n]; range of B, [n][r] */
    double T[N * N], Z[N * N]; /* A' Z = Z T, real Schur form */
    double re[N], im[N];       /* eigenvalues */
};

/* C[n][p] = A[n][m] B[m][p], or (flip) A[m][n]' B[m][p]. */
static void multiply(bool flip, int n, int m, int p, const double *A, const double *B, double *C)
{
    if (!flip)
        matrix_multiply(p, m, n, B, A, C);
    for (int i = 0; flip && i < n * p; i++)
        C[i] = matrix_dot(m, A + i % n * m, B + i / n * m);
}

/* Orthonormal V[k][*left] of what M[rows][k] maps to 0, singular values up to `zero` counting as
 * it. M is spent. */
static stance_error null_space(int rows, int k, double *M, double zero, double *V, int *left)
{
    const int values = rows < k ? rows : k;
    double sv[N], unused[N], VT[N * N];
    int rank = 0;
    if (rows == 0) /* LAPACK takes none */
        for (int i = 0; i < k * k; i++)
            VT[i] = i % (k + 1) == 0;
    else if (LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'A', rows, k, M, rows, sv, NULL, 1, VT, k,
                            unused) != 0)
        return STANCE_NUMERICAL;
    while (rank < values && sv[rank] > zero)
        rank++;
    *left = k - rank;
    for (int j = 0; j < *left; j++)
        for (int i = 0; i < k; i++)
            V[j * k + i] = VT[i * k + rank + j];
    return STANCE_OK;
}

/* V[k][*d], orthonormal: what C[r][k] maps to 0 and T[k][k] into itself. */
static stance_error stay_unreached(const struct balanced *b, int k, double *C, const double *T,
                                   double *V, int *d)
{
    double S[N * N], P[N * N], W[N * N], next[N * N];
    stance_error error = null_space(b->r, k, C, UNREACHED, V, d);
    for (int before = k; error == STANCE_OK && *d > 0 && *d < before;) {
        before = *d;
        multiply(false, k, k, before, T, V, S); /* what leaves: (1 - V V') T V */
        multiply(true, before, k, before, V, S, P);
        multiply(false, k, before, before, V, P, next);
        for (int i = 0; i < k * before; i++)
            S[i] -= next[i];
        error = null_space(k, before, S, UNREACHED * b->norm, W, d);
        if (error != STANCE_OK)
            return error;
        multiply(false, k, before, *d, V, W, next);
        memcpy(V, next, (size_t)(k * *d) * sizeof *V);
    }
    return error;
}

/* Moves what `takes` selects to the front of T, Q: the first *count columns of Q. */
static stance_error to_front(int n, const lapack_logical *takes, double *T, double *Q, double *re,
                             double *im, int *count)
{
    double s, sep, work[N];
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

/* Which eigenvalues of H = Q T Q' do not decay; what is nothing but rounding in them becomes 0. */
static stance_error select_lasting(int d, double norm, const double *T, double *re, double *im,
                                   lapack_logical *lasts)
{
    double left[N * N], right[N * N], s[N], sep[N];
    lapack_int m = 0;
    int info = LAPACKE_dtrevc(LAPACK_COL_MAJOR, 'B', 'A', NULL, d, T, d, left, d, right, d, d, &m);
    if (info == 0)
        info = LAPACKE_dtrsna(LAPACK_COL_MAJOR, 'E', 'A', NULL, d, T, d, left, d, right, d, s, sep,
                              d, &m);
    for (int i = 0; i < d && info == 0; i++) {
        const double rounding = rounding_of_eigenvalue(norm, s[i]);
        lasts[i] = re[i] >= -rounding;
        re[i] = fabs(re[i]) <= rounding ? 0 : re[i];
        im[i] = fabs(im[i]) <= rounding ? 0 : im[i];
    }
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

/* Of the group of eigenvalues that are selected: adds rows to `out`, of balanced states. */
static stance_error look_at_group(const struct balanced *b, const lapack_logical *group,
                                  struct unreached *out)
{
    const int n = b->n;
    double T[N * N], Z[N * N], L[N * N], V[N * N], H[N * N], Q[N * N], C[N * N], re[N], im[N];
    double moved[2][N];
    lapack_logical lasts[N];
    int k, d = 0, count = 0;
    memcpy(T, b->T, sizeof T);
    memcpy(Z, b->Z, sizeof Z);
    stance_error error = to_front(n, group, T, Z, re, im, &k);
    for (int j = 0; j < k; j++)
        memcpy(L + j * k, T + j * n, (size_t)k * sizeof *L);
    multiply(true, b->r, n, k, b->U, Z, C);
    if (error == STANCE_OK)
        error = stay_unreached(b, k, C, L, V, &d);
    if (error != STANCE_OK || d == 0)
        return error;
    multiply(false, k, k, d, L, V, C); /* H = V' L V */
    multiply(true, d, k, d, V, C, H);
    error = schur(d, H, Q, re, im);
    if (error == STANCE_OK)
        error = select_lasting(d, b->norm, H, re, im, lasts);
    if (error == STANCE_OK)
        error = to_front(d, lasts, H, Q, moved[0], moved[1], &count);
    if (error != STANCE_OK)
        return error;
    multiply(false, k, d, count, V, Q, C);
    multiply(false, n, k, count, Z, C, out->row + out->count * n);
    for (int i = 0; i < d; i++) {
        if (lasts[i]) {
            out->re[out->count] = re[i];
            out->im[out->count++] = im[i];
        }
    }
    return STANCE_OK;
}

/* Eigenvalues i and j belong together. */
static bool near(const struct balanced *b, double largest, int i, int j)
{
    const double size = fmax(hypot(b->re[i], b->im[i]), hypot(b->re[j], b->im[j]));
    return hypot(b->re[i] - b->re[j], fabs(b->im[i]) - fabs(b->im[j])) <=
           NEAR * fmax(size, SMALL / NEAR * largest);
}

static stance_error look_at_groups(const struct balanced *b, struct unreached *out)
{
    const int n = b->n;
    bool seen[N] = {false};
    double largest = 0;
    stance_error error = STANCE_OK;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, hypot(b->re[i], b->im[i]));
    for (int first = 0; first < n && error == STANCE_OK; first++) {
        lapack_logical group[N] = {0};
        if (seen[first])
            continue;
        group[first] = 1;
        for (bool grew = true; grew;) {
            grew = false;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n && !group[i]; j++)
                    if (group[j] && near(b, largest, i, j))
                        group[i] = grew = true;
        }
        for (int i = 0; i < n; i++)
            seen[i] = seen[i] || group[i];
        error = look_at_group(b, group, out);
    }
    return error;
}

/* A' balanced and its Schur form, the range of B; scale[n]: balanced states are scale x. */
static stance_error balance(const stance_plant *plant, struct balanced *b, double *scale)
{
    const int n = plant->states, m = plant->inputs;
    lapack_int low, high;
    double scaled[N * N];
    *b = (struct balanced){.n = n};
    memcpy(b->A, plant->A, (size_t)(n * n) * sizeof *b->A);
    if (LAPACKE_dgebal(LAPACK_COL_MAJOR, 'S', n, b->A, n, &low, &high, scale) != 0)
        return STANCE_NUMERICAL;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++)
            scaled[i * m + j] = scale[i] * plant->B[i * m + j];
    b->norm = matrix_norm(n * n, b->A);
    memcpy(b->T, b->A, sizeof b->T);
    const stance_error error = schur(n, b->T, b->Z, b->re, b->im);
    return error == STANCE_OK ? stance_input_range(n, m, scaled, b->U, NULL, &b->r) : error;
}

/* The plant of the states without a part along the rows, in an orthonormal basis of theirs. */
static stance_error make_rest(const struct balanced *b, struct unreached *out)
{
    const int n = b->n, rest = n - out->count;
    double rows[N * N], V[N * N] = {0}, AV[N * N];
    int left;
    matrix_transpose(out->count, n, out->row, rows);
    /* The rows are independent: none of their singular values is 0. */
    const stance_error error = null_space(out->count, n, rows, -1, V, &left);
    if (error != STANCE_OK)
        return error;
    multiply(true, n, n, rest, b->A, V, AV); /* A' by columns, flipped: A V */
    multiply(true, rest, n, rest, V, AV, rows);
    matrix_transpose(rest, rest, rows, out->A);
    for (int i = 0; i < rest; i++)
        for (int j = 0; j < n; j++)
            out->rest[i * n + j] = V[i * n + j] * out->scale[j];
    return STANCE_OK;
}

stance_error stance_unreached_find(const stance_plant *plant, struct unreached *out)
{
    struct balanced b;
    *out = (struct unreached){.n = plant->states};
    stance_error error = balance(plant, &b, out->scale);
    if (error == STANCE_OK)
        error = look_at_groups(&b, out);
    return error == STANCE_OK && out->count > 0 ? make_rest(&b, out) : error;
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
