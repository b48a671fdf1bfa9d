/* Rows: the 3 x 3 block diagonal of G' B G, particle by particle. */
#include "row_loops.h"

#include "projdyn/vec3.h"

static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};

/* Adds c (B + B') to a block, for the part B between two rows of an element whose block has n
 * columns. */
INLINE void add_symmetric(double *block, double c, const double *B, int n) {
    for (int a = 0; a < 6; a++)
        block[a] += c * (B[n * row[a] + column[a]] + B[n * column[a] + row[a]]);
}

/* Adds the part of element e, which a particle's entries touch[0] to touch[count - 1] select. */
INLINE void diagonal_of_element(const struct batch *b, int e, const struct touch *touch, int count,
                                double *block) {
    int first = b->view.element_row[e], n = 3 * (b->view.element_row[e + 1] - first);
    const double *B = batch_has_blocks(b) ? b->block + b->block_start[e] : NULL;
    for (int k = 0; k < count; k++)
        for (int m = 0; m <= k; m++) {
            int r = touch[k].row - first, s = touch[m].row - first;
            double c = touch[k].coefficient * touch[m].coefficient * (m < k ? 1.0 : 0.5);
            if (B) add_symmetric(block, c, B + 3 * r * n + 3 * s, n);
            else if (r == s) vec3_add_identity(block, 2.0 * c * b->view.weight[e]); /* B = w I */
        }
}

static void diagonal_rows(void *arg, int first, int last, int block) {
    (void)block;
    const struct row_loop *c = arg;
    const struct batch *b = c->batch;
    for (int i = first; i < last; i++) {
        double sum[6] = {0}, *out = c->out + 6 * (size_t)(b->touch_first + i);
        for (int t = b->touch_start[i], next; t < b->touch_start[i + 1]; t = next) {
            int e = b->entry_element[b->touch[t].entry];
            for (next = t + 1; next < b->touch_start[i + 1]; next++)
                if (b->entry_element[b->touch[next].entry] != e) break;
            diagonal_of_element(b, e, b->touch + t, next - t, sum);
        }
        for (int a = 0; a < 6; a++) out[a] += sum[a];
    }
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
WIDE static void diagonal_rank1(void *arg, int first, int last, int block) {
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

/* As diagonal_rank1, for elements of any number of rows: the entries of a particle in an element
 * have the sum m of their parts of m, and add m m'. */
static void diagonal_wide(void *arg, int first, int last, int block) {
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
    return b->type->tangent_rank1 && batch_has_blocks(b) ? diagonal_rank1 : diagonal_single;
}

void rows_diagonal(struct batch *b, double *blocks) {
    rows_for_particles(b, diagonal_of(b), blocks);
}
