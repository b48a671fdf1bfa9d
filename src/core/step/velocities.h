/* Velocities at the end of a step, from the positions that minimise E. */
#ifndef PDYN_VELOCITIES_H
#define PDYN_VELOCITIES_H

#include "sim.h"

/* Computes sim->v after a step of length h, s, from sim->x to sim->x_next. After a step that was
 * not solved, the next step is an Euler step. */
void velocities_update(struct pdyn_sim *sim, double h);

/* Lets operators change the velocities at the end of a step of length h, s: viscosity. */
void velocities_apply_operators(struct pdyn_sim *sim, double h);

#endif
