/* Constraints that a scene gives times: "from" and "until". */
#ifndef PDYN_SCHEDULE_H
#define PDYN_SCHEDULE_H

#include "sim.h"

/* Before a step: switches the constraints on whose time begins with it, and those off whose time
 * has ended. What a program has switched since (pdyn_enable) stays as it is. */
pdyn_status schedule_switch(struct pdyn_sim *sim);

#endif
