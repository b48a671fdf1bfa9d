/* Solver "cholesky": a sparse Cholesky factor of H. It is analysed when the pattern of H changes
 * and computed when its values change. With static constraints, and the projective step or no
 * tangents, both happen where the length of the step or a weight changes, and a solve is two
 * triangular solves with three right-hand sides. With the newton step and tangents the values
 * change in every iteration, and x, y, z couple. */
#include "cholmod_factor.h"

#include <string.h>

struct cholesky {
    pdyn_model *model;
    struct factor factor;
    unsigned pattern, values; /* of the matrix that the factor belongs to; 0: none */
};

static int suits(const pdyn_model *model, const char **reason) {
    bool constant = !model->dynamic && !model->newton;
    *reason =
        constant
            ? "the matrix is constant in a step: it is factored where the length of the step or a "
              "weight changes"
            : "a factorisation in every iteration";
    if (model->solve_bodies) {
        *reason = "it has rigid bodies, whose matrix is not a sparse one of particles";
        return 0;
    }
    return constant ? 20 : 2;
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct cholesky *s = self;
    s->model = model;
    factor_start(&s->factor, model->services);
    return PDYN_OK;
}

static void release(void *self) { factor_end(&((struct cholesky *)self)->factor); }

/* Brings the factor up to date with H. */
static pdyn_status update_factor(struct cholesky *s) {
    pdyn_matrix matrix;
    pdyn_status status = s->model->matrix(s->model, &matrix);
    if (status == PDYN_OK && s->pattern != matrix.pattern)
        status = factor_analyse(&s->factor, &matrix, !s->model->dynamic);
    if (status == PDYN_OK && s->values != matrix.values)
        status = factor_compute(&s->factor, &matrix);
    s->pattern = status == PDYN_OK ? matrix.pattern : 0;
    s->values = status == PDYN_OK ? matrix.values : 0;
    return status;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    (void)stop;
    struct cholesky *s = self;
    *iterations = 1;
    pdyn_status status = update_factor(s);
    if (status == PDYN_OK) status = factor_solve(&s->factor, b, y);
    memset(b, 0, 3 * (size_t)s->model->particles * sizeof *b); /* the residual is rounding */
    return status;
}

const pdyn_global_solver pdyn_solver_cholesky = {
    .name = "cholesky",
    .summary = "a sparse Cholesky factor by CHOLMOD, kept while the matrix stays; for static "
               "constraints with the projective step",
    .direct = true,
    .state_size = sizeof(struct cholesky),
    .suits = suits,
    .create = create,
    .solve = solve,
    .free = release,
};
