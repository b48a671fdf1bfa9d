/* Reads all frames of a run for the ranges of their values: bounding boxes, numbers of points,
 * largest speed and density error. */
#include "replay_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RADIUS_SAMPLES = 64 }; /* particles, see estimate_radius() */

static const struct box empty_box = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

/* Extends a box to include all points of a frame. */
static void extend_box(struct box *box, const struct vtk_frame *frame) {
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
    return fmin(1e9, fmax(0.0, frame->density[i] / body->rest_density - 1.0));
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Particle radius, m, for a run without report.json: half the median of the distances from some
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

/* Takes the mesh from the first frame of a body. */
static int init_body(struct body *body, struct vtk_frame *frame, int frames) {
    body->triangles = frame->triangles;
    body->triangle = frame->triangle;
    body->count = frame->count;
    frame->triangle = NULL;
    body->has_channels = frame->density || !frame->count;
    body->frame_points = calloc((size_t)frames, sizeof *body->frame_points);
    return body->frame_points ? EXIT_GOOD : report_no_memory();
}

int replay_check_frame(const struct body *body, const struct vtk_frame *frame, const char *path) {
    bool other_count = body->triangles && frame->count != body->count;
    if (other_count || frame->triangles != body->triangles)
        return replay_error("%s: expected %d points and %d triangles as in the first frame, "
                            "found %d and %d",
                            path, body->count, body->triangles, frame->count, frame->triangles);
    size_t size = 3 * (size_t)frame->triangles * sizeof *frame->triangle;
    if (size && memcmp(frame->triangle, body->triangle, size))
        return replay_error("%s: expected the same triangles as in the first frame", path);
    return EXIT_GOOD;
}

/* Checks the number of points against "count" in report.json: equal for a mesh, at most "count"
 * for particles. */
static int check_point_count(const struct run *run, int b, const struct vtk_frame *frame,
                             const char *path) {
    json_t *count = json_object_get(json_array_get(run->body_list, (size_t)b), "count");
    long long most = json_integer_value(count), least = frame->triangles ? most : 0;
    if (!run->report || b == run->body_count || (frame->count >= least && frame->count <= most))
        return EXIT_GOOD;
    return replay_error("%s: expected %s%lld points (\"count\" in report.json), found %d", path,
                        frame->triangles ? "" : "at most ", most, frame->count);
}

/* Updates the ranges with frame f of body[b]. */
static int add_frame(struct run *run, int b, struct vtk_frame *frame, int f, const char *path) {
    struct body *body = &run->body[b];
    int code = f ? replay_check_frame(body, frame, path) : EXIT_GOOD;
    if (code == EXIT_GOOD) code = check_point_count(run, b, frame, path);
    if (code == EXIT_GOOD && !f) code = init_body(body, frame, run->frames);
    if (code != EXIT_GOOD) return code;
    body->frame_points[f] = frame->count;
    if (frame->count > body->count) body->count = frame->count;
    if (frame->density && frame->count && !(body->radius > 0.0))
        body->radius = estimate_radius(frame);
    extend_box(&run->box, frame);
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
    if (!replay_path(path, run, name, "")) return replay_error("%s: the path is too long", name);
    return b < run->body_count ? vtk_frame_read(path, frame) : vtk_frame_read_boundary(path, frame);
}

int replay_find_ranges(struct run *run) {
    char path[REPLAY_PATH];
    int code = EXIT_GOOD;
    run->box = run->boundary_box = empty_box;
    for (int f = 0; f < run->frames; f++)
        for (int b = 0; b < run->part_count; b++) {
            struct vtk_frame frame;
            code = replay_read_frame(run, b, f, path, &frame);
            if (code != EXIT_GOOD) return code;
            code = add_frame(run, b, &frame, f, path);
            vtk_frame_free(&frame);
            if (code != EXIT_GOOD) return code;
        }
    if (run->box.min[0] > run->box.max[0])
        return replay_error("%s: expected at least one particle in some frame, found none",
                            run->directory);
    if (replay_path(path, run, "boundary", ".vtk") && access(path, F_OK) == 0)
        code = vtk_frame_read_boundary(path, &run->boundary);
    extend_box(&run->boundary_box, &run->boundary);
    return code;
}
