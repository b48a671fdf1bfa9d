/* Scale, rotation and translation of what a scene places in the world. */
#ifndef PDYN_TRANSFORM_H
#define PDYN_TRANSFORM_H

#include "json_file.h"

struct transform {
    double scale[3], rotate[3], translate[3];
};

/* Reads "scale", "rotate" and "translate" of an object. PDYN_BAD_INPUT: a scale is 0 or below
 * `min`. */
pdyn_status transform_read(const struct json_at *owner, double min, struct transform *out);

/* Fails if the object has one of these keys: "KEY needs WHAT". */
pdyn_status transform_refuse(const struct json_at *owner, const char *what);

/* Scales, rotates about x, then y, then z, and translates `count` points, m, in place. Directions
 * are only rotated. */
void transform_points(const struct transform *t, double *x, int count);
void transform_directions(const struct transform *t, double *v, int count);

#endif
