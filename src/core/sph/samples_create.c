/* Creation of surface samples: points on the surfaces of bodies, and their volumes at rest. */
#include "base/body.h"
#include "geometry/sampling.h"
#include "point_volumes.h"
#include "surface_samples.h"

#include "projdyn/kernel.h"

#include <math.h>
#include <string.h>

static bool resize_arrays(struct surface_samples *s, enum array_action action) {
    size_t count = (size_t)s->count, particles = (size_t)s->particles;
    const struct array_entry table[] = {
        ARRAY(s->vertex, 3 * count),
        ARRAY(s->weight, 3 * count),
        ARRAY(s->volume, count),
        ARRAY(s->rest_volume, count),
        ARRAY(s->rest_area, count),
        ARRAY(s->has_inside, count),
        ARRAY(s->share, count),
        ARRAY(s->near, count),
        ARRAY(s->active, count),
        ARRAY(s->corner, particles),
        ARRAY(s->scratch, particles),
        ARRAY(s->corner_start, particles + 1),
        ARRAY(s->corner_entry, 3 * count),
        ARRAY(s->x, 3 * (particles + count) + 1),
        ARRAY(s->input, 3 * (particles + count) + 1),
        ARRAY(s->output, 3 * (particles + count) + 1),
        ARRAY(s->blocks, 6 * (particles + count)),
    };
    return context_arrays(s->context, table, ARRAY_ROWS(table), action);
}

void samples_free(struct surface_samples *s) {
    if (!s) return;
    resize_arrays(s, ARRAYS_FREE);
    FREE_ARRAY(s->context, s, 1);
}

/* ---- one surface ----------------------------------------------------------------------------- */

/* The surface of a body at rest, which is not to be changed. */
static struct mesh mesh_of(const pdyn_body *body) {
    return (struct mesh){body->count, (double *)body->rest, body->triangles, (int *)body->triangle};
}

/* Sets up the samples of one surface from index `first` on. Writes positions to s->x. */
static void place(struct surface_samples *s, const pdyn_body *body,
                  const struct surface_points *points, int first) {
    const struct mesh mesh = mesh_of(body);
    for (int k = 0; k < points->count; k++) {
        const struct surface_point *point = &points->point[k];
        const int *corner = body->triangle + 3 * point->triangle;
        int *vertex = s->vertex + 3 * (first + k);
        for (int m = 0; m < 3; m++) vertex[m] = body->first + corner[m];
        memcpy(s->weight + 3 * (first + k), point->weight, sizeof point->weight);
        surface_point_position(point, &mesh, s->x + 3 * (size_t)(first + k));
        s->rest_area[first + k] = point->area;
        s->has_inside[first + k] = !body_is_sheet(body);
    }
}

/* Surfaces that a fluid passes, and points on a border, add nothing to the density: so small a
 * share of their volume is listed as a neighbour and pushes nothing. */
static const double open_share = 1e-9;

/* Beside a border, particles of the other side are neighbours: the nearer the border, the more of
 * them take the place of samples. triangle: the first one of the surface. */
static void reduce_beside_border(struct surface_samples *s, const struct samples_def *def,
                                 int triangle, const struct surface_points *points, int first) {
    for (int k = 0; k < points->count; k++) {
        const double *at = s->x + 3 * (size_t)(first + k);
        double distance =
            border_distance(def->border, triangle + points->point[k].triangle, def->rest, at);
        s->rest_volume[first + k] *= fmax(open_share, distance / def->border->width);
    }
}

/* The volumes, m^3, with which `count` samples of a body from `first` on enter SPH sums: area times
 * spacing, or 1 / sum W. */
static pdyn_status set_volumes(struct surface_samples *s, const struct samples_def *def,
                               const pdyn_body *body, int first, int count) {
    double *volume = s->rest_volume + first, thickness = body_is_thick(body) ? def->thickness : 0.0;
    double factor = surface_kernel_farther(def->kernel, boundary_farther(thickness, def->spacing));
    if (def->model->volumes)
        return point_volumes(s->context, count, s->x + 3 * (size_t)first, def->kernel,
                             def->kernel->support * def->spacing, volume);
    for (int k = 0; k < count; k++) volume[k] = factor * s->rest_area[first + k] * def->spacing;
    return PDYN_OK;
}

/* ---- creation -------------------------------------------------------------------------------- */

static pdyn_status fill(struct surface_samples *s, const struct samples_def *def,
                        const struct surface_points *points) {
    pdyn_status status = resize_arrays(s, ARRAYS_ALLOCATE) ? PDYN_OK : PDYN_NO_MEMORY;
    int first = 0, triangle = 0;
    for (int b = 0; b < def->bodies && status == PDYN_OK; b++) {
        const pdyn_body *body = &def->body[b];
        place(s, body, &points[b], first);
        status = set_volumes(s, def, body, first, points[b].count);
        for (int k = first; body->permeability > 0.0 && k < first + points[b].count; k++)
            s->rest_volume[k] *= open_share;
        if (hiding_triangles(body) && def->border->width > 0.0)
            reduce_beside_border(s, def, triangle, &points[b], first);
        triangle += hiding_triangles(body), first += points[b].count;
    }
    if (status != PDYN_OK) return status;
    for (int k = 0; k < s->count; k++)
        s->share[k] = s->rest_volume[k] / samples_area(s, k, def->rest);
    return PDYN_OK;
}

static pdyn_status create(pdyn_context *context, const struct samples_def *def,
                          const struct surface_points *points, int count,
                          struct surface_samples **out) {
    struct surface_samples *s = *out = NEW_ARRAY(context, 1, struct surface_samples);
    if (!s) return PDYN_NO_MEMORY;
    s->context = context, s->particles = def->particles, s->count = count;
    pdyn_status status = fill(s, def, points);
    if (status != PDYN_OK) samples_free(s), *out = NULL;
    return status;
}

pdyn_status samples_create(pdyn_context *context, const struct samples_def *def,
                           struct surface_samples **out) {
    double distance = def->model->mesh_spacing * def->spacing;
    struct surface_points *points = NEW_ARRAY(context, def->bodies, struct surface_points);
    pdyn_status status = points ? PDYN_OK : PDYN_NO_MEMORY;
    int count = 0;
    *out = NULL;
    for (int b = 0; b < def->bodies && status == PDYN_OK; count += points[b++].count) {
        const struct mesh mesh = mesh_of(&def->body[b]);
        status = sample_triangles(context, def->body[b].name, &mesh, distance, &points[b]);
    }
    if (status == PDYN_OK && count) status = create(context, def, points, count, out);
    for (int b = 0; points && b < def->bodies; b++) surface_points_free(context, &points[b]);
    FREE_ARRAY(context, points, def->bodies);
    return status;
}
