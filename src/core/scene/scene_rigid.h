/* Reading a rigid body: its shape, mass properties and rotation. */
#ifndef PDYN_SCENE_RIGID_H
#define PDYN_SCENE_RIGID_H

#include "reader.h"

/* Reads the object "rigid" of the current body. */
pdyn_status scene_read_rigid(struct reader *r, const struct json_at *at);

#endif
