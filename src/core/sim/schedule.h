/* What a scene changes over time: constraints with "from" and "until", and parameters and gravity
 * with keys. */
#ifndef PDYN_SCHEDULE_H
#define PDYN_SCHEDULE_H

#include "base/snapshot_file.h"
#include "projdyn/module.h"

struct pdyn_sim;
struct scene_constraint;

/* When a simulation has been built: switches the constraints off that begin later, and sets what
 * has keys. */
pdyn_status schedule_start(struct pdyn_sim *sim);

/* Before a step: switches constraints on or off whose "from" or "until" has come, and sets what has
 * keys to the value of this time. A constraint that a program has switched since then (pdyn_enable)
 * stays so, and a value that it has set (pdyn_set_parameter, pdyn_set_gravity) no longer follows
 * its keys. */
pdyn_status schedule_switch(struct pdyn_sim *sim);

/* Whether the "until" of a constraint has come when the next step begins. */
bool schedule_has_ended(const struct pdyn_sim *sim, const struct scene_constraint *constraint);

/* Notes that a program has set a parameter: its keys do not count any more. */
void schedule_replace(struct pdyn_sim *sim, int constraint, const pdyn_param *param);

/* Writes or reads which keys do not count any more. */
void schedule_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
