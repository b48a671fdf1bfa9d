/* Assembly of H as a sparse matrix: lower triangle by block columns, one block row and column per
 * particle. Blocks are 3 x 3, or 1 x 1 for the projective step (eps = 1), where x, y and z do not
 * couple. */
#ifndef PDYN_ASSEMBLY_H
#define PDYN_ASSEMBLY_H

#include "objective.h"

struct matrix {
    pdyn_context *context;
    int particles, dim; /* dim: 1 or 3 */
    int *block_start;   /* particles + 1: first block of each block column */
    int *block_row;     /* blocks: ascending in a column, the diagonal first */
    size_t capacity;    /* of block_row, before repeated blocks were merged */
    size_t entries;     /* of row and value: blocks x dim^2 */
    int *column_start;  /* dim particles + 1 */
    int *row;           /* entries */
    double *value;      /* entries; the upper triangle of a diagonal block is to be ignored */
};

/* The pattern of the diagonal and of the rows of these batches (NULL: left out). Frees the former
 * matrix. PDYN_NO_MEMORY; PDYN_SOLVER_FAILED: more than 2^31 entries. */
pdyn_status matrix_pattern(struct matrix *matrix, const struct objective *objective,
                           struct batch *const *rows, int dim);

/* Values of H, as the batches were linearised where dim is 3; without inertia: the sum of the rows'
 * contributions alone. */
void matrix_values(struct matrix *matrix, const struct objective *objective,
                   struct batch *const *rows, bool inertia);

void matrix_free(struct matrix *matrix);

#endif
