/* A tree of boxes: which boxes of a set overlap a given one. The boxes are sorted along a curve
 * that fills space (Morton order; Lauterbach et al. 2009); four neighbours make a group, which has
 * a box around it, four of these groups make one again, up to a single one. A group is tested at
 * once. */
#ifndef PDYN_BVH_H
#define PDYN_BVH_H

#include "base/context.h"

struct box {
    double min[3], max[3];
};

enum { BOXES_WIDTH = 4, BOXES_LEVELS = 16 };

struct box_group { /* lanes without a box hold none */
    double min[3][BOXES_WIDTH], max[3][BOXES_WIDTH];
};

struct bvh {
    int count, capacity;
    int *order;                          /* capacity: the boxes along the curve */
    int levels, first[BOXES_LEVELS + 1]; /* where the groups of a level begin; level 0: of boxes */
    struct box_group *group;
    uint32_t *key; /* capacity: along the curve */
    int *swapped;  /* capacity: scratch of the sort */
};

pdyn_status bvh_create(pdyn_context *context, int capacity, struct bvh *boxes);
void bvh_free(pdyn_context *context, struct bvh *boxes);

void bvh_sort(struct bvh *boxes, const struct box *box, int count);

/* Calls visit for each box that overlaps or touches `box` and is numbered `from` or higher. It may
 * make `box` smaller, which then holds for what has not been visited. */
void bvh_visit(const struct bvh *boxes, const struct box *box, int from,
               void (*visit)(void *user, int id), void *user);

static inline bool box_overlaps(const struct box *a, const struct box *b) {
    return (a->min[0] <= b->max[0]) & (b->min[0] <= a->max[0]) & (a->min[1] <= b->max[1]) &
           (b->min[1] <= a->max[1]) & (a->min[2] <= b->max[2]) & (b->min[2] <= a->max[2]);
}

/* Makes the box hold a point. A box that holds none has min > max. */
void box_add(struct box *box, const double x[3]);
extern const struct box box_empty;

#endif
