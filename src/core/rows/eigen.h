/* Eigenvalues and eigenvectors of a small symmetric matrix by Jacobi rotations (Golub and Van Loan,
 * Matrix Computations, section 8.5). */
#ifndef PDYN_EIGEN_H
#define PDYN_EIGEN_H

/* A: n x n, becomes diagonal. value: n. vector: n x n, column k is the eigenvector of value[k]. */
void eigen_symmetric(double *A, int n, double *value, double *vector);

#endif
