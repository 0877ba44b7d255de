/* linear.h - what the tests of the control design share: matrices of a JSON reference, comparison
 * of numbers and of spectra. */
#ifndef STANCE_TESTS_LINEAR_H
#define STANCE_TESTS_LINEAR_H

#include "support.h"

static inline void assert_near(double value, double wanted, double tolerance, const char *what)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%s: %.15g instead of %.15g +- %.3g", what, value, wanted, tolerance);
}

static inline void assert_text(const char *text, const char *wanted)
{
    if (strcmp(text, wanted) != 0)
        fail_msg("message '%s' instead of '%s'", text, wanted);
}

static inline double number_at(const json_t *list, size_t i)
{
    const json_t *item = json_array_get(list, i);
    return json_is_null(item) ? NAN : json_number_value(item);
}

static inline void matrix_of(const json_t *record, const char *key, int rows, int columns,
                             double *x)
{
    const json_t *matrix = json_object_get(record, key);
    assert_int_equal(json_array_size(matrix), rows);
    for (int i = 0; i < rows; i++) {
        const json_t *row = json_array_get(matrix, (size_t)i);
        for (int j = 0; j < columns; j++) {
            x[i * columns + j] =
                json_is_array(row) ? number_at(row, (size_t)j) : number_at(matrix, (size_t)i);
        }
    }
}

/* Six complex numbers of a record. */
static inline void poles_of(const json_t *record, const char *key, double re[6], double im[6])
{
    double pairs[12];
    matrix_of(record, key, 6, 2, pairs);
    for (int i = 0; i < 6; i++)
        re[i] = pairs[2 * i], im[i] = pairs[2 * i + 1];
}

static inline void assert_matrix(int count, const double *x, const double *wanted, double relative,
                                 const char *what)
{
    double scale = 0;
    for (int i = 0; i < count; i++)
        scale = fmax(scale, fabs(wanted[i]));
    for (int i = 0; i < count; i++)
        assert_near(x[i], wanted[i], relative * scale, what);
}

static inline void closed_loop(int n, int m, const double *A, const double *B, const double *K,
                               double *loop)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            loop[i * n + j] = A[i * n + j];
            for (int k = 0; k < m; k++)
                loop[i * n + j] -= B[i * m + k] * K[k * n + j];
        }
    }
}

/* Each wanted eigenvalue is among those of the matrix, each used once. */
static inline void assert_eigenvalues(int n, const double *matrix, const double *re,
                                      const double *im, double tolerance, const char *what)
{
    double got_re[12], got_im[12];
    bool used[12] = {false};
    assert_int_equal(stance_eigenvalues(n, matrix, got_re, got_im), STANCE_OK);
    for (int i = 0; i < n; i++) {
        int best = -1;
        double least = INFINITY;
        for (int j = 0; j < n; j++) {
            const double distance = hypot(got_re[j] - re[i], got_im[j] - im[i]);
            if (!used[j] && distance < least) {
                least = distance;
                best = j;
            }
        }
        used[best] = true;
        if (least > tolerance)
            fail_msg("%s: no eigenvalue within %.3g of %.9g%+.9gi", what, tolerance, re[i], im[i]);
    }
}

static inline stance_equilibrium equilibrium_of(const double *robot, int support, double theta,
                                                double q1, double q2, bool lower)
{
    const stance_equilibrium_choice choice = {1u << support, {theta, q1, q2}, lower};
    stance_equilibrium e;
    stance_message message = {""};
    if (biped()->equilibrium(biped(), robot, &choice, &e, &message) != STANCE_OK)
        fail_msg("%s", message.text);
    return e;
}

#endif
