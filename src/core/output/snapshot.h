/* Saved states of simulations. */
#ifndef PDYN_SNAPSHOT_H
#define PDYN_SNAPSHOT_H

#include "base/snapshot_file.h"
#include "sim/sim.h"

/* Writes the state of a simulation to a file. */
pdyn_status snapshot_write(struct pdyn_sim *sim, struct snapshot_file *snapshot);

/* Reads a state into a simulation loaded from the same scene. The state before goes to `before`, in
 * memory. PDYN_BAD_INPUT: the state is of another scene or version, or has an invalid field.
 * PDYN_NO_MEMORY. A call of snapshot_end_read must follow in every case. */
pdyn_status snapshot_read(struct pdyn_sim *sim, struct snapshot_file *snapshot,
                          struct snapshot_file *before);

/* Ends a read with the status of the whole operation and returns it: after a failure the simulation
 * gets its state before the read. If there is no memory for that, its next step fails. */
pdyn_status snapshot_end_read(struct pdyn_sim *sim, struct snapshot_file *before,
                              pdyn_status status);

#endif
