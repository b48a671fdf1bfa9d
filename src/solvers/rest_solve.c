#include "rest_solve.h"

#include <string.h>

enum { GRAIN = 2048, MAX_ITERATIONS = 100 };

struct call {
    const struct rest_solve *s;
    double *b, *y;
};

pdyn_status rest_solve_create(struct rest_solve *s, pdyn_model *model) {
    s->model = model;
    pdyn_status status = pcg_create(&s->pcg, model);
    if (status == PDYN_OK) status = block_jacobi_create(&s->jacobi, model);
    return status == PDYN_OK ? coarse_space_create(&s->coarse, model) : status;
}

void rest_solve_free(struct rest_solve *s) {
    pcg_free(&s->pcg);
    block_jacobi_free(&s->jacobi);
    coarse_space_free(&s->coarse);
}

void rest_solve_update(struct rest_solve *s, bool first_of_step) {
    block_jacobi_update(&s->jacobi);
    coarse_space_update(&s->coarse, first_of_step);
}

/* y = D^-1 b and b = 0 for particles in no row, whose block D is a number (damping counts up to the
 * limit of block_jacobi.c); y = 0 for the others. */
static void solve_free(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        const double *D = c->s->jacobi.inverse + 6 * (size_t)i;
        bool free = !c->s->model->in_rows[i];
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            c->y[k] = free ? D[0] * c->b[k] : 0.0;
            if (free) c->b[k] = 0.0;
        }
    }
}

static void precondition(void *self, const double *r, double *z) {
    struct rest_solve *s = self;
    block_jacobi_apply(&s->jacobi, r, z);
    coarse_space_correct(&s->coarse, r, z);
}

int rest_solve_apply(struct rest_solve *s, double *b, double *y, double rel_tol) {
    const pdyn_services *services = s->model->services;
    const pdyn_stop stop = {
        .rel_tol = rel_tol, .max_iterations = MAX_ITERATIONS, .first_of_step = true};
    int iterations = 0;
    services->parallel_for(services->core, s->model->particles, GRAIN, solve_free,
                           &(struct call){s, b, y});
    pcg_solve(&s->pcg, precondition, s, b, y, &stop, &iterations);
    return iterations;
}
