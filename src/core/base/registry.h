/* The constraint types and solvers registered with a context, and search by name. */
#ifndef PDYN_REGISTRY_H
#define PDYN_REGISTRY_H

#include "context.h"
#include "projdyn/module.h"

#include <math.h>

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
pdyn_status table_check_constraint(const pdyn_constraint_type *type);
pdyn_status table_check_solver(const pdyn_global_solver *type);

/* The parameters of a scene's root, "solver" and "time_step" (tables in settings.c, offsets into
 * struct scene_settings), each ending with a NULL name. */
extern const pdyn_param settings_solver_params[], settings_time_step_params[],
    settings_general_params[];

/* A table (PDYN_TABLE): what its rows belong to, and the numbers in each row. */
static inline bool param_is_table(const pdyn_param *param) { return param->kind >= PDYN_ROWS; }
static inline int param_width(const pdyn_param *param) { return (int)(param->kind & 0xFF); }

/* The first numbers of a row that are vertices (PDYN_VERTEX_TABLE). */
static inline int param_vertices(const pdyn_param *param) {
    return param_is_table(param) ? (int)(param->kind / PDYN_VERTEX_COLUMN) : 0;
}

/* The path that a parameter is in a struct of parameters; NULL: it is none. */
static inline const pdyn_path *param_path(const pdyn_param *param, const void *params) {
    return param->kind == PDYN_PATH ? (const pdyn_path *)((const char *)params + param->offset)
                                    : NULL;
}

/* The same of the name of another body. */
static inline const pdyn_other *param_other(const pdyn_param *param, const void *params) {
    return param->kind == PDYN_OTHER ? (const pdyn_other *)((const char *)params + param->offset)
                                     : NULL;
}

/* The rows of a table on a body of so many vertices, triangles and tetrahedra; 0: any number. */
static inline int param_rows(const pdyn_param *param, int vertices, int triangles, int tets) {
    unsigned per = param->kind & 0xFF00u;
    return per == PDYN_PER_VERTEX     ? vertices
           : per == PDYN_PER_TRIANGLE ? triangles
           : per == PDYN_PER_TET      ? tets
                                      : 0;
}

/* The numbers that a parameter of numbers has, in each row of a table; 0: another kind. */
static inline int param_numbers(const pdyn_param *param) {
    if (param_is_table(param)) return param_width(param);
    return param->kind == PDYN_REAL ? 1 : param->kind == PDYN_VECTOR ? 3 : 0;
}

/* Whether a parameter of a constraint can change while a simulation runs. */
bool param_is_changeable(const pdyn_constraint_type *type, const pdyn_param *param);

/* Whether a table may contain this number. */
static inline bool param_allows(const pdyn_param *param, double value) {
    return isfinite(value) && value >= param->min && value <= param->max;
}

/* Whether a parameter has a default. A default outside the bounds means: absent unless given. */
static inline bool params_has_default(const pdyn_param *param) {
    return !param->required && (param->kind <= PDYN_VECTOR || param_is_table(param)) &&
           param->def >= param->min && param->def <= param->max;
}

#endif
