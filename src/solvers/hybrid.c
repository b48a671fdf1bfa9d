/* Conjugate gradients (krylov.h) on H, preconditioned by a factor and by blocks in turn:
 *
 *     z = omega D^-1 r,   z += A^-1 (r - H z),   z += omega D^-1 (r - H z)
 *
 * A is the matrix of the projective step, of what is static: it knows how a push travels through a
 * sheet, but resists every motion alike. D, the block diagonal of H, knows how soft each particle
 * is along every direction, but nothing of its neighbours. Each removes what the other leaves, as
 * smoother and coarse level do in multigrid.
 *
 * A is factored once. Where the length of the step changes, its old factor still is a
 * preconditioner. */
#include "blocks.h"
#include "factor.h"
#include "krylov.h"

#include <math.h>
#include <string.h>

/* omega: where D is the largest that neighbours allow, 2 / omega D must be above H. */
static const double relaxed = 0.6;

/* A step that differs from that of the factor by more than this ratio is what another factor would
 * help; that pays after about as many iterations. */
static const double same_step = 1.5;
enum { WORTH_FACTOR = 30 };

struct hybrid {
    struct krylov krylov;
    struct matrix matrix;
    struct factor factor;
    struct batch **rows; /* batches of the system: those in A, NULL for others */
    bool *held;          /* particles: A knows more of them than inertia */
    double *inverse;     /* particles x 6: inverse diagonal blocks */
    double *t;           /* particles x 3 */
    double h;            /* s: the factor is for steps of this length; 0: not known yet */
    double made;         /* s: it was made for this one; 0: not yet */
    double omega;
    int strange; /* iterations with a factor for steps of another length */
};

static void release(void *self) {
    struct hybrid *s = self;
    struct krylov *k = &s->krylov;
    int n = k->system ? k->system->particles : 0;
    if (!k->context) return;
    matrix_free(&s->matrix);
    factor_free(&s->factor);
    FREE_ARRAY(k->context, s->rows, k->system->batches);
    FREE_ARRAY(k->context, s->held, n);
    FREE_ARRAY(k->context, s->inverse, 6 * (size_t)n);
    FREE_VECTOR(k->context, s->t, n);
    krylov_free(k);
}

/* What is static goes into A. */
static void choose_rows(struct hybrid *s) {
    const struct system *sys = s->krylov.system;
    for (int b = 0; b < sys->batches; b++) {
        struct batch *batch = sys->batch[b];
        if (batch->op || batch->changing) continue;
        s->rows[b] = batch;
        for (int i = 0; i < batch->touch_count; i++)
            s->held[batch->touch_first + i] |= batch->touch_start[i + 1] > batch->touch_start[i];
    }
}

/* ---- the preconditioner ---------------------------------------------------------------------- */

static double for_particles(struct hybrid *s, pdyn_range_fn *fn) {
    pool_for(s->krylov.context->pool, s->krylov.system->particles, SYSTEM_GRAIN, fn, s);
    return system_partial_sum(s->krylov.system);
}

static void invert_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct hybrid *s = arg;
    for (int i = first; i < last; i++) block_invert(s->inverse + 6 * (size_t)i);
}

/* z = omega D^-1 r; partial: r.z */
WIDE static void smooth_first(void *arg, int first, int last, int block) {
    const struct hybrid *s = arg;
    const double *r = s->krylov.r + 3 * (size_t)first;
    double *z = s->krylov.z + 3 * (size_t)first;
    for (int i = 0; i < last - first; i++) {
        block_multiply(z + 3 * i, s->inverse + 6 * (size_t)(first + i), r + 3 * i);
        for (int a = 0; a < 3; a++) z[3 * i + a] *= s->omega;
    }
    s->krylov.system->partial[block] = simd_dot(r, z, 3 * (last - first));
}

/* t = r - t; partial: z.t */
WIDE static void find_rest(void *arg, int first, int last, int block) {
    const struct hybrid *s = arg;
    const double *r = s->krylov.r, *z = s->krylov.z + 3 * (size_t)first;
    for (int k = 3 * first; k < 3 * last; k++) s->t[k] = r[k] - s->t[k];
    s->krylov.system->partial[block] = simd_dot(s->t + 3 * (size_t)first, z, 3 * (last - first));
}

/* z += t, where A knows something */
WIDE static void add_coarse(void *arg, int first, int last, int block) {
    (void)block;
    const struct hybrid *s = arg;
    for (int i = first; i < last; i++)
        for (int k = 3 * i; s->held[i] && k < 3 * i + 3; k++) s->krylov.z[k] += s->t[k];
}

/* z += omega D^-1 (r - t); partial: r.z */
WIDE static void smooth_last(void *arg, int first, int last, int block) {
    const struct hybrid *s = arg;
    const double *r = s->krylov.r + 3 * (size_t)first, *t = s->t + 3 * (size_t)first;
    double *z = s->krylov.z + 3 * (size_t)first;
    for (int i = 0; i < last - first; i++) {
        double rest[3], more[3];
        for (int a = 0; a < 3; a++) rest[a] = r[3 * i + a] - t[3 * i + a];
        block_multiply(more, s->inverse + 6 * (size_t)(first + i), rest);
        for (int a = 0; a < 3; a++) z[3 * i + a] += s->omega * more[a];
    }
    s->krylov.system->partial[block] = simd_dot(r, z, 3 * (last - first));
}

static void prepare(void *self) {
    struct hybrid *s = self;
    system_diagonal(s->krylov.system, s->inverse);
    for_particles(s, invert_blocks);
}

/* The two smoothings alone are 2 omega D^-1 - omega^2 D^-1 H D^-1, positive where omega is small
 * enough for the D and H at hand. Every residual tells whether it is, by what the first one leaves;
 * where it is not, omega falls, for good. */
static double precondition(void *self) {
    struct hybrid *s = self;
    struct system *sys = s->krylov.system;
    double *z = s->krylov.z, rz = for_particles(s, smooth_first);
    system_apply(sys, z, s->t);
    while (for_particles(s, find_rest) < -0.9 * rz) {
        s->omega *= 0.7;
        s->krylov.restart = true;
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
static void fill_matrix(struct hybrid *s, double h) {
    struct system *sys = s->krylov.system;
    double now = sys->h;
    sys->h = h;
    for (int b = 0; b < sys->batches; b++) batch_weigh(sys->batch[b], h);
    matrix_values(&s->matrix, sys, s->rows);
    sys->h = now;
    for (int b = 0; b < sys->batches; b++) batch_weigh(sys->batch[b], now);
}

static pdyn_status make_factor(struct hybrid *s, double h) {
    bool first = !s->matrix.particles;
    pdyn_status status = PDYN_OK;
    if (first) status = matrix_pattern(&s->matrix, s->krylov.system, s->rows, 1);
    if (status != PDYN_OK) return status;
    fill_matrix(s, h);
    if (first) status = factor_analyse(&s->factor, &s->matrix, true);
    if (status == PDYN_OK) status = factor_numbers(&s->factor, &s->matrix);
    s->h = s->made = h;
    return status;
}

static bool is_strange(const struct hybrid *s) {
    double h = s->krylov.system->h;
    return fmax(h / s->h, s->h / h) > same_step;
}

static pdyn_status update_factor(struct hybrid *s) {
    bool other = s->h == 0.0 || (is_strange(s) && s->strange >= WORTH_FACTOR);
    if (other) s->strange = 0;
    if (!other && s->made == s->h) return PDYN_OK;
    return make_factor(s, other ? s->krylov.system->h : s->h);
}

/* The factor is made again from its length of step. */
static pdyn_status persist(void *self, pdyn_archive *archive) {
    struct hybrid *s = self;
    archive->bytes(archive, &s->h, sizeof s->h);
    archive->bytes(archive, &s->omega, sizeof s->omega);
    archive->bytes(archive, &s->strange, sizeof s->strange);
    return PDYN_OK;
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct hybrid *s = self;
    struct system *system = model_system(model);
    pdyn_context *context = system->context;
    s->krylov.prepare = prepare, s->krylov.precondition = precondition, s->krylov.self = s;
    s->omega = relaxed;
    pdyn_status status = krylov_create(&s->krylov, context, system);
    factor_start(&s->factor, context);
    if (status != PDYN_OK) return status;
    s->rows = NEW_ARRAY(context, system->batches, struct batch *);
    s->held = NEW_ARRAY(context, system->particles, bool);
    s->inverse = NEW_ARRAY(context, 6 * (size_t)system->particles, double);
    s->t = NEW_VECTOR(context, system->particles);
    if ((system->batches && !s->rows) || !s->held || !s->inverse || !s->t) return PDYN_NO_MEMORY;
    choose_rows(s);
    return PDYN_OK;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct hybrid *s = self;
    pdyn_status status = update_factor(s);
    if (status != PDYN_OK) return status;
    krylov_solve(&s->krylov, b, y, goal, iterations);
    if (is_strange(s)) s->strange += *iterations;
    return PDYN_OK;
}

const pdyn_global_solver pdyn_solver_hybrid = {
    .name = "hybrid",
    .summary = "conjugate gradients preconditioned by a factor of the projective step's matrix and "
               "by 3 x 3 blocks; for cloth with the newton step",
    .state_size = sizeof(struct hybrid),
    .create = create,
    .solve = solve,
    .persist = persist,
    .free = release,
};
