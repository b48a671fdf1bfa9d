/* The model of E as solvers of plug-ins see it. */
#include "solver_view.h"

static void product(pdyn_model *model, const double *u, double *y) {
    objective_apply(model_system(model), u, y);
}

static void diagonal(pdyn_model *model, double *blocks) {
    objective_diagonal(model_system(model), blocks);
}

static double dot(pdyn_model *model, const double *a, const double *b) {
    return objective_dot(model_system(model), a, b);
}

static double norm(pdyn_model *model, const double *r) {
    return objective_norm(model_system(model), r);
}

static pdyn_status matrix(pdyn_model *view, pdyn_matrix *out) {
    struct model *model = (struct model *)view;
    struct hessian_matrix *h = &model->hessian;
    bool pattern = false, values = false;
    pdyn_status status = h->context ? PDYN_OK : hessian_matrix_create(h, model->objective);
    if (status == PDYN_OK) status = hessian_matrix_update(h, &pattern, &values);
    if (status != PDYN_OK) return status;
    model->pattern += pattern, model->values += values;
    *out = (pdyn_matrix){.dim = h->matrix.dim,
                         .size = h->matrix.dim * h->matrix.particles,
                         .start = h->matrix.column_start,
                         .row = h->matrix.row,
                         .value = h->matrix.value,
                         .pattern = model->pattern,
                         .values = model->values};
    return PDYN_OK;
}

void model_create(struct model *model, struct objective *objective, const pdyn_services *services) {
    *model = (struct model){.view = {.services = services,
                                     .particles = objective->particles,
                                     .product = product,
                                     .diagonal = diagonal,
                                     .dot = dot,
                                     .matrix = matrix,
                                     .norm = norm},
                            .objective = objective};
}

void model_free(struct model *model) { hessian_matrix_free(&model->hessian); }
