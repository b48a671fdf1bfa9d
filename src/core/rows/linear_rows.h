/* The stiffness K = sum of w G' G of a batch that is linear (pdyn_constraint_type.linear), by
 * particles: one pass over memory where rows would take two. */
#ifndef PDYN_LINEAR_ROWS_H
#define PDYN_LINEAR_ROWS_H

#include "base/context.h"
#include "projdyn/module.h"

struct batch;

struct linear_rows {
    pdyn_context *context;
    int first, count; /* particles of the system that it touches */
    int entries;
    int *start;       /* count + 1: the entries of each */
    int *column;      /* entries: another particle of the system */
    double *value;    /* entries: K_ij */
    double *own;      /* count: the sum of the row, K_ii and all */
    double *diagonal; /* count: K_ii */
    double *partial;  /* an energy for each parallel block */
};

/* Of a batch whose rows are known. */
pdyn_status linear_rows_create(pdyn_context *context, const struct batch *batch,
                               struct linear_rows **out);
void linear_rows_free(struct linear_rows *stiffness); /* NULL is fine */

/* y += K x */
void linear_rows_apply(struct linear_rows *stiffness, const double *x, double *y);
/* Returns x.K x / 2, summed as differences of neighbours are; y += K x. */
double linear_rows_energy(struct linear_rows *stiffness, const double *x, double *y);
/* Adds K_ii to the blocks, packed xx xy xz yy yz zz, particles x 6. */
void linear_rows_diagonal(const struct linear_rows *stiffness, double *blocks);

#endif
