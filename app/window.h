/* How much of a scene fits into a time. */
#ifndef WINDOW_H
#define WINDOW_H

#include "farm.h"

struct window {
    double length, interval;       /* s: simulated time, and between two frames */
    bool whole;                    /* all of the scene */
    char sets[2][64];              /* overrides that make it */
    double duration, own_interval; /* s, of the scene itself */
    char solver[64];               /* that it uses */
};

/* Of so many seconds of the scene; where that is 0, runs it as it is until its end, or until
 * `share` seconds of processor time are spent. An exit code. */
int window_find(const struct farm *farm, const struct scene_options *scene, double length,
                double share, struct window *window);

#endif
