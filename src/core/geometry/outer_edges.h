/* The outside of tetrahedra whose vertices have names (keys) instead of indices. */
#ifndef PDYN_OUTER_EDGES_H
#define PDYN_OUTER_EDGES_H

#include "base/context.h"

/* Compares two keys, for qsort and bsearch. */
static inline int keys_compare(const void *a, const void *b) {
    int64_t p = *(const int64_t *)a, q = *(const int64_t *)b;
    return (p > q) - (p < q);
}

/* Calls visit(user, key) for both ends of every edge that has more than two outer faces: where
 * parts of the outside touch. corner: tets x 4. */
pdyn_status outer_edges_visit(pdyn_context *context, size_t tets, const int64_t *corner,
                              void (*visit)(void *user, int64_t key), void *user);

#endif
