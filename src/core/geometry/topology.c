/* Topology of triangle meshes: edges and neighbours, the border, vertices at the same place. */
#include "mesh_sides.h"

#include "projdyn/box.h"
#include "projdyn/vec3.h"

#include <stdlib.h>
#include <string.h>

/* ---- vertices at the same place -------------------------------------------------------------- */

/* Programs compute both sides of a seam with rounding errors: coordinates are the same if they
 * round to the same multiple of this part of the longest side of the mesh's box. */
#define SAME_PLACE 1e-6

/* The coordinates as such multiples. NULL: no memory. */
static double *rounded_positions(pdyn_context *context, const struct mesh *mesh) {
    struct box box = box_around(mesh->vertex, mesh->vertices);
    double longest = 0.0, *place = NEW_ARRAY(context, 3 * (size_t)mesh->vertices, double);
    for (int k = 0; k < 3; k++) longest = fmax(longest, box.max[k] - box.min[k]);
    for (size_t k = 0; place && k < 3 * (size_t)mesh->vertices; k++)
        place[k] = rint(mesh->vertex[k] / (SAME_PLACE * longest));
    return place;
}

static int compare_positions(const void *a, const void *b, void *place) {
    const double *x = (const double *)place + 3 * (size_t) * (const int *)a;
    const double *y = (const double *)place + 3 * (size_t) * (const int *)b;
    int k = 0;
    while (k < 2 && x[k] == y[k]) k++;
    return (x[k] > y[k]) - (x[k] < y[k]);
}

/* For each vertex a vertex at its place, the same one for all that lie there. NULL: no memory. */
static int *vertex_of_place(pdyn_context *context, const struct mesh *mesh) {
    int *order = NEW_ARRAY(context, mesh->vertices, int);
    int *vertex = NEW_ARRAY(context, mesh->vertices, int);
    double *place = rounded_positions(context, mesh);
    if (order && vertex && place) {
        for (int i = 0; i < mesh->vertices; i++) order[i] = i;
        qsort_r(order, (size_t)mesh->vertices, sizeof *order, compare_positions, place);
        for (int i = 0; i < mesh->vertices; i++) {
            bool same = i && !compare_positions(order + i - 1, order + i, place);
            vertex[order[i]] = same ? vertex[order[i - 1]] : order[i];
        }
    } else FREE_ARRAY(context, vertex, mesh->vertices);
    FREE_ARRAY(context, order, mesh->vertices);
    FREE_ARRAY(context, place, 3 * (size_t)mesh->vertices);
    return vertex;
}

pdyn_status mesh_count_duplicates(pdyn_context *context, const struct mesh *mesh, int *count) {
    int *place = vertex_of_place(context, mesh);
    if (!place) return PDYN_NO_MEMORY;
    *count = 0;
    for (int i = 0; i < mesh->vertices; i++) *count += place[i] != i;
    FREE_ARRAY(context, place, mesh->vertices);
    return PDYN_OK;
}

pdyn_status mesh_find_border(pdyn_context *context, const struct mesh *mesh, int *across) {
    int sides = 3 * mesh->triangles, last;
    struct mesh joined = *mesh;
    struct side *side = NULL;
    int *place = vertex_of_place(context, mesh);
    joined.triangle = NEW_ARRAY(context, sides, int);
    if (place && joined.triangle) {
        for (int i = 0; i < sides; i++) joined.triangle[i] = place[mesh->triangle[i]];
        side = mesh_sides(context, &joined);
    }
    for (int first = 0; side && first < sides; first = last) {
        last = sides_edge_end(side, sides, first);
        for (int i = first; i < last; i++) across[side[i].corner] = last - first == 1 ? -1 : 0;
    }
    FREE_ARRAY(context, place, mesh->vertices);
    FREE_ARRAY(context, joined.triangle, sides);
    if (!side) return PDYN_NO_MEMORY;
    FREE_ARRAY(context, side, sides);
    return PDYN_OK;
}

/* ---- topology -------------------------------------------------------------------------------- */

static bool resize_arrays(pdyn_context *context, struct topology *t, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(t->vertex_area, t->vertices),    ARRAY(t->edge, 2 * t->edges),
        ARRAY(t->edge_share, t->edges),        ARRAY(t->on_border, t->vertices),
        ARRAY(t->triangle_area, t->triangles), ARRAY(t->across, 3 * t->triangles),
    };
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

/* The area of a triangle divided by the sum of its squared sides: its part of edge_share. */
static double share(const struct mesh *mesh, int t) {
    double squares = 0.0;
    for (int k = 0; k < 3; k++) {
        double side = vec3_distance(mesh->vertex + 3 * mesh->triangle[3 * t + k],
                                    mesh->vertex + 3 * mesh->triangle[3 * t + (k + 1) % 3]);
        squares += side * side;
    }
    return mesh_triangle_area(mesh, t) / squares;
}

static void fill_edges(const struct mesh *mesh, const struct side *side, struct topology *out) {
    int sides = 3 * mesh->triangles, last;
    for (int first = 0, e = 0; first < sides; first = last, e++) {
        last = sides_edge_end(side, sides, first);
        memcpy(out->edge + 2 * e, side[first].end, sizeof side->end);
        for (int i = first; i < last; i++) out->edge_share[e] += share(mesh, side[i].corner / 3);
        if (last - first == 1)
            for (int k = 0; k < 2; k++) out->on_border[side[first].end[k]] = true;
        out->across[side[first].corner] = last - first == 1 ? -1 : side[first + 1].corner;
        if (last - first == 2) out->across[side[first + 1].corner] = side[first].corner;
    }
}

static void fill_areas(const struct mesh *mesh, struct topology *out) {
    for (int t = 0; t < mesh->triangles; t++) {
        out->triangle_area[t] = mesh_triangle_area(mesh, t);
        for (int k = 0; k < 3; k++)
            out->vertex_area[mesh->triangle[3 * t + k]] += out->triangle_area[t] / 3.0;
    }
}

pdyn_status topology_build(pdyn_context *context, const struct mesh *mesh, struct topology *out) {
    *out = (struct topology){.vertices = mesh->vertices, .triangles = mesh->triangles};
    int sides = 3 * mesh->triangles;
    struct side *side = mesh_sides(context, mesh);
    if (!side) return *out = (struct topology){0}, PDYN_NO_MEMORY;
    for (int first = 0; first < sides; first = sides_edge_end(side, sides, first)) out->edges++;
    bool ready = resize_arrays(context, out, ARRAYS_ALLOCATE);
    if (ready) {
        fill_edges(mesh, side, out);
        fill_areas(mesh, out);
    } else topology_free(context, out);
    FREE_ARRAY(context, side, sides);
    return ready ? PDYN_OK : PDYN_NO_MEMORY;
}

void topology_free(pdyn_context *context, struct topology *topology) {
    resize_arrays(context, topology, ARRAYS_FREE);
    *topology = (struct topology){0};
}
