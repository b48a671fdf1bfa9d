/* The cubic spline kernel (Monaghan 1992), normalised in 3-D, with compact support H. */
#ifndef PDYN_KERNEL_H
#define PDYN_KERNEL_H

#include "projdyn/vec3.h"

struct kernel {
    double support; /* H, m */
    double scale;   /* 8 / (pi H^3), 1/m^3 */
};

static inline struct kernel kernel_make(double support) {
    return (struct kernel){support, 8.0 / (3.14159265358979323846 * support * support * support)};
}

/* W(r), 1/m^3; zero from r = H on. */
static inline double kernel_value(const struct kernel *k, double r) {
    double q = r / k->support;
    if (q <= 0.5) return k->scale * (6.0 * q * q * (q - 1.0) + 1.0);
    if (q < 1.0) return k->scale * 2.0 * (1.0 - q) * (1.0 - q) * (1.0 - q);
    return 0.0;
}

/* W'(r) / r, 1/m^5, so that grad W(d) = kernel_slope(|d|) d; finite at r = 0. */
static inline double kernel_slope(const struct kernel *k, double r) {
    double q = r / k->support, unit = 6.0 * k->scale / (k->support * k->support);
    if (q <= 0.5) return unit * (3.0 * q - 2.0);
    if (q < 1.0) return -unit * (1.0 - q) * (1.0 - q) / q;
    return 0.0;
}

#endif
