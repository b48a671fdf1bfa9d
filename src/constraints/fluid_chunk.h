/* Within the fluid operator: neighbours of a point in chunks, in arrays of four lanes. A chunk
 * selects those within the support and evaluates kernel and gradient for them. */
#ifndef PDYN_FLUID_CHUNK_H
#define PDYN_FLUID_CHUNK_H

#include "fluid_operator.h"

enum { CHUNK = 64 }; /* neighbours of a chunk */

struct chunk { /* the neighbours of one chunk that lie within the support */
    int index[CHUNK + 4];
    double squared[CHUNK + 4];           /* squared distance, m^2 */
    double x[CHUNK], y[CHUNK], z[CHUNK]; /* x_i - x_j, m; round_gradients: V grad W, 1/m */
    double volume[CHUNK];                /* minus the relative volume V of the pair */
    double value[CHUNK], slope[CHUNK];   /* W times the volume of a particle; (dW/dr) / r */
};

/* out = at - (point `index` of x) */
INLINE void difference(const double *x, const v4 *at, int index, v4 *out) {
    v4 row;
    memcpy(&row, x + 4 * (size_t)index, sizeof row);
    *out = *at - row;
}

/* Four differences, transposed: out[0] has the x of the four, then y, z and at[3] - volume. */
INLINE void differences(const double *x, const v4 *at, const int *index, v4 out[4]) {
    v4 a, b, c, d;
    difference(x, at, index[0], &a);
    difference(x, at, index[1], &b);
    difference(x, at, index[2], &c);
    difference(x, at, index[3], &d);
    v4 xz = __builtin_shufflevector(a, b, 0, 4, 2, 6),
       yv = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    v4 xz2 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    v4 yv2 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    out[0] = __builtin_shufflevector(xz, xz2, 0, 1, 4, 5);
    out[1] = __builtin_shufflevector(yv, yv2, 0, 1, 4, 5);
    out[2] = __builtin_shufflevector(xz, xz2, 2, 3, 6, 7);
    out[3] = __builtin_shufflevector(yv, yv2, 2, 3, 6, 7);
}

/* Returns four indices from list[k] on; past the end of the list its last index is repeated. */
INLINE const int *four_indices(const int *list, int k, int count, int filled[4]) {
    if (k + 4 <= count) return list + k;
    for (int a = 0; a < 4; a++) filled[a] = list[k + a < count ? k + a : count - 1];
    return filled;
}

/* near->index = those of `count` points at a distance below `reach` from `at`; returns their
 * number. Without a branch on the distance: it would be mispredicted about half the time. */
INLINE int select_near(const struct fluid *f, const v4 *at, const int *list, int count,
                       double reach, struct chunk *near) {
    double limit = reach * reach;
    int filled[4], inside = 0;
    for (int k = 0; k < count; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four_indices(list, k, count, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
    }
    for (int k = 0; k < count; k++) {
        near->index[inside] = list[k];
        inside += near->squared[k] < limit;
    }
    return inside;
}

/* Sets squared, x, y, z, volume of the selected points, up to a multiple of four. */
INLINE void load_near(const struct fluid *f, const v4 *at, int inside, struct chunk *near) {
    int filled[4];
    for (int k = 0; k < inside; k += 4) {
        v4 d[4], squared;
        differences(f->x, at, four_indices(near->index, k, inside, filled), d);
        squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        memcpy(near->squared + k, &squared, sizeof squared);
        memcpy(near->x + k, &d[0], sizeof d[0]);
        memcpy(near->y + k, &d[1], sizeof d[1]);
        memcpy(near->z + k, &d[2], sizeof d[2]);
        memcpy(near->volume + k, &d[3], sizeof d[3]);
    }
}

/* Sets value and slope of the selected points, 0 from `inside` to the next multiple of four. */
typedef void evaluate_fn(const struct fluid *f, int inside, struct chunk *near);

INLINE void evaluate_spline(const struct kernel *kernel, int padded, struct chunk *near) {
    for (int k = 0; k < padded; k++) {
        double q = sqrt(near->squared[k]) * kernel->inverse, rest = 1.0 - q;
        double value = q <= 0.5 ? 1.0 - 6.0 * q * q * rest : 2.0 * rest * rest * rest;
        double slope = q <= 0.5 ? 3.0 * q - 2.0 : -rest * rest / q;
        near->value[k] = kernel->value * value;
        near->slope[k] = kernel->slope * slope;
    }
}

INLINE void evaluate_wendland(const struct kernel *kernel, int padded, struct chunk *near) {
    for (int k = 0; k < padded; k++) {
        double q = sqrt(near->squared[k]) * kernel->inverse, rest = 1.0 - q;
        double cube = rest * rest * rest;
        near->value[k] = kernel->value * cube * rest * (1.0 + 4.0 * q);
        near->slope[k] = -kernel->slope * cube;
    }
}

/* The density kernel, kernel.h */
INLINE void evaluate_particles(const struct fluid *f, int inside, struct chunk *near) {
    int padded = (inside + 3) / 4 * 4;
    if (f->kernel.wendland) evaluate_wendland(&f->kernel, padded, near);
    else evaluate_spline(&f->kernel, padded, near);
    for (int k = inside; k < padded; k++) near->value[k] = near->slope[k] = 0.0;
}

/* The surface kernel, kernel.h */
INLINE void evaluate_areas(const struct fluid *f, int inside, struct chunk *near) {
    const struct surface_kernel *kernel = &f->surface;
    int padded = (inside + 3) / 4 * 4;
    for (int k = 0; k < padded; k++) {
        double q = sqrt(near->squared[k] + kernel->soft), rest = 1.0 - q * kernel->inverse;
        double scale = kernel->value * rest * rest / q;
        near->value[k] = scale * rest;
        near->slope[k] = -scale * (1.0 + 2.0 * q * kernel->inverse) / (q * q);
    }
    for (int k = inside; k < padded; k++) near->value[k] = near->slope[k] = 0.0;
}

INLINE void evaluate_surface(const struct fluid *f, int inside, struct chunk *near) {
    if (f->lists->has_volumes) evaluate_particles(f, inside, near);
    else evaluate_areas(f, inside, near);
}

/* x_a = scale_a x_a rounded to float, as pairs are stored */
INLINE void round_lanes(double *x, double scale[4]) {
    for (int a = 0; a < 4; a++) x[a] = (double)(float)(scale[a] * x[a]);
}

/* x, y, z = V grad W, from the distance vector and the slope */
INLINE void round_gradients(struct chunk *near, int inside) {
    for (int k = 0; k < inside; k += 4) {
        round_lanes(near->x + k, near->slope + k);
        round_lanes(near->y + k, near->slope + k);
        round_lanes(near->z + k, near->slope + k);
    }
}

/* Selects those of `count` points at a distance below `reach` from `at`, with values and gradients;
 * returns their number. */
INLINE int evaluate_near(const struct fluid *f, const v4 *at, const int *list, int count,
                         double reach, evaluate_fn *evaluate, struct chunk *near) {
    int inside = select_near(f, at, list, count, reach, near);
    load_near(f, at, inside, near);
    evaluate(f, inside, near);
    for (int k = 0; k < inside; k++) near->slope[k] *= -near->volume[k];
    round_gradients(near, inside);
    return inside;
}

INLINE int chunk_of(int count, int s) { return count - s < CHUNK ? count - s : CHUNK; }

#endif
