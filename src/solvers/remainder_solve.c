#include "remainder_solve.h"

#include "memory.h"

enum { GRAIN = 2048, MAX_ITERATIONS = 100 };

struct call {
    const struct remainder_solve *s;
    double *b, *y;
};

pdyn_status remainder_solve_create(struct remainder_solve *s, pdyn_model *whole) {
    s->whole = whole, s->model = whole->remainder;
    s->coupled = whole->elements_count || whole->dynamic_count || whole->solve_bodies;
    s->mobility = NEW(whole->services, whole->particles, double);
    if (!s->mobility) return PDYN_NO_MEMORY;
    return s->coupled ? two_level_create(&s->two_level, s->model) : PDYN_OK;
}

void remainder_solve_free(struct remainder_solve *s) {
    if (s->whole) FREE(s->whole->services, s->mobility, s->whole->particles);
    two_level_free(&s->two_level);
}

static void for_particles(const struct remainder_solve *s, pdyn_range_fn *fn, double *b,
                          double *y) {
    const pdyn_services *services = s->model->services;
    services->parallel_for(services->core, s->model->particles, GRAIN, fn, &(struct call){s, b, y});
}

static void compute_mobility(void *arg, int first, int last, int block) {
    (void)block;
    const struct remainder_solve *s = ((const struct call *)arg)->s;
    pdyn_model *model = s->whole;
    for (int i = first; i < last; i++) s->mobility[i] = 0.0;
    for (int k = 0; k < model->one_sided_count; k++) {
        const pdyn_body *body;
        const double *weight_sum = model->one_sided(model, k, &body).weight_sum;
        for (int i = first; i < last; i++) s->mobility[i] += weight_sum[i];
    }
    for (int i = first; i < last; i++)
        s->mobility[i] =
            1.0 / (model->mass[i] / (model->h * model->h) + model->eps * s->mobility[i]);
}

void remainder_solve_update(struct remainder_solve *s, bool first_of_step) {
    s->exact = !s->coupled || s->model->bodies_alone;
    for_particles(s, compute_mobility, NULL, NULL);
    if (s->coupled) two_level_update(&s->two_level, first_of_step);
}

/* y = A^-1 b of particles in no row and of no rigid body */
static void apply_mobility(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->y[k] = c->s->mobility[k / 3] * c->b[k];
}

/* y = D^-1 b and b = 0 for particles in no row, whose block D is a number (damping counts up to the
 * limit of block_jacobi.c); y = 0 for the others. */
static void solve_free(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        const double *D = c->s->two_level.jacobi.inverse + 6 * (size_t)i;
        bool free = !c->s->model->in_rows[i];
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            c->y[k] = free ? D[0] * c->b[k] : 0.0;
            if (free) c->b[k] = 0.0;
        }
    }
}

int remainder_solve_apply(struct remainder_solve *s, double *b, double *y, double tolerance) {
    const pdyn_stop stop = {
        .rel_tol = tolerance, .max_iterations = MAX_ITERATIONS, .first_of_step = true};
    int iterations = 0;
    if (s->exact) {
        for_particles(s, apply_mobility, b, y);
        if (s->coupled) s->whole->solve_bodies(s->whole, b, y);
        return 0;
    }
    for_particles(s, solve_free, b, y);
    pcg_solve(&s->two_level.pcg, b, y, &stop, tolerance, &iterations);
    return iterations;
}
