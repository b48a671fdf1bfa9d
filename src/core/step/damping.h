/* eps, the damping of the global steps, by Levenberg and Marquardt: more after a step that was
 * shortened, less after a whole one.
 *
 * With a dual solver eps is 0 in the first iteration, which makes the whole inertial step. Later
 * the slope at the end of a step sets eps: it tells whether the step was too long or too short.
 * Damping there stands for the second derivatives of a fluid's constraints, which H leaves out. */
#ifndef PDYN_DAMPING_H
#define PDYN_DAMPING_H

#include "line_search.h"

/* eps at the start of a step. With a dual solver eps falls from step to step; beside rows a step
 * after an unsolved one begins undamped. */
double damping_at_start(const struct pdyn_sim *sim);

/* eps after an iteration with the damping sim->eps. A projective step has the same in all. */
double damping_after(const struct pdyn_sim *sim, const struct line_step *taken);

#endif
