/* Fits rigid motions to what a program sets of the vertices of rigid bodies. */
#ifndef PDYN_RIGID_FIT_H
#define PDYN_RIGID_FIT_H

#include "sim.h"

/* PDYN_BAD_INPUT: of the vertices of a rigid body, a program sets some and not all. first, count:
 * the particles that it sets. */
pdyn_status rigid_fit_check(const struct pdyn_sim *sim, int first, int count);
/* Moves the bodies of these particles to the rigid poses closest to the vertices at sim->x. */
void rigid_fit_positions(struct pdyn_sim *sim, int first, int count);
/* Gives them the rigid motions closest to the velocities sim->v of the vertices. */
void rigid_fit_velocities(struct pdyn_sim *sim, int first, int count);

#endif
