/* The paths of particles to an iterate, stopped where surfaces of contact are in their way. */
#ifndef PDYN_STOP_PATHS_H
#define PDYN_STOP_PATHS_H

#include "sim/sim.h"

enum paths {
    PATHS_TO_START,     /* from set_path_starts to positions, while solids move to their goals */
    PATHS_FROM_ITERATE, /* from sim->x_next by displacements */
};

/* Stops every point on its path; to: particles x 3, m. A rigid body that stops within a turn, here
 * or by iterate_limit, is put to the closest rigid pose, to which the path is checked again; a body
 * that still stops after some of these checks does not move. *part is multiplied by the smallest
 * part of its path that a point goes. sim->rhs is scratch. */
pdyn_status stop_paths(struct pdyn_sim *sim, enum paths paths, double *to, double *part);

/* x = where the paths of particles to their first iterate begin: the state, with particles carried
 * along by moving solids (carried.h), and bodies moved by their common displacement
 * (contact/common_motion.c). */
void set_path_starts(const struct pdyn_sim *sim, double *x);

#endif
