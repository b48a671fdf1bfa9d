/* Sampling of boxes and spheres with particles, and of surfaces of solids with boundary points. */
#include "sampling.h"

#include "projdyn/vec3.h"

#include <string.h>

pdyn_status sample_box_volume(pdyn_context *context, const struct box *box, double radius,
                              struct point_list *out) {
    double cuts[3];
    long n[3];
    for (int a = 0; a < 3; a++) cuts[a] = sample_cells(box->max[a] - box->min[a], 2.0 * radius);
    if (!(cuts[0] * cuts[1] * cuts[2] < POINT_LIST_MAX)) return point_list_too_many(context);
    for (int a = 0; a < 3; a++) n[a] = (long)cuts[a];
    for (long k = 0; k < n[0] * n[1] * n[2]; k++) {
        long cell[3] = {k % n[0], k / n[0] % n[1], k / n[0] / n[1]};
        double x[3];
        for (int a = 0; a < 3; a++) x[a] = box->min[a] + radius * (2.0 * (double)cell[a] + 1.0);
        pdyn_status status = point_list_add(context, out, x);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
}

pdyn_status sample_sphere_volume(pdyn_context *context, const struct scene_sphere *sphere,
                                 double radius, struct point_list *out) {
    double reach = sphere->radius - radius, half = floor(reach / (2.0 * radius) + 1e-9);
    double side = 2.0 * half + 1.0;
    if (!(side * side * side < POINT_LIST_MAX)) return point_list_too_many(context);
    pdyn_status status = PDYN_OK;
    for (double k = -half; k <= half; k++)
        for (double j = -half; j <= half; j++)
            for (double i = -half; i <= half; i++) {
                double from_centre[3] = {2.0 * radius * i, 2.0 * radius * j, 2.0 * radius * k};
                if (vec3_length(from_centre) > reach * (1.0 + 1e-9)) continue;
                vec3_add(from_centre, 1.0, sphere->center);
                status = point_list_add(context, out, from_centre);
                if (status != PDYN_OK) return status;
            }
    return status;
}

/* ---- the faces of a box ---------------------------------------------------------------------- */

void boundary_points_free(pdyn_context *context, struct boundary_points *out) {
    FREE_ARRAY(context, out->point, out->capacity);
    point_list_free(context, &out->at);
    *out = (struct boundary_points){0};
}

static pdyn_status append_boundary_point(pdyn_context *context, struct boundary_points *out,
                                         const double x[3], const struct boundary_point *point) {
    size_t count = (size_t)out->at.count;
    struct boundary_point *grown =
        context_grow(context, out->point, &out->capacity, count + 1, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    out->point = grown;
    out->point[count] = *point;
    return point_list_add(context, &out->at, x);
}

/* Samples the face across axis a, at the lower or upper end. */
static pdyn_status sample_face(pdyn_context *context, const struct box *box, int a, bool upper,
                               const struct face_grid *grid, struct boundary_points *out) {
    double pitch[3], low[3], x[3];
    long n[3] = {0};
    for (int b = 0; b < 3; b++) {
        /* past an edge only if the adjacent face is closed */
        double under = grid->open >> (2 * b) & 1u ? 0.0 : grid->beyond;
        double over = grid->open >> (2 * b + 1) & 1u ? 0.0 : grid->beyond;
        double length = box->max[b] - box->min[b] + under + over;
        double cuts = ceil(length / grid->spacing - 1e-9);
        if (b == a) continue;
        if (!(cuts < POINT_LIST_MAX)) return point_list_too_many(context);
        n[b] = (long)cuts, pitch[b] = length / cuts, low[b] = box->min[b] - under;
    }
    int b = (a + 1) % 3, c = (a + 2) % 3;
    x[a] = upper ? box->max[a] + grid->outside : box->min[a] - grid->outside;
    for (long i = 0; i <= n[b]; i++)
        for (long j = 0; j <= n[c]; j++) {
            double share = (i == 0 || i == n[b] ? 0.5 : 1.0) * (j == 0 || j == n[c] ? 0.5 : 1.0);
            struct boundary_point point = {.area = share * pitch[b] * pitch[c], .of_box = true};
            point.normal[a] = upper ? -1.0 : 1.0;
            x[b] = low[b] + (double)i * pitch[b], x[c] = low[c] + (double)j * pitch[c];
            pdyn_status status = append_boundary_point(context, out, x, &point);
            if (status != PDYN_OK) return status;
        }
    return PDYN_OK;
}

pdyn_status sample_box_surface(pdyn_context *context, const struct box *box,
                               const struct face_grid *grid, struct boundary_points *out) {
    pdyn_status status = PDYN_OK;
    for (int side = 0; side < 6 && status == PDYN_OK; side++)
        if (!(grid->open >> side & 1u))
            status = sample_face(context, box, side / 2, side % 2, grid, out);
    return status;
}

pdyn_status sample_mesh_surface(pdyn_context *context, const char *name, const struct mesh *mesh,
                                double spacing, struct boundary_points *out) {
    struct surface_points points = {0};
    pdyn_status status = sample_triangles(context, name, mesh->vertex, mesh->triangles,
                                          mesh->triangle, spacing, &points);
    for (int i = 0; status == PDYN_OK && i < points.count; i++) {
        struct boundary_point point = {.area = points.point[i].area};
        const double *corner[3];
        double x[3];
        surface_point_position(&points.point[i], mesh->vertex, mesh->triangle, x);
        mesh_corners(mesh, points.point[i].triangle, corner);
        vec3_normal(point.normal, corner[0], corner[1], corner[2]);
        vec3_normalise(point.normal);
        status = append_boundary_point(context, out, x, &point);
    }
    surface_points_free(context, &points);
    return status;
}
