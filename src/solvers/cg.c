/* Conjugate gradients on H without a matrix, preconditioned with the inverse 3 x 3 block diagonal.
 *
 * The model of E is quadratic but for one-sided constraints. These keep their sides for a linear
 * solve; then the model is followed with its sides along what was found, to the minimum there, and
 * the next solve begins from that: a semi-smooth Newton iteration with an exact line search.
 *
 * It looks for a correction, so it is warm started by construction: its first residual is that of
 * the iterate, and the tolerance is relative to it. */
#include "../core/simd.h"
#include "../core/solver.h"
#include "../core/system.h"

#include "projdyn/vec3.h"

#include <string.h>

/* Rounds: linear solves for one model. Inner: what such a solve makes of its residual, at least. */
enum { ROUNDS = 12 };
static const double inner = 0.03;

/* How far above its inertia a preconditioner may hold a particle that only an operator holds. Most
 * motions of a fluid change no density and feel inertia alone; blocks that differ widely there
 * would spread the eigenvalues of these motions, which are one and the same without them. */
static const double most_stiff = 10.0;

struct cg {
    pdyn_context *context;
    struct system *system;
    double *r, *z, *p, *q, *d; /* particles x 3 */
    double *inverse;           /* particles x 6: inverse diagonal blocks */
    bool *held;                /* particles: some rows hold it */
};

struct call {
    struct cg *cg;
    double scale;
};

static void release(void *self) {
    struct cg *cg = self;
    size_t n = cg->system ? (size_t)cg->system->particles : 0;
    FREE_VECTOR(cg->context, cg->r, n);
    FREE_VECTOR(cg->context, cg->z, n);
    FREE_VECTOR(cg->context, cg->p, n);
    FREE_VECTOR(cg->context, cg->q, n);
    FREE_VECTOR(cg->context, cg->d, n);
    FREE_ARRAY(cg->context, cg->inverse, 6 * n);
    FREE_ARRAY(cg->context, cg->held, n);
}

static void find_held(struct cg *cg) {
    for (int b = 0; b < cg->system->batches; b++) {
        const struct batch *batch = cg->system->batch[b];
        for (int i = 0; i < batch->touch_count; i++)
            cg->held[batch->touch_first + i] |= batch->touch_start[i + 1] > batch->touch_start[i];
    }
}

static pdyn_status create(void *self, pdyn_context *context, struct system *system) {
    struct cg *cg = self;
    size_t n = (size_t)system->particles;
    cg->context = context, cg->system = system;
    cg->r = NEW_VECTOR(context, n);
    cg->z = NEW_VECTOR(context, n);
    cg->p = NEW_VECTOR(context, n);
    cg->q = NEW_VECTOR(context, n);
    cg->d = NEW_VECTOR(context, n);
    cg->inverse = NEW_ARRAY(context, 6 * n, double);
    cg->held = NEW_ARRAY(context, n, bool);
    if (!(cg->r && cg->z && cg->p && cg->q && cg->d && cg->inverse && cg->held))
        return PDYN_NO_MEMORY;
    find_held(cg);
    return PDYN_OK;
}

/* Brings the block D of a particle with this inertia, m/h^2, down to what it may be. */
static void soften(double *D, double inertia) {
    double trace = D[0] + D[3] + D[5] - 3.0 * inertia, most = 3.0 * most_stiff * inertia;
    if (trace <= most) return;
    for (int a = 0; a < 6; a++) D[a] *= most / trace;
    for (int a = 0; a < 6; a += a ? 2 : 3) D[a] += inertia * (1.0 - most / trace);
}

/* Symmetric positive definite 3 x 3 blocks, inverted in place by their cofactors. */
static void invert(double *D) {
    double a = D[0], b = D[1], d = D[2], e = D[3], f = D[4], g = D[5];
    double A = e * g - f * f, B = d * f - b * g, C = b * f - d * e;
    double s = 1.0 / (a * A + b * B + d * C);
    D[0] = s * A, D[1] = s * B, D[2] = s * C;
    D[3] = s * (a * g - d * d), D[4] = s * (b * d - a * f), D[5] = s * (a * e - b * b);
}

static void invert_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct system *sys = c->cg->system;
    for (int i = first; i < last; i++) {
        double *D = c->cg->inverse + 6 * i;
        if (!c->cg->held[i]) soften(D, system_inertia(sys, i));
        invert(D);
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

/* d += scale p, r -= scale q; partial: r.r */
WIDE static void advance(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    const double *p = c->cg->p, *q = c->cg->q;
    double *r = c->cg->r, *d = c->cg->d;
    for (int k = 3 * first; k < 3 * last; k++) {
        d[k] += c->scale * p[k];
        r[k] -= c->scale * q[k];
    }
    r += 3 * first;
    c->cg->system->partial[block] = simd_dot(r, r, 3 * (last - first));
}

static void for_particles(struct cg *cg, pdyn_range_fn *fn, double scale) {
    struct call call = {cg, scale};
    pool_for(cg->context->pool, cg->system->particles, SYSTEM_GRAIN, fn, &call);
}

/* d = H^-1 r with all constraints on the sides where they are, until |r| is at most `target`. */
static void solve_linear(struct cg *cg, double target, int max_iterations, int *iterations) {
    struct system *sys = cg->system;
    size_t bytes = 3 * (size_t)sys->particles * sizeof *cg->p;
    double rr = INFINITY, rz = 0.0;
    memset(cg->p, 0, bytes);
    memset(cg->d, 0, bytes);
    system_diagonal(sys, cg->inverse);
    for_particles(cg, invert_blocks, 0.0);
    while (rr > target * target && *iterations < max_iterations) {
        for_particles(cg, precondition, 0.0);
        double before = rz;
        rz = system_partial_sum(sys);
        for_particles(cg, next_direction, before > 0.0 ? rz / before : 0.0);
        system_apply(sys, cg->p, cg->q);
        double curvature = system_dot(sys, cg->p, cg->q);
        if (!(curvature > 0.0)) return; /* the residual is exhausted, or not a number */
        for_particles(cg, advance, rz / curvature);
        rr = system_partial_sum(sys);
        ++*iterations;
    }
}

/* Goes along d to the minimum of the model; b becomes its residual there. Returns how many
 * constraints changed sides. */
static int go_along(struct cg *cg, double *b, double *y) {
    struct system *sys = cg->system;
    system_aim(sys, cg->d, cg->q);
    double descent = system_dot(sys, b, cg->d), curvature = system_dot(sys, cg->d, cg->q);
    double t = descent > 0.0 ? system_line_minimum(sys, descent, curvature) : 0.0;
    int changed = system_go(sys, t, cg->q);
    system_axpy(sys, t, cg->d, y);
    system_axpy(sys, -1.0, cg->q, b);
    return changed;
}

static pdyn_status solve(void *self, double *b, double *y, double tolerance, int max_iterations,
                         int *iterations) {
    struct cg *cg = self;
    struct system *sys = cg->system;
    double size = sqrt(system_dot(sys, b, b)), target = tolerance * size;
    bool solved = false;
    *iterations = 0;
    for (int k = 0; k < ROUNDS && size > target && !solved && *iterations < max_iterations; k++) {
        double aim_at = sys->changing ? fmax(target, inner * size) : target;
        memcpy(cg->r, b, 3 * (size_t)sys->particles * sizeof *b);
        solve_linear(cg, aim_at, max_iterations, iterations);
        solved = !go_along(cg, b, y) && aim_at == target;
        size = sqrt(system_dot(sys, b, b));
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
