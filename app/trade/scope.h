/* Scope: what `projdyn trade` simulates with every setting: the whole scene, a coarser replica
 * of it, or the first seconds of one of both. */
#ifndef SCOPE_H
#define SCOPE_H

#include "setting.h"
#include "time_window.h"

struct scope {
    const struct scene_options *user; /* the scene with the user's overrides */
    double coarsening;                /* factor of the replica; 1: no replica; 0: to be chosen */
    struct setting replica;           /* overrides that make the replica; none without a replica */
    struct scene_options runs;        /* the scene with the overrides of the user and the replica */
    struct time_window window;
};

/* Chooses replica and time window so that one run takes at most run_budget_s seconds of
 * processor time. length: of the window, s; 0: to be chosen. A coarsening or a length set by the
 * user is not changed. Returns an exit code. */
int scope_find(struct scope *scope, const struct jobs *jobs, double length, double run_budget_s);
void scope_print(const struct scope *scope);
void scope_free(struct scope *scope);

#endif
