#include "residual.h"

#include "base/body.h"
#include "projdyn/simd.h"

#include <math.h>
#include <string.h>

struct call {
    struct objective *objective;
    const double *a;
};

/* The sum of the partial sums of fn over particles. */
static double sum_between(struct objective *o, int first, int last, pdyn_range_fn *fn,
                          const double *a) {
    struct call call = {o, a};
    return objective_partial_sum(
        o, pool_for_between(o->context->pool, first, last, PARTICLE_GRAIN, fn, &call));
}

/* ---- bodies ---------------------------------------------------------------------------------- */

WIDE static void squares_block(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *own = c->a + 3 * (size_t)first;
    c->objective->partial[block] = simd_dot(own, own, 3 * (last - first));
}

/* The norm of a vector, particles x 3, over the particles of a body. */
static double body_norm(struct objective *o, const struct objective_body *body,
                        const double *vector) {
    return sqrt(sum_between(o, body->first, body->first + body->count, squares_block, vector));
}

static double scale_of(const struct objective_body *body) {
    return fmax(body->weight, body->impact) + body->load;
}

/* ---- loads ----------------------------------------------------------------------------------- */

/* A matrix-free constraint beside surfaces. Contact puts no load: its forces in a fold are balanced
 * only by friction, and a residual of a part of them would let the fold creep. */
static bool puts_load(const struct batch *batch) { return batch->samples; }

pdyn_status residual_create(struct objective *o) {
    bool loads = false;
    for (int b = 0; b < o->batches; b++) loads |= puts_load(o->batch[b]);
    if (loads) o->without_load = NEW_VECTOR(o->context, o->particles);
    return loads && !o->without_load ? PDYN_NO_MEMORY : PDYN_OK;
}

void residual_free(struct objective *o) { FREE_VECTOR(o->context, o->without_load, o->particles); }

/* A constraint puts no load on its own body: its forces there are part of the residual. */
static bool is_own(const struct batch *batch, const struct objective_body *body) {
    return batch->view.body == body->of;
}

/* A fluid is solved to its density, not to a part of its impact. */
static double impact_on(struct objective *o, const struct objective_body *body,
                        const double *inertial) {
    return o->contact && !body_is_particles(body->of) ? body_norm(o, body, inertial) : 0.0;
}

void residual_open(struct objective *o, const double *inertial) {
    for (int b = 0; b < o->bodies; b++)
        o->body[b].impact = impact_on(o, &o->body[b], inertial), o->body[b].load = 0.0;
}

void residual_open_load(struct objective *o, const struct batch *batch, const double *gradient) {
    if (puts_load(batch)) memcpy(o->without_load, gradient, objective_bytes(o));
}

void residual_add_load(struct objective *o, const struct batch *batch, const double *gradient) {
    if (!puts_load(batch)) return;
    objective_axpy(o, -1.0, gradient, o->without_load);
    for (int b = 0; b < o->bodies; b++)
        if (!is_own(batch, &o->body[b]))
            o->body[b].load += body_norm(o, &o->body[b], o->without_load);
}

/* ---- residuals ------------------------------------------------------------------------------- */

/* The sum over bodies of |r|^2 / scale^2, of particles from `first` to before `last`. */
INLINE double norm_part(const struct objective *o, const double *r, int first, int last) {
    double sum = 0.0;
    for (int b = objective_body_of(o, first), end; first < last; first = end, b++) {
        const struct objective_body *body = &o->body[b];
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

double objective_norm_between(struct objective *o, int first, int last, const double *r) {
    return sqrt(sum_between(o, first, last, norm_block, r));
}

double objective_norm(struct objective *o, const double *r) {
    return objective_norm_between(o, 0, o->particles, r);
}

double objective_residual(struct objective *o, const double *gradient) {
    double largest = 0.0;
    for (int b = 0; b < o->bodies; b++) {
        struct objective_body *body = &o->body[b];
        body->residual = body_norm(o, body, gradient) / scale_of(body);
        /* unlike fmax, keeps a NaN */
        if (!(body->residual <= largest)) largest = body->residual;
    }
    return largest;
}
