#include "hessian_matrix.h"

static void free_replicas(struct hessian_matrix *c) {
    for (int b = 0; b < c->objective->batches; b++)
        if (c->rows[b] && c->rows[b] != c->objective->batch[b]) {
            batch_free(c->rows[b]);
            c->rows[b] = NULL;
        }
}

void hessian_matrix_free(struct hessian_matrix *c) {
    if (!c->context) return;
    if (c->rows) free_replicas(c);
    FREE_ARRAY(c->context, c->rows, c->objective->batches);
    FREE_VECTOR(c->context, c->unused, c->objective->particles);
    matrix_free(&c->matrix);
}

pdyn_status hessian_matrix_create(struct hessian_matrix *c, struct objective *objective) {
    pdyn_context *context = objective->context;
    c->context = context, c->objective = objective;
    c->rows = NEW_ARRAY(context, objective->batches, struct batch *);
    c->unused = NEW_VECTOR(context, objective->particles);
    if ((objective->batches && !c->rows) || !c->unused) return PDYN_NO_MEMORY;
    for (int b = 0; b < objective->batches; b++)
        if (!objective->batch[b]->op) c->rows[b] = objective->batch[b];
    return PDYN_OK;
}

/* Local steps of the replicas at the x of the last local step. */
static pdyn_status update_replicas(struct hessian_matrix *c, bool lists_moved) {
    struct objective *objective = c->objective;
    const struct batch_step step = objective_step(objective);
    if (!objective->dynamic) return PDYN_OK;
    if (lists_moved) free_replicas(c);
    for (int b = 0; b < objective->batches; b++) {
        const struct batch *from = objective->batch[b];
        if (!from->op) continue;
        pdyn_status status = c->rows[b] ? PDYN_OK : batch_create_rows(from, &c->rows[b]);
        if (status != PDYN_OK) return status;
        batch_set_step(c->rows[b], &step);
        status = batch_local(c->rows[b], objective->x, c->unused);
        if (status == PDYN_OK) status = batch_linearise(c->rows[b], objective->eps);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
}

pdyn_status hessian_matrix_update(struct hessian_matrix *c, bool *pattern, bool *values) {
    struct objective *objective = c->objective;
    int dim = objective->eps < 1.0 && objective_has_tangents(objective) ? 3 : 1;
    bool moved = objective->dynamic && c->lists_revision != objective->lists_revision;
    *pattern =
        c->matrix.dim != dim || (moved && dim == 3) || c->revision != objective_revision(objective);
    *values = *pattern || moved || dim == 3 || c->h != objective->h ||
              c->weights_revision != objective->weights_revision;
    if (!*values) return PDYN_OK;
    pdyn_status status = update_replicas(c, moved);
    if (status == PDYN_OK && *pattern) status = matrix_pattern(&c->matrix, objective, c->rows, dim);
    if (status != PDYN_OK) return status;
    matrix_values(&c->matrix, objective, c->rows, true);
    c->h = objective->h, c->weights_revision = objective->weights_revision;
    c->lists_revision = objective->lists_revision, c->revision = objective_revision(objective);
    return PDYN_OK;
}
