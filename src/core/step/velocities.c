#include "velocities.h"

#include "live_particles.h"

#include "projdyn/vec3.h"

#include <string.h>

/* v = (x_next - from) / h. Positions can meet a momentum up to their rounding; velocities take the
 * rest, so that it does not add up over many steps. */
static void divide(struct pdyn_sim *sim, const double *from, double h) {
    const double *g = sim->scene.settings.gravity, H = sim->objective.h;
    double excess[3] = {0}, mass = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) {
        double m = live_particles_has(sim, i) ? sim->objective.mass[i] : 0.0;
        mass += m;
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            double v = (sim->x_next[k] - from[k]) / h;
            excess[k % 3] += m * (v - sim->v_base[k] - H * g[k % 3]);
            sim->v[k] = v;
        }
    }
    if (sim->anchored) return;
    for (int k = 0; k < 3 * sim->objective.particles; k++)
        if (live_particles_has(sim, k / 3)) sim->v[k] -= excess[k % 3] / mass;
}

/* ---- steps that were not solved -------------------------------------------------------------- */

/* The mean velocity of what moves freely; 0 where something can take momentum away. */
static void mean_velocity(const struct pdyn_sim *sim, double mean[3]) {
    double mass = 0.0;
    mean[0] = mean[1] = mean[2] = 0.0;
    for (int i = 0; i < sim->objective.particles && !sim->anchored; i++) {
        if (!live_particles_has(sim, i)) continue;
        mass += sim->objective.mass[i];
        vec3_add(mean, sim->objective.mass[i], sim->v + 3 * i);
    }
    for (int a = 0; a < 3 && mass > 0.0; a++) mean[a] /= mass;
}

/* What particle i may have gained in a step of length h from velocity v_n to v = (x_next - x_n) /
 * h, J. Convex constraints do not give more energy on that way than the work of their forces at its
 * end; r is what those forces and inertia leave open (docs/theory/step.md). */
static double gain_of(const struct pdyn_sim *sim, int i, double h) {
    const struct objective *sys = &sim->objective;
    const double *v = sim->v + 3 * i, m = sys->mass[i];
    const double *v_n = (sim->v_before ? sim->v_before : sim->v_base) + 3 * i;
    double change[3], r[3];
    for (int a = 0; a < 3; a++) {
        int k = 3 * i + a;
        double pulled = (sim->x_next[k] - sys->s[k]) / (sys->h * sys->h);
        change[a] = v[a] - v_n[a];
        r[a] =
            h * sim->gradient[k] + m * (change[a] - h * (pulled + sim->scene.settings.gravity[a]));
    }
    return vec3_dot(r, v) - 0.5 * m * vec3_dot(change, change);
}

/* The motion relative to the mean pays for what was gained. */
static void pay_for_work(struct pdyn_sim *sim, double h) {
    const struct objective *sys = &sim->objective;
    double gained = 0.0, kinetic = 0.0, mean[3];
    mean_velocity(sim, mean);
    for (int i = 0; i < sys->particles; i++) {
        double own = vec3_distance(sim->v + 3 * i, mean);
        if (!live_particles_has(sim, i)) continue;
        gained += gain_of(sim, i, h);
        kinetic += 0.5 * sys->mass[i] * own * own;
    }
    if (!(gained > 0.0)) return;
    double part = sqrt(fmax(0.0, 1.0 - gained / kinetic));
    for (int k = 0; k < 3 * sys->particles; k++)
        if (live_particles_has(sim, k / 3))
            sim->v[k] = mean[k % 3] + part * (sim->v[k] - mean[k % 3]);
}

/* Velocities by the displacement, as Euler has them: an x^ that was not reached, because something
 * was in the way, says nothing about them. */
static void take_unsolved(struct pdyn_sim *sim, double h) {
    divide(sim, sim->x, h);
    pay_for_work(sim, h);
    sim->history = 0.0;
    sim->impacts = 0;
}

/* ---- all steps ------------------------------------------------------------------------------- */

/* Multipliers meet the inertia exactly, however early a solve ends, and the classic step is stiffer
 * than E: both may be cut short. */
void velocities_take(struct pdyn_sim *sim, double h) {
    if (sim->unfinished && sim->scene.settings.newton && !sim->solver->dual) {
        take_unsolved(sim, h);
        return;
    }
    divide(sim, sim->x_base, sim->objective.h);
    sim->impacts = integrator_impacts(sim, h);
}

/* The next steps see a change of v as an acceleration of change / H, where change / h is meant. */
void velocities_change(struct pdyn_sim *sim, double h) {
    struct objective *sys = &sim->objective;
    double part = sys->h / h, *before = sim->trial;
    memcpy(before, sim->v, objective_bytes(sys));
    for (int b = 0; b < sys->batches; b++) batch_velocity(sys->batch[b], sim->v);
    if (part == 1.0) return;
    for (int k = 0; k < 3 * sys->particles; k++)
        sim->v[k] = before[k] + part * (sim->v[k] - before[k]);
}
