#include "registry.h"

#include "builtin.h"

#include <string.h>

/* builtin.h: generated lists of X(name); a new file in src/constraints or src/solvers is found by
 * the build, which expects the table `pdyn_constraint_NAME` or `pdyn_solver_NAME` in NAME.c. */
#define DECLARE_CONSTRAINT(name) extern const pdyn_constraint_type pdyn_constraint_##name;
#define DECLARE_SOLVER(name)     extern const struct solver_type pdyn_solver_##name;
#define LIST_CONSTRAINT(name)    &pdyn_constraint_##name,
#define LIST_SOLVER(name)        &pdyn_solver_##name,

BUILTIN_CONSTRAINTS(DECLARE_CONSTRAINT)
BUILTIN_SOLVERS(DECLARE_SOLVER)

static const pdyn_constraint_type *const constraints[] = {BUILTIN_CONSTRAINTS(LIST_CONSTRAINT)
                                                              NULL};
static const struct solver_type *const solvers[] = {BUILTIN_SOLVERS(LIST_SOLVER) NULL};

const pdyn_constraint_type *const *registry_constraints(void) { return constraints; }
const struct solver_type *const *registry_solvers(void) { return solvers; }

const pdyn_constraint_type *registry_constraint(const char *name) {
    for (int i = 0; constraints[i]; i++)
        if (!strcmp(constraints[i]->name, name)) return constraints[i];
    return NULL;
}

const struct solver_type *registry_solver(const char *name) {
    for (int i = 0; solvers[i]; i++)
        if (!strcmp(solvers[i]->name, name)) return solvers[i];
    return NULL;
}
