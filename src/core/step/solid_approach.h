/* How far moving solids and surfaces in contact approach each other in a step. A solid moves as
 * given, and pushes what is in its way by about the contact thickness in an iteration; in a step
 * that needs many of them it is held up, and the step stays unsolved. */
#ifndef PDYN_SOLID_APPROACH_H
#define PDYN_SOLID_APPROACH_H

#include "sim.h"

/* Returns the longest step, s, at most h, in which no solid approaches a vertex that it may reach
 * by more than twice the contact thickness. Without contact and moving solids: h. */
double solid_approach_limit(const struct pdyn_sim *sim, double h);

#endif
