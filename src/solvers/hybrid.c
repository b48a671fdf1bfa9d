/* Conjugate gradients with a preconditioner that sees further than a particle: the blocks of cg,
 * and a coarse level for what surfaces and solids do as a whole (coarse.h). In floats (single_cg.h)
 * as far as these go, beyond that in doubles. */
#include "coarse.h"
#include "jacobi.h"
#include "krylov.h"
#include "single_cg.h"

#include <math.h>
#include <string.h>

struct hybrid {
    struct krylov krylov;
    struct jacobi jacobi;
    struct single_cg single;
    struct coarse coarse;
};

static void release(void *self) {
    struct hybrid *s = self;
    jacobi_free(&s->jacobi);
    single_cg_free(&s->single);
    coarse_free(&s->coarse);
    krylov_free(&s->krylov);
}

/* Floats are trusted to bring a residual down by as much. */
static const double trusted = 1e-4;

/* ---- in doubles ------------------------------------------------------------------------------ */

static void prepare(void *self) {
    struct hybrid *s = self;
    jacobi_prepare(&s->jacobi);
    coarse_prepare(&s->coarse, false);
}

static double precondition(void *self) {
    struct hybrid *s = self;
    double rz = jacobi_apply(&s->jacobi, s->krylov.r, s->krylov.z);
    return rz + coarse_add(&s->coarse, s->krylov.r, s->krylov.z);
}

/* ---- in floats ------------------------------------------------------------------------------- */

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
    enum single_end end = single_cg_solve(&s->single, k->r, k->d, &rest, &done);
    *iterations += done;
    if (end == SINGLE_EXHAUSTED) return false;
    if (goal->tolerance >= trusted) single_cg_residual(&s->single, k->r);
    else look(k, k->r);
    return true;
}

/* One solve in floats; b becomes what doubles see of it, unless it is the last one
 * or no more iterations are wanted. */
static enum single_end solve_in_floats(struct hybrid *s, double *b, double *y,
                                       const pdyn_goal *goal, bool last, int *iterations) {
    struct krylov *k = &s->krylov;
    memset(k->d, 0, system_bytes(k->system));
    enum single_end end = single_cg_solve(&s->single, b, k->d, goal, iterations);
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
    double size = system_norm(sys, b), target = goal->tolerance * size;
    pdyn_goal rest = *goal;
    bool failed = false;
    for (*iterations = 0; size > target && rest.iterations > 0; rest.first = false) {
        int done;
        double before = size;
        bool last = target / size >= trusted && !failed;
        rest.tolerance = fmax(target / size, trusted);
        enum single_end end = solve_in_floats(s, b, y, &rest, last, &done);
        *iterations += done, rest.iterations -= done;
        if (end == SINGLE_ENOUGH) return;
        size = system_norm(sys, b);
        failed = size > 2.0 * rest.tolerance * before;
        if (end == SINGLE_EXHAUSTED || !(size < 0.5 * before)) break;
    }
    if (!(size > target) || rest.iterations <= 0) return;
    int done;
    rest.tolerance = target / size, rest.first = true;
    krylov_solve(&s->krylov, b, y, &rest, &done);
    *iterations += done;
}

/* ---- the solver ------------------------------------------------------------------------------ */

static pdyn_status create(void *self, pdyn_model *model) {
    struct hybrid *s = self;
    struct system *system = model_system(model);
    pdyn_status status = krylov_create(&s->krylov, system->context, system);
    s->krylov.self = s, s->krylov.patient = system->changing;
    s->krylov.prepare = prepare, s->krylov.precondition = precondition;
    if (status == PDYN_OK) status = jacobi_create(&s->jacobi, system);
    if (status == PDYN_OK) status = coarse_create(&s->coarse, system);
    if (status != PDYN_OK || (system->changing && !s->coarse.p.nodes)) return status;
    if (system->changing) s->krylov.linear = linear_in_floats;
    return single_cg_create(&s->single, system, &s->jacobi, &s->coarse);
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_goal *goal, int *iterations) {
    struct hybrid *s = self;
    if (s->single.system) single_cg_prepare(&s->single);
    if (s->krylov.system->changing) krylov_solve(&s->krylov, b, y, goal, iterations);
    else solve_static(s, b, y, goal, iterations);
    return PDYN_OK;
}

static pdyn_status persist(void *self, pdyn_archive *archive) {
    coarse_persist(&((struct hybrid *)self)->coarse, archive);
    return PDYN_OK;
}

const pdyn_global_solver pdyn_solver_hybrid = {
    .name = "hybrid",
    .summary = "conjugate gradients preconditioned by 3 x 3 blocks and by a coarse level, what H "
               "makes of some hundred nodes of surfaces and solids; for cloth with the newton step",
    .state_size = sizeof(struct hybrid),
    .create = create,
    .solve = solve,
    .persist = persist,
    .free = release,
};
