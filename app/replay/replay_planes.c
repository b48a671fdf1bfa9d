/* Codes the frames of a run for the page: quantisation, prediction, residuals. */
#include "replay_planes.h"
#include "replay_filled.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLANES = 3 + CHANNELS }; /* x, y, z, and the channels */

/* One quantised number per point, in the current frame and in the two frames before it. */
struct plane {
    bool wide;                            /* 16 bits, otherwise 8 */
    uint16_t *now, *previous, *preceding; /* count; preceding: two frames before `now` */
};

/* Position of a value between min and max: 0 ... levels; 0 where max <= min. */
static uint16_t quantise(double value, double min, double max, double levels) {
    if (!(max > min)) return 0;
    return (uint16_t)lrint(levels * fmin(1.0, fmax(0.0, (value - min) / (max - min))));
}

uint16_t replay_code_position(const struct vtk_frame *frame, const struct box *box, int i, int k) {
    return quantise(frame->x[3 * i + k], box->min[k], box->max[k], 65535.0);
}

uint16_t replay_code_value(const struct part *part, const struct vtk_frame *frame,
                           enum channel channel, const double *filled, double most, int i) {
    bool given = channel == FILLED && filled;
    double value = given ? filled[i] : replay_value(part, frame, channel, i);
    return quantise(sqrt(value), 0.0, sqrt(most), 255.0);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static int plane_count(const struct part *part) { return 3 + part->channels; }

static void free_planes(const struct run *run, struct plane (*plane)[PLANES]) {
    for (int b = 0; b < run->parts && plane; b++)
        for (int p = 0; p < PLANES; p++) {
            free(plane[b][p].now);
            free(plane[b][p].previous);
            free(plane[b][p].preceding);
        }
    free(plane);
}

/* Planes of every part, zeroed; NULL if memory ran out. */
static struct plane (*make_planes(const struct run *run))[PLANES] {
    struct plane(*planes)[PLANES] = calloc((size_t)run->parts, sizeof *planes);
    bool good = planes;
    for (int b = 0; b < run->parts && good; b++) {
        size_t count = (size_t)run->part[b].count + 1; /* + 1: a part may never have had points */
        for (int p = 0; p < plane_count(&run->part[b]) && good; p++) {
            struct plane *plane = &planes[b][p];
            plane->wide = p < 3;
            plane->now = calloc(count, sizeof *plane->now);
            plane->previous = calloc(count, sizeof *plane->previous);
            plane->preceding = calloc(count, sizeof *plane->preceding);
            good = plane->now && plane->previous && plane->preceding;
        }
    }
    if (good) return planes;
    free_planes(run, planes);
    return NULL;
}

/* ---- prediction ------------------------------------------------------------------------------ */

/* Weights of the two frames before: no prediction, constant, linear extrapolation. The page's
 * JavaScript has the same table. */
static const struct predictor { int previous, preceding; } predictors[] = {{0, 0}, {1, 0}, {2, -1}};

enum { PREDICTORS = sizeof predictors / sizeof *predictors };

/* Value minus prediction, modulo the range of the plane, mapped to small unsigned numbers: 0,
 * -1, 1, -2, 2, ... to 0, 1, 2, 3, 4, ... */
static unsigned residual(const struct plane *plane, const struct predictor *p, int i) {
    int difference =
        plane->now[i] - p->previous * plane->previous[i] - p->preceding * plane->preceding[i];
    int wrapped = plane->wide ? (int16_t)difference : (int8_t)difference;
    return wrapped < 0 ? 2U * (unsigned)-wrapped - 1U : 2U * (unsigned)wrapped;
}

/* Index of the predictor with the smallest sum of residuals. Predictors that need earlier frames
 * than exist are left out. */
static int best_predictor(const struct plane *plane, int count, int frame) {
    int best = 0;
    uint64_t least = UINT64_MAX;
    for (int p = 0; p < PREDICTORS && p <= frame; p++) {
        uint64_t sum = 0;
        for (int i = 0; i < count; i++) sum += residual(plane, &predictors[p], i);
        if (sum < least) {
            least = sum;
            best = p;
        }
    }
    return best;
}

/* Writes a plane and moves its frames on by one. scratch: 2 count + 1 bytes */
static void write_plane(struct stream *stream, struct plane *plane, int count, int frame,
                        unsigned char *scratch) {
    int best = best_predictor(plane, count, frame);
    unsigned char *low = scratch + 1 + (plane->wide ? count : 0);
    scratch[0] = (unsigned char)best;
    for (int i = 0; i < count; i++) {
        unsigned value = residual(plane, &predictors[best], i);
        if (plane->wide) scratch[1 + i] = (unsigned char)(value >> 8);
        low[i] = (unsigned char)value;
    }
    stream_bytes(stream, scratch, (size_t)(low - scratch) + (size_t)count);
    uint16_t *oldest = plane->preceding;
    plane->preceding = plane->previous;
    plane->previous = plane->now;
    plane->now = oldest;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* Points that a frame does not have are zero. */
static void quantise_frame(const struct part *part, struct plane *plane,
                           const struct vtk_frame *frame, const double *filled) {
    for (int p = 0; p < plane_count(part); p++)
        memset(plane[p].now, 0, (size_t)part->count * sizeof *plane[p].now);
    for (int i = 0; i < frame->count; i++) {
        for (int k = 0; k < 3; k++) plane[k].now[i] = replay_code_position(frame, &part->box, i, k);
        for (int c = 0; c < part->channels; c++)
            plane[3 + c].now[i] =
                replay_code_value(part, frame, (enum channel)c, filled, part->most[c], i);
    }
}

static int write_frame(const struct run *run, const struct part *part, struct stream *stream,
                       struct plane *plane, int f) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    int code = part_read_frame(run, part, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    code = replay_check_frame(part, &frame, path);
    if (code == EXIT_GOOD && frame.count != part->frame_points[f])
        code = run_error("%s: the file changed during the replay: expected %d points, found %d",
                         path, part->frame_points[f], frame.count);
    unsigned char *scratch = malloc(2 * (size_t)part->count + 1);
    double *filled = part->fluid ? replay_find_filled(&frame, part->radius) : NULL;
    if (code == EXIT_GOOD && (!scratch || (part->fluid && !filled))) code = report_no_memory();
    if (code == EXIT_GOOD) {
        quantise_frame(part, plane, &frame, filled);
        for (int p = 0; p < plane_count(part); p++)
            write_plane(stream, &plane[p], part->count, f, scratch);
    }
    free(scratch);
    free(filled);
    vtk_frame_free(&frame);
    return code;
}

/* Corner indices, 32 bits, little endian as in the typed arrays of JavaScript. */
static void write_triangles(struct stream *stream, const struct part *part) {
    for (int i = 0; i < 3 * part->triangles; i++) {
        unsigned corner = (unsigned)part->triangle[i];
        unsigned char bytes[4] = {(unsigned char)corner, (unsigned char)(corner >> 8),
                                  (unsigned char)(corner >> 16), (unsigned char)(corner >> 24)};
        stream_bytes(stream, bytes, sizeof bytes);
    }
}

int replay_write_data(const struct run *run, struct stream *stream) {
    struct plane(*plane)[PLANES] = make_planes(run);
    if (!plane) return report_no_memory();
    if (!stream_begin_data(stream)) {
        free_planes(run, plane);
        return report_no_memory();
    }
    int code = EXIT_GOOD;
    for (int p = 0; p < run->parts; p++) write_triangles(stream, &run->part[p]);
    for (int f = 0; f < run->frames && code == EXIT_GOOD && !stream->failed; f++)
        for (int p = 0; p < run->parts && code == EXIT_GOOD; p++)
            if (f < part_frames(run, &run->part[p]))
                code = write_frame(run, &run->part[p], stream, plane[p], f);
    stream_end_data(stream, code == EXIT_GOOD);
    free_planes(run, plane);
    return code;
}
