/* Filling a body with particles: boxes, spheres, closed meshes, and particles from files. */
#ifndef PDYN_FILL_H
#define PDYN_FILL_H

#include "json_file.h"
#include "scene.h"

enum { MOST_PARTICLES = 1 << 27 };

/* Adds to the particles of the scene so far; fails beyond MOST_PARTICLES. */
pdyn_status fill_count(const struct json_at *at, double count, double *so_far);

/* Adds what one entry of "fill" says to the start of a body, whose radius and velocity are known.
 */
pdyn_status fill_read(const struct json_at *at, struct scene_body *body, double *so_far);

#endif
