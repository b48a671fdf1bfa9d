/* What a solver sees of the objective: pdyn_model of module.h. */
#ifndef PDYN_SOLVER_VIEW_H
#define PDYN_SOLVER_VIEW_H

#include "hessian_matrix.h"
#include "projdyn/module.h"

struct solver_view {
    pdyn_model model; /* first: callbacks get its address */
    struct objective *objective;
    struct solver_view *remainder; /* the model without one-sided constraints */
    bool *in_rows;                 /* particles */
    int first, last;               /* the particles first to before last concern a solve */
    struct hessian_matrix hessian; /* created when H is asked for first */
    struct matrix graph;
    unsigned pattern, values; /* counters of the hessian's changes */
};

/* All constraints of the objective exist, and `services` outlive the view. newton: the scene asks
 * for the newton step. PDYN_NO_MEMORY. */
pdyn_status solver_view_create(struct solver_view *view, struct objective *objective, bool newton,
                               const pdyn_services *services);
void solver_view_free(struct solver_view *view); /* zeroed is fine */

/* Linearises the objective at the x of the last local step, with a damping eps, for the solver. */
pdyn_status solver_view_linearise(struct solver_view *view, double eps);

#endif
