/* Elements that come and go: `update`, `memory` and `end` of pdyn_constraint_type. The arrays of
 * the batch grow with the elements and never shrink, so that a warmed-up step allocates nothing. */
#include "row_loops.h"

#include "base/param_kind.h"

#include <math.h>
#include <string.h>

/* The index has room for all particles that rows may ever select. Without memory there is none,
 * and the next call tries again. */
static pdyn_status make_index(struct batch *b) {
    int low, high;
    rows_selectable(b, &low, &high);
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        const pdyn_body *body = param_body(p, b->params);
        if (body && body->first < low) low = body->first;
        if (body && body->first + body->count > high) high = body->first + body->count;
    }
    if (!b->view.scratch)
        b->view.scratch = context_array(b->context, b->view.body->count, b->type->scratch_size);
    if (!b->view.scratch && b->type->scratch_size) return PDYN_NO_MEMORY;
    b->touch_start = NEW_ARRAY(b->context, high - low + 2, int);
    if (!b->touch_start) return PDYN_NO_MEMORY;
    b->touch_room = high - low;
    return PDYN_OK;
}

/* New arrays; what the elements had is lost. */
static pdyn_status make_room(struct batch *b, int elements) {
    int rows = b->type->rows, *element_row;
    rows_free(b);
    b->room.elements = elements, b->room.rows = elements * rows;
    b->room.entries = b->room.rows * b->width;
    b->view.element_row = element_row = NEW_ARRAY(b->context, elements + 1, int);
    for (int e = 0; element_row && e < elements; e++) element_row[e + 1] = (e + 1) * rows;
    if (element_row && rows_allocate(b)) return PDYN_OK;
    rows_free(b);
    memset(&b->room, 0, sizeof b->room);
    b->view.elements = b->rows = b->entries = 0;
    return context_no_memory(b->context);
}

static pdyn_status resize(struct batch *b, int elements) {
    long entries = (long)elements * b->type->rows * b->width;
    if (elements < 0) return rows_fault(b, "it has %d elements", elements);
    if (entries > INT32_MAX / 2) return rows_fault(b, "it has too many rows");
    if (elements > b->room.elements) {
        pdyn_status status = make_room(b, elements + elements / 2);
        if (status != PDYN_OK) return status;
    }
    b->view.elements = elements, b->rows = elements * b->type->rows, b->entries = (int)entries;
    return PDYN_OK;
}

/* Whether the rows of the elements [first, last) select particles of the body, or of the system,
 * and their numbers are finite. Where this is false, rows_check decides, which knows other bodies.
 */
static bool are_good(const struct batch *b, int first, int last) {
    const pdyn_batch *v = &b->view;
    int low, high;
    bool good = true;
    rows_selectable(b, &low, &high);
    for (int k = v->row_entry[v->element_row[first]]; k < v->row_entry[v->element_row[last]]; k++)
        good &= v->column[k] >= low && v->column[k] < high && isfinite(v->coefficient[k]);
    for (int e = first; e < last; e++) good &= v->weight[e] >= 0.0 && isfinite(v->weight[e]);
    return good;
}

static void fill_rows(void *arg, int first, int last, int block) {
    struct batch *b = arg;
    b->type->select(b->params, &b->view, first, last);
    if (!b->type->begin) rows_weigh(b, first, last);
    b->partial[block] = are_good(b, first, last) ? 0.0 : 1.0;
}

/* The type counts its elements and is called again where there was no room for all. */
static pdyn_status count_elements(struct batch *b, const double *x, const double *v) {
    pdyn_status status = PDYN_OK;
    for (int room = -1; status == PDYN_OK && b->room.elements > room;) {
        room = b->room.elements;
        status = resize(b, b->type->update(b->params, &b->view, x, v, room));
    }
    if (status != PDYN_OK) b->view.elements = b->rows = b->entries = 0;
    return status;
}

pdyn_status rows_update(struct batch *b, const double *x, const double *v) {
    pdyn_status status = b->touch_start ? PDYN_OK : make_index(b);
    if (status == PDYN_OK) status = count_elements(b, x, v);
    if (status != PDYN_OK) return status;
    int elements = b->view.elements, blocks = pool_blocks(elements, b->grain);
    bool good = true;
    batch_recall(b);
    pool_for(b->context->pool, elements, b->grain, fill_rows, b);
    for (int k = 0; k < blocks; k++) good &= b->partial[k] == 0.0;
    status = good ? PDYN_OK : rows_check(b);
    if (status != PDYN_OK) return status;
    rows_find_touched(b, &b->touch_first, &b->touch_count);
    rows_index(b);
    return PDYN_OK;
}

void batch_recall(struct batch *b) {
    size_t size = b->type->memory_size;
    if (size) row_memory_get(&b->memory, b->view.key, b->view.memory, b->view.elements, size);
}

static void end_rows(void *arg, int first, int last, int block) {
    (void)block;
    struct batch *b = arg;
    b->type->end(b->params, &b->view, first, last);
}

pdyn_status batch_prepare_end(struct batch *b) {
    if (!b->type->end) return PDYN_OK;
    return row_memory_reserve(b->context, &b->memory, b->view.elements, b->type->memory_size);
}

void batch_end(struct batch *b) {
    if (!b->type->end) return;
    pool_for(b->context->pool, b->view.elements, b->grain, end_rows, b);
    row_memory_set(&b->memory, b->view.key, b->view.memory, b->view.elements, b->type->memory_size);
}
