/* "inlets" of a body and "outlets" of a scene. */
#ifndef PDYN_INLET_H
#define PDYN_INLET_H

#include "json_file.h"
#include "scene.h"

/* Keys of inlets and outlets that are one value each. */
extern const pdyn_param inlet_params[], outlet_params[];
extern const pdyn_param inlet_speed_param; /* of a key of "speed" */

/* Reads an inlet of a body of particles, whose name and radius are known. The caller calls
 * inlet_free, after a failure, too. */
pdyn_status inlet_read(const struct json_at *at, const struct scene_body *body,
                       struct scene_inlet *out);
/* Says how much of the area of an inlet its layers have where it differs by more than a tenth: once
 * for all inlets of the body that are alike. After all of them have been read. */
void inlet_note_areas(pdyn_context *context, const struct scene_body *body);
void inlet_free(pdyn_context *context, struct scene_inlet *inlet);

pdyn_status outlet_read(const struct json_at *at, struct scene_outlet *out);

#endif
