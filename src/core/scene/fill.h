/* Filling a body with particles: boxes, spheres, closed meshes, and particles from files. */
#ifndef PDYN_FILL_H
#define PDYN_FILL_H

#include "json_file.h"
#include "scene.h"

enum { MOST_PARTICLES = 1 << 27 };

#define FILL_FARTHEST 1e6 /* m from the origin, as for all that a scene places */

/* Adds to the particles of the scene so far; fails beyond MOST_PARTICLES. */
pdyn_status fill_count(const struct json_at *at, double count, double *so_far);

/* The points from `first` on are finite and none is farther than FILL_FARTHEST. */
pdyn_status fill_check_range(const struct json_at *at, const struct point_list *points, int first);

/* Adds what one entry of "fill" says to the start of a body, whose radius and velocity are known.
 */
pdyn_status fill_read(const struct json_at *at, struct scene_body *body, double *so_far);

#endif
