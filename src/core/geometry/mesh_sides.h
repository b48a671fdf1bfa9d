/* The sides of the triangles of a mesh, sorted such that those of the same edge are adjacent:
 *
 *     for (int first = 0; first < 3 * mesh->triangles; first = last) {
 *         last = sides_edge_end(side, 3 * mesh->triangles, first);
 *         ... the sides first to last - 1 are those of an edge
 */
#ifndef PDYN_MESH_SIDES_H
#define PDYN_MESH_SIDES_H

#include "mesh.h"

struct side {
    int end[2]; /* vertices, ascending */
    int corner; /* index in mesh.triangle of the opposite corner */
};

/* The three sides of every triangle, sorted by (smaller, larger) vertex, to be freed by the caller.
 * NULL: no memory. */
struct side *mesh_sides(pdyn_context *context, const struct mesh *mesh);

/* One past the last side of the edge whose first side is `first`. */
int sides_edge_end(const struct side *side, int sides, int first);

#endif
