#include "sampling.h"

#include "grid.h"
#include "projdyn/vec3.h"

pdyn_status sample_box_volume(pdyn_context *context, const struct scene_box *box, double radius,
                              struct points *out) {
    double cuts[3];
    long n[3];
    for (int a = 0; a < 3; a++) cuts[a] = sample_cells(box->max[a] - box->min[a], 2.0 * radius);
    if (!(cuts[0] * cuts[1] * cuts[2] < POINTS_MOST)) return points_too_many(context);
    for (int a = 0; a < 3; a++) n[a] = (long)cuts[a];
    for (long k = 0; k < n[0] * n[1] * n[2]; k++) {
        long cell[3] = {k % n[0], k / n[0] % n[1], k / n[0] / n[1]};
        double x[3];
        for (int a = 0; a < 3; a++) x[a] = box->min[a] + radius * (2.0 * (double)cell[a] + 1.0);
        pdyn_status status = points_add(context, out, x);
        if (status != PDYN_OK) return status;
    }
    return PDYN_OK;
}

pdyn_status sample_sphere_volume(pdyn_context *context, const struct scene_sphere *sphere,
                                 double radius, struct points *out) {
    double reach = sphere->radius - radius, half = floor(reach / (2.0 * radius) + 1e-9);
    double side = 2.0 * half + 1.0;
    if (!(side * side * side < POINTS_MOST)) return points_too_many(context);
    pdyn_status status = PDYN_OK;
    for (double k = -half; k <= half; k++)
        for (double j = -half; j <= half; j++)
            for (double i = -half; i <= half; i++) {
                double from_centre[3] = {2.0 * radius * i, 2.0 * radius * j, 2.0 * radius * k};
                if (vec3_length(from_centre) > reach * (1.0 + 1e-9)) continue;
                vec3_add(from_centre, 1.0, sphere->center);
                status = points_add(context, out, from_centre);
                if (status != PDYN_OK) return status;
            }
    return status;
}

/* A lattice point lies on the surface where one of its indices is at an end whose face is there. */
static bool on_face(const long cell[3], const long n[3], unsigned open) {
    for (int a = 0; a < 3; a++)
        if ((cell[a] == 0 && !(open >> (2 * a) & 1u)) ||
            (cell[a] == n[a] && !(open >> (2 * a + 1) & 1u)))
            return true;
    return false;
}

pdyn_status sample_box_surface(pdyn_context *context, const struct scene_box *box, unsigned open,
                               double spacing, struct points *out) {
    double cuts[3];
    long n[3], cell[3];
    for (int a = 0; a < 3; a++) cuts[a] = ceil((box->max[a] - box->min[a]) / spacing - 1e-9);
    if (!(cuts[0] * cuts[1] + cuts[1] * cuts[2] + cuts[2] * cuts[0] < POINTS_MOST))
        return points_too_many(context);
    for (int a = 0; a < 3; a++) n[a] = (long)cuts[a];
    for (cell[2] = 0; cell[2] <= n[2]; cell[2]++)
        for (cell[1] = 0; cell[1] <= n[1]; cell[1]++) {
            /* inside a row only the ends can lie on a face, unless the row itself lies on one */
            long middle[3] = {-1, cell[1], cell[2]};
            long stride = on_face(middle, n, open) ? 1 : n[0];
            for (cell[0] = 0; cell[0] <= n[0]; cell[0] += stride) {
                double x[3];
                for (int a = 0; a < 3; a++)
                    x[a] =
                        box->min[a] + (box->max[a] - box->min[a]) * (double)cell[a] / (double)n[a];
                pdyn_status status = on_face(cell, n, open) ? points_add(context, out, x) : PDYN_OK;
                if (status != PDYN_OK) return status;
            }
        }
    return PDYN_OK;
}

/* ---- meshes: candidates in a fixed order, each taken unless one taken before is too close
 * -------- */

/* Candidates: a lattice of barycentric coordinates on every triangle, a quarter spacing apart. */
static pdyn_status mesh_candidates(pdyn_context *context, const struct mesh *mesh, double spacing,
                                   struct points *out) {
    for (int t = 0; t < mesh->triangles; t++) {
        const double *c[3];
        for (int k = 0; k < 3; k++) c[k] = mesh->vertex + 3 * (size_t)mesh->triangle[3 * t + k];
        double longest = fmax(vec3_distance(c[0], c[1]),
                              fmax(vec3_distance(c[1], c[2]), vec3_distance(c[2], c[0])));
        double cuts = fmax(1.0, ceil(longest / (0.25 * spacing)));
        for (double i = 0; i <= cuts; i++)
            for (double j = 0; i + j <= cuts; j++) {
                double x[3];
                for (int a = 0; a < 3; a++)
                    x[a] =
                        c[0][a] + i / cuts * (c[1][a] - c[0][a]) + j / cuts * (c[2][a] - c[0][a]);
                pdyn_status status = points_add(context, out, x);
                if (status != PDYN_OK) return status;
            }
    }
    return PDYN_OK;
}

/* Takes candidates greedily; `taken` marks those in the set. */
static void thin_out(const struct grid *grid, const struct points *all, double distance,
                     bool *taken) {
    struct grid_cells cells = {0};
    int one;
    for (int i = 0; i < all->count; i++) {
        const double *at = all->x + 3 * (size_t)i;
        grid_around(grid, at, &cells);
        taken[i] = !grid_query(grid, &cells, at, distance, i, taken, &one, 0);
    }
}

pdyn_status sample_mesh_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                struct points *out) {
    struct points all = {0};
    struct grid grid = {0};
    bool *taken = NULL;
    pdyn_status status = mesh_candidates(context, mesh, spacing, &all);
    if (status == PDYN_OK) status = grid_create(context, all.count, 0.75 * spacing, &grid);
    if (status == PDYN_OK) status = grid_sort(context, &grid, all.count, NULL, all.x);
    if (status == PDYN_OK && !(taken = NEW_ARRAY(context, all.count, bool)))
        status = PDYN_NO_MEMORY;
    if (status == PDYN_OK) thin_out(&grid, &all, 0.75 * spacing, taken);
    for (int i = 0; status == PDYN_OK && i < all.count; i++)
        if (taken[i]) status = points_add(context, out, all.x + 3 * (size_t)i);
    FREE_ARRAY(context, taken, all.count);
    grid_free(context, &grid);
    points_free(context, &all);
    return status;
}
