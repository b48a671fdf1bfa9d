/* Sampling of triangles: a greedy Poisson-disk set of points, and their areas. */
#include "grid.h"
#include "sampling.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- points ---------------------------------------------------------------------------------- */

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

/* ---- candidates ------------------------------------------------------------------------------ */

/* Candidates lie at the corners of small parts of a triangle, at most a quarter spacing long. An
 * ordinary triangle has a lattice of barycentric coordinates with `cuts` parts along each side. A
 * long one has rows along its longest side instead, each with as many parts as its length needs:
 *
 *           apex                             row `rows`: one candidate
 *             o---o---o---o                  row 1
 *     o---o---o---o---o---o---o              row 0: `cuts` parts, the longest side
 */
struct pattern {
    double cuts;
    double rows; /* 0: a lattice */
    int apex;    /* corner opposite to the longest side */
};

/* A triangle is long if a lattice has at least this factor more candidates than rows have. */
static const double long_factor = 8.0;

static double count_lattice(double cuts) { return 0.5 * (cuts + 1.0) * (cuts + 2.0); }
/* An upper bound. */
static double count_rows(double cuts, double rows) { return (rows + 1.0) * (0.5 * cuts + 2.0); }
static double count_candidates(const struct pattern *p) {
    return p->rows > 0.0 ? count_rows(p->cuts, p->rows) : count_lattice(p->cuts);
}

static struct pattern pattern_of(const double *const c[3], double spacing) {
    const double part = 0.25 * spacing;
    double longest = 0.0, normal[3];
    struct pattern p = {0};
    for (int k = 0; k < 3; k++) {
        double side = vec3_distance(c[(k + 1) % 3], c[(k + 2) % 3]);
        if (side > longest) longest = side, p.apex = k;
    }
    p.cuts = fmax(1.0, ceil(longest / part));
    vec3_normal(normal, c[0], c[1], c[2]);
    double height = longest > 0.0 ? vec3_length(normal) / longest : 0.0;
    double rows = fmax(1.0, ceil(height / part));
    if (count_lattice(p.cuts) > long_factor * count_rows(p.cuts, rows)) p.rows = rows;
    return p;
}

/* Barycentric coordinates of a long triangle: `up` from 0, the longest side, to 1, the apex, and
 * `along` from 0 to 1. */
static void weights_in_row(const struct pattern *p, double up, double along, double *weight) {
    weight[p->apex] = up;
    weight[(p->apex + 2) % 3] = (1.0 - up) * along;
    weight[(p->apex + 1) % 3] = (1.0 - up) * (1.0 - along);
}

static void add_point(struct surface_points *points, int triangle, const double weight[3]) {
    struct surface_point *point = &points->point[points->count++];
    *point = (struct surface_point){.triangle = triangle};
    memcpy(point->weight, weight, sizeof point->weight);
}

static void add_rows(const struct pattern *p, int triangle, struct surface_points *out) {
    for (double i = 0; i <= p->rows; i++) {
        double weight[3], up = i / p->rows, cuts = ceil(p->cuts * (1.0 - up));
        for (double j = 0; j <= cuts; j++) {
            weights_in_row(p, up, j / fmax(1.0, cuts), weight);
            add_point(out, triangle, weight);
        }
    }
}

static void add_lattice(const struct pattern *p, int triangle, struct surface_points *out) {
    for (double i = 0; i <= p->cuts; i++)
        for (double j = 0; i + j <= p->cuts; j++)
            add_point(out, triangle,
                      (const double[3]){1.0 - (i + j) / p->cuts, i / p->cuts, j / p->cuts});
}

/* Allocates the candidates; refuses a surface that needs too many. */
static pdyn_status reserve_candidates(pdyn_context *context, const char *name, double spacing,
                                      double count, struct surface_points *out) {
    if (count > SURFACE_CANDIDATES)
        return context_fail(
            context, PDYN_BAD_INPUT,
            "the surface of \"%s\" needs %.3g points to find samples %g m apart, more "
            "than %d: the particle radius is too small for its size",
            name, count, spacing, SURFACE_CANDIDATES);
    out->point = NEW_ARRAY(context, count, struct surface_point);
    if (!out->point) return PDYN_NO_MEMORY;
    out->capacity = (size_t)count;
    return PDYN_OK;
}

/* Makes the candidates of all triangles. */
static pdyn_status mesh_candidates(pdyn_context *context, const char *name, const double *vertex,
                                   int triangles, const int *triangle, double spacing,
                                   struct surface_points *out) {
    const double *c[3];
    double count = 0.0;
    for (int t = 0; t < triangles; t++) {
        corners_of(vertex, triangle, t, c);
        struct pattern p = pattern_of(c, spacing);
        count += count_candidates(&p);
    }
    if (count == 0.0) return PDYN_OK;
    pdyn_status status = reserve_candidates(context, name, spacing, count, out);
    for (int t = 0; status == PDYN_OK && t < triangles; t++) {
        corners_of(vertex, triangle, t, c);
        struct pattern p = pattern_of(c, spacing);
        if (p.rows > 0.0) add_rows(&p, t, out);
        else add_lattice(&p, t, out);
    }
    return status;
}

/* ---- selection ------------------------------------------------------------------------------- */

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

struct sharing { /* adds areas of small parts of the surface to the nearest points */
    const struct grid *grid;
    const double *x;
    struct surface_points *points;
    struct grid_cells cells;
};

static void share(struct sharing *s, const double *at, double area) {
    int point = nearest_point(s->grid, &s->cells, s->x, at);
    if (point >= 0) s->points->point[point].area += area;
}

/* The parts of a lattice are triangles of equal area. */
static void share_lattice(struct sharing *s, const double *const c[3], double cuts, double area) {
    double u[3], v[3];
    for (int a = 0; a < 3; a++) u[a] = c[1][a] - c[0][a], v[a] = c[2][a] - c[0][a];
    for (double i = 0; i < cuts; i++)
        for (double j = 0; i + j < cuts; j++)
            for (double third = 1.0; third <= 2.0 && i + j + third <= cuts; third++) {
                double at[3];
                memcpy(at, c[0], sizeof at);
                vec3_add(at, (i + third / 3.0) / cuts, u);
                vec3_add(at, (j + third / 3.0) / cuts, v);
                share(s, at, area / (cuts * cuts));
            }
}

/* The parts of a long triangle are cells between two rows, with equal areas along the rows. */
static void share_rows(struct sharing *s, const double *const c[3], const struct pattern *p,
                       double area) {
    for (double i = 0; i < p->rows; i++) {
        double up = (i + 0.5) / p->rows, cells = fmax(1.0, ceil(p->cuts * (1.0 - up)));
        double each = area * (2.0 * (p->rows - i) - 1.0) / (p->rows * p->rows * cells);
        for (double j = 0; j < cells; j++) {
            double at[3] = {0}, weight[3];
            weights_in_row(p, up, (j + 0.5) / cells, weight);
            for (int k = 0; k < 3; k++) vec3_add(at, weight[k], c[k]);
            share(s, at, each);
        }
    }
}

static void share_triangle(struct sharing *s, const double *const c[3], double spacing) {
    double normal[3];
    struct pattern p = pattern_of(c, spacing);
    vec3_normal(normal, c[0], c[1], c[2]);
    double area = 0.5 * vec3_length(normal);
    s->cells = (struct grid_cells){0};
    if (p.rows > 0.0) share_rows(s, c, &p, area);
    else share_lattice(s, c, p.cuts, area);
}

/* Computes the areas of all points. A place of the surface has a point within 1.1 spacing. */
static pdyn_status share_surface(pdyn_context *context, const double *vertex, int triangles,
                                 const int *triangle, double spacing, const double *x,
                                 struct surface_points *points) {
    struct grid grid = {0};
    pdyn_status status = grid_create(context, points->count, 1.1 * spacing, &grid);
    if (status == PDYN_OK) status = grid_sort(context, &grid, points->count, NULL, x);
    struct sharing sharing = {&grid, x, points, {0}};
    for (int t = 0; status == PDYN_OK && t < triangles; t++) {
        const double *c[3];
        corners_of(vertex, triangle, t, c);
        share_triangle(&sharing, c, spacing);
    }
    grid_free(context, &grid);
    return status;
}

static void surface_point_positions(const struct surface_points *points, const double *vertex,
                                    const int *triangle, double *x) {
    for (int i = 0; i < points->count; i++)
        surface_point_position(&points->point[i], vertex, triangle, x + 3 * (size_t)i);
}

pdyn_status sample_triangles(pdyn_context *context, const char *name, const double *vertex,
                             int triangles, const int *triangle, double spacing,
                             struct surface_points *out) {
    pdyn_status status = mesh_candidates(context, name, vertex, triangles, triangle, spacing, out);
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
