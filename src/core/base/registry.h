/* The constraint types and solvers that a context knows, and looking them up by name. */
#ifndef PDYN_REGISTRY_H
#define PDYN_REGISTRY_H

#include "context.h"
#include "projdyn/module.h"

/* What the library brings along. */
extern const pdyn_plugin registry_builtin;

/* Not by name: core makes these of the scene's "contact" and of "fluid_friction" of a body. */
extern const pdyn_constraint_type pdyn_constraint_contact, pdyn_constraint_friction,
    pdyn_constraint_slip;

/* The k-th of all, in the order in which they are listed; NULL beyond the last. */
const pdyn_constraint_type *registry_constraint_at(const pdyn_context *context, int k);
const pdyn_global_solver *registry_solver_at(const pdyn_context *context, int k);

/* NULL: unknown */
const pdyn_constraint_type *registry_constraint(const pdyn_context *context, const char *name);
const pdyn_global_solver *registry_solver(const pdyn_context *context, const char *name);

/* Whether the table of a type can be worked with: PDYN_BAD_INPUT with what is wrong. */
pdyn_status table_check_constraint(pdyn_context *context, const pdyn_constraint_type *type);
pdyn_status table_check_solver(pdyn_context *context, const pdyn_global_solver *type);

/* The parameters that every scene's "solver" and "time_step" object knows (tables in settings.c,
 * offsets into struct scene_settings), ending with a name of NULL. */
extern const pdyn_param settings_solver_params[], settings_time_step_params[],
    settings_general_params[];

/* Closest of `count` names to `name`, or NULL when none is near. */
const char *registry_near_miss(const char *name, const char *const *names, int count);

/* A default outside the bounds stands for "none": the parameter is absent unless it is given. */
static inline bool params_has_default(const pdyn_param *param) {
    return !param->required && param->kind <= PDYN_VECTOR && param->def >= param->min &&
           param->def <= param->max;
}

#endif
