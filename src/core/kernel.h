/* The cubic spline kernel (Monaghan 1992), normalised in 3-D, with compact support H. */
#ifndef PDYN_KERNEL_H
#define PDYN_KERNEL_H

#include "projdyn/vec3.h"
#include "simd.h"

struct kernel {
    double support, inverse; /* H, m; 1/H */
    double value;            /* 8 / (pi H^3), 1/m^3 */
    double slope;            /* 6 value / H^2, 1/m^5 */
};

static inline struct kernel kernel_make(double support) {
    double value = 8.0 / (3.14159265358979323846 * support * support * support);
    return (struct kernel){support, 1.0 / support, value, 6.0 * value / (support * support)};
}

/* Both without a branch, so that loops over neighbours run in lanes. */

/* W(r), 1/m^3; zero from r = H on. */
INLINE double kernel_value(const struct kernel *k, double r) {
    double q = r * k->inverse, rest = q < 1.0 ? 1.0 - q : 0.0;
    return k->value * (q <= 0.5 ? 1.0 - 6.0 * q * q * rest : 2.0 * rest * rest * rest);
}

/* W'(r) / r, 1/m^5, so that grad W(d) = kernel_slope(|d|) d; finite at r = 0. */
INLINE double kernel_slope(const struct kernel *k, double r) {
    double q = r * k->inverse, rest = q < 1.0 ? 1.0 - q : 0.0;
    return k->slope * (q <= 0.5 ? 3.0 * q - 2.0 : -rest * rest / q);
}

#endif
