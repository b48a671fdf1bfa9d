/* Topology of triangle meshes: checks, edges, areas. Everything is computed from the sides of the
 * triangles, sorted such that the sides of the same edge are adjacent. */
#include "mesh.h"
#include "point_list.h"

#include "projdyn/vec3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct side {
    int end[2]; /* vertices, ascending */
    int corner; /* index in mesh.triangle of the opposite corner */
};

/* Stable counting sort by one end (0 or 1). start: scratch, vertices + 1. */
static void sort_by_end(const struct side *from, struct side *to, int sides, int end, int *start,
                        int vertices) {
    memset(start, 0, ((size_t)vertices + 1) * sizeof *start);
    for (int i = 0; i < sides; i++) start[from[i].end[end] + 1]++;
    for (int v = 0; v < vertices; v++) start[v + 1] += start[v];
    for (int i = 0; i < sides; i++) to[start[from[i].end[end]]++] = from[i];
}

/* The three sides of every triangle, sorted by (smaller, larger) vertex. NULL: no memory. */
static struct side *sorted_sides(pdyn_context *context, const struct mesh *mesh) {
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

/* One past the last side of the edge whose first side is `first`. */
static int edge_end(const struct side *side, int sides, int first) {
    int last = first + 1;
    while (last < sides && !memcmp(side[last].end, side[first].end, sizeof side->end)) last++;
    return last;
}

static double area_of(const struct mesh *mesh, int t) {
    const double *c[3];
    double n[3];
    mesh_corners(mesh, t, c);
    vec3_normal(n, c[0], c[1], c[2]);
    return 0.5 * vec3_length(n);
}

double mesh_area(const struct mesh *mesh) {
    double area = 0.0;
    for (int t = 0; t < mesh->triangles; t++) area += area_of(mesh, t);
    return area;
}

/* ---- checks for cloth and closed volumes ----------------------------------------------------- */

pdyn_status mesh_check_used(pdyn_context *context, const char *name, int vertices, const int *index,
                            int count, const char *what) {
    bool *used = NEW_ARRAY(context, vertices, bool);
    if (!used) return PDYN_NO_MEMORY;
    for (int i = 0; i < count; i++) used[index[i]] = true;
    int v = 0;
    while (v < vertices && used[v]) v++;
    FREE_ARRAY(context, used, vertices);
    if (v == vertices) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT, "%.1024s: vertex %d is used by no %s", name, v, what);
}

static pdyn_status check_areas(const struct mesh *mesh, const char *name) {
    for (int t = 0; t < mesh->triangles; t++) {
        const int *c = mesh->triangle + 3 * t;
        double area = area_of(mesh, t), longest = 0.0;
        for (int k = 0; k < 3; k++)
            longest = fmax(
                longest, vec3_distance(mesh->vertex + 3 * c[k], mesh->vertex + 3 * c[(k + 1) % 3]));
        if (!(area > 1e-12 * longest * longest))
            return set_error(PDYN_BAD_INPUT,
                             "%.1024s: triangle %d (vertices %d, %d, %d) has no area", name, t,
                             c[0], c[1], c[2]);
    }
    return PDYN_OK;
}

/* Checks one edge: `count` sides from `side` on. */
typedef pdyn_status check_edge_fn(const struct mesh *mesh, const char *name,
                                  const struct side *side, int count);

static pdyn_status check_edges(pdyn_context *context, const struct mesh *mesh, const char *name,
                               check_edge_fn *check) {
    int sides = 3 * mesh->triangles, last;
    struct side *side = sorted_sides(context, mesh);
    if (!side) return PDYN_NO_MEMORY;
    pdyn_status status = PDYN_OK;
    for (int first = 0; first < sides && status == PDYN_OK; first = last) {
        last = edge_end(side, sides, first);
        status = check(mesh, name, side + first, last - first);
    }
    FREE_ARRAY(context, side, sides);
    return status;
}

static pdyn_status check_cloth_edge(const struct mesh *mesh, const char *name,
                                    const struct side *side, int count) {
    if (count == 2 && mesh->triangle[side[0].corner] == mesh->triangle[side[1].corner])
        return set_error(PDYN_BAD_INPUT, "%.1024s: triangles %d and %d have the same vertices",
                         name, side[0].corner / 3, side[1].corner / 3);
    if (count <= 2) return PDYN_OK;
    const double *x = mesh->vertex + 3 * (size_t)side->end[0];
    return set_error(PDYN_BAD_INPUT,
                     "%.1024s: the edge between vertices %d and %d, at (%.4g, %.4g, %.4g) m, "
                     "has %d triangles, expected at most 2",
                     name, side->end[0], side->end[1], x[0], x[1], x[2], count);
}

static pdyn_status check_closed_edge(const struct mesh *mesh, const char *name,
                                     const struct side *side, int count) {
    if (count % 2 == 0) return PDYN_OK;
    const double *x = mesh->vertex + 3 * (size_t)side->end[0];
    return set_error(PDYN_BAD_INPUT,
                     "%.1024s: the mesh is not closed: the edge between vertices %d and %d, at "
                     "(%.4g, %.4g, %.4g) m, has %d triangle%s, expected 2",
                     name, side->end[0], side->end[1], x[0], x[1], x[2], count,
                     count == 1 ? "" : "s");
}

pdyn_status mesh_check_edges(pdyn_context *context, const struct mesh *mesh, const char *name) {
    return check_edges(context, mesh, name, check_cloth_edge);
}

pdyn_status mesh_visit_crowded_edges(pdyn_context *context, const struct mesh *mesh,
                                     void (*visit)(void *user, int vertex), void *user) {
    int sides = 3 * mesh->triangles, last;
    struct side *side = sorted_sides(context, mesh);
    if (!side) return PDYN_NO_MEMORY;
    for (int first = 0; first < sides; first = last) {
        last = edge_end(side, sides, first);
        for (int k = 0; last - first > 2 && k < 2; k++) visit(user, side[first].end[k]);
    }
    FREE_ARRAY(context, side, sides);
    return PDYN_OK;
}

pdyn_status mesh_check_cloth(pdyn_context *context, const struct mesh *mesh, const char *name) {
    pdyn_status status = mesh_check_used(context, name, mesh->vertices, mesh->triangle,
                                         3 * mesh->triangles, "triangle");
    if (status == PDYN_OK) status = check_areas(mesh, name);
    return status == PDYN_OK ? mesh_check_edges(context, mesh, name) : status;
}

pdyn_status mesh_check_closed(pdyn_context *context, const struct mesh *mesh, const char *name) {
    int doubles;
    pdyn_status status = check_edges(context, mesh, name, check_closed_edge);
    if (status != PDYN_BAD_INPUT) return status;
    char why[ERROR_LENGTH];
    snprintf(why, sizeof why, "%s", pdyn_last_error(NULL));
    status = mesh_count_duplicates(context, mesh, &doubles);
    if (status != PDYN_OK) return status;
    if (!doubles) return PDYN_BAD_INPUT;
    return set_error(PDYN_BAD_INPUT,
                     "%.1500s; %d of its vertices lie where another one does already, along "
                     "seams: merge them in the modelling program",
                     why, doubles);
}

/* The triangles of an edge pass it in opposite directions. */
static pdyn_status check_oriented_edge(const struct mesh *mesh, const char *name,
                                       const struct side *side, int count) {
    const int *one = mesh->triangle + side[0].corner / 3 * 3;
    for (int k = 1; k < count; k++) {
        const int *other = mesh->triangle + side[k].corner / 3 * 3;
        if (one[(side[0].corner + 1) % 3] != other[(side[k].corner + 1) % 3]) continue;
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: triangles %d and %d face opposite sides: both have the edge "
                         "from vertex %d to %d, expected one of them from %d to %d",
                         name, side[0].corner / 3, side[k].corner / 3,
                         one[(side[0].corner + 1) % 3], one[(side[0].corner + 2) % 3],
                         one[(side[0].corner + 2) % 3], one[(side[0].corner + 1) % 3]);
    }
    return PDYN_OK;
}

pdyn_status mesh_check_oriented(pdyn_context *context, const struct mesh *mesh, const char *name) {
    return check_edges(context, mesh, name, check_oriented_edge);
}

double mesh_volume(int triangles, const int *triangle, const double *x) {
    const double *origin = x + 3 * (size_t)triangle[0];
    double sum = 0.0;
    for (int t = 0; t < triangles; t++) {
        double side[3][3], normal[3];
        for (int k = 0; k < 3; k++)
            vec3_subtract(side[k], x + 3 * (size_t)triangle[3 * t + k], origin);
        vec3_cross(normal, side[1], side[2]);
        sum += vec3_dot(side[0], normal) / 6.0;
    }
    return sum;
}

pdyn_status mesh_check_encloses(pdyn_context *context, const struct mesh *mesh, const char *name) {
    pdyn_status status = mesh_check_closed(context, mesh, name);
    if (status == PDYN_OK) status = mesh_check_oriented(context, mesh, name);
    if (status != PDYN_OK) return status;
    double area = mesh_area(mesh);
    double volume = mesh_volume(mesh->triangles, mesh->triangle, mesh->vertex);
    if (fabs(volume) > 1e-9 * area * sqrt(area)) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT, "%.1024s: the mesh is flat: it encloses no volume", name);
}

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
        side = sorted_sides(context, &joined);
    }
    for (int first = 0; side && first < sides; first = last) {
        last = edge_end(side, sides, first);
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
    return area_of(mesh, t) / squares;
}

static void fill_edges(const struct mesh *mesh, const struct side *side, struct topology *out) {
    int sides = 3 * mesh->triangles, last;
    for (int first = 0, e = 0; first < sides; first = last, e++) {
        last = edge_end(side, sides, first);
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
        out->triangle_area[t] = area_of(mesh, t);
        for (int k = 0; k < 3; k++)
            out->vertex_area[mesh->triangle[3 * t + k]] += out->triangle_area[t] / 3.0;
    }
}

pdyn_status topology_build(pdyn_context *context, const struct mesh *mesh, struct topology *out) {
    *out = (struct topology){.vertices = mesh->vertices, .triangles = mesh->triangles};
    int sides = 3 * mesh->triangles;
    struct side *side = sorted_sides(context, mesh);
    if (!side) return *out = (struct topology){0}, PDYN_NO_MEMORY;
    for (int first = 0; first < sides; first = edge_end(side, sides, first)) out->edges++;
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
