/* One-sided constraints make the model of E quadratic in pieces. It is minimised by an active-set
 * iteration: a linear solve with every constraint on a fixed side, then an exact line search along
 * the result with sides changing (semi-smooth Newton), and again from there. Linear solvers see
 * fixed sides alone. */
#include "global_step.h"

#include "objective/residual.h"

#include <math.h>
#include <string.h>

enum { MAX_ROUNDS = 12 }; /* linear solves of one model */

/* Where sides may change, a linear solve reduces its residual by no more than this: its sides may
 * be wrong. */
static const double round_tolerance = 0.03;

/* Progress of an iteration, relative to the mean of all, below which a linear solve of a newton
 * step ends: E is not quadratic, and a new model is worth more than the last digits of this one. A
 * projective step has one matrix for all models, and solves to the tolerance that the user sets, so
 * that solvers can be compared. */
static const double min_progress = 0.3;

/* Iterations of the first linear solve of a step, at least, where all constraints are static: at s,
 * a few stiff points, such as pins, make up most of the gradient, and one iteration removes that.
 */
enum { MIN_ITERATIONS = 5 };

/* The first linear solve of a step reduces its residual to this at least: a start point
 * that is already within the tolerance still has the forces of the previous step (minimise.c). */
static const double first_reduction = 0.1;

static pdyn_stop stop_of(struct pdyn_sim *sim, bool first_of_step) {
    const struct scene_settings *settings = &sim->scene.settings;
    bool whole = sim->objective.dynamic || !settings->newton;
    /* reaches the step's tolerance, to first order */
    double enough = 0.5 * settings->tolerance / objective_norm(&sim->objective, sim->gradient);
    if (first_of_step && !solves_fluid_alone(sim)) enough = fmin(enough, first_reduction);
    bool far = first_of_step && !whole && enough < settings->linear_tolerance;
    return (pdyn_stop){.rel_tol = fmax(settings->linear_tolerance, enough),
                       .min_progress = whole ? 0.0 : min_progress,
                       .min_iterations = far ? MIN_ITERATIONS : 0,
                       .max_iterations = settings->linear_iterations,
                       .first_of_step = first_of_step};
}

struct round {
    double *b;  /* minus the gradient of the model where d is */
    double *d;  /* solution of the linear solve */
    double *Hd; /* residual of the linear solve; then H d */
};

/* Moves along d to the minimum of the model. b becomes its residual there. */
static void move_to_minimum(struct pdyn_sim *sim, const struct round *at) {
    struct objective *objective = &sim->objective;
    for (int k = 0; k < 3 * objective->particles; k++) at->Hd[k] = at->b[k] - at->Hd[k];
    double descent = objective_dot(objective, at->b, at->d),
           curvature = objective_dot(objective, at->d, at->Hd);
    double t = descent > 0.0 ? objective_line_minimum(objective, descent, curvature) : 0.0;
    objective_step_along(objective, t, at->Hd);
    objective_axpy(objective, t, at->d, sim->direction);
    objective_axpy(objective, -1.0, at->Hd, at->b);
}

static pdyn_status solve(struct pdyn_sim *sim, double *b, double *y, const pdyn_stop *stop,
                         int *iterations) {
    unsigned errors = error_count();
    pdyn_status status = sim->solver->solve(sim->solver_state, b, y, stop, iterations);
    return error_of_module(sim->solver->name, status, errors);
}

static pdyn_status solve_linear(struct pdyn_sim *sim, const struct round *at, const pdyn_stop *stop,
                                int *iterations) {
    int done = 0;
    memcpy(at->Hd, at->b, objective_bytes(&sim->objective));
    memset(at->d, 0, objective_bytes(&sim->objective));
    pdyn_status status = solve(sim, at->Hd, at->d, stop, &done);
    if (sim->objective.rigid) rigid_map_extend(sim->objective.rigid, at->d);
    *iterations += done;
    return status;
}

static pdyn_status solve_rounds(struct pdyn_sim *sim, const pdyn_stop *stop, int *iterations) {
    struct objective *objective = &sim->objective;
    const struct round at = {sim->rhs, sim->trial, sim->trial_gradient};
    double size = objective_norm(objective, at.b), target = stop->rel_tol * size;
    for (int n = 0; n < MAX_ROUNDS && size > target && *iterations < stop->max_iterations; n++) {
        double aim = objective->dynamic ? fmax(target, round_tolerance * size) : target;
        pdyn_stop part = *stop;
        part.rel_tol = aim / size, part.max_iterations -= *iterations;
        part.first_of_step = stop->first_of_step && n == 0;
        pdyn_status status = solve_linear(sim, &at, &part, iterations);
        if (status != PDYN_OK) return status;
        objective_set_direction(objective, at.d);
        if (aim == target && !objective_count_side_changes(objective)) {
            objective_axpy(objective, 1.0, at.d, sim->direction);
            return PDYN_OK;
        }
        move_to_minimum(sim, &at);
        size = objective_norm(objective, at.b);
    }
    return PDYN_OK;
}

/* A dual solver decides on sides itself. A direct one factors H at the sides of the iterate: other
 * sides would need another factor, as the next iterate does. */
static bool has_rounds(const pdyn_global_solver *solver) {
    return !solver->dual && !solver->direct;
}

pdyn_status global_step(struct pdyn_sim *sim, double eps, bool first_of_step, int *linear) {
    int iterations = 0;
    pdyn_status status = solver_view_linearise(&sim->model, eps);
    if (status != PDYN_OK) return status;
    const pdyn_stop stop = stop_of(sim, first_of_step);
    memset(sim->direction, 0, objective_bytes(&sim->objective));
    for (int k = 0; k < 3 * sim->objective.particles; k++) sim->rhs[k] = -sim->gradient[k];
    if (has_rounds(sim->solver)) status = solve_rounds(sim, &stop, &iterations);
    else status = solve(sim, sim->rhs, sim->direction, &stop, &iterations);
    if (sim->objective.rigid) rigid_map_extend(sim->objective.rigid, sim->direction);
    *linear += iterations;
    return status;
}
