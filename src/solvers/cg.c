/* Conjugate gradients (krylov.h) preconditioned with the inverse 3 x 3 block diagonal of H. */
#include "jacobi.h"
#include "krylov.h"

struct cg {
    struct krylov krylov;
    struct jacobi jacobi;
};

static void release(void *self) {
    struct cg *cg = self;
    jacobi_free(&cg->jacobi);
    krylov_free(&cg->krylov);
}

static void prepare(void *self) {
    struct cg *cg = self;
    jacobi_prepare(&cg->jacobi);
}

static double precondition(void *self) {
    struct cg *cg = self;
    return jacobi_apply(&cg->jacobi, cg->krylov.r, cg->krylov.z);
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct cg *cg = self;
    struct objective *objective = model_system(model);
    cg->krylov.prepare = prepare, cg->krylov.precondition = precondition, cg->krylov.self = cg;
    cg->krylov.patient = true;
    pdyn_status status = krylov_create(&cg->krylov, objective->context, objective);
    return status == PDYN_OK ? jacobi_create(&cg->jacobi, objective) : status;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct cg *cg = self;
    krylov_solve(&cg->krylov, b, y, stop, iterations);
    return PDYN_OK;
}

const pdyn_global_solver pdyn_solver_cg = {
    .name = "cg",
    .summary =
        "conjugate gradients without a matrix, preconditioned by 3 x 3 blocks; for scenes that "
        "change every step",
    .state_size = sizeof(struct cg),
    .create = create,
    .solve = solve,
    .free = release,
};
