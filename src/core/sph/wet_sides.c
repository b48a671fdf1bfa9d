#include "wet_sides.h"

#include "base/body.h"
#include "projdyn/kernel.h"
#include "projdyn/vec3.h"
#include "scene/scene.h"
#include "surface_samples.h"

#include <string.h>

enum { WIDTH = sizeof((pdyn_wet_side){0}.particle) / sizeof(int) };
enum { MOST = WIDTH - 3 }; /* particles on a side; 9 touch a sheet at rest */
enum { SAMPLES = 256 };    /* grain */

/* The wet part of a side is the fluid's density sum at the sample, in units of the rest density,
 * over this number, up to 1. A lattice of particles that touches the surface is to wet all of it:
 * its smallest sum is 0.049, between four particles (0.105 for points with volumes). */
static const double wet_share = 0.05;

struct side { /* of a sample */
    int count, particle[MOST];
    double share[MOST], sum; /* of each particle in the density sum; all together */
};

/* The normal of a sample and the fluid on its two sides; the normal points to the second side. */
static void find_fluid(const struct wet_sides *d, int sample, double n[3], struct side side[2]) {
    const pdyn_neighbours *l = d->lists;
    struct kernel kernel = kernel_make(l->kernel, l->surface_support);
    int at = d->samples->particles + sample;
    const double *x = d->x + 3 * (size_t)at;
    samples_normal(d->samples, sample, d->x, n);
    vec3_normalise(n);
    memset(side, 0, 2 * sizeof *side);
    for (int s = l->start[at]; s < l->surface_start[at]; s++) {
        int i = l->index[s];
        double r[3];
        vec3_subtract(r, d->x + 3 * (size_t)i, x);
        double share = l->volume[i] * kernel_value(&kernel, vec3_length(r));
        struct side *to = &side[vec3_dot(r, n) > 0.0];
        if (share == 0.0 || to->count == MOST) continue;
        to->particle[to->count] = i, to->share[to->count++] = share;
        to->sum += share;
    }
}

static void count_sides(void *arg, int first, int last, int block) {
    (void)block;
    const struct wet_sides *d = arg;
    for (int k = first; k < last; k++) {
        struct side side[2];
        double n[3];
        d->first[2 * k] = d->first[2 * k + 1] = 0;
        if (d->along[k] == 0.0 && d->across[k] == 0.0) continue;
        find_fluid(d, k, n, side);
        for (int m = 0; m < 2; m++) d->first[2 * k + m] = side[m].count > 0;
    }
}

/* Entries that are not needed select the sample's first corner with 0. */
static void set_side(const struct wet_sides *d, int e, int sample, const double n[3],
                     const struct side *side, double both) {
    const struct surface_samples *s = d->samples;
    pdyn_wet_side *to = &d->side[e];
    double stretched = s->volume[sample] / s->rest_volume[sample]; /* area over the area at rest */
    for (int k = 0; k < WIDTH; k++) to->particle[k] = s->vertex[3 * sample], to->coefficient[k] = 0;
    for (int k = 0; k < 3; k++) {
        to->particle[k] = s->vertex[3 * sample + k];
        to->coefficient[k] = -s->weight[3 * sample + k];
    }
    for (int k = 0; k < side->count; k++) {
        to->particle[3 + k] = side->particle[k];
        to->coefficient[3 + k] = side->share[k] / side->sum;
    }
    memcpy(to->normal, n, sizeof to->normal);
    to->along = d->along[sample] * stretched * fmin(1.0, side->sum / wet_share);
    to->across = d->across[sample] * stretched * fmin(1.0, both / wet_share) * side->sum / both;
}

static void fill_sides(void *arg, int first, int last, int block) {
    (void)block;
    const struct wet_sides *d = arg;
    for (int k = first; k < last; k++) {
        struct side side[2];
        double n[3];
        if (d->first[2 * k + 2] == d->first[2 * k]) continue;
        find_fluid(d, k, n, side);
        for (int m = 0; m < 2; m++)
            if (side[m].count)
                set_side(d, d->first[2 * k + m], k, n, &side[m], side[0].sum + side[1].sum);
    }
}

static pdyn_status reserve(struct wet_sides *d, int count) {
    if (count <= d->room) return PDYN_OK;
    FREE_ARRAY(d->context, d->side, d->room);
    d->room = count + count / 2;
    d->view.side = d->side = NEW_ARRAY(d->context, d->room, pdyn_wet_side);
    if (!d->side) d->room = 0;
    return d->side ? PDYN_OK : PDYN_NO_MEMORY;
}

pdyn_status wet_sides_find(struct wet_sides *d, const double *x) {
    int sides = 2 * d->samples->count, count = 0;
    d->x = x, d->view.count = 0;
    pool_for(d->context->pool, d->samples->count, SAMPLES, count_sides, d);
    for (int k = 0; k < sides; k++) {
        int wet = d->first[k];
        d->first[k] = count, count += wet;
    }
    d->first[sides] = count;
    pdyn_status status = reserve(d, count);
    if (status != PDYN_OK) return status;
    d->view.count = count;
    pool_for(d->context->pool, d->samples->count, SAMPLES, fill_sides, d);
    return PDYN_OK;
}

/* ---- setting up ------------------------------------------------------------------------------ */

static bool is_on(const struct surface_samples *s, int sample, const pdyn_body *body) {
    return body_has(body, s->vertex[3 * sample]);
}

/* The rates of a body's samples, which all have the same part of its area; friction: Pa s/m. */
static void set_rates(struct wet_sides *d, const pdyn_body *body, double friction) {
    double resistance = body->permeability > 0.0 ? 1.0 / body->permeability : 0.0;
    const struct surface_samples *s = d->samples;
    double area = 0.0;
    int count = 0;
    for (int t = 0; t < body->triangles; t++) area += body->triangle_area[t];
    for (int k = 0; k < s->count; k++) count += is_on(s, k, body);
    for (int k = 0; k < s->count; k++)
        if (is_on(s, k, body))
            d->along[k] = friction * area / count, d->across[k] = resistance * area / count;
}

static bool resize_arrays(struct wet_sides *d, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(d->along, d->samples->count),
        ARRAY(d->across, d->samples->count),
        ARRAY(d->first, 2 * (size_t)d->samples->count + 1),
        ARRAY(d->side, d->room),
    };
    return context_arrays(d->context, table, ARRAY_ROWS(table), action);
}

pdyn_status wet_sides_create(pdyn_context *context, const struct scene *scene,
                             const pdyn_body *body, const struct surface_samples *samples,
                             const pdyn_neighbours *lists, struct wet_sides **out) {
    struct wet_sides *d = *out = NEW_ARRAY(context, 1, struct wet_sides);
    if (!d) return PDYN_NO_MEMORY;
    d->context = context, d->samples = samples, d->lists = lists;
    d->all = (pdyn_body){.name = "surfaces in fluid", .count = samples->particles};
    d->view.particles = samples->particles;
    if (!resize_arrays(d, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int b = 0; b < scene->bodies; b++)
        if (scene->body[b].fluid_friction > 0.0 || body[b].permeability > 0.0)
            set_rates(d, &body[b], scene->body[b].fluid_friction);
    return PDYN_OK;
}

void wet_sides_free(struct wet_sides *d) {
    if (!d) return;
    resize_arrays(d, ARRAYS_FREE);
    FREE_ARRAY(d->context, d, 1);
}
