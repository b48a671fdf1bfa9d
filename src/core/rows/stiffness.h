/* The stiffness K = sum of w G' G of a batch that is linear (pdyn_constraint_type.linear), by
 * particles: one pass over memory where rows would take two. */
#ifndef PDYN_STIFFNESS_H
#define PDYN_STIFFNESS_H

#include "base/context.h"
#include "projdyn/module.h"

struct batch;

struct stiffness {
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
pdyn_status stiffness_create(pdyn_context *context, const struct batch *batch,
                             struct stiffness **out);
void stiffness_free(struct stiffness *stiffness); /* NULL is fine */

/* y += K x */
void stiffness_apply(struct stiffness *stiffness, const double *x, double *y);
/* Returns x.K x / 2, summed as differences of neighbours are; y += K x. */
double stiffness_energy(struct stiffness *stiffness, const double *x, double *y);
/* Adds K_ii to the blocks, packed xx xy xz yy yz zz, particles x 6. */
void stiffness_diagonal(const struct stiffness *stiffness, double *blocks);

#endif
