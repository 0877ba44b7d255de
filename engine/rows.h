/* rows.h - small systems of linear equations of any rank, by Hestenes' one-sided Jacobi rotations:
 * turned among each other until they are orthogonal, the rows of A have the singular values as
 * lengths, and A x = b, turned along, is solved row by row. */
#ifndef STANCE_ROWS_H
#define STANCE_ROWS_H

enum { STANCE_ROWS_STRIDE = 128 };

/* Turns the rows of a[rows][STANCE_ROWS_STRIDE] until their first n columns are orthogonal; the
 * others, up to width, turn along. Rows shorter than 1e-9 of the longest become 0 there. Returns
 * the rank, the number of others. */
int stance_rows_turn(int rows, int n, int width, double a[][STANCE_ROWS_STRIDE]);
/* x[n] of least norm with least |A x - b| from the rows (A, b) so turned. */
void stance_rows_solve(int rows, int n, double a[][STANCE_ROWS_STRIDE], double *x);
/* Orthonormal vectors that the rows so turned are orthogonal to: rows of Z. Returns their number.
 */
int stance_rows_null(int rows, int n, double a[][STANCE_ROWS_STRIDE],
                     double Z[][STANCE_ROWS_STRIDE]);

#endif
