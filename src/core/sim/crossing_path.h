/* The first surface that the straight path of a particle in a step passes.
 *
 *     begin          end            The particle passes a triangle where its distance to the
 *       o             |             triangle's plane changes its sign, at a point inside the
 *     --+-----> ------+---          triangle. Both move in straight lines, so the distance is a
 *                     o             cubic of time and may change its sign up to three times. */
#ifndef PDYN_CROSSING_PATH_H
#define PDYN_CROSSING_PATH_H

#include "swept_surfaces.h"

struct crossing_path {
    const struct swept_surfaces *swept;
    const double *begin, *end; /* m: the particle at the two ends of the step */
    double radius, slack;      /* of the particle, m; how far it leaves a surface that it passes */
    int first_surface;         /* surfaces before this one do not count */
    int surface, direction;    /* the first one passed; sum of the directions, +1 along the normal;
                                  direction 0: none */
    const struct swept_triangles *set; /* those of the test */
};

/* Tests the path against a set of triangles of path->swept. */
void crossing_path_test(struct crossing_path *path, const struct swept_triangles *set);

#endif
