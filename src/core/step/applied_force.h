/* Gravity and the forces that a program applies (projdyn/control.h). */
#ifndef PDYN_APPLIED_FORCE_H
#define PDYN_APPLIED_FORCE_H

#include "sim/sim.h"

/* Component k, of 3 for each particle, of the acceleration g + f/m, m/s^2. */
static inline double applied_acceleration(const struct pdyn_sim *sim, int k) {
    const double *force = sim->control.force, g = sim->scene.settings.gravity[k % 3];
    return force ? g + force[k] / sim->objective.mass[k / 3] : g;
}

#endif
