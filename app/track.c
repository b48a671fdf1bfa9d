#include "track.h"
#include "app.h"
#include "frames.h"
#include "metrics.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const track_names[TRACK_MEASURES] = {"density", "cloth",  "front",
                                                 "profile", "energy", "gained"};

enum { AXIS = TRACK_LEVELS + 2 }; /* values of a fluid along an axis */

static int fail(const char *directory, const char *what) {
    fprintf(stderr, "projdyn: %s: %s\n", directory, what);
    return EXIT_FAILED;
}

/* ---- bodies ---------------------------------------------------------------------------------- */

static double diagonal(const struct frame *frame) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double sum = 0.0;
    for (int k = 0; k < 3 * frame->count; k++) {
        low[k % 3] = fmin(low[k % 3], (double)frame->x[k]);
        high[k % 3] = fmax(high[k % 3], (double)frame->x[k]);
    }
    for (int a = 0; a < 3; a++) sum += (high[a] - low[a]) * (high[a] - low[a]);
    return frame->count ? sqrt(sum) : 0.0;
}

static int ascending(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* sorted: count coordinates, ascending; value: AXIS */
static void take_levels(const float *sorted, int count, double *value) {
    for (int k = 0; k < AXIS; k++) {
        double part = k < TRACK_LEVELS ? (k + 0.5) / TRACK_LEVELS : k == TRACK_LEVELS ? 0.05 : 0.95;
        value[k] = count ? (double)sorted[(int)(part * (count - 1) + 0.5)] : 0.0;
    }
}

static bool take_frame(struct track_body *body, const struct frame *frame, int f) {
    double *value = body->value + (size_t)f * (size_t)body->stride;
    if (body->surface) {
        if (frame->count != body->count) return false;
        for (int k = 0; k < body->stride; k++) value[k] = (double)frame->x[k];
        return true;
    }
    float *sorted = malloc((size_t)frame->count * sizeof *sorted + 1);
    for (int a = 0; sorted && a < 3; a++) {
        for (int i = 0; i < frame->count; i++) sorted[i] = frame->x[3 * i + a];
        qsort(sorted, (size_t)frame->count, sizeof *sorted, ascending);
        take_levels(sorted, frame->count, value + a * AXIS);
    }
    free(sorted);
    return sorted;
}

static bool begin_body(struct track_body *body, const struct frame *frame, int frames) {
    body->count = frame->count;
    body->size = diagonal(frame);
    body->stride = body->surface ? 3 * frame->count : 3 * AXIS;
    body->value = calloc((size_t)frames * (size_t)body->stride + 1, sizeof *body->value);
    return body->value;
}

static int read_body(const char *directory, struct track_body *body, int frames) {
    bool good = true;
    int code = EXIT_GOOD;
    for (int f = 0; f < frames && good && code == EXIT_GOOD; f++) {
        struct frame frame = {0};
        char *path;
        if (asprintf(&path, "%s/%s_%06d.vtk", directory, body->name, f) < 0) return EXIT_FAILED;
        code = frame_read(path, &frame);
        free(path);
        if (code == EXIT_GOOD && f == 0) good = begin_body(body, &frame, frames);
        if (code == EXIT_GOOD && good) good = take_frame(body, &frame, f);
        frame_free(&frame);
    }
    return code == EXIT_GOOD && !good ? fail(directory, "its frames do not fit in memory") : code;
}

/* The times of the frames, as listed for a body. */
static int read_times(const char *directory, const char *name, struct track *track) {
    char *path;
    if (asprintf(&path, "%s/%s.vtk.series", directory, name) < 0) return EXIT_FAILED;
    json_t *series = json_load_file(path, 0, NULL), *files = json_object_get(series, "files");
    free(path);
    track->frames = (int)json_array_size(files);
    track->time = calloc((size_t)track->frames + 1, sizeof *track->time);
    for (int f = 0; track->time && f < track->frames; f++)
        track->time[f] =
            json_number_value(json_object_get(json_array_get(files, (size_t)f), "time"));
    json_decref(series);
    return track->frames && track->time ? EXIT_GOOD : fail(directory, "expected frames");
}

static int read_bodies(const char *directory, json_t *report, struct track *track) {
    json_t *bodies = json_object_get(report, "bodies");
    int count = (int)json_array_size(bodies), code = EXIT_GOOD;
    track->body = calloc((size_t)count + 1, sizeof *track->body);
    if (!count || !track->body) return fail(directory, "expected a report.json with bodies");
    for (int b = 0; b < count && code == EXIT_GOOD; b++) {
        json_t *info = json_array_get(bodies, (size_t)b);
        const char *name = json_string_value(json_object_get(info, "name"));
        struct track_body *body = &track->body[track->bodies++];
        body->name = strdup(name ? name : "");
        body->surface = json_integer_value(json_object_get(info, "triangles")) > 0;
        if (!body->name) return EXIT_FAILED;
        if (b == 0) code = read_times(directory, body->name, track);
        if (code == EXIT_GOOD) code = read_body(directory, body, track->frames);
    }
    return code;
}

/* ---- steps ----------------------------------------------------------------------------------- */

static double start_energy(json_t *report) {
    return json_number_value(
        json_object_get(json_object_get(json_object_get(report, "energy"), "start"), "total"));
}

static void take_steps(struct track *track, const struct metrics *m, const int *column,
                       double start) {
    double low = INFINITY, high = -INFINITY, kinetic = 0.0, ms = 0.0;
    for (long r = 0, f = 0; r < m->rows; r++) {
        const double *row = m->value + r * m->columns;
        double energy = row[column[1]] + row[column[2]] + row[column[3]], time = row[column[0]];
        while (f + 1 < track->frames && track->time[f] < time * (1.0 - 1e-7)) f++;
        if (fabs(track->time[f] - time) <= 1e-7 * time) track->energy[f] = energy;
        low = fmin(low, row[column[2]]), high = fmax(high, row[column[2]]);
        kinetic = fmax(kinetic, row[column[1]]);
        track->gained = fmax(track->gained, energy - start);
        track->density += row[column[4]], track->residual += row[column[5]], ms += row[column[6]];
    }
    track->scale = fmax(kinetic, high - low);
    track->density /= (double)m->rows, track->residual /= (double)m->rows;
    track->ms_per_second = ms / m->value[(m->rows - 1) * m->columns + column[0]];
}

static int read_steps(const char *directory, json_t *report, struct track *track) {
    static const char *const names[] = {"time_s",       "kinetic_J",          "potential_J",
                                        "constraint_J", "density_error_mean", "step_residual",
                                        "ms_cpu"};
    int column[7];
    struct metrics m;
    int code = metrics_read(directory, &m);
    if (code != EXIT_GOOD) return code;
    bool good = m.rows > 0;
    for (int k = 0; k < 7; k++) good &= (column[k] = metrics_column(&m, names[k])) >= 0;
    track->energy = calloc((size_t)track->frames, sizeof *track->energy);
    for (int f = 0; track->energy && f < track->frames; f++) track->energy[f] = NAN;
    good &= track->energy != NULL;
    if (good) take_steps(track, &m, column, start_energy(report));
    metrics_free(&m);
    return good ? EXIT_GOOD : fail(directory, "expected the steps of a run in metrics.csv");
}

/* ---- the whole ------------------------------------------------------------------------------- */

int track_read(const char *directory, struct track *track) {
    char *path;
    *track = (struct track){0};
    if (asprintf(&path, "%s/report.json", directory) < 0) return EXIT_FAILED;
    json_t *report = json_load_file(path, 0, NULL);
    free(path);
    int code = read_bodies(directory, report, track);
    if (code == EXIT_GOOD) code = read_steps(directory, report, track);
    json_decref(report);
    if (code != EXIT_GOOD) track_free(track);
    return code;
}

void track_free(struct track *track) {
    for (int b = 0; b < track->bodies; b++) free(track->body[b].name), free(track->body[b].value);
    free(track->body);
    free(track->time);
    free(track->energy);
    *track = (struct track){0};
}

/* ---- comparing ------------------------------------------------------------------------------- */

static double square(double a) { return a * a; }

static double cloth_error(const struct track_body *a, const struct track_body *b, int frames) {
    double sum = 0.0, count = (double)a->count * (frames - 1);
    for (long k = a->stride; k < (long)frames * a->stride; k++)
        sum += square(a->value[k] - b->value[k]);
    return sqrt(sum / fmax(1.0, count)) / b->size;
}

/* Root mean square over the frames of the mean distance of levels, or of the worse front. */
static double fluid_error(const struct track_body *a, const struct track_body *b, int frames,
                          int axis, bool front) {
    double sum = 0.0;
    for (int f = 1; f < frames; f++) {
        const double *x = a->value + (size_t)f * a->stride + axis * AXIS;
        const double *y = b->value + (size_t)f * b->stride + axis * AXIS;
        double moved = 0.0, worst = 0.0;
        for (int k = 0; k < TRACK_LEVELS; k++) moved += fabs(x[k] - y[k]) / TRACK_LEVELS;
        for (int k = TRACK_LEVELS; k < AXIS; k++) worst = fmax(worst, fabs(x[k] - y[k]));
        sum += square(front ? worst : moved);
    }
    return sqrt(sum / fmax(1.0, frames - 1)) / b->size;
}

static double energy_error(const struct track *a, const struct track *b) {
    double sum = 0.0, count = 0.0;
    for (int f = 1; f < a->frames; f++)
        if (isfinite(a->energy[f]) && isfinite(b->energy[f]))
            sum += square(a->energy[f] - b->energy[f]), count++;
    return b->scale > 0.0 ? sqrt(sum / fmax(1.0, count)) / b->scale : 0.0;
}

static double gained_error(const struct track *a, const struct track *b) {
    return b->scale > 0.0 ? fmax(0.0, a->gained - b->gained) / b->scale : 0.0;
}

void track_compare(const struct track *track, const struct track *reference,
                   double error[TRACK_MEASURES]) {
    int frames = track->frames < reference->frames ? track->frames : reference->frames;
    for (int k = 0; k < TRACK_MEASURES; k++) error[k] = 0.0;
    error[TRACK_DENSITY] = track->density;
    error[TRACK_ENERGY] = energy_error(track, reference);
    error[TRACK_GAINED] = gained_error(track, reference);
    for (int k = 0; k < track->bodies; k++) {
        const struct track_body *a = &track->body[k], *b = &reference->body[k];
        if (a->surface) error[TRACK_CLOTH] = fmax(error[TRACK_CLOTH], cloth_error(a, b, frames));
        for (int axis = 0; axis < 3 && !a->surface; axis++) {
            error[TRACK_FRONT] = fmax(error[TRACK_FRONT], fluid_error(a, b, frames, axis, true));
            error[TRACK_PROFILE] =
                fmax(error[TRACK_PROFILE], fluid_error(a, b, frames, axis, false));
        }
    }
}
