/* Changing parameters of constraints while a simulation runs, and switching constraints off and on.
 */
#ifndef PDYN_PARAMETERS_H
#define PDYN_PARAMETERS_H

#include "base/snapshot_file.h"
#include "projdyn/module.h"

struct pdyn_sim;

/* Whether pdyn_set_parameter can change this parameter. */
bool parameter_is_changeable(const pdyn_constraint_type *type, const pdyn_param *param);

void parameters_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
