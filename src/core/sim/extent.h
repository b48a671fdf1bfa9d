/* How far a body, the fluids and a scene extend, m, at the current positions. */
#ifndef PDYN_EXTENT_H
#define PDYN_EXTENT_H

#include "sim.h"

#include "projdyn/box.h"

/* The bounding box of a body. */
struct box extent_of_body(const struct pdyn_sim *sim, const pdyn_body *body);

/* The bounding box of the live particles of all fluids; empty without one. */
struct box extent_of_fluids(const struct pdyn_sim *sim);

/* The bounding box of all solids but one at rest positions; -1: of all. */
struct box extent_of_solids(const struct pdyn_sim *sim, int but);

/* The bounding box of all solids at rest positions and all live particles. */
struct box extent_of_scene(const struct pdyn_sim *sim);

/* The height of a place, m, against gravity; 0 without gravity. */
double extent_height(const struct pdyn_sim *sim, const double *x);

/* The height, m, below which a particle fell out of the scene: it is as far below
 * everything in the scene now as that is wide and high. */
double extent_floor(const struct pdyn_sim *sim);

#endif
