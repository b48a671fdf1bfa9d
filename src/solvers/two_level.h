/* Conjugate gradients for H y = b with a two-level preconditioner,
 *
 *     P^-1 = D^-1 + I A^-1 I'
 *
 * D: block diagonal of H; A = I' H I on a coarse space of up to 1600 nodes on cloth and solids
 * (coarse_space.h), which carries the slow motions that block Jacobi cannot see. */
#ifndef PDYN_TWO_LEVEL_H
#define PDYN_TWO_LEVEL_H

#include "block_jacobi.h"
#include "coarse_space.h"
#include "pcg.h"

struct two_level {
    struct pcg pcg; /* pcg_solve with this solves H y = b */
    struct block_jacobi jacobi;
    struct coarse_space coarse;
};

/* Zeroed before; after a failure it is to be freed, too. PDYN_NO_MEMORY. */
pdyn_status two_level_create(struct two_level *two_level, pdyn_model *model);
void two_level_free(struct two_level *two_level);

/* H has changed. */
void two_level_update(struct two_level *two_level, bool first_of_step);

#endif
