#include "inlet_motion.h"

#include "poses.h"

#include "projdyn/path.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* ---- the flow -------------------------------------------------------------------------------- */

double inlet_speed(const struct scene_inlet *inlet, double time) {
    double speed[3];
    path_at(&inlet->speed, time, speed);
    return speed[0];
}

/* The integral of the speed between two times, m. */
static double way(const struct scene_inlet *inlet, double from, double to) {
    double sum = 0.0;
    const double *key = inlet->speed.key;
    if (to < from) return -way(inlet, to, from);
    for (int k = -1; k < inlet->speed.count; k++) {
        double begin = k < 0 ? from : fmax(from, key[4 * k]);
        double end = k + 1 < inlet->speed.count ? fmin(to, key[4 * k + 4]) : to;
        if (end > begin)
            sum += 0.5 * (inlet_speed(inlet, begin) + inlet_speed(inlet, end)) * (end - begin);
    }
    return sum;
}

static double top_flow(const struct scene_inlet *inlet, double from, double to) {
    double top = fmax(inlet_speed(inlet, from), inlet_speed(inlet, to));
    for (int k = 0; k < inlet->speed.count; k++) {
        const double *key = inlet->speed.key + 4 * k;
        if (key[0] > from && key[0] < to) top = fmax(top, key[1]);
    }
    return top;
}

/* Times that differ by rounding alone are equal. */
static bool has_started(const struct scene_inlet *inlet, double time) {
    return time >= inlet->start * (1.0 - 1e-12);
}

double inlet_travelled(const struct scene_inlet *inlet, double time) {
    if (!has_started(inlet, time)) return -INFINITY;
    return inlet->travelled + way(inlet, inlet->start, time);
}

double inlet_layers_beyond(const struct scene_inlet *inlet, double time, double spacing,
                           double distance) {
    double travelled = inlet_travelled(inlet, time) / spacing + 1e-9;
    return travelled < 0.0 ? 0.0 : floor(fmax(-1.0, travelled - distance)) + 1.0;
}

double inlet_layers(const struct scene_inlet *inlet, double time, double spacing) {
    double layers = inlet_layers_beyond(inlet, time, spacing, -INLET_BEHIND);
    if (isinf(inlet->end)) return layers;
    return fmin(layers, ceil(inlet_travelled(inlet, inlet->end) / spacing - 1e-9));
}

/* ---- the pose -------------------------------------------------------------------------------- */

/* Moves a point from its place in the inlet at rest to that at a time. */
static void move(const struct scene_inlet *inlet, double time, double x[3]) {
    if (inlet->motion.keys) pose_place(&inlet->motion, x, 1, time, x);
}

void inlet_place(const struct scene_inlet *inlet, int k, double distance, double time,
                 double x[3]) {
    memcpy(x, inlet->layer.x + 3 * (size_t)k, 3 * sizeof *x);
    vec3_add(x, distance, inlet->direction);
    move(inlet, time, x);
}

void inlet_carry(const struct scene_inlet *inlet, double from, double to, double x[3]) {
    double rest[3];
    pose_to_rest(&inlet->motion, from, x, rest);
    vec3_add(rest, way(inlet, from, to), inlet->direction);
    move(inlet, to, rest);
    memcpy(x, rest, sizeof rest);
}

void inlet_direction(const struct scene_inlet *inlet, double time, double direction[3]) {
    memcpy(direction, inlet->direction, sizeof inlet->direction);
    if (!inlet->motion.keys) return;
    struct pose pose = pose_at(&inlet->motion, time);
    transform_directions(&pose.at, direction, 1);
}

void inlet_velocity(const struct scene_inlet *inlet, double time, const double x[3], double v[3]) {
    double direction[3], arm[3], speed = inlet_speed(inlet, time);
    inlet_direction(inlet, time, direction);
    memset(v, 0, 3 * sizeof *v);
    if (inlet->motion.keys) {
        struct pose pose = pose_at(&inlet->motion, time);
        vec3_subtract(arm, x, pose.at.translate);
        pose_velocity(&pose, arm, v);
    }
    vec3_add(v, speed, direction);
}

double inlet_top_speed(const struct scene_inlet *inlet, double from, double to) {
    double top = top_flow(inlet, from, to);
    if (!inlet->motion.keys) return top;
    struct box box = box_around(inlet->layer.x, inlet->layer.count);
    return top + pose_top_speed(&inlet->motion, &box, from, to);
}
