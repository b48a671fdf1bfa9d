/* Velocities at the end of a step, from the positions that minimise E. */
#ifndef PDYN_VELOCITIES_H
#define PDYN_VELOCITIES_H

#include "sim/sim.h"

/* *rise: by how much the energy of the constraints, J, is higher at the end of the step than at its
 * beginning, if the step is so far from solved that velocities_update needs it; 0 otherwise. The
 * last local step is that of sim->x_next before and after. */
pdyn_status velocities_measure_rise(struct pdyn_sim *sim, bool far_off, double *rise);

/* Computes sim->v after a step of length h, s, from sim->x to sim->x_next. After a step that was
 * far from solved, no energy has been gained (docs/theory/step.md), and the next step is an Euler
 * step. */
void velocities_update(struct pdyn_sim *sim, double h, double rise);

/* Lets operators change the velocities at the end of a step of length h, s: viscosity. */
void velocities_apply_operators(struct pdyn_sim *sim, double h);

#endif
