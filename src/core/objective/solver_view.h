/* What a solver of the library sees beyond module.h: the system behind a model. */
#ifndef PDYN_SOLVER_VIEW_H
#define PDYN_SOLVER_VIEW_H

#include "base/context.h"
#include "hessian_matrix.h"
#include "projdyn/module.h"

struct model {
    pdyn_model view; /* what a solver of a plug-in sees */
    struct objective *objective;
    struct hessian_matrix hessian; /* made when it is asked for first */
    unsigned pattern, values;
};

/* `services` outlive the model. */
void model_create(struct model *model, struct objective *objective, const pdyn_services *services);
void model_free(struct model *model);

static inline struct objective *model_system(pdyn_model *model) {
    return ((struct model *)model)->objective;
}

#endif
