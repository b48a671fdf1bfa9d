/* A small symmetric positive definite matrix of 3 x 3 blocks, in block rows from the first block of
 * each to the diagonal: where the order of the unknowns keeps blocks near the diagonal, its
 * Cholesky factor has the same room, and all loops run along rows. */
#ifndef PDYN_BLOCK_SKYLINE_H
#define PDYN_BLOCK_SKYLINE_H

#include "projdyn/module.h"

struct skyline {
    const pdyn_services *services;
    int nodes;         /* block rows */
    int *first;        /* nodes: the first block column of each; those of later rows are no lower */
    size_t *start;     /* nodes + 1: which block is the first one of each, up to the diagonal */
    ptrdiff_t *origin; /* nodes x 3: where column 0 of each row would be in `value` */
    double *value; /* block rows, each of them three rows up to the end of the diagonal block; what
                      is beyond the diagonal counts for nothing */
};

/* Takes the first block column of every block row, or an earlier one; all values are 0. */
pdyn_status skyline_create(struct skyline *skyline, const pdyn_services *services, int nodes,
                           const int *first);
void skyline_free(struct skyline *skyline);

/* Numbers in `value`. */
static inline size_t skyline_size(const struct skyline *s) { return 9 * s->start[s->nodes]; }

/* Row p of block row i, beginning at its first block. */
static inline double *skyline_row(const struct skyline *s, int i, int p) {
    return s->value + 9 * s->start[i] + (size_t)p * 3 * (size_t)(i - s->first[i] + 1);
}

/* A becomes L, with the inverse of its diagonal. false: A was not positive definite; then that is 0
 * where there was no pivot. */
bool skyline_factor(struct skyline *skyline);
/* x = A^-1 x, with the factor; nodes x 3 */
void skyline_solve(const struct skyline *skyline, double *x);

#endif
