/* Filling a body with particles: boxes, spheres, closed meshes, and particles from files. */
#ifndef PDYN_FILL_H
#define PDYN_FILL_H

#include "reader.h"

/* Checks that the points from index `first` on are finite and within SCENE_MAX_POSITION. */
pdyn_status fill_check_range(const struct json_at *at, const struct point_list *points, int first);

/* Reads one entry of "fill" and appends its particles to the current body, whose radius and
 * velocity must be set. */
pdyn_status fill_read(struct reader *r, const struct json_at *at, struct scene_fill *out);

#endif
