/* symmetric_eigen.c - Jacobi's method, see symmetric_eigen.h. */
#include "symmetric_eigen.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

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
