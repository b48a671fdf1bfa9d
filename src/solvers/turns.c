#include "turns.h"

#include "../core/simd.h"
#include "blocks.h"

#include <math.h>
#include <string.h>

/* omega: where D is the largest that neighbours allow, 2 / omega D must be above H. */
static const double relaxed = 0.6;

/* A step that differs from that of the factor by more than this ratio is what another factor would
 * help; that pays after about as many iterations. */
static const double same_step = 1.5;
enum { WORTH_FACTOR = 30 };

void turns_free(struct turns *s) {
    if (!s->krylov) return;
    struct krylov *k = s->krylov;
    matrix_free(&s->matrix);
    factor_free(&s->factor);
    FREE_VECTOR(k->context, s->t, k->system->particles);
}

/* ---- the preconditioner ---------------------------------------------------------------------- */

static double for_particles(struct turns *s, pdyn_range_fn *fn) {
    pool_for(s->krylov->context->pool, s->krylov->system->particles, SYSTEM_GRAIN, fn, s);
    return system_partial_sum(s->krylov->system);
}

/* z = omega D^-1 r; partial: r.z */
WIDE static void smooth_first(void *arg, int first, int last, int block) {
    const struct turns *s = arg;
    const double *r = s->krylov->r + 3 * (size_t)first;
    double *z = s->krylov->z + 3 * (size_t)first;
    for (int i = 0; i < last - first; i++) {
        block_multiply(z + 3 * i, s->jacobi->inverse + 6 * (size_t)(first + i), r + 3 * i);
        for (int a = 0; a < 3; a++) z[3 * i + a] *= s->omega;
    }
    s->krylov->system->partial[block] = simd_dot(r, z, 3 * (last - first));
}

/* t = r - t; partial: z.t */
WIDE static void find_rest(void *arg, int first, int last, int block) {
    const struct turns *s = arg;
    const double *r = s->krylov->r, *z = s->krylov->z + 3 * (size_t)first;
    for (int k = 3 * first; k < 3 * last; k++) s->t[k] = r[k] - s->t[k];
    s->krylov->system->partial[block] = simd_dot(s->t + 3 * (size_t)first, z, 3 * (last - first));
}

/* z += t */
WIDE static void add_coarse(void *arg, int first, int last, int block) {
    (void)block;
    const struct turns *s = arg;
    for (int k = 3 * first; k < 3 * last; k++) s->krylov->z[k] += s->t[k];
}

/* z += omega D^-1 (r - t); partial: r.z */
WIDE static void smooth_last(void *arg, int first, int last, int block) {
    const struct turns *s = arg;
    const double *r = s->krylov->r + 3 * (size_t)first, *t = s->t + 3 * (size_t)first;
    double *z = s->krylov->z + 3 * (size_t)first;
    for (int i = 0; i < last - first; i++) {
        double rest[3], more[3];
        for (int a = 0; a < 3; a++) rest[a] = r[3 * i + a] - t[3 * i + a];
        block_multiply(more, s->jacobi->inverse + 6 * (size_t)(first + i), rest);
        for (int a = 0; a < 3; a++) z[3 * i + a] += s->omega * more[a];
    }
    s->krylov->system->partial[block] = simd_dot(r, z, 3 * (last - first));
}

/* The two smoothings alone are 2 omega D^-1 - omega^2 D^-1 H D^-1, positive where omega is small
 * enough for the D and H at hand. Every residual tells whether it is, by what the first one leaves;
 * where it is not, omega falls, for good. */
double turns_precondition(struct turns *s) {
    struct system *sys = s->krylov->system;
    double *z = s->krylov->z, rz = for_particles(s, smooth_first);
    system_apply(sys, z, s->t);
    while (for_particles(s, find_rest) < -0.9 * rz) {
        s->omega *= 0.7;
        s->krylov->restart = true;
        rz = for_particles(s, smooth_first);
        system_apply(sys, z, s->t);
    }
    factor_solve(&s->factor, s->t, s->t);
    for_particles(s, add_coarse);
    system_apply(sys, z, s->t);
    return for_particles(s, smooth_last);
}

/* ---- the factor ------------------------------------------------------------------------------ */

/* The numbers of A for steps of length h. */
static void fill_matrix(struct turns *s, double h) {
    struct system *sys = s->krylov->system;
    double now = sys->h;
    sys->h = h;
    for (int b = 0; b < sys->batches; b++) batch_weigh(sys->batch[b], h);
    matrix_values(&s->matrix, sys, sys->batch);
    sys->h = now;
    for (int b = 0; b < sys->batches; b++) batch_weigh(sys->batch[b], now);
}

static pdyn_status make_factor(struct turns *s, double h) {
    bool first = !s->matrix.particles;
    pdyn_status status = PDYN_OK;
    if (first) status = matrix_pattern(&s->matrix, s->krylov->system, s->krylov->system->batch, 1);
    if (status != PDYN_OK) return status;
    fill_matrix(s, h);
    if (first) status = factor_analyse(&s->factor, &s->matrix, true);
    if (status == PDYN_OK) status = factor_numbers(&s->factor, &s->matrix);
    s->h = s->made = h;
    return status;
}

static bool is_strange(const struct turns *s) {
    double h = s->krylov->system->h;
    return fmax(h / s->h, s->h / h) > same_step;
}

pdyn_status turns_update(struct turns *s) {
    bool other = s->h == 0.0 || (is_strange(s) && s->strange >= WORTH_FACTOR);
    if (other) s->strange = 0;
    if (!other && s->made == s->h) return PDYN_OK;
    return make_factor(s, other ? s->krylov->system->h : s->h);
}

void turns_persist(struct turns *s, pdyn_archive *archive) {
    archive->bytes(archive, &s->h, sizeof s->h);
    archive->bytes(archive, &s->omega, sizeof s->omega);
    archive->bytes(archive, &s->strange, sizeof s->strange);
}

pdyn_status turns_create(struct turns *s, struct krylov *krylov, const struct jacobi *jacobi) {
    s->krylov = krylov, s->jacobi = jacobi, s->omega = relaxed;
    factor_start(&s->factor, krylov->context);
    s->t = NEW_VECTOR(krylov->context, krylov->system->particles);
    return s->t ? PDYN_OK : PDYN_NO_MEMORY;
}

void turns_note(struct turns *s, int iterations) {
    if (is_strange(s)) s->strange += iterations;
}
