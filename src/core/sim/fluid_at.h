/* The fluid at a place: pressure and velocity, and the height of its surface. */
#ifndef PDYN_FLUID_AT_H
#define PDYN_FLUID_AT_H

#include "sim.h"

enum { FLUID_VALUES = 4 };
/* Pressure, Pa, and velocity, m/s, at `at`, m: the first-order moving least-squares fit of the
 * particles within `radius`, m; 0 where there is none. */
void fluid_at_fit(const struct pdyn_sim *sim, const double *at, double radius,
                  double value[FLUID_VALUES]);

/* Height of the free surface above `at` against gravity, m; 0 where there is no fluid above. */
double fluid_at_height(const struct pdyn_sim *sim, const double *at);

#endif
