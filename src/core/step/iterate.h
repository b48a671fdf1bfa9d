/* The iterate of a minimisation, sim->x_next, and the trial beside it: no particle moves farther at
 * once than sim->max_step, and rigid bodies move as a whole. */
#ifndef PDYN_ITERATE_H
#define PDYN_ITERATE_H

#include "sim/sim.h"

/* Sets sim->max_step for displacements from x. */
pdyn_status iterate_update_limits(struct pdyn_sim *sim, const double *x);

/* Limits displacements (particles x 3) to sim->max_step, so that no particle passes a surface.
 * Returns the smallest part of a displacement that is left. */
double iterate_limit(const struct pdyn_sim *sim, double *moves);

/* Makes the shapes of rigid bodies rigid at x. Returns whether one was not. */
bool iterate_retract(const struct pdyn_sim *sim, double *x);
/* The same for displacements from the iterate. */
bool iterate_retract_moves(struct pdyn_sim *sim, double *moves);

/* The trial and its gradient become the iterate and its gradient. */
void iterate_accept_trial(struct pdyn_sim *sim);

/* Half of the part of a displacement, but not less than the first touch, where the smallest part of
 * a point is `least`: there contact enters the model. */
static inline double iterate_shorter_part(double part, double least) {
    return part > least && 0.5 * part < least ? least : 0.5 * part;
}

#endif
