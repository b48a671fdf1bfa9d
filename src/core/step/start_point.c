/* The first iterate of a step: s, or nearer to the state where surfaces are in the way, or s
 * without applied forces, or s with the constraints' acceleration of the last step. */
#include "start_point.h"

#include "carried.h"
#include "iterate.h"
#include "sim/live_particles.h"
#include "stop_paths.h"

#include <math.h>
#include <string.h>

/* x = s + h_e^2 a, a: the constraints' acceleration of the last step, which is likely to be needed
 * again. */
static void predict_with_acceleration(struct pdyn_sim *sim, double *x) {
    double h_e = sim->objective.h;
    memcpy(x, sim->objective.s, objective_bytes(&sim->objective));
    objective_axpy(&sim->objective, h_e * h_e, sim->constraint_acceleration, x);
}

/* Stops every point on its path from the state sim->x to x where surfaces are in its way. *least:
 * the smallest part of its path that a point goes. */
static pdyn_status stop_at_surfaces(struct pdyn_sim *sim, double *x, double *least) {
    double part = 1.0;
    *least = 1.0;
    iterate_retract(sim, x);
    if (sim->max_step) {
        objective_axpy(&sim->objective, -1.0, carried_x(sim), x);
        *least = iterate_limit(sim, x);
        objective_axpy(&sim->objective, 1.0, carried_x(sim), x);
    }
    pdyn_status status = stop_paths(sim, PATHS_TO_START, x, &part);
    *least = fmin(*least, part);
    iterate_retract(sim, x);
    return status;
}

/* The local step at x, where paths to x are stopped. */
static pdyn_status start_at(struct pdyn_sim *sim, double *x, double *energy, double *gradient) {
    double unused;
    pdyn_status status = stop_at_surfaces(sim, x, &unused);
    return status == PDYN_OK ? objective_local(&sim->objective, x, energy, gradient) : status;
}

/* The local step at a part of the way from where paths begin to s; pushed particles go the whole
 * way. */
static pdyn_status start_between(struct pdyn_sim *sim, double part, double *energy) {
    double *x = sim->x_next;
    set_path_starts(sim, x);
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        x[k] += (particle_is_pushed(sim, k / 3) ? 1.0 : part) * (sim->objective.s[k] - x[k]);
    return start_at(sim, x, energy, sim->gradient);
}

/* The inertial energy where paths begin: a lower bound of E there, J. Changes sim->trial. */
static double inertial_energy_at_begin(struct pdyn_sim *sim) {
    double sum = 0.0;
    set_path_starts(sim, sim->trial);
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        double moved = sim->objective.s[k] - sim->trial[k];
        if (!particle_is_pushed(sim, k / 3))
            sum += 0.5 * objective_inertia(&sim->objective, k / 3) * moved * moved;
    }
    return sum;
}

enum { SHORTER_STARTS = 6 }; /* that are tried before the step starts at the state itself */

/* Starts at s. Where surfaces are in the way, starts so far before s that E is not above its value
 * at the state: particles that a surface has stopped must not be compressed by those behind them.
 */
static pdyn_status start_inertia(struct pdyn_sim *sim, double *energy) {
    double least, bound;
    pdyn_status status = stop_at_surfaces(sim, sim->x_next, &least);
    if (status == PDYN_OK)
        status = objective_local(&sim->objective, sim->x_next, energy, sim->gradient);
    if (status != PDYN_OK || least == 1.0 || *energy <= inertial_energy_at_begin(sim))
        return status;
    status = start_between(sim, 0.0, &bound);
    double part = *energy > bound ? iterate_shorter_part(1.0, least) : 1.0;
    for (int k = 0; status == PDYN_OK && k < SHORTER_STARTS;
         k++, part = iterate_shorter_part(part, least)) {
        status = start_between(sim, part, energy);
        if (!(*energy > bound)) return status;
    }
    return status == PDYN_OK ? start_between(sim, 0.0, energy) : status;
}

/* x = s - h_e^2 f/m, f: the forces that a program applies. Forces on few vertices move these far
 * from the others in a long step. Rigid bodies and particles that an inlet moves stay at s. Returns
 * whether x differs from s. */
static bool predict_without_forces(const struct pdyn_sim *sim, double *x) {
    const double *force = sim->control.force, h_e = sim->objective.h;
    const struct rigid_map *rigid = sim->objective.rigid;
    bool differs = false;
    memcpy(x, sim->objective.s, objective_bytes(&sim->objective));
    for (int k = 0; force && k < 3 * sim->objective.particles; k++) {
        int i = k / 3;
        if (force[k] == 0.0 || (rigid && rigid->owner[i] >= 0) || particle_is_pushed(sim, i))
            continue;
        x[k] -= h_e * h_e * force[k] / sim->objective.mass[i];
        differs = true;
    }
    return differs;
}

/* Takes the trial as the start if E is lower there. If not, the iterate stays the start, but the
 * last local step was at the trial: *elsewhere is true. */
static pdyn_status try_start(struct pdyn_sim *sim, double *energy, bool *elsewhere) {
    double other;
    pdyn_status status = start_at(sim, sim->trial, &other, sim->trial_gradient);
    if (status != PDYN_OK) return status;
    *elsewhere = !(other < *energy);
    if (*elsewhere) return PDYN_OK;
    iterate_accept_trial(sim);
    *energy = other;
    return PDYN_OK;
}

/* Starts where E is lowest: at s, without applied forces, or with the acceleration of the last
 * step, except after a step that was cut short: its error would be handed on. */
static pdyn_status start_positions(struct pdyn_sim *sim, double *energy) {
    bool elsewhere = false;
    pdyn_status status = start_inertia(sim, energy);
    if (status == PDYN_OK && predict_without_forces(sim, sim->trial))
        status = try_start(sim, energy, &elsewhere);
    if (status == PDYN_OK && sim->last_h != 0.0 && !sim->far_off) {
        predict_with_acceleration(sim, sim->trial);
        status = try_start(sim, energy, &elsewhere);
    }
    if (status != PDYN_OK || !elsewhere) return status;
    return start_at(sim, sim->x_next, energy, sim->gradient);
}

/* A dual solver keeps its multipliers, so a step starts at s. A fluid at rest, which moves less
 * than its constraints move it in a step, starts at s + h_e^2 a: there it is solved. */
static pdyn_status start_multipliers(struct pdyn_sim *sim, double *energy) {
    struct objective *objective = &sim->objective;
    double moved = objective_dot(objective, sim->v, sim->v);
    double pushed =
        objective->h * objective->h *
        objective_dot(objective, sim->constraint_acceleration, sim->constraint_acceleration);
    if (moved < pushed) predict_with_acceleration(sim, sim->x_next);
    return start_at(sim, sim->x_next, energy, sim->gradient);
}

pdyn_status start_point(struct pdyn_sim *sim, double *energy) {
    pdyn_status status = iterate_update_limits(sim, carried_x(sim));
    if (status != PDYN_OK) return status;
    return solves_fluid_alone(sim) ? start_multipliers(sim, energy) : start_positions(sim, energy);
}
