/* Particles of inlets that would enter inside a solid. */
#ifndef PDYN_INLET_COVER_H
#define PDYN_INLET_COVER_H

#include "json_file.h"
#include "scene.h"

/* Leaves out the particles of the layers of a body's inlets that a solid covers: one spacing in
 * front of the opening, their way lies inside of the solid, behind a wall of a vessel, or close to
 * a surface. Where the inlet or the solid moves, they stay and are only counted (`covered`). A
 * closed solid that the inlet flows within is a vessel. at: "particles" of the body.
 * PDYN_BAD_INPUT: no particle of a layer is left. */
pdyn_status inlet_cover_resolve(const struct json_at *at, const struct scene *scene,
                                struct scene_body *body);

#endif
