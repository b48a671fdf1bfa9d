#include "residual.h"

#include "projdyn/simd.h"

#include <math.h>
#include <string.h>

struct call {
    struct objective *objective;
    const double *a;
};

/* The sum of the partial sums of fn over particles. */
static double sum_between(struct objective *sys, int first, int last, pdyn_range_fn *fn,
                          const double *a) {
    struct call call = {sys, a};
    return objective_partial_sum(
        sys, pool_for_between(sys->context->pool, first, last, PARTICLE_GRAIN, fn, &call));
}

/* ---- bodies ---------------------------------------------------------------------------------- */

int objective_body_of(const struct objective *sys, int particle) {
    int low = 0, high = sys->bodies;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (sys->body[middle].first <= particle) low = middle;
        else high = middle;
    }
    return low;
}

WIDE static void squares_block(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *own = c->a + 3 * (size_t)first;
    c->objective->partial[block] = simd_dot(own, own, 3 * (last - first));
}

/* The norm of a vector, particles x 3, over the particles of a body. */
static double body_norm(struct objective *sys, const struct objective_body *body,
                        const double *vector) {
    return sqrt(sum_between(sys, body->first, body->first + body->count, squares_block, vector));
}

static double scale_of(const struct objective_body *body) { return body->weight + body->load; }

/* ---- loads ----------------------------------------------------------------------------------- */

/* A matrix-free constraint beside surfaces. Contact puts no load: its forces in a fold are balanced
 * only by friction, and a residual of a part of them would let the fold creep. */
static bool puts_load(const struct batch *batch) { return batch->samples; }

pdyn_status residual_create(struct objective *sys) {
    bool loads = false;
    for (int b = 0; b < sys->batches; b++) loads |= puts_load(sys->batch[b]);
    if (loads) sys->before = NEW_VECTOR(sys->context, sys->particles);
    return loads && !sys->before ? PDYN_NO_MEMORY : PDYN_OK;
}

void residual_free(struct objective *sys) {
    FREE_VECTOR(sys->context, sys->before, sys->particles);
}

/* A constraint puts no load on its own body: what acts there are the forces that are solved for. */
static bool is_own(const struct batch *batch, const struct objective_body *body) {
    return batch->view.body == body->of;
}

void residual_forget_loads(struct objective *sys) {
    for (int b = 0; b < sys->bodies; b++) sys->body[b].load = 0.0;
}

void residual_open_load(struct objective *sys, const struct batch *batch, const double *gradient) {
    if (puts_load(batch)) memcpy(sys->before, gradient, objective_bytes(sys));
}

void residual_add_load(struct objective *sys, const struct batch *batch, const double *gradient) {
    if (!puts_load(batch)) return;
    objective_axpy(sys, -1.0, gradient, sys->before);
    for (int b = 0; b < sys->bodies; b++)
        if (!is_own(batch, &sys->body[b]))
            sys->body[b].load += body_norm(sys, &sys->body[b], sys->before);
}

/* ---- residuals ------------------------------------------------------------------------------- */

/* The sum over bodies of |r|^2 / scale^2, of particles from `first` to before `last`. */
INLINE double norm_part(const struct objective *sys, const double *r, int first, int last) {
    double sum = 0.0;
    for (int b = objective_body_of(sys, first), end; first < last; first = end, b++) {
        const struct objective_body *body = &sys->body[b];
        double scale = scale_of(body);
        end = body->first + body->count < last ? body->first + body->count : last;
        const double *own = r + 3 * (size_t)first;
        sum += simd_dot(own, own, 3 * (end - first)) / (scale * scale);
    }
    return sum;
}

WIDE static void norm_block(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    c->objective->partial[block] = norm_part(c->objective, c->a, first, last);
}

double objective_norm_between(struct objective *sys, int first, int last, const double *r) {
    return sqrt(sum_between(sys, first, last, norm_block, r));
}

double objective_norm(struct objective *sys, const double *r) {
    return objective_norm_between(sys, 0, sys->particles, r);
}

double objective_residual(struct objective *sys, const double *gradient) {
    double largest = 0.0;
    for (int b = 0; b < sys->bodies; b++) {
        struct objective_body *body = &sys->body[b];
        body->residual = body_norm(sys, body, gradient) / scale_of(body);
        /* unlike fmax, keeps a NaN */
        if (!(body->residual <= largest)) largest = body->residual;
    }
    return largest;
}
