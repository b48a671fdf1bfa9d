#include "bvh.h"

#include "base/simd.h"

#include <math.h>
#include <string.h>

const struct box box_empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

void box_add(struct box *box, const double x[3]) {
    for (int a = 0; a < 3; a++) {
        if (x[a] < box->min[a]) box->min[a] = x[a];
        if (x[a] > box->max[a]) box->max[a] = x[a];
    }
}

/* Groups of all levels over `count` boxes; first: where each level begins. */
static int count_groups(int count, int *levels, int *first) {
    int total = 0;
    *levels = 0;
    do {
        first[(*levels)++] = total;
        count = (count + BOXES_WIDTH - 1) / BOXES_WIDTH;
        total += count;
    } while (count > 1);
    first[*levels] = total;
    return total;
}

pdyn_status bvh_create(pdyn_context *context, int capacity, struct bvh *boxes) {
    *boxes = (struct bvh){.capacity = capacity};
    boxes->key = NEW_ARRAY(context, capacity, uint32_t);
    boxes->order = NEW_ARRAY(context, capacity, int);
    boxes->swapped = NEW_ARRAY(context, capacity, int);
    int groups = count_groups(capacity, &boxes->levels, boxes->first);
    boxes->group = NEW_ARRAY(context, groups, struct box_group);
    if (!capacity || (boxes->key && boxes->order && boxes->swapped && boxes->group)) return PDYN_OK;
    bvh_free(context, boxes);
    return PDYN_NO_MEMORY;
}

void bvh_free(pdyn_context *context, struct bvh *boxes) {
    FREE_ARRAY(context, boxes->key, boxes->capacity);
    FREE_ARRAY(context, boxes->order, boxes->capacity);
    FREE_ARRAY(context, boxes->swapped, boxes->capacity);
    FREE_ARRAY(context, boxes->group, count_groups(boxes->capacity, &boxes->levels, boxes->first));
}

/* ---- sorting --------------------------------------------------------------------------------- */

/* Ten bits with two zeros before each. */
static uint32_t spread(uint32_t v) {
    v = (v | v << 16) & 0x030000FFu;
    v = (v | v << 8) & 0x0300F00Fu;
    v = (v | v << 4) & 0x030C30C3u;
    return (v | v << 2) & 0x09249249u;
}

static void find_keys(struct bvh *boxes, const struct box *box, int count) {
    struct box all = box_empty;
    double middle[3], scale = 0.0;
    for (int i = 0; i < count; i++) box_add(&all, box[i].min), box_add(&all, box[i].max);
    for (int a = 0; a < 3; a++) scale = fmax(scale, all.max[a] - all.min[a]);
    scale = scale > 0.0 ? 1023.0 / scale : 0.0;
    for (int i = 0; i < count; i++) {
        boxes->order[i] = i, boxes->key[i] = 0;
        for (int a = 0; a < 3; a++) {
            middle[a] = 0.5 * (box[i].min[a] + box[i].max[a]) - all.min[a];
            boxes->key[i] |= spread((uint32_t)(scale * middle[a])) << a;
        }
    }
}

/* Ten bits at a time, from the lowest. */
static void sort_keys(struct bvh *boxes, int count) {
    enum { BITS = 10, BINS = 1 << BITS };
    for (int shift = 0; shift < 30; shift += BITS) {
        int end[BINS + 1] = {0};
        for (int i = 0; i < count; i++) end[1 + (boxes->key[i] >> shift & (BINS - 1))]++;
        for (int b = 0; b < BINS; b++) end[b + 1] += end[b];
        for (int i = 0; i < count; i++)
            boxes->swapped[end[boxes->key[boxes->order[i]] >> shift & (BINS - 1)]++] =
                boxes->order[i];
        int *sorted = boxes->swapped;
        boxes->swapped = boxes->order, boxes->order = sorted;
    }
}

static void set_lane(struct box_group *group, int lane, const struct box *box) {
    for (int a = 0; a < 3; a++)
        group->min[a][lane] = box->min[a], group->max[a][lane] = box->max[a];
}

static struct box around(const struct box_group *group) {
    struct box box = box_empty;
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < BOXES_WIDTH; k++) {
            box.min[a] = fmin(box.min[a], group->min[a][k]);
            box.max[a] = fmax(box.max[a], group->max[a][k]);
        }
    return box;
}

void bvh_sort(struct bvh *boxes, const struct box *box, int count) {
    boxes->count = count;
    count_groups(count, &boxes->levels, boxes->first);
    if (!count) return;
    find_keys(boxes, box, count);
    sort_keys(boxes, count);
    for (int level = 0, below = count; level < boxes->levels; level++) {
        struct box_group *group = boxes->group + boxes->first[level];
        int groups = boxes->first[level + 1] - boxes->first[level];
        for (int k = 0; k < BOXES_WIDTH * groups; k++) {
            struct box one = box_empty;
            if (k < below)
                one = level ? around(boxes->group + boxes->first[level - 1] + k)
                            : box[boxes->order[k]];
            set_lane(&group[k / BOXES_WIDTH], k % BOXES_WIDTH, &one);
        }
        below = groups;
    }
}

/* ---- asking ---------------------------------------------------------------------------------- */

typedef int64_t lanes4 __attribute__((vector_size(32)));

/* Not 0 in the lanes that overlap the box. */
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

/* Depth first; a group waits on the stack with its level. */
WIDE static void visit_groups(const struct bvh *boxes, const struct box *box, int from,
                              void (*visit)(void *user, int id), void *user) {
    struct {
        int level, group;
    } stack[BOXES_LEVELS * BOXES_WIDTH] = {{boxes->levels - 1, 0}};
    for (int waiting = 1; waiting;) {
        int level = stack[--waiting].level, group = stack[waiting].group;
        int64_t lanes[BOXES_WIDTH];
        test_group(&boxes->group[boxes->first[level] + group], box, lanes);
        for (int k = 0, child = BOXES_WIDTH * group; k < BOXES_WIDTH; k++, child++) {
            if (!lanes[k]) continue;
            if (level) stack[waiting].level = level - 1, stack[waiting++].group = child;
            else if (boxes->order[child] >= from) visit(user, boxes->order[child]);
        }
    }
}

void bvh_visit(const struct bvh *boxes, const struct box *box, int from,
               void (*visit)(void *user, int id), void *user) {
    if (boxes->count) visit_groups(boxes, box, from, visit, user);
}
