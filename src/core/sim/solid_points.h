/* Boundary points on the solids of a scene, through which these act on the fluid. */
#ifndef PDYN_SOLID_POINTS_H
#define PDYN_SOLID_POINTS_H

#include "projdyn/projdyn.h"

#include <stdbool.h>

struct pdyn_sim;

/* Samples all solids: first those at rest, then those that move. */
pdyn_status solid_points_sample(struct pdyn_sim *sim);

/* Computes face_x of `count` boundary points from the first one on. at: count x 3, m, their places
 * without the motion of their solid. */
void solid_points_find_faces(struct pdyn_sim *sim, int first, int count, const double *at);

/* Computes the volumes, m^3, of the boundary points, and which have the kernel of particles. */
pdyn_status solid_points_compute_volumes(struct pdyn_sim *sim, double *volume, bool *is_wall);

#endif
