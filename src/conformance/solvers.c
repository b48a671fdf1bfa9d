/* Every constraint type with every solver that fits it: the solution of H y = b against a dense
 * solve for several eps, and steps with the same bits for any number of threads. */
#include "conformance.h"
#include "dense.h"

#include <string.h>

static bool fits(const pdyn_global_solver *solver, struct trial *t) {
    const char *reason;
    return !solver->suits || solver->suits(&t->sim->model.model, &reason);
}

/* The solver's y for H y = u against that of a dense H and against the assembled matrix. */
static void compare_dense(struct check *check, struct trial *t, double eps) {
    size_t numbers = (size_t)t->n * (size_t)t->n;
    double *H = NEW_ARRAY(t->context, numbers, double);
    pdyn_model *model = &t->sim->model.model;
    const char *solver = t->sim->solver->name;
    if (!H) return;
    dense_hessian(model, H, t->z);
    double error = t->sim->solver->direct ? dense_matrix_error(model, H) : 0.0;
    if (!(error >= 0.0 && error <= 1e-9))
        fault(check, "eps = %g: the assembled H differs from the product by %.3g of it", eps,
              error);
    memcpy(t->z, t->u, (size_t)t->n * sizeof *t->z);
    if (!dense_solve(H, t->n, t->z)) fault(check, "eps = %g: H is not positive definite", eps);
    else if (!((error = trial_distance(t->y, t->z, t->n) / trial_norm(t->z, t->n)) <= 1e-7))
        fault(check, "with %s, eps = %g: y differs from that of a dense H by %.3g of it", solver,
              eps, error);
    FREE_ARRAY(t->context, H, numbers);
}

/* Solves H y = u in a trial whose scene has this solver; checks the residual and the iterations. */
static void solve(struct check *check, struct trial *t, double eps) {
    const pdyn_stop stop = {.rel_tol = 1e-13, .max_iterations = 100000};
    int iterations = -1;
    const char *solver = t->sim->solver->name;
    if (solver_view_linearise(&t->sim->model, eps) != PDYN_OK) return;
    memset(t->y, 0, (size_t)t->n * sizeof *t->y);
    memcpy(t->z, t->u, (size_t)t->n * sizeof *t->z);
    unsigned errors = error_count();
    pdyn_status status =
        t->sim->solver->solve(t->sim->solver_state, t->z, t->y, &stop, &iterations);
    if (error_of_module(solver, status, errors) != PDYN_OK) {
        fault(check, "with %s, eps = %g: %s", solver, eps, pdyn_last_error(t->context));
        return;
    }
    objective_apply(&t->sim->objective, t->y, t->z);
    double left = trial_distance(t->z, t->u, t->n) / trial_norm(t->u, t->n);
    if (!(left <= 1e-8))
        fault(check, "with %s, eps = %g: H y = b has a residual of %.3g of b", solver, eps, left);
    else compare_dense(check, t, eps);
    /* With eps = 1 the H of a matrix-free type is diagonal: a solver may need no iteration. */
    int least = t->batch->op && eps == 1.0 ? 0 : 1;
    if (iterations < least || iterations > stop.max_iterations)
        fault(check, "with %s, eps = %g: %d iterations, expected %d to %d", solver, eps, iterations,
              least, stop.max_iterations);
}

/* Direct solvers get the rows of a matrix-free type. For eps > 0 these differ from the operator:
 * they count listed pairs beyond the support, too. */
static void solve_all(struct check *check, const pdyn_constraint_type *type,
                      const pdyn_global_solver *solver) {
    static const double eps[] = {0.0, 0.3, 1.0};
    int count = type->matrix_free && solver->direct ? 1 : 3;
    for (int k = 0; k < count; k++) {
        struct trial t;
        if (!trial_start(&t, check, type, solver->name)) return;
        solve(check, &t, eps[k]);
        trial_finish(&t, check);
    }
}

static bool solver_fits(struct check *check, const pdyn_constraint_type *type,
                        const pdyn_global_solver *solver) {
    struct trial t;
    if (!trial_start(&t, check, type, "auto")) return false;
    bool good = fits(solver, &t);
    trial_finish(&t, check);
    return good;
}

/* ---- steps ----------------------------------------------------------------------------------- */

enum { STEPS = 3 };

/* Adds random velocities: a body in free fall would not load its constraints. */
static void shake(pdyn_sim *sim) {
    uint64_t seed = 11;
    for (int k = 0; k < 3 * sim->objective.particles; k++) sim->v[k] += 0.5 * trial_random(&seed);
}

/* Takes STEPS steps; *hash: of the final state. false, with a fault, if a step failed. */
static bool run(struct check *check, const struct trial_scene *scene, int threads, uint64_t *hash) {
    pdyn_context *context = trial_context(check->like, threads);
    pdyn_sim *sim = NULL;
    if (!context) return false;
    pdyn_status status = trial_load(context, scene, &sim);
    if (status == PDYN_OK) status = trial_vary_tables(sim);
    if (status == PDYN_OK) shake(sim);
    for (int k = 0; k < STEPS && status == PDYN_OK; k++) status = pdyn_step(sim, NULL);
    if (status == PDYN_OK) *hash = pdyn_state_hash(sim);
    else fault(check, "%d threads: %s", threads, pdyn_last_error(context));
    pdyn_free(sim);
    if (context->bytes)
        fault(check, "%zu bytes of the services' memory were not given back", context->bytes);
    pdyn_destroy(context);
    return status == PDYN_OK;
}

/* Steps succeed, and give the same bits for any number of threads. */
static void step(struct check *check, const pdyn_constraint_type *type, enum trial_size size,
                 const char *solver, const char *kind) {
    static const int threads[] = {3, 2, 8}; /* a LARGE scene: 3 only */
    uint64_t one, more;
    const struct trial_scene scene = {check, type, size, solver, kind};
    if (!run(check, &scene, 1, &one)) return;
    for (int n = 0; n < (size == LARGE ? 1 : 3); n++) {
        if (!run(check, &scene, threads[n], &more)) return;
        if (more == one) continue;
        fault(check,
              "not deterministic: %d threads give other bits than 1 (%s, %s step); callbacks may "
              "not write variables that they share",
              threads[n], solver, kind);
        return;
    }
}

static void step_both(struct check *check, const pdyn_constraint_type *type, const char *solver) {
    int faults = check->faults;
    step(check, type, SMALL, solver, "newton");
    if (check->faults == faults) step(check, type, SMALL, solver, "projective");
}

/* ---- all types and solvers ------------------------------------------------------------------- */

void check_solvers(struct check *check) {
    const pdyn_global_solver *s;
    for (int k = 0; (s = registry_solver_at(check->like, k)); k++)
        if (solver_fits(check, check->type, s)) solve_all(check, check->type, s);
}

void check_steps(struct check *check) {
    const pdyn_global_solver *s;
    int faults = check->faults;
    step(check, check->type, LARGE, "auto", "newton");
    for (int k = 0; (s = registry_solver_at(check->like, k)) && check->faults == faults; k++)
        if (solver_fits(check, check->type, s)) step_both(check, check->type, s->name);
}

/* The solver on the scene of each built-in type that it fits; it must fit one. */
void check_solver(struct check *check) {
    int fitting = 0;
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t && !check->faults;
         t++) {
        check->kind = (*t)->flags & PDYN_ON_PARTICLES                   ? PARTICLES
                      : (*t)->flags & (PDYN_ON_VOLUME | PDYN_ON_CLOSED) ? VOLUME
                                                                        : SURFACE;
        if (!solver_fits(check, *t, check->solver)) continue;
        fitting++;
        solve_all(check, *t, check->solver);
        if (!check->faults) step_both(check, *t, check->solver->name);
        if (!check->faults && fitting == 1)
            step(check, *t, LARGE, check->solver->name, "projective");
    }
    if (!fitting && !check->faults) fault(check, "it fits no scene of a type of the library");
}
