/* Where the minimisation of a step starts. */
#ifndef PDYN_START_POINT_H
#define PDYN_START_POINT_H

#include "sim/sim.h"

/* Moves the iterate sim->x_next from the prediction s to where the minimisation starts: a point
 * that no surface is in the way of. Does the local step there: *energy, J, and sim->gradient. */
pdyn_status start_point(struct pdyn_sim *sim, double *energy);

#endif
