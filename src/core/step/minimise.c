/* Minimisation of E in one step: local and global steps in turn, each followed by a line search.
 * The global step is a damped Newton step of E; with eps = 1 it is that of classic Projective
 * Dynamics. */
#include "minimise.h"

#include "global_step.h"
#include "measure.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

enum { BACKTRACKS = 6 };

struct rule {      /* conditions under which a step along the direction is accepted */
    double bound;  /* J: the energy must be below it, */
    double armijo; /* by this part of the slope (Armijo constant) */
    double uphill; /* curvature constant: |slope after| <= uphill x |slope before| where the slope
                      is positive; 0 disables. The last try need not satisfy it */
    int tries;     /* backtracking steps at most */
};

struct line_step {             /* a step along the direction */
    double length;             /* part of the direction that was taken; 0: none */
    double slope, slope_after; /* of E along the direction, before and after */
};

static void accept_trial(struct pdyn_sim *sim) {
    memcpy(sim->x_next, sim->trial, objective_bytes(&sim->objective));
    memcpy(sim->gradient, sim->trial_gradient, objective_bytes(&sim->objective));
}

/* Limits the displacements of rigid bodies as below: all particles of a body move by the same part
 * of theirs. */
static double limit_bodies(const struct pdyn_sim *sim, double *moves) {
    const struct rigid_map *map = sim->objective.rigid;
    double all = 1.0;
    for (int k = 0; map && k < map->bodies; k++) {
        const struct rigid_body *body = &map->body[k];
        int end = body->first + body->vertices + RIGID_POINTS;
        double least = 1.0;
        for (int i = body->first; i < end; i++) {
            double length = vec3_length(moves + 3 * (size_t)i);
            if (length > sim->max_step[i]) least = fmin(least, sim->max_step[i] / length);
        }
        for (int j = 3 * body->first; least < 1.0 && j < 3 * end; j++) moves[j] *= least;
        all = fmin(all, least);
    }
    return all;
}

/* Limits displacements (particles x 3) to sim->max_step, so that no particle passes a surface.
 * Returns the smallest part of a displacement that is left. */
static double limit_displacements(const struct pdyn_sim *sim, double *moves) {
    double least = sim->max_step ? limit_bodies(sim, moves) : 1.0;
    for (int i = 0; sim->max_step && i < sim->objective.particles; i++) {
        double *own = moves + 3 * (size_t)i, length = vec3_length(own);
        if (!(length > sim->max_step[i])) continue;
        double part = sim->max_step[i] / length;
        for (int a = 0; a < 3; a++) own[a] *= part;
        least = fmin(least, part);
    }
    return least;
}

/* Makes the shapes of rigid bodies rigid at x. */
static void retract(const struct pdyn_sim *sim, double *x) {
    if (sim->objective.rigid) rigid_map_retract(sim->objective.rigid, x);
}

static pdyn_status update_max_step(struct pdyn_sim *sim, const double *x) {
    return sim->max_step ? objective_limit(&sim->objective, x, sim->max_step) : PDYN_OK;
}

/* ---- one iteration ----------------------------------------------------------------------- */

/* Displacements of rigid bodies from x_next become those to rigid positions. */
static void rigid_moves(struct pdyn_sim *sim, double *moves) {
    if (!sim->objective.rigid) return;
    objective_axpy(&sim->objective, 1.0, sim->x_next, moves);
    retract(sim, moves);
    objective_axpy(&sim->objective, -1.0, sim->x_next, moves);
}

/* sim->trial = x_next + part x direction, every point stopped where its path ends. *least: the
 * smallest part that a point has gone so far. *slope, of E along the direction, becomes the slope
 * along these displacements. */
static pdyn_status set_trial(struct pdyn_sim *sim, double part, double *least, double *slope) {
    struct objective *objective = &sim->objective;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 3 * objective->particles; k++) sim->trial[k] = part * sim->direction[k];
    rigid_moves(sim, sim->trial);
    bool blocked = part > *least;
    double taken = blocked ? limit_displacements(sim, sim->trial) : 1.0;
    if (blocked && objective->contact) {
        status = contact_filter(objective->contact, sim->x_next, sim->trial);
        taken *= contact_least(objective->contact);
    }
    if (blocked) *least = part * taken;
    *slope = part > *least ? objective_dot(objective, sim->gradient, sim->trial) : part * *slope;
    objective_axpy(objective, 1.0, sim->x_next, sim->trial);
    retract(sim, sim->trial);
    return status;
}

/* Half of the part, but not less than the first touch: there contact enters the model. */
static double shorter_part(double part, double least) {
    return part > least && 0.5 * part < least ? least : 0.5 * part;
}

/* Close to the minimum, differences of E are rounding. A step is then accepted by its slopes
 * (approximate Wolfe conditions, Hager and Zhang 2005), if E rises by no more than this part. */
static const double energy_uncertainty = 1e-6;

static bool is_accepted(const struct rule *rule, const struct line_step *step, double energy,
                        double slope, bool free, bool last) {
    bool falls =
        energy <= rule->bound + rule->armijo * fmin(slope, 0.0) + 1e-13 * fabs(rule->bound);
    bool flatter = rule->uphill > 0.0 && free && step->slope < 0.0 &&
                   fabs(step->slope_after) <= -rule->uphill * step->slope;
    if (!falls) return flatter && energy <= rule->bound + energy_uncertainty * fabs(rule->bound);
    return last || !free || rule->uphill == 0.0 || step->slope_after <= -rule->uphill * step->slope;
}

/* Backtracking: x_next + direction, halved until the rule accepts it. In contact every point goes
 * as far as its path is free; a shorter direction stops fewer of them. */
static pdyn_status search_line(struct pdyn_sim *sim, const struct rule *rule, double *energy,
                               struct line_step *step) {
    struct objective *objective = &sim->objective;
    double trial, least = objective->contact || sim->max_step ? 0.0 : 1.0;
    *step = (struct line_step){.length = 1.0,
                               .slope = objective_dot(objective, sim->gradient, sim->direction)};
    for (int k = 1; k <= rule->tries; k++, step->length = shorter_part(step->length, least)) {
        double slope = step->slope;
        pdyn_status status = set_trial(sim, step->length, &least, &slope);
        if (status == PDYN_OK)
            status = objective_local(objective, sim->trial, &trial, sim->trial_gradient);
        if (status != PDYN_OK) return status;
        step->slope_after = objective_dot(objective, sim->trial_gradient, sim->direction);
        if (is_accepted(rule, step, trial, slope, step->length <= least, k == rule->tries)) {
            accept_trial(sim);
            *energy = trial;
            return PDYN_OK;
        }
    }
    step->length = 0.0;
    return PDYN_OK;
}

/* A line search along the direction. Without an accepted step, the iterate and its local step stay.
 * With a dual solver E may rise once, while multipliers are inaccurate; then it has to fall below
 * its value before that. */
static pdyn_status descend(struct pdyn_sim *sim, double before, double *energy,
                           struct line_step *step) {
    struct rule rule = {.bound = *energy, .armijo = 1e-4, .uphill = 0.7, .tries = BACKTRACKS};
    if (sim->solver->dual) rule.bound = fmax(before, *energy), rule.armijo = rule.uphill = 0.0;
    pdyn_status status = search_line(sim, &rule, energy, step);
    if (status != PDYN_OK || step->length > 0.0) return status;
    return objective_local(&sim->objective, sim->x_next, energy, sim->gradient);
}

/* Takes the point that the acceleration (Anderson, Chebyshev) proposes, if E is lower there;
 * otherwise searches along the direction. */
static pdyn_status search_accelerated(struct pdyn_sim *sim, double before, double *energy,
                                      struct line_step *step) {
    struct acceleration *a = &sim->acceleration;
    pdyn_status status = PDYN_OK;
    if (!acceleration_propose(a, sim->x_next, sim->direction))
        return descend(sim, before, energy, step);
    status = search_line(sim, &(struct rule){.bound = *energy, .tries = 1}, energy, step);
    if (status != PDYN_OK || step->length > 0.0) return status;
    acceleration_start(a);
    memcpy(sim->direction, a->plain, objective_bytes(&sim->objective));
    return descend(sim, before, energy, step);
}

/* Levenberg-Marquardt: more damping where a step had to be shortened, less where it was taken
 * whole. With a dual solver the first iteration is undamped, because it alone carries the motion,
 * and the slope at the end of a step decides: it says whether the step was too long or too short.
 * Damping is needed there for the second derivatives of a fluid's constraints, which H leaves out.
 */
static double more_damping(double eps, double factor) {
    return fmin(1.0, fmax(factor * eps, 1e-6));
}

static double less_damping(double eps, double factor) { return eps > 1e-7 ? eps / factor : 0.0; }

static double adapt_to_slope(double eps, const struct line_step *step) {
    double overshoot = step->slope_after / fmax(fabs(step->slope), 1e-300);
    if (step->length < 1.0 || overshoot > 0.5) return more_damping(eps, 4.0);
    return overshoot < -0.5 ? less_damping(eps, 4.0) : eps;
}

static double adapt_to_length(double eps, const struct line_step *step) {
    return step->length < 1.0 ? more_damping(eps, 10.0) : less_damping(eps, 10.0);
}

/* A global step and a line search. *moved is false where no step lowers E any more. */
static pdyn_status iterate(struct pdyn_sim *sim, struct progress *p, bool *moved) {
    struct line_step taken = {0};
    double energy = p->energy;
    bool first_solve = p->outer == 0 || sim->choice.fresh, first = sim->solver->dual && first_solve;
    sim->choice.fresh = false;
    pdyn_status status = update_max_step(sim, sim->x_next);
    if (status == PDYN_OK)
        status = global_step(sim, first ? 0.0 : sim->eps, first_solve, &p->linear);
    if (status == PDYN_OK) status = search_accelerated(sim, p->before, &p->energy, &taken);
    p->before = energy;
    if (status != PDYN_OK) return status;
    *moved = first || taken.length > 0.0 || sim->eps < 1.0;
    if (!sim->scene.settings.newton) return PDYN_OK;
    if (!sim->solver->dual) sim->eps = adapt_to_length(sim->eps, &taken);
    else if (!first) sim->eps = adapt_to_slope(sim->eps, &taken);
    return PDYN_OK;
}

/* ---- where the minimisation starts ----------------------------------------------------------- */

/* x = s + h^2 a, a: the constraints' acceleration of the last step, which is likely to be needed
 * again. (A start without gravity gives the same density, but unsolved steps then lose motion.) */
static void predict_with_acceleration(struct pdyn_sim *sim, double *x) {
    double h = sim->objective.h;
    memcpy(x, sim->objective.s, objective_bytes(&sim->objective));
    objective_axpy(&sim->objective, h * h, sim->constraint_acceleration, x);
}

/* The local step at x, where every point is stopped on its path from the state sim->x by surfaces.
 * *least: the smallest part of its path that a point has gone. */
static pdyn_status start_at(struct pdyn_sim *sim, double *x, double *least, double *energy,
                            double *gradient) {
    struct contact *contact = sim->objective.contact;
    *least = 1.0;
    retract(sim, x);
    if (sim->max_step) {
        objective_axpy(&sim->objective, -1.0, sim->x, x);
        *least = limit_displacements(sim, x);
        objective_axpy(&sim->objective, 1.0, sim->x, x);
    }
    pdyn_status status = contact ? contact_start(contact, sim->x, x) : PDYN_OK;
    if (contact) *least = fmin(*least, contact_least(contact));
    retract(sim, x);
    return status == PDYN_OK ? objective_local(&sim->objective, x, energy, gradient) : status;
}

/* The local step at a part of the path from the state to s. */
static pdyn_status start_between(struct pdyn_sim *sim, double part, double *energy) {
    double least;
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        sim->x_next[k] = sim->x[k] + part * (sim->objective.s[k] - sim->x[k]);
    return start_at(sim, sim->x_next, &least, energy, sim->gradient);
}

/* The inertial energy of staying at the state x: a lower bound of E there, J. */
static double inertial_energy_at_rest(const struct pdyn_sim *sim) {
    double sum = 0.0;
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        double moved = sim->objective.s[k] - sim->x[k];
        sum += 0.5 * objective_inertia(&sim->objective, k / 3) * moved * moved;
    }
    return sum;
}

/* Starts at s. Where surfaces are in the way, starts so far before s that E is not above its value
 * at the state: particles that a surface has stopped must not be compressed by those behind them.
 */
static pdyn_status start_inertia(struct pdyn_sim *sim, double *energy) {
    double least, bound;
    pdyn_status status = start_at(sim, sim->x_next, &least, energy, sim->gradient);
    if (status != PDYN_OK || least == 1.0 || *energy <= inertial_energy_at_rest(sim)) return status;
    status = start_between(sim, 0.0, &bound);
    double part = *energy > bound ? shorter_part(1.0, least) : 1.0;
    for (int k = 0; status == PDYN_OK && k < BACKTRACKS; k++, part = shorter_part(part, least)) {
        status = start_between(sim, part, energy);
        if (!(*energy > bound)) return status;
    }
    return status == PDYN_OK ? start_between(sim, 0.0, energy) : status;
}

/* Adds the acceleration of the last step where that lowers E, except after a step that was cut
 * short: its error would be handed on. */
static pdyn_status start_positions(struct pdyn_sim *sim, double *energy) {
    double warm, least;
    pdyn_status status = start_inertia(sim, energy);
    if (status != PDYN_OK || sim->last_h == 0.0 || sim->unfinished) return status;
    predict_with_acceleration(sim, sim->trial);
    status = start_at(sim, sim->trial, &least, &warm, sim->trial_gradient);
    if (status != PDYN_OK) return status;
    if (!(warm < *energy)) return start_at(sim, sim->x_next, &least, energy, sim->gradient);
    accept_trial(sim);
    *energy = warm;
    return PDYN_OK;
}

/* A dual solver keeps its multipliers, so a step starts at s. A fluid at rest, which moves less
 * than its constraints move it in a step, starts at s + h^2 a: there it is solved. */
static pdyn_status start_multipliers(struct pdyn_sim *sim, double *energy) {
    struct objective *objective = &sim->objective;
    double moved = objective_dot(objective, sim->v, sim->v), least;
    double pushed =
        objective->h * objective->h *
        objective_dot(objective, sim->constraint_acceleration, sim->constraint_acceleration);
    if (moved < pushed) predict_with_acceleration(sim, sim->x_next);
    if (sim->scene.settings.newton) sim->eps = less_damping(sim->eps, 4.0);
    return start_at(sim, sim->x_next, &least, energy, sim->gradient);
}

/* ---- the loop -------------------------------------------------------------------------------- */

static void observe(const struct pdyn_sim *sim, const struct progress *p, int linear) {
    if (!sim->observer) return;
    pdyn_iteration iteration = {.iteration = p->outer,
                                .linear_iterations = linear,
                                .energy = p->energy,
                                .residual = p->residual,
                                .damping = sim->eps,
                                .x = sim->x_next};
    sim->observer(sim->observer_user, &iteration);
}

/* Moves solids on that wait for a surface in contact. */
static pdyn_status advance_solids(struct pdyn_sim *sim, double *energy) {
    struct contact *contact = sim->objective.contact;
    if (!contact || !contact->behind) return PDYN_OK;
    pdyn_status status = contact_advance(contact, sim->x_next);
    return status == PDYN_OK ? objective_local(&sim->objective, sim->x_next, energy, sim->gradient)
                             : status;
}

static bool is_solved(const struct pdyn_sim *sim, const struct progress *p) {
    return p->residual <= sim->scene.settings.tolerance &&
           !(sim->objective.contact && sim->objective.contact->behind);
}

/* The error names the constraint whose energy is not finite. */
static pdyn_status fail_not_finite(const struct pdyn_sim *sim) {
    for (int b = 0; b < sim->objective.batches; b++) {
        const struct batch *batch = sim->objective.batch[b];
        if (!isfinite(batch->energy))
            return context_fail(sim->context, PDYN_DIVERGED,
                                "the energy of constraint \"%s\" on body \"%s\" is not finite",
                                batch->type->name, batch->view.body->name);
    }
    return context_fail(sim->context, PDYN_DIVERGED, "the energy is not finite");
}

/* Local and global steps in turn until the step residual is small enough. */
pdyn_status minimise(struct pdyn_sim *sim, struct progress *p) {
    const struct scene_settings *set = &sim->scene.settings;
    int linear = 0; /* of the iterations before this one */
    bool moved = true;
    measure_weights(sim);
    pdyn_status status = update_max_step(sim, sim->x);
    if (status == PDYN_OK)
        status = solves_fluid_alone(sim) ? start_multipliers(sim, &p->energy)
                                         : start_positions(sim, &p->energy);
    if (sim->solver->dual && !solves_fluid_alone(sim)) sim->eps = 0.0;
    p->before = p->energy;
    acceleration_start(&sim->acceleration);
    while (status == PDYN_OK) {
        p->residual = objective_residual(&sim->objective, sim->gradient);
        if (!isfinite(p->energy) || !isfinite(p->residual)) return fail_not_finite(sim);
        observe(sim, p, p->linear - linear);
        linear = p->linear;
        if (is_solved(sim, p) || p->outer >= set->outer_iterations) break;
        if (solver_choice_has_lost(sim, p->linear)) solver_choice_hand_over(sim);
        else if (!moved && !(sim->solver->dual && solver_choice_hand_over(sim))) break;
        status = iterate(sim, p, &moved);
        if (status == PDYN_OK) status = advance_solids(sim, &p->energy);
        p->outer++;
    }
    return status;
}
