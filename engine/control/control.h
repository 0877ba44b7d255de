/* control.h - what the files of the control design share: messages and small matrices.
 *
 * Matrices are row-major here as everywhere. LAPACK and SLICOT read the same memory as the
 * transpose, which costs nothing where a function commutes with transposition (eigenvalues,
 * singular values, the exponential).
 */
#ifndef STANCE_CONTROL_CONTROL_H
#define STANCE_CONTROL_CONTROL_H

#include "design.h"

#include "engine/matrix.h"
#include "engine/refuse.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

/* A complex number as people write it: no part that is nothing but rounding. */
const char *stance_complex_text(double _Complex number, char text[64]);

/* Equal but for rounding. */
bool stance_same_pole(double _Complex a, double _Complex b);

/* What the public functions ask of a plant: BAD_ARGUMENT. */
stance_error stance_check_plant(const stance_plant *plant, stance_message *message);

/* What every pole assignment asks: puts the poles in an order in which a pair stands in two places
 * in a row, the one with im > 0 first. BAD_POLES when one is not finite or lacks its conjugate. */
stance_error stance_pair_poles(int n, const stance_poles *poles, double _Complex *pole,
                               stance_message *message);
/* ... and that inputs reach every mode, else UNCONTROLLABLE. */
stance_error stance_check_controllable(const stance_plant *plant, stance_message *message);

/* A plant and the poles wanted of it. */
typedef struct placement {
    const stance_plant *plant;
    const stance_poles *poles;
} placement;

/* The methods of stance_place, at T = 0. Robust: `near` may be NULL, or a neighbour with its poles
 * in the same order: of the maxima of the conditioning the one that continues its solution, where
 * that leads somewhere. */
stance_error stance_place_robust(const placement *wanted, const placement *near, double *K,
                                 stance_robustness *robustness, stance_message *message);
stance_error stance_place_schur(const placement *wanted, double *K, stance_message *message);

/* The eigenvalues of A that a Hautus test looks at: all, those with real part >= 0, those of
 * modulus >= 1. */
enum mode_filter { EVERY_MODE, GROWING_MODES, EXPANDING_MODES };

/* Hautus: (A - s I, B) has full rank for every eigenvalue s of A that passes the filter, else the
 * error `code`: "BEFORE the mode with eigenvalue sAFTER". */
stance_error stance_check_modes(const stance_plant *plant, enum mode_filter filter,
                                stance_error code, const char *before, const char *after,
                                stance_message *message);

/* Whether x' = A x, or (sampled) x+ = A x, comes to rest; else *lasts is an eigenvalue that keeps
 * it from that. */
stance_error stance_is_stable(int n, const double *A, bool sampled, bool *stable,
                              double _Complex *lasts);

/* B[n][m] = U S V^T: its rank, U[n][n] by columns, the first `rank` of which span its range and,
 * unless NULL, V S^-1, [m][rank]. */
stance_error stance_input_range(int n, int m, const double *B, double *U, double *pseudo,
                                int *rank);

/* X of F' X + X F = C, or (discrete) F' X F - X = C; C symmetric, X may be C. n <=
 * STANCE_PLANT_MOST.
 */
stance_error stance_solve_lyapunov(int n, const double *F, bool discrete, const double *C,
                                   double *X);

/* E = exp(A T) and, unless NULL, integral = that of exp(A t) over 0 ... T; all [n][n], n <=
 * STANCE_LOOP_MOST. */
stance_error stance_exponential(int n, const double *A, double T, double *E, double *integral);

#endif
