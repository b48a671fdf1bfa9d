/* A bounding volume hierarchy of axis-aligned boxes with four children per node: which boxes of a
 * set overlap a given one? The boxes are sorted along a space-filling curve (Morton order;
 * Lauterbach et al. 2009). Every four neighbours form a group with a bounding box, every four
 * groups form a group of the next level, up to a single group. The four boxes of a group are tested
 * at once (simd.h). */
#ifndef PDYN_BVH_H
#define PDYN_BVH_H

#include "base/context.h"
#include "projdyn/box.h"
#include "projdyn/simd.h"

#include <string.h>

enum { BVH_WIDTH = 4, BVH_LEVELS = 16 };

struct box_group { /* four boxes side by side; unused lanes hold the empty box */
    double min[3][BVH_WIDTH], max[3][BVH_WIDTH];
    int owner[BVH_WIDTH];    /* of all boxes within; -1 where they have several or none */
    bool changed[BVH_WIDTH]; /* some box within, in the last build or refit */
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

/* Builds the hierarchy of `count` <= capacity boxes. Nothing overlaps an empty box. */
void bvh_build(struct bvh *tree, const struct box *box, int count);

/* Updates the hierarchy where changed[i] says that box[i] is another one. The order of the boxes
 * stays: searches find the same as after a build, and take longer the farther boxes have moved. */
void bvh_refit(struct bvh *tree, const struct box *box, const bool *changed);

/* Calls visit(user, id) for each box that overlaps or touches `box`. `visit` may shrink `box`; the
 * rest of the search then uses the smaller one. */
void bvh_visit(const struct bvh *tree, const struct box *box, void (*visit)(void *user, int id),
               void *user);

/* As bvh_visit, without the boxes of `owner`: subtrees in which it owns all boxes are left out at
 * once. */
void bvh_visit_others(const struct bvh *tree, const struct box *box, int owner,
                      void (*visit)(void *user, int id), void *user);

typedef int64_t lanes4 __attribute__((vector_size(32)));

/* Sets lanes[k] to a value other than 0 if box k of the group overlaps `box`. */
INLINE void box_group_test(const struct box_group *group, const struct box *box,
                           int64_t lanes[BVH_WIDTH]) {
    v4 min, max;
    lanes4 good = {-1, -1, -1, -1};
    for (int a = 0; a < 3; a++) {
        v4 low = {box->min[a], box->min[a], box->min[a], box->min[a]};
        v4 high = {box->max[a], box->max[a], box->max[a], box->max[a]};
        memcpy(&min, group->min[a], sizeof min);
        memcpy(&max, group->max[a], sizeof max);
        good &= (min <= high) & (low <= max);
    }
    memcpy(lanes, &good, sizeof good);
}

static inline bool box_is_empty(const struct box *box) { return box->min[0] > box->max[0]; }

static inline bool box_overlaps(const struct box *a, const struct box *b) {
    return (a->min[0] <= b->max[0]) & (b->min[0] <= a->max[0]) & (a->min[1] <= b->max[1]) &
           (b->min[1] <= a->max[1]) & (a->min[2] <= b->max[2]) & (b->min[2] <= a->max[2]);
}

#endif
