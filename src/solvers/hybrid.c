/* Solver "hybrid": conjugate gradients without a matrix and a two-level preconditioner. */
#include "two_level.h"

static int suits(const pdyn_model *model, const char **reason) {
    *reason = model->dynamic
                  ? "some constraints change every step; block Jacobi and a coarse space on cloth "
                    "and solids precondition"
                  : "the newton step changes the matrix in every iteration: a two-level "
                    "preconditioner costs less than a factorisation";
    if (!model->newton || !model->elements_count) return 3;
    return model->one_sided_count || !model->dynamic ? 30 : 3;
}

static pdyn_status create(void *self, pdyn_model *model) { return two_level_create(self, model); }

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    two_level_update(self, stop->first_of_step);
    two_level_solve(self, b, y, stop, 0.0, iterations);
    return PDYN_OK;
}

static void release(void *self) { two_level_free(self); }

const pdyn_global_solver pdyn_solver_hybrid = {
    .name = "hybrid",
    .summary = "conjugate gradients with a two-level preconditioner: block Jacobi plus a coarse "
               "space of up to 1600 nodes on cloth and solids; for cloth with the newton step",
    .state_size = sizeof(struct two_level),
    .suits = suits,
    .create = create,
    .solve = solve,
    .free = release,
};
