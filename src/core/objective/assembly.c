#include "assembly.h"

#include <string.h>

/* Called for every ordered pair of entries (k, m) of an element that contributes to the lower
 * triangle: k's particle is not before m's; where dim is 1, both are in the same row. */
typedef void visit_fn(struct matrix *matrix, const struct batch *b, int k, int m);

static void visit_pairs(struct matrix *matrix, const struct batch *b, visit_fn *visit) {
    const pdyn_batch *v = &b->view;
    for (int k = 0; k < b->entries; k++) {
        int e = b->entry_element[k], r = b->entry_row[k];
        int first = v->row_entry[matrix->dim == 1 ? r : v->element_row[e]];
        int last = v->row_entry[matrix->dim == 1 ? r + 1 : v->element_row[e + 1]];
        for (int m = first; m < last; m++)
            if (v->column[k] >= v->column[m]) visit(matrix, b, k, m);
    }
}

static void visit_batches(struct matrix *matrix, const struct objective *objective,
                          struct batch *const *rows, visit_fn *visit) {
    for (int b = 0; b < objective->batches; b++)
        if (rows[b]) visit_pairs(matrix, rows[b], visit);
}

/* ---- pattern --------------------------------------------------------------------------------- */

static void count_pair(struct matrix *matrix, const struct batch *b, int k, int m) {
    (void)k;
    matrix->block_start[b->view.column[m] + 1]++;
}

static void store_pair(struct matrix *matrix, const struct batch *b, int k, int m) {
    matrix->block_row[matrix->block_start[b->view.column[m]]++] = b->view.column[k];
}

/* Inserts `row` into ascending rows, unless it is there. */
static void insert_row(int *rows, int *count, int row) {
    int low = 0, high = *count;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (rows[middle] < row) low = middle + 1;
        else high = middle;
    }
    if (low < *count && rows[low] == row) return;
    memmove(rows + low + 1, rows + low, (size_t)(*count - low) * sizeof *rows);
    rows[low] = row, ++*count;
}

/* Sorts every column and merges repeated blocks. On entry, block_start is shifted by one column. */
static void merge_blocks(struct matrix *matrix) {
    int from = 0, kept = 0;
    for (int j = 0; j < matrix->particles; j++) {
        int end = matrix->block_start[j], count = 0, *rows = matrix->block_row + kept;
        for (int k = from; k < end; k++) insert_row(rows, &count, matrix->block_row[k]);
        matrix->block_start[j] = kept;
        kept += count, from = end;
    }
    matrix->block_start[matrix->particles] = kept;
}

static pdyn_status find_blocks(struct matrix *matrix, const struct objective *objective,
                               struct batch *const *rows) {
    int n = matrix->particles;
    matrix->block_start = NEW_ARRAY(matrix->context, n + 1, int);
    if (!matrix->block_start) return PDYN_NO_MEMORY;
    for (int i = 0; i < n; i++) matrix->block_start[i + 1] = 1; /* the diagonal */
    visit_batches(matrix, objective, rows, count_pair);
    size_t blocks = 0;
    for (int i = 0; i < n; i++) {
        blocks += (size_t)matrix->block_start[i + 1];
        if (blocks * (size_t)matrix->dim * (size_t)matrix->dim > INT32_MAX)
            return set_error(
                PDYN_SOLVER_FAILED,
                "the matrix of this scene has more than 2^31 entries; use solver \"cg\"");
        matrix->block_start[i + 1] = (int)blocks;
    }
    matrix->capacity = blocks;
    matrix->block_row = NEW_ARRAY(matrix->context, blocks, int);
    if (!matrix->block_row) return PDYN_NO_MEMORY;
    for (int i = 0; i < n; i++) matrix->block_row[matrix->block_start[i]++] = i;
    visit_batches(matrix, objective, rows, store_pair);
    merge_blocks(matrix);
    return PDYN_OK;
}

pdyn_status matrix_pattern(struct matrix *matrix, const struct objective *objective,
                           struct batch *const *rows, int dim) {
    matrix_free(matrix);
    matrix->context = objective->context, matrix->particles = objective->particles,
    matrix->dim = dim;
    pdyn_status status = find_blocks(matrix, objective, rows);
    if (status != PDYN_OK) return status;
    matrix->entries = (size_t)matrix->block_start[matrix->particles] * (size_t)(dim * dim);
    matrix->column_start = NEW_ARRAY(objective->context, dim * objective->particles + 1, int);
    matrix->row = NEW_ARRAY(objective->context, matrix->entries, int);
    matrix->value = NEW_ARRAY(objective->context, matrix->entries, double);
    if (!matrix->column_start || !matrix->row || !matrix->value) return PDYN_NO_MEMORY;
    int *row = matrix->row;
    for (int c = 0; c < dim * objective->particles; c++) {
        for (int k = matrix->block_start[c / dim]; k < matrix->block_start[c / dim + 1]; k++)
            for (int a = 0; a < dim; a++) *row++ = dim * matrix->block_row[k] + a;
        matrix->column_start[c + 1] = (int)(row - matrix->row);
    }
    return PDYN_OK;
}

void matrix_free(struct matrix *matrix) {
    if (!matrix->context) return;
    FREE_ARRAY(matrix->context, matrix->row, matrix->entries);
    FREE_ARRAY(matrix->context, matrix->value, matrix->entries);
    FREE_ARRAY(matrix->context, matrix->column_start, matrix->dim * matrix->particles + 1);
    FREE_ARRAY(matrix->context, matrix->block_row, matrix->capacity);
    FREE_ARRAY(matrix->context, matrix->block_start, matrix->particles + 1);
    *matrix = (struct matrix){0};
}

/* ---- values ---------------------------------------------------------------------------------- */

/* Position in its column of the block (i, j). */
static int find_block(const struct matrix *matrix, int i, int j) {
    int low = matrix->block_start[j], high = matrix->block_start[j + 1];
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (matrix->block_row[middle] <= i) low = middle;
        else high = middle;
    }
    return low - matrix->block_start[j];
}

static void add_pair(struct matrix *matrix, const struct batch *b, int k, int m) {
    int dim = matrix->dim, i = b->view.column[k], j = b->view.column[m],
        block = find_block(matrix, i, j);
    double *column = matrix->value + matrix->column_start[dim * j] + dim * block;
    double B[9], c = b->view.coefficient[k] * b->view.coefficient[m];
    if (dim == 1) {
        *column += c * b->view.weight[b->entry_element[k]];
        return;
    }
    batch_block(b, k, m, B);
    for (int q = 0; q < dim; q++) {
        column = matrix->value + matrix->column_start[dim * j + q] + dim * block;
        for (int p = 0; p < dim; p++) column[p] += c * B[3 * p + q];
    }
}

void matrix_values(struct matrix *matrix, const struct objective *objective,
                   struct batch *const *rows, bool inertia) {
    memset(matrix->value, 0, matrix->entries * sizeof *matrix->value);
    for (int c = 0; inertia && c < matrix->dim * matrix->particles; c++)
        matrix->value[matrix->column_start[c] + c % matrix->dim] = /* the diagonal block is first */
            objective_inertia(objective, c / matrix->dim);
    visit_batches(matrix, objective, rows, add_pair);
}
