/* Local and global steps in turn. The global step is the damped newton step of E; with eps = 1 it
 * is that of classic Projective Dynamics. */
#include "minimise.h"

#include "global_step.h"
#include "measure.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

enum { BACKTRACKS = 6 };

struct rule {      /* what a step along the direction has to meet */
    double bound;  /* J: E ends below it */
    double armijo; /* by this part of the slope, and */
    double uphill; /* rises no more steeply than this part of it, or the next step leads back; 0: it
                      may */
    int tries;     /* of these, the last is not asked about that */
};

struct taken {                 /* a step along the direction */
    double length;             /* 1: all of it */
    double slope, slope_after; /* of E along it, before and after */
};

static void take_trial(struct pdyn_sim *sim) {
    memcpy(sim->x_next, sim->trial, objective_bytes(&sim->objective));
    memcpy(sim->gradient, sim->trial_gradient, objective_bytes(&sim->objective));
}

/* Shortens displacements (particles x 3) to what is free of surfaces; the least part that is left.
 */
static double limit_moves(const struct pdyn_sim *sim, double *moves) {
    double least = 1.0;
    for (int i = 0; sim->way && i < sim->objective.particles; i++) {
        double *own = moves + 3 * (size_t)i, length = vec3_length(own);
        if (!(length > sim->way[i])) continue;
        double part = sim->way[i] / length;
        for (int a = 0; a < 3; a++) own[a] *= part;
        least = fmin(least, part);
    }
    return least;
}

static pdyn_status find_way(struct pdyn_sim *sim, const double *x) {
    return sim->way ? objective_limit(&sim->objective, x, sim->way) : PDYN_OK;
}

/* ---- one iteration ----------------------------------------------------------------------- */

/* sim->trial: x_next and a part of the direction, of which every point goes as far as its way is
 * free. *slope, of E along the direction, becomes that along the way. */
static pdyn_status go_part(struct pdyn_sim *sim, double part, double *least, double *slope) {
    struct objective *sys = &sim->objective;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 3 * sys->particles; k++) sim->trial[k] = part * sim->direction[k];
    bool blocked = part > *least;
    double taken = blocked ? limit_moves(sim, sim->trial) : 1.0;
    if (blocked && sys->contact) {
        status = contact_filter(sys->contact, sim->x_next, sim->trial);
        taken *= contact_least(sys->contact);
    }
    if (blocked) *least = part * taken;
    *slope = part > *least ? objective_dot(sys, sim->gradient, sim->trial) : part * *slope;
    objective_axpy(sys, 1.0, sim->x_next, sim->trial);
    return status;
}

/* Half of it, but not past the first touch, where contact becomes part of the model. */
static double next_part(double part, double least) {
    return part > least && 0.5 * part < least ? least : 0.5 * part;
}

/* Close to the minimum, E is not known well enough to tell: projections end at a tolerance, sums
 * are rounded. There slopes tell (Hager and Zhang 2005, approximate Wolfe conditions), while E
 * rises by no more than this part of it. */
static const double unsure = 1e-6;

static bool is_good(const struct rule *rule, const struct taken *step, double energy, double slope,
                    bool free, bool last) {
    bool falls =
        energy <= rule->bound + rule->armijo * fmin(slope, 0.0) + 1e-13 * fabs(rule->bound);
    bool flatter = rule->uphill > 0.0 && free && step->slope < 0.0 &&
                   fabs(step->slope_after) <= -rule->uphill * step->slope;
    if (!falls) return flatter && energy <= rule->bound + unsure * fabs(rule->bound);
    return last || !free || rule->uphill == 0.0 || step->slope_after <= -rule->uphill * step->slope;
}

/* x_next + direction, halved until it meets the rule. step->length: what was taken, 0 for none. In
 * contact every point goes as far as its way is free, and fewer of them are stopped where all go
 * less far. */
static pdyn_status go_down(struct pdyn_sim *sim, const struct rule *rule, double *energy,
                           struct taken *step) {
    struct objective *sys = &sim->objective;
    double trial, least = sys->contact || sim->way ? 0.0 : 1.0;
    *step =
        (struct taken){.length = 1.0, .slope = objective_dot(sys, sim->gradient, sim->direction)};
    for (int k = 1; k <= rule->tries; k++, step->length = next_part(step->length, least)) {
        double slope = step->slope;
        pdyn_status status = go_part(sim, step->length, &least, &slope);
        if (status == PDYN_OK)
            status = objective_local(sys, sim->trial, &trial, sim->trial_gradient);
        if (status != PDYN_OK) return status;
        step->slope_after = objective_dot(sys, sim->trial_gradient, sim->direction);
        if (is_good(rule, step, trial, slope, step->length <= least, k == rule->tries)) {
            take_trial(sim);
            *energy = trial;
            return PDYN_OK;
        }
    }
    step->length = 0.0;
    return PDYN_OK;
}

/* Goes down along the direction; where it does not, the iterate and its local step are as before.
 * Unfinished multipliers may raise E once; then it has to fall below what it was before that. */
static pdyn_status descend(struct pdyn_sim *sim, double before, double *energy,
                           struct taken *step) {
    struct rule rule = {.bound = *energy, .armijo = 1e-4, .uphill = 0.7, .tries = BACKTRACKS};
    if (sim->solver->dual) rule.bound = fmax(before, *energy), rule.armijo = rule.uphill = 0.0;
    pdyn_status status = go_down(sim, &rule, energy, step);
    if (status != PDYN_OK || step->length > 0.0) return status;
    return objective_local(&sim->objective, sim->x_next, energy, sim->gradient);
}

/* Where an acceleration leads, if E falls on the way; otherwise goes down along the direction. */
static pdyn_status extrapolate(struct pdyn_sim *sim, double before, double *energy,
                               struct taken *step) {
    struct acceleration *a = &sim->acceleration;
    pdyn_status status = PDYN_OK;
    if (!acceleration_propose(a, sim->x_next, sim->direction))
        return descend(sim, before, energy, step);
    status = go_down(sim, &(struct rule){.bound = *energy, .tries = 1}, energy, step);
    if (status != PDYN_OK || step->length > 0.0) return status;
    acceleration_start(a);
    memcpy(sim->direction, a->plain, objective_bytes(&sim->objective));
    return descend(sim, before, energy, step);
}

/* Levenberg-Marquardt: more damping where the step went too far, less where it was good. With
 * multipliers the first iteration is undamped, for it alone carries the motion, and damping lasts:
 * what needs it is the change of a fluid's gradients under pressure, which the model does not know.
 * There, the slope along the step says at its end whether it was too long or too short. */
static double more_damping(double eps, double factor) {
    return fmin(1.0, fmax(factor * eps, 1e-6));
}

static double less_damping(double eps, double factor) { return eps > 1e-7 ? eps / factor : 0.0; }

static double adapt_to_slope(double eps, const struct taken *step) {
    double overshoot = step->slope_after / fmax(fabs(step->slope), 1e-300);
    if (step->length < 1.0 || overshoot > 0.5) return more_damping(eps, 4.0);
    return overshoot < -0.5 ? less_damping(eps, 4.0) : eps;
}

static double adapt_to_length(double eps, const struct taken *step) {
    return step->length < 1.0 ? more_damping(eps, 10.0) : less_damping(eps, 10.0);
}

/* A global step and a line search. *moved is false where no step lowers E any more. */
static pdyn_status iterate(struct pdyn_sim *sim, struct progress *p, bool *moved) {
    struct taken taken = {0};
    double energy = p->energy;
    bool first = sim->solver->dual && p->outer == 0;
    pdyn_status status = find_way(sim, sim->x_next);
    if (status == PDYN_OK)
        status = global_step(sim, first ? 0.0 : sim->damping, p->outer == 0, &p->linear);
    if (status == PDYN_OK) status = extrapolate(sim, p->before, &p->energy, &taken);
    p->before = energy;
    if (status != PDYN_OK) return status;
    *moved = taken.length > 0.0 || sim->damping < 1.0;
    if (!sim->scene.settings.newton) return PDYN_OK;
    if (!sim->solver->dual) sim->damping = adapt_to_length(sim->damping, &taken);
    else if (!first) sim->damping = adapt_to_slope(sim->damping, &taken);
    return PDYN_OK;
}

/* ---- where the minimisation starts ----------------------------------------------------------- */

/* s, and the constraints' acceleration of the last step: it is likely to be needed again. (Leaving
 * out gravity instead would look as good in density and destroy the motion of unconverged steps.)
 */
static void repeat_acceleration(struct pdyn_sim *sim, double *x) {
    double h = sim->objective.h;
    memcpy(x, sim->objective.s, objective_bytes(&sim->objective));
    objective_axpy(&sim->objective, h * h, sim->constraint_acceleration, x);
}

/* The local step at x, or as far on the way there as it is free. *least: the least part of it that
 * a particle went. */
static pdyn_status start_at(struct pdyn_sim *sim, double *x, double *least, double *energy,
                            double *gradient) {
    struct contact *contact = sim->objective.contact;
    *least = 1.0;
    if (sim->way) {
        objective_axpy(&sim->objective, -1.0, sim->x, x);
        *least = limit_moves(sim, x);
        objective_axpy(&sim->objective, 1.0, sim->x, x);
    }
    pdyn_status status = contact ? contact_start(contact, sim->x, x) : PDYN_OK;
    if (contact) *least = fmin(*least, contact_least(contact));
    return status == PDYN_OK ? objective_local(&sim->objective, x, energy, gradient) : status;
}

/* The local step a part of the way from the state to s. */
static pdyn_status start_after(struct pdyn_sim *sim, double part, double *energy) {
    double least;
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        sim->x_next[k] = sim->x[k] + part * (sim->objective.s[k] - sim->x[k]);
    return start_at(sim, sim->x_next, &least, energy, sim->gradient);
}

/* What inertia alone adds to E at the state: E is not below it there. */
static double inertia_of_standing(const struct pdyn_sim *sim) {
    double sum = 0.0;
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        double moved = sim->objective.s[k] - sim->x[k];
        sum += 0.5 * objective_inertia(&sim->objective, k / 3) * moved * moved;
    }
    return sum;
}

/* Starts at s, or, where surfaces are in the way, so far before it that E is not above that of
 * standing still: what a surface stops is not to be crushed by what comes behind it, nor to be
 * driven through the surface while E falls elsewhere. */
static pdyn_status start_inertia(struct pdyn_sim *sim, double *energy) {
    double least, bound;
    pdyn_status status = start_at(sim, sim->x_next, &least, energy, sim->gradient);
    if (status != PDYN_OK || least == 1.0 || *energy <= inertia_of_standing(sim)) return status;
    status = start_after(sim, 0.0, &bound);
    double part = *energy > bound ? next_part(1.0, least) : 1.0;
    for (int k = 0; status == PDYN_OK && k < BACKTRACKS; k++, part = next_part(part, least)) {
        status = start_after(sim, part, energy);
        if (!(*energy > bound)) return status;
    }
    return status == PDYN_OK ? start_after(sim, 0.0, energy) : status;
}

/* With positions, that acceleration is taken where it lowers E. That of a step that was cut short
 * would hand on its error, even so. */
static pdyn_status start_positions(struct pdyn_sim *sim, double *energy) {
    double warm, least;
    pdyn_status status = start_inertia(sim, energy);
    if (status != PDYN_OK || sim->last_h == 0.0 || sim->unfinished) return status;
    repeat_acceleration(sim, sim->trial);
    status = start_at(sim, sim->trial, &least, &warm, sim->trial_gradient);
    if (status != PDYN_OK) return status;
    if (!(warm < *energy)) return start_at(sim, sim->x_next, &least, energy, sim->gradient);
    take_trial(sim);
    *energy = warm;
    return PDYN_OK;
}

/* With multipliers, the solver keeps what is needed. Only a fluid that moves less than its
 * constraints move it, at rest, starts where these put it: there it is solved already. */
static pdyn_status start_multipliers(struct pdyn_sim *sim, double *energy) {
    struct objective *sys = &sim->objective;
    double moved = objective_dot(sys, sim->v, sim->v), least;
    double pushed = sys->h * sys->h *
                    objective_dot(sys, sim->constraint_acceleration, sim->constraint_acceleration);
    if (moved < pushed) repeat_acceleration(sim, sim->x_next);
    if (sim->scene.settings.newton) sim->damping = less_damping(sim->damping, 4.0);
    return start_at(sim, sim->x_next, &least, energy, sim->gradient);
}

/* ---- all of them ----------------------------------------------------------------------------- */

static void observe(const struct pdyn_sim *sim, const struct progress *p, int linear) {
    if (!sim->observer) return;
    pdyn_iteration iteration = {.iteration = p->outer,
                                .linear_iterations = linear,
                                .energy = p->energy,
                                .residual = p->residual,
                                .damping = sim->damping,
                                .x = sim->x_next};
    sim->observer(sim->observer_user, &iteration);
}

/* Solids that wait for a surface go on. */
static pdyn_status push(struct pdyn_sim *sim, double *energy) {
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

/* Names the constraint that it comes from, if there is one. */
static pdyn_status say_not_finite(const struct pdyn_sim *sim) {
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
    pdyn_status status = find_way(sim, sim->x);
    if (status == PDYN_OK)
        status = sim->solver->dual ? start_multipliers(sim, &p->energy)
                                   : start_positions(sim, &p->energy);
    p->before = p->energy;
    acceleration_start(&sim->acceleration);
    while (status == PDYN_OK) {
        p->residual = objective_residual(&sim->objective, sim->gradient);
        if (!isfinite(p->energy) || !isfinite(p->residual)) return say_not_finite(sim);
        observe(sim, p, p->linear - linear);
        linear = p->linear;
        if (!moved || is_solved(sim, p) || p->outer >= set->outer_iterations) break;
        status = iterate(sim, p, &moved);
        if (status == PDYN_OK) status = push(sim, &p->energy);
        p->outer++;
    }
    return status;
}
