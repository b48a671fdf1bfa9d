/* Input of `projdyn replay`: the output directory of a run, with its bodies, the files of their
 * frames and the ranges of their values. Frames are read twice: first for the ranges, then for
 * the page. */
#ifndef REPLAY_RUN_H
#define REPLAY_RUN_H

#include "app.h"
#include "vtk_frame.h"

#include <jansson.h>

enum { REPLAY_PATH = 4096 }; /* size of a path with its NUL */

/* Axis-aligned box, m. */
struct box {
    double min[3], max[3];
};

/* A body, or the boundary points on moving solids. */
struct body {
    const char *name;    /* owned by run->body_list */
    json_t *series;      /* content of NAME.vtk.series */
    json_t *files;       /* its array of frames */
    int count;           /* points, maximum over the frames */
    int triangles;       /* 0 for particles */
    int *frame_points;   /* points of each frame; particles may enter and leave */
    int *triangle;       /* triangles x 3 */
    bool has_channels;   /* particles: the page stores their speed and density error */
    double radius;       /* of particles, m */
    double rest_density; /* of particles, kg/m^3; 0: unknown */
    double max_speed;    /* m/s */
    double max_error;    /* largest density error, relative */
};

struct run {
    const char *directory;
    json_t *report;    /* report.json; NULL: missing */
    json_t *body_list; /* array of the bodies, as in report.json */
    json_t *metrics;   /* columns of metrics.csv for the plots; NULL: missing */
    int body_count;
    int part_count; /* bodies, and one more if there are boundary points that move */
    int frames;
    struct body *body;         /* part_count: the bodies, then the moving boundary points */
    struct box box;            /* of all points in all frames */
    struct vtk_frame boundary; /* fixed boundary points; none if count is 0 */
    struct box boundary_box;
};

/* Functions that return int return an exit code, after a message unless it is EXIT_GOOD. */

/* Prints a message to stderr; returns EXIT_BAD_INPUT. */
int replay_error(const char *format, ...) PDYN_PRINTF(1, 2);

/* Path of NAME + ending in the run's directory; false if it is too long. */
bool replay_path(char path[REPLAY_PATH], const struct run *run, const char *name,
                 const char *ending);

/* Finds the bodies and the files of their frames; reads no frame. The caller calls
 * replay_close() in any case. */
int replay_open(struct run *run);
void replay_close(struct run *run);
/* Reads run->metrics; leaves it NULL if metrics.csv is missing. */
int replay_read_metrics(struct run *run);
/* Reads all frames for boxes, counts and largest values, and the fixed boundary points. */
int replay_find_ranges(struct run *run);

/* Time of frame f, s. */
double replay_time(const struct body *body, int f);
/* Reads frame f of body[b]; path: of the file that was read. */
int replay_read_frame(const struct run *run, int b, int f, char path[REPLAY_PATH],
                      struct vtk_frame *frame);
/* Checks that a frame has the mesh of the first frame. */
int replay_check_frame(const struct body *body, const struct vtk_frame *frame, const char *path);
/* Speed of point i, m/s. */
double replay_speed(const struct vtk_frame *frame, int i);
/* Relative density error of particle i: max(0, density / rest density - 1), at most 1e9. */
double replay_density_error(const struct body *body, const struct vtk_frame *frame, int i);

#endif
