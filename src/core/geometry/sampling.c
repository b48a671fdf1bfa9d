/* Sampling of boxes and spheres with particles, and of surfaces of solids with boundary points. */
#include "sampling.h"

#include "projdyn/vec3.h"

#include <string.h>

pdyn_status sample_box_volume(pdyn_context *context, const struct box *box, double radius,
                              struct point_list *out) {
    double cuts[3];
    long n[3];
    for (int a = 0; a < 3; a++) cuts[a] = sample_cells(box->max[a] - box->min[a], 2.0 * radius);
    if (!(cuts[0] * cuts[1] * cuts[2] < POINT_LIST_MAX)) return point_list_too_many();
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

pdyn_status sample_sphere_volume(pdyn_context *context, const struct sphere *sphere, double radius,
                                 struct point_list *out) {
    double reach = sphere->radius - radius, half = floor(reach / (2.0 * radius) + 1e-9);
    double side = 2.0 * half + 1.0;
    if (!(side * side * side < POINT_LIST_MAX)) return point_list_too_many();
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

/* ---- rectangles: faces of a box, planes ------------------------------------------------------ */

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

/* A flat part of a surface. */
struct rectangle {
    double corner[3], along[2][3], length[2]; /* m, along: unit vectors of two sides */
    double normal[3];                         /* unit vector */
    bool of_box;
};

/* Refuses a surface that would take too much memory. */
static pdyn_status check_points(const char *name, const double length[2], double spacing,
                                double count) {
    if (count <= RECTANGLE_POINTS) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT,
                     "a side of \"%s\" has %.3g m^2, too many for points %g m apart (%.3g points, "
                     "at most %d): make it no larger than fluid reaches, or the particles larger",
                     name, length[0] * length[1], spacing, count, RECTANGLE_POINTS);
}

/* Covers a rectangle with a lattice of points, on its border as well. */
static pdyn_status sample_rectangle(pdyn_context *context, const char *name,
                                    const struct rectangle *r, double spacing,
                                    struct boundary_points *out) {
    double cuts[2], pitch[2];
    for (int k = 0; k < 2; k++) {
        cuts[k] = fmax(1.0, ceil(r->length[k] / spacing - 1e-9));
        pitch[k] = r->length[k] / cuts[k];
    }
    pdyn_status status = check_points(name, r->length, spacing, cuts[0] * cuts[1]);
    for (double i = 0; i <= cuts[0] && status == PDYN_OK; i++)
        for (double j = 0; j <= cuts[1] && status == PDYN_OK; j++) {
            double x[3], share = (i == 0 || i == cuts[0] ? 0.5 : 1.0);
            if (j == 0 || j == cuts[1]) share *= 0.5;
            struct boundary_point point = {.area = share * pitch[0] * pitch[1],
                                           .of_box = r->of_box};
            memcpy(point.normal, r->normal, sizeof point.normal);
            memcpy(x, r->corner, sizeof x);
            vec3_add(x, i * pitch[0], r->along[0]);
            vec3_add(x, j * pitch[1], r->along[1]);
            status = append_boundary_point(context, out, x, &point);
        }
    return status;
}

/* Samples the face across axis a, at the lower or upper end. */
static pdyn_status sample_face(pdyn_context *context, const char *name, const struct box *box,
                               int a, bool upper, const struct face_grid *grid,
                               struct boundary_points *out) {
    struct rectangle r = {.of_box = true};
    for (int k = 0; k < 2; k++) {
        int b = (a + 1 + k) % 3;
        /* past an edge only if the adjacent face is closed */
        double under = grid->open >> (2 * b) & 1u ? 0.0 : grid->beyond;
        double over = grid->open >> (2 * b + 1) & 1u ? 0.0 : grid->beyond;
        r.along[k][b] = 1.0, r.corner[b] = box->min[b] - under;
        r.length[k] = box->max[b] - box->min[b] + under + over;
    }
    r.corner[a] = upper ? box->max[a] + grid->outside : box->min[a] - grid->outside;
    r.normal[a] = upper ? -1.0 : 1.0;
    return sample_rectangle(context, name, &r, grid->spacing, out);
}

pdyn_status sample_box_surface(pdyn_context *context, const char *name, const struct box *box,
                               const struct face_grid *grid, struct boundary_points *out) {
    pdyn_status status = PDYN_OK;
    for (int side = 0; side < 6 && status == PDYN_OK; side++)
        if (!(grid->open >> side & 1u))
            status = sample_face(context, name, box, side / 2, side % 2, grid, out);
    return status;
}

/* Spacing of the lattice of a plane over that of a Poisson-disk set with about as many points. On a
 * lattice of 1, a layer of particles that slides feels the rows. */
static const double lattice_spacing = 0.8;

pdyn_status sample_plane_surface(pdyn_context *context, const char *name, const struct mesh *mesh,
                                 double spacing, struct boundary_points *out) {
    struct rectangle r;
    memcpy(r.corner, mesh->vertex, sizeof r.corner);
    for (int k = 0; k < 2; k++) { /* the corners are in order around the plane */
        vec3_subtract(r.along[k], mesh->vertex + (k ? 9 : 3), r.corner);
        r.length[k] = vec3_normalise(r.along[k]);
    }
    r.of_box = false;
    vec3_cross(r.normal, r.along[0], r.along[1]);
    return sample_rectangle(context, name, &r, lattice_spacing * spacing, out);
}

/* ---- meshes ---------------------------------------------------------------------------------- */

pdyn_status sample_mesh_surface(pdyn_context *context, const char *name, const struct mesh *mesh,
                                double spacing, struct boundary_points *out) {
    struct surface_points points = {0};
    pdyn_status status = sample_triangles(context, name, mesh, spacing, &points);
    for (int i = 0; status == PDYN_OK && i < points.count; i++) {
        struct boundary_point point = {.area = points.point[i].area};
        const double *corner[3];
        double x[3];
        surface_point_position(&points.point[i], mesh, x);
        mesh_corners(mesh, points.point[i].triangle, corner);
        vec3_normal(point.normal, corner[0], corner[1], corner[2]);
        vec3_normalise(point.normal);
        status = append_boundary_point(context, out, x, &point);
    }
    surface_points_free(context, &points);
    return status;
}
