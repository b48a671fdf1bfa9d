/* The line search of an iteration: backtracking from the whole direction, conditions of acceptance,
 * and steps longer than the direction. */
#include "line_search.h"

#include "iterate.h"
#include "stop_paths.h"

#include <math.h>

struct rule {         /* conditions under which a step along the direction is accepted */
    double bound;     /* J: the energy must be below it, */
    double armijo;    /* by this part of the slope (Armijo constant) */
    double curvature; /* Wolfe constant: |slope after| <= curvature x |slope before| where the slope
                         is positive; 0 disables. The last try need not satisfy it */
};

/* sim->trial = x_next + part x direction, every point stopped where its path ends. *least: the
 * smallest part that a point has gone so far. *slope, of E along the direction, becomes the slope
 * along these displacements. */
static pdyn_status set_trial(struct pdyn_sim *sim, double part, double *least, double *slope) {
    struct objective *objective = &sim->objective;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 3 * objective->particles; k++) sim->trial[k] = part * sim->direction[k];
    iterate_retract_moves(sim, sim->trial);
    bool blocked = part > *least;
    double taken = blocked ? iterate_limit(sim, sim->trial) : 1.0;
    if (blocked) status = stop_paths(sim, PATHS_FROM_ITERATE, sim->trial, &taken);
    if (blocked) *least = part * taken;
    *slope = part > *least ? objective_dot(objective, sim->gradient, sim->trial) : part * *slope;
    objective_axpy(objective, 1.0, sim->x_next, sim->trial);
    iterate_retract(sim, sim->trial);
    return status;
}

/* E must fall by this part of the slope (Armijo), and the slope after a step may be positive up to
 * this part of the slope before (Wolfe; docs/theory/step.md). */
static const double armijo_part = 1e-4, wolfe_part = 0.7;

/* E, a sum over all particles, is known up to this part. */
static const double energy_rounding = 1e-13;

/* Close to the minimum, differences of E are rounding. A step is then accepted by its slopes
 * (approximate Wolfe conditions, Hager and Zhang 2005), if E rises by no more than this part. */
static const double energy_uncertainty = 1e-6;

static bool is_accepted(const struct rule *rule, const struct line_step *step, double energy,
                        double slope, bool free, bool last) {
    bool falls = energy <= rule->bound + rule->armijo * fmin(slope, 0.0) +
                               energy_rounding * fabs(rule->bound);
    bool flatter = rule->curvature > 0.0 && free && step->slope < 0.0 &&
                   fabs(step->slope_after) <= -rule->curvature * step->slope;
    if (!falls) return flatter && energy <= rule->bound + energy_uncertainty * fabs(rule->bound);
    return last || !free || rule->curvature == 0.0 ||
           step->slope_after <= -rule->curvature * step->slope;
}

/* Length to which a step is lengthened at most, in directions. With 3 or 6, scenes of
 * cloth need the same number of linear iterations within 5 %. */
static const double longest = 4.0;

/* A whole step is lengthened where more than this part of the slope is left. With 0.7, scenes of
 * cloth need up to 3 % more linear iterations, with 0.4 up to 14 %. */
static const double slope_to_lengthen = 0.5;

/* The other side of the curvature condition: where much of the slope is left at the end of a whole
 * step, goes on to where the slope would vanish, if E is lower there. H, made positive,
 * is too stiff along the motions of a sheet that buckles. */
static pdyn_status lengthen(struct pdyn_sim *sim, double *energy, struct line_step *step) {
    struct objective *objective = &sim->objective;
    double left = step->slope_after / step->slope; /* above 1 where E is concave */
    if (step->length < 1.0 || !(step->slope < 0.0 && left > slope_to_lengthen)) return PDYN_OK;
    double more = left < 1.0 ? fmin(longest, 1.0 / (1.0 - left)) - 1.0 : longest - 1.0;
    double least = objective->contact || sim->max_step ? 0.0 : more;
    double slope = step->slope_after, trial;
    pdyn_status status = iterate_update_limits(sim, sim->x_next);
    if (status == PDYN_OK) status = set_trial(sim, more, &least, &slope);
    if (status == PDYN_OK)
        status = objective_local(objective, sim->trial, &trial, sim->trial_gradient);
    if (status != PDYN_OK) return status;
    if (!(trial < *energy)) return objective_local(objective, sim->x_next, energy, sim->gradient);
    iterate_accept_trial(sim);
    *energy = trial;
    step->slope_after = objective_dot(objective, sim->gradient, sim->direction);
    step->length += more;
    return PDYN_OK;
}

/* Lengths that are tried at most, down to 1/512 of the direction. In contact the thickness may be a
 * hundredth of what gravity moves in a long step: with 8 lengths a sheet hung in the air. */
enum { LENGTHS = 10 };

/* Takes x_next + direction, halved until the rule accepts it. In contact every point goes as far as
 * its path is free; a shorter direction stops fewer of them. */
static pdyn_status backtrack(struct pdyn_sim *sim, const struct rule *rule, double *energy,
                             struct line_step *step) {
    struct objective *objective = &sim->objective;
    double trial, least = objective->contact || sim->max_step ? 0.0 : 1.0;
    *step = (struct line_step){.length = 1.0,
                               .slope = objective_dot(objective, sim->gradient, sim->direction)};
    for (int k = 1; k <= LENGTHS; k++, step->length = iterate_shorter_part(step->length, least)) {
        double slope = step->slope;
        pdyn_status status = set_trial(sim, step->length, &least, &slope);
        if (status == PDYN_OK)
            status = objective_local(objective, sim->trial, &trial, sim->trial_gradient);
        if (status != PDYN_OK) return status;
        step->slope_after = objective_dot(objective, sim->trial_gradient, sim->direction);
        if (is_accepted(rule, step, trial, slope, step->length <= least, k == LENGTHS)) {
            iterate_accept_trial(sim);
            *energy = trial;
            return PDYN_OK;
        }
    }
    step->length = 0.0;
    return PDYN_OK;
}

/* Under a dual solver damping shortens steps that are too long, and the conditions count only at
 * the largest damping. Without them a particle between surfaces goes to and fro there. */
pdyn_status line_search(struct pdyn_sim *sim, double highest, double *energy,
                        struct line_step *step) {
    struct rule rule = {.bound = *energy, .armijo = armijo_part, .curvature = wolfe_part};
    if (sim->solver->dual && sim->eps < 1.0)
        rule.bound = highest, rule.armijo = rule.curvature = 0.0;
    pdyn_status status = backtrack(sim, &rule, energy, step);
    if (status != PDYN_OK) return status;
    if (step->length == 0.0)
        return objective_local(&sim->objective, sim->x_next, energy, sim->gradient);
    bool may_lengthen = sim->scene.settings.newton && !sim->solver->dual;
    return may_lengthen ? lengthen(sim, energy, step) : PDYN_OK;
}
