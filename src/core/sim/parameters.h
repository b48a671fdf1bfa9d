/* Changing parameters of constraints while a simulation runs, and switching constraints off and on.
 */
#ifndef PDYN_PARAMETERS_H
#define PDYN_PARAMETERS_H

#include "base/snapshot_file.h"
#include "projdyn/module.h"

struct pdyn_sim;

/* Sets a parameter, all rows of a table, to a value within its bounds, if it is another one. */
pdyn_status parameters_follow(struct pdyn_sim *sim, int constraint, const pdyn_param *param,
                              const double *value);

void parameters_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
