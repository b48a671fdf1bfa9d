/* The row of a wet side, for the constraints slip and seepage: u = mean position of the fluid on
 * that side, less that of the sample. Its anchor is u when the step begins. */
#ifndef PDYN_WET_SIDE_H
#define PDYN_WET_SIDE_H

#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { WET_SIDE_WIDTH = sizeof((pdyn_wet_side){0}.particle) / sizeof(int) };

struct wet_side_anchor {
    double u[3]; /* m: at the beginning of the step */
};

/* An element for every wet side, in the same order. */
static inline int wet_side_update(const void *par, const pdyn_batch *b, const double *x,
                                  const double *v, int room) {
    (void)par, (void)x, (void)v, (void)room;
    return b->wet_sides->count;
}

static inline void wet_side_select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const pdyn_wet_side *side = &b->wet_sides->side[e];
        memcpy(b->column + WET_SIDE_WIDTH * e, side->particle, sizeof side->particle);
        memcpy(b->coefficient + WET_SIDE_WIDTH * e, side->coefficient, sizeof side->coefficient);
    }
}

static inline void wet_side_begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    memcpy((struct wet_side_anchor *)b->data + first, b->u + 3 * (size_t)first,
           (size_t)(last - first) * sizeof(struct wet_side_anchor));
}

static inline const double *wet_side_anchor(const pdyn_batch *b, int e) {
    return ((const struct wet_side_anchor *)b->data)[e].u;
}

/* p = from + part times the way of u across the surface, from its anchor */
static inline void wet_side_project(const pdyn_batch *b, int e, const double *from, double part) {
    const double *n = b->wet_sides->side[e].normal;
    double moved[3], *p = b->p + 3 * (size_t)e;
    vec3_subtract(moved, b->u + 3 * (size_t)e, wet_side_anchor(b, e));
    memcpy(p, from, sizeof moved);
    vec3_add(p, part * vec3_dot(moved, n), n);
}

#endif
