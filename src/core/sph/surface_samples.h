/* Surface samples: points on surfaces through which these act on a fluid, closer together than its
 * particles (boundary.h), whatever the resolution of the mesh. */
#ifndef PDYN_SURFACE_SAMPLES_H
#define PDYN_SURFACE_SAMPLES_H

#include "base/context.h"
#include "border.h"
#include "boundary.h"
#include "projdyn/module.h"
#include "projdyn/simd.h"
#include "projdyn/vec3.h"

/* A sample lies in a triangle and moves with its corners by barycentric weights. With S the matrix
 * of the weights, a vector x of the particles is extended to (x, S x), on which SPH sums work;
 * forces (f, f_s) on the extended vector are f + S' f_s on the particles. Samples therefore have no
 * mass and are no unknowns, and their interaction with the fluid conserves momentum. */
struct surface_samples {
    pdyn_context *context;
    int particles;       /* particles of the system */
    int count;           /* number of samples */
    int *vertex;         /* count x 3: corners, particles of the system */
    double *weight;      /* count x 3: barycentric coordinates */
    double *volume;      /* count, m^3: current volume in SPH sums (boundary.h) */
    double *rest_volume; /* count, m^3: volume at rest */
    double *rest_area;   /* count, m^2: area at rest of the surface that the sample represents */
    bool *has_inside;    /* count: its body is a volume or rigid, and lies behind the triangle */
    double *share;       /* count, m: volume over the area of the sample's triangle; constant */
    int near_count;      /* samples that a neighbour list may contain soon (neighbours.h) */
    int *near;           /* near_count: their indices */
    int active_count;    /* samples that appear in at least one neighbour list */
    int *active;         /* active_count: their indices */
    int corner_count;    /* particles that are corners of active samples */
    int *corner;         /* corner_count: their indices */
    int *corner_start;   /* corner_count + 1: first entry of each in corner_entry */
    int *corner_entry;   /* 3 active_count: indices into vertex and weight, ascending per corner */
    int *scratch;        /* particles */
    double *x; /* extended vector with 3 (particles + count) + 1 numbers: positions, m; of samples
                  that are not near those of the last build of the lists */
    double *input, *output; /* extended vectors: input and output of an operator */
    double *blocks;         /* (particles + count) x 6 */
};

struct samples_def { /* what samples are made from */
    int bodies;
    const pdyn_body *body;
    int particles;      /* of the system */
    const double *rest; /* particles x 3, m */
    const struct boundary_model *model;
    const struct kernel_model *kernel;
    double spacing;              /* m, of the fluid's particles */
    double thickness;            /* m, of sheets and rigid bodies */
    const struct border *border; /* of the surfaces */
};

/* Samples all surfaces. *out is NULL if no body has one. */
pdyn_status samples_create(pdyn_context *context, const struct samples_def *def,
                           struct surface_samples **out);
void samples_free(struct surface_samples *samples);

/* out = (x, S x), for all samples. x: particles x 3; out: (particles + count) x 3. */
void samples_interpolate(const struct surface_samples *samples, const double *x, double *out);

/* The same for near samples; the others in out stay. */
void samples_interpolate_near(const struct surface_samples *samples, const double *x, double *out);

/* The same of sample k alone. */
INLINE void samples_at(const struct surface_samples *samples, int k, const double *x,
                       double at[3]) {
    at[0] = at[1] = at[2] = 0.0;
    for (int m = 3 * k; m < 3 * k + 3; m++)
        vec3_add(at, samples->weight[m], x + 3 * (size_t)samples->vertex[m]);
}

/* n: across the triangle of sample k, twice as long as its area. */
static inline void samples_normal(const struct surface_samples *samples, int k, const double *x,
                                  double n[3]) {
    const int *corner = samples->vertex + 3 * (size_t)k;
    vec3_normal(n, x + 3 * (size_t)corner[0], x + 3 * (size_t)corner[1], x + 3 * (size_t)corner[2]);
}

/* Area of the triangle of sample k at x, m^2. */
static inline double samples_area(const struct surface_samples *samples, int k, const double *x) {
    double n[3];
    samples_normal(samples, k, x, n);
    return 0.5 * vec3_length(n);
}

/* Call after the lists were built, near: numbers of points (neighbours.h). Finds the active
 * samples. All functions below except samples_update_volumes use active samples only. */
void samples_update_active(struct surface_samples *samples, const pdyn_neighbours *lists,
                           const int *near, int near_count);

/* samples->input = (u, S u); u may be samples->input itself. */
void samples_interpolate_active(const struct surface_samples *samples, const double *u);

/* Sets the output of samples to 0; particles: that of particles, too. */
void samples_clear(const struct surface_samples *samples, bool particles);

/* y += f + S' f_s, with samples->output = (f, f_s). If y is samples->output, it contains f already.
 */
void samples_scatter(const struct surface_samples *samples, double *y);

/* Sets the blocks of particles and samples to 0. */
void samples_clear_blocks(const struct surface_samples *samples);

/* Adds samples->blocks to a block diagonal, packed, 6 numbers per particle. The blocks of a sample
 * are lumped to its corners by weight, which is an upper bound of S' D S. */
void samples_scatter_blocks(const struct surface_samples *samples, double *blocks);

/* out = the numbers of particles in d (particles, then samples) and those of samples, lumped in the
 * same way. */
void samples_lump(const struct surface_samples *samples, const double *d, double *out);

/* Limits the displacement of a particle to the limits of the samples on its triangles. max_step:
 * particles, then samples, m. */
void samples_limit_motion(const struct surface_samples *samples, double *max_step);

/* Scales the volumes of near samples with the areas of their triangles at x, particles x 3, m. */
void samples_update_volumes(struct surface_samples *samples, const double *x);

#endif
