/* All pairs of overlapping boxes of two hierarchies, or of one with itself, where one box or both
 * have changed (bvh_refit). Both hierarchies are descended at once (dual-tree traversal), so that
 * parts far from each other, or without change, are left out as a whole. Boxes of one owner are no
 * pair. */
#ifndef PDYN_BVH_JOIN_H
#define PDYN_BVH_JOIN_H

#include "bvh.h"

struct bvh_join {
    const struct bvh *tree[2]; /* the same one twice: each pair of its boxes once */
};

struct group_pair { /* a part of a join: a group of each hierarchy */
    int level[2], group[2];
};

enum { BVH_PARTS = 512 };

/* Divides a join into at most BVH_PARTS parts, which may be done in any order; returns their
 * number. */
int bvh_join_divide(const struct bvh_join *join, struct group_pair part[BVH_PARTS]);

/* Calls visit(user, a, b) for each pair of a part until it returns false; a: index of a box of
 * tree[0], b: of tree[1]. */
void bvh_join_visit(const struct bvh_join *join, struct group_pair part,
                    bool (*visit)(void *user, int a, int b), void *user);

#endif
