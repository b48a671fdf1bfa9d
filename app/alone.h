/* One run of a scene while nothing else runs: how far it comes in a time. Kept as those of a farm.
 */
#ifndef ALONE_H
#define ALONE_H

#include "farm.h"
#include "metrics.h"

/* The steps that a run made until its limit, at least one; of the farm are its scene and directory.
 * EXIT_GOOD; or an exit code with a message and nothing to be freed, EXIT_FAILED where the run
 * itself fails. */
int alone_run(const struct farm *farm, struct farm_run *run, struct metrics *steps);

/* s, simulated by steps. */
double alone_end(const struct metrics *steps);
/* ms of processor time that steps up to this time took. */
double alone_spent(const struct metrics *steps, double time);

#endif
