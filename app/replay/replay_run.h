/* A finished run as its replay needs it: which bodies there are, their frames, what these span. */
#ifndef REPLAY_RUN_H
#define REPLAY_RUN_H

#include "app.h"
#include "read_file.h"
#include "vtk_frame.h"

#include <jansson.h>

enum { REPLAY_PATH = 4096 };

struct box {
    double min[3], max[3];
};

struct body {
    const char *name;            /* owned by the run's `bodies` */
    json_t *series;              /* its file */
    json_t *files;               /* the frames in it */
    int count, triangles;        /* count: the most points of a frame */
    int *points;                 /* frames: particles may come and go */
    int *triangle;               /* triangles x 3 */
    bool shaded;                 /* its points may have a speed and a density error */
    double radius, rest_density; /* of particles; rest density 0: unknown */
    double max_speed, max_error;
};

struct run {
    const char *directory;
    json_t *report, *bodies, *metrics; /* report NULL: there is none */
    int count, parts, frames;
    struct body *body; /* parts: the bodies, then boundary points that move, if there are any */
    struct box box;
    struct vtk_frame boundary; /* no points: there is none */
    struct box boundary_box;
};

/* What returns an int returns an exit code, after a message if it is not EXIT_GOOD. */
int replay_fail(const char *format, ...) PDYN_PRINTF(1, 2); /* bad input */
int replay_no_memory(void);

/* The path of NAME + ENDING in the run's directory; false: too long. */
bool replay_path(char path[REPLAY_PATH], const struct run *run, const char *name,
                 const char *ending);

/* Finds the bodies and their frames, but reads none of them. To be closed on failure, too. */
int replay_open(struct run *run);
void replay_close(struct run *run);
int replay_read_metrics(struct run *run); /* leaves them NULL where the run has none */
/* Reads all frames for what they span, and the boundary. */
int replay_survey(struct run *run);

double replay_time(const struct body *body, int f);
int replay_read_frame(const struct run *run, int b, int f, char path[REPLAY_PATH],
                      struct vtk_frame *frame);
/* Is it of the same mesh as the first? */
int replay_check_frame(const struct body *body, const struct vtk_frame *frame, const char *path);
double replay_speed(const struct vtk_frame *frame, int i);
double replay_density_error(const struct body *body, const struct vtk_frame *frame, int i);

#endif
