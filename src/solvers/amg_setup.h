/* Interpolation from up to 1600 coarse dofs to the particles of cloth and solids: the classical
 * interpolation of algebraic multigrid (Ruge and Stueben 1987), applied level upon level until few
 * C-points are left. */
#ifndef PDYN_AMG_SETUP_H
#define PDYN_AMG_SETUP_H

#include "projdyn/module.h"
#include "sparse.h"

struct amg_interpolation {
    int nodes;                  /* coarse dofs; coupled ones have close indices */
    struct sparse prolongation; /* I: particles x nodes */
    struct sparse restriction;  /* its transpose */
};

/* From model->graph. At most max_nodes, unless more pieces are not connected. Zeroed before.
 * PDYN_NO_MEMORY. */
pdyn_status amg_setup(struct amg_interpolation *out, pdyn_model *model, int max_nodes);
void amg_free(struct amg_interpolation *interpolation);

#endif
