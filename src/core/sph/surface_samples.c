/* Surface samples (made by samples_create.c): interpolation (x, S x), its transpose, volumes. */
#include "surface_samples.h"

#include "projdyn/simd.h"

#include <math.h>
#include <string.h>

enum { PARTICLES = 2048, SAMPLES = 256 }; /* of a parallel block */

/* ---- interpolation and its transpose --------------------------------------------------------- */

struct call {
    const struct surface_samples *s;
    const double *in;
    double *out;
    int numbers;     /* per particle: 1, 3 (vector) or 6 (block) */
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
    size_t numbers = (size_t)c->numbers;
    size_t begin = numbers * (size_t)first, count = numbers * (size_t)(last - first);
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
    const struct call call = {.s = s, .in = x, .out = out, .numbers = 3, .list = list};
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
        if (c->numbers == 1) add_samples_of(c, i, 1);
        else if (c->numbers == 3) add_samples_of(c, i, 3);
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

void samples_lump(const struct surface_samples *s, const double *d, double *out) {
    const struct call call = {.s = s, .in = d, .out = out, .numbers = 1};
    for_particles(copy_particles, call);
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

static void compute_volumes(void *arg, int first, int last, int block) {
    (void)block;
    const struct call *c = arg;
    const struct surface_samples *s = c->s;
    for (int n = first; n < last; n++) {
        int k = s->near[n];
        c->out[k] = s->share[k] * samples_area(s, k, c->in);
    }
}

void samples_update_volumes(struct surface_samples *s, const double *x) {
    for_samples(s->near_count, compute_volumes, (struct call){.s = s, .in = x, .out = s->volume});
}
