/* Within rows/: loops over the rows of a batch. A vector of particles x becomes u = G x, and the
 * flux of the rows, w (u - p) or B u, goes back to the particles by G'. */
#ifndef PDYN_ROW_LOOPS_H
#define PDYN_ROW_LOOPS_H

#include "base/pool.h"
#include "projdyn/simd.h"
#include "row_arrays.h"

#include <string.h>

enum {
    ROWS_PIECE = 256,   /* elements of one call of a callback: they stay in the L1 cache */
    ROWS_ENTRIES = 4096 /* of the particles of a parallel block, about */
};

struct row_loop { /* the arguments of a parallel loop */
    struct batch *batch;
    const double *in; /* of a loop over elements: particles x 3 */
    double *out;      /* of a loop over particles: particles x 3, or x 6 */
};

/* Calls fn for all elements. */
static inline void rows_for_elements(struct batch *batch, pdyn_range_fn *fn, const double *in) {
    struct row_loop loop = {.batch = batch, .in = in};
    pool_for(batch->context->pool, batch->view.elements, batch->grain, fn, &loop);
}

/* Calls fn for all particles that rows may select. */
static inline void rows_for_particles(struct batch *batch, pdyn_range_fn *fn, double *out) {
    struct row_loop loop = {.batch = batch, .out = out};
    int count = batch->touch_count, blocks = batch->entries / ROWS_ENTRIES + count / ROWS_ENTRIES;
    pool_for(batch->context->pool, count, count / (blocks + 1) + 1, fn, &loop);
}

/* u = sum over `width` entries from k on */
INLINE void gather_entries(const pdyn_batch *v, int k, int width, const double *x, v4 *u) {
    *u = (v4){0};
    for (int end = k + width; k < end; k++) {
        v4 at;
        memcpy(&at, x + 3 * (size_t)v->column[k], sizeof at);
        *u += v->coefficient[k] * at;
    }
}

/* u of row r; the loop over two entries is unrolled */
INLINE void gather_row(const struct batch *b, int r, const double *x, v4 *u) {
    const int *entry = b->view.row_entry + r;
    if (b->width == 2) gather_entries(&b->view, 2 * r, 2, x, u);
    else gather_entries(&b->view, entry[0], entry[1] - entry[0], x, u);
}

/* row_local.c: u, p and the flux w (u - p) of all rows at x. Returns their energy, J. */
double rows_project(struct batch *batch, const double *x);
/* y += G' flux */
void rows_scatter(struct batch *batch, double *y);
/* A step begins: rest shapes and weights of a damper; `begin` of a type that has it, and weights.
 */
void rows_begin_damper(struct batch *batch, const struct step_start *start);
void rows_begin(struct batch *batch, const struct step_start *start);

/* dynamic_rows.c: calls the type's `update` at x and v (particles x 3; v NULL in a local step),
 * then `select`, and `weight` where the type has no `begin`. PDYN_BAD_INPUT: the type gave a row
 * that it must not give. */
pdyn_status rows_update(struct batch *batch, const double *x, const double *v);

/* row_tangent.c: B of all elements at the last local step, for the eps of the batch. */
pdyn_status rows_linearise(struct batch *batch);
/* flux = B G u */
void rows_multiply(struct batch *batch, const double *u);

/* row_diagonal.c: adds the 3 x 3 block diagonal of G' B G. */
void rows_diagonal(struct batch *batch, double *blocks);

/* row_impacts.c: force += the impact part of the flux of all rows. Returns the number of rows with
 * an impact. */
int rows_impacts(struct batch *batch, const struct velocity_change *change, double *force);
/* Flux times the kept part, of the rows in which solids have a part. */
void rows_keep_impacts(struct batch *batch, const double *kept);
/* y += G' flux of the rows that tie particles to particles alone: their forces sum to zero. */
void rows_scatter_between(const struct batch *batch, double *y);
/* Joins the particles of each row from `first` on, before `last` (base/groups.h). */
void rows_join(const struct batch *batch, int first, int last, int *group);
/* The same of each row between particles alone that has a flux. */
void rows_join_between(const struct batch *batch, int *group);

#endif
