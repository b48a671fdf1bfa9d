/* Sampling of boxes and spheres with particles, and of surfaces with points. */
#include "sampling.h"

#include "grid.h"
#include "projdyn/vec3.h"

#include <string.h>

pdyn_status sample_box_volume(pdyn_context *context, const struct scene_box *box, double radius,
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
static pdyn_status sample_face(pdyn_context *context, const struct scene_box *box, int a,
                               bool upper, const struct face_grid *grid,
                               struct boundary_points *out) {
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
            const struct boundary_point point = {.area = share * pitch[b] * pitch[c],
                                                 .of_box = true};
            x[b] = low[b] + (double)i * pitch[b], x[c] = low[c] + (double)j * pitch[c];
            pdyn_status status = append_boundary_point(context, out, x, &point);
            if (status != PDYN_OK) return status;
        }
    return PDYN_OK;
}

pdyn_status sample_box_surface(pdyn_context *context, const struct scene_box *box,
                               const struct face_grid *grid, struct boundary_points *out) {
    pdyn_status status = PDYN_OK;
    for (int side = 0; side < 6 && status == PDYN_OK; side++)
        if (!(grid->open >> side & 1u))
            status = sample_face(context, box, side / 2, side % 2, grid, out);
    return status;
}

/* ---- surfaces of meshes: a greedy Poisson-disk set ------------------------------------------- */

static pdyn_status append_point(pdyn_context *context, struct surface_points *points,
                                const struct surface_point *point) {
    if (points->count == POINT_LIST_MAX) return point_list_too_many(context);
    struct surface_point *grown = context_grow(context, points->point, &points->capacity,
                                               (size_t)points->count + 1, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    points->point = grown;
    points->point[points->count++] = *point;
    return PDYN_OK;
}

void surface_points_free(pdyn_context *context, struct surface_points *points) {
    FREE_ARRAY(context, points->point, points->capacity);
    *points = (struct surface_points){0};
}

static void corners_of(const double *vertex, const int *triangle, int t, const double *c[3]) {
    for (int k = 0; k < 3; k++) c[k] = vertex + 3 * (size_t)triangle[3 * t + k];
}

void surface_point_position(const struct surface_point *point, const double *vertex,
                            const int *triangle, double *x) {
    const double *c[3];
    corners_of(vertex, triangle, point->triangle, c);
    for (int a = 0; a < 3; a++)
        x[a] = c[0][a] + point->weight[1] * (c[1][a] - c[0][a]) +
               point->weight[2] * (c[2][a] - c[0][a]);
}

/* Number of parts into which each side of a triangle is divided; a part is at most a quarter
 * spacing long. */
static double cuts_of(const double *const c[3], double spacing) {
    double longest =
        fmax(vec3_distance(c[0], c[1]), fmax(vec3_distance(c[1], c[2]), vec3_distance(c[2], c[0])));
    return fmax(1.0, ceil(longest / (0.25 * spacing)));
}

/* Makes the candidates: on every triangle a lattice of barycentric coordinates, a quarter spacing
 * apart. */
static pdyn_status mesh_candidates(pdyn_context *context, const double *vertex, int triangles,
                                   const int *triangle, double spacing,
                                   struct surface_points *out) {
    for (int t = 0; t < triangles; t++) {
        const double *c[3];
        corners_of(vertex, triangle, t, c);
        double cuts = cuts_of(c, spacing);
        for (double i = 0; i <= cuts; i++)
            for (double j = 0; i + j <= cuts; j++) {
                struct surface_point point = {t, {1.0 - (i + j) / cuts, i / cuts, j / cuts}, 0.0};
                pdyn_status status = append_point(context, out, &point);
                if (status != PDYN_OK) return status;
            }
    }
    return PDYN_OK;
}

/* Selects candidates greedily: one that has no selected candidate within `distance` is selected. */
static void select_points(const struct grid *grid, const double *x, int count, double distance,
                          bool *taken) {
    struct grid_cells cells = {0};
    int one;
    for (int i = 0; i < count; i++) {
        const double *at = x + 3 * (size_t)i;
        grid_update_cells(grid, at, &cells);
        taken[i] = !grid_query(grid, &cells, at, distance, i, taken, &one, 0);
    }
}

/* Reduces the candidates at x to a Poisson-disk set. */
static pdyn_status thin_candidates(pdyn_context *context, struct surface_points *points,
                                   const double *x, double distance) {
    struct grid grid = {0};
    int count = points->count;
    bool *taken = NEW_ARRAY(context, count, bool);
    pdyn_status status = taken ? grid_create(context, count, distance, &grid) : PDYN_NO_MEMORY;
    if (status == PDYN_OK) status = grid_sort(context, &grid, count, NULL, x);
    if (status == PDYN_OK) {
        select_points(&grid, x, count, distance, taken);
        points->count = 0;
        for (int i = 0; i < count; i++)
            if (taken[i]) points->point[points->count++] = points->point[i];
    }
    FREE_ARRAY(context, taken, count);
    grid_free(context, &grid);
    return status;
}

/* ---- area of points -------------------------------------------------------------------------- */

enum { NEAR = 256 }; /* largest number of points near a place of the surface; about 10 occur */

static int nearest_point(const struct grid *grid, struct grid_cells *cells, const double *x,
                         const double *at) {
    int list[NEAR + 1], best = -1;
    double smallest = INFINITY;
    grid_update_cells(grid, at, cells);
    int found = grid_query(grid, cells, at, grid->cell, -1, NULL, list, NEAR);
    for (int k = 0; k < found && k < NEAR; k++) {
        double distance = vec3_distance(at, x + 3 * (size_t)list[k]);
        if (distance < smallest) smallest = distance, best = list[k];
    }
    return best;
}

/* Adds the area of each small triangle of the candidate lattice to the nearest point. */
static void share_triangle(const double *const c[3], double spacing, const struct grid *grid,
                           const double *x, struct surface_points *points) {
    double u[3], v[3], normal[3], cuts = cuts_of(c, spacing);
    struct grid_cells cells = {0};
    for (int a = 0; a < 3; a++) u[a] = c[1][a] - c[0][a], v[a] = c[2][a] - c[0][a];
    vec3_normal(normal, c[0], c[1], c[2]);
    double each = 0.5 * vec3_length(normal) / (cuts * cuts);
    for (double i = 0; i < cuts; i++)
        for (double j = 0; i + j < cuts; j++)
            for (double third = 1.0; third <= 2.0 && i + j + third <= cuts; third++) {
                double at[3];
                memcpy(at, c[0], sizeof at);
                vec3_add(at, (i + third / 3.0) / cuts, u);
                vec3_add(at, (j + third / 3.0) / cuts, v);
                int point = nearest_point(grid, &cells, x, at);
                if (point >= 0) points->point[point].area += each;
            }
}

/* Computes the areas of all points. A place of the surface has a point within 1.1 spacing. */
static pdyn_status share_surface(pdyn_context *context, const double *vertex, int triangles,
                                 const int *triangle, double spacing, const double *x,
                                 struct surface_points *points) {
    struct grid grid = {0};
    pdyn_status status = grid_create(context, points->count, 1.1 * spacing, &grid);
    if (status == PDYN_OK) status = grid_sort(context, &grid, points->count, NULL, x);
    for (int t = 0; status == PDYN_OK && t < triangles; t++) {
        const double *c[3];
        corners_of(vertex, triangle, t, c);
        share_triangle(c, spacing, &grid, x, points);
    }
    grid_free(context, &grid);
    return status;
}

static void surface_point_positions(const struct surface_points *points, const double *vertex,
                                    const int *triangle, double *x) {
    for (int i = 0; i < points->count; i++)
        surface_point_position(&points->point[i], vertex, triangle, x + 3 * (size_t)i);
}

pdyn_status sample_triangles(pdyn_context *context, const double *vertex, int triangles,
                             const int *triangle, double spacing, struct surface_points *out) {
    pdyn_status status = mesh_candidates(context, vertex, triangles, triangle, spacing, out);
    if (status != PDYN_OK || !out->count) return status;
    size_t count = (size_t)out->count;
    double *x = NEW_ARRAY(context, 3 * count, double);
    if (!x) return PDYN_NO_MEMORY;
    surface_point_positions(out, vertex, triangle, x);
    status = thin_candidates(context, out, x, 0.75 * spacing);
    if (status == PDYN_OK) {
        surface_point_positions(out, vertex, triangle, x);
        status = share_surface(context, vertex, triangles, triangle, spacing, x, out);
    }
    FREE_ARRAY(context, x, 3 * count);
    return status;
}

pdyn_status sample_mesh_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                struct boundary_points *out) {
    struct surface_points points = {0};
    pdyn_status status =
        sample_triangles(context, mesh->vertex, mesh->triangles, mesh->triangle, spacing, &points);
    for (int i = 0; status == PDYN_OK && i < points.count; i++) {
        double x[3];
        surface_point_position(&points.point[i], mesh->vertex, mesh->triangle, x);
        status = append_boundary_point(context, out, x,
                                       &(struct boundary_point){.area = points.point[i].area});
    }
    surface_points_free(context, &points);
    return status;
}
