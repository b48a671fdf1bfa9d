/* "inlets" of a body and "outlets" of a scene. */
#ifndef PDYN_INLET_H
#define PDYN_INLET_H

#include "json_file.h"
#include "scene.h"

/* Keys of inlets and outlets that are one value each. */
extern const pdyn_param inlet_params[], outlet_params[];
extern const pdyn_param inlet_speed_param; /* of a key of "speed" */

/* Reads an inlet for particles of this radius, m. The caller calls inlet_free, after a failure,
 * too. */
pdyn_status inlet_read(const struct json_at *at, double radius, struct scene_inlet *out);
void inlet_free(pdyn_context *context, struct scene_inlet *inlet);

pdyn_status outlet_read(const struct json_at *at, struct scene_outlet *out);

#endif
