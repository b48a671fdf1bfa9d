/* The global step: the direction from an iterate to the minimum of the quadratic model of E. */
#ifndef PDYN_GLOBAL_STEP_H
#define PDYN_GLOBAL_STEP_H

#include "sim/sim.h"

/* Linearises E at the iterate of the last local step, with a damping eps, and minimises the model
 * as accurately as the scene's settings say. sim->direction: the displacement to the minimum;
 * *linear: iterations of the linear solver are added. */
pdyn_status global_step(struct pdyn_sim *sim, double eps, bool first_of_step, int *linear);

#endif
