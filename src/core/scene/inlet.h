/* "inlets" of a body and "outlets" of a scene. */
#ifndef PDYN_INLET_H
#define PDYN_INLET_H

#include "json_file.h"
#include "scene.h"

/* Keys of inlets and outlets, except "rectangle", "disc", "up" and "box". */
extern const pdyn_param inlet_params[], outlet_params[];

/* Reads an inlet for particles of this radius, m, in a scene that ends at `end`, s. */
pdyn_status inlet_read(const struct json_at *at, double radius, double end,
                       struct scene_inlet *out);

/* How far behind the opening a layer appears, in spacings. Layers are one spacing apart; the first
 * one is in the opening at `start`, and the second behind it. */
#define INLET_BEHIND 1.0

/* Number of layers, of an inlet that never ends, that are `distance` spacings or more in front of
 * the opening at a time, s. */
double inlet_layers_beyond(const struct scene_inlet *inlet, double time, double spacing,
                           double distance);

/* Number of particles that the inlet emits in all. */
double inlet_total(const struct scene_inlet *inlet);

pdyn_status outlet_read(const struct json_at *at, struct scene_outlet *out);

#endif
