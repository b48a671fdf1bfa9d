/* Fits rigid motions to what a program sets of the vertices of rigid bodies. */
#ifndef PDYN_RIGID_FIT_H
#define PDYN_RIGID_FIT_H

#include "sim.h"

/* PDYN_BAD_INPUT: of the vertices of a rigid body, a program sets some and not all. first, count:
 * the particles that it sets. */
pdyn_status rigid_fit_check(const struct pdyn_sim *sim, int first, int count);
/* Where v is NULL, moves x of the bodies to the rigid poses closest to the vertices at x. Otherwise
 * changes v to the rigid motions closest to the velocities v of the vertices at x. x, v: particles
 * x 3, m and m/s. */
void rigid_fit(const struct pdyn_sim *sim, int first, int count, double *x, double *v);

#endif
