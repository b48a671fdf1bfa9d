/* Embedding of points in tetrahedra: each point is bound to the tetrahedron that contains it at
 * rest, or to one nearby, by barycentric coordinates, and follows it when it moves,
 *
 *     x = sum_k w_k y_k,     sum_k w_k = 1,     k = 0 .. 3
 *
 * A point outside has negative coordinates and is extrapolated. A part of a mesh that is far from
 * all tetrahedra is bound to four vertices that span a large one. */
#ifndef PDYN_EMBEDDING_H
#define PDYN_EMBEDDING_H

#include "tets.h"

struct embedding {
    int count;
    int *corner;    /* count x 4: vertices of a tetrahedron */
    double *weight; /* count x 4 */
};

/* Binds the vertices of a mesh. rest: positions of the vertices of the tetrahedra, m, of which
 * there is at least one, each with a volume. PDYN_NO_MEMORY: nothing is left to free. */
pdyn_status embedding_create(pdyn_context *context, const double *rest, const struct tets *tets,
                             const struct mesh *mesh, struct embedding *out);
void embedding_free(pdyn_context *context, struct embedding *embedding);

/* Finds four of `count` points that span a large tetrahedron, for points that move rigidly. */
void embedding_span(const double *x, int count, int corner[4]);

#endif
