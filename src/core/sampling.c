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

/* ---- meshes: candidates in a fixed order, each taken unless one taken before is too close ---- */

static pdyn_status add_spot(pdyn_context *context, struct spots *spots, const struct spot *spot) {
    if (spots->count == POINTS_MOST) return points_too_many(context);
    if ((size_t)spots->count == spots->capacity) {
        size_t capacity = 2 * spots->capacity + 1024;
        struct spot *grown = context_resize(context, spots->spot, spots->capacity * sizeof *grown,
                                            capacity * sizeof *grown);
        if (!grown) return context_no_memory(context);
        spots->spot = grown, spots->capacity = capacity;
    }
    spots->spot[spots->count++] = *spot;
    return PDYN_OK;
}

void spots_free(pdyn_context *context, struct spots *spots) {
    FREE_ARRAY(context, spots->spot, spots->capacity);
    *spots = (struct spots){0};
}

void spot_position(const struct spot *spot, const double *vertex, const int *triangle, double *x) {
    const double *c[3];
    for (int k = 0; k < 3; k++) c[k] = vertex + 3 * (size_t)triangle[3 * spot->triangle + k];
    for (int a = 0; a < 3; a++)
        x[a] =
            c[0][a] + spot->weight[1] * (c[1][a] - c[0][a]) + spot->weight[2] * (c[2][a] - c[0][a]);
}

/* Candidates: a lattice of barycentric coordinates on every triangle, a quarter spacing apart. */
static pdyn_status mesh_candidates(pdyn_context *context, const double *vertex, int triangles,
                                   const int *triangle, double spacing, struct spots *out) {
    for (int t = 0; t < triangles; t++) {
        const double *c[3];
        for (int k = 0; k < 3; k++) c[k] = vertex + 3 * (size_t)triangle[3 * t + k];
        double longest = fmax(vec3_distance(c[0], c[1]),
                              fmax(vec3_distance(c[1], c[2]), vec3_distance(c[2], c[0])));
        double cuts = fmax(1.0, ceil(longest / (0.25 * spacing)));
        for (double i = 0; i <= cuts; i++)
            for (double j = 0; i + j <= cuts; j++) {
                struct spot spot = {t, {1.0 - (i + j) / cuts, i / cuts, j / cuts}};
                pdyn_status status = add_spot(context, out, &spot);
                if (status != PDYN_OK) return status;
            }
    }
    return PDYN_OK;
}

/* Takes candidates greedily; `taken` marks those in the set. */
static void thin_out(const struct grid *grid, const double *x, int count, double distance,
                     bool *taken) {
    struct grid_cells cells = {0};
    int one;
    for (int i = 0; i < count; i++) {
        const double *at = x + 3 * (size_t)i;
        grid_around(grid, at, &cells);
        taken[i] = !grid_query(grid, &cells, at, distance, i, taken, &one, 0);
    }
}

/* Keeps of the candidates at x a Poisson-disk set. */
static pdyn_status thin_candidates(pdyn_context *context, struct spots *spots, const double *x,
                                   double distance) {
    struct grid grid = {0};
    int count = spots->count;
    bool *taken = NEW_ARRAY(context, count, bool);
    pdyn_status status = taken ? grid_create(context, count, distance, &grid) : PDYN_NO_MEMORY;
    if (status == PDYN_OK) status = grid_sort(context, &grid, count, NULL, x);
    if (status == PDYN_OK) {
        thin_out(&grid, x, count, distance, taken);
        spots->count = 0;
        for (int i = 0; i < count; i++)
            if (taken[i]) spots->spot[spots->count++] = spots->spot[i];
    }
    FREE_ARRAY(context, taken, count);
    grid_free(context, &grid);
    return status;
}

pdyn_status sample_triangles(pdyn_context *context, const double *vertex, int triangles,
                             const int *triangle, double spacing, struct spots *out) {
    pdyn_status status = mesh_candidates(context, vertex, triangles, triangle, spacing, out);
    if (status != PDYN_OK || !out->count) return status;
    size_t count = (size_t)out->count;
    double *x = NEW_ARRAY(context, 3 * count, double);
    if (!x) return PDYN_NO_MEMORY;
    for (size_t i = 0; i < count; i++) spot_position(&out->spot[i], vertex, triangle, x + 3 * i);
    status = thin_candidates(context, out, x, 0.75 * spacing);
    FREE_ARRAY(context, x, 3 * count);
    return status;
}

pdyn_status sample_mesh_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                struct points *out) {
    struct spots spots = {0};
    pdyn_status status =
        sample_triangles(context, mesh->vertex, mesh->triangles, mesh->triangle, spacing, &spots);
    for (int i = 0; status == PDYN_OK && i < spots.count; i++) {
        double x[3];
        spot_position(&spots.spot[i], mesh->vertex, mesh->triangle, x);
        status = points_add(context, out, x);
    }
    spots_free(context, &spots);
    return status;
}
