/* The accuracy and physics of a step, measured rather than assumed. */
#ifndef PDYN_MEASURE_H
#define PDYN_MEASURE_H

#include "sim.h"

/* The weights of bodies, |M g| in N over their live particles, with 9.81 m/s^2 where the scene has
 * no gravity: what step residuals are relative to. */
void measure_weights(struct pdyn_sim *sim);

/* PDYN_DIVERGED where x_next cannot be a state. */
pdyn_status measure_finite(struct pdyn_sim *sim);

/* Density and pressure of the coming state x_next, which was that of the last local step. */
void measure_fetch(struct pdyn_sim *sim);

/* Fills density errors, energies, momentum and pin reaction of the state just accepted. */
void measure_step(struct pdyn_sim *sim, pdyn_step_info *info);

#endif
