#ifndef PDYN_SNAPSHOT_H
#define PDYN_SNAPSHOT_H

#include "base/snapshot_file.h"
#include "step/sim.h"

/* Writes the simulation to the snapshot, or reads it into one that was loaded from the same scene.
 * Where reading fails after the file was found to be of this scene, for want of memory, the
 * simulation is of no further use. */
pdyn_status persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
