#include "pcg.h"

#include "memory.h"
#include "projdyn/simd.h"

#include <math.h>

enum { GRAIN = 2048 }; /* particles per parallel block */

struct call {
    const struct pcg *pcg;
    double *r, *y;
    double scale;
};

pdyn_status pcg_create(struct pcg *s, pdyn_model *model, pcg_preconditioner *precondition,
                       void *self) {
    const pdyn_services *services = model->services;
    s->model = model, s->precondition = precondition, s->self = self;
    s->z = NEW(services, vector_size(model), double);
    s->p = NEW(services, vector_size(model), double);
    s->q = NEW(services, vector_size(model), double);
    s->partial = NEW(services, block_count(model->particles, GRAIN) + 1, double);
    return s->z && s->p && s->q && s->partial ? PDYN_OK : PDYN_NO_MEMORY;
}

void pcg_free(struct pcg *s) {
    if (!s->model) return;
    const pdyn_services *services = s->model->services;
    FREE(services, s->z, vector_size(s->model));
    FREE(services, s->p, vector_size(s->model));
    FREE(services, s->q, vector_size(s->model));
    FREE(services, s->partial, block_count(s->model->particles, GRAIN) + 1);
}

/* p = z + scale p, or z, whatever p was, if scale is 0; partial: r . p */
WIDE static void pcg_update_direction(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *z = c->pcg->z;
    double *p = c->pcg->p, scale = c->scale;
    for (int k = 3 * first; k < 3 * last; k++) p[k] = z[k] + (scale == 0.0 ? 0.0 : scale * p[k]);
    c->pcg->partial[block] = simd_dot(c->r + 3 * first, p + 3 * first, 3 * (last - first));
}

/* y += scale p, r -= scale q */
WIDE static void pcg_advance(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const double *p = c->pcg->p, *q = c->pcg->q;
    for (int k = 3 * first; k < 3 * last; k++) {
        c->y[k] += c->scale * p[k];
        c->r[k] -= c->scale * q[k];
    }
}

/* r . p for p = z + scale p */
static double update_direction(struct pcg *s, double *r, double scale) {
    double sum = 0.0;
    int blocks = s->model->for_particles(s->model, GRAIN, pcg_update_direction,
                                         &(struct call){s, r, NULL, scale});
    for (int b = 0; b < blocks; b++) sum += s->partial[b];
    return sum;
}

/* The direction from z, conjugate to the last one where that leads down. Returns r . p. */
static double choose_direction(struct pcg *s, double *r) {
    pdyn_model *m = s->model;
    if (s->curvature > 0.0) {
        double rp = update_direction(s, r, -m->dot(m, s->z, s->q) / s->curvature);
        if (rp > 0.0) return rp;
    }
    return update_direction(s, r, 0.0);
}

/* One iteration. Returns by how much the model has fallen, times 2; 0: there is no direction. */
static double iterate(struct pcg *s, double *r, double *y) {
    pdyn_model *m = s->model;
    double rp = choose_direction(s, r);
    m->product(m, s->p, s->q);
    s->curvature = m->dot(m, s->p, s->q);
    if (!(s->curvature > 0.0)) return 0.0;
    m->for_particles(m, GRAIN, pcg_advance, &(struct call){s, r, y, rp / s->curvature});
    return rp * rp / s->curvature;
}

void pcg_solve(struct pcg *s, double *b, double *y, const pdyn_stop *stop, double error,
               int *iterations) {
    pdyn_model *m = s->model;
    double size = m->norm(m, b), target = stop->rel_tol * size;
    double gain = INFINITY, before = INFINITY, all = 0.0;
    int counted = 0; /* iterations whose gains `all` has */
    if (stop->first_of_step) s->curvature = 0.0;
    for (*iterations = 0; *iterations < stop->max_iterations; ++*iterations) {
        bool slow = gain * counted < stop->min_progress * all;
        bool done = !(size > target) || slow || before + gain < error * error * all;
        if (*iterations >= stop->min_iterations && done) return;
        s->precondition(s->self, b, s->z);
        before = gain;
        gain = iterate(s, b, y);
        if (!(gain > 0.0)) return;
        if (*iterations > 0 || stop->min_iterations == 0) all += gain, counted++;
        size = m->norm(m, b);
    }
}
