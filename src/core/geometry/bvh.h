/* A bounding volume hierarchy of axis-aligned boxes with four children per node: which boxes of a
 * set overlap a given one? The boxes are sorted along a space-filling curve (Morton order;
 * Lauterbach et al. 2009). Every four neighbours form a group with a bounding box, every four
 * groups form a group of the next level, up to a single group. The four boxes of a group are tested
 * at once (simd.h). */
#ifndef PDYN_BVH_H
#define PDYN_BVH_H

#include "base/context.h"
#include "projdyn/box.h"

enum { BVH_WIDTH = 4, BVH_LEVELS = 16 };

struct box_group { /* four boxes side by side; unused lanes hold the empty box */
    double min[3][BVH_WIDTH], max[3][BVH_WIDTH];
    int owner[BVH_WIDTH]; /* of all boxes within; -1 where they have several or none */
};

struct bvh {
    int count, capacity; /* of boxes in the hierarchy */
    int *order;          /* capacity: indices of the boxes in Morton order */
    int levels;
    int first[BVH_LEVELS + 1]; /* first group of each level; level 0 holds the boxes themselves */
    struct box_group *group;
    uint32_t *key;    /* capacity: Morton codes of the boxes, 30 bits */
    int *swapped;     /* capacity: scratch of the sort */
    const int *owner; /* of each box, set before bvh_build: 0 or more, -1: none. NULL: all -1 */
};

/* Allocates a hierarchy of up to `capacity` boxes; free it with bvh_free. */
pdyn_status bvh_create(pdyn_context *context, int capacity, struct bvh *tree);
void bvh_free(pdyn_context *context, struct bvh *tree);

/* Builds the hierarchy of those of `count` <= capacity boxes that `chosen` says; NULL: of all. */
void bvh_build(struct bvh *tree, const struct box *box, int count, const bool *chosen);

/* Calls visit(user, id) for each box with an index of at least `from` that overlaps or touches
 * `box`. `visit` may shrink `box`; the rest of the search then uses the smaller one. */
void bvh_visit(const struct bvh *tree, const struct box *box, int from,
               void (*visit)(void *user, int id), void *user);

/* As bvh_visit, but for the boxes of one owner: subtrees that are all its own are left out at once.
 */
void bvh_visit_others(const struct bvh *tree, const struct box *box, int from, int owner,
                      void (*visit)(void *user, int id), void *user);

static inline bool box_is_empty(const struct box *box) { return box->min[0] > box->max[0]; }

static inline bool box_overlaps(const struct box *a, const struct box *b) {
    return (a->min[0] <= b->max[0]) & (b->min[0] <= a->max[0]) & (a->min[1] <= b->max[1]) &
           (b->min[1] <= a->max[1]) & (a->min[2] <= b->max[2]) & (b->min[2] <= a->max[2]);
}

#endif
