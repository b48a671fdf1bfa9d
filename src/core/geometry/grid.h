/* Points sorted into the cells of a uniform grid. Only cells with points are kept, sorted along x,
 * then y, then z: the domain has no bounds, memory goes with the number of points (88 bytes each),
 * and cells that are neighbours along x are one run of points. Where the box around all points has
 * few enough cells, a table says where each begins; otherwise it is searched for. */
#ifndef PDYN_GRID_H
#define PDYN_GRID_H

#include "base/context.h"

struct grid {
    double cell; /* m, edge of a cell: the reach */
    int capacity, points;
    int low[3];           /* a corner of the cells in use, one cell outside */
    int64_t pitch[2];     /* what a step along y and z adds to a key; along x it is 1 */
    int64_t keys;         /* of the box of these cells and one around it */
    int *id;              /* points: what was sorted */
    double *x[3];         /* points each */
    int cells;            /* with points in them */
    int64_t *key;         /* cells, ascending */
    int *start;           /* cells + 1: first point of each cell */
    int *table;           /* for each key, the first point of its cell or one after it; */
    bool tabled;          /* if there is room for all keys */
    int64_t *point_key;   /* points: scratch of the sort */
    int *order, *swapped; /* points: the same */
};

enum { GRID_RANGE = 1 << 29 }; /* cells from the origin in each direction */

/* reach: m, the largest radius that will be asked for. */
pdyn_status grid_create(pdyn_context *context, int capacity, double reach, struct grid *grid);
void grid_free(pdyn_context *context, struct grid *grid);

/* Sorts the points `id` (NULL: 0, 1, ...) of x. PDYN_DIVERGED: one is not finite or out of range.
 */
pdyn_status grid_sort(pdyn_context *context, struct grid *grid, int points, const int *id,
                      const double *x);

/* The cells within reach of a cell, as runs of points. Cells half as wide would have half as many
 * candidates, but each run costs more than these do. */
enum { GRID_RUNS = 3 * 3 };
struct grid_cells {
    bool known;
    int64_t key; /* of the cell in the middle */
    int first[GRID_RUNS], last[GRID_RUNS];
    int cell[GRID_RUNS]; /* where each run was found: the next is not far */
};

/* The cells around `at`; kept where `cells` already are these. Start with all 0. */
void grid_around(const struct grid *grid, const double *at, struct grid_cells *cells);

/* Writes to `list` the ids of the points closer than `radius` <= reach to `at`, a point of the cell
 * in the middle, without `self` and, where `keep` is given, without those whose keep[id] is false.
 * Returns how many there are; the first `room` of them are written, and one place more is used. */
int grid_query(const struct grid *grid, const struct grid_cells *cells, const double *at,
               double radius, int self, const bool *keep, int *list, int room);

#endif
