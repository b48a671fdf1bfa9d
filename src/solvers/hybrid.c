/* Solver "hybrid": conjugate gradients without a matrix and a two-level preconditioner. */
#include "two_level.h"

/* Whether some steady element ties particles: coarse spaces consist of these. */
static bool has_coarse_space(const pdyn_model *model) {
    for (int k = 0; k < model->elements_count; k++) {
        pdyn_elements elements = model->elements((pdyn_model *)model, k);
        const pdyn_batch *rows = elements.rows;
        for (int r = 0; elements.steady && r < rows->element_row[rows->elements]; r++)
            if (rows->row_entry[r + 1] - rows->row_entry[r] > 1) return true;
    }
    return false;
}

static int suits(const pdyn_model *model, const char **reason) {
    static const char *const reasons[2][2] = {
        {"the newton step changes the matrix in every iteration: block Jacobi costs less than a "
         "factorisation; there is no coarse space, because no elements with constant weights tie "
         "particles",
         "the newton step changes the matrix in every iteration: a two-level preconditioner costs "
         "less than a factorisation"},
        {"some constraints change every step; block Jacobi preconditions",
         "some constraints change every step; block Jacobi and a coarse space on cloth and solids "
         "precondition"}};
    *reason = reasons[model->dynamic][has_coarse_space(model)];
    if (!model->newton || !model->elements_count) return 3;
    return model->one_sided_count || !model->dynamic ? 30 : 3;
}

static pdyn_status create(void *self, pdyn_model *model) { return two_level_create(self, model); }

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct two_level *s = self;
    two_level_update(s, stop->first_of_step);
    pcg_solve(&s->pcg, b, y, stop, 0.0, iterations);
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
