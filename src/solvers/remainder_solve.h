/* A^-1 b, where A is the part of H without one-sided constraints: inertia, their damping, rows of
 * elements, and rows that come and go. Particles in no row have a diagonal block that is a multiple
 * of I and are solved exactly: all of them in a fluid alone. Rigid bodies that nothing ties to each
 * other are solved exactly, too. The other particles take conjugate gradients (two_level.h). */
#ifndef PDYN_REMAINDER_SOLVE_H
#define PDYN_REMAINDER_SOLVE_H

#include "two_level.h"

struct remainder_solve {
    pdyn_model *whole; /* H */
    pdyn_model *model; /* A */
    bool coupled;      /* there are rows or rigid bodies: A is not diagonal */
    bool exact;        /* A^-1 takes no iteration now */
    double *mobility;  /* particles, m/N: A^-1 of particles in no row, displacement per force */
    struct two_level two_level; /* if coupled */
};

/* Zeroed before; after a failure it is to be freed, too. */
pdyn_status remainder_solve_create(struct remainder_solve *solve, pdyn_model *whole);
void remainder_solve_free(struct remainder_solve *solve);

/* A has changed. */
void remainder_solve_update(struct remainder_solve *solve, bool first_of_step);

/* y = A^-1 b; b becomes the residual, or stays where the solve is exact. It ends where the residual
 * is `tolerance` of b's, or the error of y in the norm of A `tolerance` of y: the residual of
 * forces that act on a part of a sheet grows at first while the error falls. Not coupled: y may be
 * b. Returns the number of iterations. */
int remainder_solve_apply(struct remainder_solve *solve, double *b, double *y, double tolerance);

#endif
