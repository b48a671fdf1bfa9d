/* Where a solid that moves as its scene says is at a time: between the keys of its motion. */
#ifndef PDYN_POSES_H
#define PDYN_POSES_H

#include "scene.h"
#include "transform.h"

struct pose {
    struct transform at;            /* from the pivot; its scale is 1 */
    double velocity[3], turning[3]; /* m/s; rad/s about x, y and z, as the angles change */
};

/* On the way from key k to the one after it, at a time in s; the first and the last key hold. */
struct pose pose_between(const struct scene_solid *solid, int k, double time);

/* The last key at or before a time, s; -1: there is none. */
int pose_key_before(const struct scene_solid *solid, double time);

/* Where points of a solid that moves, placed as seen from its pivot, are at a time, s: count x 3.
 */
void pose_place(const struct scene_solid *solid, const double *placed, int count, double time,
                double *x);

/* The axis about which all turns at the moment, times the rate, rad/s: a rotation that comes later
 * turns the axis of an earlier one. */
void pose_turning_axis(const struct pose *pose, double axis[3]);

#endif
