/* Sampling of meshes: a greedy Poisson-disk set of points, and their areas. */
#include "grid.h"
#include "poisson_disk.h"
#include "sampling.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- points ---------------------------------------------------------------------------------- */

void surface_points_free(pdyn_context *context, struct surface_points *points) {
    FREE_ARRAY(context, points->point, points->capacity);
    *points = (struct surface_points){0};
}

void surface_point_position(const struct surface_point *point, const struct mesh *mesh, double *x) {
    const double *c[3];
    mesh_corners(mesh, point->triangle, c);
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

static double count_all(const struct mesh *mesh, double spacing) {
    double count = 0.0;
    for (int t = 0; t < mesh->triangles; t++) {
        const double *c[3];
        mesh_corners(mesh, t, c);
        struct pattern p = pattern_of(c, spacing);
        count += count_candidates(&p);
    }
    return count;
}

/* Barycentric coordinates of a long triangle: `up` from 0, the longest side, to 1, the apex, and
 * `along` from 0 to 1. */
static void weights_in_row(const struct pattern *p, double up, double along, double *weight) {
    weight[p->apex] = up;
    weight[(p->apex + 2) % 3] = (1.0 - up) * along;
    weight[(p->apex + 1) % 3] = (1.0 - up) * (1.0 - along);
}

/* ---- selection ------------------------------------------------------------------------------- */

/* A candidate is selected if no selected one is within the distance of the set. */
struct selection {
    pdyn_context *context;
    const struct mesh *mesh;
    struct poisson_disk set;
    struct surface_points *points;
    pdyn_status status; /* after a failure nothing more is selected */
};

static pdyn_status add_point(pdyn_context *context, struct surface_points *points,
                             const struct surface_point *point) {
    size_t need = (size_t)points->count + 1;
    struct surface_point *grown =
        context_grow(context, points->point, &points->capacity, need, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    points->point = grown;
    points->point[points->count++] = *point;
    return PDYN_OK;
}

static void offer(struct selection *s, int triangle, const double weight[3]) {
    struct surface_point point = {.triangle = triangle};
    double x[3];
    bool taken;
    if (s->status != PDYN_OK) return;
    memcpy(point.weight, weight, sizeof point.weight);
    surface_point_position(&point, s->mesh, x);
    s->status = poisson_disk_offer(s->context, &s->set, x, &taken);
    if (s->status == PDYN_OK && taken) s->status = add_point(s->context, s->points, &point);
}

static void offer_rows(struct selection *s, const struct pattern *p, int triangle) {
    for (double i = 0; i <= p->rows; i++) {
        double weight[3], up = i / p->rows, cuts = ceil(p->cuts * (1.0 - up));
        for (double j = 0; j <= cuts; j++) {
            weights_in_row(p, up, j / fmax(1.0, cuts), weight);
            offer(s, triangle, weight);
        }
    }
}

static void offer_lattice(struct selection *s, const struct pattern *p, int triangle) {
    for (double i = 0; i <= p->cuts; i++)
        for (double j = 0; i + j <= p->cuts; j++)
            offer(s, triangle,
                  (const double[3]){1.0 - (i + j) / p->cuts, i / p->cuts, j / p->cuts});
}

/* Refuses a surface that would take too long. */
static pdyn_status check_size(const char *name, const struct mesh *mesh, double spacing) {
    double count = count_all(mesh, spacing);
    if (count <= SURFACE_CANDIDATES) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT,
                     "the surface of \"%s\" has %.3g m^2, too many for samples %g m apart "
                     "(%.3g points to choose from, at most %d): if its mesh is not in metres, "
                     "give it a \"scale\"; else make it no larger than fluid reaches, or the "
                     "particles larger",
                     name, mesh_area(mesh), spacing, count, SURFACE_CANDIDATES);
}

/* Selects from the candidates of all triangles. */
static void select_points(struct selection *s, double spacing) {
    const double *c[3];
    for (int t = 0; t < s->mesh->triangles; t++) {
        mesh_corners(s->mesh, t, c);
        struct pattern p = pattern_of(c, spacing);
        if (p.rows > 0.0) offer_rows(s, &p, t);
        else offer_lattice(s, &p, t);
    }
}

/* ---- area of points -------------------------------------------------------------------------- */

enum { NEAR = 256 }; /* largest number of points near a place of the surface; about 10 occur */

static int nearest_point(const struct grid *grid, struct grid_cells *cells, const double *x,
                         const double *at) {
    int list[NEAR + 1], best = -1;
    double smallest = INFINITY;
    grid_update_cells(grid, at, cells);
    int found = grid_query(grid, cells, at, grid->cell, -1, list, NEAR);
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
static pdyn_status share_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                 const double *x, struct surface_points *points) {
    struct grid grid = {0};
    pdyn_status status = grid_create(context, points->count, 1.1 * spacing, &grid);
    if (status == PDYN_OK) status = grid_sort(&grid, points->count, NULL, x);
    struct sharing sharing = {&grid, x, points, {0}};
    for (int t = 0; status == PDYN_OK && t < mesh->triangles; t++) {
        const double *c[3];
        mesh_corners(mesh, t, c);
        share_triangle(&sharing, c, spacing);
    }
    grid_free(context, &grid);
    return status;
}

pdyn_status sample_triangles(pdyn_context *context, const char *name, const struct mesh *mesh,
                             double spacing, struct surface_points *out) {
    struct selection s = {context, mesh, {.distance = 0.75 * spacing}, out, PDYN_OK};
    s.status = check_size(name, mesh, spacing);
    if (s.status == PDYN_OK) select_points(&s, spacing);
    if (s.status == PDYN_OK && out->count)
        s.status = share_surface(context, mesh, spacing, s.set.at.x, out);
    poisson_disk_free(context, &s.set);
    return s.status;
}
