/* What `projdyn check` prints about a scene: its bodies with sizes, masses and velocities,
 * constraints, solids, gravity, solver, memory. */
#ifndef SCENE_SUMMARY_H
#define SCENE_SUMMARY_H

#include "app.h"

/* Returns EXIT_GOOD, or EXIT_FAILED after a message without memory. */
int print_scene_summary(const pdyn_context *context, const pdyn_sim *sim);

#endif
