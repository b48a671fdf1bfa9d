/* Rows: the 3 x 3 block diagonal of G' B G, particle by particle. */
#include "row_loops.h"

#include "projdyn/vec3.h"

/* Adds the contribution of entry k to the block of its particle: its pairs with those entries of
 * the same element that select the same particle. */
static void diagonal_of_entry(const struct batch *b, int k, double *block) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const pdyn_batch *v = &b->view;
    int e = b->entry_element[k], r0 = v->element_row[e], r1 = v->element_row[e + 1];
    if (!batch_has_blocks(b)) r0 = b->entry_row[k], r1 = r0 + 1; /* B = w I */
    for (int m = v->row_entry[r0]; m < v->row_entry[r1]; m++) {
        if (v->column[m] != v->column[k]) continue;
        double B[9], c = v->coefficient[k] * v->coefficient[m];
        batch_block(b, k, m, B);
        for (int a = 0; a < 6; a++) block[a] += c * B[3 * row[a] + column[a]];
    }
}

static void diagonal_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++)
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++)
            diagonal_of_entry(b, b->touch[t].entry, c->out + 6 * (size_t)(b->touch_first + i));
}

/* Adds to the blocks of particles [first, last) where each element is a row that selects no
 * particle twice. */
WIDE static void diagonal_single(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i), zz = 0.0, plain = 0.0;
        v4 low = {0}, high = {0}, part;
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            const struct touch *at = &b->touch[t];
            double square = at->coefficient * at->coefficient;
            if (!batch_has_blocks(b)) {
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

/* As diagonal_single, for B = m m' + a I. */
WIDE static void diagonal_axes(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i), zz = 0.0, plain = 0.0;
        v4 x = {0}, y = {0}, B;
        for (int t = b->touch_start[i]; t < b->touch_start[i + 1]; t++) {
            double square = b->touch[t].coefficient * b->touch[t].coefficient;
            v4_load(&B, b->block, b->touch[t].row);
            x += square * B[0] * B, y += square * B[1] * B;
            zz += square * B[2] * B[2], plain += square * B[3];
        }
        out[0] += x[0] + plain, out[1] += x[1], out[2] += x[2];
        out[3] += y[1] + plain, out[4] += y[2], out[5] += zz + plain;
    }
}

/* As diagonal_axes, for elements of any number of rows: the entries of a particle in an element
 * have the sum m of their parts of m, and add m m'. */
static void diagonal_wide(void *arg, int first, int last, int block) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double *out = c->out + 6 * (size_t)(b->touch_first + i);
        for (int t = b->touch_start[i], end = b->touch_start[i + 1]; t < end;) {
            int e = b->entry_element[b->touch[t].entry], r0 = b->view.element_row[e];
            double m[3] = {0}, plain = 0.0;
            for (; t < end && b->entry_element[b->touch[t].entry] == e; t++) {
                double k = b->touch[t].coefficient;
                vec3_add(m, k, b->block + b->block_start[e] + 3 * (b->touch[t].row - r0));
                plain += k * k * b->block[b->block_start[e + 1] - 1];
            }
            for (int a = 0; a < 6; a++)
                out[a] += m[row[a]] * m[column[a]] + (row[a] == column[a] ? plain : 0.0);
        }
    }
}

/* The function that adds the blocks of a range of particles. */
static pdyn_range_fn *diagonal_of(const struct batch *b) {
    if (b->wide && batch_has_blocks(b)) return diagonal_wide;
    if (!b->single) return diagonal_rows;
    return b->type->tangent_rank1 && batch_has_blocks(b) ? diagonal_axes : diagonal_single;
}

void rows_diagonal(struct batch *b, double *blocks) {
    rows_for(b, b->touch_count, ROWS_PARTICLES, diagonal_of(b), NULL, blocks, 0.0);
}
