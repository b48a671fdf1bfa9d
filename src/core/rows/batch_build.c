/* Makes a batch: its rows where its elements stay the same, or its operator. */
#include "row_arrays.h"

#include "base/registry.h"
#include "base/snapshot_file.h"

/* ---- setting up ------------------------------------------------------------------------------ */

enum { MAX_ROWS = INT32_MAX / 3 }; /* of a batch: three numbers each */

/* Counts rows and entries of every element. */
static pdyn_status shape_rows(struct batch *b, int *element_row) {
    const pdyn_constraint_type *t = b->type;
    long rows = 0, entries = 0;
    for (int e = 0; e < b->view.elements; e++) {
        int n, width;
        rows_of_element(b, e, &n, &width);
        if (n < 0 || width < 0)
            return rows_fault(b, "element %d has %d rows of %d entries", e, n, width);
        if (t->flags & PDYN_NUMERIC_TANGENT && n > NUMERIC_TANGENT_ROWS)
            return rows_fault(
                b, "element %d has %d rows, expected at most %d with PDYN_NUMERIC_TANGENT", e, n,
                NUMERIC_TANGENT_ROWS);
        b->wide |= t->tangent_rank1 && n != 1;
        b->dense |= n && width > MAX_DENSE;
        rows += n;
        entries += (long)n * width;
        if (rows > MAX_ROWS || entries > INT32_MAX) return rows_fault(b, "it has too many rows");
        element_row[e + 1] = (int)rows;
    }
    b->rows = (int)rows, b->entries = (int)entries;
    return PDYN_OK;
}

/* Whether every element is a row that selects no particle twice. */
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

/* The range of particles that rows select. A failure changes nothing. */
static pdyn_status find_touched(struct batch *b) {
    int first, count;
    rows_find_touched(b, &first, &count);
    if (!b->touch_start || count != b->touch_room) {
        int *start = NEW_ARRAY(b->context, count + 2, int);
        if (!start) return PDYN_NO_MEMORY;
        FREE_ARRAY(b->context, b->touch_start, b->touch_room + 2);
        b->touch_start = start, b->touch_room = count;
    }
    b->touch_first = first, b->touch_count = count;
    return PDYN_OK;
}

/* Checks and indexes the rows that `select` has written. */
static pdyn_status index_rows(struct batch *b) {
    pdyn_status status = rows_check(b);
    if (status != PDYN_OK) return status;
    b->single = is_single(&b->view), b->width = common_width(&b->view, b->rows);
    status = find_touched(b);
    if (status == PDYN_OK) rows_index(b);
    return status;
}

static pdyn_status create_rows(struct batch *b) {
    pdyn_batch *v = &b->view;
    int *element_row = NEW_ARRAY(b->context, v->elements + 1, int);
    v->element_row = element_row, b->room.elements = v->elements;
    if (!element_row) return PDYN_NO_MEMORY;
    pdyn_status status = shape_rows(b, element_row);
    if (status != PDYN_OK) return status;
    b->room.rows = b->rows, b->room.entries = b->entries;
    if (v->elements)
        rows_set_grain(b, (double)b->rows / v->elements, (double)b->entries / v->elements);
    if (!rows_allocate(b)) return context_no_memory(b->context);
    for (int e = 0; e < v->elements && v->key; e++) v->key[e] = (uint64_t)e;
    b->type->select(b->params, v, 0, v->elements);
    /* Weights that may depend on h are 0 until the first step. */
    if (!type_weighs_in_steps(b->type)) rows_weigh(b, 0, v->elements);
    return index_rows(b);
}

static pdyn_status create_operator(struct batch *b, const pdyn_services *services) {
    const pdyn_operator *op = b->type->matrix_free;
    if (!(b->op = op->create(b->params, b->view.body, services)))
        return context_no_memory(b->context);
    const pdyn_neighbours *lists = b->view.neighbours;
    b->one_sided = (struct one_sided){.context = b->context,
                                      .op = op,
                                      .self = b->op,
                                      .particles = lists->particles - lists->samples};
    if (lists->samples && !(b->lumped = NEW_ARRAY(b->context, b->one_sided.particles, double)))
        return context_no_memory(b->context);
    return batch_neighbours(b, b->view.neighbours);
}

/* Elements that come and go: there are none yet. */
static void start_dynamic(struct batch *b) {
    b->single = b->type->rows == 1, b->width = b->type->width;
    b->wide = b->type->tangent_rank1 && !b->single;
}

static pdyn_status create(pdyn_context *context, const struct batch_def *def, bool rows,
                          struct batch **out) {
    const pdyn_constraint_type *type = def->type;
    struct batch *b = *out = NEW_ARRAY(context, 1, struct batch);
    if (!b) return PDYN_NO_MEMORY;
    b->context = context, b->type = type, b->params = def->params;
    b->view.body = def->body, b->view.neighbours = def->neighbours;
    rows_set_grain(b, type->rows, (double)type->rows * type->width);
    b->view.elements = type->update ? 0 : type->elements(def->params, def->body);
    pdyn_status status = PDYN_OK;
    if (b->view.elements < 0 || b->view.elements > MAX_ROWS) {
        status = rows_fault(b, "it has %d elements, expected 0 to %d", b->view.elements, MAX_ROWS);
        b->view.elements = 0;
    } else if (type->update) start_dynamic(b);
    else status = rows ? create_rows(b) : create_operator(b, def->services);
    if (status == PDYN_OK) return status;
    batch_free(b);
    *out = NULL;
    return status;
}

pdyn_status batch_create(pdyn_context *context, const struct batch_def *def, struct batch **out) {
    return create(context, def, !def->type->matrix_free, out);
}

pdyn_status batch_create_rows(const struct batch *b, struct batch **out) {
    const struct batch_def def = {b->type, b->params, b->view.body, b->view.neighbours, NULL};
    return create(b->context, &def, true, out);
}

static bool is_linear(const struct batch *b) {
    return b->type->linear && b->type->linear(b->params, &b->view);
}

pdyn_status batch_join_rows(struct batch *b) {
    if (b->op || !is_linear(b)) return PDYN_OK;
    return linear_rows_create(b->context, b, &b->linear);
}

/* ---- other parameters ------------------------------------------------------------------------ */

/* Whether the elements and their rows are those that the batch has. */
static bool has_same_rows(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    if (b->type->elements(b->params, v->body) != v->elements) return false;
    for (int e = 0; e < v->elements; e++) {
        int rows, width, first = v->element_row[e];
        rows_of_element(b, e, &rows, &width);
        if (rows != v->element_row[e + 1] - first) return false;
        if (rows && width != v->row_entry[first + 1] - v->row_entry[first]) return false;
    }
    return true;
}

/* A hash of what solvers keep of the rows: G and the weights, but for those of a damper, which
 * follow from the weights of the other batch, the damping and the step. */
static uint64_t hash_rows(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    uint64_t hash = HASH_BEGIN;
    hash = hash_bytes(hash, v->column, (size_t)b->entries * sizeof *v->column);
    hash = hash_bytes(hash, v->coefficient, (size_t)b->entries * sizeof *v->coefficient);
    return b->damper ? hash : hash_bytes(hash, v->weight, (size_t)v->elements * sizeof *v->weight);
}

static bool has_changed(const struct batch *b, uint64_t before) {
    if (hash_rows(b) != before) return true;
    return b->damper ? b->type->damping(b->params) != b->damping
                     : is_linear(b) != (b->linear != NULL);
}

static pdyn_status join_again(struct batch *b) {
    linear_rows_free(b->linear);
    b->linear = NULL;
    pdyn_status status = index_rows(b);
    return status == PDYN_OK && !b->damper ? batch_join_rows(b) : status;
}

void batch_make_damper(struct batch *b) {
    b->damper = true, b->damping = b->type->damping(b->params);
}

pdyn_status batch_refresh(struct batch *b, bool *changed) {
    pdyn_batch *v = &b->view;
    if (b->op) b->type->matrix_free->set_params(b->op, b->params), *changed = true;
    if (!batch_is_static(b)) return PDYN_OK;
    if (!has_same_rows(b))
        return rows_fault(b, "it has other elements with this value than the scene gave it");
    uint64_t before = hash_rows(b);
    b->type->select(b->params, v, 0, v->elements);
    if (!type_weighs_in_steps(b->type)) rows_weigh(b, 0, v->elements);
    if (!has_changed(b, before)) return PDYN_OK;
    *changed = true;
    if (b->damper) b->damping = b->type->damping(b->params);
    return join_again(b);
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
    FREE_ARRAY(c, b->lumped, b->one_sided.particles);
    rows_free(b);
    row_memory_free(c, &b->memory, b->type->memory_size);
    linear_rows_free(b->linear);
    FREE_ARRAY(c, b->touch_start, b->touch_room + 2);
    if (b->view.scratch)
        context_resize(c, b->view.scratch, (size_t)b->view.body->count * b->type->scratch_size, 0);
    FREE_ARRAY(c, b, 1);
}
