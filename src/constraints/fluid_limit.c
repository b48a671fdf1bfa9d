/* Step limit that keeps fluid particles and surfaces from passing through each other: a fraction of
 * their distance. Within one particle spacing, the density that a surface adds at a particle bounds
 * the distance, whatever points and triangles the surface has. Beyond, the distance is at least the
 * spacing, and at least the distance to a bounding box of the other party, so a sheet that flies
 * towards water is not slowed down. */
#include "fluid_operator.h"

#include "projdyn/box.h"
#include "projdyn/vec3.h"

/* Density over the rest density that the listed surface points first to last - 1 add at `at`. */
INLINE double add_areas(const struct fluid *f, const double *x, const double *at, int first,
                        int last) {
    const pdyn_neighbours *l = f->lists;
    double sum = 0.0;
    for (int s = first; s < last; s++) {
        int j = l->index[s];
        const double *there =
            j < l->particles ? x + 3 * (size_t)j : l->boundary_x + 3 * (size_t)(j - l->particles);
        double r = vec3_distance(at, there);
        sum += l->volume[j] / f->particle_volume * surface_kernel_value(&f->surface, r * r);
    }
    return sum;
}

/* Fraction of the distance: below one half, as particle and surface may both approach. */
static const double distance_fraction = 0.45;
/* Lower bound of the limit in particle spacings: a particle that touches a surface can move. */
static const double min_limit = 0.02;

/* The box around those of `count` particles from `first` on that have a volume. */
static struct box box_of_volumes(const struct fluid *f, const double *x, int first, int count) {
    struct box box = box_empty;
    for (int i = first; i < first + count; i++)
        if (f->lists->volume[i] > 0.0) box_add(&box, x + 3 * (size_t)i);
    return box;
}

/* Limit for a point without listed neighbours among the points in a box, m. */
static double limit_outside(const struct box *box, const double *at, double spacing) {
    double d[3];
    for (int a = 0; a < 3; a++) {
        double below = box->min[a] - at[a], above = at[a] - box->max[a];
        double out = below > above ? below : above; /* fmax would be a function call */
        d[a] = out > 0.0 ? out : 0.0;
    }
    return distance_fraction * fmax(spacing, vec3_length(d));
}

struct limit_call {
    const struct fluid *f;
    const double *x;
    double *max_step;
    double spacing;
    struct box fluid, samples; /* bounding boxes; empty without samples */
};

WIDE static void limit_block(void *arg, int first, int last, int block) {
    (void)block;
    const struct limit_call *c = arg;
    const struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    for (int i = f->first + first; i < f->first + last; i++) {
        int samples = l->has_volumes ? l->boundary_start[i] : l->surface_start[i];
        const double *at = c->x + 3 * (size_t)i;
        double limit = limit_outside(&c->samples, at, c->spacing);
        if (samples < l->boundary_start[i] || l->patch_start[i] < l->end[i]) {
            double sum = add_areas(f, c->x, at, samples, l->boundary_start[i]) +
                         add_areas(f, c->x, at, l->patch_start[i], l->end[i]);
            double far = surface_kernel_least_distance(&f->surface, sum, c->spacing);
            limit = fmin(limit, distance_fraction * far);
        }
        c->max_step[i] = fmin(c->max_step[i], fmax(limit, min_limit * c->spacing));
    }
}

/* A listed sample gets the smallest limit of the fluid particles within the surface support. */
static void limit_samples(void *arg, int first, int last, int block) {
    (void)block;
    const struct limit_call *c = arg;
    const pdyn_neighbours *l = c->f->lists;
    double reach = l->surface_support * l->surface_support;
    for (int i = l->particles - l->samples + first; i < l->particles - l->samples + last; i++) {
        if (l->start[i] == l->surface_start[i]) continue;
        c->max_step[i] =
            fmin(c->max_step[i], limit_outside(&c->fluid, c->x + 3 * (size_t)i, c->spacing));
        for (int s = l->start[i]; s < l->surface_start[i]; s++) {
            int j = l->index[s];
            double d[3];
            for (int a = 0; a < 3; a++) d[a] = c->x[3 * (size_t)i + a] - c->x[3 * (size_t)j + a];
            if (vec3_dot(d, d) < reach) c->max_step[i] = fmin(c->max_step[i], c->max_step[j]);
        }
    }
}

void fluid_limit(void *self, const double *x, double *max_step) {
    struct fluid *f = self;
    const pdyn_neighbours *l = f->lists;
    int samples = l->has_volumes ? 0 : l->samples;
    struct limit_call call = {.f = f,
                              .x = x,
                              .max_step = max_step,
                              .spacing = f->spacing,
                              .fluid = box_of_volumes(f, x, f->first, samples ? f->count : 0),
                              .samples = box_of_volumes(f, x, l->particles - samples, samples)};
    f->services->parallel_for(f->services->core, f->count, FLUID_GRAIN, limit_block, &call);
    f->services->parallel_for(f->services->core, samples, FLUID_GRAIN, limit_samples, &call);
}
