/* Solids that move as their scene says: their boundary points are kept as placed, seen from the
 * pivot, and carried to where they are at a time. */
#ifndef PDYN_KINEMATIC_SOLIDS_H
#define PDYN_KINEMATIC_SOLIDS_H

#include "geometry/point_list.h"
#include "scene/scene.h"

struct pdyn_sim;

struct moving { /* one solid */
    const struct scene_solid *solid;
    int first, count;      /* its boundary points */
    double min[3], max[3]; /* m, their box, from the pivot */
};

struct kinematic_solids { /* empty in a scene whose solids rest */
    int solids, capacity;
    struct moving *solid;     /* capacity */
    int points;               /* of all of them: the last ones of the boundary */
    struct point_list placed; /* these as placed, from their pivots */
};

/* Takes the boundary points from `first` on, of a solid that moves. */
pdyn_status kinematic_add(struct pdyn_sim *sim, const struct scene_solid *solid, int first);
void kinematic_free(pdyn_context *context, struct kinematic_solids *motion);

/* Carries the boundary points to where they are at a time, s. */
void kinematic_carry(struct pdyn_sim *sim, double time);

/* The largest speed of a point on the way from one time to another, s: m/s, up to some more than
 * that, as corners of a box stand for the points. */
double kinematic_speed(const struct kinematic_solids *motion, double from, double to);

#endif
