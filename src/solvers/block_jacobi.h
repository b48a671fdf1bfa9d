/* Block Jacobi preconditioner: the inverse of the 3 x 3 block diagonal of H. */
#ifndef PDYN_BLOCK_JACOBI_H
#define PDYN_BLOCK_JACOBI_H

#include "projdyn/module.h"

struct block_jacobi {
    pdyn_model *model;
    double *inverse; /* particles x 6: symmetric blocks, packed xx xy xz yy yz zz */
};

pdyn_status block_jacobi_create(struct block_jacobi *jacobi, pdyn_model *model);
void block_jacobi_free(struct block_jacobi *jacobi); /* zeroed is fine */

/* Takes the blocks from H. Call it when H has changed. */
void block_jacobi_update(struct block_jacobi *jacobi);

/* z = D^-1 r; of a rigid body, the inverse of its whole part of H times r */
void block_jacobi_apply(const struct block_jacobi *jacobi, const double *r, double *z);

#endif
