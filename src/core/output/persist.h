#ifndef PDYN_PERSIST_H
#define PDYN_PERSIST_H

#include "base/archive.h"
#include "step/sim.h"

/* Writes the simulation to the archive, or reads it into one that was loaded from the same scene.
 * Where reading fails after the archive was found to be of this scene, for want of memory, the
 * simulation is of no further use. */
pdyn_status persist(struct pdyn_sim *sim, struct archive *archive);

#endif
