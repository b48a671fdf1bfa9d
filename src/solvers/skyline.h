/* A small symmetric positive definite matrix in rows, each from its first entry to the diagonal:
 * where the order of the unknowns keeps entries near the diagonal, its Cholesky factor has the same
 * room, and all loops run along rows. */
#ifndef PDYN_SKYLINE_H
#define PDYN_SKYLINE_H

#include "../core/context.h"

struct skyline {
    pdyn_context *context;
    int rows;
    int *first;    /* rows: the first column of each */
    size_t *start; /* rows + 1: where its entries begin, up to the diagonal */
    double *value;
};

/* Takes the first column of every row; all values are 0. */
pdyn_status skyline_create(struct skyline *skyline, pdyn_context *context, int rows,
                           const int *first);
void skyline_free(struct skyline *skyline);

/* The entry of row i and column j, first[i] <= j <= i. */
static inline double *skyline_at(const struct skyline *s, int i, int j) {
    return s->value + s->start[i] + (size_t)(j - s->first[i]);
}

/* A becomes L, with the inverse of its diagonal. false: A was not positive definite; then that is 0
 * where there was no pivot. */
bool skyline_factor(struct skyline *skyline);
/* x = A^-1 x, with the factor */
void skyline_solve(const struct skyline *skyline, double *x);

#endif
