/* The pose of a moving solid at a time, interpolated between the keys of its motion. */
#ifndef PDYN_POSES_H
#define PDYN_POSES_H

#include "scene.h"
#include "transform.h"

struct pose {
    struct transform at;            /* of coordinates relative to the pivot; scale 1 */
    double velocity[3], turning[3]; /* m/s; rad/s: rates of the angles about x, y and z */
};

/* The pose between key k and key k + 1 at `time`, s; constant before the first and after the last
 * key. */
struct pose pose_between(const struct scene_solid *solid, int k, double time);

/* Index of the last key at or before `time`, s; -1: none. */
int pose_key_before(const struct scene_solid *solid, double time);

/* Computes the positions x, count x 3, m, at `time`, s, of points given relative to the pivot in
 * the initial placement. x may be `placed`. */
void pose_place(const struct scene_solid *solid, const double *placed, int count, double time,
                double *x);

/* Computes the positions x, 3 per vertex, m, of a solid's mesh at `time`, s. */
void pose_place_mesh(const struct scene_solid *solid, double time, double *x);

/* Computes where the point x of the world, m, at `time`, s, lies in the initial placement. */
void pose_to_rest(const struct scene_solid *solid, double time, const double x[3], double rest[3]);

/* Angular velocity, rad/s, from the rates of the three angles: a later rotation turns the axis of
 * an earlier one. */
void pose_turning_axis(const struct pose *pose, double axis[3]);

#endif
