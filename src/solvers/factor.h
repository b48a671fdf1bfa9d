/* A sparse Cholesky factor of a matrix (assembly.h), by CHOLMOD. Where x, y and z do not couple, it
 * is solved with by panels.h. */
#ifndef PDYN_FACTOR_H
#define PDYN_FACTOR_H

#include "objective/assembly.h"
#include "panels.h"

#include <suitesparse/cholmod.h>

struct factor {
    pdyn_context *context;
    int unknowns; /* 3 particles where these couple, else particles */
    bool coupled;
    cholmod_common common;
    cholmod_factor *factor; /* its numbers are in the panels, unless coupled */
    struct panels panels;
    cholmod_dense *solution, *work, *scratch; /* coupled */
};

void factor_start(struct factor *factor, pdyn_context *context);
void factor_free(struct factor *factor); /* zeroed or started */

/* Chooses the order of the unknowns by the pattern. `lasting`: it will be solved with often, so a
 * small factor is worth looking for. */
pdyn_status factor_analyse(struct factor *factor, const struct matrix *matrix, bool lasting);
/* Takes the numbers of a matrix of that pattern. */
pdyn_status factor_numbers(struct factor *factor, const struct matrix *matrix);
/* y = A^-1 b, particles x 3 both */
pdyn_status factor_solve(struct factor *factor, const double *b, double *y);

#endif
