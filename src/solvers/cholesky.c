/* A sparse Cholesky factor of H by CHOLMOD: analysed when the pattern changes, factored when the
 * values do. With the projective step and static constraints both happen once for each length of
 * step, and a solve is two triangular ones with three right-hand sides; with the newton step the
 * values change in every iteration and x, y, z couple; where neighbours change, the pattern does
 * too. */
#include "factor.h"
#include "objective/solver_view.h"

struct cholesky {
    struct hessian_matrix hessian;
    struct factor factor;
};

static void release(void *self) {
    struct cholesky *c = self;
    hessian_matrix_free(&c->hessian);
    factor_free(&c->factor);
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct cholesky *c = self;
    struct objective *objective = model_system(model);
    factor_start(&c->factor, objective->context);
    return hessian_matrix_create(&c->hessian, objective);
}

/* Brings the factor up to date with H. */
static pdyn_status prepare(struct cholesky *c) {
    bool pattern, values;
    bool lasting = !c->hessian.objective->dynamic_rows;
    pdyn_status status = hessian_matrix_update(&c->hessian, &pattern, &values);
    if (status == PDYN_OK && pattern)
        status = factor_analyse(&c->factor, &c->hessian.matrix, lasting);
    if (status == PDYN_OK && values) status = factor_numbers(&c->factor, &c->hessian.matrix);
    return status;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    (void)stop;
    struct cholesky *c = self;
    *iterations = 1;
    pdyn_status status = prepare(c);
    return status == PDYN_OK ? factor_solve(&c->factor, b, y) : status;
}

const pdyn_global_solver pdyn_solver_cholesky = {
    .name = "cholesky",
    .summary =
        "a sparse factor by CHOLMOD, kept while the matrix stays; for static constraints with the "
        "projective step",
    .direct = true,
    .state_size = sizeof(struct cholesky),
    .create = create,
    .solve = solve,
    .free = release,
};
