/* How far a body and a scene extend, m, at the current positions. */
#ifndef PDYN_EXTENT_H
#define PDYN_EXTENT_H

#include "sim.h"

#include "projdyn/box.h"

/* The bounding box of a body. */
struct box extent_of_body(const struct pdyn_sim *sim, const pdyn_body *body);

/* The bounding box of all solids at rest positions and all live particles. */
struct box extent_of_scene(const struct pdyn_sim *sim);

/* The height, m, against gravity, below which a particle fell out of the scene: it is as far below
 * everything in the scene now as that is wide and high. */
double extent_floor(const struct pdyn_sim *sim);

#endif
