/* How much of a scene fits into a time. */
#ifndef WINDOW_H
#define WINDOW_H

#include "app.h"

struct window {
    double length, interval; /* s: simulated time, and between two frames */
    bool whole;              /* all of the scene */
    char sets[2][64];        /* overrides that make it */
};

/* Simulates the scene as it is, until its end or until so many seconds of processor time are spent.
 * An exit code. */
int window_find(const struct scene_options *scene, double seconds, struct window *window);
/* Of so many seconds of a scene that was loaded. */
void window_set(struct window *window, const pdyn_sim *sim, double length);

#endif
