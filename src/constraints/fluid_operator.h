/* State of the matrix-free fluid operator and functions shared by its files.
 *
 * Rows would take about 30 rows per particle. The operator stores one entry per pair within the
 * support instead: the kernel's gradient and value. All displacements u - p of constraint i are one
 * factor t_i times these gradients. Each pass loops over the pairs of a particle and writes only to
 * that particle.
 *
 * Pairs are stored in float, sums and everything else in double. Both directions of a pair hold the
 * same rounded numbers, so momentum and the symmetry of H are exact to double precision. Memory: 20
 * bytes per listed neighbour, 168 per particle of the system, 84 more per sample and 32 per
 * boundary point. */
#ifndef PDYN_FLUID_OPERATOR_H
#define PDYN_FLUID_OPERATOR_H

#include "fluid.h"
#include "projdyn/simd.h"

enum { FLUID_GRAIN = 128 }; /* particles per parallel block */

struct fluid {
    const pdyn_services *services;
    const pdyn_neighbours *lists;
    struct fluid_params params;
    struct kernel kernel; /* both times the volume of a particle */
    struct surface_kernel surface;
    int first, count;                            /* the fluid's particles in the system */
    int particles, points;                       /* of the system; the same with boundary points */
    int samples;                                 /* the last ones of the particles */
    unsigned volume_revision, boundary_revision; /* of the volumes and boundary points in x */
    double rest_density;                         /* kg/m^3 */
    double spacing, particle_volume;             /* m, m^3 */
    double factor, part;                         /* of damping in a step (fluid_local.c) */
    size_t pairs;                                /* capacity of pair_index and pair */
    int listed;                                  /* samples with neighbours */
    int *listed_sample;                          /* listed: their numbers */
    int *block_start;           /* blocks + 1: first pair of each block of points */
    int *pair_start, *pair_end; /* particles: range of pairs within the support */
    int *pair_index;            /* pairs: the neighbour */
    float *pair;                /* pairs x 4: V grad W(x_i - x_j), 1/m, V: relative volume of the
                                   sample of the pair, 1 between fluid particles; then W */
    double *x;                  /* points x 4: positions of the last local step, relative volume */
    double *gradient;           /* particles x 4: grad C_i with respect to x_i, 1/m, and 0 */
    double *vector;  /* particles x 4: input of a pass; of a sample then minus the rate of its
                        relative volume */
    double *growth;  /* samples x 9: gradient of the relative volume of a sample with respect to
                        the corners of its triangle, 1/m */
    double *tension; /* samples: sum of flux times W over the pairs of a sample, N m */
    double *value_before;   /* particles: C^n = max(0, C_i) at the end of the step before; -1: not
                               known */
    double *squares_before; /* particles: |grad C_i|^2 at the end of the step before */
    double *value;          /* particles: C_i - part C^n_i (fluid_local.c) */
    double *squares;        /* particles: |grad C_i|^2, 1/m^2 */
    double *stiffness;  /* particles: factor k_i (fluid.h) of squares_before, N m; 0: not known */
    double *flux;       /* particles: stiffness_i max(0, value_i), N m */
    double *weight_sum; /* particles: sum of the weights of its constraints, N/m */
    double *multiplier; /* particles: multipliers of `force`; 0 for other particles than fluid */
    double *partial;    /* blocks: energy, J */
};

struct fluid_call { /* arguments of a parallel loop */
    struct fluid *f;
    const double *in;
    double *out;
    const bool *which;
};

static inline double fluid_stiffness_at(const struct fluid *f, double squares) {
    return fluid_energy_stiffness(f->lists->kernel, f->params.stiffness, squares, f->spacing);
}

static inline bool is_fluid(const struct fluid *f, int i) {
    return i >= f->first && i < f->first + f->count;
}

static inline void for_particles(struct fluid *f, int count, pdyn_range_fn *fn, const double *in,
                                 double *out) {
    struct fluid_call call = {f, in, out, NULL};
    f->services->parallel_for(f->services->core, count, FLUID_GRAIN, fn, &call);
}

/* True for a block of particles with fluid or neighbours: most samples of a large surface have
 * none. */
static inline bool takes_part(const struct fluid *f, int first, int last, int block) {
    bool fluid = first < f->first + f->count && last > f->first;
    return fluid || f->block_start[block + 1] > f->block_start[block];
}

/* Local step at x (particles x 3; fluid_local.c): computes pairs, C_i and grad C_i; returns the
 * energy, J. */
double fluid_project(struct fluid *f, const double *x);

/* pdyn_operator.boundary_force (fluid_boundary.c) */
void fluid_boundary_force(void *self, double *force);

/* y += sum_i multiplier_i grad C_i; multiplier: particles, y: particles x 3 */
void fluid_add_gradients(struct fluid *f, const double *multiplier, double *y);

/* pdyn_operator.limit (fluid_limit.c) */
void fluid_limit(void *self, const double *x, double *max_step);

/* pdyn_operator.rate, force, diagonal, velocity (fluid_pairs.c) */
void fluid_rate(void *self, const bool *which, const double *u, double *rate);
void fluid_force(void *self, const double *multiplier, double *y);
void fluid_diagonal(void *self, const double *stiffness, double *blocks);
void fluid_viscosity(void *self, double *v);

#endif
