/* Conjugate gradients (krylov.h) with a preconditioner that sees further than a particle: of what
 * is static, a factor (turns.h); where fluid or contact change what the surfaces feel, groups of
 * particles as a coarse level beside the blocks of cg (groups.h). */
#include "groups.h"
#include "jacobi.h"
#include "turns.h"

struct hybrid {
    struct krylov krylov;
    struct turns turns;
    struct groups groups;
    struct jacobi jacobi;
};

static void release(void *self) {
    struct hybrid *s = self;
    turns_free(&s->turns);
    jacobi_free(&s->jacobi);
    groups_free(&s->groups);
    krylov_free(&s->krylov);
}

static void prepare_turns(void *self) { jacobi_prepare(&((struct hybrid *)self)->jacobi); }

static double take_turns(void *self) { return turns_precondition(&((struct hybrid *)self)->turns); }

static void prepare_levels(void *self) {
    struct hybrid *s = self;
    jacobi_prepare(&s->jacobi);
    groups_prepare(&s->groups);
}

static double add_levels(void *self) {
    struct hybrid *s = self;
    double rz = jacobi_apply(&s->jacobi, s->krylov.r, s->krylov.z);
    return rz + groups_add(&s->groups, s->krylov.r, s->krylov.z);
}

static pdyn_status create_levels(struct hybrid *s, struct system *system) {
    s->krylov.prepare = prepare_levels, s->krylov.precondition = add_levels;
    s->krylov.patient = true;
    return groups_create(&s->groups, system);
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct hybrid *s = self;
    struct system *system = model_system(model);
    pdyn_status status = krylov_create(&s->krylov, system->context, system);
    s->krylov.self = s;
    if (status == PDYN_OK) status = jacobi_create(&s->jacobi, system);
    if (status != PDYN_OK) return status;
    if (system->changing) return create_levels(s, system);
    s->krylov.prepare = prepare_turns, s->krylov.precondition = take_turns;
    return turns_create(&s->turns, &s->krylov, &s->jacobi);
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct hybrid *s = self;
    bool in_turns = s->turns.krylov;
    pdyn_status status = in_turns ? turns_update(&s->turns) : PDYN_OK;
    if (status != PDYN_OK) return status;
    krylov_solve(&s->krylov, b, y, goal, iterations);
    if (in_turns) turns_note(&s->turns, *iterations);
    return PDYN_OK;
}

static pdyn_status persist(void *self, pdyn_archive *archive) {
    struct hybrid *s = self;
    if (s->turns.krylov) turns_persist(&s->turns, archive);
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
