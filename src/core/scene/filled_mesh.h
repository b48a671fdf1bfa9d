/* "cell": a closed mesh that is filled with tetrahedra, of a soft solid, or of a rigid body, which
 * keeps their outside. */
#ifndef PDYN_FILLED_MESH_H
#define PDYN_FILLED_MESH_H

#include "json_file.h"
#include "scene.h"
#include "transform.h"

/* Reads the mesh at `at`, places it, and fills it with tetrahedra of the size at `cell`: sets mesh,
 * tets, filled, crumbs and missed of the body. */
pdyn_status filled_mesh_read(const struct json_at *at, const struct json_at *cell,
                             const struct transform *transform, struct scene_body *body);

/* The same, of which only the outside is kept, in body->mesh. */
pdyn_status filled_mesh_read_surface(const struct json_at *at, const struct json_at *cell,
                                     const struct transform *transform, struct scene_body *body);

#endif
