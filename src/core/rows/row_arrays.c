/* Arrays of the rows of a batch, checks of what a type writes into them, and the index by
 * particles. */
#include "row_arrays.h"

#include "base/body.h"
#include "base/param_kind.h"
#include "base/text.h"

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
    return set_error(PDYN_BAD_INPUT, "constraint \"%s\" on body \"%s\": %s", b->type->name,
                     b->view.body->name, what);
}

/* Whether a parameter names the body of this particle. */
static bool is_of_other(const struct batch *b, int particle) {
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        const pdyn_body *other = param_body(p, b->params);
        if (other && body_has(other, particle)) return true;
    }
    return false;
}

/* An element selects a particle that it may not. */
static pdyn_status column_fault(const struct batch *b, int element, int particle, int low,
                                int high) {
    char others[160] = "";
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        const pdyn_body *other = param_body(p, b->params);
        if (other)
            text_append(others, sizeof others, ", or %d to %d of body \"%s\"", other->first,
                        other->first + other->count - 1, other->name);
    }
    return rows_fault(b, "element %d selects particle %d, expected %d to %d%s", element, particle,
                      low, high - 1, others);
}

void rows_selectable(const struct batch *b, int *low, int *high) {
    const pdyn_batch *v = &b->view;
    *low = 0;
    if (v->neighbours) *high = v->neighbours->particles - v->neighbours->samples;
    else if (v->contacts) *high = v->contacts->particles;
    else if (v->wet_sides) *high = v->wet_sides->particles;
    else *low = v->body->first, *high = v->body->first + v->body->count;
}

pdyn_status rows_check_weights(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < v->elements; e++)
        if (!(v->weight[e] >= 0.0 && isfinite(v->weight[e])))
            return rows_fault(b,
                              "element %d has the weight %g, expected a finite one of at least 0",
                              e, v->weight[e]);
    return PDYN_OK;
}

pdyn_status rows_check(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    int low, high;
    rows_selectable(b, &low, &high);
    for (int k = 0; k < b->entries; k++) {
        int i = v->column[k];
        if ((i < low || i >= high) && !is_of_other(b, i))
            return column_fault(b, b->entry_element[k], i, low, high);
        if (!isfinite(v->coefficient[k]))
            return rows_fault(b, "element %d has a coefficient that is not finite",
                              b->entry_element[k]);
    }
    return rows_check_weights(b);
}

void rows_weigh(struct batch *b, int first, int last) {
    if (!b->off) b->type->weight(b->params, &b->view, first, last);
    else memset(b->view.weight + first, 0, (size_t)(last - first) * sizeof *b->view.weight);
}

/* ---- arrays ---------------------------------------------------------------------------------- */

/* The arrays for which there is room, but for element_row, from which the others follow, and for
 * `block`. */
static bool resize_arrays(struct batch *b, enum array_action action) {
    pdyn_batch *v = &b->view;
    size_t elements = (size_t)b->room.elements, rows = (size_t)b->room.rows;
    size_t entries = (size_t)b->room.entries, keys = b->type->memory_size ? elements : 0;
    const struct array_entry table[] = {
        ARRAY(v->row_entry, rows + 1),
        ARRAY(v->column, entries),
        ARRAY(v->coefficient, entries),
        ARRAY(v->weight, elements),
        {&v->data, 1, 1 + elements * b->type->data_size},
        ARRAY(v->key, keys),
        {&v->memory, keys, b->type->memory_size},
        ARRAY(v->u, VECTOR_LENGTH(rows)),
        ARRAY(v->p, VECTOR_LENGTH(rows)),
        ARRAY(b->flux, 4 * rows),
        ARRAY(b->partial, pool_blocks(b->room.elements, b->grain)),
        ARRAY(b->block_start, elements + 1),
        ARRAY(b->entry_element, entries),
        ARRAY(b->entry_row, entries),
        ARRAY(b->touch, entries),
    };
    return context_arrays(b->context, table, ARRAY_ROWS(table), action);
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

void rows_of_element(const struct batch *b, int e, int *rows, int *width) {
    *rows = b->type->rows, *width = b->type->width;
    if (b->type->row_sizes) b->type->row_sizes(b->params, &b->view, e, rows, width);
}

bool rows_allocate(struct batch *b) {
    if (!resize_arrays(b, ARRAYS_ALLOCATE)) return false;
    int *row_entry = (int *)b->view.row_entry, rows, width;
    for (int e = 0; e < b->room.elements; e++) {
        rows_of_element(b, e, &rows, &width);
        for (int r = b->view.element_row[e]; r < b->view.element_row[e + 1]; r++)
            row_entry[r + 1] = row_entry[r] + width;
    }
    number_rows(b);
    return true;
}

void rows_free(struct batch *b) {
    pdyn_context *c = b->context;
    if (b->block_start) FREE_ARRAY(c, b->block, rows_block_numbers(b));
    resize_arrays(b, ARRAYS_FREE);
    FREE_ARRAY(c, b->view.element_row, b->room.elements + 1);
}

/* ---- index ----------------------------------------------------------------------------------- */

void rows_find_touched(const struct batch *b, int *first, int *count) {
    int low = INT32_MAX, high = -1;
    for (int k = 0; k < b->entries; k++) {
        if (b->view.column[k] < low) low = b->view.column[k];
        if (b->view.column[k] > high) high = b->view.column[k];
    }
    *first = b->entries ? low : 0, *count = b->entries ? high - low + 1 : 0;
}

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
