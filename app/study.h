/* The runs of a trade: of a scene, of its beginning or of a coarser twin with all settings of the
 * plan, and how far each is from a reference. */
#ifndef STUDY_H
#define STUDY_H

#include "extent.h"
#include "farm.h"
#include "trade.h"

struct study {
    struct farm farm;     /* its runs; its scene has no overrides */
    double length, share; /* as extent_find() takes them */
    struct extent extent;
    struct plan plan;           /* for the scene: the same settings as */
    struct plan tried;          /* those for what is run */
    struct farm_run *reference; /* references: the last is the reference, the others coarser */
    int references;
    struct farm_run *run; /* of the settings, after those */
    struct trade trade;
};

/* Finds what to simulate, runs, and leaves the front in `trade`. An exit code. */
int study_do(struct study *study);
void study_free(struct study *study);

#endif
