/* Reading "motion" and "pivot" of a solid or an inlet. */
#ifndef PDYN_MOTION_H
#define PDYN_MOTION_H

#include "json_file.h"
#include "scene.h"

/* Reads the motion of an object whose default pivot is in *motion. The caller calls motion_free,
 * after a failure, too. */
pdyn_status motion_read(const struct json_at *owner, struct scene_motion *motion);
void motion_free(pdyn_context *context, struct scene_motion *motion);

#endif
