#include "batch.h"

#include "simd.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ELEMENTS = 2048, PARTICLES = 1024 }; /* grains: worth waking a thread for */
enum { PIECE = 256 };                       /* elements of a local step at once */

struct call { /* the arguments of a parallel loop over a batch */
    struct batch *batch;
    const double *in;
    double *out;
    double number; /* eps, or the length of a step */
};

static void for_range(struct batch *batch, int count, int grain, pdyn_range_fn *fn,
                      const double *in, double *out, double number) {
    struct call call = {batch, in, out, number};
    pool_for(batch->context->pool, count, grain, fn, &call);
}

/* ---- what goes through an operator: vectors that end with the samples' values ---------------- */

static const double *extend(const struct batch *b, const double *u) {
    if (!b->samples) return u;
    samples_extend(b->samples, u, b->samples->input);
    return b->samples->input;
}

/* Where an operator adds to y, until it is gathered. */
static double *begin_output(const struct batch *b, double *y) {
    if (!b->samples) return y;
    memset(b->samples->output, 0, 3 * (size_t)b->scalars.particles * sizeof *y);
    return b->samples->output;
}

static void end_output(const struct batch *b, double *y) {
    if (b->samples) samples_gather(b->samples, b->samples->output, y);
}

/* ---- the rows: u = G x, flux -> particles ---------------------------------------------------- */

/* u of row r, which begins with entry k and has so many */
INLINE void gather_row(const pdyn_batch *v, int k, int width, const double *x, v4 *u) {
    *u = (v4){0};
    for (int end = k + width; k < end; k++) {
        v4 at;
        memcpy(&at, x + 3 * (size_t)v->column[k], sizeof at);
        *u += v->coefficient[k] * at;
    }
}

WIDE static void gather_rows(const struct batch *b, int first, int last, const double *x) {
    const pdyn_batch *v = &b->view;
    for (int r = first; r < last; r++) {
        v4 u;
        if (b->width == 2) gather_row(v, 2 * r, 2, x, &u);
        else gather_row(v, v->row_entry[r], v->row_entry[r + 1] - v->row_entry[r], x, &u);
        memcpy((double *)v->u + 3 * (size_t)r, &u, 3 * sizeof(double));
    }
}

/* out += G' flux, by particles, so that no two threads write to one place */
WIDE static void scatter_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        v4 sum = {0};
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            v4 flux;
            memcpy(&flux, b->flux + 4 * (size_t)b->touch[t].row, sizeof flux);
            sum += b->touch[t].coefficient * flux;
        }
        v4_add_to(c->out + 3 * (size_t)(b->touch_first + i), &sum);
    }
}

/* ---- local step ------------------------------------------------------------------------------ */

/* flux = w (u - p) in row r; adds to twice the energy. */
INLINE void pull_row(const struct batch *b, int r, double w, v4 *energy) {
    v4 u, p, f; /* their fourth lanes mean nothing */
    memcpy(&u, b->view.u + 3 * (size_t)r, sizeof u);
    memcpy(&p, b->view.p + 3 * (size_t)r, sizeof p);
    u -= p;
    f = w * u;
    *energy += f * u;
    memcpy(b->flux + 4 * (size_t)r, &f, sizeof f);
}

/* Returns the energy. */
WIDE static double pull_rows(struct batch *b, int first, int last) {
    const pdyn_batch *v = &b->view;
    v4 energy = {0};
    for (int e = first; e < last; e++)
        if (b->single) pull_row(b, e, v->weight[e], &energy);
        else
            for (int r = v->element_row[e]; r < v->element_row[e + 1]; r++)
                pull_row(b, r, v->weight[e], &energy);
    return 0.5 * (energy[0] + energy[1] + energy[2]);
}

/* In pieces whose u, p and flux stay in the first cache. */
static void local_rows(void *arg, int first, int last, int block) {
    const struct call *c = arg;
    struct batch *b = c->batch;
    const pdyn_batch *v = &b->view;
    double energy = 0.0;
    for (int e = first, end; e < last; e = end) {
        end = last - e > PIECE ? e + PIECE : last;
        gather_rows(b, v->element_row[e], v->element_row[end], c->in);
        b->type->project(b->params, v, e, end);
        double squares = pull_rows(b, e, end);
        energy += b->type->energy ? b->type->energy(b->params, v, e, end) : squares;
    }
    b->partial[block] = energy;
}

pdyn_status batch_local(struct batch *b, const double *x, double time, double *gradient) {
    b->view.time = time;
    if (b->op) {
        b->energy = b->type->op->local(b->op, x, begin_output(b, gradient));
        end_output(b, gradient);
        return scalars_begin(&b->scalars);
    }
    b->energy = 0.0;
    if (b->stiffness) {
        b->energy = stiffness_apply(b->stiffness, x, gradient);
        return PDYN_OK;
    }
    for_range(b, b->view.elements, ELEMENTS, local_rows, x, NULL, 0.0);
    for (int k = 0; k < pool_blocks(b->view.elements, ELEMENTS); k++) b->energy += b->partial[k];
    for_range(b, b->touch_count, PARTICLES, scatter_rows, NULL, gradient, 0.0);
    return PDYN_OK;
}

/* ---- the beginning of a step ----------------------------------------------------------------- */

static void hold_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    gather_rows(b, b->view.element_row[first], b->view.element_row[last], c->in);
    b->type->hold(b->params, &b->view, first, last);
}

static void weigh_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    double part = b->type->damping(b->params) / c->number;
    b->type->weight(b->params, &b->view, first, last);
    for (int e = first; e < last; e++) b->view.weight[e] *= part;
}

void batch_weigh(struct batch *b, double h) {
    if (b->damper) for_range(b, b->view.elements, ELEMENTS, weigh_rows, NULL, NULL, h);
}

/* in: x; out: v */
static void begin_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    int row = b->view.element_row[first], end = b->view.element_row[last];
    gather_rows(b, row, end, c->out);
    memcpy(b->view.p + 3 * (size_t)row, b->view.u + 3 * (size_t)row,
           3 * (size_t)(end - row) * sizeof(double));
    gather_rows(b, row, end, c->in);
    b->type->begin(b->params, &b->view, first, last);
    b->type->weight(b->params, &b->view, first, last);
}

bool batch_begin(struct batch *b, const double *x, const double *v, double h) {
    b->view.h = h;
    if (b->damper) for_range(b, b->view.elements, ELEMENTS, hold_rows, x, NULL, 0.0);
    batch_weigh(b, h);
    if (!b->damper && b->type->begin)
        for_range(b, b->view.elements, ELEMENTS, begin_rows, x, (double *)v, 0.0);
    return !b->damper && b->type->begin;
}

/* ---- tangent --------------------------------------------------------------------------------- */

/* B = w (I - (1 - eps) J), in place of J, n x n numbers */
INLINE void damp_block(double *B, int n, double w, double eps) {
    for (int k = 0; k < n * n; k++) B[k] *= -w * (1.0 - eps);
    for (int k = 0; k < n; k++) B[k * n + k] += w;
}

WIDE static void damp_blocks(struct batch *b, int first, int last, double eps) {
    const pdyn_batch *v = &b->view;
    for (int e = first; e < last; e++) {
        int rows = v->element_row[e + 1] - v->element_row[e];
        double *B = b->block + b->block_start[e];
        if (rows == 1) damp_block(B, 3, v->weight[e], eps);
        else damp_block(B, 3 * rows, v->weight[e], eps);
    }
}

static void linearise_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    struct batch *b = c->batch;
    for (int e = first, end; e < last; e = end) {
        end = last - e > PIECE ? e + PIECE : last;
        double *J = b->block + b->block_start[e];
        memset(J, 0, (b->block_start[end] - b->block_start[e]) * sizeof *J);
        if (b->type->tangent) b->type->tangent(b->params, &b->view, e, end, J);
        damp_blocks(b, e, end, c->number);
    }
}

/* With room to load the last column as four. */
static size_t block_numbers(const struct batch *b) { return b->block_start[b->room.elements] + 1; }

/* The components of its rows are not independent: B is not w I. */
INLINE bool has_blocks(const struct batch *b) { return b->eps < 1.0 && !b->stiffness; }

pdyn_status batch_linearise(struct batch *b, double eps) {
    b->eps = eps;
    if (b->op || !has_blocks(b) || !b->rows) return PDYN_OK;
    if (!b->block) b->block = NEW_ARRAY(b->context, block_numbers(b), double);
    if (!b->block) return PDYN_NO_MEMORY;
    for_range(b, b->view.elements, ELEMENTS, linearise_rows, NULL, NULL, eps);
    return PDYN_OK;
}

/* flux = B u for element e, of so many rows from `first` on; B = w I for eps = 1 */
INLINE void multiply_element(const struct batch *b, int e, int first, int rows, const double *x) {
    const int *entry = b->view.row_entry + first;
    double *flux = b->flux + 4 * (size_t)first;
    const double *B = has_blocks(b) ? b->block + b->block_start[e] : NULL;
    for (int s = 0; s < rows; s++) {
        v4 u, f, column;
        if (b->width == 2) gather_row(&b->view, 2 * (first + s), 2, x, &u);
        else gather_row(&b->view, entry[s], entry[s + 1] - entry[s], x, &u);
        for (int r = 0; r < rows; r++) {
            if (s) memcpy(&f, flux + 4 * r, sizeof f);
            else f = (v4){0};
            if (!B && r == s) f += b->view.weight[e] * u;
            for (int a = 0; B && a < 3; a++) { /* B is symmetric: a row is a column */
                memcpy(&column, B + 3 * (3 * s + a) * rows + 3 * r, sizeof column);
                f += u[a] * column;
            }
            memcpy(flux + 4 * r, &f, sizeof f);
        }
    }
}

WIDE static void apply_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int e = first; e < last; e++)
        if (b->single) multiply_element(b, e, e, 1, c->in);
        else {
            int r = b->view.element_row[e];
            multiply_element(b, e, r, b->view.element_row[e + 1] - r, c->in);
        }
}

void batch_apply(struct batch *b, const double *u, double *y) {
    if (b->op) {
        scalars_apply(&b->scalars, b->eps, extend(b, u), begin_output(b, y));
        end_output(b, y);
        return;
    }
    if (b->stiffness) {
        stiffness_apply(b->stiffness, u, y);
        return;
    }
    for_range(b, b->view.elements, ELEMENTS, apply_rows, u, NULL, 0.0);
    for_range(b, b->touch_count, PARTICLES, scatter_rows, NULL, y, 0.0);
}

void batch_aim(struct batch *b, const double *u, double *y) {
    if (b->op) {
        scalars_aim(&b->scalars, b->eps, extend(b, u), begin_output(b, y));
        end_output(b, y);
    } else batch_apply(b, u, y);
}

double batch_slope(struct batch *b, double t, double *curvature) {
    *curvature = 0.0;
    return b->op ? scalars_slope(&b->scalars, b->eps, t, curvature) : 0.0;
}

int batch_go(struct batch *b, double t, double *y) {
    if (!b->op) return 0;
    int changed = scalars_go(&b->scalars, b->eps, t, begin_output(b, y));
    end_output(b, y);
    return changed;
}

void batch_velocity(struct batch *b, double *v) {
    if (!b->op || !b->type->op->velocity) return;
    if (!b->samples) {
        b->type->op->velocity(b->op, v);
        return;
    }
    samples_extend(b->samples, v, b->samples->input);
    b->type->op->velocity(b->op, b->samples->input);
    memcpy(v, b->samples->input, 3 * (size_t)b->samples->particles * sizeof *v);
}

void batch_block(const struct batch *b, int k, int m, double B[9]) {
    int e = b->entry_element[k], r0 = b->view.element_row[e],
        n = 3 * (b->view.element_row[e + 1] - r0);
    bool same = b->entry_row[k] == b->entry_row[m];
    const double *from = has_blocks(b)
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
            diagonal_of_entry(b, b->touch[t].entry, c->out + 6 * (size_t)(b->touch_first + i));
}

/* The same where an element is a row that selects no particle twice. */
WIDE static void diagonal_single(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i), zz = 0.0, plain = 0.0;
        v4 low = {0}, high = {0}, part;
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            const struct touch *at = &b->touch[t];
            double square = at->coefficient * at->coefficient;
            if (!has_blocks(b)) {
                plain += b->view.weight[at->row] * square;
                continue;
            }
            const double *B = b->block + 9 * (size_t)at->row;
            memcpy(&part, B, sizeof part), low += square * part;
            memcpy(&part, B + 4, sizeof part), high += square * part;
            zz += square * B[8];
        }
        out[0] += low[0] + plain, out[1] += low[1], out[2] += low[2];
        out[3] += high[0] + plain, out[4] += high[1], out[5] += zz + plain;
    }
}

void batch_diagonal(struct batch *b, double *blocks) {
    if (b->op && b->samples) {
        memset(b->samples->blocks, 0, 6 * (size_t)b->scalars.particles * sizeof *blocks);
        scalars_diagonal(&b->scalars, b->eps, b->samples->blocks);
        samples_gather_blocks(b->samples, b->samples->blocks, blocks);
    } else if (b->op) scalars_diagonal(&b->scalars, b->eps, blocks);
    else if (b->stiffness) stiffness_diagonal(b->stiffness, blocks);
    else
        for_range(b, b->touch_count, PARTICLES, b->single ? diagonal_single : diagonal_rows, NULL,
                  blocks, 0.0);
}

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

/* Rows select particles of their body; those that know neighbours, of the whole system. */
static pdyn_status check_rows(const struct batch *b) {
    const pdyn_batch *v = &b->view;
    const pdyn_neighbours *l = v->neighbours;
    int low = l ? 0 : v->body->first;
    int high = l ? l->particles - l->samples : v->body->first + v->body->count;
    for (int k = 0; k < b->entries; k++) {
        if (v->column[k] < low || v->column[k] >= high)
            return fault(b, "element %d selects particle %d, expected %d to %d",
                         b->entry_element[k], v->column[k], low, high - 1);
        if (!isfinite(v->coefficient[k]))
            return fault(b, "element %d has a coefficient that is not finite", b->entry_element[k]);
    }
    for (int e = 0; e < v->elements && !b->type->begin; e++) /* begin weighs anew, by h */
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
        if (t->shape) t->shape(b->params, v, e, &n, &width);
        if (n < 0 || width < 0)
            return fault(b, "element %d has %d rows of %d entries", e, n, width);
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
    return 1 + (size_t)b->room.elements * b->type->data_size;
}

/* Where an element's block begins, and what each entry belongs to. */
static void number_rows(struct batch *b) {
    const pdyn_batch *v = &b->view;
    for (int e = 0; e < b->room.elements; e++) {
        size_t n = 3 * (size_t)(v->element_row[e + 1] - v->element_row[e]);
        b->block_start[e + 1] = b->block_start[e] + n * n;
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
    int *row_entry = NEW_ARRAY(c, rows + 1, int);
    v->row_entry = row_entry;
    for (int r = 0; row_entry && r < rows; r++)
        row_entry[r + 1] = row_entry[r] + (row_width ? row_width[r] : b->width);
    v->column = NEW_ARRAY(c, entries, int);
    v->coefficient = NEW_ARRAY(c, entries, double);
    v->weight = NEW_ARRAY(c, elements, double);
    v->data = context_array(c, 1, data_bytes(b));
    v->u = NEW_VECTOR(c, rows);
    v->p = NEW_VECTOR(c, rows);
    b->flux = NEW_ARRAY(c, 4 * (size_t)rows, double);
    b->partial = NEW_ARRAY(c, pool_blocks(elements, ELEMENTS), double);
    b->block_start = NEW_ARRAY(c, elements + 1, size_t);
    b->entry_element = NEW_ARRAY(c, entries, int);
    b->entry_row = NEW_ARRAY(c, entries, int);
    b->touch = NEW_ARRAY(c, entries, struct touch);
    bool good =
        row_entry && v->data && b->block_start && (!elements || (v->weight && b->partial)) &&
        (!rows || (v->u && v->p && b->flux)) &&
        (!entries || (v->column && v->coefficient && b->entry_element && b->entry_row && b->touch));
    if (good) number_rows(b);
    return good;
}

static void free_rows(struct batch *b) {
    pdyn_context *c = b->context;
    pdyn_batch *v = &b->view;
    int elements = b->room.elements, rows = b->room.rows, entries = b->room.entries;
    if (b->block_start) FREE_ARRAY(c, b->block, block_numbers(b));
    if (v->data) v->data = context_resize(c, v->data, data_bytes(b), 0);
    FREE_ARRAY(c, v->element_row, elements + 1);
    FREE_ARRAY(c, v->row_entry, rows + 1);
    FREE_ARRAY(c, v->column, entries);
    FREE_ARRAY(c, v->coefficient, entries);
    FREE_ARRAY(c, v->weight, elements);
    FREE_VECTOR(c, v->u, rows);
    FREE_VECTOR(c, v->p, rows);
    FREE_ARRAY(c, b->flux, 4 * (size_t)rows);
    FREE_ARRAY(c, b->partial, pool_blocks(elements, ELEMENTS));
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
void batch_index(struct batch *b) {
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
    b->type->weight(b->params, v, 0, v->elements);
    status = check_rows(b);
    if (status != PDYN_OK) return status;
    b->single = is_single(v), b->width = common_width(v, b->rows);
    status = find_touched(b);
    if (status == PDYN_OK) batch_index(b);
    return status;
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
    if (b->view.elements < 0)
        status = fault(b, "it has %d elements", b->view.elements), b->view.elements = 0;
    else if (!type->op || rows_only) status = create_rows(b);
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

pdyn_status batch_join_rows(struct batch *b) {
    if (b->op || !b->type->linear || !b->type->linear(b->params, &b->view)) return PDYN_OK;
    return stiffness_create(b->context, b, &b->stiffness);
}

/* ---- elements that come and go --------------------------------------------------------------- */

pdyn_status batch_create_changing(pdyn_context *context, const pdyn_constraint_type *type,
                                  const void *params, const pdyn_body *body, struct batch **out) {
    struct batch *b = *out = NEW_ARRAY(context, 1, struct batch);
    if (!b) return PDYN_NO_MEMORY;
    b->context = context, b->type = type, b->params = params, b->view.body = body;
    b->changing = b->single = true, b->width = type->width;
    b->touch_first = body->first, b->touch_count = body->count;
    b->touch_start = NEW_ARRAY(context, b->touch_count + 2, int);
    if (b->touch_start) return PDYN_OK;
    batch_free(b);
    *out = NULL;
    return PDYN_NO_MEMORY;
}

static pdyn_status make_room(struct batch *b, int elements) {
    int *element_row;
    free_rows(b);
    b->room.elements = b->room.rows = elements, b->room.entries = elements * b->width;
    b->view.element_row = element_row = NEW_ARRAY(b->context, elements + 1, int);
    for (int e = 0; element_row && e < elements; e++) element_row[e + 1] = e + 1;
    if (element_row && allocate_rows(b, NULL)) return PDYN_OK;
    return context_no_memory(b->context);
}

pdyn_status batch_resize(struct batch *b, int elements) {
    b->view.elements = b->rows = elements, b->entries = elements * b->width;
    if (elements <= b->room.elements) return PDYN_OK;
    if (elements > INT32_MAX / 16)
        return context_fail(b->context, PDYN_BAD_INPUT, "constraint \"%s\": too many rows",
                            b->type->name);
    pdyn_status status = make_room(b, elements + elements / 2);
    if (status != PDYN_OK) b->view.elements = b->rows = b->entries = 0;
    return status;
}

pdyn_status batch_neighbours(struct batch *b, const pdyn_neighbours *neighbours) {
    if (b->op && !b->type->op->neighbours(b->op, neighbours)) return context_no_memory(b->context);
    return PDYN_OK;
}

void batch_free(struct batch *b) {
    if (!b) return;
    pdyn_context *c = b->context;
    if (b->op) b->type->op->free(b->op), scalars_free(&b->scalars);
    free_rows(b);
    stiffness_free(b->stiffness);
    FREE_ARRAY(c, b->touch_start, b->touch_count + 2);
    FREE_ARRAY(c, b, 1);
}
