/* Finds intersecting triangles by separating axes, independent of the library's contact: each side
 * of a triangle against every other triangle whose bounding box overlaps. Triangles without a
 * separating axis count as intersecting. */
#ifndef INTERSECT_H
#define INTERSECT_H

#include "sim/sim.h"

struct soup {
    int points, triangles,
        free;      /* free: triangles of surfaces; pairs of other triangles are not compared */
    double *x;     /* points x 3 */
    int *triangle; /* triangles x 3 */
};

/* All surfaces and solids of a simulation at their current positions. */
struct soup soup_of(const pdyn_sim *sim);
void soup_free(struct soup *soup);

/* Returns the number of intersecting pairs with a triangle of a surface; *a, *b: the first pair. */
int soup_intersections(const struct soup *soup, int *a, int *b);

#endif
