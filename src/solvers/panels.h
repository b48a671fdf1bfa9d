/* The factor of a sparse symmetric matrix, L L' = P A P', in a layout of our own, for solves with
 * three right-hand sides at once: x, y and z of every particle, padded to four lanes.
 *
 * A panel is a supernode: neighbouring columns of L that share the rows below, [D; R]. It is kept
 * as T = [D^-1; -R D^-1], so that each substitution is one product, with T or T', in which nothing
 * waits for a division; in tiles of four rows, column by column, so that both read it in order.
 *
 * Subtrees of the elimination tree are independent: the larger ones are tasks that run in parallel.
 * What they give to rows of the rest, the top, goes to places of their own and is added up in the
 * order of the tasks. The split belongs to the matrix, hence the same bits for any number of
 * threads. */
#ifndef PDYN_PANELS_H
#define PDYN_PANELS_H

#include "base/context.h"

#include <suitesparse/cholmod.h>

enum { TILE = 4 }; /* rows */
enum {
    PANELS_WORTH = 50000
}; /* numbers of a factor that has tasks; a panel of the top is shared
      above a quarter of it */

struct panel {
    int first, columns; /* its columns of L */
    int rows, row;      /* how many below; the first of these in `place` */
    int parent;         /* the panel of its first row below, or -1 */
    size_t value;       /* its first number in `value` */
};

struct task {                 /* a subtree or a few */
    int first, last;          /* panels */
    int outside, outside_end; /* its places for rows of the top */
};

struct panels {
    pdyn_context *context;
    int columns, panels, rows, places, tasks, tops;
    int widest; /* columns of a panel at most */
    size_t values;
    int *particle;       /* columns: whose each is */
    struct panel *panel; /* panels, children first */
    int *place;          /* rows: where in `work` */
    int *column_of;      /* columns + rows; places of them used: the column that each stands for */
    struct task *task;   /* panels; tasks of them used, in the order of their panels */
    int *top;            /* panels; tops of them used: those in no task */
    double *value;       /* values: all T */
    double *work;        /* places x 4: the vector, then what tasks give to the top */
    double *scratch;     /* (tasks + 1) x widest x 4: a panel's part of the vector */
};

/* Takes the layout of a supernodal factor; frees what was there. */
pdyn_status panels_build(struct panels *panels, pdyn_context *context,
                         const cholmod_factor *factor);
/* Takes its numbers. */
pdyn_status panels_fill(struct panels *panels, const cholmod_factor *factor);
/* y = A^-1 b, both columns x 3 in the order of the particles; they may be one. */
void panels_solve(struct panels *panels, const double *b, double *y);
void panels_free(struct panels *panels);

/* ---- tiles ----------------------------------------------------------------------------------- */

static inline int tiles_of(int rows) { return (rows + TILE - 1) / TILE; }

/* Tiles of a panel: of the triangle D^-1 first, these have no columns right of it. */
static inline int panel_tiles(const struct panel *p) {
    return tiles_of(p->columns) + tiles_of(p->rows);
}

static inline int tile_columns(const struct panel *p, int tile) {
    return TILE * (tile + 1) < p->columns ? TILE * (tile + 1) : p->columns;
}

/* Numbers before a tile. */
static inline size_t tile_start(const struct panel *p, int tile) {
    size_t triangle = (size_t)(p->columns + TILE - 1) / TILE, t = (size_t)tile;
    if (t < triangle) return TILE * TILE / 2 * t * (t + 1);
    return TILE * TILE / 2 * triangle * (triangle - 1) +
           TILE * (size_t)p->columns * (t - triangle + 1);
}

static inline size_t panel_values(const struct panel *p) { return tile_start(p, panel_tiles(p)); }

#endif
