/* poles.c - wanted poles: which are the same, which belong together as a conjugate pair, and
 * whether there is something to place. */
#include "control.h"

#define SAME_POLE 1e-12

bool stance_same_pole(double complex a, double complex b)
{
    return cabs(a - b) <= SAME_POLE * fmax(1, cabs(a));
}

stance_error stance_check_plant(int n, int m, const double *A, const double *B,
                                stance_message *message)
{
    if (n < 1 || m < 1)
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "pole placement needs at least one state and one input");
    if (!matrix_finite((size_t)n * (size_t)n, A) || !matrix_finite((size_t)n * (size_t)m, B))
        return stance_refuse(message, STANCE_BAD_ARGUMENT, "A and B must be finite");
    return STANCE_OK;
}

stance_error stance_check_controllable(int n, int m, const double *A, const double *B,
                                       stance_message *message)
{
    double complex mode = 0;
    bool reached = true;
    char text[64];
    const stance_error error = stance_hautus(n, m, A, B, EVERY_MODE, &mode, &reached);
    if (error != STANCE_OK || reached)
        return error;
    return stance_refuse(message, STANCE_UNCONTROLLABLE,
                         "the pair (A, B) is not controllable: no input reaches the mode with "
                         "eigenvalue %s",
                         stance_complex_text(mode, text));
}

stance_error stance_pair_poles(int n, const double *re, const double *im, double complex *pole,
                               stance_message *message)
{
    bool *taken = calloc((size_t)n, sizeof *taken);
    stance_error error = taken ? STANCE_OK : STANCE_NO_MEMORY;
    int placed = 0;

    for (int j = 0; j < n && error == STANCE_OK; j++) {
        if (!isfinite(re[j]) || !isfinite(im[j])) {
            error = stance_refuse(message, STANCE_BAD_POLES,
                                  "%d poles are needed, all of them finite", n);
        }
    }
    for (int j = 0; j < n && error == STANCE_OK; j++) {
        if (taken[j])
            continue;
        const double complex wanted = CMPLX(re[j], im[j]);
        pole[placed++] = wanted;
        if (im[j] == 0)
            continue;
        int k = j + 1;
        while (k < n && (taken[k] || !stance_same_pole(CMPLX(re[k], im[k]), conj(wanted))))
            k++;
        if (k == n) {
            char text[64], other[64];
            error = stance_refuse(
                message, STANCE_BAD_POLES, "the pole %s has no conjugate %s among the poles",
                stance_complex_text(wanted, text), stance_complex_text(conj(wanted), other));
            break;
        }
        taken[k] = true;
        pole[placed - 1] = CMPLX(re[j], fabs(im[j]));
        pole[placed++] = CMPLX(re[j], -fabs(im[j]));
    }
    free(taken);
    return error;
}
