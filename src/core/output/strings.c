/* Springs between two bodies, as those of `attachment`, for pictures: each from a vertex to a point
 * of a triangle of another body. */
#include "base/body.h"
#include "base/param_kind.h"
#include "output.h"

#include <math.h>

enum { ENTRIES = 4 }; /* of the row of a spring: the vertex, the three corners of the triangle */

/* The other body that a constraint names; NULL: none. */
static const pdyn_body *other_of(const struct batch *b) {
    for (const pdyn_param *p = b->type->params; p->name; p++)
        if (param_body(p, b->params)) return param_body(p, b->params);
    return NULL;
}

/* Whether the row that begins at an entry is x - sum_k w_k y_k, with y_k of the other body. */
static bool is_spring(const struct batch *b, const pdyn_body *other, int first) {
    const int *column = b->view.column + first;
    const double *c = b->view.coefficient + first;
    bool between = body_has(b->view.body, column[0]);
    for (int k = 1; k < ENTRIES; k++) between &= body_has(other, column[k]);
    return between && c[0] == 1.0 && fabs(c[1] + c[2] + c[3] + 1.0) < 1e-9;
}

/* [vertex, corners of the triangle, their weights] */
static json_t *spring(const struct batch *b, const pdyn_body *other, int first) {
    const int *column = b->view.column + first;
    const double *c = b->view.coefficient + first;
    return json_pack("[i, i, i, i, f, f, f]", column[0] - b->view.body->first,
                     column[1] - other->first, column[2] - other->first, column[3] - other->first,
                     -c[1], -c[2], -c[3]);
}

static json_t *ends_of(const struct batch *b, const pdyn_body *other) {
    json_t *ends = json_array();
    for (int r = 0; ends && r < b->rows; r++) {
        int first = b->view.row_entry[r];
        bool drawn = b->view.row_entry[r + 1] - first == ENTRIES && is_spring(b, other, first);
        if (drawn && json_array_append_new(ends, spring(b, other, first)))
            return json_decref(ends), NULL;
    }
    return ends;
}

static json_t *strings_of(const struct batch *b, const pdyn_body *other,
                          const struct scene_constraint *c) {
    return json_pack("{s:s, s:s, s:f, s:o*, s:o}", "body", b->view.body->name, "to", other->name,
                     "from", c->from, "until", isfinite(c->until) ? json_real(c->until) : NULL,
                     "ends", ends_of(b, other));
}

json_t *report_strings(const pdyn_sim *sim) {
    json_t *list = json_array();
    for (int k = 0; list && k < sim->constraints; k++) {
        const struct batch *b = sim->objective.batch[k];
        const pdyn_body *other = b->op ? NULL : other_of(b);
        if (other && json_array_append_new(list, strings_of(b, other, sim->constraint[k])))
            return json_decref(list), NULL;
    }
    return list;
}
