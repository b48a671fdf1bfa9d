/* Input of `projdyn replay`: the directory of a run with the ranges of its values. Frames are read
 * twice: first for the ranges, then for the page. */
#ifndef REPLAY_RUN_H
#define REPLAY_RUN_H

#include "run_directory.h"

/* As run_open, and reads all that the page needs but the points. A run with neither report.json nor
 * files.json gives a warning. */
int replay_load(struct run *run);
/* Reads run->metrics; leaves it NULL if metrics.csv is missing. */
int replay_read_metrics(struct run *run);

/* Checks that a frame has the mesh of the first frame. */
int replay_check_frame(const struct part *part, const struct vtk_frame *frame, const char *path);
/* Value of a channel at point i, at least 0; a density error, max(0, density / rest density - 1),
 * is at most 1e9; FILLED: its largest value, 1. */
double replay_value(const struct part *part, const struct vtk_frame *frame, enum channel channel,
                    int i);

#endif
