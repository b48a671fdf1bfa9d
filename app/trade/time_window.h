/* Time window: the part of a scene, from its start, that `projdyn trade` simulates. */
#ifndef TIME_WINDOW_H
#define TIME_WINDOW_H

#include "jobs.h"

struct time_window {
    double length;                         /* simulated time, s */
    double frame_interval;                 /* s */
    bool whole;                            /* the window is the whole scene */
    char sets[2][64];                      /* overrides that set duration and frame_interval */
    double scene_duration, scene_interval; /* s: duration and frame interval of the scene */
    char solver[64];                       /* solver type of the scene */
};

/* Makes a window of `length` seconds of the scene. length = 0: makes the window as long as a run
 * gets within `run_budget_s` seconds of processor time (a calibration run). Returns an exit
 * code. */
int time_window_find(const struct jobs *jobs, const struct scene_options *scene, double length,
                     double run_budget_s, struct time_window *window);

#endif
