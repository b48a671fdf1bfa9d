/* H as a sparse matrix (assembly.h) that is kept up to date with the objective: pattern and values
 * are computed again when they have changed. A matrix-free constraint is assembled from its rows,
 * which a second batch, its replica, holds. */
#ifndef PDYN_HESSIAN_MATRIX_H
#define PDYN_HESSIAN_MATRIX_H

#include "assembly.h"

struct hessian_matrix {
    pdyn_context *context;
    struct objective *objective;
    struct batch **rows; /* batches: the batch itself, or the replica of a matrix-free one */
    double *unused;      /* particles x 3: gradients of replicas */
    struct matrix matrix;
    unsigned lists_revision;   /* of the neighbour lists, */
    unsigned revision;         /* and of the rows, that the pattern belongs to */
    double h;                  /* s: length of the step, */
    unsigned weights_revision; /* and of weights, that the values belong to; h = 0: none */
};

pdyn_status hessian_matrix_create(struct hessian_matrix *hessian, struct objective *objective);
void hessian_matrix_free(struct hessian_matrix *hessian);

/* Updates the matrix to the last linearisation. *pattern, *values: what has changed since the call
 * before. */
pdyn_status hessian_matrix_update(struct hessian_matrix *hessian, bool *pattern, bool *values);

#endif
