/* The state of the fluid operator, and what its files share.
 *
 * A row for every particle of every constraint would be some 30 rows a particle. What is kept
 * instead, for every pair inside the support, is the gradient of the kernel and its value; all
 * displacements u - p of constraint i are t_i times that. Every pass runs over the pairs of a
 * particle and writes only to it.
 *
 * Pairs are kept in single precision, sums and everything else in double; a pair is the same in
 * both directions and everywhere it is used, so momentum and symmetry hold as in double. Memory: 20
 * bytes per listed neighbour, 160 per particle of the system and 32 per boundary point. */
#ifndef PDYN_FLUID_PAIRS_H
#define PDYN_FLUID_PAIRS_H

#include "base/simd.h"
#include "fluid.h"

enum { FLUID_GRAIN = 128 }; /* particles of a parallel block */

struct fluid {
    const pdyn_services *services;
    const pdyn_neighbours *lists;
    struct fluid_params params;
    struct kernel kernel;            /* times the volume of a particle */
    struct surface_kernel surface;   /* the same */
    int first, count;                /* the fluid's particles in the system */
    int particles, points;           /* of the system; with the boundary */
    unsigned volumes;                /* revision of the volumes in x, */
    unsigned boundary;               /* and of the boundary points */
    double rest_density;             /* kg/m^3 */
    double spacing, particle_volume; /* m, m^3 */
    size_t pairs;                    /* capacity of what is kept per listed neighbour */
    int *block_start;                /* blocks + 1: first pair of each block of points */
    int *pair_start, *pair_end;      /* particles: its pairs inside the support, packed by blocks */
    int *pair_index;                 /* pairs: the neighbour */
    float *pair;        /* pairs x 4: grad W(x_i - x_j) times the volume of a particle that
                           is no fluid (of others: 1), 1/m, and W */
    double *x;          /* points x 4: where the last local step was, and the volume */
    double *gradient;   /* particles x 4: grad C_i with respect to x_i, 1/m, and 0 */
    double *vector;     /* particles x 4: what a pass reads of the neighbours */
    double *value;      /* particles: C_i, negative where there is room */
    double *squares;    /* particles: |grad C_i|^2, 1/m^2 */
    double *stiffness;  /* particles: k_i of the energy k_i / 2 C_i^2, N m; 0: not known yet */
    double *flux;       /* particles: what constraint i gives along its gradient, N m */
    double *held;       /* particles: weights of the constraints that it is in, N/m */
    double *multiplier; /* particles: those of `force`, 0 for a particle that is no fluid */
    double *partial;    /* an energy for each parallel block */
};

struct fluid_call { /* arguments of a parallel loop */
    struct fluid *f;
    const double *in;
    double *out;
    const bool *which;
};

/* NULL allocates, a count of 0 frees; NULL without memory. */
static inline void *fluid_resize(struct fluid *f, void *block, size_t old_count, size_t count,
                                 size_t size) {
    return f->services->allocate(f->services->core, block, old_count * size, count * size);
}

static inline bool is_fluid(const struct fluid *f, int i) {
    return i >= f->first && i < f->first + f->count;
}

static inline void for_particles(struct fluid *f, int count, pdyn_range_fn *fn, const double *in,
                                 double *out) {
    struct fluid_call call = {f, in, out, NULL};
    f->services->parallel_for(f->services->core, count, FLUID_GRAIN, fn, &call);
}

static inline double fluid_stiffness_at(const struct fluid *f, int i) {
    return fluid_energy_stiffness(f->params.stiffness, f->squares[i], f->spacing);
}

/* Whether a block of particles has fluid or pairs: of a large surface, few samples have. */
static inline bool takes_part(const struct fluid *f, int first, int last, int block) {
    bool fluid = first < f->first + f->count && last > f->first;
    return fluid || f->pair_end[last - 1] > f->block_start[block];
}

/* The gradient and the value of a pair. */
INLINE void load_pair(const struct fluid *f, int pair, v4 *out) {
    const float *from = f->pair + 4 * (size_t)pair;
    double wide[4]; /* as a loop, four lanes are converted by one instruction */
    for (int a = 0; a < 4; a++) wide[a] = (double)from[a];
    memcpy(out, wide, sizeof wide);
}

/* Local step: C_i, its gradient, the pairs and the energy at x, which is returned. */
double fluid_project(struct fluid *f, const double *x);

/* The forces on boundary points, see pdyn_operator. */
void fluid_boundary_force(void *self, double *force);

/* y += sum of the multipliers (particles) times the gradients of their constraints. */
void fluid_add_gradients(struct fluid *f, const double *multiplier, double *y);

/* Half of the way to the nearest surface, see pdyn_operator. */
void fluid_limit(void *self, const double *x, double *way);

/* The passes over pairs, see pdyn_operator. */
void fluid_rate(void *self, const bool *which, const double *u, double *rate);
void fluid_force(void *self, const double *multiplier, double *y);
void fluid_diagonal(void *self, const double *stiffness, double *blocks);
void fluid_viscosity(void *self, double *v);

#endif
