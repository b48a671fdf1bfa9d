/* Reading a body: one file for each kind, and one for constraints. */
#ifndef PDYN_SCENE_BODY_H
#define PDYN_SCENE_BODY_H

#include "reader.h"

/* Reads the object "particles", "surface", "volume" or "rigid" of the current body. */
typedef pdyn_status scene_read_kind_fn(struct reader *r, const struct json_at *at);
scene_read_kind_fn scene_read_particles, scene_read_surface, scene_read_volume, scene_read_rigid;

/* Reads the array "constraints" of the current body, which may be missing. */
pdyn_status scene_read_constraints(struct reader *r, const struct json_at *array);

#endif
