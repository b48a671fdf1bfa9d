/* Filling a body with particles: boxes, spheres, closed meshes, and particles from files. */
#ifndef PDYN_FILL_H
#define PDYN_FILL_H

#include "json_file.h"
#include "scene.h"

/* Checks that the points from index `first` on are finite and within SCENE_MAX_POSITION. */
pdyn_status fill_check_range(const struct json_at *at, const struct point_list *points, int first);

/* Reads one entry of "fill" and appends its particles to the body, whose radius and velocity must
 * be set. */
pdyn_status fill_read(const struct json_at *at, struct scene_body *body, double *so_far);

#endif
