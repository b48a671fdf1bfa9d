#include "integrator.h"

#include "live_particles.h"
#include "scene/choices.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <string.h>

/* base = x_n + part (x_n - x_(n-1)), and the same of the velocities. */
static void extrapolate(struct pdyn_sim *sim, double part) {
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        sim->x_base[k] = sim->x[k] + part * (sim->x[k] - sim->x_before[k]);
        sim->v_base[k] = sim->v[k] + part * (sim->v[k] - sim->v_before[k]);
    }
}

static double begin_euler(struct pdyn_sim *sim, double h) {
    memcpy(sim->x_base, sim->x, objective_bytes(&sim->objective));
    memcpy(sim->v_base, sim->v, objective_bytes(&sim->objective));
    return h;
}

/* Zero-stable as long as steps grow by less than 1 + sqrt(2) (Hairer, Norsett, Wanner, Solving
 * Ordinary Differential Equations I, section III.5). One longer step is Euler's, which leaves the
 * order at two. */
static const double most_growth = 2.0;

/* The backward differentiation formula of order two, for steps of any lengths. */
static double begin_bdf2(struct pdyn_sim *sim, double h) {
    double w = sim->history > 0.0 ? h / sim->history : INFINITY;
    if (w > most_growth) return begin_euler(sim, h);
    extrapolate(sim, w * w / (1.0 + 2.0 * w));
    return h * (1.0 + w) / (1.0 + 2.0 * w);
}

/* ---- impacts --------------------------------------------------------------------------------- */

/* Takes impulses (particles x 3, m/s) out of v where they counted as H a, and puts them in as H^2 a
 * / h; v_before gets that, too. Beside a fluid, no particle moves farther than twice the way to the
 * velocity that Euler's step gives it, its displacement over h: a light point of a sheet that water
 * presses on and that other forces hold would be thrown by an impulse that these take up. What is
 * left out, *excess per mass, all get in equal parts. */
static void shift_velocities(struct pdyn_sim *sim, double h, const double *impulse,
                             double excess[2][3]) {
    const struct objective *sys = &sim->objective;
    double part = sys->h / h, mass = 0.0;
    memset(excess, 0, 6 * sizeof **excess);
    for (int i = 0; i < sys->particles; i++) {
        const double *own = impulse + 3 * i;
        double size = (1.0 - part) * vec3_length(own), most = 0.0;
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            double missing = (sim->x_next[k] - sim->x[k]) / h - sim->v[k];
            most += missing * missing;
        }
        double m = sys->mass[i], kept = 1.0;
        if (sim->neighbours && size * size > 4.0 * most) kept = 2.0 * sqrt(most) / size;
        for (int a = 0; a < 3; a++) {
            double lost = (1.0 - part) * own[a], gained = part * own[a];
            sim->v[3 * i + a] -= kept * lost;
            sim->v_before[3 * i + a] += kept * gained;
            excess[0][a] += m * (1.0 - kept) * lost;
            excess[1][a] -= m * (1.0 - kept) * gained;
        }
        mass += live_particles_has(sim, i) ? m : 0.0;
    }
    for (int a = 0; a < 3; a++) excess[0][a] /= mass, excess[1][a] /= mass;
}

/* A formula of two states takes the jump of v in an impact for an acceleration that goes on: what
 * falls on a floor would bounce. So the impulse of an impact, H a, counts as the displacement H^2 a
 * over h, as with Euler, and v_before gets it as well, as if it had been there before. Both are
 * sums of constraints' forces, so that momentum stays. */
int integrator_impacts(struct pdyn_sim *sim, double h) {
    struct objective *sys = &sim->objective;
    double H = sys->h, *force = sim->trial_gradient, *slowed = sim->trial;
    struct velocity_change change = {slowed, sys->particles, sys->mass, H, sim->direction};
    int count = 0;
    if (!sim->v_before) return 0;
    memset(force, 0, objective_bytes(sys));
    memcpy(slowed, sim->v_before, objective_bytes(sys));
    objective_axpy(sys, -1.0, sim->v, slowed);
    for (int b = 0; b < sys->batches; b++) count += batch_impacts(sys->batch[b], &change, force);
    double excess[2][3];
    for (int k = 0; k < 3 * sys->particles; k++) force[k] = -H * force[k] / sys->mass[k / 3];
    shift_velocities(sim, h, force, excess);
    for (int k = 0; !sim->anchored && k < 3 * sys->particles; k++) {
        if (!live_particles_has(sim, k / 3)) continue;
        sim->v[k] -= excess[0][k % 3];
        sim->v_before[k] -= excess[1][k % 3];
    }
    return count;
}

static const struct integrator integrators[] = {
    {"bdf2", "second order; one implicit step from two states", begin_bdf2, true},
    {"euler", "first order; implicit, as published", begin_euler, false},
};
const struct choices integrator_choices = {integrators, sizeof *integrators,
                                           sizeof integrators / sizeof *integrators};
