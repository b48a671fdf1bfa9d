/* Conjugate gradients (krylov.h) preconditioned with the inverse 3 x 3 block diagonal of H. */
#include "blocks.h"
#include "krylov.h"

/* How far above its inertia a preconditioner may hold a particle that only an operator holds. Most
 * motions of a fluid change no density and feel inertia alone; blocks that differ widely there
 * would spread the eigenvalues of these motions, which are one and the same without them. */
static const double most_stiff = 10.0;

struct cg {
    struct krylov krylov;
    double *inverse; /* particles x 6: inverse diagonal blocks */
    bool *held;      /* particles: some rows hold it */
};

static void release(void *self) {
    struct cg *cg = self;
    struct krylov *k = &cg->krylov;
    int n = k->system ? k->system->particles : 0;
    FREE_ARRAY(k->context, cg->inverse, 6 * (size_t)n);
    FREE_ARRAY(k->context, cg->held, n);
    krylov_free(k);
}

static void find_held(struct cg *cg) {
    const struct system *sys = cg->krylov.system;
    for (int b = 0; b < sys->batches; b++) {
        const struct batch *batch = sys->batch[b];
        for (int i = 0; i < batch->touch_count; i++)
            cg->held[batch->touch_first + i] |= batch->touch_start[i + 1] > batch->touch_start[i];
    }
}

/* Brings the block D of a particle with this inertia, m/h^2, down to what it may be. */
static void soften(double *D, double inertia) {
    double trace = D[0] + D[3] + D[5] - 3.0 * inertia, most = 3.0 * most_stiff * inertia;
    if (trace <= most) return;
    for (int a = 0; a < 6; a++) D[a] *= most / trace;
    for (int a = 0; a < 6; a += a ? 2 : 3) D[a] += inertia * (1.0 - most / trace);
}

static void invert_blocks(void *arg, int first, int last, int block) {
    (void)block;
    const struct cg *cg = arg;
    for (int i = first; i < last; i++) {
        double *D = cg->inverse + 6 * (size_t)i;
        if (!cg->held[i]) soften(D, system_inertia(cg->krylov.system, i));
        block_invert(D);
    }
}

/* z = D^-1 r; partial: r.z */
WIDE static void precondition_block(void *arg, int first, int last, int block) {
    const struct cg *cg = arg;
    const double *r = cg->krylov.r + 3 * (size_t)first;
    double *z = cg->krylov.z + 3 * (size_t)first;
    for (int i = first; i < last; i++)
        block_multiply(z + 3 * (i - first), cg->inverse + 6 * (size_t)i, r + 3 * (i - first));
    cg->krylov.system->partial[block] = simd_dot(r, z, 3 * (last - first));
}

static void for_particles(struct cg *cg, pdyn_range_fn *fn) {
    pool_for(cg->krylov.context->pool, cg->krylov.system->particles, SYSTEM_GRAIN, fn, cg);
}

static void prepare(void *self) {
    struct cg *cg = self;
    system_diagonal(cg->krylov.system, cg->inverse);
    for_particles(cg, invert_blocks);
}

static double precondition(void *self) {
    struct cg *cg = self;
    for_particles(cg, precondition_block);
    return system_partial_sum(cg->krylov.system);
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct cg *cg = self;
    struct system *system = model_system(model);
    pdyn_context *context = system->context;
    size_t n = (size_t)system->particles;
    cg->krylov.prepare = prepare, cg->krylov.precondition = precondition, cg->krylov.self = cg;
    pdyn_status status = krylov_create(&cg->krylov, context, system);
    if (status != PDYN_OK) return status;
    cg->inverse = NEW_ARRAY(context, 6 * n, double);
    cg->held = NEW_ARRAY(context, n, bool);
    if (!cg->inverse || !cg->held) return PDYN_NO_MEMORY;
    find_held(cg);
    return PDYN_OK;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct cg *cg = self;
    pdyn_goal patient = *goal;
    patient.gain = 0.0;
    krylov_solve(&cg->krylov, b, y, &patient, iterations);
    return PDYN_OK;
}

const pdyn_global_solver pdyn_solver_cg = {
    .name = "cg",
    .summary =
        "conjugate gradients without a matrix, preconditioned by 3 x 3 blocks; for scenes that "
        "change every step",
    .state_size = sizeof(struct cg),
    .create = create,
    .solve = solve,
    .free = release,
};
