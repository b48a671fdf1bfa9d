/* What a global solver sees: the linear system (M/h^2 + sum of the constraints) y = b of one
 * iteration, and the table that it fills. */
#ifndef PDYN_SOLVER_H
#define PDYN_SOLVER_H

#include "context.h"

struct system;

struct solver_type {
    const char *name, *summary;
    bool direct; /* factors a matrix: costs a factorisation where the constraints change every step
                  */
    size_t state_size; /* zeroed before create */
    /* Refer to the system from now on. */
    pdyn_status (*create)(void *self, pdyn_context *context, struct system *system);
    /* Solves H y = b until |b - H y| <= tolerance |b| or the cap; a direct solver needs neither.
     * y: particles x 3, zero on entry; b: particles x 3; *iterations: 1 for a direct solver. */
    pdyn_status (*solve)(void *self, const double *b, double *y, double tolerance,
                         int max_iterations, int *iterations);
    void (*free)(void *self);
};

#endif
