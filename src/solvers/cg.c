/* Conjugate gradients on H without a matrix, preconditioned with the inverse 3 x 3 block diagonal.
 *
 * H y = -grad E is the equation of a correction, so the iteration is warm started by construction:
 * its first residual is that of the iterate, and the tolerance is relative to it. */
#include "../core/simd.h"
#include "../core/solver.h"
#include "../core/system.h"

#include "projdyn/vec3.h"

#include <string.h>

struct cg {
    pdyn_context *context;
    struct system *system;
    double *r, *z, *p, *q; /* particles x 3 */
    double *inverse;       /* particles x 6: inverse diagonal blocks */
};

struct call {
    struct cg *cg;
    double scale;
    double *y;
};

static void release(void *self) {
    struct cg *cg = self;
    size_t n = cg->system ? (size_t)cg->system->particles : 0;
    FREE_VECTOR(cg->context, cg->r, n);
    FREE_VECTOR(cg->context, cg->z, n);
    FREE_VECTOR(cg->context, cg->p, n);
    FREE_VECTOR(cg->context, cg->q, n);
    FREE_ARRAY(cg->context, cg->inverse, 6 * n);
}

static pdyn_status create(void *self, pdyn_context *context, struct system *system) {
    struct cg *cg = self;
    size_t n = (size_t)system->particles;
    cg->context = context, cg->system = system;
    cg->r = NEW_VECTOR(context, n);
    cg->z = NEW_VECTOR(context, n);
    cg->p = NEW_VECTOR(context, n);
    cg->q = NEW_VECTOR(context, n);
    cg->inverse = NEW_ARRAY(context, 6 * n, double);
    return cg->r && cg->z && cg->p && cg->q && cg->inverse ? PDYN_OK : PDYN_NO_MEMORY;
}

/* Symmetric positive definite 3 x 3 blocks, inverted in place by their cofactors. */
static void invert_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        double *D = c->cg->inverse + 6 * i;
        double a = D[0], b = D[1], d = D[2], e = D[3], f = D[4], g = D[5];
        double A = e * g - f * f, B = d * f - b * g, C = b * f - d * e;
        double s = 1.0 / (a * A + b * B + d * C);
        D[0] = s * A, D[1] = s * B, D[2] = s * C;
        D[3] = s * (a * g - d * d), D[4] = s * (b * d - a * f), D[5] = s * (a * e - b * b);
    }
}

/* z = D^-1 r; partial: r.z */
WIDE static void precondition(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        const double *D = c->cg->inverse + 6 * i, *r = c->cg->r + 3 * i;
        double *z = c->cg->z + 3 * i;
        z[0] = D[0] * r[0] + D[1] * r[1] + D[2] * r[2];
        z[1] = D[1] * r[0] + D[3] * r[1] + D[4] * r[2];
        z[2] = D[2] * r[0] + D[4] * r[1] + D[5] * r[2];
    }
    const double *r = c->cg->r + 3 * first, *z = c->cg->z + 3 * first;
    c->cg->system->partial[block] = simd_dot(r, z, 3 * (last - first));
}

/* p = z + scale p */
WIDE static void next_direction(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    double *p = c->cg->p;
    for (int k = 3 * first; k < 3 * last; k++) p[k] = c->cg->z[k] + c->scale * p[k];
}

/* y += scale p, r -= scale q; partial: r.r */
WIDE static void advance(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *p = c->cg->p, *q = c->cg->q;
    double *r = c->cg->r, *y = c->y;
    for (int k = 3 * first; k < 3 * last; k++) {
        y[k] += c->scale * p[k];
        r[k] -= c->scale * q[k];
    }
    r += 3 * first;
    c->cg->system->partial[block] = simd_dot(r, r, 3 * (last - first));
}

static void for_particles(struct cg *cg, pdyn_range_fn *fn, double scale, double *y) {
    struct call call = {cg, scale, y};
    pool_for(cg->context->pool, cg->system->particles, SYSTEM_GRAIN, fn, &call);
}

static pdyn_status solve(void *self, const double *b, double *y, double tolerance,
                         int max_iterations, int *iterations) {
    struct cg *cg = self;
    struct system *sys = cg->system;
    *iterations = 0;
    memcpy(cg->r, b, 3 * (size_t)sys->particles * sizeof *b);
    memset(cg->p, 0, 3 * (size_t)sys->particles * sizeof *b);
    system_diagonal(sys, cg->inverse);
    for_particles(cg, invert_blocks, 0.0, NULL);
    double first = system_dot(sys, b, b), rr = first, rz = 0.0;
    while (rr > tolerance * tolerance * first && *iterations < max_iterations) {
        for_particles(cg, precondition, 0.0, NULL);
        double before = rz;
        rz = system_partial_sum(sys);
        for_particles(cg, next_direction, before > 0.0 ? rz / before : 0.0, NULL);
        system_apply(sys, cg->p, cg->q);
        double curvature = system_dot(sys, cg->p, cg->q);
        if (!(curvature > 0.0)) break; /* the residual is exhausted, or not a number */
        for_particles(cg, advance, rz / curvature, y);
        rr = system_partial_sum(sys);
        ++*iterations;
    }
    return PDYN_OK;
}

const struct solver_type pdyn_solver_cg = {
    .name = "cg",
    .summary =
        "conjugate gradients without a matrix, preconditioned by 3 x 3 blocks; for scenes that "
        "change every step and for the newton step",
    .state_size = sizeof(struct cg),
    .create = create,
    .solve = solve,
    .free = release,
};
