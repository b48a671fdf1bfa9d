/* The colour field of a body of particles, whose level COLOUR_ISO is the surface of the fluid:
 *
 *     phi(x) = sum_j V_j W(x - x_j),    V_j = 1 / sum_k W(x_j - x_k),
 *     W(d)   = C (1 - |d|^2 / support^2)^5 for |d| < support = 2 spacings,
 *     C      = 9009 / (1024 pi support^3).
 *
 * V_j is the volume of a particle from the density sum (Mueller, Charypar, Gross 2003). It is one
 * spacing^3 inside of the fluid and larger at the surface, in sheets and in drops, so that these do
 * not shrink. Particles are sorted into cubic bins as wide as the support; the field is sampled at
 * 4 x 4 x 4 points in each bin near the surface, one half of a spacing apart. Inside of the fluid
 * there are no samples. */
#ifndef COLOUR_FIELD_H
#define COLOUR_FIELD_H

#include "vtk_frame.h"

#include <stdbool.h>
#include <stdint.h>

/* The level whose surface lies half a spacing above the top layer of a half space of particles on a
 * cubic lattice: calibrated on still water. A single particle then has 1.07 times its volume. */
#define COLOUR_ISO 0.5879

/* Sums of (1 - r^2 / support^2)^5 times this are numbers of particles in a spacing^3: C (support /
 * 2)^3. */
#define COLOUR_SUM_SCALE (9009.0 / (8192.0 * 3.14159265358979323846))

enum { BLOCK = 4, BLOCK_SAMPLES = BLOCK * BLOCK * BLOCK };

struct colour_field {
    double support, cell; /* m: radius beyond which W is 0, and the distance of samples */
    int count;            /* particles, sorted by bin */
    float *x, *v;         /* count x 3: positions, m, and velocities, m/s */
    float *weight; /* V_j C; 0: no particle is closer than the support, this one is not sampled */
    bool *deep;    /* the particle is surrounded by others on all sides */
    int bins;
    uint64_t *bin; /* bins, ascending: keys of the bins with particles */
    int *first;    /* bins + 1: particles of bin b are first[b] to first[b + 1] - 1 */
    int blocks;
    uint64_t *block; /* blocks, ascending: keys of the bins with samples */
    float *value;    /* blocks x BLOCK_SAMPLES, x runs fastest */
};

/* Particles of the bins around a point, as ranges of consecutive particles. */
struct colour_rows {
    int first[9], last[9];
};

/* Sorts the particles, computes their volumes and samples the field. radius: m, half a spacing.
 * The caller frees the field in any case. Returns an exit code, after a message unless it is
 * EXIT_GOOD. EXIT_BAD_INPUT: a particle is farther than 2^20 times the support from the origin. */
int colour_field_build(const struct vtk_frame *frame, const char *path, double radius, int threads,
                       struct colour_field *out);
/* The last part of colour_field_build: samples the field. Returns an exit code. */
int colour_sample_surface(struct colour_field *field, int threads);
void colour_field_free(struct colour_field *field);

/* Index of a key in `count` ascending keys; -1: none. */
int colour_find(const uint64_t *key, int count, uint64_t wanted);

/* Keys and coordinates of bins. */
uint64_t colour_key(const int at[3]);
void colour_coordinates(uint64_t key, int at[3]);

/* Whether a value is inside of the surface; whether a bin without samples is. */
bool colour_is_inside(float value);
bool colour_is_deep(const struct colour_field *field, uint64_t key);

/* Whether no other particle is closer than the support to particle i. */
bool colour_is_alone(const struct colour_field *field, int i);

/* The particles in the 27 bins around bin `at`: all that are closer than the support to a point in
 * it.
 */
struct colour_rows colour_rows_around(const struct colour_field *field, const int at[3]);
/* The bin of a point. */
void colour_bin(const struct colour_field *field, const double x[3], int at[3]);
/* (1 - r^2 / support^2)^5, r2 = r^2; 0 for r >= support. */
double colour_kernel(const struct colour_field *field, double r2);

#endif
