/* A^-1 r, where A is the part of H without one-sided constraints: inertia, rows of elements, and
 * rows that come and go. Particles in no row have a diagonal block that is a multiple of I: they
 * are solved exactly. The others take conjugate gradients with a two-level preconditioner (block
 * Jacobi and the coarse space). */
#ifndef PDYN_REST_SOLVE_H
#define PDYN_REST_SOLVE_H

#include "block_jacobi.h"
#include "coarse_space.h"
#include "pcg.h"

struct rest_solve {
    pdyn_model *model; /* A */
    struct pcg pcg;
    struct block_jacobi jacobi;
    struct coarse_space coarse;
};

/* model: `rest` of a model. Zeroed before; after a failure it is to be freed, too. */
pdyn_status rest_solve_create(struct rest_solve *solve, pdyn_model *model);
void rest_solve_free(struct rest_solve *solve);

/* A has changed. */
void rest_solve_update(struct rest_solve *solve, bool first_of_step);

/* y = A^-1 b, to a residual of rel_tol of b's. b becomes the residual. Returns the number of
 * iterations. */
int rest_solve_apply(struct rest_solve *solve, double *b, double *y, double rel_tol);

#endif
