/* How long a run of a scene takes, as `projdyn check` prints it. */
#ifndef TIME_ESTIMATE_H
#define TIME_ESTIMATE_H

#include "app.h"

/* Makes the first steps of the scene and prints an estimate of the time that a run takes. Returns
 * EXIT_GOOD, or EXIT_FAILED after a message if a step failed. */
int print_time_estimate(const pdyn_context *context, pdyn_sim *sim);

#endif
