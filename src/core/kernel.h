/* The cubic spline kernel (Monaghan 1992), normalised in 3-D, with compact support H. */
#ifndef PDYN_KERNEL_H
#define PDYN_KERNEL_H

#include "projdyn/vec3.h"

struct kernel {
    double support, inverse; /* H, m; 1/H */
    double value;            /* 8 / (pi H^3), 1/m^3 */
    double slope;            /* 6 value / H^2, 1/m^5 */
};

static inline struct kernel kernel_make(double support) {
    double value = 8.0 / (3.14159265358979323846 * support * support * support);
    return (struct kernel){support, 1.0 / support, value, 6.0 * value / (support * support)};
}

/* W(r), 1/m^3; zero from r = H on. */
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

#endif
