/* What `projdyn check` prints about a scene: its bodies with sizes, masses and velocities,
 * constraints, solids, gravity, solver, memory, and how long a run takes. */
#ifndef SCENE_SUMMARY_H
#define SCENE_SUMMARY_H

#include "app.h"

/* Returns EXIT_GOOD, or EXIT_FAILED after a message without memory. */
int print_scene_summary(const pdyn_context *context, const pdyn_sim *sim);

/* Makes the first steps of the scene and prints an estimate of the time that a run takes. Returns
 * EXIT_GOOD, or EXIT_FAILED after a message if a step failed. */
int print_time_estimate(const pdyn_context *context, pdyn_sim *sim);

#endif
