/* Accuracy and physical quantities of a step: density errors, energies, momentum, reactions. */
#ifndef PDYN_MEASURE_H
#define PDYN_MEASURE_H

#include "sim.h"

/* Computes the weights of the bodies, |M g| over their live particles, N; g: the largest
 * |g| so far, with keys the largest of all keys; 9.81 m/s^2 where that is below 1e-3 m/s^2. Step
 * residuals are relative to these. */
void measure_weights(struct pdyn_sim *sim);

/* PDYN_DIVERGED: a step of length h, s, to x_next exceeds STEP_MAX_POSITION or STEP_MAX_SPEED. */
pdyn_status measure_check_range(struct pdyn_sim *sim, double h);

/* Updates density and pressure from the operators; the last local step must have been at x_next. */
void measure_update_fluid(struct pdyn_sim *sim);

/* Computes density errors, energies, momentum and pin reaction of the accepted state. */
void measure_step(struct pdyn_sim *sim, pdyn_step_info *info);

#endif
