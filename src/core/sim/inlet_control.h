/* Inlets that a program moves, opens and shuts while the simulation runs. */
#ifndef PDYN_INLET_CONTROL_H
#define PDYN_INLET_CONTROL_H

#include "base/snapshot_file.h"

struct pdyn_sim;

/* Writes or reads motion and speed of an inlet (index in all of them). */
void inlet_control_persist(struct pdyn_sim *sim, int inlet, struct snapshot_file *snapshot);

#endif
