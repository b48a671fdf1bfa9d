/* The reference for solvers: H as a dense matrix, and the solution of H y = b with it. */
#ifndef PDYN_DENSE_H
#define PDYN_DENSE_H

#include "projdyn/module.h"

/* H: n x n for n = 3 particles, row k the product of H with unit vector k. unit: room for a vector.
 */
void dense_hessian(pdyn_model *model, double *H, double *unit);

/* y = H^-1 y by a Cholesky factorisation (Golub and Van Loan, Matrix Computations, section 4.2),
 * which replaces the lower triangle of H. false: H is not positive definite. */
bool dense_solve(double *H, int n, double *y);

/* The largest difference between the assembled matrix of the model and H, over the largest entry of
 * H. Negative: the matrix could not be assembled. */
double dense_matrix_error(pdyn_model *model, const double *H);

#endif
