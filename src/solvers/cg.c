/* Conjugate gradients on H without a matrix, preconditioned with the inverse 3 x 3 block diagonal.
 *
 * H y = -grad E is the equation of a correction, so the iteration is warm started by construction:
 * its first residual is that of the iterate, and the tolerance is relative to it. */
#include "../core/solver.h"
#include "../core/system.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { GRAIN = 8192 };

struct cg {
    pdyn_context *context;
    struct system *system;
    double *r, *z, *p, *q; /* particles x 3 */
    double *inverse;       /* particles x 6: inverse diagonal blocks */
};

struct call {
    struct cg *cg;
    double beta;
};

static void release(void *self) {
    struct cg *cg = self;
    size_t n = cg->system ? (size_t)cg->system->particles : 0;
    FREE_ARRAY(cg->context, cg->r, 3 * n);
    FREE_ARRAY(cg->context, cg->z, 3 * n);
    FREE_ARRAY(cg->context, cg->p, 3 * n);
    FREE_ARRAY(cg->context, cg->q, 3 * n);
    FREE_ARRAY(cg->context, cg->inverse, 6 * n);
}

static pdyn_status create(void *self, pdyn_context *context, struct system *system) {
    struct cg *cg = self;
    size_t n = (size_t)system->particles;
    cg->context = context, cg->system = system;
    cg->r = NEW_ARRAY(context, 3 * n, double);
    cg->z = NEW_ARRAY(context, 3 * n, double);
    cg->p = NEW_ARRAY(context, 3 * n, double);
    cg->q = NEW_ARRAY(context, 3 * n, double);
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

static void precondition(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        const double *D = c->cg->inverse + 6 * i, *r = c->cg->r + 3 * i;
        double *z = c->cg->z + 3 * i;
        z[0] = D[0] * r[0] + D[1] * r[1] + D[2] * r[2];
        z[1] = D[1] * r[0] + D[3] * r[1] + D[4] * r[2];
        z[2] = D[2] * r[0] + D[4] * r[1] + D[5] * r[2];
    }
}

static void next_direction(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = 3 * first; k < 3 * last; k++) c->cg->p[k] = c->cg->z[k] + c->beta * c->cg->p[k];
}

static void for_particles(struct cg *cg, pdyn_range_fn *fn, double beta) {
    struct call call = {cg, beta};
    pool_for(cg->context->pool, cg->system->particles, GRAIN, fn, &call);
}

static pdyn_status solve(void *self, const double *b, double *y, double tolerance,
                         int max_iterations, int *iterations) {
    struct cg *cg = self;
    struct system *sys = cg->system;
    *iterations = 0;
    memcpy(cg->r, b, 3 * (size_t)sys->particles * sizeof *b);
    memset(cg->p, 0, 3 * (size_t)sys->particles * sizeof *b);
    system_diagonal(sys, cg->inverse);
    for_particles(cg, invert_blocks, 0.0);
    double first = system_dot(sys, b, b), rr = first, rz = 0.0;
    while (rr > tolerance * tolerance * first && *iterations < max_iterations) {
        for_particles(cg, precondition, 0.0);
        double rz_new = system_dot(sys, cg->r, cg->z);
        for_particles(cg, next_direction, rz > 0.0 ? rz_new / rz : 0.0);
        rz = rz_new;
        system_apply(sys, cg->p, cg->q);
        double curvature = system_dot(sys, cg->p, cg->q);
        if (!(curvature > 0.0)) break; /* the residual is exhausted, or not a number */
        double alpha = rz / curvature;
        system_axpy(sys, alpha, cg->p, y);
        system_axpy(sys, -alpha, cg->q, cg->r);
        rr = system_dot(sys, cg->r, cg->r);
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
