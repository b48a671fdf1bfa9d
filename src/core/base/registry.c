#include "registry.h"

#include "builtin.h"

#include <string.h>

/* builtin.h: generated lists of X(name); a new file in src/constraints or src/solvers is found by
 * the build, which expects the table `pdyn_constraint_NAME` or `pdyn_solver_NAME` in NAME.c. */
#define DECLARE_CONSTRAINT(name) extern const pdyn_constraint_type pdyn_constraint_##name;
#define DECLARE_SOLVER(name)     extern const pdyn_global_solver pdyn_solver_##name;
#define LIST_CONSTRAINT(name)    &pdyn_constraint_##name,
#define LIST_SOLVER(name)        &pdyn_solver_##name,

BUILTIN_CONSTRAINTS(DECLARE_CONSTRAINT)
BUILTIN_SOLVERS(DECLARE_SOLVER)

static const pdyn_constraint_type *const constraints[] = {BUILTIN_CONSTRAINTS(LIST_CONSTRAINT)
                                                              NULL};
static const pdyn_global_solver *const solvers[] = {BUILTIN_SOLVERS(LIST_SOLVER) NULL};

const pdyn_plugin registry_builtin = {PDYN_ABI, "projdyn", constraints, solvers};

/* ---- looking up ------------------------------------------------------------------------------ */

const pdyn_constraint_type *registry_constraint_at(const pdyn_context *context, int k) {
    for (int p = 0; p < context->plugins; p++) {
        const pdyn_constraint_type *const *t = context->plugin[p]->constraints;
        for (; t && *t; t++)
            if (k-- == 0) return *t;
    }
    return NULL;
}

const pdyn_global_solver *registry_solver_at(const pdyn_context *context, int k) {
    for (int p = 0; p < context->plugins; p++) {
        const pdyn_global_solver *const *t = context->plugin[p]->solvers;
        for (; t && *t; t++)
            if (k-- == 0) return *t;
    }
    return NULL;
}

const pdyn_constraint_type *registry_constraint(const pdyn_context *context, const char *name) {
    const pdyn_constraint_type *type;
    for (int k = 0; (type = registry_constraint_at(context, k)); k++)
        if (!strcmp(type->name, name)) return type;
    return NULL;
}

const pdyn_global_solver *registry_solver(const pdyn_context *context, const char *name) {
    const pdyn_global_solver *type;
    for (int k = 0; (type = registry_solver_at(context, k)); k++)
        if (!strcmp(type->name, name)) return type;
    return NULL;
}

/* ---- registering ----------------------------------------------------------------------------- */

/* Constraints and solvers share their names: `projdyn list NAME` takes either. */
static pdyn_status check_name(pdyn_context *context, const pdyn_plugin *plugin, const char *name) {
    if (!strcmp(name, "auto") || registry_constraint(context, name) ||
        registry_solver(context, name))
        return context_fail(context, PDYN_BAD_INPUT, "plug-in \"%s\": the name \"%s\" is taken",
                            plugin->name, name);
    return PDYN_OK;
}

static pdyn_status check_types(pdyn_context *context, const pdyn_plugin *plugin) {
    pdyn_status status = PDYN_OK;
    const pdyn_constraint_type *const *c = plugin->constraints;
    const pdyn_global_solver *const *s = plugin->solvers;
    for (; c && *c && status == PDYN_OK; c++) {
        status = table_check_constraint(context, *c);
        if (status == PDYN_OK) status = check_name(context, plugin, (*c)->name);
    }
    for (; s && *s && status == PDYN_OK; s++) {
        status = table_check_solver(context, *s);
        if (status == PDYN_OK) status = check_name(context, plugin, (*s)->name);
    }
    return status;
}

pdyn_status pdyn_register(pdyn_context *context, const pdyn_plugin *plugin) {
    if (!context || !plugin) return PDYN_BAD_CALL;
    for (int p = 0; p < context->plugins; p++)
        if (context->plugin[p] == plugin) return PDYN_OK;
    if (plugin->abi != PDYN_ABI)
        return context_fail(context, PDYN_BAD_INPUT,
                            "the plug-in was built for abi %u, expected abi %u: build it again "
                            "with the headers of projdyn %s",
                            plugin->abi, PDYN_ABI, pdyn_version());
    if (!plugin->name || !*plugin->name)
        return context_fail(context, PDYN_BAD_INPUT, "the plug-in has no name");
    if (context->plugins == MOST_PLUGINS)
        return context_fail(context, PDYN_BAD_INPUT, "expected at most %d plug-ins, found one more",
                            MOST_PLUGINS - 1);
    pdyn_status status = check_types(context, plugin);
    if (status == PDYN_OK) context->plugin[context->plugins++] = plugin;
    return status;
}
