/* The simulation of a live view, and what the page that shows it has been told. One thread calls
 * these functions (session.h). */
#ifndef LIVE_H
#define LIVE_H

#include "replay_run.h"
#include "scene_options.h"

struct live {
    const struct scene_options *scene;
    pdyn_context *context;
    pdyn_sim *sim;
    struct run run;       /* the parts of the page: bodies, solids, boundary points */
    pdyn_step_info step;  /* results of the last step; all 0 before the first one */
    double step_ms;       /* wall-clock time of the last step */
    long steps;           /* since the start */
    int starts;           /* number of times that the scene was loaded */
    bool running, single; /* steps on; takes one step and stops */
    bool real_time;       /* simulated time does not run ahead of the clock; see live_due() */
    bool failed;          /* a step failed: only a restart goes on */
    bool stale;           /* the page does not show the state */
    int held;             /* particle that the page holds; -1: none */
    double clock_s;       /* wall-clock time at which the simulated time was 0, in real time */
    json_t *notes;        /* texts for the page, for the next frame */
    json_t *told;         /* members of the last frame that are only sent when they change */
};

/* Loads the scene and makes the page of its first frame, with its NUL. Returns an exit code, after
 * a message unless it is EXIT_GOOD. The caller calls live_close() in any case, and frees *page. */
int live_open(struct live *live, const struct scene_options *scene, char **page);
void live_close(struct live *live);

/* Loads the scene again. After an error, which becomes a note, the simulation stays: one in the
 * scene, or bodies and solids that are not those of the page. */
void live_restart(struct live *live);
/* Takes a step. After an error, which becomes a note, only a restart goes on. */
void live_step(struct live *live);
/* Wall-clock time, s, at which the next step is due; 0: at once. */
double live_due(struct live *live);

/* Does what a message of the page says (docs of the messages: actions.c); errors become notes. */
void live_act(struct live *live, const json_t *message);

/* A note for the page; bad: something failed. */
void live_note(struct live *live, bool bad, const char *format, ...) PDYN_PRINTF(3, 4);

#endif
