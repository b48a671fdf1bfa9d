/* Reads the frames of a run for what they span: boxes, counts, the largest speed and error. */
#include "replay_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SAMPLES = 64 };

static const struct box nothing = {{INFINITY, INFINITY, INFINITY},
                                   {-INFINITY, -INFINITY, -INFINITY}};

static void grow_box(struct box *box, const struct vtk_frame *frame) {
    for (int i = 0; i < frame->count; i++)
        for (int k = 0; k < 3; k++) {
            box->min[k] = fmin(box->min[k], frame->x[3 * i + k]);
            box->max[k] = fmax(box->max[k], frame->x[3 * i + k]);
        }
}

double replay_speed(const struct vtk_frame *frame, int i) {
    const float *v = frame->velocity + 3 * i;
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

double replay_density_error(const struct body *body, const struct vtk_frame *frame, int i) {
    if (body->rest_density <= 0.0) return 0.0;
    return fmin(1e9, fmax(0.0, frame->density[i] / body->rest_density - 1.0)); /* finite */
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Without a report: half the median distance of a few particles to their nearest. */
static double guess_radius(const struct vtk_frame *frame) {
    double nearest[SAMPLES];
    int samples = frame->count < SAMPLES ? frame->count : SAMPLES;
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
    qsort(nearest, (size_t)samples, sizeof *nearest, by_size);
    double radius = 0.5 * nearest[samples / 2];
    return isfinite(radius) && radius > 0.0 ? radius : 0.01;
}

static int begin_body(struct body *body, struct vtk_frame *frame, int frames) {
    body->triangles = frame->triangles;
    body->triangle = frame->triangle;
    body->count = frame->count;
    frame->triangle = NULL;
    body->shaded = frame->density || !frame->count;
    body->points = calloc((size_t)frames, sizeof *body->points);
    return body->points ? EXIT_GOOD : replay_no_memory();
}

int replay_check_frame(const struct body *body, const struct vtk_frame *frame, const char *path) {
    bool other_count = body->triangles && frame->count != body->count;
    if (other_count || frame->triangles != body->triangles)
        return replay_fail("%s: expected %d points and %d triangles as in the first frame, "
                           "found %d and %d",
                           path, body->count, body->triangles, frame->count, frame->triangles);
    size_t size = 3 * (size_t)frame->triangles * sizeof *frame->triangle;
    if (size && memcmp(frame->triangle, body->triangle, size))
        return replay_fail("%s: expected the same triangles as in the first frame", path);
    return EXIT_GOOD;
}

static int check_report(const struct run *run, int b, const struct vtk_frame *frame,
                        const char *path) {
    json_t *count = json_object_get(json_array_get(run->bodies, (size_t)b), "count");
    long long most = json_integer_value(count), least = frame->triangles ? most : 0;
    if (!run->report || b == run->count || (frame->count >= least && frame->count <= most))
        return EXIT_GOOD;
    return replay_fail("%s: expected %s%lld points as report.json says, found %d", path,
                       frame->triangles ? "" : "at most ", most, frame->count);
}

static int survey_frame(struct run *run, int b, struct vtk_frame *frame, int f, const char *path) {
    struct body *body = &run->body[b];
    int code = f ? replay_check_frame(body, frame, path) : EXIT_GOOD;
    if (code == EXIT_GOOD) code = check_report(run, b, frame, path);
    if (code == EXIT_GOOD && !f) code = begin_body(body, frame, run->frames);
    if (code != EXIT_GOOD) return code;
    body->points[f] = frame->count;
    if (frame->count > body->count) body->count = frame->count;
    if (frame->density && frame->count && !(body->radius > 0.0)) body->radius = guess_radius(frame);
    grow_box(&run->box, frame);
    for (int i = 0; i < frame->count && frame->density; i++) {
        body->max_speed = fmax(body->max_speed, replay_speed(frame, i));
        body->max_error = fmax(body->max_error, replay_density_error(body, frame, i));
    }
    return EXIT_GOOD;
}

int replay_read_frame(const struct run *run, int b, int f, char path[REPLAY_PATH],
                      struct vtk_frame *frame) {
    json_t *entry = json_array_get(run->body[b].files, (size_t)f);
    const char *name = json_string_value(json_object_get(entry, "name"));
    if (!replay_path(path, run, name, "")) return replay_fail("%s: the path is too long", name);
    return b < run->count ? vtk_frame_read(path, frame) : vtk_frame_read_boundary(path, frame);
}

int replay_survey(struct run *run) {
    char path[REPLAY_PATH];
    int code = EXIT_GOOD;
    run->box = run->boundary_box = nothing;
    for (int f = 0; f < run->frames; f++)
        for (int b = 0; b < run->parts; b++) {
            struct vtk_frame frame;
            code = replay_read_frame(run, b, f, path, &frame);
            if (code != EXIT_GOOD) return code;
            code = survey_frame(run, b, &frame, f, path);
            vtk_frame_free(&frame);
            if (code != EXIT_GOOD) return code;
        }
    if (run->box.min[0] > run->box.max[0])
        return replay_fail("%s: expected at least one particle in some frame, found none",
                           run->directory);
    if (replay_path(path, run, "boundary", ".vtk") && access(path, F_OK) == 0)
        code = vtk_frame_read_boundary(path, &run->boundary);
    grow_box(&run->boundary_box, &run->boundary);
    return code;
}
