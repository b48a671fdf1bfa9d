/* Reads all frames of a run for the ranges of their values: bounding boxes, numbers of points,
 * largest values of the channels. */
#include "replay_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RADIUS_SAMPLES = 64 }; /* particles, see estimate_radius() */

static double speed(const struct vtk_frame *frame, int i) {
    const float *v = frame->velocity + 3 * i;
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

double replay_value(const struct part *part, const struct vtk_frame *frame, enum channel channel,
                    int i) {
    if (channel == SPEED) return speed(frame, i);
    if (channel == PRESSURE) return fmax(0.0, frame->pressure[i]);
    if (channel == FILLED) return 1.0;
    double ratio = part->rest_density > 0.0 ? frame->density[i] / part->rest_density : 1.0;
    return fmin(1e9, fmax(0.0, ratio - 1.0));
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Particle radius, m, for a run without report: half the median of the distances from some
 * particles to their nearest neighbours. */
static double estimate_radius(const struct vtk_frame *frame) {
    double nearest[RADIUS_SAMPLES];
    int samples = frame->count < RADIUS_SAMPLES ? frame->count : RADIUS_SAMPLES;
    for (int s = 0; s < samples; s++) {
        int i = (int)((long)s * frame->count / samples);
        nearest[s] = INFINITY;
        for (int j = 0; j < frame->count; j++) {
            double square = 0.0;
            for (int k = 0; k < 3; k++) {
                double d = (double)frame->x[3 * i + k] - frame->x[3 * j + k];
                square += d * d;
            }
            if (j != i) nearest[s] = fmin(nearest[s], sqrt(square));
        }
    }
    qsort(nearest, (size_t)samples, sizeof *nearest, compare_doubles);
    double radius = 0.5 * nearest[samples / 2];
    return isfinite(radius) && radius > 0.0 ? radius : 0.01;
}

/* Takes the mesh from the first frame of a part. */
static int init_part(struct part *part, struct vtk_frame *frame, int frames) {
    part->triangles = frame->triangles;
    part->triangle = frame->triangle;
    part->fluid &= !part->triangles; /* without a report, of a sheet, too */
    part->count = frame->count;
    frame->triangle = NULL;
    if (part->kind == BODY) part->channels = part->triangles ? SPEED + 1 : CHANNELS;
    part->frame_points = calloc((size_t)frames, sizeof *part->frame_points);
    return part->frame_points ? EXIT_GOOD : report_no_memory();
}

int replay_check_frame(const struct part *part, const struct vtk_frame *frame, const char *path) {
    bool other_count = part->triangles && frame->count != part->count;
    if (other_count || frame->triangles != part->triangles)
        return run_error("%s: expected %d points and %d triangles as in the first frame, "
                         "found %d and %d",
                         path, part->count, part->triangles, frame->count, frame->triangles);
    size_t size = 3 * (size_t)frame->triangles * sizeof *frame->triangle;
    if (size && memcmp(frame->triangle, part->triangle, size))
        return run_error("%s: expected the same triangles as in the first frame", path);
    return EXIT_GOOD;
}

/* Checks the number of points of a body against its "count" in the report: equal for a mesh, at
 * most "count" for particles. A skin has points of its own. */
static int check_point_count(const struct run *run, const struct part *part,
                             const struct vtk_frame *frame, const char *path) {
    json_t *count =
        json_object_get(json_array_get(run->body_list, (size_t)(part - run->part)), "count");
    long long most = json_integer_value(count), least = frame->triangles ? most : 0;
    if (!run->report || part->kind != BODY || part->skin.count ||
        (frame->count >= least && frame->count <= most))
        return EXIT_GOOD;
    return run_error("%s: expected %s%lld points (\"count\" in %s), found %d", path,
                     frame->triangles ? "" : "at most ", most, run->source, frame->count);
}

/* Updates the ranges of a part with frame f. */
static int add_frame(const struct run *run, struct part *part, struct vtk_frame *frame, int f,
                     const char *path) {
    int code = f ? replay_check_frame(part, frame, path) : EXIT_GOOD;
    if (code == EXIT_GOOD) code = check_point_count(run, part, frame, path);
    if (code == EXIT_GOOD && !f) code = init_part(part, frame, run->frames);
    if (code != EXIT_GOOD) return code;
    part->frame_points[f] = frame->count;
    if (frame->count > part->count) part->count = frame->count;
    if (frame->density && frame->count && !(part->radius > 0.0))
        part->radius = estimate_radius(frame);
    vtk_frame_extend_box(&part->box, frame);
    for (int c = 0; c < part->channels; c++)
        for (int i = 0; i < frame->count; i++) {
            /* without fmax, with which GCC 12 for arm64 ends with an internal error */
            double value = replay_value(part, frame, (enum channel)c, i);
            if (value > part->most[c]) part->most[c] = value;
        }
    return EXIT_GOOD;
}

static int find_part_ranges(const struct run *run, struct part *part) {
    char path[RUN_PATH];
    part->box = box_empty;
    for (int f = 0; f < part_frames(run, part); f++) {
        struct vtk_frame frame;
        int code = part_read_frame(run, part, f, path, &frame);
        if (code != EXIT_GOOD) return code;
        code = add_frame(run, part, &frame, f, path);
        vtk_frame_free(&frame);
        if (code != EXIT_GOOD) return code;
    }
    return EXIT_GOOD;
}

/* Reads all frames for boxes, counts and largest values. Of a live view, all may be without points.
 */
static int find_ranges(struct run *run) {
    bool seen = false;
    for (int p = 0; p < run->parts; p++) {
        int code = find_part_ranges(run, &run->part[p]);
        if (code != EXIT_GOOD) return code;
        seen |= run->part[p].kind == BODY && run->part[p].count;
        if (!run->part[p].count) run->part[p].box = (struct box){0};
    }
    if (seen || run->live) return EXIT_GOOD;
    return run_error("%s: expected at least one particle in some frame, found none",
                     run->directory);
}

int replay_load(struct run *run) {
    int code = run_open(run);
    if (code == EXIT_GOOD && !run->report)
        fputs("projdyn: warning: no report.json or files.json: particle radii are estimated, "
              "density errors are not shown\n",
              stderr);
    if (code == EXIT_GOOD) code = replay_read_metrics(run);
    return code == EXIT_GOOD ? find_ranges(run) : code;
}
