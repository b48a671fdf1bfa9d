/* Solids given by a few numbers, as triangle meshes, and how a scene says them. */
#ifndef PDYN_PRIMITIVE_MESH_H
#define PDYN_PRIMITIVE_MESH_H

#include "json_file.h"
#include "scene.h"

/* All points closer than a radius to the segment between two points; a sphere where these are one.
 * Its vertices lie on the surface, up to 0.24 % of the radius outside its triangles. */
pdyn_status primitive_capsule(pdyn_context *context, const double from[3], const double to[3],
                              double radius, struct mesh *out);

/* A square of a size, m, across a normal of any length. */
pdyn_status primitive_plane(pdyn_context *context, const double center[3], const double normal[3],
                            double size, struct mesh *out);

/* The faces of a box that are not open (bits as in scene_solid), two triangles each. */
pdyn_status primitive_box(pdyn_context *context, const struct scene_box *box, unsigned open,
                          struct mesh *out);

/* {"center": [..], "radius": r}, {"from": [..], "to": [..], "radius": r}, and
 * {"center": [..], "normal": [..], "size": s}, into the mesh; and the middle. */
pdyn_status primitive_read_sphere(const struct json_at *at, struct mesh *mesh, double middle[3]);
pdyn_status primitive_read_capsule(const struct json_at *at, struct mesh *mesh, double middle[3]);
pdyn_status primitive_read_plane(const struct json_at *at, struct mesh *mesh, double middle[3]);

#endif
