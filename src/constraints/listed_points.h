/* Points of the neighbour lists (pdyn_neighbours), for constraints on particles. */
#ifndef PDYN_LISTED_POINTS_H
#define PDYN_LISTED_POINTS_H

#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

/* Whether particle i of the system belongs to the body. */
static inline bool body_has(const pdyn_body *body, int i) {
    return i >= body->first && i < body->first + body->count;
}

/* Whether entry k of the list of particle i, a point of a surface, has an area and the surface
 * kernel; otherwise it has a volume and the kernel of particles. */
static inline bool listed_has_area(const pdyn_neighbours *l, int i, int k) {
    return k < l->boundary_start[i] ? !l->has_volumes : k >= l->patch_start[i];
}

/* The first of a sample's corners in sample_vertex and sample_weight. */
static inline int sample_corner(const pdyn_neighbours *l, int sample) {
    return 3 * (sample - (l->particles - l->samples));
}

/* The position of a sample, from positions x of the particles, or of a boundary point, m. */
static inline void listed_position(const pdyn_neighbours *l, const double *x, int point,
                                   double at[3]) {
    int corner = sample_corner(l, point);
    memset(at, 0, 3 * sizeof *at);
    if (point >= l->particles)
        memcpy(at, l->boundary_x + 3 * (size_t)(point - l->particles), 3 * sizeof *at);
    else
        for (int k = corner; k < corner + 3; k++)
            vec3_add(at, l->sample_weight[k], x + 3 * (size_t)l->sample_vertex[k]);
}

#endif
