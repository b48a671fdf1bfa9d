/* The callbacks of pdyn_model that a solver gets, each one a call of the objective; and the
 * remainder, the model without one-sided constraints. */
#include "solver_view.h"

#include "residual.h"

#include <string.h>

static struct objective *objective_of(pdyn_model *model) {
    return ((struct solver_view *)model)->objective;
}

static bool is_matrix_free(const struct batch *b) { return b->op; }

/* Batch k of those with a property. */
static struct batch *batch_at(pdyn_model *model, bool (*has)(const struct batch *b), int k) {
    struct objective *o = objective_of(model);
    int b = 0;
    while (!has(o->batch[b]) || k-- > 0) b++;
    return o->batch[b];
}

static int count_batches(const struct objective *o, bool (*has)(const struct batch *b)) {
    int count = 0;
    for (int b = 0; b < o->batches; b++) count += has(o->batch[b]);
    return count;
}

/* ---- H --------------------------------------------------------------------------------------- */

static void product(pdyn_model *model, const double *u, double *y) {
    objective_apply(objective_of(model), u, y);
}

static void diagonal(pdyn_model *model, pdyn_part part, double *blocks) {
    objective_diagonal(objective_of(model), part, blocks);
}

static void remainder_product(pdyn_model *model, const double *u, double *y) {
    const struct solver_view *view = (struct solver_view *)model;
    objective_apply_remainder(view->objective, view->first, view->last, u, y);
}

static void remainder_diagonal(pdyn_model *model, pdyn_part part, double *blocks) {
    objective_diagonal_remainder(objective_of(model), part, blocks);
}

static void solve_bodies(pdyn_model *model, const double *r, double *z) {
    rigid_matrix_solve(objective_of(model)->rigid_matrix, r, z);
}

static double dot(pdyn_model *model, const double *a, const double *b) {
    const struct solver_view *view = (struct solver_view *)model;
    return objective_dot_between(view->objective, view->first, view->last, a, b);
}

static double norm(pdyn_model *model, const double *r) {
    const struct solver_view *view = (struct solver_view *)model;
    return objective_norm_between(view->objective, view->first, view->last, r);
}

static int for_particles(pdyn_model *model, int grain, pdyn_range_fn *fn, void *arg) {
    const struct solver_view *view = (struct solver_view *)model;
    struct pool *pool = view->objective->context->pool;
    return pool_for_between(pool, view->first, view->last, grain, fn, arg);
}

/* ---- matrices -------------------------------------------------------------------------------- */

static pdyn_matrix matrix_view(const struct matrix *m) {
    return (pdyn_matrix){.dim = m->dim,
                         .size = m->dim * m->particles,
                         .start = m->column_start,
                         .row = m->row,
                         .value = m->value};
}

static pdyn_status matrix(pdyn_model *model, pdyn_matrix *out) {
    struct solver_view *view = (struct solver_view *)model;
    if (model->solve_bodies)
        return set_error(PDYN_SOLVER_FAILED,
                         "the matrix of a scene with rigid bodies is not assembled; use solver "
                         "\"cg\"");
    struct hessian_matrix *h = &view->hessian;
    bool pattern = false, values = false;
    pdyn_status status = h->context ? PDYN_OK : hessian_matrix_create(h, view->objective);
    if (status == PDYN_OK) status = hessian_matrix_update(h, &pattern, &values);
    if (status != PDYN_OK) return status;
    view->pattern += pattern, view->values += values;
    *out = matrix_view(&h->matrix);
    out->pattern = view->pattern, out->values = view->values;
    return PDYN_OK;
}

/* Vertices of rigid bodies are no unknowns: their couplings become 0, and what ties other particles
 * to them stays on the diagonal of these, as if the bodies stood still. */
static void hold_rigid_bodies(const struct rigid_map *rigid, struct matrix *m) {
    for (int j = 0; j < m->particles; j++)
        for (int k = m->column_start[j]; k < m->column_start[j + 1]; k++) {
            int i = m->row[k];
            if (i != j && (rigid->owner[i] >= 0 || rigid->owner[j] >= 0)) m->value[k] = 0.0;
        }
}

static pdyn_status graph(pdyn_model *model, pdyn_matrix *out) {
    struct solver_view *view = (struct solver_view *)model;
    struct objective *o = view->objective;
    struct batch **rows = NEW_ARRAY(o->context, o->batches, struct batch *);
    if (o->batches && !rows) return PDYN_NO_MEMORY;
    for (int b = 0; b < o->batches; b++)
        if (batch_is_static(o->batch[b]) && batch_is_steady(o->batch[b]) &&
            !batch_couples_all(o->batch[b]))
            rows[b] = o->batch[b];
    pdyn_status status = matrix_pattern(&view->graph, o, rows, 1);
    if (status == PDYN_OK) {
        matrix_values(&view->graph, o, rows, false);
        if (o->rigid) hold_rigid_bodies(o->rigid, &view->graph);
        *out = matrix_view(&view->graph);
    }
    FREE_ARRAY(o->context, rows, o->batches);
    return status;
}

static pdyn_elements elements(pdyn_model *model, int k) {
    static const int start;
    static const pdyn_batch none = {.element_row = &start, .row_entry = &start};
    const struct batch *b = batch_at(model, batch_is_static, k);
    if (batch_couples_all(b)) return (pdyn_elements){.rows = &none};
    bool blocks = batch_has_blocks(b);
    return (pdyn_elements){.rows = &b->view,
                           .block = blocks ? b->block : NULL,
                           .block_start = blocks && !b->type->tangent_rank1 ? b->block_start : NULL,
                           .constant = b->linear != NULL,
                           .steady = batch_is_steady(b)};
}

/* ---- matrix-free constraints ----------------------------------------------------------------- */

static pdyn_one_sided one_sided(pdyn_model *model, int k, const pdyn_body **body) {
    const struct batch *b = batch_at(model, is_matrix_free, k);
    *body = b->view.body;
    return b->one_sided.at;
}

/* Constraint k, whose gradients are visited once. */
static struct batch *visit(pdyn_model *model, int k) {
    struct batch *b = batch_at(model, is_matrix_free, k);
    objective_count(objective_of(model), b, 1);
    return b;
}

static void rate(pdyn_model *model, int k, const bool *which, const double *u, double *out) {
    batch_rate(visit(model, k), which, objective_extended(objective_of(model), u), out);
}

static void force(pdyn_model *model, int k, const double *multiplier, double *out) {
    batch_force(visit(model, k), multiplier, out);
    objective_pull(objective_of(model), out);
}

/* ---- the view -------------------------------------------------------------------------------- */

static void update_remainder(struct solver_view *remainder, const struct solver_view *whole) {
    struct objective *o = remainder->objective;
    remainder->model.h = o->h, remainder->model.eps = o->eps;
    remainder->model.bodies_alone =
        o->rigid && o->rigid_matrix->closed && !whole->model.elements_count;
    memcpy(remainder->in_rows, whole->in_rows, (size_t)o->particles * sizeof *remainder->in_rows);
    for (int b = 0; b < o->batches; b++)
        if (batch_comes_and_goes(o->batch[b])) batch_mark_selected(o->batch[b], remainder->in_rows);
    remainder->first = 0, remainder->last = o->particles;
    while (remainder->last > 0 && !remainder->in_rows[remainder->last - 1]) remainder->last--;
    while (remainder->first < remainder->last && !remainder->in_rows[remainder->first])
        remainder->first++;
}

static void update_view(struct solver_view *view) {
    view->model.h = view->objective->h, view->model.eps = view->objective->eps;
    update_remainder(view->remainder, view);
}

static pdyn_status create_remainder(struct solver_view *view) {
    struct objective *o = view->objective;
    view->remainder = NEW_ARRAY(o->context, 1, struct solver_view);
    if (!view->remainder) return PDYN_NO_MEMORY;
    struct solver_view *remainder = view->remainder;
    *remainder = (struct solver_view){.objective = o, .model = view->model};
    remainder->in_rows = NEW_ARRAY(o->context, o->particles, bool);
    if (o->particles && !remainder->in_rows) return PDYN_NO_MEMORY;
    remainder->model.in_rows = remainder->in_rows;
    remainder->model.product = remainder_product, remainder->model.diagonal = remainder_diagonal;
    remainder->model.matrix = NULL; /* that of the view contains the one-sided constraints */
    remainder->model.one_sided_count = 0;
    view->model.remainder = &remainder->model;
    update_view(view);
    return PDYN_OK;
}

pdyn_status solver_view_create(struct solver_view *view, struct objective *o, bool newton,
                               const pdyn_services *services) {
    *view = (struct solver_view){.objective = o, .last = o->particles};
    view->in_rows = NEW_ARRAY(o->context, o->particles, bool);
    if (o->particles && !view->in_rows) return PDYN_NO_MEMORY;
    for (int b = 0; b < o->batches; b++) /* rows that come and go are marked in each step */
        if (batch_is_static(o->batch[b])) batch_mark_selected(o->batch[b], view->in_rows);
    for (int k = 0; o->rigid && k < o->rigid->bodies; k++) {
        const struct rigid_body *body = &o->rigid->body[k];
        memset(view->in_rows + body->first, true, (size_t)rigid_body_particles(body));
    }
    view->model = (pdyn_model){.services = services,
                               .particles = o->particles,
                               .mass = o->inertia,
                               .newton = newton && objective_has_tangents(o),
                               .dynamic = o->dynamic,
                               .in_rows = view->in_rows,
                               .elements_count = count_batches(o, batch_is_static),
                               .one_sided_count = count_batches(o, is_matrix_free),
                               .dynamic_count = count_batches(o, batch_comes_and_goes),
                               .product = product,
                               .diagonal = diagonal,
                               .solve_bodies = o->rigid ? solve_bodies : NULL,
                               .dot = dot,
                               .norm = norm,
                               .matrix = matrix,
                               .graph = graph,
                               .elements = elements,
                               .one_sided = one_sided,
                               .rate = rate,
                               .force = force,
                               .for_particles = for_particles};
    return create_remainder(view);
}

void solver_view_free(struct solver_view *view) {
    if (!view->objective) return;
    if (view->remainder) {
        matrix_free(&view->remainder->graph);
        FREE_ARRAY(view->objective->context, view->remainder->in_rows, view->objective->particles);
    }
    FREE_ARRAY(view->objective->context, view->remainder, 1);
    hessian_matrix_free(&view->hessian);
    matrix_free(&view->graph);
    FREE_ARRAY(view->objective->context, view->in_rows, view->objective->particles);
}

pdyn_status solver_view_linearise(struct solver_view *view, double eps) {
    pdyn_status status = objective_linearise(view->objective, eps);
    update_view(view);
    return status;
}
