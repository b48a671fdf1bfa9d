/* J = dp/du of an element by central differences of `project` (PDYN_NUMERIC_TANGENT). */
#ifndef PDYN_NUMERIC_TANGENT_H
#define PDYN_NUMERIC_TANGENT_H

#include "base/registry.h"
#include "batch.h"

enum { TANGENT_NUMBERS_MAX = 3 * NUMERIC_TANGENT_ROWS };

/* D = dp/du of element e at its u by central differences, n x n, n = 3 x rows, at most
 * TANGENT_NUMBERS_MAX. step: of each number of u, over |u| + |p|. Changes u and p of the element
 * and restores them: threads may work on different elements of a batch. */
void tangent_difference(const struct batch *batch, int e, double step, double *D);

/* A, n x n, becomes its symmetric part with all eigenvalues clamped to [0, 1]. */
void tangent_clamp(double *A, int n);

/* J of element e, symmetric, with eigenvalues in [0, 1]. */
void tangent_numeric(const struct batch *batch, int e, double *J);

#endif
