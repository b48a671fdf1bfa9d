/* A bounding volume hierarchy by Morton order: build and box queries. */
#include "bvh.h"

#include "projdyn/simd.h"

#include <math.h>
#include <string.h>

/* Computes for `count` boxes the number of levels and the first group of each; returns the number
 * of groups in all levels. */
static int count_groups(int count, int *levels, int *first) {
    int total = 0;
    *levels = 0;
    do {
        first[(*levels)++] = total;
        count = (count + BVH_WIDTH - 1) / BVH_WIDTH;
        total += count;
    } while (count > 1);
    first[*levels] = total;
    return total;
}

static bool resize_arrays(pdyn_context *context, struct bvh *tree, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(tree->key, tree->capacity),
        ARRAY(tree->order, tree->capacity),
        ARRAY(tree->swapped, tree->capacity),
        ARRAY(tree->group, count_groups(tree->capacity, &tree->levels, tree->first)),
    };
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

pdyn_status bvh_create(pdyn_context *context, int capacity, struct bvh *tree) {
    *tree = (struct bvh){.capacity = capacity};
    if (resize_arrays(context, tree, ARRAYS_ALLOCATE)) return PDYN_OK;
    bvh_free(context, tree);
    return PDYN_NO_MEMORY;
}

void bvh_free(pdyn_context *context, struct bvh *tree) {
    resize_arrays(context, tree, ARRAYS_FREE);
}

/* ---- sorting --------------------------------------------------------------------------------- */

/* Inserts two zero bits before each of the ten low bits of v. */
static uint32_t spread(uint32_t v) {
    v = (v | v << 16) & 0x030000FFu;
    v = (v | v << 8) & 0x0300F00Fu;
    v = (v | v << 4) & 0x030C30C3u;
    return (v | v << 2) & 0x09249249u;
}

/* Computes the Morton codes of the centres of the boxes in `order`. */
static void compute_keys(struct bvh *tree, const struct box *box) {
    struct box bounds = box_empty;
    double middle[3], scale = 0.0;
    for (int k = 0; k < tree->count; k++) {
        box_add(&bounds, box[tree->order[k]].min);
        box_add(&bounds, box[tree->order[k]].max);
    }
    for (int a = 0; a < 3; a++) scale = fmax(scale, bounds.max[a] - bounds.min[a]);
    scale = scale > 0.0 ? 1023.0 / scale : 0.0;
    for (int k = 0; k < tree->count; k++) {
        int i = tree->order[k];
        tree->key[i] = 0;
        for (int a = 0; a < 3; a++) {
            middle[a] = 0.5 * (box[i].min[a] + box[i].max[a]) - bounds.min[a];
            tree->key[i] |= spread((uint32_t)(scale * middle[a])) << a;
        }
    }
}

/* Radix sort of the Morton codes, ten bits per pass. */
static void sort_keys(struct bvh *tree, int count) {
    enum { BITS = 10, BINS = 1 << BITS };
    for (int shift = 0; shift < 30; shift += BITS) {
        int end[BINS + 1] = {0};
        for (int i = 0; i < count; i++)
            end[1 + (tree->key[tree->order[i]] >> shift & (BINS - 1))]++;
        for (int b = 0; b < BINS; b++) end[b + 1] += end[b];
        for (int i = 0; i < count; i++)
            tree->swapped[end[tree->key[tree->order[i]] >> shift & (BINS - 1)]++] = tree->order[i];
        int *sorted = tree->swapped;
        tree->swapped = tree->order, tree->order = sorted;
    }
}

static void set_lane(struct box_group *group, int lane, const struct box *box, int owner) {
    for (int a = 0; a < 3; a++)
        group->min[a][lane] = box->min[a], group->max[a][lane] = box->max[a];
    group->owner[lane] = owner;
}

/* The owner of all boxes of a group. Unused lanes repeat the owner of the first one. */
static int owner_of(const struct box_group *group) {
    bool same = true;
    for (int k = 1; k < BVH_WIDTH; k++) same &= group->owner[k] == group->owner[0];
    return same ? group->owner[0] : -1;
}

static struct box bounds_of(const struct box_group *group) {
    struct box box = box_empty;
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < BVH_WIDTH; k++) { /* fmin would be a call, for its rule of NaN */
            if (group->min[a][k] < box.min[a]) box.min[a] = group->min[a][k];
            if (group->max[a][k] > box.max[a]) box.max[a] = group->max[a][k];
        }
    return box;
}

void bvh_build(struct bvh *tree, const struct box *box, int count, const bool *chosen) {
    tree->count = 0;
    for (int i = 0; i < count; i++)
        if (!chosen || chosen[i]) tree->order[tree->count++] = i;
    count = tree->count;
    count_groups(count, &tree->levels, tree->first);
    if (!count) return;
    compute_keys(tree, box);
    sort_keys(tree, count);
    for (int level = 0, below = count; level < tree->levels; level++) {
        struct box_group *group = tree->group + tree->first[level];
        int groups = tree->first[level + 1] - tree->first[level];
        for (int k = 0; k < BVH_WIDTH * groups; k++) {
            const struct box_group *under =
                level && k < below ? tree->group + tree->first[level - 1] + k : NULL;
            struct box one = box_empty;
            int owner = group[k / BVH_WIDTH].owner[0];
            if (under) one = bounds_of(under), owner = owner_of(under);
            else if (k < below)
                one = box[tree->order[k]], owner = tree->owner ? tree->owner[tree->order[k]] : -1;
            set_lane(&group[k / BVH_WIDTH], k % BVH_WIDTH, &one, owner);
        }
        below = groups;
    }
}

/* ---- queries --------------------------------------------------------------------------------- */

typedef int64_t lanes4 __attribute__((vector_size(32)));

/* Sets lanes[k] to a value other than 0 if box k of the group overlaps `box`. */
INLINE void test_group(const struct box_group *group, const struct box *box, int64_t lanes[4]) {
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

/* Depth-first traversal with a stack of groups and their levels. */
WIDE static void visit_groups(const struct bvh *tree, const struct box *box, int from, int except,
                              void (*visit)(void *user, int id), void *user) {
    struct {
        int level, group;
    } stack[BVH_LEVELS * BVH_WIDTH] = {{tree->levels - 1, 0}};
    for (int waiting = 1; waiting;) {
        int level = stack[--waiting].level, group = stack[waiting].group;
        int64_t lanes[BVH_WIDTH];
        const struct box_group *four = &tree->group[tree->first[level] + group];
        test_group(four, box, lanes);
        for (int k = 0, child = BVH_WIDTH * group; k < BVH_WIDTH; k++, child++) {
            if (!lanes[k] || four->owner[k] == except) continue;
            if (level) stack[waiting].level = level - 1, stack[waiting++].group = child;
            else if (tree->order[child] >= from) visit(user, tree->order[child]);
        }
    }
}

void bvh_visit(const struct bvh *tree, const struct box *box, int from,
               void (*visit)(void *user, int id), void *user) {
    bvh_visit_others(tree, box, from, -1, visit, user);
}

void bvh_visit_others(const struct bvh *tree, const struct box *box, int from, int owner,
                      void (*visit)(void *user, int id), void *user) {
    if (tree->count) visit_groups(tree, box, from, owner < 0 ? INT32_MIN : owner, visit, user);
}
