/* Parameters that a constraint type computes from others and from the scene
 * (pdyn_constraint_type.resolve). A copy of the parameters as they were given is kept: `resolve`
 * starts from it each time one of them changes. */
#ifndef PDYN_DERIVED_H
#define PDYN_DERIVED_H

#include "scene.h"

/* Keeps what `resolve` of this constraint reads. Does nothing for a type without `resolve`. */
pdyn_status derived_create(pdyn_context *context, const struct scene *scene,
                           const struct scene_body *body, struct scene_constraint *constraint);
/* Computes `params` anew from the parameters as they were given. */
pdyn_param_fault derived_compute(const struct scene_constraint *constraint);
void derived_free(pdyn_context *context, struct scene_constraint *constraint);

/* The parameters as they were given: what to change before derived_compute. */
static inline void *derived_given(const struct scene_constraint *constraint) {
    return constraint->given ? constraint->given : constraint->params;
}

#endif
