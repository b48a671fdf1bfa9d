/* Plan of a study: the settings that `projdyn trade` runs on a scene, and its reference
 * settings. */
#ifndef PLAN_H
#define PLAN_H

#include "setting.h"
#include "time_window.h"

#include <jansson.h>

enum { PLAN_REFERENCES = 6 };

struct plan {
    const json_t *scene; /* what plan_make was called with; used by it alone */
    const struct time_window *window;
    double coarsening;
    int count, capacity;
    struct setting *setting; /* count */
    /* BDF2 solved to a small residual, with steps of 1/4, 1/8, ... 1/128 of the scene's length. */
    struct setting reference[PLAN_REFERENCES];
};

/* scene: JSON with the user's overrides applied; window: of the runs; coarsening: linear iteration
 * limits are multiplied by it, so that a plan for a scene and a plan for its replica (coarsening 1)
 * match: information travels one spacing per linear iteration. false if memory ran out; the caller
 * calls plan_free() in any case. */
bool plan_make(struct plan *plan, const json_t *scene, const struct time_window *window,
               double coarsening);
void plan_free(struct plan *plan);

#endif
