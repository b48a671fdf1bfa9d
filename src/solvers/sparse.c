#include "sparse.h"

#include "memory.h"

#include <math.h>
#include <string.h>

pdyn_status sparse_create(struct sparse *m, const pdyn_services *services, int rows, int columns,
                          const int *counts) {
    *m = (struct sparse){.services = services, .rows = rows, .columns = columns};
    m->start = NEW(services, rows + 1, int);
    if (!m->start) return PDYN_NO_MEMORY;
    for (int i = 0; i < rows; i++) m->start[i + 1] = m->start[i] + counts[i];
    m->room = (size_t)m->start[rows] + 1; /* an empty matrix has its entries, too */
    m->entry = NEW(services, m->room, struct entry);
    return m->entry ? PDYN_OK : PDYN_NO_MEMORY;
}

void sparse_free(struct sparse *m) {
    if (!m->services) return;
    FREE(m->services, m->entry, m->room);
    FREE(m->services, m->start, m->rows + 1);
    *m = (struct sparse){0};
}

pdyn_status sparse_transpose(const struct sparse *a, struct sparse *out) {
    int *counts = NEW(a->services, a->columns + 1, int);
    if (!counts) return PDYN_NO_MEMORY;
    for (int k = 0; k < a->start[a->rows]; k++) counts[a->entry[k].column]++;
    pdyn_status status = sparse_create(out, a->services, a->columns, a->rows, counts);
    if (status == PDYN_OK) {
        memcpy(counts, out->start, (size_t)a->columns * sizeof *counts);
        for (int i = 0; i < a->rows; i++)
            for (int k = a->start[i]; k < a->start[i + 1]; k++)
                out->entry[counts[a->entry[k].column]++] = (struct entry){i, a->entry[k].value};
    }
    FREE(a->services, counts, a->columns + 1);
    return status;
}

/* ---- the product ----------------------------------------------------------------------------- */

struct row { /* of a product: as it grows */
    int count;
    int *place; /* columns: where in `entry`, or -1 */
    struct entry *entry;
};

static void add_row(struct row *row, const struct sparse *b, int k, float scale) {
    for (int m = b->start[k]; m < b->start[k + 1]; m++) {
        int column = b->entry[m].column;
        if (row->place[column] < 0) {
            row->place[column] = row->count;
            row->entry[row->count++] = (struct entry){column, 0.0F};
        }
        row->entry[row->place[column]].value += scale * b->entry[m].value;
    }
}

/* Copies the entries above `least` to `to` (NULL: only counts them) and empties the row. Returns
 * their number. */
static int flush_row(struct row *row, float least, struct entry *to) {
    int kept = 0;
    for (int k = 0; k < row->count; k++) {
        row->place[row->entry[k].column] = -1;
        if (!(fabsf(row->entry[k].value) > least)) continue;
        if (to) to[kept] = row->entry[k];
        kept++;
    }
    row->count = 0;
    return kept;
}

/* counts: NULL; otherwise the numbers of entries of the rows are computed, and none is stored. */
static void multiply(const struct sparse *a, const struct sparse *b, float least, struct row *row,
                     int *counts, struct sparse *out) {
    for (int i = 0; i < a->rows; i++) {
        for (int k = a->start[i]; k < a->start[i + 1]; k++)
            add_row(row, b, a->entry[k].column, a->entry[k].value);
        if (counts) counts[i] = flush_row(row, least, NULL);
        else flush_row(row, least, out->entry + out->start[i]);
    }
}

pdyn_status sparse_multiply(const struct sparse *a, const struct sparse *b, float least,
                            struct sparse *out) {
    const pdyn_services *c = a->services;
    struct row row = {.place = NEW(c, b->columns, int), .entry = NEW(c, b->columns, struct entry)};
    int *counts = NEW(c, a->rows, int);
    pdyn_status status = (b->columns && (!row.place || !row.entry)) || (a->rows && !counts)
                             ? PDYN_NO_MEMORY
                             : PDYN_OK;
    if (status == PDYN_OK) {
        for (int j = 0; j < b->columns; j++) row.place[j] = -1;
        multiply(a, b, least, &row, counts, out);
        status = sparse_create(out, c, a->rows, b->columns, counts);
        if (status == PDYN_OK) multiply(a, b, least, &row, NULL, out);
    }
    FREE(c, row.place, b->columns);
    FREE(c, row.entry, b->columns);
    FREE(c, counts, a->rows);
    return status;
}
