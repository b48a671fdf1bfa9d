/* Spheres, capsules, planes and boxes as triangle meshes, and their JSON objects. */
#ifndef PDYN_PRIMITIVE_MESH_H
#define PDYN_PRIMITIVE_MESH_H

#include "json_file.h"
#include "scene.h"

/* All points within `radius`, m, of the segment between two points; a sphere if the points are
 * equal. The vertices lie on the surface, `bump`, m, outside the triangles, but within 0.24 to 1.7
 * % of the radius: a sphere has 3968 to 528 triangles. */
pdyn_status primitive_capsule(pdyn_context *context, const double from[3], const double to[3],
                              double radius, double bump, struct mesh *out);

/* A square of edge `size`, m, perpendicular to a normal of any length. */
pdyn_status primitive_plane(pdyn_context *context, const double center[3], const double normal[3],
                            double size, struct mesh *out);

/* The closed faces of a box (`open`: bits as in scene_solid), two triangles each. */
pdyn_status primitive_box(pdyn_context *context, const struct box *box, unsigned open,
                          struct mesh *out);

/* Read {"center": [..], "radius": r}, {"from": [..], "to": [..], "radius": r} and
 * {"center": [..], "normal": [..], "size": s}. middle: the centre, m. */
typedef pdyn_status primitive_read_fn(const struct json_at *at, double bump, struct mesh *mesh,
                                      double middle[3]);
primitive_read_fn primitive_read_sphere, primitive_read_capsule, primitive_read_plane;

#endif
