/* What kind of value a parameter has (pdyn_param of module.h). */
#ifndef PDYN_PARAM_KIND_H
#define PDYN_PARAM_KIND_H

#include "projdyn/module.h"

#include <string.h>

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

/* The body that a parameter names; NULL: none. */
static inline const pdyn_body *param_body(const pdyn_param *param, const void *params) {
    const pdyn_other *other = param_other(param, params);
    return other ? other->body : NULL;
}

/* Whether a type has a parameter of this kind. */
static inline bool type_has_kind(const pdyn_constraint_type *type, pdyn_param_kind kind) {
    const pdyn_param *p = type->params;
    while (p->name && p->kind != kind) p++;
    return p->name;
}

/* The parameters of a type that are true or false. */
static inline int type_bools(const pdyn_constraint_type *type) {
    int count = 0;
    for (const pdyn_param *p = type->params; p->name; p++) count += p->kind == PDYN_BOOL;
    return count;
}

/* Whether constraints of a type act between their body and another one. */
static inline bool type_ties_to_other(const pdyn_constraint_type *type) {
    return type_has_kind(type, PDYN_OTHER);
}

/* Whether their forces on the body may have a sum. */
static inline bool type_acts_from_outside(const pdyn_constraint_type *type) {
    return type->flags & PDYN_ANCHORED || type_ties_to_other(type);
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
static inline bool param_is_changeable(const pdyn_constraint_type *type, const pdyn_param *param) {
    if (param->kind == PDYN_PATH) return !type->matrix_free;
    if (!param_numbers(param)) return false;
    for (const char *const *a = type->alternatives; a && *a; a++)
        if (!strcmp(*a, param->name)) return false;
    return !type->matrix_free || type->matrix_free->set_params;
}

/* Whether a parameter has a default. A default outside the bounds means: absent unless given. */
static inline bool param_has_default(const pdyn_param *param) {
    return !param->required && (param->kind <= PDYN_VECTOR || param_is_table(param)) &&
           param->def >= param->min && param->def <= param->max;
}

#endif
