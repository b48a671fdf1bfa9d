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

void patches_free(pdyn_context *context, struct patches *patches) {
    FREE_ARRAY(context, patches->patch, patches->capacity);
    point_list_free(context, &patches->at);
    *patches = (struct patches){0};
}

static pdyn_status add_patch(pdyn_context *context, struct patches *patches, const double x[3],
                             const struct patch *patch) {
    size_t count = (size_t)patches->at.count;
    if (count == patches->capacity) {
        size_t capacity = 2 * count + 1024;
        struct patch *grown = context_resize(context, patches->patch, count * sizeof *grown,
                                             capacity * sizeof *grown);
        if (!grown) return context_no_memory(context);
        patches->patch = grown, patches->capacity = capacity;
    }
    patches->patch[count] = *patch;
    return point_list_add(context, &patches->at, x);
}

/* One face: across axis a, at its lower or upper end. */
static pdyn_status sample_face(pdyn_context *context, const struct scene_box *box, int a,
                               bool upper, const struct face_grid *grid, struct patches *out) {
    double pitch[3], low[3], x[3];
    long n[3] = {0};
    for (int b = 0; b < 3; b++) {
        /* beyond the face only where another one begins */
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
            const struct patch patch = {.area = share * pitch[b] * pitch[c], .of_box = true};
            x[b] = low[b] + (double)i * pitch[b], x[c] = low[c] + (double)j * pitch[c];
            pdyn_status status = add_patch(context, out, x, &patch);
            if (status != PDYN_OK) return status;
        }
    return PDYN_OK;
}

pdyn_status sample_box_surface(pdyn_context *context, const struct scene_box *box,
                               const struct face_grid *grid, struct patches *out) {
    pdyn_status status = PDYN_OK;
    for (int side = 0; side < 6 && status == PDYN_OK; side++)
        if (!(grid->open >> side & 1u))
            status = sample_face(context, box, side / 2, side % 2, grid, out);
    return status;
}

/* ---- meshes: candidates in a fixed order, each taken unless one taken before is too close ---- */

static pdyn_status add_spot(pdyn_context *context, struct spots *spots, const struct spot *spot) {
    if (spots->count == POINT_LIST_MAX) return point_list_too_many(context);
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

static void corners_of(const double *vertex, const int *triangle, int t, const double *c[3]) {
    for (int k = 0; k < 3; k++) c[k] = vertex + 3 * (size_t)triangle[3 * t + k];
}

void spot_position(const struct spot *spot, const double *vertex, const int *triangle, double *x) {
    const double *c[3];
    corners_of(vertex, triangle, spot->triangle, c);
    for (int a = 0; a < 3; a++)
        x[a] =
            c[0][a] + spot->weight[1] * (c[1][a] - c[0][a]) + spot->weight[2] * (c[2][a] - c[0][a]);
}

/* Into how many parts the sides of a triangle are cut, a quarter spacing each. */
static double cuts_of(const double *const c[3], double spacing) {
    double longest =
        fmax(vec3_distance(c[0], c[1]), fmax(vec3_distance(c[1], c[2]), vec3_distance(c[2], c[0])));
    return fmax(1.0, ceil(longest / (0.25 * spacing)));
}

/* Candidates: a lattice of barycentric coordinates on every triangle, a quarter spacing apart. */
static pdyn_status mesh_candidates(pdyn_context *context, const double *vertex, int triangles,
                                   const int *triangle, double spacing, struct spots *out) {
    for (int t = 0; t < triangles; t++) {
        const double *c[3];
        corners_of(vertex, triangle, t, c);
        double cuts = cuts_of(c, spacing);
        for (double i = 0; i <= cuts; i++)
            for (double j = 0; i + j <= cuts; j++) {
                struct spot spot = {t, {1.0 - (i + j) / cuts, i / cuts, j / cuts}, 0.0};
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
        grid_update_cells(grid, at, &cells);
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

/* ---- the share of the surface that a spot stands for ----------------------------------------- */

enum { NEAR = 256 }; /* spots that can lie around a point: some 10 do */

static int nearest_spot(const struct grid *grid, struct grid_cells *cells, const double *x,
                        const double *at) {
    int list[NEAR + 1], best = -1;
    double least = INFINITY;
    grid_update_cells(grid, at, cells);
    int found = grid_query(grid, cells, at, grid->cell, -1, NULL, list, NEAR);
    for (int k = 0; k < found && k < NEAR; k++) {
        double distance = vec3_distance(at, x + 3 * (size_t)list[k]);
        if (distance < least) least = distance, best = list[k];
    }
    return best;
}

/* Gives the small triangles of the candidates' lattice to the nearest spots. */
static void share_triangle(const double *const c[3], double spacing, const struct grid *grid,
                           const double *x, struct spots *spots) {
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
                int spot = nearest_spot(grid, &cells, x, at);
                if (spot >= 0) spots->spot[spot].area += each;
            }
}

/* A spot lies nowhere farther than 1.1 spacings from the surface around it. */
static pdyn_status share_surface(pdyn_context *context, const double *vertex, int triangles,
                                 const int *triangle, double spacing, const double *x,
                                 struct spots *spots) {
    struct grid grid = {0};
    pdyn_status status = grid_create(context, spots->count, 1.1 * spacing, &grid);
    if (status == PDYN_OK) status = grid_sort(context, &grid, spots->count, NULL, x);
    for (int t = 0; status == PDYN_OK && t < triangles; t++) {
        const double *c[3];
        corners_of(vertex, triangle, t, c);
        share_triangle(c, spacing, &grid, x, spots);
    }
    grid_free(context, &grid);
    return status;
}

static void spot_positions(const struct spots *spots, const double *vertex, const int *triangle,
                           double *x) {
    for (int i = 0; i < spots->count; i++)
        spot_position(&spots->spot[i], vertex, triangle, x + 3 * (size_t)i);
}

pdyn_status sample_triangles(pdyn_context *context, const double *vertex, int triangles,
                             const int *triangle, double spacing, struct spots *out) {
    pdyn_status status = mesh_candidates(context, vertex, triangles, triangle, spacing, out);
    if (status != PDYN_OK || !out->count) return status;
    size_t count = (size_t)out->count;
    double *x = NEW_ARRAY(context, 3 * count, double);
    if (!x) return PDYN_NO_MEMORY;
    spot_positions(out, vertex, triangle, x);
    status = thin_candidates(context, out, x, 0.75 * spacing);
    if (status == PDYN_OK) {
        spot_positions(out, vertex, triangle, x);
        status = share_surface(context, vertex, triangles, triangle, spacing, x, out);
    }
    FREE_ARRAY(context, x, 3 * count);
    return status;
}

pdyn_status sample_mesh_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                struct patches *out) {
    struct spots spots = {0};
    pdyn_status status =
        sample_triangles(context, mesh->vertex, mesh->triangles, mesh->triangle, spacing, &spots);
    for (int i = 0; status == PDYN_OK && i < spots.count; i++) {
        double x[3];
        spot_position(&spots.spot[i], mesh->vertex, mesh->triangle, x);
        status = add_patch(context, out, x, &(struct patch){.area = spots.spot[i].area});
    }
    spots_free(context, &spots);
    return status;
}
