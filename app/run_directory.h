/* The output directory of a run: its parts and the files of their frames. `mesh`, `usd`, `replay`,
 * `render` and `view` read it. */
#ifndef RUN_DIRECTORY_H
#define RUN_DIRECTORY_H

#include "app.h"
#include "vtk_frame.h"

#include <jansson.h>

enum {
    RUN_PATH = 4096 + 1, /* size of a path; one that fills it is too long for the system to open */
    PART_NAME = 64,      /* longest name of a body or a solid, bytes */
};

/* Values of points that the page can show as colours, and what it needs to draw water. */
enum channel {
    SPEED,         /* m/s */
    DENSITY_ERROR, /* relative, see replay_value() */
    PRESSURE,      /* Pa; negative ones count as 0 */
    FILLED,        /* of fluids: see replay_filled.h; 1 for other particles */
    CHANNELS
};

enum part_kind { BODY, SOLID, BOUNDARY };

/* A body, a solid or the boundary points. */
struct part {
    enum part_kind kind;
    bool rest;             /* one file for all frames */
    const char *folder;    /* of its files in the directory of the run: "" or "solids/" */
    const char *name;      /* owned by the report, or by run->body_list */
    const char *color;     /* "#rrggbb"; NULL: none of its own */
    const char *shape;     /* of a solid: "box", "mesh", ...; "rigid" of a rigid body */
    json_t *series;        /* content of NAME.vtk.series, or the like for a part at rest */
    json_t *files;         /* its array of frames */
    bool fluid;            /* particles with a constraint of type fluid */
    double radius;         /* of particles, m */
    double rest_density;   /* of particles, kg/m^3; 0: unknown */
    struct vtk_frame skin; /* of a body with NAME.skin.vtk, drawn in its place but in a live view,
                              which moves vertices of the body; count 0: none */

    /* What replay_load (replay/replay_run.h) finds in all frames; 0 without it. */
    int count;             /* points, maximum over the frames */
    int *frame_points;     /* points of each frame; particles may enter and leave */
    int triangles;         /* 0 for particles and boundary points */
    int *triangle;         /* triangles x 3 */
    struct box box;        /* of all points */
    int channels;          /* the first so many values of enum channel are there */
    double most[CHANNELS]; /* largest value of each */
};

struct run {
    const char *directory;
    json_t *report; /* report.json, or "scene" of files.json while there is none; NULL: neither */
    const char *source; /* name of the file that `report` was read from */
    json_t *body_list;  /* array of the bodies, as in report.json */
    int parts, frames;
    struct part *part; /* the bodies, then solids, then boundary points */

    /* Of the page (replay/). */
    json_t *metrics; /* columns of metrics.csv for the plots; NULL: missing */
    json_t *live;    /* of a live view: what the page needs to talk to it; NULL: a replay */
};

/* Functions that return int return an exit code, after a message unless it is EXIT_GOOD. */

/* Prints a message to stderr; returns EXIT_BAD_INPUT. */
int run_error(const char *format, ...) PDYN_PRINTF(1, 2);

/* Path of a file in the run's directory. */
void run_path(char path[RUN_PATH], const struct run *run, const char *format, ...)
    PDYN_PRINTF(3, 4);

/* Finds the parts of run->directory and the files of their frames, and reads no frame. The caller
 * calls run_close() in any case. */
int run_open(struct run *run);
/* The same, and refuses a run with neither report.json nor files.json, whose kinds of bodies and
 * radii of particles are unknown. */
int run_open_with_report(struct run *run);
/* Whether z is up in the scene; without a report y is. */
bool run_is_z_up(const struct run *run);
void run_close(struct run *run);
/* Reads the list of frames FOLDER/NAME.vtk.series of a part, which the caller frees (part->series);
 * a part at rest has the file NAME.vtk. Part of run_open. */
int part_open_series(const struct run *run, struct part *part);
/* Time of frame f of a part, s. */
double part_time(const struct part *part, int f);
/* Whether frame f of a part is that of a time, s, but for rounding. */
bool part_has_time(const struct part *part, int f, double time);
/* Number of frames of a part that are stored: 1 for a part at rest. */
int part_frames(const struct run *run, const struct part *part);
/* Reads frame f of a part, for a part at rest its only one; path: of the file that was read. A body
 * with a skin gives the points and triangles of the skin. */
int part_read_frame(const struct run *run, const struct part *part, int f, char path[RUN_PATH],
                    struct vtk_frame *frame);

#endif
