/* Kernels of the density sums: the cubic spline W (Monaghan 1992, normalised in 3-D, support H)
 * between fluid particles, and the surface kernel S between particles and surfaces. */
#ifndef PROJDYN_KERNEL_H
#define PROJDYN_KERNEL_H

#include <math.h>

struct kernel {
    double support, inverse; /* H, m; 1/H */
    double value;            /* 8 / (pi H^3), 1/m^3 */
    double slope;            /* 6 value / H^2, 1/m^5 */
};

static inline struct kernel kernel_make(double support) {
    double value = 8.0 / (3.14159265358979323846 * support * support * support);
    return (struct kernel){support, 1.0 / support, value, 6.0 * value / (support * support)};
}

/* W(r), 1/m^3; zero for r >= H. */
static inline double kernel_value(const struct kernel *k, double r) {
    double q = r * k->inverse, rest = 1.0 - q;
    if (q <= 0.5) return k->value * (1.0 - 6.0 * q * q * rest);
    return q < 1.0 ? 2.0 * k->value * rest * rest * rest : 0.0;
}

/* W'(r) / r, 1/m^5, so that grad W(d) = kernel_slope(|d|) d; finite at r = 0. */
static inline double kernel_slope(const struct kernel *k, double r) {
    double q = r * k->inverse, rest = 1.0 - q;
    if (q <= 0.5) return k->slope * (3.0 * q - 2.0);
    return q < 1.0 ? -k->slope * rest * rest / q : 0.0;
}

/* The surface kernel: what a unit of area at distance r adds to the density of a fluid with
 * particle spacing d,
 *
 *     S(r) = 2 A / (pi d q) (1 - q/d)^3,   q^2 = r^2 + (d/10)^2,   S = 0 for q >= d.
 *
 * A plane at distance z then adds lambda(z) = A (1 - q(z)/d)^4, in place of the half space of fluid
 * that is missing behind the plane. At z = d/2 a cubic lattice needs lambda = 0.150 and, because a
 * surface has no density constraint that pushes back, twice the slope of a layer of particles,
 * -1.02/d. Water at rest is less regular and keeps the distance d/2 with A = 2.2 (lambda = 0.127,
 * slope -1.02/d). Close to the surface lambda exceeds 1, so that a single particle is compressed
 * and cannot pass. */
#define SURFACE_AMPLITUDE 2.2 /* A */

struct surface_kernel {
    double inverse; /* 1/d, 1/m */
    double soft;    /* (d/10)^2, m^2 */
    double value;   /* 2 A / (pi d^2), 1/m^2: for areas given as volumes, area times d */
};

static inline struct surface_kernel surface_kernel_make(double spacing) {
    return (struct surface_kernel){1.0 / spacing, 0.01 * spacing * spacing,
                                   2.0 * SURFACE_AMPLITUDE / 3.14159265358979323846 /
                                       (spacing * spacing)};
}

/* Distance, m, of the plane that adds `sum`; at most d. */
static inline double surface_kernel_distance(double sum, double spacing) {
    double q = 1.0 - sqrt(sqrt(sum / SURFACE_AMPLITUDE));
    return q > 0.1 ? spacing * sqrt(q * q - 0.01) : 0.0;
}

/* Factor of the areas such that water rests `by` spacings farther from the surface. It is the
 * square root of the factor that gives lambda(0.5 + by) the value of lambda(0.5): with the full
 * factor water moves 1.9 times as far (measured), because the slope of lambda grows, too. */
static inline double surface_kernel_farther(double by) {
    double near = 1.0 - sqrt(0.5 * 0.5 + 0.01), far = 0.5 + by;
    double ratio = near / (1.0 - sqrt(far * far + 0.01));
    return ratio * ratio;
}

/* S / d, 1/m^3; zero for r >= d. squared: r^2, m^2. */
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
