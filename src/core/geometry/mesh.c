/* Triangle meshes: rectangular sheets, checks of coordinates and indices, memory. */
#include "mesh.h"

#include <math.h>
#include <string.h>

static void fill_grid_vertices(const double size[2], const int vertices[2], double sag, double *x) {
    for (int i = 0; i < vertices[0] * vertices[1]; i++, x += 3) {
        double a = (i % vertices[0]) / (vertices[0] - 1.0) - 0.5;
        double b = (i / vertices[0]) / (vertices[1] - 1.0) - 0.5;
        x[0] = size[0] * a, x[2] = size[1] * b;
        x[1] = 0.0 - sag * (1.0 - 4.0 * a * a) * (1.0 - 4.0 * b * b);
    }
}

static void fill_grid_triangles(const int vertices[2], int *triangle) {
    for (int j = 0; j + 1 < vertices[1]; j++)
        for (int i = 0; i + 1 < vertices[0]; i++, triangle += 6) {
            int p = j * vertices[0] + i, q = p + 1, s = p + vertices[0], r = s + 1;
            const int even[6] = {p, s, r, p, r, q}, odd[6] = {p, s, q, q, s, r};
            memcpy(triangle, (i + j) % 2 ? odd : even, sizeof even);
        }
}

pdyn_status mesh_grid(pdyn_context *context, const double size[2], const int vertices[2],
                      double sag, struct mesh *out) {
    *out = (struct mesh){0};
    for (int k = 0; k < 2; k++) {
        if (!(size[k] > 0.0 && size[k] <= MESH_MAX_COORDINATE))
            return set_error(PDYN_BAD_INPUT,
                             "grid: expected sizes above 0 and of at most %g m, found %g",
                             MESH_MAX_COORDINATE, size[k]);
        if (vertices[k] < 2)
            return set_error(PDYN_BAD_INPUT,
                             "grid: expected at least 2 vertices along each side, found %d",
                             vertices[k]);
    }
    if (vertices[1] > MESH_MAX / 2 / vertices[0]) /* two triangles per vertex */
        return set_error(PDYN_BAD_INPUT, "grid: expected at most %d vertices, found %d x %d",
                         MESH_MAX / 2, vertices[0], vertices[1]);
    pdyn_status status = mesh_allocate(context, vertices[0] * vertices[1],
                                       2 * (vertices[0] - 1) * (vertices[1] - 1), out);
    if (status != PDYN_OK) return status;
    fill_grid_vertices(size, vertices, sag, out->vertex);
    fill_grid_triangles(vertices, out->triangle);
    return PDYN_OK;
}

pdyn_status mesh_check(const struct mesh *mesh, const char *name) {
    if (mesh->triangles < 1)
        return set_error(PDYN_BAD_INPUT, "%.1024s: the mesh has no triangles", name);
    for (int i = 0; i < 3 * mesh->vertices; i++)
        if (!(fabs(mesh->vertex[i]) <= MESH_MAX_COORDINATE))
            return set_error(PDYN_BAD_INPUT,
                             "%.1024s: vertex %d: expected a finite %c of at most %g m, found %g",
                             name, i / 3, "xyz"[i % 3], MESH_MAX_COORDINATE, mesh -> vertex[i]);
    for (int t = 0; t < mesh->triangles; t++) {
        const int *c = mesh->triangle + 3 * t;
        for (int k = 0; k < 3; k++) {
            if (c[k] < 0 || c[k] >= mesh->vertices)
                return set_error(PDYN_BAD_INPUT,
                                 "%.1024s: triangle %d uses vertex %d, expected 0 to %d", name, t,
                                 c[k], mesh->vertices - 1);
            if (c[k] == c[(k + 1) % 3])
                return set_error(PDYN_BAD_INPUT, "%.1024s: triangle %d uses vertex %d twice", name,
                                 t, c[k]);
        }
    }
    return PDYN_OK;
}

static bool resize_arrays(pdyn_context *context, struct mesh *mesh, enum array_action action) {
    const struct array_entry table[] = {ARRAY(mesh->vertex, 3 * (size_t)mesh->vertices),
                                        ARRAY(mesh->triangle, 3 * (size_t)mesh->triangles)};
    return context_arrays(context, table, ARRAY_ROWS(table), action);
}

pdyn_status mesh_allocate(pdyn_context *context, int vertices, int triangles, struct mesh *out) {
    *out = (struct mesh){.vertices = vertices, .triangles = triangles};
    if (resize_arrays(context, out, ARRAYS_ALLOCATE)) return PDYN_OK;
    mesh_free(context, out);
    return PDYN_NO_MEMORY;
}

void mesh_free(pdyn_context *context, struct mesh *mesh) {
    resize_arrays(context, mesh, ARRAYS_FREE);
    *mesh = (struct mesh){0};
}

void particles_free(pdyn_context *context, struct particles *particles) {
    FREE_ARRAY(context, particles->x, 3 * (size_t)particles->count);
    FREE_ARRAY(context, particles->v, 3 * (size_t)particles->count);
    *particles = (struct particles){0};
}
