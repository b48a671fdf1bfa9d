/* Which triangles intersect, by a slow method that shares nothing with the library's: separating
 * axes for every side of a triangle and every other triangle whose boxes overlap. What cannot be
 * proven apart counts as intersecting. */
#ifndef INTERSECT_H
#define INTERSECT_H

#include "step/sim.h"

struct soup {
    int points, triangles, free; /* free: triangles of surfaces; the others are not compared */
    double *x;                   /* points x 3 */
    int *triangle;               /* triangles x 3 */
};

/* All surfaces and solids of a simulation, where they are now. */
struct soup soup_of(const pdyn_sim *sim);
void soup_free(struct soup *soup);

/* Pairs of triangles that intersect, at least one of them of a surface; the first one to *a, *b. */
int soup_intersections(const struct soup *soup, int *a, int *b);

#endif
