/* Points sorted into the cells of a uniform grid. Cells are hashed, so that the domain has no
 * bounds; memory goes with the number of points. */
#ifndef PDYN_GRID_H
#define PDYN_GRID_H

#include "context.h"

struct grid {
    double cell; /* m, edge of a cell */
    int capacity, points;
    int buckets;  /* a power of two, at least the capacity */
    int *start;   /* buckets + 1: first point of each bucket in the sorted arrays */
    int *id;      /* points: what was sorted, ascending within a bucket */
    double *x[3]; /* points each */
    int *bucket;  /* points: scratch of the sort, in the order given */
};

enum { GRID_RANGE = 1 << 20 }; /* cells from the origin in each direction */

pdyn_status grid_create(pdyn_context *context, int capacity, double cell, struct grid *grid);
void grid_free(pdyn_context *context, struct grid *grid);

/* Sorts the points `id` (NULL: 0, 1, ...) of x. PDYN_DIVERGED: one is not finite or out of range.
 */
pdyn_status grid_sort(pdyn_context *context, struct grid *grid, int points, const int *id,
                      const double *x);

static inline uint64_t grid_key(int i, int j, int k) {
    return ((uint64_t)(i + 2 * GRID_RANGE) << 44) | ((uint64_t)(j + 2 * GRID_RANGE) << 22) |
           (uint64_t)(k + 2 * GRID_RANGE);
}
static inline int grid_bucket(const struct grid *grid, uint64_t key) {
    key *= 0x9E3779B97F4A7C15u;
    return (int)(key >> 33) & (grid->buckets - 1);
}

/* The cells within one of the cell of a point, as slots of the sorted arrays. Two cells that share
 * a bucket are one range: distances tell their points apart. */
struct grid_cells {
    uint64_t key; /* of the cell in the middle */
    int count, first[27], last[27];
};

/* The cells around `at`; kept where `cells` already are these. Start with a key of 0. */
void grid_around(const struct grid *grid, const double *at, struct grid_cells *cells);

/* Writes to `list` the ids of the points closer than `radius` <= cell to `at`, a point of the cell
 * in the middle, without `self` and, where `keep` is given, without those whose keep[id] is false.
 * Returns how many there are; the first `room` of them are written, and one place more is used. */
int grid_query(const struct grid *grid, const struct grid_cells *cells, const double *at,
               double radius, int self, const bool *keep, int *list, int room);

#endif
