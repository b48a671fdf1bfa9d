#include "boxes.h"

#include <math.h>
#include <string.h>

const struct box box_empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

void box_add(struct box *box, const double x[3]) {
    for (int a = 0; a < 3; a++) {
        if (x[a] < box->min[a]) box->min[a] = x[a];
        if (x[a] > box->max[a]) box->max[a] = x[a];
    }
}

/* Nodes of all levels over `count` boxes; first: where each level begins. */
static int count_nodes(int count, int *levels, int *first) {
    int total = 0;
    for (*levels = 0;; ++*levels) {
        first[*levels] = total;
        total += count;
        if (count <= 1) break;
        count = (count + BOXES_WIDTH - 1) / BOXES_WIDTH;
    }
    first[++*levels] = total;
    return total;
}

pdyn_status boxes_create(pdyn_context *context, int capacity, struct boxes *boxes) {
    *boxes = (struct boxes){.capacity = capacity};
    boxes->key = NEW_ARRAY(context, capacity, uint32_t);
    boxes->order = NEW_ARRAY(context, capacity, int);
    boxes->swapped = NEW_ARRAY(context, capacity, int);
    boxes->node =
        NEW_ARRAY(context, count_nodes(capacity, &boxes->levels, boxes->first), struct box);
    if (!capacity || (boxes->key && boxes->order && boxes->swapped && boxes->node)) return PDYN_OK;
    boxes_free(context, boxes);
    return PDYN_NO_MEMORY;
}

void boxes_free(pdyn_context *context, struct boxes *boxes) {
    FREE_ARRAY(context, boxes->key, boxes->capacity);
    FREE_ARRAY(context, boxes->order, boxes->capacity);
    FREE_ARRAY(context, boxes->swapped, boxes->capacity);
    FREE_ARRAY(context, boxes->node, count_nodes(boxes->capacity, &boxes->levels, boxes->first));
}

/* ---- sorting --------------------------------------------------------------------------------- */

/* Ten bits with two zeros before each. */
static uint32_t spread(uint32_t v) {
    v = (v | v << 16) & 0x030000FFu;
    v = (v | v << 8) & 0x0300F00Fu;
    v = (v | v << 4) & 0x030C30C3u;
    return (v | v << 2) & 0x09249249u;
}

static void find_keys(struct boxes *boxes, const struct box *box, int count) {
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
static void sort_keys(struct boxes *boxes, int count) {
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

static void wrap_groups(struct boxes *boxes, int level) {
    int below = boxes->first[level - 1], end = boxes->first[level];
    for (int n = end; n < boxes->first[level + 1]; n++, below += BOXES_WIDTH) {
        boxes->node[n] = box_empty;
        for (int k = below; k < below + BOXES_WIDTH && k < end; k++) {
            box_add(&boxes->node[n], boxes->node[k].min);
            box_add(&boxes->node[n], boxes->node[k].max);
        }
    }
}

void boxes_sort(struct boxes *boxes, const struct box *box, int count) {
    boxes->count = count;
    count_nodes(count, &boxes->levels, boxes->first);
    find_keys(boxes, box, count);
    sort_keys(boxes, count);
    for (int i = 0; i < count; i++) boxes->node[i] = box[boxes->order[i]];
    for (int level = 1; level < boxes->levels; level++) wrap_groups(boxes, level);
}

/* ---- asking ---------------------------------------------------------------------------------- */

/* Depth first; a node waits on the stack with its level. */
void boxes_visit(const struct boxes *boxes, const struct box *box, int from,
                 void (*visit)(void *user, int id), void *user) {
    struct {
        int level, node;
    } stack[BOXES_LEVELS * BOXES_WIDTH];
    int waiting = 0;
    if (!boxes->count) return;
    stack[waiting].level = boxes->levels - 1, stack[waiting++].node = 0;
    while (waiting) {
        int level = stack[--waiting].level, node = stack[waiting].node;
        if (!box_overlaps(&boxes->node[boxes->first[level] + node], box)) continue;
        if (level == 0) {
            if (boxes->order[node] >= from) visit(user, boxes->order[node]);
            continue;
        }
        int nodes = boxes->first[level] - boxes->first[level - 1];
        for (int k = BOXES_WIDTH * node; k < BOXES_WIDTH * (node + 1) && k < nodes; k++)
            stack[waiting].level = level - 1, stack[waiting++].node = k;
    }
}
