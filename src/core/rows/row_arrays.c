#include "row_arrays.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- rows that a type must not give, as far as it is cheap to see ---------------------------- */

pdyn_status rows_fault(const struct batch *b, const char *format, ...) {
    char what[256];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return context_fail(b->context, PDYN_BAD_INPUT, "constraint \"%s\" on body \"%s\": %s",
                        b->type->name, b->view.body->name, what);
}

/* Whether a parameter names the body of this particle. */
static bool is_of_other(const struct batch *b, int particle) {
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        if (p->kind != PDYN_OTHER) continue;
        const pdyn_body *body = ((const pdyn_other *)((const char *)b->params + p->offset))->body;
        if (body && particle >= body->first && particle < body->first + body->count) return true;
    }
    return false;
}

void rows_selectable(const struct batch *b, int *low, int *high) {
    const pdyn_batch *v = &b->view;
    *low = 0;
    if (v->neighbours) *high = v->neighbours->particles - v->neighbours->samples;
    else if (v->contacts) *high = v->contacts->particles;
    else if (v->wet_sides) *high = v->wet_sides->particles;
    else *low = v->body->first, *high = v->body->first + v->body->count;
}

pdyn_status rows_check(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    int low, high;
    rows_selectable(b, &low, &high);
    for (int k = 0; k < b->entries; k++) {
        int i = v->column[k];
        if ((i < low || i >= high) && !is_of_other(b, i))
            return rows_fault(b, "element %d selects particle %d, expected %d to %d",
                              b->entry_element[k], i, low, high - 1);
        if (!isfinite(v->coefficient[k]))
            return rows_fault(b, "element %d has a coefficient that is not finite",
                              b->entry_element[k]);
    }
    for (int e = 0; e < v->elements; e++)
        if (!(v->weight[e] >= 0.0 && isfinite(v->weight[e])))
            return rows_fault(b,
                              "element %d has the weight %g, expected a finite one of at least 0",
                              e, v->weight[e]);
    return PDYN_OK;
}

void rows_weigh(struct batch *b, int first, int last) {
    if (!b->off) b->type->weight(b->params, &b->view, first, last);
    else memset(b->view.weight + first, 0, (size_t)(last - first) * sizeof *b->view.weight);
}

/* ---- arrays ---------------------------------------------------------------------------------- */

static size_t data_bytes(const struct batch *b) {
    return 1 + (size_t)b->room.elements * b->type->data_size;
}

static size_t memory_bytes(const struct batch *b) {
    return (size_t)b->room.elements * b->type->memory_size;
}

/* Where an element's block begins, and what each entry belongs to. */
static void number_rows(struct batch *b) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < b->room.elements; e++) {
        size_t n = 3 * (size_t)(v->element_row[e + 1] - v->element_row[e]);
        b->block_start[e + 1] = b->block_start[e] + (b->type->tangent_rank1 ? n + 1 : n * n);
        for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++)
            for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
                b->entry_element[k] = e, b->entry_row[k] = r;
    }
}

void rows_set_grain(struct batch *b, double rows, double entries) {
    b->grain = (int)fmax(64.0, 4096.0 / fmax(2.0, rows * entries));
}

bool rows_allocate(struct batch *b, const int *row_width) {
    pdyn_context *c = b->context;
    pdyn_batch *v = &b->view;
    int elements = b->room.elements, rows = b->room.rows, entries = b->room.entries;
    int keys = b->type->memory_size ? elements : 0;
    int *row_entry = NEW_ARRAY(c, rows + 1, int);
    v->row_entry = row_entry;
    for (int r = 0; row_entry && r < rows; r++)
        row_entry[r + 1] = row_entry[r] + (row_width ? row_width[r] : b->width);
    v->column = NEW_ARRAY(c, entries, int);
    v->coefficient = NEW_ARRAY(c, entries, double);
    v->weight = NEW_ARRAY(c, elements, double);
    v->data = context_array(c, 1, data_bytes(b));
    v->key = NEW_ARRAY(c, keys, uint64_t);
    v->memory = context_array(c, (size_t)keys, b->type->memory_size);
    v->u = NEW_VECTOR(c, rows);
    v->p = NEW_VECTOR(c, rows);
    b->flux = NEW_ARRAY(c, 4 * (size_t)rows, double);
    b->partial = NEW_ARRAY(c, pool_blocks(elements, b->grain), double);
    b->block_start = NEW_ARRAY(c, elements + 1, size_t);
    b->entry_element = NEW_ARRAY(c, entries, int);
    b->entry_row = NEW_ARRAY(c, entries, int);
    b->touch = NEW_ARRAY(c, entries, struct touch);
    bool good =
        row_entry && v->data && b->block_start && (!elements || (v->weight && b->partial)) &&
        (!keys || (v->key && v->memory)) && (!rows || (v->u && v->p && b->flux)) &&
        (!entries || (v->column && v->coefficient && b->entry_element && b->entry_row && b->touch));
    if (good) number_rows(b);
    return good;
}

void rows_free(struct batch *b) {
    pdyn_context *c = b->context;
    pdyn_batch *v = &b->view;
    int elements = b->room.elements, rows = b->room.rows, entries = b->room.entries;
    if (b->block_start) FREE_ARRAY(c, b->block, batch_block_numbers(b));
    if (v->data) v->data = context_resize(c, v->data, data_bytes(b), 0);
    if (v->memory) v->memory = context_resize(c, v->memory, memory_bytes(b), 0);
    FREE_ARRAY(c, v->key, elements);
    FREE_ARRAY(c, v->element_row, elements + 1);
    FREE_ARRAY(c, v->row_entry, rows + 1);
    FREE_ARRAY(c, v->column, entries);
    FREE_ARRAY(c, v->coefficient, entries);
    FREE_ARRAY(c, v->weight, elements);
    FREE_VECTOR(c, v->u, rows);
    FREE_VECTOR(c, v->p, rows);
    FREE_ARRAY(c, b->flux, 4 * (size_t)rows);
    FREE_ARRAY(c, b->partial, pool_blocks(elements, b->grain));
    FREE_ARRAY(c, b->block_start, elements + 1);
    FREE_ARRAY(c, b->entry_element, entries);
    FREE_ARRAY(c, b->entry_row, entries);
    FREE_ARRAY(c, b->touch, entries);
}

/* ---- index ----------------------------------------------------------------------------------- */

void rows_index(struct batch *b) {
    const pdyn_batch *v = &b->view;
    int *start = b->touch_start, *end = start + 1, low = b->touch_first;
    memset(start, 0, ((size_t)b->touch_count + 2) * sizeof *start);
    for (int k = 0; k < b->entries; k++)
        if (v->coefficient[k] != 0.0) end[v->column[k] - low + 1]++;
    for (int i = 0; i < b->touch_count; i++)
        end[i + 1] += end[i]; /* filling turns ends into starts */
    for (int k = 0; k < b->entries; k++)
        if (v->coefficient[k] != 0.0)
            b->touch[end[v->column[k] - low]++] =
                (struct touch){v->coefficient[k], b->entry_row[k], k};
    b->revision++;
}
