/* The pose of a moving solid or inlet at a time, interpolated between the keys of its motion. */
#ifndef PDYN_POSES_H
#define PDYN_POSES_H

#include "scene.h"
#include "transform.h"

struct pose {
    struct transform at;            /* of coordinates at rest relative to the pivot; scale 1 */
    double velocity[3], turning[3]; /* m/s; rad/s: rates of the angles about x, y and z */
};

/* The pose at `time`, s: linear between keys, constant before the first and after the last one. */
struct pose pose_at(const struct scene_motion *motion, double time);

/* Computes the positions x, count x 3, m, at `time`, s, of points that lie at `rest`, m, without
 * the motion. x may be `rest`. */
void pose_place(const struct scene_motion *motion, const double *rest, int count, double time,
                double *x);

/* Computes where the point that is at x, m, at `time`, s, lies at rest. */
void pose_to_rest(const struct scene_motion *motion, double time, const double x[3],
                  double rest[3]);

/* Velocity v, m/s, of a point; arm: from the pivot to it, m. */
void pose_velocity(const struct pose *pose, const double arm[3], double v[3]);

/* Upper bound of the speed of a point between two times, s: m/s. It is the speed of the corners of
 * a bounding box at rest, m, and slightly too large. */
double pose_top_speed(const struct scene_motion *motion, const struct box *box, double from,
                      double to);

/* That of a solid's mesh from time 0 to `end`, s; 0: it rests. */
double pose_top_speed_of_mesh(const struct scene_solid *solid, double end);

#endif
