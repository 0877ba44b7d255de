/* rows.c - see rows.h. */
#include "rows.h"

#include "matrix.h"

enum { SWEEPS = 40 };

static const double rank_tolerance = 1e-9;

/* Makes rows p and q orthogonal, whose squared lengths are a and b; false: they are. */
static bool turn_pair(int n, int width, double *p, double *q, double *a, double *b,
                      double negligible)
{
    const double c = matrix_dot(n, p, q);
    if (c * c <= 1e-31 * (*a * *b) || fmin(*a, *b) <= negligible)
        return false;
    const double zeta = (*b - *a) / (2 * c);
    const double t = (zeta < 0 ? -1 : 1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    const double cosine = 1 / sqrt(1 + t * t), sine = cosine * t;
    for (int i = 0; i < width; i++) {
        const double x = p[i], y = q[i];
        p[i] = cosine * x - sine * y;
        q[i] = sine * x + cosine * y;
    }
    *a -= t * c;
    *b += t * c;
    return true;
}

/* Squared lengths of the rows; returns the largest. */
static double measure(int rows, int n, double a[][STANCE_ROWS_STRIDE], double *square)
{
    double largest = 0;
    for (int p = 0; p < rows; p++) {
        square[p] = matrix_dot(n, a[p], a[p]);
        largest = fmax(largest, square[p]);
    }
    return largest;
}

int stance_rows_turn(int rows, int n, int width, double a[][STANCE_ROWS_STRIDE])
{
    double square[STANCE_ROWS_STRIDE], largest;
    bool turned = true;
    int rank = 0;
    for (int sweep = 0; sweep < SWEEPS && turned; sweep++) {
        turned = false;
        largest = measure(rows, n, a, square);
        for (int p = 0; p < rows; p++)
            for (int q = p + 1; q < rows; q++)
                turned |= turn_pair(n, width, a[p], a[q], &square[p], &square[q], 1e-32 * largest);
    }
    largest = measure(rows, n, a, square);
    for (int p = 0; p < rows; p++)
        if (square[p] > rank_tolerance * rank_tolerance * largest)
            rank++;
        else
            memset(a[p], 0, (size_t)n * sizeof *a[p]);
    return rank;
}

void stance_rows_solve(int rows, int n, double a[][STANCE_ROWS_STRIDE], double *x)
{
    memset(x, 0, (size_t)n * sizeof *x);
    for (int p = 0; p < rows; p++) {
        const double square = matrix_dot(n, a[p], a[p]);
        for (int i = 0; square > 0 && i < n; i++)
            x[i] += a[p][i] * (a[p][n] / square);
    }
}

int stance_rows_null(int rows, int n, double a[][STANCE_ROWS_STRIDE],
                     double Z[][STANCE_ROWS_STRIDE])
{
    int count = 0;
    for (int i = 0; i < n; i++) { /* the projector onto what is left */
        for (int j = 0; j < n; j++)
            Z[i][j] = i == j;
        for (int p = 0; p < rows; p++) {
            const double square = matrix_dot(n, a[p], a[p]);
            for (int j = 0; square > 0 && j < n; j++)
                Z[i][j] -= a[p][i] * (a[p][j] / square);
        }
    }
    stance_rows_turn(n, n, n, Z);
    for (int i = 0; i < n; i++) {
        const double length = sqrt(matrix_dot(n, Z[i], Z[i]));
        if (length < 0.5)
            continue;
        for (int j = 0; j < n; j++)
            Z[count][j] = Z[i][j] / length;
        count++;
    }
    return count;
}
