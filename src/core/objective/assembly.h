/* H as a sparse matrix, for direct solvers: lower triangle by block columns, one block row and
 * column a particle. Blocks are 3 x 3, or 1 x 1 for the projective step's (eps = 1), where x, y and
 * z do not couple. */
#ifndef PDYN_ASSEMBLY_H
#define PDYN_ASSEMBLY_H

#include "objective.h"

struct matrix {
    pdyn_context *context;
    int particles, dim; /* dim: 1 or 3 */
    int *block_start;   /* particles + 1: first block of each block column */
    int *block_row;     /* blocks: ascending in a column, the diagonal first */
    size_t capacity;    /* of block_row before repeated blocks were merged */
    int *column_start;  /* dim particles + 1 */
    int *row;           /* entries: blocks x dim^2 */
    double *value;      /* entries; of a diagonal block the upper triangle counts for nothing */
};

/* Pattern of the rows of these batches (rows tier; NULL: left out) and of the masses. Frees what
 * was there. */
pdyn_status matrix_pattern(struct matrix *matrix, const struct objective *objective,
                           struct batch *const *rows, int dim);

/* Values of H, as the batches were linearised where dim is 3; without inertia: the sum of the rows'
 * contributions alone. */
void matrix_values(struct matrix *matrix, const struct objective *objective,
                   struct batch *const *rows, bool inertia);

void matrix_free(struct matrix *matrix);

#endif
