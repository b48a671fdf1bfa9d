/* Reads a finished run for comparison and computes its errors against a reference. */
#include "run_metrics.h"
#include "app.h"
#include "metrics_csv.h"
#include "projdyn/vec3.h"
#include "vtk_frame.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const run_metric_names[RUN_METRICS_COUNT] = {"density", "cloth",  "front",
                                                         "profile", "energy", "gained"};

enum { AXIS_VALUES = RUN_METRICS_LEVELS + 2 }; /* values of a fluid per axis and frame */

static int fail(const char *directory, const char *what) {
    fprintf(stderr, "projdyn: %s: %s\n", directory, what);
    return EXIT_FAILED;
}

/* ---- bodies ---------------------------------------------------------------------------------- */

/* Diagonal of the bounding box, m; 0 for an empty frame. */
static double box_diagonal(const struct vtk_frame *frame) {
    struct box box = box_empty;
    vtk_frame_extend_box(&box, frame);
    return frame->count ? vec3_distance(box.min, box.max) : 0.0;
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Quantiles of a coordinate. sorted: count, ascending; value: AXIS_VALUES (body_metrics) */
static void compute_quantiles(const float *sorted, int count, double *value) {
    for (int k = 0; k < AXIS_VALUES; k++) {
        double part = k < RUN_METRICS_LEVELS    ? (k + 0.5) / RUN_METRICS_LEVELS
                      : k == RUN_METRICS_LEVELS ? 0.05
                                                : 0.95;
        value[k] = count ? (double)sorted[(int)(part * (count - 1) + 0.5)] : 0.0;
    }
}

/* Stores frame f of a body; false if its vertices changed in number or memory ran out. */
static bool add_frame(struct body_metrics *body, const struct vtk_frame *frame, int f) {
    double *value = body->value + (size_t)f * (size_t)body->stride;
    if (body->surface) {
        if (frame->count != body->count) return false;
        for (int k = 0; k < body->stride; k++) value[k] = (double)frame->x[k];
        return true;
    }
    float *sorted = malloc((size_t)frame->count * sizeof *sorted + 1);
    for (int a = 0; sorted && a < 3; a++) {
        for (int i = 0; i < frame->count; i++) sorted[i] = frame->x[3 * i + a];
        qsort(sorted, (size_t)frame->count, sizeof *sorted, compare_floats);
        compute_quantiles(sorted, frame->count, value + a * AXIS_VALUES);
    }
    free(sorted);
    return sorted;
}

/* Sizes and allocates a body by its first frame. */
static bool init_body(struct body_metrics *body, const struct vtk_frame *frame, int frames) {
    body->count = frame->count;
    body->stride = body->surface ? 3 * frame->count : 3 * AXIS_VALUES;
    body->value = calloc((size_t)frames * (size_t)body->stride + 1, sizeof *body->value);
    return body->value;
}

/* Reads all frames of a body. */
static int read_body(const char *directory, struct body_metrics *body, int frames) {
    bool good = true;
    int code = EXIT_GOOD;
    for (int f = 0; f < frames && good && code == EXIT_GOOD; f++) {
        struct vtk_frame frame = {0};
        char *path;
        if (asprintf(&path, "%s/%s_%06d.vtk", directory, body->name, f) < 0)
            return report_no_memory();
        code = vtk_frame_read(path, &frame);
        free(path);
        if (code == EXIT_GOOD && f == 0) good = init_body(body, &frame, frames);
        if (code == EXIT_GOOD && good) good = add_frame(body, &frame, f);
        if (body->size == 0.0) body->size = box_diagonal(&frame);
        vtk_frame_free(&frame);
    }
    return code == EXIT_GOOD && !good
               ? fail(directory, "its frames differ in their number of vertices, or memory ran out")
               : code;
}

/* Times of the frames, from the .vtk.series file of a body. */
static int read_times(const char *directory, const char *name, struct run_metrics *metrics) {
    char *path;
    if (asprintf(&path, "%s/%s.vtk.series", directory, name) < 0) return report_no_memory();
    json_t *series = json_load_file(path, 0, NULL), *files = json_object_get(series, "files");
    free(path);
    metrics->frames = (int)json_array_size(files);
    metrics->time = calloc((size_t)metrics->frames + 1, sizeof *metrics->time);
    for (int f = 0; metrics->time && f < metrics->frames; f++)
        metrics->time[f] =
            json_number_value(json_object_get(json_array_get(files, (size_t)f), "time"));
    json_decref(series);
    return metrics->frames && metrics->time
               ? EXIT_GOOD
               : fail(directory, "expected a .vtk.series file with frames");
}

static int read_bodies(const char *directory, json_t *report, struct run_metrics *metrics) {
    json_t *bodies = json_object_get(report, "bodies");
    int count = (int)json_array_size(bodies), code = EXIT_GOOD;
    metrics->body = calloc((size_t)count + 1, sizeof *metrics->body);
    if (!count || !metrics->body) return fail(directory, "expected a report.json with bodies");
    for (int b = 0; b < count && code == EXIT_GOOD; b++) {
        json_t *info = json_array_get(bodies, (size_t)b);
        const char *name = json_string_value(json_object_get(info, "name"));
        struct body_metrics *body = &metrics->body[metrics->bodies++];
        body->name = strdup(name ? name : "");
        body->surface = json_integer_value(json_object_get(info, "triangles")) > 0;
        if (!body->name) return report_no_memory();
        if (b == 0) code = read_times(directory, body->name, metrics);
        if (code == EXIT_GOOD) code = read_body(directory, body, metrics->frames);
    }
    return code;
}

/* ---- steps ----------------------------------------------------------------------------------- */

static double start_energy(json_t *report) {
    return json_number_value(
        json_object_get(json_object_get(json_object_get(report, "energy"), "start"), "total"));
}

/* Columns of metrics.csv that are evaluated; the order is that of step_columns[]. */
enum { TIME, KINETIC, POTENTIAL, CONSTRAINT, DENSITY, RESIDUAL, MS_CPU, STEP_COLUMNS };
static const char *const step_columns[STEP_COLUMNS] = {
    "time_s",        "kinetic_J", "potential_J", "constraint_J", "density_error_mean",
    "step_residual", "ms_cpu"};

/* column: STEP_COLUMNS indices into the rows of m; start: total energy at the start, J */
static void evaluate_steps(struct run_metrics *metrics, const struct metrics_csv *m,
                           const int *column, double start) {
    double low = INFINITY, high = -INFINITY, kinetic = 0.0, ms = 0.0;
    for (long r = 0, f = 0; r < m->rows; r++) {
        const double *row = m->value + r * m->columns;
        double time = row[column[TIME]];
        double energy = row[column[KINETIC]] + row[column[POTENTIAL]] + row[column[CONSTRAINT]];
        while (f + 1 < metrics->frames && metrics->time[f] < time * (1.0 - 1e-7)) f++;
        if (fabs(metrics->time[f] - time) <= 1e-7 * time) metrics->energy[f] = energy;
        low = fmin(low, row[column[POTENTIAL]]), high = fmax(high, row[column[POTENTIAL]]);
        kinetic = fmax(kinetic, row[column[KINETIC]]);
        metrics->gained = fmax(metrics->gained, energy - start);
        metrics->density += row[column[DENSITY]], metrics->residual += row[column[RESIDUAL]];
        ms += row[column[MS_CPU]];
    }
    metrics->scale = fmax(kinetic, high - low);
    metrics->density /= (double)m->rows, metrics->residual /= (double)m->rows;
    metrics->ms_per_second = ms / m->value[(m->rows - 1) * m->columns + column[TIME]];
}

/* Reads energies, errors and times of the steps from metrics.csv. */
static int read_steps(const char *directory, json_t *report, struct run_metrics *metrics) {
    int column[STEP_COLUMNS];
    struct metrics_csv m;
    int code = metrics_csv_read(directory, "metrics.csv", &m);
    if (code != EXIT_GOOD) return code;
    bool good = m.rows > 0;
    for (int k = 0; k < STEP_COLUMNS; k++)
        good &= (column[k] = metrics_csv_column(&m, step_columns[k])) >= 0;
    metrics->energy = calloc((size_t)metrics->frames, sizeof *metrics->energy);
    for (int f = 0; metrics->energy && f < metrics->frames; f++) metrics->energy[f] = NAN;
    good &= metrics->energy != NULL;
    if (good) evaluate_steps(metrics, &m, column, start_energy(report));
    metrics_csv_free(&m);
    return good ? EXIT_GOOD
                : fail(directory, "expected time steps and their columns in metrics.csv");
}

/* ---- the run --------------------------------------------------------------------------------- */

int run_metrics_read(const char *directory, struct run_metrics *metrics) {
    char *path;
    *metrics = (struct run_metrics){0};
    if (asprintf(&path, "%s/report.json", directory) < 0) return report_no_memory();
    json_t *report = json_load_file(path, 0, NULL);
    free(path);
    int code = read_bodies(directory, report, metrics);
    if (code == EXIT_GOOD) code = read_steps(directory, report, metrics);
    json_decref(report);
    if (code != EXIT_GOOD) run_metrics_free(metrics);
    return code;
}

void run_metrics_free(struct run_metrics *metrics) {
    for (int b = 0; b < metrics->bodies; b++)
        free(metrics->body[b].name), free(metrics->body[b].value);
    free(metrics->body);
    free(metrics->time);
    free(metrics->energy);
    *metrics = (struct run_metrics){0};
}

/* ---- comparison ------------------------------------------------------------------------------ */

static double square(double a) { return a * a; }

static double cloth_error(const struct body_metrics *a, const struct body_metrics *b, int frames) {
    double sum = 0.0, count = (double)a->count * (frames - 1);
    for (long k = a->stride; k < (long)frames * a->stride; k++)
        sum += square(a->value[k] - b->value[k]);
    return sqrt(sum / fmax(1.0, count)) / b->size;
}

/* Error `front` or `profile` along one axis (run_metrics_compare()). */
static double fluid_error(const struct body_metrics *a, const struct body_metrics *b, int frames,
                          int axis, bool front) {
    double sum = 0.0;
    for (int f = 1; f < frames; f++) {
        const double *x = a->value + (size_t)f * a->stride + axis * AXIS_VALUES;
        const double *y = b->value + (size_t)f * b->stride + axis * AXIS_VALUES;
        double mean = 0.0, max = 0.0;
        for (int k = 0; k < RUN_METRICS_LEVELS; k++) mean += fabs(x[k] - y[k]) / RUN_METRICS_LEVELS;
        for (int k = RUN_METRICS_LEVELS; k < AXIS_VALUES; k++) max = fmax(max, fabs(x[k] - y[k]));
        sum += square(front ? max : mean);
    }
    return sqrt(sum / fmax(1.0, frames - 1)) / b->size;
}

static double energy_error(const struct run_metrics *a, const struct run_metrics *b) {
    double sum = 0.0, count = 0.0;
    for (int f = 1; f < a->frames; f++)
        if (isfinite(a->energy[f]) && isfinite(b->energy[f]))
            sum += square(a->energy[f] - b->energy[f]), count++;
    return b->scale > 0.0 ? sqrt(sum / fmax(1.0, count)) / b->scale : 0.0;
}

static double gained_error(const struct run_metrics *a, const struct run_metrics *b) {
    return b->scale > 0.0 ? fmax(0.0, a->gained - b->gained) / b->scale : 0.0;
}

void run_metrics_compare(const struct run_metrics *metrics, const struct run_metrics *reference,
                         double error[RUN_METRICS_COUNT]) {
    int frames = metrics->frames < reference->frames ? metrics->frames : reference->frames;
    for (int k = 0; k < RUN_METRICS_COUNT; k++) error[k] = 0.0;
    error[RUN_METRIC_DENSITY] = metrics->density;
    error[RUN_METRIC_ENERGY] = energy_error(metrics, reference);
    error[RUN_METRIC_GAINED] = gained_error(metrics, reference);
    for (int k = 0; k < metrics->bodies; k++) {
        const struct body_metrics *a = &metrics->body[k], *b = &reference->body[k];
        if (a->surface)
            error[RUN_METRIC_CLOTH] = fmax(error[RUN_METRIC_CLOTH], cloth_error(a, b, frames));
        for (int axis = 0; axis < 3 && !a->surface; axis++) {
            error[RUN_METRIC_FRONT] =
                fmax(error[RUN_METRIC_FRONT], fluid_error(a, b, frames, axis, true));
            error[RUN_METRIC_PROFILE] =
                fmax(error[RUN_METRIC_PROFILE], fluid_error(a, b, frames, axis, false));
        }
    }
}
