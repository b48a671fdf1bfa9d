/* Checks of the tables of a plug-in before any of its code runs: names, parameters, callbacks. */
#include "param_kind.h"
#include "registry.h"

#include <math.h>
#include <string.h>

static pdyn_status fail(const char *name, const char *what) {
    return set_error(PDYN_BAD_INPUT, "type \"%.64s\": %s", name, what);
}

static bool is_name(const char *name) {
    return name && *name && strlen(name) < 32 &&
           strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
               strlen(name);
}

static pdyn_status check_names(const char *name, const char *summary) {
    if (!is_name(name))
        return set_error(PDYN_BAD_INPUT,
                         "a type has no name of 1 to 31 letters, digits, '_' and '-'");
    return summary && *summary ? PDYN_OK : fail(name, "it has no summary");
}

/* ---- parameters ------------------------------------------------------------------------------ */

static const size_t sizes[] = {[PDYN_REAL] = sizeof(double),
                               [PDYN_INT] = sizeof(int),
                               [PDYN_BOOL] = sizeof(bool),
                               [PDYN_VECTOR] = 3 * sizeof(double),
                               [PDYN_VERTICES] = sizeof(pdyn_vertices),
                               [PDYN_PATH] = sizeof(pdyn_path),
                               [PDYN_OTHER] = sizeof(pdyn_other)};

static bool is_known(unsigned kind) {
    unsigned table = kind % PDYN_VERTEX_COLUMN;
    return kind < sizeof sizes / sizeof *sizes ||
           (table >= PDYN_ROWS && table <= (PDYN_PER_TET | 0xFF));
}

static size_t size_of(const pdyn_param *p) {
    return param_is_table(p) ? sizeof(pdyn_table) : sizes[p->kind];
}

/* Describes why no body of the type has rows for a table; NULL: they have. */
static const char *table_fault(const pdyn_constraint_type *type, const pdyn_param *p) {
    bool tets = type->flags & PDYN_ON_VOLUME, mesh = tets || type->flags & PDYN_ON_SURFACE;
    if (!param_width(p)) return "its rows have no numbers";
    if (param_rows(p, 0, 0, 1) && !tets) return "it needs PDYN_ON_VOLUME";
    if (param_rows(p, 1, 1, 0) && !mesh) return "it needs PDYN_ON_SURFACE or PDYN_ON_VOLUME";
    if (param_vertices(p) && !mesh) return "vertices need PDYN_ON_SURFACE or PDYN_ON_VOLUME";
    if (param_vertices(p) > param_width(p)) return "its rows have more vertices than numbers";
    if (param_vertices(p) && param_has_default(p)) return "vertices have no default";
    return NULL;
}

const char *const registry_common_keys[] = {"type", "from", "until", NULL};

static bool is_taken(const char *name) {
    for (const char *const *key = registry_common_keys; *key; key++)
        if (!strcmp(name, *key)) return true;
    return false;
}

/* Describes the first error in a parameter, compared with the parameters before it; NULL: none. */
static const char *param_fault(const pdyn_constraint_type *type, const pdyn_param *p) {
    if (!is_name(p->name) || is_taken(p->name)) return "its name cannot be a key of a scene";
    if (!is_known(p->kind)) return "its kind is unknown";
    if (!p->unit || !p->doc) return "it has no unit or no doc";
    if (p->offset > type->params_size || size_of(p) > type->params_size - p->offset)
        return "it lies outside of params_size";
    bool bounded = (p->kind <= PDYN_VECTOR && p->kind != PDYN_BOOL) || param_is_table(p);
    if (bounded && !(p->min <= p->max)) return "its bounds are not ordered";
    if (bounded && !p->required && isfinite(p->def) && p->def > p->max)
        return "its default is above its bounds; one below them, or NAN, means that there is none";
    if (p->kind == PDYN_INT && !p->required && isfinite(p->def) && p->def != floor(p->def))
        return "its default has a fraction: say PDYN_REAL, or give a whole number";
    if (param_is_table(p) && table_fault(type, p)) return table_fault(type, p);
    for (const pdyn_param *q = type->params; q < p; q++) {
        if (!strcmp(q->name, p->name)) return "its name is given twice";
        if (p->offset < q->offset + size_of(q) && q->offset < p->offset + size_of(p))
            return "it overlaps another one";
    }
    return NULL;
}

static pdyn_status check_params(const pdyn_constraint_type *type) {
    if (!type->params) return fail(type->name, "it has no table of parameters");
    for (const pdyn_param *p = type->params; p->name; p++) {
        const char *fault = param_fault(type, p);
        if (fault)
            return set_error(PDYN_BAD_INPUT, "type \"%s\": parameter \"%.32s\": %s", type->name,
                             p->name, fault);
    }
    return PDYN_OK;
}

static const pdyn_param *find_param(const pdyn_constraint_type *type, const char *name) {
    const pdyn_param *p = type->params;
    while (p->name && strcmp(p->name, name) != 0) p++;
    return p->name ? p : NULL;
}

static const char *alternatives_fault(const pdyn_constraint_type *type) {
    int defaults = 0;
    for (const char *const *name = type->alternatives; name && *name; name++) {
        const pdyn_param *p = find_param(type, *name);
        if (!p || p->required) return "an alternative is not a parameter, or a required one";
        defaults += param_has_default(p);
    }
    return defaults > 1 ? "more than one alternative has a default" : NULL;
}

/* ---- types ----------------------------------------------------------------------------------- */

static const char *operator_fault(const pdyn_operator *op) {
    bool whole = op->create && op->free && op->neighbours && op->local && op->one_sided &&
                 op->rate && op->force && op->diagonal;
    return whole ? NULL : "its operator lacks a callback";
}

/* Elements that come and go. */
static const char *update_fault(const pdyn_constraint_type *t) {
    bool always = t->flags & PDYN_EVERY_ITERATION;
    if (!t->update && (always || t->scratch_size))
        return "PDYN_EVERY_ITERATION and scratch_size need update";
    if (!t->memory_size != !t->end) return "memory_size and end need each other";
    if (t->memory_size && (t->linear || t->damping || t->matrix_free))
        return "memory_size excludes linear, damping and matrix_free";
    if (t->update && (t->row_sizes || t->linear || t->damping || t->matrix_free))
        return "update excludes row_sizes, linear, damping and matrix_free";
    if (t->update && t->flags & PDYN_STEADY) return "update excludes PDYN_STEADY";
    return always && t->begin ? "PDYN_EVERY_ITERATION excludes begin" : NULL;
}

static const char *constraint_fault(const pdyn_constraint_type *t) {
    if ((!t->elements && !t->update) || !t->select || !t->weight || !t->project)
        return "it lacks one of elements (or update), select, weight, project";
    if (!t->row_sizes && (t->rows < 1 || t->width < 1))
        return "without row_sizes, it needs rows and width";
    if ((t->flags & (PDYN_ON_SURFACE | PDYN_ON_VOLUME)) && (t->flags & PDYN_ON_PARTICLES))
        return "no body is both a surface and particles";
    if (t->flags & PDYN_ON_CLOSED && !(t->flags & PDYN_ON_SURFACE))
        return "PDYN_ON_CLOSED needs PDYN_ON_SURFACE";
    if (t->flags >= 2u * PDYN_STEADY) return "its flags have a bit that module.h does not define";
    if (alternatives_fault(t)) return alternatives_fault(t);
    if (update_fault(t)) return update_fault(t);
    if (t->tangent && t->tangent_rank1)
        return "it has tangent and tangent_rank1, expected one of them at most";
    if (t->flags & PDYN_NUMERIC_TANGENT && (t->tangent || t->tangent_rank1))
        return "PDYN_NUMERIC_TANGENT excludes tangent and tangent_rank1";
    if (t->flags & PDYN_NUMERIC_TANGENT && !t->row_sizes && t->rows > NUMERIC_TANGENT_ROWS)
        return "with PDYN_NUMERIC_TANGENT, an element has at most 12 rows";
    if (!t->damping != !t->damping_rest) return "damping and damping_rest need each other";
    if (t->damping &&
        (t->data_size % sizeof(double) || t->data_size > DAMPED_DATA_MAX * sizeof(double)))
        return "with damping, data of an element are at most 512 doubles";
    if ((t->matrix_free || t->flags & PDYN_NEIGHBOURS) && !(t->flags & PDYN_ON_PARTICLES))
        return "it works on neighbour lists: it needs PDYN_ON_PARTICLES";
    if (t->linear && t->begin) return "linear excludes begin: core adds its rows up once";
    if (t->matrix_free && (t->begin || t->damping)) return "matrix_free excludes begin and damping";
    return t->matrix_free ? operator_fault(t->matrix_free) : NULL;
}

pdyn_status plugin_check_constraint(const pdyn_constraint_type *type) {
    pdyn_status status = check_names(type->name, type->summary);
    if (status == PDYN_OK) status = check_params(type);
    if (status != PDYN_OK) return status;
    const char *fault = constraint_fault(type);
    return fault ? fail(type->name, fault) : PDYN_OK;
}

pdyn_status plugin_check_solver(const pdyn_global_solver *type) {
    pdyn_status status = check_names(type->name, type->summary);
    if (status != PDYN_OK) return status;
    if (!type->create || !type->solve || !type->free)
        return fail(type->name, "it lacks one of create, solve, free");
    return type->state_size ? PDYN_OK : fail(type->name, "its state_size is 0");
}
