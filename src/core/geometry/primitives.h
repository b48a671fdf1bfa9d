/* Simple shapes given by a few numbers in a scene: boxes and spheres. */
#ifndef PDYN_PRIMITIVES_H
#define PDYN_PRIMITIVES_H

#include <stdbool.h>

struct scene_box {
    double min[3], max[3]; /* m; min < max along every axis */
};

static inline bool scene_box_contains(const struct scene_box *box, const double x[3]) {
    bool inside = true;
    for (int a = 0; a < 3; a++) inside &= x[a] >= box->min[a] && x[a] <= box->max[a];
    return inside;
}

struct scene_sphere {
    double center[3], radius; /* m */
};

#endif
