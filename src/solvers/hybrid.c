/* Conjugate gradients with a preconditioner that sees further than a particle: the blocks of cg,
 * and a level for what surfaces and solids do as a whole: a factor where all is static
 * (backbone.h), groups of particles where fluid or contact change what they feel (groups.h). In
 * floats (single_cg.h) as far as these go, beyond that in doubles. */
#include "backbone.h"
#include "groups.h"
#include "jacobi.h"
#include "krylov.h"
#include "single_cg.h"

#include <math.h>
#include <string.h>

struct hybrid {
    struct krylov krylov;
    struct jacobi jacobi;
    struct backbone backbone;
    struct single_cg single;
    struct groups groups;
};

static void release(void *self) {
    struct hybrid *s = self;
    jacobi_free(&s->jacobi);
    single_cg_free(&s->single);
    backbone_free(&s->backbone);
    groups_free(&s->groups);
    krylov_free(&s->krylov);
}

/* How much of the blocks, in turn with a factor and where a level is added to them: a factor holds
 * all that they do once more, groups hold little of it. */
static const double in_turn = 0.6, beside_factor = 0.5, beside_groups = 1.0;

/* Floats are trusted to bring a residual down by as much. */
static const double trusted = 1e-4;

/* ---- a level beside the blocks --------------------------------------------------------------- */

static void prepare_backbone(void *self) {
    jacobi_prepare(&((struct hybrid *)self)->jacobi, beside_factor);
}

static double add_backbone(void *self) {
    struct hybrid *s = self;
    double rz = jacobi_apply(&s->jacobi, s->krylov.r, s->krylov.z);
    return rz + backbone_add(&s->backbone, s->krylov.r, s->krylov.z);
}

static void prepare_groups(void *self) {
    struct hybrid *s = self;
    jacobi_prepare(&s->jacobi, beside_groups);
    groups_prepare(&s->groups);
}

static double add_groups(void *self) {
    struct hybrid *s = self;
    double rz = jacobi_apply(&s->jacobi, s->krylov.r, s->krylov.z);
    return rz + groups_add(&s->groups, s->krylov.r, s->krylov.z);
}

/* b -= H d, as doubles see it */
static void look(struct krylov *k, double *b) {
    system_apply(k->system, k->d, k->q);
    system_axpy(k->system, -1.0, k->q, b);
}

/* One of the linear solves, in floats; what it left is what doubles say, where floats are not
 * trusted with all that is wanted. */
static bool linear_in_floats(void *self, double size, double target, const pdyn_goal *goal,
                             int *iterations) {
    struct hybrid *s = self;
    struct krylov *k = &s->krylov;
    const pdyn_goal rest = {.tolerance = target / size,
                            .iterations = goal->iterations - *iterations,
                            .first = goal->first && *iterations == 0};
    int done;
    memset(k->d, 0, system_bytes(k->system));
    enum single_end end = single_cg_solve(&s->single, k->r, size, k->d, &rest, &done);
    *iterations += done;
    if (end == SINGLE_EXHAUSTED) return false;
    if (goal->tolerance >= trusted) single_cg_residual(&s->single, size, k->r);
    else look(k, k->r);
    return true;
}

static pdyn_status create_groups(struct hybrid *s, struct system *system) {
    pdyn_status status = groups_create(&s->groups, system);
    if (status != PDYN_OK || !s->groups.clusters.count) return status;
    s->krylov.linear = linear_in_floats;
    return single_cg_create(&s->single, system, &s->jacobi, beside_groups, NULL, &s->groups);
}

/* ---- the solver ------------------------------------------------------------------------------ */

static pdyn_status create(void *self, pdyn_model *model) {
    struct hybrid *s = self;
    struct system *system = model_system(model);
    pdyn_status status = krylov_create(&s->krylov, system->context, system);
    s->krylov.self = s, s->krylov.patient = system->changing;
    s->krylov.prepare = system->changing ? prepare_groups : prepare_backbone;
    s->krylov.precondition = system->changing ? add_groups : add_backbone;
    if (status == PDYN_OK) status = jacobi_create(&s->jacobi, system);
    if (status != PDYN_OK) return status;
    if (system->changing) return create_groups(s, system);
    status = backbone_create(&s->backbone, system);
    if (status != PDYN_OK) return status;
    return single_cg_create(&s->single, system, &s->jacobi, in_turn, &s->backbone, NULL);
}

/* One solve in floats; b, of this size, becomes what doubles see of it, unless it is the last one
 * or no more iterations are wanted. */
static enum single_end solve_in_floats(struct hybrid *s, double *b, double size, double *y,
                                       const pdyn_goal *goal, bool last, int *iterations) {
    struct krylov *k = &s->krylov;
    memset(k->d, 0, system_bytes(k->system));
    enum single_end end = single_cg_solve(&s->single, b, size, k->d, goal, iterations);
    system_axpy(k->system, 1.0, k->d, y);
    if (end == SINGLE_SOLVED && last) return SINGLE_ENOUGH;
    if (end != SINGLE_ENOUGH) look(k, b);
    return end;
}

/* H y = b, in floats as long as doubles see that it gets on with them: they look where floats are
 * not trusted with all that is left to do, or did less than they should have the last time. */
static void solve_static(struct hybrid *s, double *b, double *y, const pdyn_goal *goal,
                         int *iterations) {
    struct system *sys = s->krylov.system;
    double size = sqrt(system_dot(sys, b, b)), target = goal->tolerance * size;
    pdyn_goal rest = *goal;
    bool failed = false;
    for (*iterations = 0; size > target && rest.iterations > 0; rest.first = false) {
        int done;
        double before = size;
        bool last = target / size >= trusted && !failed;
        rest.tolerance = fmax(target / size, trusted);
        enum single_end end = solve_in_floats(s, b, size, y, &rest, last, &done);
        *iterations += done, rest.iterations -= done;
        if (end == SINGLE_ENOUGH) return;
        size = sqrt(system_dot(sys, b, b));
        failed = size > 2.0 * rest.tolerance * before;
        if (end == SINGLE_EXHAUSTED || !(size < 0.5 * before)) break;
    }
    if (!(size > target) || rest.iterations <= 0) return;
    int done;
    rest.tolerance = target / size, rest.first = true;
    krylov_solve(&s->krylov, b, y, &rest, &done);
    *iterations += done;
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct hybrid *s = self;
    if (s->single.system) single_cg_prepare(&s->single);
    if (!s->backbone.system) {
        krylov_solve(&s->krylov, b, y, goal, iterations);
        return PDYN_OK;
    }
    pdyn_status status = backbone_update(&s->backbone);
    if (status != PDYN_OK) return status;
    solve_static(s, b, y, goal, iterations);
    backbone_note(&s->backbone, *iterations);
    return PDYN_OK;
}

static pdyn_status persist(void *self, pdyn_archive *archive) {
    struct hybrid *s = self;
    if (s->backbone.system) backbone_persist(&s->backbone, archive);
    else groups_persist(&s->groups, archive);
    return PDYN_OK;
}

const pdyn_global_solver pdyn_solver_hybrid = {
    .name = "hybrid",
    .summary = "conjugate gradients preconditioned by 3 x 3 blocks and by a factor: of the "
               "projective step's matrix, in single precision, or where fluid and contact change, "
               "of groups of particles; for cloth with the newton step",
    .state_size = sizeof(struct hybrid),
    .create = create,
    .solve = solve,
    .persist = persist,
    .free = release,
};
