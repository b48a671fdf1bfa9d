/* Time integration. A step of length h is one implicit Euler step of length h_e from a base (x^,
 * v^):
 *
 *     s = x^ + h_e v^ + h_e^2 g
 *     x_(n+1) minimises E with step length h_e
 *     v_(n+1) = (x_(n+1) - x^) / h_e
 *
 *     euler   x^ = x_n                        h_e = h
 *     bdf2    x^ = x_n + c (x_n - x_(n-1))    h_e = h (1 + w) / (1 + 2 w)
 *             c = w^2 / (1 + 2 w),   w = h / (length of the previous step)
 *
 * v^ is computed from v_n and v_(n-1) in the same way. Both conserve linear momentum exactly:
 * internal forces sum to zero, and gravity adds h M g. */
#ifndef PDYN_INTEGRATOR_H
#define PDYN_INTEGRATOR_H

#include <stdbool.h>

struct pdyn_sim;

struct integrator {
    const char *name, *summary;
    /* Computes sim->x_base and sim->v_base for a step of length h, s; returns h_e, s. */
    double (*begin)(struct pdyn_sim *sim, double h);
    bool history; /* needs sim->x_before and sim->v_before */
};

#endif
