/* Vessels: solids with the fluid inside of them. Any other solid has it on all sides. */
#ifndef PDYN_VESSEL_H
#define PDYN_VESSEL_H

#include "scene.h"

/* The points of a wall lie a spacing behind it and push particles closer than 1.5 spacings: the
 * distance, in radii, within which it acts on the fluid behind it. */
enum { VESSEL_WALL_REACH = 5 };

/* Sets is_vessel of the solids: a box with an open side, or one that contains most particles of a
 * body or of a layer of an inlet. */
void vessel_find_all(struct scene *scene);

/* Whether a point, m, lies outside of a wall of a vessel, which rests, and closer to it than
 * `distance`, m. */
bool vessel_is_behind_wall(const struct scene_solid *vessel, const double rest[3], double distance);

#endif
