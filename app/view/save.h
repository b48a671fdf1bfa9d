/* The state of a live view as a run that `projdyn run --resume` continues. */
#ifndef SAVE_H
#define SAVE_H

#include "live.h"

/* Writes the state of a simulation to a folder as a run of one frame: frame and report.json, and,
 * with `state`, state.pdyn. */
pdyn_status save_frame(pdyn_sim *sim, const char *folder, bool state);

/* Writes frame, report.json, run.json and state.pdyn to a new directory SCENE_live_N in the current
 * directory. Its name, or an error, becomes a note. */
void save_run(struct live *live);

#endif
