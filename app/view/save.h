/* The state of a live view as a run that `projdyn run --resume` continues. */
#ifndef SAVE_H
#define SAVE_H

#include "live.h"

/* Writes frame, report.json, run.json and state.pdyn to a new directory SCENE_live_N in the current
 * directory. Its name, or an error, becomes a note. */
void save_run(struct live *live);

#endif
