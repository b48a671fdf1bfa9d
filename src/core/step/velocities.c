/* Velocities at the end of a step. */
#include "velocities.h"

#include "applied_force.h"
#include "impacts.h"
#include "live_particles.h"
#include "rigid_bodies.h"

#include "projdyn/vec3.h"

#include <string.h>

/* Subtracts momentum, N s, that rounding has added to a system whose constraints cannot, so that it
 * does not accumulate over many steps. */
static void subtract_momentum(struct pdyn_sim *sim, const double excess[3]) {
    double mass = 0.0;
    if (sim->anchored) return;
    for (int i = 0; i < sim->objective.particles; i++)
        if (particle_is_live(sim, i)) mass += sim->objective.mass[i];
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        if (particle_is_live(sim, k / 3)) sim->v[k] -= excess[k % 3] / mass;
}

/* v = (x_next - from) / h. */
static void compute_velocities(struct pdyn_sim *sim, const double *from, double h) {
    const double h_e = sim->objective.h;
    double excess[3] = {0};
    for (int i = 0; i < sim->objective.particles; i++) {
        double m = particle_is_live(sim, i) ? sim->objective.mass[i] : 0.0;
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            double v = (sim->x_next[k] - from[k]) / h;
            excess[k % 3] += m * (v - sim->v_base[k] - h_e * applied_acceleration(sim, k));
            sim->v[k] = v;
        }
    }
    subtract_momentum(sim, excess);
}

/* ---- unsolved steps -------------------------------------------------------------------------- */

/* Mean velocity of the system; 0 if a constraint can change the momentum. */
static void mean_velocity(const struct pdyn_sim *sim, double mean[3]) {
    double mass = 0.0;
    mean[0] = mean[1] = mean[2] = 0.0;
    for (int i = 0; i < sim->objective.particles && !sim->anchored; i++) {
        if (!particle_is_live(sim, i)) continue;
        mass += sim->objective.mass[i];
        vec3_add(mean, sim->objective.mass[i], sim->v + 3 * i);
    }
    for (int a = 0; a < 3 && mass > 0.0; a++) mean[a] /= mass;
}

/* Bound of the energy, J, that particle i may gain in a step of length h from v_n to
 * v = (x_next - x_n) / h. Along this path convex constraints release at most the work of their
 * forces at its end; r is the part of these forces that inertia does not balance
 * (docs/theory/step.md). */
static double energy_gain(const struct pdyn_sim *sim, int i, double h) {
    const struct objective *objective = &sim->objective;
    const double *v = sim->v + 3 * i, m = objective->mass[i];
    const double *v_n = (sim->v_before ? sim->v_before : sim->v_base) + 3 * i;
    double change[3], r[3];
    for (int a = 0; a < 3; a++) {
        int k = 3 * i + a;
        double pulled = (sim->x_next[k] - objective->s[k]) / (objective->h * objective->h);
        change[a] = v[a] - v_n[a];
        r[a] = h * sim->gradient[k] + m * (change[a] - h * (pulled + applied_acceleration(sim, k)));
    }
    return vec3_dot(r, v) - 0.5 * m * vec3_dot(change, change);
}

/* Removes the energy gain from the motion relative to the mean velocity. */
static void remove_energy_gain(struct pdyn_sim *sim, double h) {
    const struct objective *objective = &sim->objective;
    double gained = 0.0, kinetic = 0.0, mean[3], excess[3] = {0};
    mean_velocity(sim, mean);
    for (int i = 0; i < objective->particles; i++) {
        double speed = vec3_distance(sim->v + 3 * i, mean);
        if (!particle_is_live(sim, i) || particle_is_pushed(sim, i)) continue;
        gained += energy_gain(sim, i, h);
        kinetic += 0.5 * objective->mass[i] * speed * speed;
    }
    if (!(gained > 0.0)) return;
    double part = sqrt(fmax(0.0, 1.0 - gained / kinetic));
    for (int k = 0; k < 3 * objective->particles; k++) {
        if (!particle_is_live(sim, k / 3)) continue;
        double v = mean[k % 3] + part * (sim->v[k] - mean[k % 3]);
        excess[k % 3] += objective->mass[k / 3] * (v - sim->v[k]);
        sim->v[k] = v;
    }
    subtract_momentum(sim, excess);
}

/* After an unsolved step, computes the velocities of Euler's method, v = (x_next - x) / h. With the
 * formula (x_next - x^) / h_e of bdf2 they would have 1.5 times the error, because h_e = 2/3 h. */
static void update_unsolved(struct pdyn_sim *sim, double h) {
    compute_velocities(sim, sim->x, h);
    remove_energy_gain(sim, h);
    rigid_bodies_project(sim, sim->x_next, sim->v);
    sim->history = 0.0;
    sim->impacts = 0;
    sim->left_out = 0.0;
}

/* ---- all steps ------------------------------------------------------------------------------- */

/* Only a Newton step needs Euler velocities where it is far from solved. When a solver for the
 * multipliers of a fluid ends early, positions still follow exactly from its forces and inertia.
 * When the classic projective step ends early, it has moved too little, because its matrix is
 * stiffer than E. */
void velocities_update(struct pdyn_sim *sim, double h) {
    if (sim->far_off && sim->scene.settings.newton && !solves_fluid_alone(sim)) {
        update_unsolved(sim, h);
        return;
    }
    compute_velocities(sim, sim->x_base, sim->objective.h);
    rigid_bodies_set_velocities(sim);
    sim->impacts = impacts_correct(sim, h);
    double part = sim->objective.h / h;
    sim->left_out = sim->v_before ? 1.0 - part * part : 0.0;
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
