/* How far moving solids and surfaces in contact approach each other in a step. In one iteration
 * contact moves a surface in front of a solid by about the contact thickness. A solid that moves by
 * many thicknesses in a step would need more iterations than the step has, and the step would not
 * be solved. */
#ifndef PDYN_SOLID_APPROACH_H
#define PDYN_SOLID_APPROACH_H

#include "sim/sim.h"

/* Returns the longest step, s, at most h, in which no solid approaches a vertex that it may reach
 * by more than twice the contact thickness. Without contact and moving solids: h. */
double solid_approach_limit(const struct pdyn_sim *sim, double h);

#endif
