/* The velocities at the end of a step, from the positions that minimise E. */
#ifndef PDYN_VELOCITIES_H
#define PDYN_VELOCITIES_H

#include "sim.h"

/* sim->v after a step of length h, s, from sim->x to sim->x_next. The next step is Euler's after
 * one that was not solved. */
void velocities_take(struct pdyn_sim *sim, double h);

/* What operators do to velocities at the end of a step: viscosity. */
void velocities_change(struct pdyn_sim *sim, double h);

#endif
