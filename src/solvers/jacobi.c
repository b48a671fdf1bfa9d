#include "jacobi.h"

#include "blocks.h"

/* How far above its inertia a preconditioner may hold a particle that only an operator holds. Most
 * motions of a fluid change no density and feel inertia alone; blocks that differ widely there
 * would spread the eigenvalues of these motions, which are one and the same without them. */
static const double most_stiff = 10.0;

/* Brings the block D of a particle with this inertia, m/h^2, down to what it may be. */
static void soften(double *D, double inertia) {
    double trace = D[0] + D[3] + D[5] - 3.0 * inertia, most = 3.0 * most_stiff * inertia;
    if (trace <= most) return;
    for (int a = 0; a < 6; a++) D[a] *= most / trace;
    for (int a = 0; a < 6; a += a ? 2 : 3) D[a] += inertia * (1.0 - most / trace);
}

static void invert_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct jacobi *s = arg;
    for (int i = first; i < last; i++) {
        double *D = s->inverse + 6 * (size_t)i;
        if (!s->held[i]) soften(D, objective_inertia(s->objective, i));
        block_invert(D);
    }
}

/* z = D^-1 r; partial: r.z */
WIDE static void precondition_block(void *arg, int first, int last, int block) {
    const struct jacobi *s = arg;
    const double *r = s->r + 3 * (size_t)first;
    double *z = s->z + 3 * (size_t)first;
    for (int i = first; i < last; i++)
        block_multiply(z + 3 * (i - first), s->inverse + 6 * (size_t)i, r + 3 * (i - first));
    s->objective->partial[block] = simd_dot(r, z, 3 * (last - first));
}

pdyn_status jacobi_create(struct jacobi *s, struct objective *objective) {
    size_t n = (size_t)objective->particles;
    s->objective = objective;
    s->inverse = NEW_ARRAY(objective->context, 6 * n, double);
    s->held = NEW_ARRAY(objective->context, n, bool);
    if (n && (!s->inverse || !s->held)) return PDYN_NO_MEMORY;
    for (int b = 0; b < objective->batches; b++) batch_mark_held(objective->batch[b], s->held);
    return PDYN_OK;
}

void jacobi_free(struct jacobi *s) {
    if (!s->objective) return;
    size_t n = (size_t)s->objective->particles;
    FREE_ARRAY(s->objective->context, s->inverse, 6 * n);
    FREE_ARRAY(s->objective->context, s->held, n);
}

static void for_particles(struct jacobi *s, pdyn_range_fn *fn) {
    pool_for(s->objective->context->pool, s->objective->particles, PARTICLE_GRAIN, fn, s);
}

void jacobi_invert(struct jacobi *s) { for_particles(s, invert_blocks); }

void jacobi_prepare(struct jacobi *s) {
    objective_diagonal(s->objective, s->inverse);
    jacobi_invert(s);
}

double jacobi_apply(struct jacobi *s, const double *r, double *z) {
    s->r = r, s->z = z;
    for_particles(s, precondition_block);
    return objective_partial_sum(s->objective);
}
