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

/* ---- parts of triangles ---------------------------------------------------------------------- */

/* A part of a triangle. A lattice cuts its sides into equal pieces, at most a quarter spacing long.
 * A long part, whose lattice would be much finer across than along, is halved across its longest
 * side, again and again:
 *
 *                 .o
 *           . o'   |
 *     o ------+----o
 */
struct part {
    double corner[3][3]; /* m */
    double weight[3][3]; /* barycentric coordinates of the corners */
    int halvings;        /* that made it from the triangle */
};

/* Returns whether to go on with the next part. */
typedef bool part_fn(void *arg, const struct part *part, double cuts);

static const double long_side = 4.0; /* longest side over height of a long part */
static const double few_cuts = 8.0;  /* parts with so few are not halved */
/* Two halvings halve the longest side: a triangle that needs more has too many candidates. Without
 * an end, halving would go on for ever where coordinates are so large that the middle of a side is
 * rounded to one of its ends. */
enum { MOST_HALVINGS = 64 };

static double count_lattice(double cuts) { return 0.5 * (cuts + 1.0) * (cuts + 2.0); }

/* Moves corner k of a part to the middle between corners k and l. */
static void move_corner(struct part *part, int k, int l) {
    for (int a = 0; a < 3; a++) {
        part->corner[k][a] = 0.5 * (part->corner[k][a] + part->corner[l][a]);
        part->weight[k][a] = 0.5 * (part->weight[k][a] + part->weight[l][a]);
    }
}

static bool is_long(const struct part *part, double longest, double cuts) {
    double normal[3];
    vec3_normal(normal, part->corner[0], part->corner[1], part->corner[2]);
    return cuts > few_cuts && part->halvings < MOST_HALVINGS &&
           longest * longest > long_side * vec3_length(normal);
}

/* Calls fn for the part, or for the parts that a long one is cut into, until it returns false.
 * Returns false then. */
static bool for_parts(const struct part *part, double spacing, part_fn *fn, void *arg) {
    int apex = 0; /* opposite to the longest side */
    double longest = 0.0;
    for (int k = 0; k < 3; k++) {
        double side = vec3_distance(part->corner[(k + 1) % 3], part->corner[(k + 2) % 3]);
        if (side > longest) longest = side, apex = k;
    }
    double cuts = fmax(1.0, ceil(longest / (0.25 * spacing)));
    if (!is_long(part, longest, cuts)) return fn(arg, part, cuts);
    for (int k = 1; k <= 2; k++) {
        struct part half = *part;
        half.halvings++;
        move_corner(&half, (apex + k) % 3, (apex + 3 - k) % 3);
        if (!for_parts(&half, spacing, fn, arg)) return false;
    }
    return true;
}

static bool for_parts_of(const struct mesh *mesh, int triangle, double spacing, part_fn *fn,
                         void *arg) {
    struct part part = {.weight = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
    const double *c[3];
    mesh_corners(mesh, triangle, c);
    for (int k = 0; k < 3; k++) memcpy(part.corner[k], c[k], sizeof part.corner[k]);
    return for_parts(&part, spacing, fn, arg);
}

static bool count_part(void *arg, const struct part *part, double cuts) {
    double *count = arg;
    (void)part;
    *count += count_lattice(cuts);
    return *count <= SURFACE_CANDIDATES;
}

/* Whether the surface has at most SURFACE_CANDIDATES. */
static bool has_few_candidates(const struct mesh *mesh, double spacing) {
    double count = 0.0;
    for (int t = 0; t < mesh->triangles; t++)
        if (!for_parts_of(mesh, t, spacing, count_part, &count)) return false;
    return true;
}

/* ---- selection ------------------------------------------------------------------------------- */

/* A candidate is selected if no selected one is within the distance of the set. */
struct selection {
    pdyn_context *context;
    const struct mesh *mesh;
    int triangle; /* that candidates are from */
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

static void offer(struct selection *s, const double weight[3]) {
    struct surface_point point = {.triangle = s->triangle};
    double x[3];
    bool taken;
    if (s->status != PDYN_OK) return;
    memcpy(point.weight, weight, sizeof point.weight);
    surface_point_position(&point, s->mesh, x);
    s->status = poisson_disk_offer(s->context, &s->set, x, &taken);
    if (s->status == PDYN_OK && taken) s->status = add_point(s->context, s->points, &point);
}

/* Offers the corners of a lattice. */
static bool offer_part(void *arg, const struct part *part, double cuts) {
    for (double i = 0; i <= cuts; i++)
        for (double j = 0; i + j <= cuts; j++) {
            double weight[3] = {0};
            vec3_add(weight, 1.0 - (i + j) / cuts, part->weight[0]);
            vec3_add(weight, i / cuts, part->weight[1]);
            vec3_add(weight, j / cuts, part->weight[2]);
            offer(arg, weight);
        }
    return true;
}

/* Refuses a surface that would take too long. A thin one may have a small area. */
static pdyn_status check_size(const char *name, const struct mesh *mesh, double spacing) {
    if (has_few_candidates(mesh, spacing)) return PDYN_OK;
    struct box box = box_around(mesh->vertex, mesh->vertices);
    return set_error(PDYN_BAD_INPUT,
                     "the surface of \"%s\" is %.3g m long and has %.3g m^2, too large for samples "
                     "%g m apart (above %d points to choose from): if its mesh is not in metres, "
                     "give it a \"scale\"; else make it no larger than fluid reaches, or the "
                     "particles larger",
                     name, box_extent(&box), mesh_area(mesh), spacing, SURFACE_CANDIDATES);
}

/* Selects from the candidates of all triangles. */
static void select_points(struct selection *s, double spacing) {
    for (s->triangle = 0; s->triangle < s->mesh->triangles; s->triangle++)
        for_parts_of(s->mesh, s->triangle, spacing, offer_part, s);
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

/* The cells of a lattice are triangles of equal area. */
static bool share_part(void *arg, const struct part *part, double cuts) {
    double u[3], v[3], normal[3];
    vec3_normal(normal, part->corner[0], part->corner[1], part->corner[2]);
    vec3_subtract(u, part->corner[1], part->corner[0]);
    vec3_subtract(v, part->corner[2], part->corner[0]);
    double area = 0.5 * vec3_length(normal);
    for (double i = 0; i < cuts; i++)
        for (double j = 0; i + j < cuts; j++)
            for (double third = 1.0; third <= 2.0 && i + j + third <= cuts; third++) {
                double at[3];
                memcpy(at, part->corner[0], sizeof at);
                vec3_add(at, (i + third / 3.0) / cuts, u);
                vec3_add(at, (j + third / 3.0) / cuts, v);
                share(arg, at, area / (cuts * cuts));
            }
    return true;
}

/* Computes the areas of all points. A place of the surface has a point within 1.1 spacing. */
static pdyn_status share_surface(pdyn_context *context, const struct mesh *mesh, double spacing,
                                 const double *x, struct surface_points *points) {
    struct grid grid = {0};
    pdyn_status status = grid_create(context, points->count, 1.1 * spacing, &grid);
    if (status == PDYN_OK) status = grid_sort(&grid, points->count, NULL, x);
    struct sharing sharing = {&grid, x, points, {0}};
    for (int t = 0; status == PDYN_OK && t < mesh->triangles; t++) {
        sharing.cells = (struct grid_cells){0};
        for_parts_of(mesh, t, spacing, share_part, &sharing);
    }
    grid_free(context, &grid);
    return status;
}

pdyn_status sample_triangles(pdyn_context *context, const char *name, const struct mesh *mesh,
                             double spacing, struct surface_points *out) {
    struct selection s = {context, mesh, 0, {.distance = 0.75 * spacing}, out, PDYN_OK};
    s.status = check_size(name, mesh, spacing);
    if (s.status == PDYN_OK) select_points(&s, spacing);
    if (s.status == PDYN_OK && out->count)
        s.status = share_surface(context, mesh, spacing, s.set.at.x, out);
    poisson_disk_free(context, &s.set);
    return s.status;
}
