#include "mesh_sides.h"

#include <string.h>

/* Stable counting sort by one end (0 or 1). start: scratch, vertices + 1. */
static void sort_by_end(const struct side *from, struct side *to, int sides, int end, int *start,
                        int vertices) {
    memset(start, 0, ((size_t)vertices + 1) * sizeof *start);
    for (int i = 0; i < sides; i++) start[from[i].end[end] + 1]++;
    for (int v = 0; v < vertices; v++) start[v + 1] += start[v];
    for (int i = 0; i < sides; i++) to[start[from[i].end[end]]++] = from[i];
}

struct side *mesh_sides(pdyn_context *context, const struct mesh *mesh) {
    int sides = 3 * mesh->triangles;
    struct side *side = NEW_ARRAY(context, sides, struct side);
    struct side *other = NEW_ARRAY(context, sides, struct side);
    int *start = NEW_ARRAY(context, mesh->vertices + 1, int);
    if (side && other && start) {
        for (int i = 0; i < sides; i++) {
            const int *c = mesh->triangle + i / 3 * 3;
            int a = c[(i + 1) % 3], b = c[(i + 2) % 3];
            side[i] = (struct side){{a < b ? a : b, a < b ? b : a}, i};
        }
        sort_by_end(side, other, sides, 1, start, mesh->vertices);
        sort_by_end(other, side, sides, 0, start, mesh->vertices);
    } else FREE_ARRAY(context, side, sides);
    FREE_ARRAY(context, other, sides);
    FREE_ARRAY(context, start, mesh->vertices + 1);
    return side;
}

int sides_edge_end(const struct side *side, int sides, int first) {
    int last = first + 1;
    while (last < sides && !memcmp(side[last].end, side[first].end, sizeof side->end)) last++;
    return last;
}
