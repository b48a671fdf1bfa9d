/* The constant stiffness matrix K = sum of w G' G of a batch whose rows are linear
 * (pdyn_constraint_type.linear), stored by particles: a product reads memory once, rows twice. */
#ifndef PDYN_LINEAR_ROWS_H
#define PDYN_LINEAR_ROWS_H

#include "base/context.h"
#include "projdyn/module.h"

struct batch;

struct linear_rows {
    pdyn_context *context;
    int first, count; /* particles of the system with entries in K */
    int entries;
    int *start;       /* count + 1: first entry of each particle */
    int *column;      /* entries: another particle of the system */
    double *value;    /* entries: K_ij */
    double *own;      /* count: sum of the row of K, K_ii included */
    double *diagonal; /* count: K_ii */
    double *partial;  /* energy of each parallel block */
};

/* The matrix of a batch whose rows are filled. PDYN_NO_MEMORY: *out is NULL. */
pdyn_status linear_rows_create(pdyn_context *context, const struct batch *batch,
                               struct linear_rows **out);
void linear_rows_free(struct linear_rows *rows); /* NULL: does nothing */

/* y += K x */
void linear_rows_apply(struct linear_rows *rows, const double *x, double *y);
/* Returns x . K x / 2, summed from differences between neighbours against cancellation; y += K x.
 */
double linear_rows_energy(struct linear_rows *rows, const double *x, double *y);
/* Adds K_ii to the blocks, packed xx xy xz yy yz zz, particles x 6. */
void linear_rows_diagonal(const struct linear_rows *rows, double *blocks);

#endif
