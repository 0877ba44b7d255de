/* gauss.h - small dense equations by elimination with complete pivoting, in plain arithmetic: what
 * is rare, the same bits everywhere.
 */
#ifndef STANCE_CORE_LANES_GAUSS_H
#define STANCE_CORE_LANES_GAUSS_H

#include "engine/stance.h"
#include "lanes.h"
#include "sizes.h"

/* What a state of rest has (loop/rest_linear.h): places and rates, integrals, torques, commands
 * under way. And impulses of contacts, or more. */
enum {
    GAUSS_STATES = 2 * SCENE_COORDINATES + (2 + STANCE_MAX_DELAY) * SCENE_ACTUATORS,
    GAUSS_ROOM = GAUSS_STATES + 2 * CONTACTS,
};

/* A matrix A[n][n], factored, with rows and columns in the order of the pivots. */
struct gauss {
    int n, rank, row[GAUSS_ROOM], column[GAUSS_ROOM];
    double *A;
};

static inline double *gauss_at(const struct gauss *f, int i, int j)
{
    return &f->A[f->row[i] * f->n + f->column[j]];
}

/* Factors A; pivots not above `small` times the first end it. */
static void gauss_factor(int n, double *A, double small, struct gauss *f)
{
    f->n = n;
    f->A = A;
    for (int i = 0; i < n; i++)
        f->row[i] = f->column[i] = i;
    for (f->rank = 0; f->rank < n; f->rank++) {
        const int k = f->rank;
        int p = k, q = k;
        for (int i = k; i < n; i++)
            for (int j = k; j < n; j++)
                if (fabs(*gauss_at(f, i, j)) > fabs(*gauss_at(f, p, q)))
                    p = i, q = j;
        const int row = f->row[p], column = f->column[q];
        f->row[p] = f->row[k], f->row[k] = row;
        f->column[q] = f->column[k], f->column[k] = column;
        if (!(fabs(*gauss_at(f, k, k)) > small * fabs(*gauss_at(f, 0, 0))))
            return;
        for (int i = k + 1; i < n; i++) {
            double *const factor = gauss_at(f, i, k);
            *factor /= *gauss_at(f, k, k);
            for (int j = k + 1; j < n; j++)
                *gauss_at(f, i, j) -= *factor * *gauss_at(f, k, j);
        }
    }
}

/* Adds a solution of A x = b; unknowns that nothing determines are left as they are. */
static void gauss_solve(const struct gauss *f, const double *b, double *x)
{
    double left[GAUSS_ROOM], add[GAUSS_ROOM];
    for (int i = 0; i < f->rank; i++) {
        left[i] = b[f->row[i]];
        for (int k = 0; k < i; k++)
            left[i] -= *gauss_at(f, i, k) * left[k];
    }
    for (int i = f->rank - 1; i >= 0; i--) {
        add[i] = left[i];
        for (int j = i + 1; j < f->rank; j++)
            add[i] -= *gauss_at(f, i, j) * add[j];
        add[i] /= *gauss_at(f, i, i);
        x[f->column[i]] += add[i];
    }
}

/* What column k, beyond the rank, can be exchanged for: n with A n = 0, n of the column 1. */
static void gauss_null(const struct gauss *f, int rank, int k, double *n)
{
    for (int i = 0; i < f->n; i++)
        n[i] = 0;
    n[f->column[k]] = 1;
    for (int i = rank - 1; i >= 0; i--) {
        double sum = -*gauss_at(f, i, k);
        for (int j = i + 1; j < rank; j++)
            sum -= *gauss_at(f, i, j) * n[f->column[j]];
        n[f->column[i]] = sum / *gauss_at(f, i, i);
    }
}

#endif
