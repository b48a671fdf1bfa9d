#include "surface_samples.h"

#include "geometry/sampling.h"
#include "neighbours.h"

#include "base/simd.h"
#include "projdyn/vec3.h"

#include <math.h>

#include <string.h>

enum { GRAIN = 2048 };

/* ---- from particles to samples and back ------------------------------------------------------ */

struct call {
    const struct samples *s;
    const double *in;
    double *out;
    int numbers; /* of a particle */
};

static void for_all(const struct samples *s, int count, pdyn_range_fn *fn, const double *in,
                    double *out, int numbers) {
    struct call call = {s, in, out, numbers};
    pool_for(s->context->pool, count, GRAIN, fn, &call);
}

/* The three corners' share of sample k. */
INLINE void interpolate(const struct samples *s, int k, const double *x, double *out) {
    double sum[3] = {0};
    for (int m = 3 * k; m < 3 * k + 3; m++)
        vec3_add(sum, s->weight[m], x + 3 * (size_t)s->vertex[m]);
    memcpy(out + 3 * (size_t)(s->particles + k), sum, sizeof sum);
}

static void interpolate_all(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = first; k < last; k++) interpolate(c->s, k, c->in, c->out);
}

void samples_extend(const struct samples *s, const double *x, double *out) {
    memcpy(out, x, 3 * (size_t)s->particles * sizeof *x);
    for_all(s, s->count, interpolate_all, x, out, 3);
}

WIDE static void interpolate_near(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = first; k < last; k++) interpolate(c->s, c->s->near[k], c->in, c->out);
}

void samples_follow(const struct samples *s, const double *u) {
    if (u != s->input) memcpy(s->input, u, 3 * (size_t)s->particles * sizeof *u);
    for_all(s, s->live, interpolate_near, u, s->input, 3);
}

static void add_own(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int k = c->numbers * first; k < c->numbers * last; k++) c->out[k] += c->in[k];
}

INLINE void add_touching(const struct call *c, int i, size_t numbers) {
    const struct samples *s = c->s;
    double *to = c->out + numbers * (size_t)s->corner[i], sum[6] = {0};
    for (int t = s->touch_start[i]; t < s->touch_start[i + 1]; t++) {
        const double *from = c->in + numbers * (size_t)(s->particles + s->touch[t] / 3);
        for (size_t a = 0; a < numbers; a++) sum[a] += s->weight[s->touch[t]] * from[a];
    }
    for (size_t a = 0; a < numbers; a++) to[a] += sum[a];
}

/* Vectors or blocks: with a number that is known, sums stay in registers. */
WIDE static void add_from_samples(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    for (int i = first; i < last; i++)
        if (c->numbers == 3) add_touching(c, i, 3);
        else add_touching(c, i, 6);
}

static void gather(const struct samples *s, const double *extended, double *out, int numbers) {
    if (out != extended) for_all(s, s->particles, add_own, extended, out, numbers);
    for_all(s, s->touched, add_from_samples, extended, out, numbers);
}

void samples_gather(const struct samples *s, const double *extended, double *y) {
    gather(s, extended, y, 3);
}

void samples_gather_blocks(const struct samples *s, const double *extended, double *blocks) {
    gather(s, extended, blocks, 6);
}

void samples_limit(const struct samples *s, double *way) {
    for (int k = 0; k < s->live; k++)
        for (int m = 3 * s->near[k]; m < 3 * s->near[k] + 3; m++)
            if (s->weight[m] > 0.0)
                way[s->vertex[m]] = fmin(way[s->vertex[m]], way[s->particles + s->near[k]]);
}

/* ---- which of them matter -------------------------------------------------------------------- */

/* For every particle that samples which are near lie on, these. place: how many there are of each,
 * then its place in `corner`, then where its next one goes. */
static void transpose(struct samples *s) {
    int sum = 0;
    memset(s->place, 0, (size_t)s->particles * sizeof *s->place);
    for (int k = 0; k < s->live; k++)
        for (int m = 0; m < 3; m++) s->place[s->vertex[3 * s->near[k] + m]]++;
    s->touched = 0;
    for (int i = 0; i < s->particles; i++) {
        int own = s->place[i];
        if (!own) continue;
        s->corner[s->touched] = i, s->touch_start[s->touched++] = sum;
        s->place[i] = sum, sum += own;
    }
    s->touch_start[s->touched] = sum;
    for (int k = 0; k < s->live; k++)
        for (int m = 3 * s->near[k]; m < 3 * s->near[k] + 3; m++)
            s->touch[s->place[s->vertex[m]]++] = m;
}

void samples_reach(struct samples *s, const pdyn_neighbours *lists) {
    s->live = 0;
    for (int k = 0; k < s->count; k++)
        if (lists->end[s->particles + k] > lists->start[s->particles + k]) s->near[s->live++] = k;
    transpose(s);
}

/* ---- volumes --------------------------------------------------------------------------------- */

/* Of the triangle of sample k, m^2. */
static double area(const struct samples *s, int k, const double *x) {
    const double *c[3];
    double n[3];
    for (int m = 0; m < 3; m++) c[m] = x + 3 * (size_t)s->vertex[3 * k + m];
    vec3_normal(n, c[0], c[1], c[2]);
    return 0.5 * vec3_length(n);
}

static void stretch(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct samples *s = c->s;
    for (int k = first; k < last; k++)
        c->out[k] = s->rest_volume[k] * area(s, k, c->in) / s->rest_area[k];
}

void samples_stretch(struct samples *s, const double *x) {
    for_all(s, s->count, stretch, x, s->volume, 1);
}

/* ---- setting up ------------------------------------------------------------------------------ */

static bool allocate(struct samples *s) {
    size_t n = (size_t)s->count;
    s->vertex = NEW_ARRAY(s->context, 3 * n, int);
    s->weight = NEW_ARRAY(s->context, 3 * n, double);
    s->volume = NEW_ARRAY(s->context, n, double);
    s->rest_volume = NEW_ARRAY(s->context, n, double);
    s->rest_area = NEW_ARRAY(s->context, n, double);
    s->near = NEW_ARRAY(s->context, n, int);
    s->corner = NEW_ARRAY(s->context, s->particles, int);
    s->place = NEW_ARRAY(s->context, s->particles, int);
    s->touch_start = NEW_ARRAY(s->context, s->particles + 1, int);
    s->touch = NEW_ARRAY(s->context, 3 * n, int);
    s->x = NEW_VECTOR(s->context, s->particles + s->count);
    s->input = NEW_VECTOR(s->context, s->particles + s->count);
    s->output = NEW_VECTOR(s->context, s->particles + s->count);
    s->blocks = NEW_ARRAY(s->context, 6 * ((size_t)s->particles + n), double);
    return s->vertex && s->weight && s->volume && s->rest_volume && s->rest_area && s->near &&
           s->corner && s->place && s->touch_start && s->touch && s->x && s->input && s->output &&
           s->blocks;
}

void samples_free(struct samples *s) {
    if (!s) return;
    size_t n = (size_t)s->count;
    FREE_ARRAY(s->context, s->vertex, 3 * n);
    FREE_ARRAY(s->context, s->weight, 3 * n);
    FREE_ARRAY(s->context, s->volume, n);
    FREE_ARRAY(s->context, s->rest_volume, n);
    FREE_ARRAY(s->context, s->rest_area, n);
    FREE_ARRAY(s->context, s->near, n);
    FREE_ARRAY(s->context, s->corner, s->particles);
    FREE_ARRAY(s->context, s->place, s->particles);
    FREE_ARRAY(s->context, s->touch_start, s->particles + 1);
    FREE_ARRAY(s->context, s->touch, 3 * n);
    FREE_VECTOR(s->context, s->x, s->particles + s->count);
    FREE_VECTOR(s->context, s->input, s->particles + s->count);
    FREE_VECTOR(s->context, s->output, s->particles + s->count);
    FREE_ARRAY(s->context, s->blocks, 6 * ((size_t)s->particles + n));
    FREE_ARRAY(s->context, s, 1);
}

/* The samples of one surface, from `first` on; their positions go to s->x, areas to s->volume. */
static void place(struct samples *s, const pdyn_body *body, const struct surface_points *points,
                  int first, const double *rest) {
    for (int k = 0; k < points->count; k++) {
        const struct surface_point *point = &points->point[k];
        const int *corner = body->triangle + 3 * point->triangle;
        int *vertex = s->vertex + 3 * (first + k);
        for (int m = 0; m < 3; m++) vertex[m] = body->first + corner[m];
        memcpy(s->weight + 3 * (first + k), point->weight, sizeof point->weight);
        surface_point_position(point, body->rest, body->triangle, s->x + 3 * (size_t)(first + k));
        s->rest_area[first + k] = area(s, first + k, rest);
        s->volume[first + k] = point->area;
    }
}

struct wanted { /* of all samples */
    const struct boundary_model *model;
    double thickness, spacing; /* m */
};

static pdyn_status fill(struct samples *s, int bodies, const pdyn_body *body,
                        const struct surface_points *points, const struct wanted *wanted,
                        const double *rest) {
    pdyn_status status = allocate(s) ? PDYN_OK : PDYN_NO_MEMORY;
    for (int b = 0, first = 0; b < bodies && status == PDYN_OK; first += points[b++].count) {
        place(s, &body[b], &points[b], first, rest);
        status = boundary_volumes(
            s->context, wanted->model, points[b].count, s->x + 3 * (size_t)first, s->volume + first,
            body[b].tets ? 0.0 : wanted->thickness, wanted->spacing, s->rest_volume + first);
    }
    if (status != PDYN_OK) return status;
    for (int k = 0; k < s->count; k++) s->near[s->live++] = k;
    transpose(s);
    return PDYN_OK;
}

pdyn_status samples_create(pdyn_context *context, int bodies, const pdyn_body *body, int particles,
                           const double *rest, const struct boundary_model *model, double thickness,
                           double spacing, struct samples **out) {
    const struct wanted wanted = {model, thickness, spacing};
    struct surface_points *points = NEW_ARRAY(context, bodies, struct surface_points);
    pdyn_status status = points ? PDYN_OK : PDYN_NO_MEMORY;
    int count = 0;
    *out = NULL;
    for (int b = 0; b < bodies && status == PDYN_OK; count += points[b++].count)
        status = sample_triangles(context, body[b].rest, body[b].triangles, body[b].triangle,
                                  model->mesh_spacing * spacing, &points[b]);
    if (status == PDYN_OK && count) {
        *out = NEW_ARRAY(context, 1, struct samples);
        if (!*out) status = PDYN_NO_MEMORY;
        else {
            **out = (struct samples){.context = context, .particles = particles, .count = count};
            status = fill(*out, bodies, body, points, &wanted, rest);
        }
    }
    if (status != PDYN_OK) samples_free(*out), *out = NULL;
    for (int b = 0; points && b < bodies; b++) surface_points_free(context, &points[b]);
    FREE_ARRAY(context, points, bodies);
    return status;
}
