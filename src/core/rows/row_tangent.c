/* Rows: B = w ((1 - eps)(I - J) + eps I) of each element, and the product with it. */
#include "numeric_tangent.h"
#include "row_loops.h"

#include <math.h>

enum { NUMERIC_GRAIN = 4 }; /* elements: one takes some microseconds */

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
    struct batch *b = arg;
    for (int e = first, end; e < last; e = end) {
        end = last - e > ROWS_PIECE ? e + ROWS_PIECE : last;
        double *J = b->block + b->block_start[e];
        memset(J, 0, (b->block_start[end] - b->block_start[e]) * sizeof *J);
        b->type->tangent(b->params, &b->view, e, end, J);
        damp_blocks(b, e, end, b->eps);
    }
}

/* B = m m' + a I from J = s I - a a', in place of it: 4 numbers of each element, which has one row.
 */
WIDE static void damp_rank1(struct batch *b, int first, int last, double eps) {
    double *B = b->block + b->block_start[first], root[ROWS_PIECE];
    const double *w = b->view.weight + first;
    for (int k = 0; k < last - first; k++) root[k] = sqrt((1.0 - eps) * w[k]);
    for (int k = 0; k < last - first; k++, B += 4) {
        for (int a = 0; a < 3; a++) B[a] *= root[k];
        B[3] = w[k] * (1.0 - (1.0 - eps) * B[3]);
    }
}

/* As damp_rank1, for elements of any number of rows. */
static void damp_wide(struct batch *b, int first, int last, double eps) {
    for (int e = first; e < last; e++) {
        double w = b->view.weight[e], *B = b->block + b->block_start[e];
        size_t n = b->block_start[e + 1] - b->block_start[e] - 1;
        for (size_t k = 0; k < n; k++) B[k] *= sqrt((1.0 - eps) * w);
        B[n] = w * (1.0 - (1.0 - eps) * B[n]);
    }
}

static void linearise_numeric(void *arg, int first, int last, int block) {
    (void)block;
    struct batch *b = arg;
    for (int e = first; e < last; e++) tangent_numeric(b, e, b->block + b->block_start[e]);
    damp_blocks(b, first, last, b->eps);
}

static void linearise_rank1(void *arg, int first, int last, int block) {
    (void)block;
    struct batch *b = arg;
    for (int e = first, end; e < last; e = end) {
        end = last - e > ROWS_PIECE ? e + ROWS_PIECE : last;
        b->type->tangent_rank1(b->params, &b->view, e, end, b->block + b->block_start[e]);
        (b->wide ? damp_wide : damp_rank1)(b, e, end, b->eps);
    }
}

size_t rows_block_numbers(const struct batch *b) { return b->block_start[b->room.elements] + 1; }

pdyn_status rows_linearise(struct batch *b) {
    if (!batch_has_blocks(b) || !b->rows) return PDYN_OK;
    if (!b->block) b->block = NEW_ARRAY(b->context, rows_block_numbers(b), double);
    if (!b->block) return PDYN_NO_MEMORY;
    bool numeric = b->type->flags & PDYN_NUMERIC_TANGENT;
    pdyn_range_fn *linearise = numeric                  ? linearise_numeric
                               : b->type->tangent_rank1 ? linearise_rank1
                                                        : linearise_rows;
    pool_for(b->context->pool, b->view.elements, numeric ? NUMERIC_GRAIN : b->grain, linearise, b);
    return PDYN_OK;
}

/* flux = B u for element e, which has `rows` rows from `first` on; B = w I for eps = 1 */
INLINE void multiply_element(const struct batch *b, int e, int first, int rows, const double *x) {
    double *flux = b->flux + 4 * (size_t)first;
    const double *B = batch_has_blocks(b) ? b->block + b->block_start[e] : NULL;
    for (int s = 0; s < rows; s++) {
        v4 u, f, column;
        gather_row(b, first + s, x, &u);
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

/* flux = B u for element e of one row with B = m m' + a I */
INLINE void multiply_rank1(const struct batch *b, int e, const double *x) {
    v4 u, f, B;
    gather_row(b, e, x, &u);
    v4_load(&B, b->block, e);
    f = v4_dot(&B, &u) * B + B[3] * u;
    v4_store(b->flux, e, &f);
}

WIDE static void apply_rank1(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    for (int e = first; e < last; e++) multiply_rank1(c->batch, e, c->in);
}

/* flux = B u for element e with B = m m' + a I */
INLINE void multiply_wide(const struct batch *b, int e, const double *x) {
    int first = b->view.element_row[e], last = b->view.element_row[e + 1];
    const double *m = b->block + b->block_start[e], a = m[3 * (size_t)(last - first)];
    v4 along = {0};
    for (int r = first; r < last; r++) {
        v4 u, part;
        gather_row(b, r, x, &u);
        memcpy(&part, m + 3 * (size_t)(r - first), sizeof part);
        along += part * u;
        u *= a;
        v4_store(b->flux, r, &u);
    }
    double dot = along[0] + along[1] + along[2];
    for (int r = first; r < last; r++) {
        v4 part;
        memcpy(&part, m + 3 * (size_t)(r - first), sizeof part);
        v4_add_to(b->flux + 4 * (size_t)r, &(v4){dot * part[0], dot * part[1], dot * part[2]});
    }
}

WIDE static void apply_wide(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    for (int e = first; e < last; e++) multiply_wide(c->batch, e, c->in);
}

WIDE static void apply_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int e = first; e < last; e++)
        if (b->single) multiply_element(b, e, e, 1, c->in);
        else {
            int r = b->view.element_row[e], rows = b->view.element_row[e + 1] - r;
            if (rows == 2) multiply_element(b, e, r, 2, c->in); /* unrolled */
            else if (rows == 3) multiply_element(b, e, r, 3, c->in);
            else multiply_element(b, e, r, rows, c->in);
        }
}

static pdyn_range_fn *apply_of(const struct batch *b) {
    if (!b->type->tangent_rank1 || !batch_has_blocks(b)) return apply_rows;
    return b->wide ? apply_wide : apply_rank1;
}

void rows_multiply(struct batch *b, const double *u) { rows_for_elements(b, apply_of(b), u); }

void batch_block(const struct batch *b, int k, int m, double B[9]) {
    int e = b->entry_element[k], first = b->view.element_row[e];
    int row = 3 * (b->entry_row[k] - first), column = 3 * (b->entry_row[m] - first);
    int n = 3 * (b->view.element_row[e + 1] - first);
    const double *own = batch_has_blocks(b) ? b->block + b->block_start[e] : NULL;
    for (int i = row; i < row + 3; i++)
        for (int j = column; j < column + 3; j++) {
            double part = 0.0;
            if (!own) part = i == j ? b->view.weight[e] : 0.0; /* w I */
            else if (!b->type->tangent_rank1) part = own[i * n + j];
            else part = own[i] * own[j] + (i == j ? own[n] : 0.0); /* m m' + a I */
            B[3 * (i - row) + j - column] = part;
        }
}
