/* The constraint types and solvers registered with a context, and search by name. */
#ifndef PDYN_REGISTRY_H
#define PDYN_REGISTRY_H

#include "context.h"
#include "projdyn/module.h"

/* Largest number of doubles in the data of an element of a constraint with damping. */
enum { DAMPED_DATA_MAX = 512 };

/* Largest number of rows of an element with PDYN_NUMERIC_TANGENT. */
enum { NUMERIC_TANGENT_ROWS = 12 };

/* The constraints and solvers of the library. */
extern const pdyn_plugin registry_builtin;

/* Types without a name in scenes: core makes them for "contact" and for "fluid_friction" of a body.
 */
extern const pdyn_constraint_type pdyn_constraint_contact, pdyn_constraint_contact_damping,
    pdyn_constraint_friction, pdyn_constraint_slip, pdyn_constraint_seepage;

/* The k-th constraint type or solver, in the order of registration; NULL beyond the last. */
const pdyn_constraint_type *registry_constraint_at(const pdyn_context *context, int k);
const pdyn_global_solver *registry_solver_at(const pdyn_context *context, int k);

/* The type with this name; NULL: unknown. */
const pdyn_constraint_type *registry_constraint(const pdyn_context *context, const char *name);
const pdyn_global_solver *registry_solver(const pdyn_context *context, const char *name);

/* The library without which the build leaves out the solver `name`; NULL: there is the solver, or
 * no solver of projdyn has this name. */
const char *registry_absent(const pdyn_context *context, const char *name);

/* The keys of every constraint of a scene beside its parameters; ends with NULL. */
extern const char *const registry_common_keys[];

/* Checks that the table of a type is complete and consistent. PDYN_BAD_INPUT: the error text says
 * what is wrong. */
pdyn_status plugin_check_constraint(const pdyn_constraint_type *type);
pdyn_status plugin_check_solver(const pdyn_global_solver *type);

#endif
