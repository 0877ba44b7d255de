/* poles.c - wanted poles: which are the same, which belong together as a conjugate pair, and
 * whether there is something to place. */
#include "control.h"

#define SAME_POLE 1e-12

bool stance_same_pole(double complex a, double complex b)
{
    return cabs(a - b) <= SAME_POLE * fmax(1, cabs(a));
}

stance_error stance_check_controllable(const stance_plant *plant, stance_message *message)
{
    return stance_check_modes(plant, EVERY_MODE, STANCE_UNCONTROLLABLE,
                              "the pair (A, B) is not controllable: no input reaches", "", message);
}

stance_error stance_pair_poles(int n, const stance_poles *poles, double complex *pole,
                               stance_message *message)
{
    const double *const re = poles->re, *const im = poles->im;
    bool taken[STANCE_PLANT_MOST] = {false};
    int placed = 0;
    for (int j = 0; j < n; j++)
        if (!isfinite(re[j]) || !isfinite(im[j]))
            return stance_refuse(message, STANCE_BAD_POLES,
                                 "%d poles are needed, all of them finite", n);
    for (int j = 0; j < n; j++) {
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
            return stance_refuse(
                message, STANCE_BAD_POLES, "the pole %s has no conjugate %s among the poles",
                stance_complex_text(wanted, text), stance_complex_text(conj(wanted), other));
        }
        taken[k] = true;
        pole[placed - 1] = CMPLX(re[j], fabs(im[j]));
        pole[placed++] = CMPLX(re[j], -fabs(im[j]));
    }
    return STANCE_OK;
}
