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
    objective_apply(k->objective, k->d, k->q);
    objective_axpy(k->objective, -1.0, k->q, b);
}

/* One of the linear solves, in floats; what it left is what doubles say, where floats are not
 * trusted with all that is wanted. */
static bool linear_in_floats(void *self, double size, double target, const pdyn_stop *stop,
                             int *iterations) {
    struct hybrid *s = self;
    struct krylov *k = &s->krylov;
    const pdyn_stop rest = {.rel_tol = target / size,
                            .max_iterations = stop->max_iterations - *iterations,
                            .first_of_step = stop->first_of_step && *iterations == 0};
    int done;
    memset(k->d, 0, objective_bytes(k->objective));
    enum single_end end = single_cg_solve(&s->single, k->r, k->d, &rest, &done);
    *iterations += done;
    if (end == SINGLE_EXHAUSTED) return false;
    if (stop->rel_tol >= trusted) single_cg_residual(&s->single, k->r);
    else look(k, k->r);
    return true;
}

/* One solve in floats; b becomes what doubles see of it, unless it is the last one
 * or no more iterations are wanted. */
static enum single_end solve_in_floats(struct hybrid *s, double *b, double *y,
                                       const pdyn_stop *stop, bool last, int *iterations) {
    struct krylov *k = &s->krylov;
    memset(k->d, 0, objective_bytes(k->objective));
    enum single_end end = single_cg_solve(&s->single, b, k->d, stop, iterations);
    objective_axpy(k->objective, 1.0, k->d, y);
    if (end == SINGLE_SOLVED && last) return SINGLE_ENOUGH;
    if (end != SINGLE_ENOUGH) look(k, b);
    return end;
}

/* H y = b, in floats as long as doubles see that it gets on with them: they look where floats are
 * not trusted with all that is left to do, or did less than they should have the last time. */
static void solve_static(struct hybrid *s, double *b, double *y, const pdyn_stop *stop,
                         int *iterations) {
    struct objective *sys = s->krylov.objective;
    double size = objective_norm(sys, b), target = stop->rel_tol * size;
    pdyn_stop rest = *stop;
    bool failed = false;
    for (*iterations = 0; size > target && rest.max_iterations > 0; rest.first_of_step = false) {
        int done;
        double before = size;
        bool last = target / size >= trusted && !failed;
        rest.rel_tol = fmax(target / size, trusted);
        enum single_end end = solve_in_floats(s, b, y, &rest, last, &done);
        *iterations += done, rest.max_iterations -= done;
        if (end == SINGLE_ENOUGH) return;
        size = objective_norm(sys, b);
        failed = size > 2.0 * rest.rel_tol * before;
        if (end == SINGLE_EXHAUSTED || !(size < 0.5 * before)) break;
    }
    if (!(size > target) || rest.max_iterations <= 0) return;
    int done;
    rest.rel_tol = target / size, rest.first_of_step = true;
    krylov_solve(&s->krylov, b, y, &rest, &done);
    *iterations += done;
}

/* ---- the solver ------------------------------------------------------------------------------ */

static pdyn_status create(void *self, pdyn_model *model) {
    struct hybrid *s = self;
    struct objective *objective = model_system(model);
    pdyn_status status = krylov_create(&s->krylov, objective->context, objective);
    s->krylov.self = s, s->krylov.patient = objective->dynamic_rows;
    s->krylov.prepare = prepare, s->krylov.precondition = precondition;
    if (status == PDYN_OK) status = jacobi_create(&s->jacobi, objective);
    if (status == PDYN_OK) status = coarse_create(&s->coarse, objective);
    if (status != PDYN_OK || (objective->dynamic_rows && !s->coarse.p.nodes)) return status;
    if (objective->dynamic_rows) s->krylov.linear = linear_in_floats;
    return single_cg_create(&s->single, objective, &s->jacobi, &s->coarse);
}

static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct hybrid *s = self;
    if (s->single.objective) single_cg_prepare(&s->single);
    if (s->krylov.objective->dynamic_rows) krylov_solve(&s->krylov, b, y, stop, iterations);
    else solve_static(s, b, y, stop, iterations);
    return PDYN_OK;
}

static pdyn_status persist(void *self, pdyn_snapshot *snapshot) {
    coarse_persist(&((struct hybrid *)self)->coarse, snapshot);
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
