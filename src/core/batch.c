#include "batch.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { ELEMENTS = 2048, PARTICLES = 1024 }; /* grains: worth waking a thread for */

struct call { /* the arguments of a parallel loop over a batch */
    struct batch *batch;
    const double *in;
    double *out;
    double eps;
};

static void for_range(struct batch *batch, int count, int grain, pdyn_range_fn *fn,
                      const double *in, double *out, double eps) {
    struct call call = {batch, in, out, eps};
    pool_for(batch->context->pool, count, grain, fn, &call);
}

/* ---- the rows: u = G x, flux -> particles ---------------------------------------------------- */

static void gather_rows(const struct batch *b, int first, int last, const double *x, double *u) {
    for (int r = first; r < last; r++) {
        double sum[3] = {0};
        for (int k = b->view.row_entry[r]; k < b->view.row_entry[r + 1]; k++)
            vec3_add(sum, b->view.coefficient[k], x + 3 * b->view.column[k]);
        memcpy(u + 3 * r, sum, sizeof sum);
    }
}

/* out += G' flux, by particles, so that no two threads write to one place */
static void scatter_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++)
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            int k = b->touch_entry[t];
            vec3_add(c->out + 3 * (b->touch_first + i), b->view.coefficient[k],
                     b->flux + 3 * b->entry_row[k]);
        }
}

/* ---- local step ------------------------------------------------------------------------------ */

static void local_rows(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct batch *b = c->batch;
    const pdyn_batch *v = &b->view;
    double energy = 0.0;
    gather_rows(b, v->element_row[first], v->element_row[last], c->in, (double *)v->u);
    b->type->project(b->params, v, first, last);
    for (int e = first; e < last; e++)
        for (int r = 3 * v->element_row[e]; r < 3 * v->element_row[e + 1]; r++) {
            double d = v->u[r] - v->p[r];
            b->flux[r] = v->weight[e] * d;
            energy += 0.5 * v->weight[e] * d * d;
        }
    b->partial[block] = energy;
}

pdyn_status batch_local(struct batch *b, const double *x, double time, double *gradient) {
    b->view.time = time;
    if (b->op) {
        b->energy = b->type->op->local(b->op, x, gradient);
        return scalars_begin(&b->scalars);
    }
    for_range(b, b->view.elements, ELEMENTS, local_rows, x, NULL, 0.0);
    b->energy = 0.0;
    for (int k = 0; k < pool_blocks(b->view.elements, ELEMENTS); k++) b->energy += b->partial[k];
    for_range(b, b->touch_count, PARTICLES, scatter_rows, NULL, gradient, 0.0);
    return PDYN_OK;
}

/* ---- tangent --------------------------------------------------------------------------------- */

static void linearise_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    double *J = b->block + b->block_start[first];
    size_t size = b->block_start[last] - b->block_start[first];
    memset(J, 0, size * sizeof *J);
    if (b->type->tangent) b->type->tangent(b->params, &b->view, first, last, J);
    for (int e = first; e < last; e++) {
        int n = 3 * (b->view.element_row[e + 1] - b->view.element_row[e]);
        double *B = b->block + b->block_start[e], w = b->view.weight[e];
        for (int k = 0; k < n * n; k++) B[k] *= -w * (1.0 - c->eps);
        for (int k = 0; k < n; k++) B[k * n + k] += w;
    }
}

pdyn_status batch_linearise(struct batch *b, double eps) {
    b->eps = eps;
    if (b->op || eps == 1.0 || !b->rows) return PDYN_OK;
    if (!b->block) b->block = NEW_ARRAY(b->context, b->block_start[b->view.elements], double);
    if (!b->block) return PDYN_NO_MEMORY;
    for_range(b, b->view.elements, ELEMENTS, linearise_rows, NULL, NULL, eps);
    return PDYN_OK;
}

/* f = B u for element e, n numbers; B = w I for eps = 1 */
static void multiply_block(const struct batch *b, int e, int n, const double *u, double *f) {
    if (b->eps == 1.0) {
        for (int i = 0; i < n; i++) f[i] = b->view.weight[e] * u[i];
        return;
    }
    const double *B = b->block + b->block_start[e];
    for (int i = 0; i < n; i++) {
        f[i] = 0.0;
        for (int j = 0; j < n; j++) f[i] += B[i * n + j] * u[j];
    }
}

static void apply_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    gather_rows(b, b->view.element_row[first], b->view.element_row[last], c->in,
                (double *)b->view.u);
    for (int e = first; e < last; e++) {
        int r = b->view.element_row[e], n = 3 * (b->view.element_row[e + 1] - r);
        multiply_block(b, e, n, b->view.u + 3 * r, b->flux + 3 * r);
    }
}

void batch_apply(struct batch *b, const double *u, double *y) {
    if (b->op) {
        scalars_apply(&b->scalars, b->eps, u, y);
        return;
    }
    for_range(b, b->view.elements, ELEMENTS, apply_rows, u, NULL, 0.0);
    for_range(b, b->touch_count, PARTICLES, scatter_rows, NULL, y, 0.0);
}

void batch_aim(struct batch *b, const double *u, double *y) {
    if (b->op) scalars_aim(&b->scalars, b->eps, u, y);
    else batch_apply(b, u, y);
}

double batch_slope(struct batch *b, double t, double *curvature) {
    *curvature = 0.0;
    return b->op ? scalars_slope(&b->scalars, b->eps, t, curvature) : 0.0;
}

int batch_go(struct batch *b, double t, double *y) {
    return b->op ? scalars_go(&b->scalars, b->eps, t, y) : 0;
}

void batch_block(const struct batch *b, int k, int m, double B[9]) {
    int e = b->entry_element[k], r0 = b->view.element_row[e],
        n = 3 * (b->view.element_row[e + 1] - r0);
    bool same = b->entry_row[k] == b->entry_row[m];
    const double *from = b->eps < 1.0
                             ? b->block + b->block_start[e] + 3 * (b->entry_row[k] - r0) * n +
                                   3 * (b->entry_row[m] - r0)
                             : NULL;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            B[3 * i + j] = from ? from[i * n + j] : same && i == j ? b->view.weight[e] : 0.0;
}

/* ---- block diagonal -------------------------------------------------------------------------- */

/* What entry k adds to the block of its particle: its pairs with the entries of the same element
 * that select the same particle. */
static void diagonal_of_entry(const struct batch *b, int k, double *block) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const pdyn_batch *v = &b->view;
    int e = b->entry_element[k], r0 = v->element_row[e], r1 = v->element_row[e + 1];
    for (int m = v->row_entry[r0]; m < v->row_entry[r1]; m++) {
        if (v->column[m] != v->column[k]) continue;
        double B[9], c = v->coefficient[k] * v->coefficient[m];
        batch_block(b, k, m, B);
        for (int a = 0; a < 6; a++) block[a] += c * B[3 * row[a] + column[a]];
    }
}

static void diagonal_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++)
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++)
            diagonal_of_entry(b, b->touch_entry[t], c->out + 6 * (b->touch_first + i));
}

void batch_diagonal(struct batch *b, double *blocks) {
    if (b->op) scalars_diagonal(&b->scalars, b->eps, blocks);
    else for_range(b, b->touch_count, PARTICLES, diagonal_rows, NULL, blocks, 0.0);
}

/* ---- setting up ------------------------------------------------------------------------------ */

/* Counts rows and entries of every element. */
static pdyn_status shape_rows(struct batch *b, int *element_row, int **row_width) {
    const pdyn_constraint_type *t = b->type;
    pdyn_batch *v = &b->view;
    long rows = 0, entries = 0;
    for (int e = 0; e < v->elements; e++) {
        int n = t->rows, width = t->width;
        if (t->shape) t->shape(b->params, v, e, &n, &width);
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
        if (t->shape) t->shape(b->params, v, e, &n, &width);
        for (int r = element_row[e]; r < element_row[e + 1]; r++) (*row_width)[r] = width;
    }
    return PDYN_OK;
}

static size_t data_bytes(const struct batch *b) {
    return 1 + (size_t)b->view.elements * b->type->data_size;
}

static bool allocate_rows(struct batch *b, int *row_width) {
    pdyn_context *c = b->context;
    pdyn_batch *v = &b->view;
    int *row_entry = NEW_ARRAY(c, b->rows + 1, int);
    v->row_entry = row_entry;
    for (int r = 0; row_entry && r < b->rows; r++) row_entry[r + 1] = row_entry[r] + row_width[r];
    v->column = NEW_ARRAY(c, b->entries, int);
    v->coefficient = NEW_ARRAY(c, b->entries, double);
    v->weight = NEW_ARRAY(c, v->elements, double);
    v->data = context_array(c, 1, data_bytes(b));
    v->u = NEW_ARRAY(c, 3 * b->rows, double);
    v->p = NEW_ARRAY(c, 3 * b->rows, double);
    b->flux = NEW_ARRAY(c, 3 * b->rows, double);
    b->partial = NEW_ARRAY(c, pool_blocks(v->elements, ELEMENTS), double);
    b->block_start = NEW_ARRAY(c, v->elements + 1, size_t);
    b->entry_element = NEW_ARRAY(c, b->entries, int);
    b->entry_row = NEW_ARRAY(c, b->entries, int);
    b->touch_entry = NEW_ARRAY(c, b->entries, int);
    if (!b->block_start) return false;
    for (int e = 0; e < v->elements; e++) {
        size_t n = 3 * (size_t)(v->element_row[e + 1] - v->element_row[e]);
        b->block_start[e + 1] = b->block_start[e] + n * n;
    }
    return row_entry && v->data && (!v->elements || (v->weight && b->partial)) &&
           (!b->rows || (v->u && v->p && b->flux)) &&
           (!b->entries ||
            (v->column && v->coefficient && b->entry_element && b->entry_row && b->touch_entry));
}

/* The transpose of G: for every particle the entries that select it. */
static pdyn_status transpose_rows(struct batch *b) {
    const pdyn_batch *v = &b->view;
    int low = INT32_MAX, high = -1;
    for (int e = 0; e < v->elements; e++)
        for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++)
            for (int k = v->row_entry[r]; k < v->row_entry[r + 1]; k++) {
                b->entry_element[k] = e, b->entry_row[k] = r;
                if (v->column[k] < low) low = v->column[k];
                if (v->column[k] > high) high = v->column[k];
            }
    b->touch_first = b->entries ? low : 0;
    b->touch_count = b->entries ? high - low + 1 : 0;
    b->touch_start = NEW_ARRAY(b->context, b->touch_count + 2, int);
    if (!b->touch_start) return PDYN_NO_MEMORY;
    int *end = b->touch_start + 1; /* shifted by one, so that filling turns ends into starts */
    for (int k = 0; k < b->entries; k++) end[v->column[k] - low + 1]++;
    for (int i = 0; i < b->touch_count; i++) end[i + 1] += end[i];
    for (int k = 0; k < b->entries; k++) b->touch_entry[end[v->column[k] - low]++] = k;
    return PDYN_OK;
}

static pdyn_status create_rows(struct batch *b) {
    pdyn_batch *v = &b->view;
    int *row_width = NULL, *element_row = NEW_ARRAY(b->context, v->elements + 1, int);
    v->element_row = element_row;
    if (!element_row) return PDYN_NO_MEMORY;
    pdyn_status status = shape_rows(b, element_row, &row_width);
    if (status == PDYN_OK && !allocate_rows(b, row_width)) status = context_no_memory(b->context);
    FREE_ARRAY(b->context, row_width, b->rows);
    if (status != PDYN_OK) return status;
    b->type->select(b->params, v, 0, v->elements);
    b->type->weight(b->params, v, 0, v->elements);
    return transpose_rows(b);
}

pdyn_status batch_create(pdyn_context *context, const pdyn_constraint_type *type,
                         const void *params, const pdyn_body *body, const pdyn_services *services,
                         const pdyn_neighbours *neighbours, bool rows_only, struct batch **out) {
    struct batch *b = *out = NEW_ARRAY(context, 1, struct batch);
    if (!b) return PDYN_NO_MEMORY;
    b->context = context, b->type = type, b->params = params;
    b->view.body = body, b->view.neighbours = neighbours;
    b->view.elements = type->elements(params, body);
    pdyn_status status = PDYN_OK;
    if (!type->op || rows_only) status = create_rows(b);
    else if (!(b->op = type->op->create(params, body, services)))
        status = context_no_memory(context);
    else {
        b->scalars = (struct scalars){
            .context = context, .op = type->op, .self = b->op, .particles = neighbours->particles};
        status = batch_neighbours(b, neighbours);
    }
    if (status == PDYN_OK) return status;
    batch_free(b);
    *out = NULL;
    return status;
}

pdyn_status batch_neighbours(struct batch *b, const pdyn_neighbours *neighbours) {
    if (b->op && !b->type->op->neighbours(b->op, neighbours)) return context_no_memory(b->context);
    return PDYN_OK;
}

void batch_free(struct batch *b) {
    if (!b) return;
    pdyn_context *c = b->context;
    pdyn_batch *v = &b->view;
    if (b->op) b->type->op->free(b->op), scalars_free(&b->scalars);
    if (b->block_start) FREE_ARRAY(c, b->block, b->block_start[v->elements]);
    if (v->data) context_resize(c, v->data, data_bytes(b), 0);
    FREE_ARRAY(c, v->element_row, v->elements + 1);
    FREE_ARRAY(c, v->row_entry, b->rows + 1);
    FREE_ARRAY(c, v->column, b->entries);
    FREE_ARRAY(c, v->coefficient, b->entries);
    FREE_ARRAY(c, v->weight, v->elements);
    FREE_ARRAY(c, v->u, 3 * b->rows);
    FREE_ARRAY(c, v->p, 3 * b->rows);
    FREE_ARRAY(c, b->flux, 3 * b->rows);
    FREE_ARRAY(c, b->partial, pool_blocks(v->elements, ELEMENTS));
    FREE_ARRAY(c, b->block_start, v->elements + 1);
    FREE_ARRAY(c, b->entry_element, b->entries);
    FREE_ARRAY(c, b->entry_row, b->entries);
    FREE_ARRAY(c, b->touch_entry, b->entries);
    FREE_ARRAY(c, b->touch_start, b->touch_count + 2);
    FREE_ARRAY(c, b, 1);
}
