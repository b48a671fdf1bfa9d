/* Surface samples: interpolation (x, S x), its transpose, volumes, and sampling of bodies. */
#include "surface_samples.h"

#include "geometry/sampling.h"
#include "point_volumes.h"

#include "projdyn/kernel.h"
#include "projdyn/simd.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

enum { PARTICLES = 2048, SAMPLES = 256 }; /* of a parallel block */

/* ---- interpolation and its transpose --------------------------------------------------------- */

struct call {
    const struct surface_samples *s;
    const double *in;
    double *out;
    int numbers;     /* per particle: 3 (vector) or 6 (block) */
    const int *list; /* the samples that are interpolated; NULL: all */
};

static void for_particles(pdyn_range_fn *fn, struct call call) {
    pool_for(call.s->context->pool, call.s->particles, PARTICLES, fn, &call);
}

static void for_samples(int count, pdyn_range_fn *fn, struct call call) {
    pool_for(call.s->context->pool, count, SAMPLES, fn, &call);
}

static void copy_particles(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    size_t begin = 3 * (size_t)first, count = 3 * (size_t)(last - first);
    memcpy(c->out + begin, c->in + begin, count * sizeof *c->out);
}

/* Interpolates samples from the three corners of their triangles. */
WIDE static void interpolate_samples(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int n = first; n < last; n++) {
        int k = c->list ? c->list[n] : n;
        double sum[3];
        samples_at(c->s, k, c->in, sum);
        memcpy(c->out + 3 * (size_t)(c->s->particles + k), sum, sizeof sum);
    }
}

/* out = (x, S x) for `count` samples of a list; x may be out itself. */
static void interpolate(const struct surface_samples *s, const int *list, int count,
                        const double *x, double *out) {
    const struct call call = {.s = s, .in = x, .out = out, .list = list};
    if (x != out) for_particles(copy_particles, call);
    for_samples(count, interpolate_samples, call);
}

void samples_interpolate(const struct surface_samples *s, const double *x, double *out) {
    interpolate(s, NULL, s->count, x, out);
}

void samples_interpolate_near(const struct surface_samples *s, const double *x, double *out) {
    interpolate(s, s->near, s->near_count, x, out);
}

void samples_interpolate_active(const struct surface_samples *s, const double *u) {
    interpolate(s, s->active, s->active_count, u, s->input);
}

static void clear_particles(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    size_t numbers = (size_t)c->numbers;
    memset(c->out + numbers * (size_t)first, 0, numbers * (size_t)(last - first) * sizeof *c->out);
}

static void clear_active(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    size_t numbers = (size_t)c->numbers;
    for (int k = first; k < last; k++)
        memset(c->out + numbers * (size_t)(c->s->particles + c->s->active[k]), 0,
               numbers * sizeof *c->out);
}

void samples_clear(const struct surface_samples *s, bool particles) {
    const struct call call = {.s = s, .out = s->output, .numbers = 3};
    if (particles) for_particles(clear_particles, call);
    for_samples(s->active_count, clear_active, call);
}

void samples_clear_blocks(const struct surface_samples *s) {
    const struct call call = {.s = s, .out = s->blocks, .numbers = 6};
    for_particles(clear_particles, call);
    for_samples(s->active_count, clear_active, call);
}

static void add_particles(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = c->numbers * first; k < c->numbers * last; k++) c->out[k] += c->in[k];
}

INLINE void add_samples_of(const struct call *c, int i, size_t numbers) {
    const struct surface_samples *s = c->s;
    double *to = c->out + numbers * (size_t)s->corner[i], sum[6] = {0};
    for (int t = s->corner_start[i]; t < s->corner_start[i + 1]; t++) {
        const double *from = c->in + numbers * (size_t)(s->particles + s->corner_entry[t] / 3);
        for (size_t a = 0; a < numbers; a++) sum[a] += s->weight[s->corner_entry[t]] * from[a];
    }
    for (size_t a = 0; a < numbers; a++) to[a] += sum[a];
}

/* A constant number of components keeps the sums in registers. */
WIDE static void add_samples(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++)
        if (c->numbers == 3) add_samples_of(c, i, 3);
        else add_samples_of(c, i, 6);
}

void samples_scatter(const struct surface_samples *s, double *y) {
    const struct call call = {.s = s, .in = s->output, .out = y, .numbers = 3};
    if (y != s->output) for_particles(add_particles, call);
    for_samples(s->corner_count, add_samples, call);
}

void samples_scatter_blocks(const struct surface_samples *s, double *blocks) {
    const struct call call = {.s = s, .in = s->blocks, .out = blocks, .numbers = 6};
    for_particles(add_particles, call);
    for_samples(s->corner_count, add_samples, call);
}

void samples_limit_motion(const struct surface_samples *s, double *max_step) {
    for (int k = 0; k < s->active_count; k++)
        for (int m = 3 * s->active[k]; m < 3 * s->active[k] + 3; m++)
            if (s->weight[m] > 0.0)
                max_step[s->vertex[m]] =
                    fmin(max_step[s->vertex[m]], max_step[s->particles + s->active[k]]);
}

/* ---- near and active samples ----------------------------------------------------------------- */

/* For every corner of active samples, lists the entries in which it appears. scratch: number of
 * entries per particle, then the next entry to write. */
static void list_corners(struct surface_samples *s) {
    int sum = 0;
    memset(s->scratch, 0, (size_t)s->particles * sizeof *s->scratch);
    for (int k = 0; k < s->active_count; k++)
        for (int m = 0; m < 3; m++) s->scratch[s->vertex[3 * s->active[k] + m]]++;
    s->corner_count = 0;
    for (int i = 0; i < s->particles; i++) {
        int entries = s->scratch[i];
        if (!entries) continue;
        s->corner[s->corner_count] = i, s->corner_start[s->corner_count++] = sum;
        s->scratch[i] = sum, sum += entries;
    }
    s->corner_start[s->corner_count] = sum;
    for (int k = 0; k < s->active_count; k++)
        for (int m = 3 * s->active[k]; m < 3 * s->active[k] + 3; m++)
            s->corner_entry[s->scratch[s->vertex[m]]++] = m;
}

void samples_update_active(struct surface_samples *s, const pdyn_neighbours *lists, const int *near,
                           int near_count) {
    s->near_count = near_count, s->active_count = 0;
    for (int k = 0; k < near_count; k++) {
        s->near[k] = near[k] - s->particles;
        if (lists->end[near[k]] > lists->start[near[k]]) s->active[s->active_count++] = s->near[k];
    }
    list_corners(s);
}

/* ---- volumes --------------------------------------------------------------------------------- */

/* Area of the triangle of sample k at x, m^2. */
static double area(const struct surface_samples *s, int k, const double *x) {
    double n[3];
    samples_normal(s, k, x, n);
    return 0.5 * vec3_length(n);
}

static void compute_volumes(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct surface_samples *s = c->s;
    for (int n = first; n < last; n++) {
        int k = s->near[n];
        c->out[k] = s->share[k] * area(s, k, c->in);
    }
}

void samples_update_volumes(struct surface_samples *s, const double *x) {
    for_samples(s->near_count, compute_volumes, (struct call){.s = s, .in = x, .out = s->volume});
}

/* ---- creation -------------------------------------------------------------------------------- */

static bool resize_arrays(struct surface_samples *s, enum array_action action) {
    size_t count = (size_t)s->count, particles = (size_t)s->particles;
    const struct array_entry table[] = {
        ARRAY(s->vertex, 3 * count),
        ARRAY(s->weight, 3 * count),
        ARRAY(s->volume, count),
        ARRAY(s->rest_volume, count),
        ARRAY(s->rest_area, count),
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
    double *volume = s->rest_volume + first, thickness = body->tets ? 0.0 : def->thickness;
    double factor = surface_kernel_farther(def->kernel, boundary_farther(thickness, def->spacing));
    if (def->model->volumes)
        return point_volumes(s->context, count, s->x + 3 * (size_t)first, def->kernel,
                             def->kernel->support * def->spacing, volume);
    for (int k = 0; k < count; k++) volume[k] = factor * s->rest_area[first + k] * def->spacing;
    return PDYN_OK;
}

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
    for (int k = 0; k < s->count; k++) s->share[k] = s->rest_volume[k] / area(s, k, def->rest);
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
