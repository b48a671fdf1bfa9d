/* Time integration. A step of length h is one implicit Euler step of length H from a base (x^, v^):
 *
 *     s = x^ + H v^ + H^2 g,   x_(n+1) minimises E with H for the length,   v_(n+1) = (x_(n+1) -
 * x^)/H
 *
 *     euler   x^ = x_n                        H = h
 *     bdf2    x^ = x_n + c (x_n - x_(n-1))    H = h (1 + w)/(1 + 2 w)
 *             c = w^2/(1 + 2 w),   w = h over the length of the step before
 *
 * and v^ from v_n and v_(n-1) as x^ from x_n and x_(n-1). Linear momentum is exact with both: what
 * is internal sums to zero, and gravity adds h M g. */
#ifndef PDYN_INTEGRATOR_H
#define PDYN_INTEGRATOR_H

#include <stdbool.h>

struct pdyn_sim;

struct integrator {
    const char *name, *summary;
    /* Fills sim->x_base and sim->v_base for a step of length h, s; returns H, s. */
    double (*begin)(struct pdyn_sim *sim, double h);
    bool history; /* `begin` needs sim->x_before and sim->v_before */
};

/* After a step of length h whose velocities are known: those of impacts become what Euler's would
 * be, in the history, too. Returns how many constraints had an impact; 0 with Euler. */
int integrator_impacts(struct pdyn_sim *sim, double h);

#endif
