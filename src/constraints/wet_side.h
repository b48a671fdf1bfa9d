/* The row of a wet side, for the constraints slip and seepage: u = mean position of the fluid on
 * that side, less that of the sample. Its anchor is u when the step begins. */
#ifndef PDYN_WET_SIDE_H
#define PDYN_WET_SIDE_H

#include "projdyn/module.h"

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

/* Sets `along` and `across` to the parts of u less its anchor along and across the surface. */
static inline void wet_side_move(const pdyn_batch *b, int e, double along[3], double across[3]) {
    const double *anchor = ((const struct wet_side_anchor *)b->data)[e].u;
    const double *n = b->wet_sides->side[e].normal;
    double part = 0.0;
    for (int a = 0; a < 3; a++) part += (b->u[3 * e + a] - anchor[a]) * n[a];
    for (int a = 0; a < 3; a++) {
        across[a] = part * n[a];
        along[a] = b->u[3 * e + a] - anchor[a] - across[a];
    }
}

#endif
