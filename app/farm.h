/* Runs of a scene with different settings, several at a time, each in a process and a directory of
 * its own. A directory is there when its run has ended, and is kept: what is there is not run
 * again. Several farms, one after the other or at the same time, may work on one directory. */
#ifndef FARM_H
#define FARM_H

#include "app.h"

enum { FARM_KEY = 17, FARM_PATH = 4096 };

enum farm_status { FARM_MISSING, FARM_ENDED };

struct farm_run {
    char **set; /* sets: overrides PATH=VALUE */
    int sets;
    bool frames;        /* are written */
    double limit_s;     /* of processor time, then it is ended; 0: none */
    char key[FARM_KEY]; /* of scene, settings, frames and limit: the name of its directory */
    enum farm_status status;
};

struct farm {
    struct scene_options scene; /* and plug-ins; what differs is in the runs */
    const char *output;
    int jobs, threads; /* processes at a time, threads of each */
    bool quiet;
    long count;
    struct farm_run *run; /* count */
};

/* More overrides for a run, texts that outlive it; false without memory. `run->set` is to be freed.
 */
bool farm_add(struct farm_run *run, const char *const *set, int sets);

/* The key of every run, and which of them have ended. An exit code. */
int farm_survey(struct farm *farm);
/* Runs what has not ended. EXIT_GOOD: all have ended, well or not. */
int farm_work(struct farm *farm);

/* OUTPUT/KEY + ending; false with a message where it is too long. */
bool farm_path(char path[FARM_PATH], const struct farm *farm, const struct farm_run *run,
               const char *ending);

#endif
