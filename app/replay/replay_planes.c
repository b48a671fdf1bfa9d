/* Codes the frames of a run for the page: quantisation, prediction, residuals. */
#include "replay_planes.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { PLANES = 5 }; /* x, y, z, speed, density error */

/* One quantised number per point, in the current frame and in the two frames before it. */
struct plane {
    bool wide;                            /* 16 bits, otherwise 8 */
    uint16_t *now, *previous, *preceding; /* count; preceding: two frames before `now` */
};

static uint16_t quantise(double value, double min, double max, double levels) {
    if (!(max > min)) return 0;
    return (uint16_t)lrint(levels * fmin(1.0, fmax(0.0, (value - min) / (max - min))));
}

/* ---- memory ---------------------------------------------------------------------------------- */

static int plane_count(const struct body *body) { return body->has_channels ? PLANES : 3; }

static void free_planes(const struct run *run, struct plane (*plane)[PLANES]) {
    for (int b = 0; b < run->part_count && plane; b++)
        for (int p = 0; p < PLANES; p++) {
            free(plane[b][p].now);
            free(plane[b][p].previous);
            free(plane[b][p].preceding);
        }
    free(plane);
}

/* Planes of every body, zeroed; NULL if memory ran out. */
static struct plane (*make_planes(const struct run *run))[PLANES] {
    struct plane(*planes)[PLANES] = calloc((size_t)run->part_count, sizeof *planes);
    bool good = planes;
    for (int b = 0; b < run->part_count && good; b++) {
        size_t count = (size_t)run->body[b].count + 1; /* + 1: a body may never have had points */
        for (int p = 0; p < plane_count(&run->body[b]) && good; p++) {
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

/* Positions are quantised linearly in the box of the run, speed and density error by their
 * square root: a few large values set the range, and the root keeps small values distinct.
 * Points that a frame does not have are zero. */
static void quantise_frame(const struct run *run, const struct body *body, struct plane *plane,
                           const struct vtk_frame *frame) {
    for (int p = 0; p < plane_count(body); p++)
        memset(plane[p].now, 0, (size_t)body->count * sizeof *plane[p].now);
    for (int i = 0; i < frame->count; i++) {
        for (int k = 0; k < 3; k++)
            plane[k].now[i] =
                quantise(frame->x[3 * i + k], run->box.min[k], run->box.max[k], 65535.0);
        if (!frame->density) continue;
        plane[3].now[i] = quantise(sqrt(replay_speed(frame, i)), 0.0, sqrt(body->max_speed), 255.0);
        plane[4].now[i] =
            quantise(sqrt(replay_density_error(body, frame, i)), 0.0, sqrt(body->max_error), 255.0);
    }
}

/* plane: PLANES of body[b] */
static int write_frame(const struct run *run, struct stream *stream, struct plane *plane, int b,
                       int f) {
    const struct body *body = &run->body[b];
    char path[REPLAY_PATH];
    struct vtk_frame frame;
    int code = replay_read_frame(run, b, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    code = replay_check_frame(body, &frame, path);
    if (code == EXIT_GOOD && frame.count != body->frame_points[f])
        code = replay_error("%s: the file changed during the replay: expected %d points, found %d",
                            path, body->frame_points[f], frame.count);
    unsigned char *scratch = malloc(2 * (size_t)body->count + 1);
    if (code == EXIT_GOOD && !scratch) code = report_no_memory();
    if (code == EXIT_GOOD) {
        quantise_frame(run, body, plane, &frame);
        for (int p = 0; p < plane_count(body); p++)
            write_plane(stream, &plane[p], body->count, f, scratch);
    }
    free(scratch);
    vtk_frame_free(&frame);
    return code;
}

/* ---- data that do not change ----------------------------------------------------------------- */

/* Corner indices, 32 bits, little endian as in the typed arrays of JavaScript. */
static void write_triangles(struct stream *stream, const struct body *body) {
    for (int i = 0; i < 3 * body->triangles; i++) {
        unsigned corner = (unsigned)body->triangle[i];
        unsigned char bytes[4] = {(unsigned char)corner, (unsigned char)(corner >> 8),
                                  (unsigned char)(corner >> 16), (unsigned char)(corner >> 24)};
        stream_bytes(stream, bytes, sizeof bytes);
    }
}

/* Positions of the fixed boundary points, 16 bits, little endian. */
static void write_boundary(struct stream *stream, const struct run *run) {
    const struct box *box = &run->boundary_box;
    for (int i = 0; i < 3 * run->boundary.count; i++) {
        unsigned value = quantise(run->boundary.x[i], box->min[i % 3], box->max[i % 3], 65535.0);
        unsigned char bytes[2] = {(unsigned char)value, (unsigned char)(value >> 8)};
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
    for (int b = 0; b < run->body_count; b++) write_triangles(stream, &run->body[b]);
    write_boundary(stream, run);
    for (int f = 0; f < run->frames && code == EXIT_GOOD && !stream->failed; f++)
        for (int b = 0; b < run->part_count && code == EXIT_GOOD; b++)
            code = write_frame(run, stream, plane[b], b, f);
    stream_end_data(stream, code == EXIT_GOOD);
    free_planes(run, plane);
    return code;
}
