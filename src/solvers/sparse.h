/* Sparse matrix of floats in compressed rows (CSR), with transpose and product: the setup of the
 * coarse space uses it. */
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
    struct entry *entry; /* entries of each row, in any order */
};

/* counts: rows, the number of entries of each row; entries are zeroed. PDYN_NO_MEMORY. */
pdyn_status sparse_create(struct sparse *matrix, const pdyn_services *services, int rows,
                          int columns, const int *counts);
void sparse_free(struct sparse *matrix); /* zeroed is fine */

/* out = a'; columns ascend in every row. PDYN_NO_MEMORY. */
pdyn_status sparse_transpose(const struct sparse *a, struct sparse *out);
/* out = a b without entries whose absolute value is at most `least`. PDYN_NO_MEMORY. */
pdyn_status sparse_multiply(const struct sparse *a, const struct sparse *b, float least,
                            struct sparse *out);

#endif
