/* Momentum of a system that no constraint anchors: a step conserves it exactly. */
#ifndef PDYN_MOMENTUM_H
#define PDYN_MOMENTUM_H

#include "sim/sim.h"

/* Subtracts `sum` over the mass of all live particles from the vector of each of them: from x a sum
 * in kg m, from v one in N s. Where a constraint is anchored, it does nothing. */
void momentum_subtract(const struct pdyn_sim *sim, const double sum[3], double *vector);

/* Removes the momentum error of a solve that ended early: the mass-weighted mean of x - s. Where a
 * constraint is anchored, it does nothing. */
pdyn_status momentum_restore(struct pdyn_sim *sim);

#endif
