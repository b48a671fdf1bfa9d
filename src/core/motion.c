#include "motion.h"

#include "placed.h"
#include "sim.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- points ---------------------------------------------------------------------------------- */

static pdyn_status make_room(struct pdyn_sim *sim) {
    struct motion *motion = &sim->motion;
    if (motion->solid) return PDYN_OK;
    motion->solid = NEW_ARRAY(sim->context, sim->scene.solids, struct moving);
    if (!motion->solid) return PDYN_NO_MEMORY;
    motion->capacity = sim->scene.solids;
    return PDYN_OK;
}

pdyn_status motion_add(struct pdyn_sim *sim, const struct scene_solid *solid, int first) {
    struct motion *motion = &sim->motion;
    struct moving m = {solid, first, sim->boundary.at.count - first, {0}, {0}};
    pdyn_status status = make_room(sim);
    for (int i = first; i < sim->boundary.at.count && status == PDYN_OK; i++) {
        double *x = sim->boundary.at.x + 3 * (size_t)i, from_pivot[3];
        for (int a = 0; a < 3; a++) {
            from_pivot[a] = x[a] - solid->pivot[a];
            m.min[a] = i == first ? from_pivot[a] : fmin(m.min[a], from_pivot[a]);
            m.max[a] = i == first ? from_pivot[a] : fmax(m.max[a], from_pivot[a]);
        }
        status = points_add(sim->context, &motion->placed, from_pivot);
    }
    if (status != PDYN_OK) return status;
    motion->solid[motion->solids++] = m;
    motion->points = motion->placed.count;
    return PDYN_OK;
}

void motion_free(pdyn_context *context, struct motion *motion) {
    FREE_ARRAY(context, motion->solid, motion->capacity);
    points_free(context, &motion->placed);
}

/* ---- keys ------------------------------------------------------------------------------------ */

struct pose {
    struct transform at;            /* from the pivot; its scale is 1 */
    double velocity[3], turning[3]; /* m/s; rad/s about x, y and z, as the angles change */
};

/* On the way from key k to the one after it; the first and the last key hold. */
static struct pose pose_between(const struct scene_solid *solid, int k, double time) {
    const struct scene_key *a = &solid->key[k < 0 ? 0 : k];
    const struct scene_key *b = &solid->key[k + 1 < solid->keys ? k + 1 : k];
    double span = b->time - a->time, part = span > 0.0 ? (time - a->time) / span : 0.0;
    double rate = span > 0.0 ? 1.0 / span : 0.0;
    struct pose pose = {.at.scale = {1.0, 1.0, 1.0}};
    for (int c = 0; c < 3; c++) {
        double way = b->translate[c] - a->translate[c], turn = b->rotate[c] - a->rotate[c];
        pose.at.translate[c] = solid->pivot[c] + a->translate[c] + part * way;
        pose.at.rotate[c] = a->rotate[c] + part * turn;
        pose.velocity[c] = rate * way;
        pose.turning[c] = rate * turn * (acos(-1.0) / 180.0);
    }
    return pose;
}

/* The last key at or before a time; -1: there is none. */
static int key_before(const struct scene_solid *solid, double time) {
    int k = -1;
    while (k + 1 < solid->keys && solid->key[k + 1].time <= time) k++;
    return k;
}

/* ---- carrying -------------------------------------------------------------------------------- */

/* Columns of the rotation: where the axes go. */
static void turned_axes(const struct transform *t, double axes[9]) {
    memset(axes, 0, 9 * sizeof *axes);
    axes[0] = axes[4] = axes[8] = 1.0;
    transform_directions(t, axes, 3);
}

void motion_place(const struct scene_solid *solid, const double *placed, int count, double time,
                  double *x) {
    struct pose pose = pose_between(solid, key_before(solid, time), time);
    double axes[9];
    turned_axes(&pose.at, axes);
    for (int i = 0; i < count; i++, x += 3, placed += 3) {
        memcpy(x, pose.at.translate, sizeof pose.at.translate);
        for (int a = 0; a < 3; a++) vec3_add(x, placed[a], axes + 3 * a);
    }
}

void motion_carry(struct pdyn_sim *sim, double time) {
    const struct motion *motion = &sim->motion;
    int resting = sim->boundary.at.count - motion->points;
    if (!motion->points) return;
    for (int k = 0; k < motion->solids; k++) {
        const struct moving *m = &motion->solid[k];
        motion_place(m->solid, motion->placed.x + 3 * (size_t)(m->first - resting), m->count, time,
                     sim->boundary.at.x + 3 * (size_t)m->first);
    }
    if (sim->neighbours) neighbours_move(sim->neighbours, sim->boundary.at.x + 3 * (size_t)resting);
}

/* ---- speed ----------------------------------------------------------------------------------- */

/* The axis about which all turns at the moment, times the rate, rad/s: a rotation that comes later
 * turns the axis of an earlier one. */
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

/* Of the corners of the solid's box, which the speed of no point exceeds. */
static double fastest_corner(const struct moving *m, const struct pose *pose) {
    double axis[3], speed = 0.0;
    turning_axis(pose, axis);
    for (int corner = 0; corner < 8; corner++) {
        double r[3], v[3];
        for (int a = 0; a < 3; a++) r[a] = corner >> a & 1 ? m->max[a] : m->min[a];
        transform_directions(&pose->at, r, 1);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            v[a] = pose->velocity[a] + axis[b] * r[c] - axis[c] * r[b];
        }
        speed = fmax(speed, vec3_length(v));
    }
    return speed;
}

/* At both ends of each part of the way between two keys. */
static double fastest(const struct moving *m, double from, double to) {
    const struct scene_solid *solid = m->solid;
    double speed = 0.0;
    for (int k = key_before(solid, from); k < solid->keys; k++) {
        double begin = k < 0 ? from : fmax(from, solid->key[k].time);
        double end = k + 1 < solid->keys ? fmin(to, solid->key[k + 1].time) : to;
        if (begin >= to) break;
        struct pose first = pose_between(solid, k, begin), last = pose_between(solid, k, end);
        speed = fmax(speed, fmax(fastest_corner(m, &first), fastest_corner(m, &last)));
    }
    return speed;
}

double motion_speed(const struct motion *motion, double from, double to) {
    double speed = 0.0;
    for (int k = 0; k < motion->solids; k++)
        speed = fmax(speed, fastest(&motion->solid[k], from, to));
    return speed;
}
