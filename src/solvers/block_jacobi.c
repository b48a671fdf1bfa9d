#include "block_jacobi.h"

#include "memory.h"
#include "projdyn/simd.h"
#include "projdyn/vec3.h"

enum { GRAIN = 2048 }; /* particles per parallel block */

/* The block of a particle in no row is limited to this many times its inertia. Such a particle is
 * held by a matrix-free constraint alone, as in a fluid. Most motions of a fluid change no density
 * and feel inertia alone: they share one eigenvalue of H, which blocks that differ widely from
 * particle to particle would spread. Measured on dam breaks: iterations stop to fall beyond 10. */
static const double max_stiffness = 10.0;

struct call {
    const struct block_jacobi *jacobi;
    const double *r;
    double *z;
};

/* Scales the block D of a particle with this inertia, m/h^2, down to the limit. */
static void limit_block(double *D, double inertia) {
    double trace = D[0] + D[3] + D[5] - 3.0 * inertia, limit = 3.0 * max_stiffness * inertia;
    if (trace <= limit) return;
    for (int a = 0; a < 6; a++) D[a] *= limit / trace;
    vec3_add_identity(D, inertia * (1.0 - limit / trace));
}

/* D becomes its inverse, by cofactors. */
INLINE void invert_block(double *D) {
    double a = D[0], b = D[1], d = D[2], e = D[3], f = D[4], g = D[5];
    double A = e * g - f * f, B = d * f - b * g, C = b * f - d * e;
    double s = 1.0 / (a * A + b * B + d * C);
    D[0] = s * A, D[1] = s * B, D[2] = s * C;
    D[3] = s * (a * g - d * d), D[4] = s * (b * d - a * f), D[5] = s * (a * e - b * b);
}

static void invert_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct block_jacobi *s = ((const struct call *)arg)->jacobi;
    const pdyn_model *m = s->model;
    for (int i = first; i < last; i++) {
        double *D = s->inverse + 6 * (size_t)i;
        if (!m->in_rows[i]) limit_block(D, m->mass[i] / (m->h * m->h));
        invert_block(D);
    }
}

WIDE static void block_jacobi_multiply(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++) {
        const double *D = c->jacobi->inverse + 6 * (size_t)i, *r = c->r + 3 * (size_t)i;
        double *z = c->z + 3 * (size_t)i;
        z[0] = D[0] * r[0] + D[1] * r[1] + D[2] * r[2];
        z[1] = D[1] * r[0] + D[3] * r[1] + D[4] * r[2];
        z[2] = D[2] * r[0] + D[4] * r[1] + D[5] * r[2];
    }
}

pdyn_status block_jacobi_create(struct block_jacobi *s, pdyn_model *model) {
    s->model = model;
    s->inverse = NEW(model->services, 6 * (size_t)model->particles, double);
    return s->inverse || !model->particles ? PDYN_OK : PDYN_NO_MEMORY;
}

void block_jacobi_free(struct block_jacobi *s) {
    if (s->model) FREE(s->model->services, s->inverse, 6 * (size_t)s->model->particles);
}

void block_jacobi_update(struct block_jacobi *s) {
    const pdyn_services *services = s->model->services;
    s->model->diagonal(s->model, PDYN_WHOLE, s->inverse);
    services->parallel_for(services->core, s->model->particles, GRAIN, invert_blocks,
                           &(struct call){.jacobi = s});
}

void block_jacobi_apply(const struct block_jacobi *s, const double *r, double *z) {
    s->model->for_particles(s->model, GRAIN, block_jacobi_multiply, &(struct call){s, r, z});
    if (s->model->solve_bodies) s->model->solve_bodies(s->model, r, z);
}
