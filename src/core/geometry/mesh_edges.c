/* The edges of any mesh, also of one that is no surface with a topology (topology_build). */
#include "mesh.h"

#include <stdlib.h>
#include <string.h>

static int compare_edges(const void *a, const void *b) { return memcmp(a, b, 2 * sizeof(int)); }

int mesh_edges(const struct mesh *mesh, int first, int *edge) {
    int count = 3 * mesh->triangles, kept = 0;
    for (int k = 0; k < count; k++) {
        int a = mesh->triangle[k], b = mesh->triangle[k / 3 * 3 + (k + 1) % 3];
        edge[2 * k] = first + (a < b ? a : b), edge[2 * k + 1] = first + (a < b ? b : a);
    }
    qsort(edge, (size_t)count, 2 * sizeof *edge, compare_edges);
    for (int k = 0; k < count; k++) {
        if (k && !compare_edges(edge + 2 * k, edge + 2 * kept - 2)) continue;
        memmove(edge + 2 * kept++, edge + 2 * k, 2 * sizeof *edge);
    }
    return kept;
}
