/* Points on the surfaces of a scene's solids, through which these act on the fluid. */
#ifndef PDYN_SOLID_POINTS_H
#define PDYN_SOLID_POINTS_H

#include "projdyn/projdyn.h"

#include <stdbool.h>

struct pdyn_sim;

/* Points on the scene's solids: first of those that rest, then of those that move. */
pdyn_status solid_points_sample(struct pdyn_sim *sim, double spacing);

/* The volumes of these points, and which have the kernel of particles. */
pdyn_status solid_points_fill(struct pdyn_sim *sim, double spacing, double *volume, bool *is_wall);

#endif
