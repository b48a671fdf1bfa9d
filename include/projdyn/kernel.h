/* Kernels of the density sums: W between fluid particles, and the surface kernel S between
 * particles and surfaces. A scene chooses one of the models ("kernel"). */
#ifndef PROJDYN_KERNEL_H
#define PROJDYN_KERNEL_H

#include <math.h>
#include <stdbool.h>

/* A choice of W with its constants; d is the particle spacing. */
struct kernel_model {
    const char *name, *summary;
    bool wendland;  /* false: cubic spline (Monaghan 1992); true: Wendland C2 (Wendland 1995) */
    double support; /* radius beyond which W is 0, in d */
    double value;   /* pi support^3 W(0), for density 1 in a continuum, or in a cubic lattice */
    double slope;   /* factor in kernel_slope, over W(0) / support^2 */
    double squares; /* |grad C|^2 d^2 of the density ratio C in a cubic lattice */
    /* of surface_tension, measured: A and o of docs/theory/surface-tension.md */
    double tension, wetting_offset;
    double surface;      /* A of the surface kernel */
    double reach;        /* s / d of the surface kernel */
    double half_areas;   /* lambda(d/2) of a plane of areas */
    double half_volumes; /* lambda(d/2) of the points of a box */
    /* points behind the faces of a box: their distance and how far they reach past the edges, in
     * d; volume per area and d */
    double outside, beyond, layer;
    double memory; /* of a fluid particle with its neighbour list, bytes */
};

struct kernel {
    bool wendland;
    double support, inverse; /* m; 1/support */
    double value;            /* W(0), 1/m^3 */
    double slope;            /* factor in kernel_slope, 1/m^5 */
};

/* W that is 0 beyond the distance `support`, m. */
static inline struct kernel kernel_make(const struct kernel_model *model, double support) {
    double value = model->value / (3.14159265358979323846 * support * support * support);
    struct kernel kernel = {model->wendland, support, 1.0 / support, value,
                            model->slope * value / (support * support)};
    return kernel;
}

/* W(r), 1/m^3; zero from the support on. */
static inline double kernel_value(const struct kernel *k, double r) {
    double q = r * k->inverse, rest = 1.0 - q;
    if (q >= 1.0) return 0.0;
    if (k->wendland) return k->value * rest * rest * rest * rest * (1.0 + 4.0 * q);
    if (q <= 0.5) return k->value * (1.0 - 6.0 * q * q * rest);
    return 2.0 * k->value * rest * rest * rest;
}

/* W'(r) / r, 1/m^5, so that grad W(d) = kernel_slope(|d|) d; finite at r = 0. */
static inline double kernel_slope(const struct kernel *k, double r) {
    double q = r * k->inverse, rest = 1.0 - q;
    if (q >= 1.0) return 0.0;
    if (k->wendland) return -k->slope * rest * rest * rest;
    return q <= 0.5 ? k->slope * (3.0 * q - 2.0) : -k->slope * rest * rest / q;
}

/* The surface kernel: what a unit of area at distance r adds to the density of a fluid with
 * particle spacing d,
 *
 *     S(r) = 2 A / (pi s q) (1 - q/s)^3,   q^2 = r^2 + (s/10)^2,   S = 0 for q >= s.
 *
 * A plane at distance z then adds lambda(z) = A (1 - q(z)/s)^4, in place of the half space of fluid
 * that is missing behind the plane. At z = d/2 a cubic lattice of the cubic spline needs lambda =
 * 0.150 and, because a surface has no density constraint that pushes back, twice the slope of a
 * layer of particles, -1.02/d. Water at rest is less regular and keeps the distance d/2 with s = d,
 * A = 2.2 (lambda = 0.127, slope -1.02/d). A and s of the other kernel were measured to do the same
 * with its particles. Close to the surface lambda and W(0) exceed 1, so that a single particle is
 * compressed and cannot pass. */
#define SURFACE_KERNEL_SOFT 0.01 /* (1/10)^2: (q^2 - r^2) / s^2, so that S is finite at r = 0 */

struct surface_kernel {
    double amplitude; /* A */
    double reach;     /* s, m */
    double inverse;   /* 1/s, 1/m */
    double soft;      /* q^2 - r^2, m^2 */
    double value;     /* 2 A / (pi s d), 1/m^2: for areas given as volumes, area times d */
};

/* S of a model for particles that are `spacing` apart, m. */
static inline struct surface_kernel surface_kernel_make(const struct kernel_model *model,
                                                        double spacing) {
    double reach = model->reach * spacing;
    struct surface_kernel kernel = {
        model->surface, reach, 1.0 / reach, SURFACE_KERNEL_SOFT * reach * reach,
        2.0 * model->surface / 3.14159265358979323846 / (reach * spacing)};
    return kernel;
}

/* Distance, m, of the plane that adds `sum`; at most s. */
static inline double surface_kernel_distance(const struct surface_kernel *k, double sum) {
    double q = 1.0 - sqrt(sqrt(sum / k->amplitude));
    return q > sqrt(SURFACE_KERNEL_SOFT) ? k->reach * sqrt(q * q - SURFACE_KERNEL_SOFT) : 0.0;
}

/* Lower bound, m, of the distance of a surface whose samples add `sum`. Over the widest hole
 * between samples they add as much as a plane without a disc of 0.18 particle spacings. */
static inline double surface_kernel_least_distance(const struct surface_kernel *k, double sum,
                                                   double spacing) {
    double far = surface_kernel_distance(k, sum), hole = 0.18 * spacing;
    return far > hole ? sqrt(far * far - hole * hole) : 0.0;
}

/* Factor of the areas such that water rests `by` spacings farther from the surface. It is the
 * square root of the factor that gives lambda(0.5 + by) the value of lambda(0.5): with the full
 * factor water moves 1.9 times as far (measured with the cubic spline), because the slope of lambda
 * grows, too. */
static inline double surface_kernel_farther(const struct kernel_model *model, double by) {
    double half = 0.5 / model->reach, far = (0.5 + by) / model->reach;
    double ratio = (1.0 - sqrt(half * half + SURFACE_KERNEL_SOFT)) /
                   (1.0 - sqrt(far * far + SURFACE_KERNEL_SOFT));
    return ratio * ratio;
}

/* S / d, 1/m^3; zero for r >= s. squared: r^2, m^2. */
static inline double surface_kernel_value(const struct surface_kernel *k, double squared) {
    double q = sqrt(squared + k->soft), rest = 1.0 - q * k->inverse;
    return rest > 0.0 ? k->value * rest * rest / q * rest : 0.0;
}

/* (1/r) d(S/d)/dr, 1/m^5. squared: r^2, m^2. */
static inline double surface_kernel_slope(const struct surface_kernel *k, double squared) {
    double q = sqrt(squared + k->soft), rest = 1.0 - q * k->inverse;
    if (!(rest > 0.0)) return 0.0;
    return -(k->value * rest * rest / q) * (1.0 + 2.0 * q * k->inverse) / (q * q);
}

#endif
