/* Checks of meshes: vertices, areas, edges. */
#include "mesh_sides.h"

#include "projdyn/vec3.h"

#include <stdio.h>

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
        double area = mesh_triangle_area(mesh, t), longest = 0.0;
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
    struct side *side = mesh_sides(context, mesh);
    if (!side) return PDYN_NO_MEMORY;
    pdyn_status status = PDYN_OK;
    for (int first = 0; first < sides && status == PDYN_OK; first = last) {
        last = sides_edge_end(side, sides, first);
        status = check(mesh, name, side + first, last - first);
    }
    FREE_ARRAY(context, side, sides);
    return status;
}

static pdyn_status check_cloth_edge(const struct mesh *mesh, const char *name,
                                    const struct side *side, int count) {
    if (count == 2 && mesh->triangle[side[0].corner] == mesh->triangle[side[1].corner])
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: triangles %d and %d have the same vertices: delete one of them",
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
                     "(%.4g, %.4g, %.4g) m, has %d triangle%s",
                     name, side->end[0], side->end[1], x[0], x[1], x[2], count,
                     count == 1 ? ", expected 2: a hole, or vertices that are not joined"
                                : "s, expected 2");
}

pdyn_status mesh_check_edges(pdyn_context *context, const struct mesh *mesh, const char *name) {
    return check_edges(context, mesh, name, check_cloth_edge);
}

pdyn_status mesh_visit_crowded_edges(pdyn_context *context, const struct mesh *mesh,
                                     void (*visit)(void *user, int vertex), void *user) {
    int sides = 3 * mesh->triangles, last;
    struct side *side = mesh_sides(context, mesh);
    if (!side) return PDYN_NO_MEMORY;
    for (int first = 0; first < sides; first = last) {
        last = sides_edge_end(side, sides, first);
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

pdyn_status mesh_check_encloses(pdyn_context *context, const struct mesh *mesh, const char *name) {
    pdyn_status status = mesh_check_closed(context, mesh, name);
    if (status == PDYN_OK) status = mesh_check_oriented(context, mesh, name);
    if (status != PDYN_OK) return status;
    double area = mesh_area(mesh);
    double volume = mesh_volume(mesh->triangles, mesh->triangle, mesh->vertex);
    if (fabs(volume) > 1e-9 * area * sqrt(area)) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT, "%.1024s: the mesh is flat: it encloses no volume", name);
}
