/* The minimisation of E in one step. */
#ifndef PDYN_MINIMISE_H
#define PDYN_MINIMISE_H

#include "sim/sim.h"

struct progress {
    double energy;        /* J, at the iterate */
    double energy_before; /* J, an iteration earlier */
    double residual;      /* the largest of all bodies at the iterate */
    bool far_off;         /* the residual is far above the tolerance at the end of the attempt */
    double rise;          /* J: velocities_measure_rise */
    int outer, linear;    /* iterations */
};

/* From s, in sim->x_next, to the minimum, as far as the scene's settings say. The last local step
 * is then that of x_next, its gradient sim->gradient. */
pdyn_status minimise(struct pdyn_sim *sim, struct progress *progress);

#endif
