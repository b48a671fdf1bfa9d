/* Where an inlet is over time, how fast its layers flow, and how far they have come. Layers are one
 * particle spacing apart; the first one is in the opening at `start`, and the others follow. */
#ifndef PDYN_INLET_MOTION_H
#define PDYN_INLET_MOTION_H

#include "scene.h"

#define INLET_MAX_SPEED 1e6 /* m/s, of the flow */

/* How far behind the opening a layer appears, in spacings. */
#define INLET_BEHIND 1.0
/* How far every second particle of a layer is in front of it, in spacings. */
#define INLET_STAGGER 0.5

/* Speed of the flow relative to the inlet at a time, s: m/s. */
double inlet_speed(const struct scene_inlet *inlet, double time);

/* Upper bound of the speed of a particle in a layer between two times, s, the motion of the inlet
 * included: m/s. */
double inlet_top_speed(const struct scene_inlet *inlet, double from, double to);

/* Distance of the first layer from the opening at a time, s: m; -INFINITY before the start. */
double inlet_travelled(const struct scene_inlet *inlet, double time);

/* Number of layers, of an inlet that never ends, that are `distance` spacings or more in front of
 * the opening at a time, s. spacing: m. */
double inlet_layers_beyond(const struct scene_inlet *inlet, double time, double spacing,
                           double distance);

/* Number of layers that have appeared until a time, s. */
double inlet_layers(const struct scene_inlet *inlet, double time, double spacing);

/* The place x, m, of particle k of a layer at a time, s, where the layer is `distance`, m, in front
 * of the opening. */
void inlet_place(const struct scene_inlet *inlet, int k, double distance, double time, double x[3]);

/* Moves a point x, m, of a layer from a time to another, s. */
void inlet_carry(const struct scene_inlet *inlet, double from, double to, double x[3]);

/* Velocity v, m/s, of the point x, m, of a layer at a time, s. */
void inlet_velocity(const struct scene_inlet *inlet, double time, const double x[3], double v[3]);

/* Unit vector of the flow at a time, s. */
void inlet_direction(const struct scene_inlet *inlet, double time, double direction[3]);

#endif
