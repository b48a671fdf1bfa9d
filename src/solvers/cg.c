/* Solver "cg": conjugate gradients without a matrix, preconditioned by block Jacobi. It uses
 * nothing but projdyn/module.h: a solver of a plug-in is written in the same way. */
#include "block_jacobi.h"
#include "pcg.h"

struct cg {
    struct pcg pcg;
    struct block_jacobi jacobi;
};

static int suits(const pdyn_model *model, const char **reason) {
    *reason = model->dynamic
                  ? "some constraints change every step, so a constant factorisation does not pay"
                  : "conjugate gradients solve any scene";
    return model->dynamic ? 20 : 5;
}

static void precondition(void *self, const double *r, double *z) {
    block_jacobi_apply(&((struct cg *)self)->jacobi, r, z);
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct cg *cg = self;
    pdyn_status status = pcg_create(&cg->pcg, model, precondition, cg);
    return status == PDYN_OK ? block_jacobi_create(&cg->jacobi, model) : status;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct cg *cg = self;
    block_jacobi_update(&cg->jacobi);
    pcg_solve(&cg->pcg, b, y, stop, 0.0, iterations);
    return PDYN_OK;
}

static void release(void *self) {
    struct cg *cg = self;
    pcg_free(&cg->pcg);
    block_jacobi_free(&cg->jacobi);
}

const pdyn_global_solver pdyn_solver_cg = {
    .name = "cg",
    .summary = "conjugate gradients without a matrix, preconditioned by block Jacobi; for scenes "
               "whose constraints change every step",
    .state_size = sizeof(struct cg),
    .suits = suits,
    .create = create,
    .solve = solve,
    .free = release,
};
