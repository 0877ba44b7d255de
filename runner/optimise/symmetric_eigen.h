/* symmetric_eigen.h - eigenvalues and eigenvectors of a small symmetric matrix.
 *
 * Jacobi's method, cyclic by rows (Golub, Van Loan, Matrix Computations, 8.5): rotations in a fixed
 * order, each makes one element off the diagonal zero, until all of them are negligible beside
 * their diagonal elements. So small eigenvalues of a positive definite matrix that is badly scaled
 * are accurate, too (Demmel, Veselic, SIAM J. Matrix Anal. Appl. 13, 1992). No library, no sum
 * whose order a compiler chooses: the same bits everywhere.
 */
#ifndef STANCE_OPTIMISE_SYMMETRIC_EIGEN_H
#define STANCE_OPTIMISE_SYMMETRIC_EIGEN_H

/* a[n][n], symmetric and finite, is overwritten. Row k of vector[n][n] is the eigenvector of length
 * 1 that belongs to value[k]; ascending. Signs follow no rule. n >= 1; n = 64 takes some
 * ms. */
void symmetric_eigen(int n, double *a, double *value, double *vector);

#endif
