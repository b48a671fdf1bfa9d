/* Skyline storage of a small symmetric positive definite matrix of 3 x 3 blocks: every block row
 * from its first nonzero block to the diagonal. The Cholesky factor fits into the same storage
 * (George and Liu 1981), and all loops run along rows. Used for the coarse matrix, which is
 * factored several times in a step: for 1378 nodes of a sheet in 5 ms, where CHOLMOD takes 32 to
 * 52 ms. */
#ifndef PDYN_BLOCK_SKYLINE_H
#define PDYN_BLOCK_SKYLINE_H

#include "projdyn/module.h"

struct skyline {
    const pdyn_services *services;
    int nodes;         /* block rows */
    int *first;        /* nodes: first block column of each block row; ascending */
    size_t *start;     /* nodes + 1: index of the first block of each block row */
    ptrdiff_t *origin; /* nodes x 3: offset in `value` of column 0 of each scalar row */
    double *value;     /* block rows of three scalar rows each, up to the end of the diagonal block;
                          numbers above the diagonal are ignored */
    float *factor;     /* L as solves read it, in the same places */
};

/* first: the first block column of every block row; it is lowered where a later row begins earlier.
 * All values are 0. PDYN_NO_MEMORY. */
pdyn_status skyline_create(struct skyline *skyline, const pdyn_services *services, int nodes,
                           const int *first);
void skyline_free(struct skyline *skyline);

/* Row p of block row i, beginning at its first block. */
static inline double *skyline_row(const struct skyline *s, int i, int p) {
    return s->value + 9 * s->start[i] + (size_t)p * 3 * (size_t)(i - s->first[i] + 1);
}

/* Block (i, j), j from first[i] to i: its index in the order of the blocks; its row p. */
static inline size_t skyline_block(const struct skyline *s, int i, int j) {
    return s->start[i] + (size_t)(j - s->first[i]);
}
static inline double *skyline_block_row(const struct skyline *s, int i, int j, int p) {
    return skyline_row(s, i, p) + 3 * (j - s->first[i]);
}

/* Replaces A by its Cholesky factor L, with the inverse of L's diagonal. false: A is not positive
 * definite; the inverse is 0 for pivots that are not positive. */
bool skyline_factor(struct skyline *skyline);
/* x = A^-1 x, with the factor in single precision; nodes x 3 */
void skyline_solve(const struct skyline *skyline, double *x);

#endif
