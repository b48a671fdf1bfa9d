/* Where a scene lets particles in and out: "inlets" of a body, "outlets" of the scene. */
#ifndef PDYN_INLET_H
#define PDYN_INLET_H

#include "json_file.h"
#include "scene.h"

/* The keys of both, besides "rectangle", "disc", "up" and "box". */
extern const pdyn_param inlet_params[], outlet_params[];

/* Reads an inlet for particles of this radius in a scene that ends at `end`, s. */
pdyn_status inlet_read(const struct json_at *at, double radius, double end,
                       struct scene_inlet *out);

/* How many particles it emits in all. */
double inlet_total(const struct scene_inlet *inlet);

pdyn_status outlet_read(const struct json_at *at, struct scene_outlet *out);

#endif
