#include "batch.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- what a type must not do, as far as it is cheap to see ----------------------------------- */

static pdyn_status fault(const struct batch *b, const char *format, ...) PDYN_PRINTF(2, 3);
static pdyn_status fault(const struct batch *b, const char *format, ...) {
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

/* Particles that rows may select, besides those of other bodies that parameters name: all of the
 * system where the type knows what core finds there, otherwise those of the body. */
static void selectable(const struct batch *b, int *low, int *high) {
    const pdyn_batch *v = &b->view;
    *low = 0;
    if (v->neighbours) *high = v->neighbours->particles - v->neighbours->samples;
    else if (v->contacts) *high = v->contacts->particles;
    else if (v->wet_sides) *high = v->wet_sides->particles;
    else *low = v->body->first, *high = v->body->first + v->body->count;
}

static pdyn_status check_rows(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    int low, high;
    selectable(b, &low, &high);
    for (int k = 0; k < b->entries; k++) {
        int i = v->column[k];
        if ((i < low || i >= high) && !is_of_other(b, i))
            return fault(b, "element %d selects particle %d, expected %d to %d",
                         b->entry_element[k], i, low, high - 1);
        if (!isfinite(v->coefficient[k]))
            return fault(b, "element %d has a coefficient that is not finite", b->entry_element[k]);
    }
    for (int e = 0; e < v->elements; e++)
        if (!(v->weight[e] >= 0.0 && isfinite(v->weight[e])))
            return fault(b, "element %d has the weight %g, expected a finite one of at least 0", e,
                         v->weight[e]);
    return PDYN_OK;
}

/* ---- setting up ------------------------------------------------------------------------------ */

/* Counts rows and entries of every element. */
static pdyn_status shape_rows(struct batch *b, int *element_row, int **row_width) {
    const pdyn_constraint_type *t = b->type;
    pdyn_batch *v = &b->view;
    long rows = 0, entries = 0;
    for (int e = 0; e < v->elements; e++) {
        int n = t->rows, width = t->width;
        if (t->row_sizes) t->row_sizes(b->params, v, e, &n, &width);
        if (n < 0 || width < 0)
            return fault(b, "element %d has %d rows of %d entries", e, n, width);
        if (t->tangent_rank1 && n != 1)
            return fault(b, "element %d has %d rows, expected 1 as its tangent is axial", e, n);
        rows += n;
        entries += (long)n * width;
        if (rows > INT32_MAX / 3 || entries > INT32_MAX)
            return context_fail(b->context, PDYN_BAD_INPUT, "constraint \"%s\": too many rows",
                                t->name);
        element_row[e + 1] = (int)rows;
    }
    b->rows = (int)rows, b->entries = (int)entries;
    *row_width = NEW_ARRAY(b->context, rows, int);
    if (rows && !*row_width) return PDYN_NO_MEMORY;
    for (int e = 0; e < v->elements; e++) {
        int n = t->rows, width = t->width;
        if (t->row_sizes) t->row_sizes(b->params, v, e, &n, &width);
        for (int r = element_row[e]; r < element_row[e + 1]; r++) (*row_width)[r] = width;
    }
    return PDYN_OK;
}

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
        b->block_start[e + 1] = b->block_start[e] + (b->type->tangent_rank1 ? 4 : n * n);
        for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++)
            for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++)
                b->entry_element[k] = e, b->entry_row[k] = r;
    }
}

/* All arrays but element_row, with room for so many elements, rows and entries. */
static bool allocate_rows(struct batch *b, const int *row_width) {
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
    b->partial = NEW_ARRAY(c, pool_blocks(elements, BATCH_GRAIN), double);
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

static void free_rows(struct batch *b) {
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
    FREE_ARRAY(c, b->partial, pool_blocks(elements, BATCH_GRAIN));
    FREE_ARRAY(c, b->block_start, elements + 1);
    FREE_ARRAY(c, b->entry_element, entries);
    FREE_ARRAY(c, b->entry_row, entries);
    FREE_ARRAY(c, b->touch, entries);
}

/* Every element is a row that selects no particle twice. */
static bool is_single(const pdyn_batch *v) {
    for (int e = 0; e < v->elements; e++) {
        if (v->element_row[e + 1] - v->element_row[e] != 1) return false;
        for (int k = v->row_entry[e]; k < v->row_entry[e + 1]; k++)
            for (int m = v->row_entry[e]; m < k; m++)
                if (v->column[m] == v->column[k]) return false;
    }
    return true;
}

/* Entries of every row, or 0 where they differ. */
static int common_width(const pdyn_batch *v, int rows) {
    int width = rows ? v->row_entry[1] : 0;
    for (int r = 0; r < rows; r++)
        if (v->row_entry[r + 1] - v->row_entry[r] != width) return 0;
    return width;
}

/* The transpose of G: for every particle the entries that select it. */
static void index_rows(struct batch *b) {
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

static pdyn_status find_touched(struct batch *b) {
    const pdyn_batch *v = &b->view;
    int low = INT32_MAX, high = -1;
    for (int k = 0; k < b->entries; k++) {
        if (v->column[k] < low) low = v->column[k];
        if (v->column[k] > high) high = v->column[k];
    }
    b->touch_first = b->entries ? low : 0;
    b->touch_count = b->entries ? high - low + 1 : 0;
    b->touch_start = NEW_ARRAY(b->context, b->touch_count + 2, int);
    return b->touch_start ? PDYN_OK : PDYN_NO_MEMORY;
}

static pdyn_status create_rows(struct batch *b) {
    pdyn_batch *v = &b->view;
    int *row_width = NULL, *element_row = NEW_ARRAY(b->context, v->elements + 1, int);
    v->element_row = element_row, b->room.elements = v->elements;
    if (!element_row) return PDYN_NO_MEMORY;
    pdyn_status status = shape_rows(b, element_row, &row_width);
    b->room.rows = b->rows, b->room.entries = b->entries;
    if (status == PDYN_OK && !allocate_rows(b, row_width)) status = context_no_memory(b->context);
    FREE_ARRAY(b->context, row_width, b->rows);
    if (status != PDYN_OK) return status;
    b->type->select(b->params, v, 0, v->elements);
    /* Where a type has `begin`, its weights may depend on h: they are 0 until the first step. */
    if (!b->type->begin) b->type->weight(b->params, v, 0, v->elements);
    status = check_rows(b);
    if (status != PDYN_OK) return status;
    b->single = is_single(v), b->width = common_width(v, b->rows);
    status = find_touched(b);
    if (status == PDYN_OK) index_rows(b);
    return status;
}

pdyn_status batch_create(pdyn_context *context, const pdyn_constraint_type *type,
                         const void *params, const pdyn_body *body, const pdyn_services *services,
                         const pdyn_neighbours *neighbours, bool rows_only, struct batch **out) {
    struct batch *b = *out = NEW_ARRAY(context, 1, struct batch);
    if (!b) return PDYN_NO_MEMORY;
    b->context = context, b->type = type, b->params = params;
    b->view.body = body, b->view.neighbours = neighbours;
    b->view.elements = type->update ? 0 : type->elements(params, body);
    pdyn_status status = PDYN_OK;
    if (b->view.elements < 0)
        status = fault(b, "it has %d elements", b->view.elements), b->view.elements = 0;
    else if (type->update) b->single = type->rows == 1, b->width = type->width;
    else if (!type->matrix_free || rows_only) status = create_rows(b);
    else if (!(b->op = type->matrix_free->create(params, body, services)))
        status = context_no_memory(context);
    else {
        b->one_sided = (struct one_sided){.context = context,
                                          .op = type->matrix_free,
                                          .self = b->op,
                                          .particles = neighbours->particles};
        status = batch_neighbours(b, neighbours);
    }
    if (status == PDYN_OK) return status;
    batch_free(b);
    *out = NULL;
    return status;
}

pdyn_status batch_join_rows(struct batch *b) {
    if (b->op || !b->type->linear || !b->type->linear(b->params, &b->view)) return PDYN_OK;
    return linear_rows_create(b->context, b, &b->linear);
}

/* ---- elements that come and go --------------------------------------------------------------- */

/* An index over all particles that rows may ever select. */
static pdyn_status make_index(struct batch *b) {
    int low, high;
    selectable(b, &low, &high);
    for (const pdyn_param *p = b->type->params; p->name; p++) {
        if (p->kind != PDYN_OTHER) continue;
        const pdyn_body *body = ((const pdyn_other *)((const char *)b->params + p->offset))->body;
        if (body && body->first < low) low = body->first;
        if (body && body->first + body->count > high) high = body->first + body->count;
    }
    b->touch_first = low, b->touch_count = high - low;
    b->touch_start = NEW_ARRAY(b->context, b->touch_count + 2, int);
    return b->touch_start ? PDYN_OK : PDYN_NO_MEMORY;
}

static pdyn_status make_room(struct batch *b, int elements) {
    int rows = b->type->rows, *element_row;
    free_rows(b);
    b->room.elements = elements, b->room.rows = elements * rows;
    b->room.entries = b->room.rows * b->width;
    b->view.element_row = element_row = NEW_ARRAY(b->context, elements + 1, int);
    for (int e = 0; element_row && e < elements; e++) element_row[e + 1] = (e + 1) * rows;
    if (element_row && allocate_rows(b, NULL)) return PDYN_OK;
    return context_no_memory(b->context);
}

static pdyn_status resize(struct batch *b, int elements) {
    long entries = (long)elements * b->type->rows * b->width;
    if (elements < 0) return fault(b, "it has %d elements", elements);
    if (entries > INT32_MAX / 2) return fault(b, "it has too many rows");
    if (elements > b->room.elements) {
        pdyn_status status = make_room(b, elements + elements / 2);
        if (status != PDYN_OK) return status;
    }
    b->view.elements = elements, b->rows = elements * b->type->rows, b->entries = (int)entries;
    return PDYN_OK;
}

/* Whether check_rows would find nothing to say about the elements [first, last), whose rows select
 * particles that the index has. */
static bool are_good(const struct batch *b, int first, int last) {
    const pdyn_batch *v = &b->view;
    int low, high;
    bool good = true;
    selectable(b, &low, &high);
    for (int k = v->row_entry[v->element_row[first]]; k < v->row_entry[v->element_row[last]]; k++)
        good &= v->column[k] >= low && v->column[k] < high && isfinite(v->coefficient[k]);
    for (int e = first; e < last; e++) good &= v->weight[e] >= 0.0 && isfinite(v->weight[e]);
    return good;
}

static void fill_rows(void *arg, int first, int last, int block) {
    struct batch *b = arg;
    b->type->select(b->params, &b->view, first, last);
    if (!b->type->begin) b->type->weight(b->params, &b->view, first, last);
    b->partial[block] = are_good(b, first, last) ? 0.0 : 1.0;
}

pdyn_status batch_update(struct batch *b, const double *x, const double *v) {
    const pdyn_constraint_type *t = b->type;
    pdyn_status status = b->touch_start ? PDYN_OK : make_index(b);
    for (int room = -1; status == PDYN_OK && b->room.elements > room;) {
        room = b->room.elements;
        status = resize(b, t->update(b->params, &b->view, x, v, room));
    }
    if (status != PDYN_OK) return b->view.elements = b->rows = b->entries = 0, status;
    int elements = b->view.elements, blocks = pool_blocks(elements, BATCH_GRAIN);
    bool good = true;
    if (t->memory_size)
        row_memory_get(&b->memory, b->view.key, b->view.memory, elements, t->memory_size);
    pool_for(b->context->pool, elements, BATCH_GRAIN, fill_rows, b);
    for (int k = 0; k < blocks; k++) good &= b->partial[k] == 0.0;
    status = good ? PDYN_OK : check_rows(b);
    if (status == PDYN_OK) index_rows(b);
    return status;
}

static void end_rows(void *arg, int first, int last, int block) {
    (void)block;
    struct batch *b = arg;
    b->type->end(b->params, &b->view, first, last);
}

pdyn_status batch_end(struct batch *b) {
    if (!b->type->end) return PDYN_OK;
    pool_for(b->context->pool, b->view.elements, BATCH_GRAIN, end_rows, b);
    return row_memory_set(b->context, &b->memory, b->view.key, b->view.memory, b->view.elements,
                          b->type->memory_size);
}

pdyn_status batch_neighbours(struct batch *b, const pdyn_neighbours *neighbours) {
    if (b->op && !b->type->matrix_free->neighbours(b->op, neighbours))
        return context_no_memory(b->context);
    return PDYN_OK;
}

void batch_free(struct batch *b) {
    if (!b) return;
    pdyn_context *c = b->context;
    if (b->op) b->type->matrix_free->free(b->op), one_sided_free(&b->one_sided);
    free_rows(b);
    row_memory_free(c, &b->memory, b->type->memory_size);
    linear_rows_free(b->linear);
    FREE_ARRAY(c, b->touch_start, b->touch_count + 2);
    FREE_ARRAY(c, b, 1);
}
