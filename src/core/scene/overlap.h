/* Particles that overlap with solids and surfaces at the start. Their energy would be released in
 * the first step. */
#ifndef PDYN_OVERLAP_H
#define PDYN_OVERLAP_H

#include "json_file.h"
#include "scene.h"

/* Sets is_vessel of the solids: a box with an open side, or one that contains most particles of a
 * body or of a layer of an inlet. */
void overlap_find_vessels(struct scene *scene);

/* Removes the particles of a body that lie inside a closed solid or body, or closer than a particle
 * radius to one. A closed solid that contains most particles of the body is a vessel: its inside
 * stays. Behind a wall of a box with fluid inside, particles closer than five radii are left out. A
 * body that keeps its particles ("overlap": "keep", or particles from a file) is checked instead.
 * at: "particles" of the body. PDYN_BAD_INPUT: no particle is left; or a body that keeps its
 * particles has more than a thousandth of them inside of a solid or a volume, or closer to one than
 * half a radius. */
pdyn_status overlap_resolve(const struct json_at *at, const struct scene *scene,
                            struct scene_body *body);

/* The points of a wall lie a spacing behind it and push particles closer than 1.5 spacings: the
 * distance, in radii, within which it acts on the fluid behind it. */
enum { OVERLAP_BEHIND_WALLS = 5 };

/* Whether a point, m, lies outside of a wall of a vessel, which rests, and closer to it than
 * `distance`, m. */
bool overlap_is_behind_wall(const struct scene_solid *vessel, const double rest[3],
                            double distance);

#endif
