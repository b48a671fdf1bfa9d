/* Particles that overlap with solids and surfaces at the start. Their energy would be released in
 * the first step. */
#ifndef PDYN_OVERLAP_H
#define PDYN_OVERLAP_H

#include "json_file.h"
#include "scene.h"

/* Removes the particles of a body that lie inside a closed solid or body, or closer than a particle
 * radius to one. A closed solid that contains most particles of the body is a vessel: its inside
 * stays. Behind a wall of a box with fluid inside, particles closer than five radii are left out. A
 * body that keeps its particles ("overlap": "keep", or particles from a file) is checked instead.
 * at: "particles" of the body. PDYN_BAD_INPUT: no particle is left; or a body that keeps its
 * particles has more than a thousandth of them inside of a solid or a volume, or closer to one than
 * half a radius. */
pdyn_status overlap_resolve(const struct json_at *at, const struct scene *scene,
                            struct scene_body *body);

#endif
