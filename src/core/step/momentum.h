/* Momentum of bodies that no constraint anchors: a step conserves it exactly, in each group of
 * bodies that interact. Where a constraint is anchored, these functions do nothing. They overwrite
 * sim->trial, direction and rhs. */
#ifndef PDYN_MOMENTUM_H
#define PDYN_MOMENTUM_H

#include "sim/sim.h"

/* Finds the groups of this step, and removes the momentum error of a solve that ended early from
 * the iterate: the mass-weighted mean of x - s of each group. With contact and several groups it
 * moves each by a quarter of the thickness at most, as pairs of different groups are farther than
 * the thickness from each other: momentum_subtract removes all of the error from the velocities. */
pdyn_status momentum_restore(struct pdyn_sim *sim);

/* Subtracts from v the mean of each group: the sum of `excess` (particles x 3, kg m/s, may be
 * sim->trial) over its mass. After momentum_restore. */
void momentum_subtract(struct pdyn_sim *sim, const double *excess, double *v);

#endif
