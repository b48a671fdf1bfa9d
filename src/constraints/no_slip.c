/* Viscous friction of a fluid on the surfaces in it, which keeps its velocity there at that of the
 * surface: a dashpot between every particle i and every point s of a surface that adds to the
 * density of i (docs/theory/interface.md), in all directions,
 *
 *     E = c / (2 h) |u - a|^2,    u = x_i - x_s,     a: u at the base of the step
 *     c = 2 mu d lambda_is / lambda_0
 *
 * lambda_is: what s adds to the density of i; lambda_0: what a plane adds at d/2. A layer at this
 * distance then feels the stress mu v / (d/2). mu: Pa s; d: particle spacing. u selects the corners
 * of a sample; a solid moves a, with the velocity of its rigid motion where the first layer rests,
 * so that fluid that turns with a box feels no stress. */
#include "listed_points.h"

#include "projdyn/kernel.h"

#include <string.h>

enum { WIDTH = 4 };

struct params {
    double viscosity; /* mu, Pa s */
};

static const pdyn_param params[] = {{"viscosity", PDYN_REAL, offsetof(struct params, viscosity),
                                     true, 0, 0, 1e9, "Pa s",
                                     "dynamic viscosity of the fluid at the surfaces"},
                                    {0}};

struct dashpot {
    double coefficient; /* c, N s/m */
    double base[3];     /* a, m, without the motion of a point of a solid */
    double layer_x[3];  /* m: layer_x of a point of a moving solid when the step begins */
    int particle, point;
};

static struct dashpot *dashpots(const pdyn_batch *b) { return b->data; }

struct surfaces { /* what the points of surfaces add to the density of particles */
    struct kernel volume;
    struct surface_kernel area;
};

/* lambda_is / lambda_0 of the entry k of the list of particle i; r: vector between the two */
static double share_of(const struct surfaces *s, const pdyn_neighbours *l, int i, int k,
                       const double r[3]) {
    double volume = l->volume[l->index[k]];
    return listed_has_area(l, i, k)
               ? volume * surface_kernel_value(&s->area, vec3_dot(r, r)) / l->kernel->half_areas
               : volume * kernel_value(&s->volume, vec3_length(r)) / l->kernel->half_volumes;
}

/* layer_x of a point of a moving solid; NULL: it does not move. */
static const double *moving_place(const pdyn_neighbours *l, int point) {
    int first = l->points - l->moving;
    return point < first ? NULL : l->layer_x + 3 * (size_t)(point - first);
}

static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    const pdyn_neighbours *l = b->neighbours;
    double mu = ((const struct params *)par)->viscosity, spacing = 2.0 * b->body->radius;
    const struct surfaces surfaces = {kernel_make(l->kernel, l->support),
                                      surface_kernel_make(l->kernel, spacing)};
    int count = 0;
    (void)v;
    for (int i = b->body->first; mu > 0.0 && i < b->body->first + b->body->count; i++)
        for (int k = l->surface_start[i]; k < l->end[i]; k++) {
            double r[3], at[3];
            listed_position(l, x, l->index[k], at);
            vec3_subtract(r, x + 3 * (size_t)i, at);
            double share = share_of(&surfaces, l, i, k, r);
            if (!(share > 0.0) || count++ >= room) continue;
            struct dashpot *d = dashpots(b) + count - 1;
            const double *layer = moving_place(l, l->index[k]);
            *d = (struct dashpot){
                .coefficient = 2.0 * mu * spacing * share, .particle = i, .point = l->index[k]};
            if (layer) memcpy(d->layer_x, layer, sizeof d->layer_x);
        }
    return count;
}

/* The particle, then the corners of the sample; 0 for the corners of a point of a solid. */
static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const pdyn_neighbours *l = b->neighbours;
    (void)par;
    for (int e = first; e < last; e++) {
        int i = dashpots(b)[e].particle, point = dashpots(b)[e].point;
        int corner = sample_corner(l, point);
        b->column[WIDTH * e] = i, b->coefficient[WIDTH * e] = 1.0;
        for (int k = 0; k < 3; k++) {
            bool sample = point < l->particles;
            b->column[WIDTH * e + 1 + k] = sample ? l->sample_vertex[corner + k] : i;
            b->coefficient[WIDTH * e + 1 + k] = sample ? -l->sample_weight[corner + k] : 0.0;
        }
    }
}

static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) memcpy(dashpots(b)[e].base, b->u + 3 * e, 3 * sizeof *b->u);
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = dashpots(b)[e].coefficient / b->h;
}

/* p: a, moved by h times the velocity of a solid at layer_x */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const pdyn_neighbours *l = b->neighbours;
    (void)par;
    for (int e = first; e < last; e++) {
        const struct dashpot *d = dashpots(b) + e;
        double *p = b->p + 3 * e;
        memcpy(p, d->base, sizeof d->base);
        const double *layer = moving_place(l, d->point);
        for (int a = 0; layer && a < 3; a++) p[a] += b->h / b->length * (layer[a] - d->layer_x[a]);
    }
}

/* The fluid pulls a point of a solid with w (u - p). */
static void boundary_force(const void *par, const pdyn_batch *b, double *force) {
    const pdyn_neighbours *l = b->neighbours;
    (void)par;
    for (int e = 0; e < b->elements; e++) {
        double pull[3];
        if (dashpots(b)[e].point < l->particles) continue;
        vec3_subtract(pull, b->u + 3 * e, b->p + 3 * e);
        vec3_add(force + 3 * (size_t)(dashpots(b)[e].point - l->particles), b->weight[e], pull);
    }
}

const pdyn_constraint_type pdyn_constraint_no_slip = {
    .name = "no_slip",
    .summary = "viscous friction of a fluid on walls, solids and sheets",
    .flags = PDYN_ON_PARTICLES | PDYN_NEIGHBOURS | PDYN_FIRST_LAYER | PDYN_LOSSY,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct dashpot),
    .update = update,
    .rows = 1,
    .width = WIDTH,
    .select = select,
    .weight = weight,
    .project = project,
    .begin = begin,
    .boundary_force = boundary_force,
};
