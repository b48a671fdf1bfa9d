/* Solver "hybrid": conjugate gradients without a matrix and a two-level preconditioner,
 *
 *     P^-1 = D^-1 + I A^-1 I'
 *
 * D: block diagonal of H; A = I' H I on a coarse space of up to 1600 nodes on cloth and solids
 * (coarse_space.h), which carries the slow motions that block Jacobi cannot see. */
#include "block_jacobi.h"
#include "coarse_space.h"
#include "pcg.h"

struct hybrid {
    struct pcg pcg;
    struct block_jacobi jacobi;
    struct coarse_space coarse;
};

static int suits(const pdyn_model *model, const char **reason) {
    *reason = model->dynamic
                  ? "some constraints change every step; block Jacobi and a coarse space on cloth "
                    "and solids precondition"
                  : "the newton step changes the matrix in every iteration: a two-level "
                    "preconditioner costs less than a factorisation";
    if (!model->newton || !model->elements_count) return 3;
    return model->one_sided_count || !model->dynamic ? 30 : 3;
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct hybrid *s = self;
    pdyn_status status = pcg_create(&s->pcg, model);
    if (status == PDYN_OK) status = block_jacobi_create(&s->jacobi, model);
    return status == PDYN_OK ? coarse_space_create(&s->coarse, model) : status;
}

static void precondition(void *self, const double *r, double *z) {
    struct hybrid *s = self;
    block_jacobi_apply(&s->jacobi, r, z);
    coarse_space_correct(&s->coarse, r, z);
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct hybrid *s = self;
    block_jacobi_update(&s->jacobi);
    coarse_space_update(&s->coarse, stop->first_of_step);
    pcg_solve(&s->pcg, precondition, s, b, y, stop, 0.0, iterations);
    return PDYN_OK;
}

static void release(void *self) {
    struct hybrid *s = self;
    pcg_free(&s->pcg);
    block_jacobi_free(&s->jacobi);
    coarse_space_free(&s->coarse);
}

const pdyn_global_solver pdyn_solver_hybrid = {
    .name = "hybrid",
    .summary = "conjugate gradients with a two-level preconditioner: block Jacobi plus a coarse "
               "space of up to 1600 nodes on cloth and solids; for cloth with the newton step",
    .state_size = sizeof(struct hybrid),
    .suits = suits,
    .create = create,
    .solve = solve,
    .free = release,
};
