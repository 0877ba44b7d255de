/* unreached.h - directions of a linear system x' = A x + B u that no input moves and that do not
 * decay of themselves (eigenvalues with a real part of 0 or more): states that have a part in them
 * no input brings back. */
#ifndef STANCE_CONTROL_UNREACHED_H
#define STANCE_CONTROL_UNREACHED_H

#include "control.h"

struct unreached {
    int n, count; /* states, directions */
    double scale[STANCE_PLANT_MOST];
    double row[STANCE_PLANT_MOST * STANCE_PLANT_MOST]; /* [count][n]: a part of x is the sum over j
                                                        * of row[j] scale[j] x[j] */
    double re[STANCE_PLANT_MOST], im[STANCE_PLANT_MOST]; /* eigenvalues, of pairs both */
    /* The states without such a part, if there are any: y = rest x, [n - count][n], with
     * y' = A y + ... [n - count][n - count] */
    double rest[STANCE_PLANT_MOST * STANCE_PLANT_MOST], A[STANCE_PLANT_MOST * STANCE_PLANT_MOST];
};

/* How far rounding may move an eigenvalue of a matrix with this norm, s the reciprocal condition
 * number that LAPACK gives it (1: well apart; 0: two have become one). */
static inline double rounding_of_eigenvalue(double norm, double s)
{
    const double exact = 1e-12, most = 1e-5;
    return norm * (s > exact / most ? exact / s : most);
}

stance_error stance_unreached_find(const stance_plant *plant, struct unreached *out);

/* Whether x[n] has a part in them, beyond rounding. */
bool stance_unreached_has(const struct unreached *out, const double *x);

#endif
