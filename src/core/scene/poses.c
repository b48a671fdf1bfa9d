/* Poses: interpolation of keys, positions, velocities. */
#include "poses.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* The pose between key k and key k + 1; constant before the first and after the last key. */
static struct pose pose_between(const struct scene_motion *motion, int k, double time) {
    const struct scene_key *a = &motion->key[k < 0 ? 0 : k];
    const struct scene_key *b = &motion->key[k + 1 < motion->keys ? k + 1 : k];
    double span = b->time - a->time, part = span > 0.0 ? (time - a->time) / span : 0.0;
    double rate = span > 0.0 ? 1.0 / span : 0.0;
    struct pose pose = {.at.scale = {1.0, 1.0, 1.0}};
    for (int c = 0; c < 3; c++) {
        double way = b->translate[c] - a->translate[c], turn = b->rotate[c] - a->rotate[c];
        pose.at.translate[c] = motion->pivot[c] + a->translate[c] + part * way;
        pose.at.rotate[c] = a->rotate[c] + part * turn;
        pose.velocity[c] = rate * way;
        pose.turning[c] = rate * turn * (acos(-1.0) / 180.0);
    }
    return pose;
}

/* Index of the last key at or before `time`, s; -1: none. */
static int key_before(const struct scene_motion *motion, double time) {
    int k = -1;
    while (k + 1 < motion->keys && motion->key[k + 1].time <= time) k++;
    return k;
}

struct pose pose_at(const struct scene_motion *motion, double time) {
    return pose_between(motion, key_before(motion, time), time);
}

/* Columns of the rotation matrix. */
static void rotated_axes(const struct transform *t, double axes[9]) {
    memset(axes, 0, 9 * sizeof *axes);
    axes[0] = axes[4] = axes[8] = 1.0;
    transform_directions(t, axes, 3);
}

void pose_place(const struct scene_motion *motion, const double *rest, int count, double time,
                double *x) {
    struct pose pose = pose_at(motion, time);
    double axes[9], arm[3];
    rotated_axes(&pose.at, axes);
    for (int i = 0; i < count; i++, x += 3, rest += 3) {
        vec3_subtract(arm, rest, motion->pivot);
        memcpy(x, pose.at.translate, sizeof pose.at.translate);
        for (int a = 0; a < 3; a++) vec3_add(x, arm[a], axes + 3 * a);
    }
}

void pose_to_rest(const struct scene_motion *motion, double time, const double x[3],
                  double rest[3]) {
    memcpy(rest, x, 3 * sizeof *rest);
    if (!motion->keys) return;
    struct pose pose = pose_at(motion, time);
    double axes[9], from_pivot[3];
    rotated_axes(&pose.at, axes);
    vec3_subtract(from_pivot, x, pose.at.translate);
    for (int a = 0; a < 3; a++) rest[a] = motion->pivot[a] + vec3_dot(axes + 3 * a, from_pivot);
}

/* Angular velocity, rad/s, from the rates of the three angles: a later rotation turns the axis of
 * an earlier one. */
static void turning_axis(const struct pose *pose, double axis[3]) {
    const double *angle = pose->at.rotate, *rate = pose->turning;
    struct transform y_z = {.rotate = {0.0, angle[1], angle[2]}},
                     z = {.rotate = {0.0, 0.0, angle[2]}};
    double about_x[3] = {rate[0], 0.0, 0.0}, about_y[3] = {0.0, rate[1], 0.0};
    transform_directions(&y_z, about_x, 1);
    transform_directions(&z, about_y, 1);
    for (int a = 0; a < 3; a++) axis[a] = about_x[a] + about_y[a];
    axis[2] += rate[2];
}

void pose_velocity(const struct pose *pose, const double arm[3], double v[3]) {
    double axis[3], turning[3];
    turning_axis(pose, axis);
    vec3_cross(turning, axis, arm);
    for (int a = 0; a < 3; a++) v[a] = pose->velocity[a] + turning[a];
}

/* Largest speed of the corners of a box; no point in it is faster. */
static double max_corner_speed(const struct scene_motion *motion, const struct box *box,
                               const struct pose *pose) {
    double speed = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        double arm[3], v[3];
        for (int a = 0; a < 3; a++)
            arm[a] = (corner >> a & 1 ? box->max[a] : box->min[a]) - motion->pivot[a];
        transform_directions(&pose->at, arm, 1);
        pose_velocity(pose, arm, v);
        speed = fmax(speed, vec3_length(v));
    }
    return speed;
}

/* Evaluated at both ends of every interval between keys. */
double pose_top_speed(const struct scene_motion *motion, const struct box *box, double from,
                      double to) {
    double speed = 0.0;
    for (int k = key_before(motion, from); k < motion->keys; k++) {
        double begin = k < 0 ? from : fmax(from, motion->key[k].time);
        double end = k + 1 < motion->keys ? fmin(to, motion->key[k + 1].time) : to;
        if (begin >= to) break;
        struct pose first = pose_between(motion, k, begin), last = pose_between(motion, k, end);
        speed = fmax(speed, max_corner_speed(motion, box, &first));
        speed = fmax(speed, max_corner_speed(motion, box, &last));
    }
    return speed;
}

double pose_top_speed_of_mesh(const struct scene_solid *solid, double end) {
    if (!solid->motion.keys) return 0.0;
    const struct box box = box_around(solid->mesh.vertex, solid->mesh.vertices);
    return pose_top_speed(&solid->motion, &box, 0.0, end);
}
