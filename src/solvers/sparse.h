/* A small sparse matrix of floats, by rows: what interpolation and coarse levels are built of. */
#ifndef PDYN_SPARSE_H
#define PDYN_SPARSE_H

#include "projdyn/module.h"

struct entry {
    int column;
    float value;
};

struct sparse {
    const pdyn_services *services;
    int rows, columns;
    size_t room;         /* of `entry` */
    int *start;          /* rows + 1 */
    struct entry *entry; /* those of each row, in no order */
};

/* Takes the number of entries of every row, which are 0 then. Frees nothing. */
pdyn_status sparse_create(struct sparse *matrix, const pdyn_services *services, int rows,
                          int columns, const int *counts);
void sparse_free(struct sparse *matrix); /* zeroed is fine */

/* Columns ascend. */
pdyn_status sparse_transpose(const struct sparse *a, struct sparse *out);
/* out = a b, but for entries of at most `least`. */
pdyn_status sparse_multiply(const struct sparse *a, const struct sparse *b, float least,
                            struct sparse *out);

#endif
