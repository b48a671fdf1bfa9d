/* How far particles may go without passing a surface. What surfaces add to the density tells how
 * far the nearest one is, whatever its points and triangles are. */
#include "fluid_pairs.h"

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

WIDE static void limit_block(void *arg, int first, int last, int block) {
    (void)block;
    const struct fluid_call *c = arg;
    const struct fluid *f = c->f;
    const pdyn_neighbours *l = f->lists;
    double spacing = 0.5 * l->support;
    for (int i = f->first + first; i < f->first + last; i++) {
        int samples = l->has_volumes ? l->boundary_start[i] : l->surface_start[i];
        if (samples == l->boundary_start[i] && l->patch_start[i] == l->end[i]) continue;
        const double *at = c->in + 3 * (size_t)i;
        double sum = add_areas(f, c->in, at, samples, l->boundary_start[i]) +
                     add_areas(f, c->in, at, l->patch_start[i], l->end[i]);
        double way = part_of_way * surface_kernel_distance(sum, spacing);
        c->out[i] = fmin(c->out[i], fmax(way, least_way * spacing));
    }
}

/* A sample moves no farther than the particles that it is near to: these may come towards it. */
static void limit_samples(void *arg, int first, int last, int block) {
    (void)block;
    const struct fluid_call *c = arg;
    const pdyn_neighbours *l = c->f->lists;
    double reach = l->surface_support * l->surface_support;
    for (int i = l->particles - l->samples + first; i < l->particles - l->samples + last; i++)
        for (int s = l->start[i]; s < l->surface_start[i]; s++) {
            int j = l->index[s];
            double d[3];
            for (int a = 0; a < 3; a++) d[a] = c->in[3 * (size_t)i + a] - c->in[3 * (size_t)j + a];
            if (vec3_dot(d, d) < reach) c->out[i] = fmin(c->out[i], c->out[j]);
        }
}

void fluid_limit(void *self, const double *x, double *way) {
    struct fluid *f = self;
    for_particles(f, f->count, limit_block, x, way);
    if (!f->lists->has_volumes) for_particles(f, f->lists->samples, limit_samples, x, way);
}
