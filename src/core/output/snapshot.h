/* Saved states of simulations. */
#ifndef PDYN_SNAPSHOT_H
#define PDYN_SNAPSHOT_H

#include "base/snapshot_file.h"
#include "step/sim.h"

/* Writes the state of a simulation to a file, or reads it into a simulation loaded from the same
 * scene. PDYN_BAD_INPUT: the state is of another scene or version. If reading fails after these
 * checks, the simulation must be freed. */
pdyn_status snapshot_simulation(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
