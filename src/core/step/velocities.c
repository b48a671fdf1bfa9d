/* Velocities at the end of a step. */
#include "velocities.h"

#include "applied_force.h"
#include "carried.h"
#include "impacts.h"
#include "momentum.h"
#include "sim/live_particles.h"
#include "sim/rigid_bodies.h"

#include "projdyn/vec3.h"

#include <string.h>

/* v = (x_next - from) / h, without the momentum, N s, that a solve that ended early and rounding
 * add to bodies whose constraints cannot: it would accumulate over many steps. */
static void compute_velocities(struct pdyn_sim *sim, const double *from, double h) {
    const double h_e = sim->objective.h;
    double *excess = sim->trial;
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        double v = (sim->x_next[k] - from[k]) / h;
        excess[k] =
            sim->objective.mass[k / 3] * (v - sim->v_base[k] - h_e * applied_acceleration(sim, k));
        sim->v[k] = v;
    }
    momentum_subtract(sim, excess, sim->v);
}

/* ---- unsolved steps -------------------------------------------------------------------------- */

/* Rise of the energy of motion and height, J, of particle i in a step of length h. */
static double motion_gain(const struct pdyn_sim *sim, int i, double h) {
    const double *v = sim->v + 3 * i;
    const double *v_n = (sim->v_before ? sim->v_before : sim->v_base) + 3 * i;
    double gain = 0.5 * (vec3_dot(v, v) - vec3_dot(v_n, v_n));
    for (int a = 0; a < 3; a++) gain -= h * v[a] * applied_acceleration(sim, 3 * i + a);
    return sim->objective.mass[i] * gain;
}

/* Removes the energy gain from the motion relative to the mean velocity of each group
 * (momentum.h); rise: that of the constraints' energies. */
static void remove_energy_gain(struct pdyn_sim *sim, double h, double rise) {
    const struct objective *objective = &sim->objective;
    double gained = rise, kinetic = 0.0, *relative = sim->trial_gradient, *momentum = sim->trial;
    for (int k = 0; k < 3 * objective->particles; k++)
        relative[k] = sim->v[k], momentum[k] = objective->mass[k / 3] * sim->v[k];
    momentum_subtract(sim, momentum, relative);
    for (int i = 0; i < objective->particles; i++) {
        const double *u = relative + 3 * (size_t)i;
        if (!particle_is_live(sim, i) || particle_is_pushed(sim, i)) continue;
        gained += motion_gain(sim, i, h);
        kinetic += 0.5 * objective->mass[i] * vec3_dot(u, u);
    }
    if (!(gained > 0.0)) return;
    sim->slowed = fmin(1.0, gained / kinetic);
    double lost = 1.0 - sqrt(1.0 - sim->slowed);
    for (int i = 0; i < objective->particles; i++)
        if (particle_is_live(sim, i))
            vec3_add(sim->v + 3 * (size_t)i, -lost, relative + 3 * (size_t)i);
}

/* After an unsolved step, computes the velocities of Euler's method, v = (x_next - x) / h. With the
 * formula (x_next - x^) / h_e of bdf2 they would have 1.5 times the error, because h_e = 2/3 h. */
static void update_unsolved(struct pdyn_sim *sim, double h, double rise) {
    compute_velocities(sim, sim->x, h);
    remove_energy_gain(sim, h, rise);
    rigid_bodies_project(sim, sim->x_next, sim->v);
    sim->history = 0.0;
}

/* ---- all steps ------------------------------------------------------------------------------- */

/* Only a Newton step can gain energy where it ends far from solved, and needs Euler velocities.
 * When a solver for the multipliers of a fluid ends early, positions still follow exactly from its
 * forces and inertia. When the classic projective step ends early, it has moved too little, because
 * its matrix is stiffer than E. */
static bool may_gain(const struct pdyn_sim *sim, bool far_off) {
    return far_off && sim->scene.settings.newton && !solves_fluid_alone(sim);
}

/* Energy of all constraints at the last local step, J. */
static double constraint_energy(const struct objective *objective) {
    double sum = 0.0;
    for (int b = 0; b < objective->batches; b++) sum += objective->batch[b]->energy;
    return sum;
}

/* Both energies are those of the constraints as they are at the end of the step, so that the work
 * of solids and pins that move does not count as a gain. */
pdyn_status velocities_measure_rise(struct pdyn_sim *sim, bool far_off, double *rise) {
    struct objective *objective = &sim->objective;
    double energy, after = constraint_energy(objective);
    *rise = 0.0;
    if (!may_gain(sim, far_off)) return PDYN_OK;
    pdyn_status status = objective_local(objective, carried_x(sim), &energy, sim->trial_gradient);
    *rise = after - constraint_energy(objective);
    return status == PDYN_OK ? objective_local(objective, sim->x_next, &energy, sim->gradient)
                             : status;
}

void velocities_update(struct pdyn_sim *sim, double h, double rise) {
    sim->slowed = sim->impacts.left_out = 0.0, sim->impacts.count = 0;
    if (may_gain(sim, sim->far_off)) {
        update_unsolved(sim, h, rise);
        return;
    }
    compute_velocities(sim, sim->x_base, sim->objective.h);
    rigid_bodies_set_velocities(sim);
    impacts_correct(sim, h);
}

/* Operators change velocities as for a step of length h (viscosity). The steps that follow take a
 * change of v for an acceleration over h_e, not over h; the factor h_e / h corrects this. */
void velocities_apply_operators(struct pdyn_sim *sim, double h) {
    struct objective *objective = &sim->objective;
    double part = objective->h / h, *before = sim->trial;
    memcpy(before, sim->v, objective_bytes(objective));
    for (int b = 0; b < objective->batches; b++) batch_velocity(objective->batch[b], sim->v);
    if (part == 1.0) return;
    for (int k = 0; k < 3 * objective->particles; k++)
        sim->v[k] = before[k] + part * (sim->v[k] - before[k]);
}
