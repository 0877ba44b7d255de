/* poles.c - wanted poles: which are the same, which belong together as a conjugate pair. */
#include "control.h"

#define SAME_POLE 1e-12

bool stance_same_pole(double complex a, double complex b)
{
    return cabs(a - b) <= SAME_POLE * fmax(1, cabs(a));
}

static stance_error unpaired(stance_message *message, double complex pole)
{
    char text[64], conjugate[64];
    return stance_refuse(
        message, STANCE_BAD_POLES, "the pole %s has no conjugate %s among the poles",
        stance_complex_text(pole, text), stance_complex_text(conj(pole), conjugate));
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
            error = unpaired(message, wanted);
            break;
        }
        taken[k] = true;
        pole[placed - 1] = CMPLX(re[j], fabs(im[j]));
        pole[placed++] = CMPLX(re[j], -fabs(im[j]));
    }
    free(taken);
    return error;
}
