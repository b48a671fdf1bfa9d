/* Conjugate gradients (krylov.h) with a preconditioner that sees further than a particle: the
 * blocks of cg, and beside them a level for what surfaces and solids do as a whole: a factor where
 * all is static (backbone.h), groups of particles where fluid or contact change what they feel
 * (groups.h). */
#include "backbone.h"
#include "groups.h"
#include "jacobi.h"
#include "krylov.h"

struct hybrid {
    struct krylov krylov;
    struct jacobi jacobi;
    struct backbone backbone;
    struct groups groups;
};

static void release(void *self) {
    struct hybrid *s = self;
    jacobi_free(&s->jacobi);
    backbone_free(&s->backbone);
    groups_free(&s->groups);
    krylov_free(&s->krylov);
}

/* How much of the blocks: a factor holds all that they do once more, groups hold little of it. */
static const double beside_factor = 0.5, beside_groups = 1.0;

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
    return system->changing ? groups_create(&s->groups, system)
                            : backbone_create(&s->backbone, system);
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct hybrid *s = self;
    bool is_static = s->backbone.system;
    pdyn_status status = is_static ? backbone_update(&s->backbone) : PDYN_OK;
    if (status != PDYN_OK) return status;
    krylov_solve(&s->krylov, b, y, goal, iterations);
    if (is_static) backbone_note(&s->backbone, *iterations);
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
               "projective step's matrix, or where fluid and contact change, of groups of "
               "particles; for cloth with the newton step",
    .state_size = sizeof(struct hybrid),
    .create = create,
    .solve = solve,
    .persist = persist,
    .free = release,
};
