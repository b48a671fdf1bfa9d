/* Within rows/: the arrays of a batch of the rows tier. batch_build.c fills them once for a type
 * whose elements stay the same, dynamic_rows.c again and again. */
#ifndef PDYN_ROW_ARRAYS_H
#define PDYN_ROW_ARRAYS_H

#include "batch.h"

/* Fails with PDYN_BAD_INPUT: "constraint NAME on body NAME: " and this text. */
pdyn_status rows_fault(const struct batch *batch, const char *format, ...) PDYN_PRINTF(2, 3);

/* Particles from *low to before *high, which rows may select besides those of other bodies that
 * parameters name: all of the system where the type knows what core finds there, otherwise those of
 * the body. */
void rows_selectable(const struct batch *batch, int *low, int *high);

/* PDYN_BAD_INPUT where a row selects a particle that it may not, where a coefficient is not finite,
 * or a weight is negative or not finite. */
pdyn_status rows_check(const struct batch *batch);
pdyn_status rows_check_weights(const struct batch *batch);

/* Fills the weights of the elements [first, last); 0 where the batch is off. */
void rows_weigh(struct batch *batch, int first, int last);

/* Sets the grain by the rows and entries of an element, so that a parallel block takes some ten
 * microseconds: a tetrahedron costs as much as twenty springs. */
void rows_set_grain(struct batch *batch, double rows, double entries);

/* The number of rows of an element, and of entries of each. */
void rows_of_element(const struct batch *batch, int e, int *rows, int *width);

/* All arrays but element_row, which is there, with room for batch->room elements, rows and entries.
 */
bool rows_allocate(struct batch *batch);
/* Numbers in batch->block (row_tangent.c), one more than needed so that the last column can be
 * loaded as four numbers. */
size_t rows_block_numbers(const struct batch *batch);
void rows_free(struct batch *batch);

/* The range of particles that rows select: `count` from `first` on; none: 0, 0. */
void rows_find_touched(const struct batch *batch, int *first, int *count);
/* The transpose of G in this range, which is set before: for every particle the entries that select
 * it. */
void rows_index(struct batch *batch);

#endif
