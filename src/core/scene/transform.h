/* What a scene takes from other files, and puts into its place in the world: scaled, turned and
 * moved. */
#ifndef PDYN_TRANSFORM_H
#define PDYN_TRANSFORM_H

#include "geometry/mesh.h"
#include "json_file.h"

struct transform {
    double scale[3], rotate[3], translate[3];
};

/* "scale", "rotate" and "translate" of an object; no scale is 0 or below `least`. */
pdyn_status transform_read(const struct json_at *owner, double least, struct transform *out);

/* Fails at the first of these keys that stands in the object: they need `what`. */
pdyn_status transform_refuse(const struct json_at *owner, const char *what);

/* Scales, turns about x, then y, then z, and moves; directions are only turned. */
void transform_points(const struct transform *t, double *x, int count);
void transform_directions(const struct transform *t, double *v, int count);

/* Reads the mesh or the particles whose file is named at `at`, found from the folder of the scene
 * (a scene that is a text has none). */
pdyn_status transform_mesh(const struct json_at *at, struct mesh *mesh);
pdyn_status transform_particles(const struct json_at *at, struct particles *particles);

/* The path of a file that a scene names, found relative to the folder of the scene's file: *size
 * bytes of the context. `what` is expected at `at`. */
pdyn_status transform_path(const struct json_at *at, const char *what, char **path, size_t *size);

#endif
