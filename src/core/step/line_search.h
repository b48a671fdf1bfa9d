/* The line search of an iteration: from the iterate along sim->direction. */
#ifndef PDYN_LINE_SEARCH_H
#define PDYN_LINE_SEARCH_H

#include "sim/sim.h"

struct line_step {             /* a step along the direction */
    double length;             /* in directions, at most 4; 0: no step was accepted */
    double slope, slope_after; /* of E along the direction, before and after */
};

/* Moves the iterate along sim->direction and updates *energy and sim->gradient. If no step is
 * accepted, iterate, energy and gradient do not change. With a dual solver a step may raise E up to
 * `highest`, because multipliers are inaccurate. */
pdyn_status line_search(struct pdyn_sim *sim, double highest, double *energy,
                        struct line_step *taken);

#endif
