/* pdyn_conformance: runs the checks of each constraint type on each kind of body it may have, and
 * of each solver. */
#include "conformance.h"

#include "base/bad_call.h"
#include "base/param_kind.h"

/* Each check gets a trial of its own, so that faults do not affect later checks. The other checks
 * need callbacks that write only where they may: without, they are skipped. */
static void check_strain(struct check *check) {
    static check_fn *const checks[] = {
        check_callbacks, check_state,        check_activity, check_projection, check_closest,
        check_one_side,  check_tangent,      check_gradient, check_work,       check_momentum,
        check_bounds,    check_damping_rest, check_diagonal, check_stiffness,  check_tiers,
        check_operator,  check_model};
    for (size_t k = 0; k < sizeof checks / sizeof *checks; k++) {
        struct trial trial;
        if (!trial_start(&trial, check, check->type, "auto")) return;
        checks[k](check, &trial);
        trial_finish(&trial, check);
        if (k == 0 && check->faults) return;
    }
}

/* Solvers solve in the first state in which elements pull. */
static void check_type_on(struct check *check) {
    enum strain acting = COMPRESSED;
    check->active = check->found = 0;
    for (int k = 0; k < STRAINS && !check->faults; k++) {
        check->strain = (enum strain)k;
        if (!check->active) acting = check->strain;
        check_strain(check);
    }
    check->strain = acting;
    if (check->faults) return;
    if (check->form.exchanged && !check->active) return; /* a parameter may switch the type off */
    if (!check->found)
        fault(check, "not exercised: update gives no element in any trial; %s",
              type_ties_to_other(check->type)
                  ? "the other body is a sheet 0.3 m above this one: check it with other defaults "
                    "of its parameters, such as a larger distance"
                  : "trials have no contacts and no wet sides");
    else if (!check->active)
        fault(check, "not exercised: no element pulls in any trial, compressed, stretched, "
                     "sheared or crumpled; check it with other defaults of its parameters, such "
                     "as a smaller limit");
    check_solvers(check);
    if (!check->faults) check_steps(check);
}

/* A body of particles has no vertices to choose from. */
static bool has_vertices(struct check *check) {
    for (const pdyn_param *p = check->type->params; p->name; p++) {
        if (p->kind != PDYN_VERTICES || !p->required) continue;
        fault(check,
              "parameter \"%s\" chooses vertices, which a body of particles lacks: say "
              "PDYN_ON_SURFACE",
              p->name);
        return false;
    }
    return true;
}

/* Whether the number of rows of a required table is that of its form. */
static bool has_free_rows(const struct check *check) {
    for (const pdyn_param *p = check->type->params; p->name && check->kind != PARTICLES; p++)
        if (param_is_table(p) && p->required && !param_vertices(p) && !param_rows(p, 1, 1, 1))
            return true;
    return false;
}

/* Checks the type with all forms of its parameters; a scene may refuse some of them. */
static void check_forms(struct check *check) {
    int bools = type_bools(check->type), forms = bools > 1 ? bools + 2 : bools + 1, accepted = 0;
    for (int many = 0; many <= has_free_rows(check); many++)
        for (int k = 0; k < forms && !check->faults; k++) {
            check->form = (struct form){k, many};
            if (trial_is_refused(check)) continue;
            accepted++;
            check_type_on(check);
        }
    check->form = (struct form){0};
    if (!accepted) check_type_on(check); /* which says why */
}

static void check_type(struct check *check) {
    static const unsigned excludes[BODY_KINDS] = {[SURFACE] = PDYN_ON_PARTICLES | PDYN_ON_VOLUME |
                                                              PDYN_ON_CLOSED,
                                                  [PARTICLES] = PDYN_ON_SURFACE | PDYN_ON_VOLUME,
                                                  [VOLUME] = PDYN_ON_PARTICLES};
    for (int kind = 0; kind < BODY_KINDS && !check->faults; kind++) {
        check->kind = (enum body_kind)kind;
        if (check->type->flags & excludes[kind]) continue;
        if (kind == PARTICLES && !has_vertices(check)) continue;
        check_forms(check);
    }
}

static void check_one(struct check *check, const pdyn_constraint_type *type,
                      const pdyn_global_solver *solver) {
    struct check one = *check;
    one.type = type, one.solver = solver, one.faults = 0;
    if (type) check_type(&one);
    else check_solver(&one);
    check->faults += one.faults;
}

static void check_plugin(struct check *check, const pdyn_plugin *plugin) {
    const pdyn_constraint_type *const *c = plugin->constraints;
    const pdyn_global_solver *const *s = plugin->solvers;
    for (; c && *c; c++) check_one(check, *c, NULL);
    for (; s && *s; s++) check_one(check, NULL, *s);
}

pdyn_status pdyn_conformance(pdyn_context *context, const char *name,
                             void (*tell)(void *user, const char *text), void *user, int *faults) {
    if (HAS_NULL(context, faults)) return PDYN_BAD_CALL;
    struct check check = {.like = context, .tell = tell, .user = user};
    const pdyn_constraint_type *type = name ? registry_constraint(context, name) : NULL;
    const pdyn_global_solver *solver = name ? registry_solver(context, name) : NULL;
    if (name && !type && !solver)
        return set_error(PDYN_BAD_INPUT, "no constraint and no solver \"%.64s\"", name);
    if (name) check_one(&check, type, solver);
    for (int p = 1; !name && p < context->plugins; p++) check_plugin(&check, context->plugin[p]);
    *faults = check.faults;
    return PDYN_OK;
}
