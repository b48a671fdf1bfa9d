/* How far particles and samples of surfaces may go without passing each other: a part of the
 * distance between the two. What surfaces add to the density tells that distance where it is below
 * a spacing, whatever points and triangles a surface has. Beyond, it is above a spacing, and above
 * the distance to a box around all of the others: a sheet that flies towards water is not held. */
#include "fluid_pairs.h"

#include "geometry/bvh.h"
#include "projdyn/vec3.h"

/* What the points of a part of a list add at `at`. */
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

/* Less than half: a sheet may come towards the particle. */
static const double part_of_way = 0.45;
/* Never less than this part of a spacing, or nothing would move where a surface is touched. */
static const double least_way = 0.02;

/* The box around what takes part of `count` particles from `first` on. */
static struct box box_around(const struct fluid *f, const double *x, int first, int count) {
    struct box box = box_empty;
    for (int i = first; i < first + count; i++)
        if (f->lists->volume[i] > 0.0) box_add(&box, x + 3 * (size_t)i);
    return box;
}

/* How far a point may go that is not near to any of those in a box. */
static double way_outside(const struct box *box, const double *at, double spacing) {
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = fmax(0.0, fmax(box->min[a] - at[a], at[a] - box->max[a]));
    return part_of_way * fmax(spacing, vec3_length(d));
}

struct limit_call {
    const struct fluid *f;
    const double *x;
    double *way;
    double spacing;
    struct box fluid, samples; /* around these; empty without samples */
};

WIDE static void limit_block(void *arg, int first, int last, int block) {
    (void)block;
    const struct limit_call *c = arg;
    const struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    for (int i = f->first + first; i < f->first + last; i++) {
        int samples = l->has_volumes ? l->boundary_start[i] : l->surface_start[i];
        const double *at = c->x + 3 * (size_t)i;
        double way = way_outside(&c->samples, at, c->spacing);
        if (samples < l->boundary_start[i] || l->patch_start[i] < l->end[i]) {
            double sum = add_areas(f, c->x, at, samples, l->boundary_start[i]) +
                         add_areas(f, c->x, at, l->patch_start[i], l->end[i]);
            way = fmin(way, part_of_way * surface_kernel_distance(sum, c->spacing));
        }
        c->way[i] = fmin(c->way[i], fmax(way, least_way * c->spacing));
    }
}

/* A sample moves no farther than the particles that it is near to: these may come towards it. */
static void limit_samples(void *arg, int first, int last, int block) {
    (void)block;
    const struct limit_call *c = arg;
    const pdyn_neighbours *l = c->f->lists;
    double reach = l->surface_support * l->surface_support;
    for (int i = l->particles - l->samples + first; i < l->particles - l->samples + last; i++) {
        c->way[i] = fmin(c->way[i], way_outside(&c->fluid, c->x + 3 * (size_t)i, c->spacing));
        for (int s = l->start[i]; s < l->surface_start[i]; s++) {
            int j = l->index[s];
            double d[3];
            for (int a = 0; a < 3; a++) d[a] = c->x[3 * (size_t)i + a] - c->x[3 * (size_t)j + a];
            if (vec3_dot(d, d) < reach) c->way[i] = fmin(c->way[i], c->way[j]);
        }
    }
}

void fluid_limit(void *self, const double *x, double *way) {
    struct fluid *f = self;
    const pdyn_neighbours *l = f->lists;
    int samples = l->has_volumes ? 0 : l->samples;
    struct limit_call call = {.f = f,
                              .x = x,
                              .way = way,
                              .spacing = 0.5 * l->support,
                              .fluid = box_around(f, x, f->first, samples ? f->count : 0),
                              .samples = box_around(f, x, l->particles - samples, samples)};
    f->services->parallel_for(f->services->core, f->count, FLUID_GRAIN, limit_block, &call);
    f->services->parallel_for(f->services->core, samples, FLUID_GRAIN, limit_samples, &call);
}
