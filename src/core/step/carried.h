/* Where the iterate starts its path to the prediction s: at the state, except for particles in
 * front of a moving solid. A solid is moved at the beginning of a step, maybe by more than the
 * distance of its nearest particles. They would be behind its surface then, and the energy would
 * push them on. So the solid carries them along first. */
#ifndef PDYN_CARRIED_H
#define PDYN_CARRIED_H

#include "base/context.h"

struct pdyn_sim;

struct carried {
    double *x;      /* particles x 3, m: the state, particles in front of solids carried along */
    double *before; /* moving boundary points x 3, m: at the beginning of the step */
};

/* Leaves sim->carried NULL in a scene in which no particle can pass a moving solid. */
pdyn_status carried_create(struct pdyn_sim *sim);
void carried_free(struct pdyn_sim *sim);

/* Moves the solids to the end of the step, and particles in front of them along. */
pdyn_status carried_move(struct pdyn_sim *sim);

/* Where the iterate starts: particles x 3, m. */
const double *carried_x(const struct pdyn_sim *sim);

#endif
