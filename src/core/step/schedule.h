/* Constraints that a scene gives times: "from" and "until". */
#ifndef PDYN_SCHEDULE_H
#define PDYN_SCHEDULE_H

#include "sim.h"

/* When a simulation has been built: switches the constraints off that begin later. */
pdyn_status schedule_start(struct pdyn_sim *sim);

/* Before a step: switches the constraints on whose time begins with it, and those off whose time
 * has ended. What a program has switched since (pdyn_enable) stays as it is. */
pdyn_status schedule_switch(struct pdyn_sim *sim);

#endif
