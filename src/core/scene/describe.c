/* pdyn_describe: constraints, solvers and boundary models as text for users. */
#include "base/bad_call.h"
#include "base/context.h"
#include "base/registry.h"
#include "base/text.h"
#include "choices.h"
#include "hint.h"
#include "keyed.h"
#include "params.h"
#include "table.h"

#include <stdio.h>

enum { NAMES = 128, LINE = 512 };

struct sink {
    void (*write)(void *user, const char *text);
    void *user;
};

static void line(const struct sink *to, const char *format, ...) PDYN_PRINTF(2, 3);
static void line(const struct sink *to, const char *format, ...) {
    char text[LINE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    to->write(to->user, text);
}

static void row(const struct sink *to, const char *name, const char *unit, const char *def,
                const char *value, const char *doc) {
    line(to, "  %-22s %-6s %-10s %-36s ", name, unit, def, value);
    to->write(to->user, doc), to->write(to->user, "\n");
}

static void heading(const struct sink *to, const char *kind, const char *name,
                    const char *summary) {
    line(to, "%s %s: ", kind, name);
    to->write(to->user, summary), to->write(to->user, "\n\n");
    row(to, "parameter", "unit", "default", "value", "meaning");
}

/* Appends e.g. "3 numbers from 0 to 1 per tetrahedron", "2 vertices, number from 0 to 1 per row".
 */
static void describe_table(char *text, size_t size, const pdyn_param *p) {
    char row[32] = "number";
    int vertices = param_vertices(p), numbers = param_width(p) - vertices;
    if (vertices) text_append(text, size, vertices == 1 ? "vertex" : "%d vertices", vertices);
    if (vertices && numbers) text_append(text, size, ", ");
    if (numbers > 1) snprintf(row, sizeof row, "%d numbers", numbers);
    if (numbers) params_describe_bounds(text, size, row, p->min, p->max, "");
    text_append(text, size, " per %s", table_part(p) ? table_part(p) : "row");
}

static void table(const struct sink *to, const pdyn_param *params) {
    static const char *const kinds[] = {[PDYN_REAL] = "number",
                                        [PDYN_INT] = "whole number",
                                        [PDYN_BOOL] = "true or false",
                                        [PDYN_VECTOR] = "3 numbers",
                                        [PDYN_VERTICES] = "choice of vertices",
                                        [PDYN_PATH] = "[[time, x, y, z], ...]",
                                        [PDYN_OTHER] = "name of another body"};
    for (const pdyn_param *p = params; p->name; p++) {
        char def[64] = "", value[128] = "";
        if (p->required) text_append(def, sizeof def, "required");
        else if (!param_has_default(p)) text_append(def, sizeof def, "none");
        else if (p->kind == PDYN_BOOL)
            text_append(def, sizeof def, p->def != 0.0 ? "true" : "false");
        else text_append(def, sizeof def, "%.6g", p->def);
        if (param_is_table(p)) describe_table(value, sizeof value, p);
        else if (p->kind == PDYN_BOOL || p->kind > PDYN_VECTOR)
            text_append(value, sizeof value, "%s", kinds[p->kind]);
        else params_describe_bounds(value, sizeof value, kinds[p->kind], p->min, p->max, "");
        row(to, p->name, p->unit, def, value, p->doc);
    }
}

static void describe_choices(const struct sink *to, const char *title,
                             const struct choices *choices) {
    line(to, "\n%s\n", title);
    for (int k = 0; k < choices->count; k++)
        line(to, "  %-16s %s\n", choices_text(choices, k, 0), choices_text(choices, k, 1));
}

static void describe_all(const pdyn_context *context, const struct sink *to) {
    const pdyn_constraint_type *constraint;
    const pdyn_global_solver *solver;
    line(to, "constraints\n");
    for (int k = 0; (constraint = registry_constraint_at(context, k)); k++)
        line(to, "  %-16s %s\n", constraint->name, constraint->summary);
    line(to, "\nsolvers\n");
    for (int k = 0; (solver = registry_solver_at(context, k)); k++)
        line(to, "  %-16s %s\n", solver->name, solver->summary);
    describe_choices(to, "boundary models, \"boundary\" of a scene", &boundary_choices);
    describe_choices(to, "kernels of fluids, \"kernel\" of a scene", &kernel_choices);
}

static void alternatives(const struct sink *to, const char *const *names) {
    if (!names || !*names) return;
    line(to, "\na scene gives at most one of: %s", *names);
    while (*++names) line(to, ", %s", *names);
    line(to, "\n");
}

static void describe_keys(const struct sink *to, const pdyn_constraint_type *type) {
    const char *before = "\nmay have keys, [{\"time\": s, \"NAME\": value}, ...]: ";
    for (const pdyn_param *p = type->params; p->name; p++) {
        if (!keyed_allowed(type, p)) continue;
        line(to, "%s%s", before, p->name);
        before = ", ";
    }
    if (*before == ',') line(to, "\n");
}

static void describe_constraint(const struct sink *to, const pdyn_constraint_type *type) {
    heading(to, "constraint", type->name, type->summary);
    table(to, type->params);
    alternatives(to, type->alternatives);
    describe_keys(to, type);
    if (!type->matrix_free)
        line(to, "\n\"from\" and \"until\" (s) limit the time in which it acts\n");
    if (type->flags & PDYN_ON_SURFACE) line(to, "\nworks on a body with a surface\n");
    if (type->flags & PDYN_ON_CLOSED) line(to, "\nneeds a surface that encloses a volume\n");
    if (type->flags & PDYN_ON_VOLUME) line(to, "\nworks on a volume of tetrahedra\n");
    if (type->flags & PDYN_ON_PARTICLES) line(to, "\nworks on a body of particles\n");
}

/* Describes a solver with the keys of the scene's "solver" object. "type" and "step"
 * are names, not numbers, and are in no table. */
static void describe_solver(const struct sink *to, const pdyn_global_solver *type) {
    heading(to, "solver", type->name, type->summary);
    row(to, "type", "", "\"auto\"", "\"auto\" or the name of a solver",
        "\"auto\": chosen for the scene");
    row(to, "step", "", "\"newton\"", "\"newton\" or \"projective\"",
        "with the constraints' tangents, or classic Projective Dynamics");
    table(to, settings_solver_params);
}

static pdyn_status fail_unknown(pdyn_context *context, const char *name) {
    const char *names[NAMES];
    const char *library = registry_absent(context, name);
    char clipped[64], hint[768] = "";
    int count = 0;
    if (library)
        return set_error(PDYN_BAD_INPUT, "this build has no solver \"%s\" (built without %s)", name,
                         library);
    for (int k = 0; registry_constraint_at(context, k) && count < NAMES; k++)
        names[count++] = registry_constraint_at(context, k)->name;
    for (int k = 0; registry_solver_at(context, k) && count < NAMES; k++)
        names[count++] = registry_solver_at(context, k)->name;
    text_clip(clipped, sizeof clipped, name);
    hint_append(hint, sizeof hint, name, names, count);
    if (context->plugins == 1) /* the built-in types */
        text_append(hint, sizeof hint, "; types of a plug-in: projdyn list --plugin FILE");
    return set_error(PDYN_BAD_INPUT, "no constraint and no solver \"%s\"%s", clipped, hint);
}

pdyn_status pdyn_describe(pdyn_context *context, const char *name,
                          void (*write)(void *user, const char *text), void *user) {
    if (HAS_NULL(context)) return PDYN_BAD_CALL;
    if (!write) return bad_call(__func__, "write is NULL");
    const struct sink to = {write, user};
    const pdyn_constraint_type *constraint = name ? registry_constraint(context, name) : NULL;
    const pdyn_global_solver *solver = name ? registry_solver(context, name) : NULL;
    if (name && !constraint && !solver) return fail_unknown(context, name);
    struct text_locale locale;
    if (!text_begin(&locale)) return context_no_memory(context);
    if (!name) describe_all(context, &to);
    if (constraint) describe_constraint(&to, constraint);
    if (solver) describe_solver(&to, solver);
    text_end(&locale);
    return PDYN_OK;
}
