/* The Cholesky factor of a sparse symmetric positive definite matrix, by CHOLMOD (Chen, Davis,
 * Hager, Rajamanickam 2008). */
#ifndef PDYN_CHOLMOD_FACTOR_H
#define PDYN_CHOLMOD_FACTOR_H

#include "projdyn/module.h"

#include <suitesparse/cholmod.h>

struct factor {
    const pdyn_services *services;
    cholmod_common common;
    cholmod_factor *analysed, *factor;              /* the layout that was found; with numbers */
    cholmod_dense *rhs, *solution, *work, *scratch; /* kept, so that a solve allocates nothing */
    int dim, size;                                  /* of the matrix */
};

void factor_start(struct factor *factor, const pdyn_services *services);
void factor_end(struct factor *factor); /* zeroed is fine */

/* Finds an ordering and the pattern of the factor. lasting: the pattern stays, so a better ordering
 * that takes longer to find pays. PDYN_NO_MEMORY, PDYN_SOLVER_FAILED. */
pdyn_status factor_analyse(struct factor *factor, const pdyn_matrix *matrix, bool lasting);
/* The factor of a matrix of the analysed pattern. PDYN_SOLVER_FAILED: it is not positive definite.
 */
pdyn_status factor_compute(struct factor *factor, const pdyn_matrix *matrix);
/* y = A^-1 b, both particles x 3; a matrix of dim 1 is the same for x, y and z. */
pdyn_status factor_solve(struct factor *factor, const double *b, double *y);

#endif
