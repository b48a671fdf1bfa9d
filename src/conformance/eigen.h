/* Eigenvalues and eigenvectors of a small symmetric matrix by Jacobi's rotations (Golub and Van
 * Loan, Matrix Computations, section 8.5). */
#ifndef PDYN_EIGEN_H
#define PDYN_EIGEN_H

/* A: n x n, is left diagonal; the k-th eigenvector is column k of `vector`, n x n. */
void eigen_symmetric(double *A, int n, double *value, double *vector);

#endif
