#include "surface_friction.h"

#include "scene/scene.h"
#include "sph/kernel.h"
#include "sph/neighbours.h"

#include <string.h>

enum { MOST = 16, WIDTH = MOST + 3 }; /* particles of an element; 9 touch a sheet at rest */
enum { SAMPLES = 256 };               /* grain */

/* A side is as wet as it feels the fluid's density. Of a lattice that touches it, a sample feels
 * 0.049 between four particles, the least, and is wholly wet there (points with volumes: 0.105). */
static const double wet_share = 0.05;

struct slipping {
    double normal[3];
    double anchor[3]; /* m: u at the beginning of the step */
    double rate;      /* N s/m */
};

/* ---- the constraint -------------------------------------------------------------------------- */

static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        memcpy(((struct slipping *)b->data + e)->anchor, b->u + 3 * e, 3 * sizeof *b->u);
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        b->weight[e] = ((const struct slipping *)b->data + e)->rate / b->h;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const struct slipping *data = (const struct slipping *)b->data + e;
        double moved[3], *p = b->p + 3 * e;
        for (int a = 0; a < 3; a++) moved[a] = b->u[3 * e + a] - data->anchor[a];
        memcpy(p, data->anchor, sizeof moved);
        vec3_add(p, vec3_dot(moved, data->normal), data->normal);
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *n = ((const struct slipping *)b->data + e)->normal;
        for (int k = 0; k < 9; k++) J[k] = n[k / 3] * n[k % 3];
    }
}

static const pdyn_constraint_type slipping_type = {
    .name = "drag",
    .summary = "friction between a fluid and surfaces in it",
    .flags = PDYN_LOSSY,
    .data_size = sizeof(struct slipping),
    .rows = 1,
    .width = WIDTH,
    .begin = begin,
    .weight = weight,
    .project = project,
    .tangent = tangent,
};

/* ---- its elements ---------------------------------------------------------------------------- */

struct side { /* of a sample */
    int count, particle[MOST];
    double share[MOST], sum; /* of the density, and of all */
};

static void normal_of(const struct surface_friction *d, int sample, double n[3]) {
    const double *corner[3];
    for (int k = 0; k < 3; k++) corner[k] = d->x + 3 * (size_t)d->samples->vertex[3 * sample + k];
    vec3_normal(n, corner[0], corner[1], corner[2]);
    double length = vec3_length(n);
    for (int a = 0; a < 3; a++) n[a] = length > 0.0 ? n[a] / length : 0.0;
}

/* The normal, and the fluid on both sides: it points to the second. */
static void look(const struct surface_friction *d, int sample, double n[3], struct side side[2]) {
    const pdyn_neighbours *l = d->lists;
    struct kernel kernel = kernel_make(l->surface_support);
    int at = d->samples->particles + sample;
    const double *x = d->x + 3 * (size_t)at;
    normal_of(d, sample, n);
    memset(side, 0, 2 * sizeof *side);
    for (int s = l->start[at]; s < l->surface_start[at]; s++) {
        int i = l->index[s];
        double r[3];
        for (int a = 0; a < 3; a++) r[a] = d->x[3 * (size_t)i + (size_t)a] - x[a];
        double share = l->volume[i] * kernel_value(&kernel, vec3_length(r));
        struct side *to = &side[vec3_dot(r, n) > 0.0];
        if (share == 0.0 || to->count == MOST) continue;
        to->particle[to->count] = i, to->share[to->count++] = share;
        to->sum += share;
    }
}

static void count_sides(void *arg, int first, int last, int block) {
    (void)block;
    const struct surface_friction *d = arg;
    for (int k = first; k < last; k++) {
        struct side side[2];
        double n[3];
        d->first[2 * k] = d->first[2 * k + 1] = 0;
        if (d->rate[k] == 0.0) continue;
        look(d, k, n, side);
        for (int m = 0; m < 2; m++) d->first[2 * k + m] = side[m].count > 0;
    }
}

/* Entries that are not needed select the sample's first corner with 0. */
static void set_element(const struct surface_friction *d, int e, int sample, const double n[3],
                        const struct side *side) {
    const struct samples *s = d->samples;
    const pdyn_batch *v = &d->batch->view;
    struct slipping *data = (struct slipping *)v->data + e;
    int *column = v->column + WIDTH * e;
    double *coefficient = v->coefficient + WIDTH * e, area = s->volume[sample];
    for (int k = 0; k < WIDTH; k++) column[k] = s->vertex[3 * sample], coefficient[k] = 0.0;
    for (int k = 0; k < 3; k++) {
        column[k] = s->vertex[3 * sample + k];
        coefficient[k] = -s->weight[3 * sample + k];
    }
    for (int k = 0; k < side->count; k++) {
        column[3 + k] = side->particle[k];
        coefficient[3 + k] = side->share[k] / side->sum;
    }
    memcpy(data->normal, n, sizeof data->normal);
    area /= s->rest_volume[sample];
    data->rate = d->rate[sample] * area * fmin(1.0, side->sum / wet_share);
}

static void fill_sides(void *arg, int first, int last, int block) {
    (void)block;
    const struct surface_friction *d = arg;
    for (int k = first; k < last; k++) {
        struct side side[2];
        double n[3];
        if (d->first[2 * k + 2] == d->first[2 * k]) continue;
        look(d, k, n, side);
        for (int m = 0; m < 2; m++)
            if (side[m].count) set_element(d, d->first[2 * k + m], k, n, &side[m]);
    }
}

pdyn_status surface_friction_begin(struct surface_friction *d, const double *x) {
    int sides = 2 * d->samples->count, count = 0;
    d->x = x;
    pool_for(d->context->pool, d->samples->count, SAMPLES, count_sides, d);
    for (int k = 0; k < sides; k++) {
        int wet = d->first[k];
        d->first[k] = count, count += wet;
    }
    d->first[sides] = count;
    pdyn_status status = batch_resize(d->batch, count);
    if (status != PDYN_OK) return status;
    pool_for(d->context->pool, d->samples->count, SAMPLES, fill_sides, d);
    batch_index(d->batch);
    return PDYN_OK;
}

/* ---- setting up ------------------------------------------------------------------------------ */

/* The samples of a body share its area. */
static void set_rates(struct surface_friction *d, const pdyn_body *body, double friction) {
    const struct samples *s = d->samples;
    double area = 0.0;
    int count = 0;
    for (int t = 0; t < body->triangles; t++) area += body->triangle_area[t];
    for (int turn = 0; turn < 2; turn++)
        for (int k = 0; k < s->count; k++) {
            int i = s->vertex[3 * k] - body->first;
            if (i < 0 || i >= body->count) continue;
            if (turn) d->rate[k] = friction * area / count;
            else count++;
        }
}

static bool has_friction(const struct scene *scene) {
    for (int b = 0; b < scene->bodies; b++)
        if (scene->body[b].fluid_friction > 0.0) return true;
    return false;
}

pdyn_status surface_friction_create(pdyn_context *context, const struct scene *scene,
                                    const pdyn_body *body, int particles,
                                    const struct samples *samples, const pdyn_neighbours *lists,
                                    struct surface_friction **out) {
    if (!has_friction(scene)) return PDYN_OK;
    struct surface_friction *d = *out = NEW_ARRAY(context, 1, struct surface_friction);
    if (!d) return PDYN_NO_MEMORY;
    d->context = context, d->samples = samples, d->lists = lists;
    d->all = (pdyn_body){.name = "drag", .count = particles};
    d->rate = NEW_ARRAY(context, samples->count, double);
    d->first = NEW_ARRAY(context, 2 * (size_t)samples->count + 1, int);
    if (!d->rate || !d->first) return PDYN_NO_MEMORY;
    for (int b = 0; b < scene->bodies; b++)
        if (scene->body[b].fluid_friction > 0.0)
            set_rates(d, &body[b], scene->body[b].fluid_friction);
    return batch_create_changing(context, &slipping_type, NULL, &d->all, &d->batch);
}

void surface_friction_free(struct surface_friction *d) {
    if (!d) return;
    FREE_ARRAY(d->context, d->rate, d->samples->count);
    FREE_ARRAY(d->context, d->first, 2 * (size_t)d->samples->count + 1);
    FREE_ARRAY(d->context, d, 1);
}
