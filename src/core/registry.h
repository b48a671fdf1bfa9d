/* The registered constraint types and solvers, and looking them up by name. */
#ifndef PDYN_REGISTRY_H
#define PDYN_REGISTRY_H

#include "projdyn/module.h"
#include "solver.h"

/* Arrays that end with NULL, in the order in which they are listed. */
const pdyn_constraint_type *const *registry_constraints(void);
const struct solver_type *const *registry_solvers(void);

const pdyn_constraint_type *registry_constraint(const char *name); /* NULL: unknown */
const struct solver_type *registry_solver(const char *name);       /* NULL: unknown */

/* The parameters that every scene's "solver" and "time_step" object knows (tables in settings.c,
 * offsets into struct scene_settings), ending with a name of NULL. */
extern const pdyn_param settings_solver_params[], settings_time_step_params[],
    settings_general_params[];

/* Closest of `count` names to `name`, or NULL when none is near. */
const char *registry_near_miss(const char *name, const char *const *names, int count);

#endif
