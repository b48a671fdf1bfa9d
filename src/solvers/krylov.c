#include "krylov.h"

#include "base/simd.h"

#include <math.h>
#include <string.h>

/* Rounds: linear solves for one model. Inner: what such a solve makes of its residual, at least. */
enum { ROUNDS = 12 };
static const double inner = 0.03;

struct call {
    struct krylov *k;
    double scale;
};

pdyn_status krylov_create(struct krylov *k, pdyn_context *context, struct objective *objective) {
    int n = objective->particles;
    k->context = context, k->objective = objective;
    k->r = NEW_VECTOR(context, n);
    k->z = NEW_VECTOR(context, n);
    k->p = NEW_VECTOR(context, n);
    k->q = NEW_VECTOR(context, n);
    k->d = NEW_VECTOR(context, n);
    return k->r && k->z && k->p && k->q && k->d ? PDYN_OK : PDYN_NO_MEMORY;
}

void krylov_free(struct krylov *k) {
    if (!k->context) return;
    int n = k->objective->particles;
    FREE_VECTOR(k->context, k->r, n);
    FREE_VECTOR(k->context, k->z, n);
    FREE_VECTOR(k->context, k->p, n);
    FREE_VECTOR(k->context, k->q, n);
    FREE_VECTOR(k->context, k->d, n);
}

/* ---- conjugate gradients --------------------------------------------------------------------- */

/* p = z + scale p; partial: r.p */
WIDE static void next_direction(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *z = c->k->z, *r = c->k->r + 3 * first;
    double *p = c->k->p;
    for (int k = 3 * first; k < 3 * last; k++) p[k] = z[k] + c->scale * p[k];
    c->k->objective->partial[block] = simd_dot(r, p + 3 * first, 3 * (last - first));
}

/* d += scale p, r -= scale q; partial: of |r|, as objective_norm */
WIDE static void advance(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *p = c->k->p, *q = c->k->q;
    double *r = c->k->r, *d = c->k->d;
    for (int k = 3 * first; k < 3 * last; k++) {
        d[k] += c->scale * p[k];
        r[k] -= c->scale * q[k];
    }
    c->k->objective->partial[block] = objective_norm_part(c->k->objective, r, first, last);
}

static void for_particles(struct krylov *k, pdyn_range_fn *fn, double scale) {
    struct call call = {k, scale};
    pool_for(k->context->pool, k->objective->particles, PARTICLE_GRAIN, fn, &call);
}

/* The direction that goes on from the last one, in the metric of H as it was along that: also from
 * the last one of the solve before, whose model differed little. Returns r.p. */
static double choose_direction(struct krylov *k) {
    double rz = k->precondition(k->self);
    if (k->curvature > 0.0) {
        for_particles(k, next_direction, -objective_dot(k->objective, k->z, k->q) / k->curvature);
        double rp = objective_partial_sum(k->objective);
        if (rp > 0.0) return rp;
    }
    memcpy(k->p, k->z, objective_bytes(k->objective));
    return rz;
}

/* d = H^-1 r with all constraints on the sides where they are, until |r| is at most `target` or
 * an iteration gains too little: the model falls by r.p / 2 times the length of each. */
static void solve_linear(struct krylov *k, double target, const pdyn_stop *stop, int *iterations) {
    struct objective *sys = k->objective;
    double rr = INFINITY, gained = 0.0, gain = INFINITY;
    memset(k->d, 0, objective_bytes(sys));
    k->prepare(k->self);
    for (int done = 0; rr > target * target && *iterations < stop->max_iterations &&
                       (k->patient || !(gain * done < stop->min_progress * gained));
         done++) {
        double rp = choose_direction(k);
        objective_apply(sys, k->p, k->q);
        k->curvature = objective_dot(sys, k->p, k->q);
        if (!(k->curvature > 0.0)) return; /* the residual is exhausted, or not a number */
        for_particles(k, advance, rp / k->curvature);
        rr = objective_partial_sum(sys);
        gain = rp * rp / k->curvature, gained += gain;
        ++*iterations;
    }
}

/* ---- the model with its sides ---------------------------------------------------------------- */

/* Goes along d, H d = b - r, to the minimum of the model; b becomes its residual there. Returns how
 * many constraints changed sides. */
static int go_along(struct krylov *k, double *b, double *y) {
    struct objective *sys = k->objective;
    memcpy(k->z, b, objective_bytes(sys));
    objective_axpy(sys, -1.0, k->r, k->z);
    double descent = objective_dot(sys, b, k->d), curvature = objective_dot(sys, k->d, k->z);
    double t = descent > 0.0 ? objective_line_minimum(sys, descent, curvature) : 0.0;
    int changed = objective_go(sys, t, k->z);
    objective_axpy(sys, t, k->d, y);
    objective_axpy(sys, -1.0, k->z, b);
    return changed;
}

void krylov_solve(struct krylov *k, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct objective *sys = k->objective;
    double size = objective_norm(sys, b), target = stop->rel_tol * size;
    bool own = k->linear;
    *iterations = 0;
    if (stop->first_of_step) k->curvature = 0.0;
    for (int n = 0; n < ROUNDS && size > target && *iterations < stop->max_iterations; n++) {
        double aim_at = sys->dynamic_rows ? fmax(target, inner * size) : target;
        memcpy(k->r, b, objective_bytes(sys));
        own = own && k->linear(k->self, size, aim_at, stop, iterations);
        if (!own) solve_linear(k, aim_at, stop, iterations);
        objective_aim(sys, k->d);
        if (aim_at == target && !objective_turns(sys)) {
            objective_axpy(sys, 1.0, k->d, y);
            return;
        }
        int changed = go_along(k, b, y);
        size = objective_norm(sys, b);
        if (!changed && size > 2.0 * aim_at) own = false;
    }
}
