/* H as a sparse matrix that follows the system (assembly.h): its pattern and values are made again
 * where they moved. A constraint with an operator of its own is assembled from its rows, which a
 * twin batch holds. */
#ifndef PDYN_HESSIAN_MATRIX_H
#define PDYN_HESSIAN_MATRIX_H

#include "assembly.h"

struct hessian_matrix {
    pdyn_context *context;
    struct objective *objective;
    struct batch **rows; /* system's batches: itself, or the rows twin of one with an operator */
    double *unused;      /* particles x 3: the twins' gradients */
    struct matrix matrix;
    unsigned lists;    /* revision of the neighbours that the pattern belongs to */
    unsigned revision; /* and that of the rows */
    double h;          /* s: the values belong to it, 0 before the first ones, */
    unsigned weights;  /* and to these weights */
};

pdyn_status hessian_matrix_create(struct hessian_matrix *hessian, struct objective *objective);
void hessian_matrix_free(struct hessian_matrix *hessian);

/* Brings the matrix up to date; says what has moved since the call before. */
pdyn_status hessian_matrix_update(struct hessian_matrix *hessian, bool *pattern, bool *values);

#endif
