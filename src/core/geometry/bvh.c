/* A bounding volume hierarchy by Morton order: build and box queries. */
#include "bvh.h"

#include <math.h>

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

/* Computes the Morton codes of the centres of the boxes; 0 of an empty one. */
static void compute_keys(struct bvh *tree, const struct box *box) {
    struct box bounds = box_empty;
    double middle[3], scale = 0.0;
    for (int i = 0; i < tree->count; i++) {
        if (box_is_empty(&box[i])) continue;
        box_add(&bounds, box[i].min);
        box_add(&bounds, box[i].max);
    }
    for (int a = 0; a < 3; a++) scale = fmax(scale, bounds.max[a] - bounds.min[a]);
    scale = scale > 0.0 ? 1023.0 / scale : 0.0;
    for (int i = 0; i < tree->count; i++) {
        tree->key[i] = 0;
        if (box_is_empty(&box[i])) continue;
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

static bool has_changed(const struct box_group *group) {
    bool changed = false;
    for (int k = 0; k < BVH_WIDTH; k++) changed |= group->changed[k];
    return changed;
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

/* Sets the lanes of all levels whose boxes have changed; changed: NULL for all boxes. */
static void fit(struct bvh *tree, const struct box *box, const bool *changed) {
    for (int level = 0, used = tree->count; level < tree->levels; level++) {
        struct box_group *groups = tree->group + tree->first[level];
        int count = tree->first[level + 1] - tree->first[level];
        for (int k = 0; k < BVH_WIDTH * count; k++) {
            struct box_group *group = &groups[k / BVH_WIDTH];
            int lane = k % BVH_WIDTH, i = !level && k < used ? tree->order[k] : -1;
            const struct box_group *under =
                level && k < used ? tree->group + tree->first[level - 1] + k : NULL;
            struct box one = box_empty;
            int owner = group->owner[0];
            bool has = under ? has_changed(under) : i >= 0 && (!changed || changed[i]);
            group->changed[lane] = has;
            if (!has && k < used) continue;
            if (under) one = bounds_of(under), owner = owner_of(under);
            else if (i >= 0) one = box[i], owner = tree->owner ? tree->owner[i] : -1;
            set_lane(group, lane, &one, owner);
        }
        used = count;
    }
}

void bvh_refit(struct bvh *tree, const struct box *box, const bool *changed) {
    if (tree->count) fit(tree, box, changed);
}

void bvh_build(struct bvh *tree, const struct box *box, int count) {
    tree->count = count;
    count_groups(count, &tree->levels, tree->first);
    if (!count) return;
    for (int i = 0; i < count; i++) tree->order[i] = i;
    compute_keys(tree, box);
    sort_keys(tree, count);
    fit(tree, box, NULL);
}

/* ---- queries --------------------------------------------------------------------------------- */

/* Depth-first traversal with a stack of groups and their levels. */
WIDE static void visit_groups(const struct bvh *tree, const struct box *box, int except,
                              void (*visit)(void *user, int id), void *user) {
    struct {
        int level, group;
    } stack[BVH_LEVELS * BVH_WIDTH] = {{tree->levels - 1, 0}};
    for (int waiting = 1; waiting;) {
        int level = stack[--waiting].level, group = stack[waiting].group;
        int64_t lanes[BVH_WIDTH];
        const struct box_group *four = &tree->group[tree->first[level] + group];
        box_group_test(four, box, lanes);
        for (int k = 0, child = BVH_WIDTH * group; k < BVH_WIDTH; k++, child++) {
            if (!lanes[k] || four->owner[k] == except) continue;
            if (level) stack[waiting].level = level - 1, stack[waiting++].group = child;
            else visit(user, tree->order[child]);
        }
    }
}

void bvh_visit(const struct bvh *tree, const struct box *box, void (*visit)(void *user, int id),
               void *user) {
    bvh_visit_others(tree, box, -1, visit, user);
}

void bvh_visit_others(const struct bvh *tree, const struct box *box, int owner,
                      void (*visit)(void *user, int id), void *user) {
    if (tree->count) visit_groups(tree, box, owner < 0 ? INT32_MIN : owner, visit, user);
}
