/* Minimisation of E in one step: local and global steps in turn, each followed by a line search.
 * The global step is a damped Newton step of E; with eps = 1 it is that of classic Projective
 * Dynamics. */
#include "minimise.h"

#include "contact/contact.h"
#include "damping.h"
#include "global_step.h"
#include "iterate.h"
#include "line_search.h"
#include "objective/residual.h"
#include "sim/measure.h"
#include "start_point.h"

#include <math.h>
#include <string.h>

/* ---- failures -------------------------------------------------------------------------------- */

static pdyn_status fail_not_finite(pdyn_status status, const char *what, const struct batch *b) {
    if (!b) return set_error(status, "the %s is not finite", what);
    return set_error(status, "the %s of constraint \"%s\" on body \"%s\" is not finite", what,
                     b->type->name, b->view.body->name);
}

/* The first element whose projection is not finite; -1: none. */
static int find_projection(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < v->elements && !b->op && !b->linear; e++)
        for (int k = 3 * v->element_row[e]; k < 3 * v->element_row[e + 1]; k++)
            if (!isfinite(v->p[k])) return e;
    return -1;
}

static pdyn_status fail_energy(const struct batch *b) {
    int element = find_projection(b);
    if (element < 0) return fail_not_finite(PDYN_DIVERGED, "energy", b);
    return set_error(PDYN_DIVERGED,
                     "the energy of constraint \"%s\" on body \"%s\" is not finite: p of element "
                     "%d is not",
                     b->type->name, b->view.body->name, element);
}

/* The error names the constraint whose energy is not finite, or else the body whose gradient is
 * not. */
static pdyn_status fail_local(const struct pdyn_sim *sim) {
    const struct objective *objective = &sim->objective;
    for (int b = 0; b < objective->batches; b++)
        if (!isfinite(objective->batch[b]->energy)) return fail_energy(objective->batch[b]);
    for (int b = 0; b < objective->bodies; b++)
        if (!isfinite(objective->body[b].residual))
            return set_error(PDYN_DIVERGED, "the gradient on body \"%s\" is not finite",
                             objective->body[b].of->name);
    return fail_not_finite(PDYN_DIVERGED, "energy", NULL);
}

/* Looks for a constraint with a tangent that is not finite: no solver finds a direction then. E is
 * finite, so a shorter step would not help: the fault is in the type. */
static pdyn_status check_tangents(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    const double *u = objective_extended(objective, sim->gradient);
    double *product = sim->trial_gradient;
    for (int b = 0; b < objective->batches; b++) {
        memset(product, 0, objective_bytes(objective));
        batch_apply(objective->batch[b], u, product);
        if (!isfinite(objective_dot(objective, product, product)))
            return fail_not_finite(PDYN_SOLVER_FAILED, "tangent", objective->batch[b]);
    }
    return PDYN_OK;
}

/* Looks for the reason of a direction that is 0 or not finite. */
static pdyn_status check_direction(struct pdyn_sim *sim) {
    double size = objective_norm(&sim->objective, sim->direction);
    if (size > 0.0 && isfinite(size)) return PDYN_OK;
    pdyn_status status = check_tangents(sim);
    if (status != PDYN_OK || size == 0.0) return status;
    return set_error(PDYN_DIVERGED, "the direction of solver \"%s\" is not finite",
                     sim->solver->name);
}

/* ---- one iteration --------------------------------------------------------------------------- */

/* How high E may be after an iteration with a dual solver: as high as two iterations ago, but the
 * last iterate, which becomes the state, not above the one before. */
static double highest_energy(const struct pdyn_sim *sim, const struct progress *p) {
    bool last = p->outer + 1 == sim->scene.settings.outer_iterations;
    return last ? p->energy : fmax(p->energy_before, p->energy);
}

/* A global step and a line search. *moved is false where no step lowers E any more. */
static pdyn_status iteration(struct pdyn_sim *sim, struct progress *p, bool *moved) {
    struct line_step taken = {0};
    double energy = p->energy;
    bool first_solve = p->outer == 0 || sim->choice.fresh;
    bool inertial = sim->solver->dual && first_solve; /* the whole inertial step, with eps = 0 */
    sim->choice.fresh = false;
    pdyn_status status = iterate_update_limits(sim, sim->x_next);
    if (status == PDYN_OK)
        status = global_step(sim, inertial ? 0.0 : sim->eps, first_solve, &p->linear);
    if (status == PDYN_OK) status = check_direction(sim);
    if (status == PDYN_OK) status = line_search(sim, highest_energy(sim, p), &p->energy, &taken);
    p->energy_before = energy;
    if (status != PDYN_OK) return status;
    *moved = inertial || taken.length > 0.0 || sim->eps < 1.0;
    if (!inertial) sim->eps = damping_after(sim, &taken);
    return PDYN_OK;
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
    if (!contact || !contact_is_lagging(contact)) return PDYN_OK;
    pdyn_status status = contact_advance(contact, sim->x_next);
    return status == PDYN_OK ? objective_local(&sim->objective, sim->x_next, energy, sim->gradient)
                             : status;
}

/* The starting point counts as solved only below this part of the tolerance. It has the forces of
 * the step before, and forces that are one step late feed every oscillation. A dual solver starts
 * with pressures instead, which need no such bound. */
static const double start_part = 1e-3;

static bool is_solved(const struct pdyn_sim *sim, const struct progress *p) {
    double part = p->outer == 0 && !solves_fluid_alone(sim) ? start_part : 1.0;
    return p->residual <= part * sim->scene.settings.tolerance &&
           !(sim->objective.contact && contact_is_lagging(sim->objective.contact));
}

/* Local and global steps in turn until the step residual is small enough. */
pdyn_status minimise(struct pdyn_sim *sim, struct progress *p) {
    const struct scene_settings *settings = &sim->scene.settings;
    int linear = 0; /* of the iterations before this one */
    bool moved = true;
    solver_choice_open(sim);
    measure_weights(sim);
    pdyn_status status = start_point(sim, &p->energy);
    sim->eps = damping_at_start(sim);
    p->energy_before = p->energy;
    while (status == PDYN_OK) {
        p->residual = objective_residual(&sim->objective, sim->gradient);
        if (!isfinite(p->energy) || !isfinite(p->residual)) return fail_local(sim);
        observe(sim, p, p->linear - linear);
        linear = p->linear;
        if (is_solved(sim, p) || p->outer >= settings->outer_iterations) break;
        if (solver_choice_has_lost(sim, p->linear)) solver_choice_hand_over(sim);
        else if (!moved && !(sim->solver->dual && solver_choice_hand_over(sim))) break;
        status = iteration(sim, p, &moved);
        if (status == PDYN_OK) status = advance_solids(sim, &p->energy);
        p->outer++;
    }
    return status;
}
