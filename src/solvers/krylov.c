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

pdyn_status krylov_create(struct krylov *k, pdyn_context *context, struct system *system) {
    int n = system->particles;
    k->context = context, k->system = system;
    k->r = NEW_VECTOR(context, n);
    k->z = NEW_VECTOR(context, n);
    k->p = NEW_VECTOR(context, n);
    k->q = NEW_VECTOR(context, n);
    k->d = NEW_VECTOR(context, n);
    return k->r && k->z && k->p && k->q && k->d ? PDYN_OK : PDYN_NO_MEMORY;
}

void krylov_free(struct krylov *k) {
    if (!k->context) return;
    int n = k->system->particles;
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
    c->k->system->partial[block] = simd_dot(r, p + 3 * first, 3 * (last - first));
}

/* d += scale p, r -= scale q; partial: of |r|, as system_norm */
WIDE static void advance(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *p = c->k->p, *q = c->k->q;
    double *r = c->k->r, *d = c->k->d;
    for (int k = 3 * first; k < 3 * last; k++) {
        d[k] += c->scale * p[k];
        r[k] -= c->scale * q[k];
    }
    c->k->system->partial[block] = system_norm_part(c->k->system, r, first, last);
}

static void for_particles(struct krylov *k, pdyn_range_fn *fn, double scale) {
    struct call call = {k, scale};
    pool_for(k->context->pool, k->system->particles, SYSTEM_GRAIN, fn, &call);
}

/* The direction that goes on from the last one, in the metric of H as it was along that: also from
 * the last one of the solve before, whose model differed little. Returns r.p. */
static double choose_direction(struct krylov *k) {
    double rz = k->precondition(k->self);
    if (k->curvature > 0.0) {
        for_particles(k, next_direction, -system_dot(k->system, k->z, k->q) / k->curvature);
        double rp = system_partial_sum(k->system);
        if (rp > 0.0) return rp;
    }
    memcpy(k->p, k->z, system_bytes(k->system));
    return rz;
}

/* d = H^-1 r with all constraints on the sides where they are, until |r| is at most `target` or
 * an iteration gains too little: the model falls by r.p / 2 times the length of each. */
static void solve_linear(struct krylov *k, double target, const pdyn_goal *goal, int *iterations) {
    struct system *sys = k->system;
    double rr = INFINITY, gained = 0.0, gain = INFINITY;
    memset(k->d, 0, system_bytes(sys));
    k->prepare(k->self);
    for (int done = 0; rr > target * target && *iterations < goal->iterations &&
                       (k->patient || !(gain * done < goal->gain * gained));
         done++) {
        double rp = choose_direction(k);
        system_apply(sys, k->p, k->q);
        k->curvature = system_dot(sys, k->p, k->q);
        if (!(k->curvature > 0.0)) return; /* the residual is exhausted, or not a number */
        for_particles(k, advance, rp / k->curvature);
        rr = system_partial_sum(sys);
        gain = rp * rp / k->curvature, gained += gain;
        ++*iterations;
    }
}

/* ---- the model with its sides ---------------------------------------------------------------- */

/* Goes along d, H d = b - r, to the minimum of the model; b becomes its residual there. Returns how
 * many constraints changed sides. */
static int go_along(struct krylov *k, double *b, double *y) {
    struct system *sys = k->system;
    memcpy(k->z, b, system_bytes(sys));
    system_axpy(sys, -1.0, k->r, k->z);
    double descent = system_dot(sys, b, k->d), curvature = system_dot(sys, k->d, k->z);
    double t = descent > 0.0 ? system_line_minimum(sys, descent, curvature) : 0.0;
    int changed = system_go(sys, t, k->z);
    system_axpy(sys, t, k->d, y);
    system_axpy(sys, -1.0, k->z, b);
    return changed;
}

void krylov_solve(struct krylov *k, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct system *sys = k->system;
    double size = system_norm(sys, b), target = goal->tolerance * size;
    bool own = k->linear;
    *iterations = 0;
    if (goal->first) k->curvature = 0.0;
    for (int n = 0; n < ROUNDS && size > target && *iterations < goal->iterations; n++) {
        double aim_at = sys->changing ? fmax(target, inner * size) : target;
        memcpy(k->r, b, system_bytes(sys));
        own = own && k->linear(k->self, size, aim_at, goal, iterations);
        if (!own) solve_linear(k, aim_at, goal, iterations);
        system_aim(sys, k->d);
        if (aim_at == target && !system_turns(sys)) {
            system_axpy(sys, 1.0, k->d, y);
            return;
        }
        int changed = go_along(k, b, y);
        size = system_norm(sys, b);
        if (!changed && size > 2.0 * aim_at) own = false;
    }
}
