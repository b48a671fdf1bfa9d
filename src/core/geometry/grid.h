/* A uniform grid for neighbour searches. Only cells that contain points are stored, sorted along x,
 * then y, then z. The domain is therefore unbounded, memory is proportional to the number of points
 * (88 bytes each), and cells adjacent along x form one contiguous run of points. If the bounding
 * box of the points has few enough cells, a table gives the first point of each cell; otherwise it
 * is found by search. */
#ifndef PDYN_GRID_H
#define PDYN_GRID_H

#include "base/context.h"

struct grid {
    double cell; /* m, edge of a cell: the largest search radius */
    int capacity, points;
    int low[3];       /* lowest cell in use, minus 1 along each axis */
    int64_t pitch[2]; /* difference of the keys of neighbouring cells along y and along z; along x
                         it is 1 */
    int64_t keys; /* number of cells in the bounding box of the cells in use, extended by one cell
                     on each side */
    int *id;      /* points: ids in the order of their cells */
    double *x[3]; /* points: coordinates in the same order, m */
    int cells;    /* number of cells that contain points */
    int64_t *key; /* cells: keys, ascending */
    int *start;   /* cells + 1: first point of each cell */
    int *table;   /* keys: first point of the cell, or of the next one that is not empty */
    bool tabled;  /* whether `table` is in use: there is room for all keys */
    int64_t *point_key;   /* points: scratch of the sort */
    int *order, *swapped; /* points: scratch of the sort */
};

enum { GRID_RANGE = 1 << 29 }; /* largest number of cells from the origin in each direction */

/* Allocates a grid for up to `capacity` points. reach: m, the largest search radius. */
pdyn_status grid_create(pdyn_context *context, int capacity, double reach, struct grid *grid);
void grid_free(pdyn_context *context, struct grid *grid);

/* Sorts the points id[0] ... id[points - 1] of x (id NULL: 0 ... points - 1) into cells.
 * PDYN_DIVERGED: a position is not finite or out of range. */
pdyn_status grid_sort(struct grid *grid, int points, const int *id, const double *x);

/* The 27 cells around a position, as nine runs of points. Cells half as wide give half as many
 * candidates, but the larger number of runs costs more than it saves. */
enum { GRID_RUNS = 3 * 3 };
struct grid_cells {
    bool known;
    int64_t key; /* key of the central cell */
    int first[GRID_RUNS], last[GRID_RUNS];
    int cell[GRID_RUNS]; /* index of the cell where each run was found: start of the next search */
};

/* Finds the cells around `at`, m. Does nothing if `cells` already holds them. `cells` must be
 * zeroed before the first call. */
void grid_update_cells(const struct grid *grid, const double *at, struct grid_cells *cells);

/* Finds the points closer than `radius` <= reach to `at`, a position in the central cell of
 * `cells`, without the id `self`. Returns the number of points found and writes the first `room` of
 * their ids to `list`, which needs space for room + 1. */
int grid_query(const struct grid *grid, const struct grid_cells *cells, const double *at,
               double radius, int self, int *list, int room);

/* Calls `visit` with the id of every point in the cells that a cube of half the edge `radius`
 * around `at`, m, touches, by ascending cell. */
typedef void grid_visit_fn(void *user, int id);
void grid_visit(const struct grid *grid, const double *at, double radius, grid_visit_fn *visit,
                void *user);

#endif
