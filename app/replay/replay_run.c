/* Finds bodies and frames in the output directory of a run. */
#include "replay_run.h"
#include "read_file.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- messages and paths ---------------------------------------------------------------------- */

int replay_error(const char *format, ...) {
    va_list args;
    fputs("projdyn: ", stderr);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
    return EXIT_BAD_INPUT;
}

bool replay_path(char path[REPLAY_PATH], const struct run *run, const char *name,
                 const char *ending) {
    int length = snprintf(path, REPLAY_PATH, "%s/%s%s", run->directory, name, ending);
    return length >= 0 && length < REPLAY_PATH;
}

static bool is_plain_name(const char *name) { return name && *name && !strchr(name, '/'); }

/* Reads a file that must hold one JSON object. */
static int load_json(const char *path, json_t **out) {
    char *text;
    size_t size;
    json_error_t error;
    int code = read_file(path, &text, &size);
    if (code != EXIT_GOOD) return code;
    *out = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    free(text);
    if (!*out)
        return replay_error("%s:%d:%d: expected JSON: %s", path, error.line, error.column,
                            error.text);
    if (!json_is_object(*out)) return replay_error("%s: expected a JSON object", path);
    return EXIT_GOOD;
}

/* ---- the bodies ------------------------------------------------------------------------------ */

static int compare_names(const struct dirent **a, const struct dirent **b) {
    return strcmp((*a)->d_name, (*b)->d_name);
}

/* Whether a directory entry is NAME.vtk.series of a body. */
static int is_series(const struct dirent *entry) {
    static const char ending[] = ".vtk.series";
    size_t length = strlen(entry->d_name), tail = sizeof ending - 1;
    return length > tail && !strcmp(entry->d_name + length - tail, ending) &&
           strcmp(entry->d_name, "boundary.vtk.series") != 0;
}

/* Bodies of a run without report.json (a killed run): each .vtk.series file but that of the
 * boundary. */
static int find_series(struct run *run) {
    struct dirent **entry;
    int count = scandir(run->directory, &entry, is_series, compare_names);
    if (count < 0)
        return replay_error("%s: cannot read the directory: %s", run->directory, strerror(errno));
    run->body_list = json_array();
    for (int i = 0; i < count; i++) {
        int length = (int)(strlen(entry[i]->d_name) - strlen(".vtk.series"));
        json_array_append_new(run->body_list,
                              json_pack("{s:s%}", "name", entry[i]->d_name, (size_t)length));
        free(entry[i]);
    }
    free(entry);
    return EXIT_GOOD;
}

/* Sets run->report and run->body_list from report.json or, if it is missing, the file names. */
static int find_bodies(struct run *run) {
    char path[REPLAY_PATH];
    if (!replay_path(path, run, "report", ".json"))
        return replay_error("%s: the path is too long", run->directory);
    bool has_report = access(path, F_OK) == 0;
    int code = has_report ? load_json(path, &run->report) : find_series(run);
    if (code != EXIT_GOOD) return code;
    if (has_report) run->body_list = json_incref(json_object_get(run->report, "bodies"));
    if (json_array_size(run->body_list)) return EXIT_GOOD;
    if (has_report) return replay_error("%s: expected an array \"bodies\" with a body in it", path);
    return replay_error(
        "%s: expected the output of a run (report.json or NAME.vtk.series), found neither",
        run->directory);
}

/* Checks that the frames are file names without a directory, with increasing times. */
static int check_series(const struct body *body, const char *path) {
    double last = -INFINITY;
    if (!json_is_array(body->files)) return replay_error("%s: expected an array \"files\"", path);
    for (size_t f = 0; f < json_array_size(body->files); f++) {
        json_t *entry = json_array_get(body->files, f), *time = json_object_get(entry, "time");
        if (!is_plain_name(json_string_value(json_object_get(entry, "name"))))
            return replay_error(
                "%s: files[%zu]: expected the \"name\" of a file in the same directory", path, f);
        if (!json_is_number(time) || json_number_value(time) <= last)
            return replay_error(
                "%s: files[%zu]: expected a \"time\" greater than that of the previous frame", path,
                f);
        last = json_number_value(time);
    }
    return EXIT_GOOD;
}

/* A non-negative number of body b in report.json; 0 if it is missing or null. */
static int read_body_number(const struct run *run, int b, const char *key, double *out) {
    json_t *value = json_object_get(json_array_get(run->body_list, (size_t)b), key);
    *out = json_number_value(value);
    if (!value || json_is_null(value)) return EXIT_GOOD;
    if (json_is_number(value) && *out >= 0.0 && *out < 1e9) return EXIT_GOOD;
    return replay_error("%s/report.json: bodies[%d].%s: expected a number from 0 to 1e9",
                        run->directory, b, key);
}

/* Reads name, list of frames, radius and rest density of body b. */
static int open_body(struct run *run, int b) {
    struct body *body = &run->body[b];
    char path[REPLAY_PATH];
    json_t *entry = json_array_get(run->body_list, (size_t)b);
    body->name = json_string_value(json_object_get(entry, "name"));
    if (!is_plain_name(body->name) || !replay_path(path, run, body->name, ".vtk.series"))
        return replay_error("%s/report.json: bodies[%d]: expected a \"name\" without '/'",
                            run->directory, b);
    int code = load_json(path, &body->series);
    body->files = json_object_get(body->series, "files");
    if (code == EXIT_GOOD) code = check_series(body, path);
    if (code == EXIT_GOOD) code = read_body_number(run, b, "radius_m", &body->radius);
    if (code == EXIT_GOOD) code = read_body_number(run, b, "rest_density", &body->rest_density);
    return code;
}

/* Boundary points on moving solids: a part with points alone, after the bodies. */
static int open_moving_boundary(struct run *run) {
    struct body *moving = &run->body[run->body_count];
    char path[REPLAY_PATH];
    if (!replay_path(path, run, "boundary", ".vtk.series") || access(path, F_OK)) return EXIT_GOOD;
    run->part_count++;
    moving->name = "boundary";
    int code = load_json(path, &moving->series);
    moving->files = json_object_get(moving->series, "files");
    return code == EXIT_GOOD ? check_series(moving, path) : code;
}

double replay_time(const struct body *body, int f) {
    return json_number_value(json_object_get(json_array_get(body->files, (size_t)f), "time"));
}

/* Sets run->frames to the number of frames that all parts have (a killed run may lack the last
 * frame of some) and checks that their times agree. */
static int count_frames(struct run *run) {
    size_t frames = json_array_size(run->body[0].files);
    for (int b = 1; b < run->part_count; b++) {
        size_t more = json_array_size(run->body[b].files);
        if (more < frames) frames = more;
    }
    if (!frames) return replay_error("%s: expected at least one frame, found none", run->directory);
    run->frames = (int)frames;
    for (int b = 1; b < run->part_count; b++)
        for (int f = 0; f < run->frames; f++) {
            double time = replay_time(&run->body[b], f), expected = replay_time(&run->body[0], f);
            if (fabs(time - expected) > 1e-9 * (1.0 + fabs(expected)))
                return replay_error(
                    "%s/%s.vtk.series: files[%d]: expected the time %.9g of \"%s\", "
                    "found %.9g",
                    run->directory, run->body[b].name, f, expected, run->body[0].name, time);
        }
    return EXIT_GOOD;
}

int replay_open(struct run *run) {
    int code = find_bodies(run);
    if (code != EXIT_GOOD) return code;
    size_t count = json_array_size(run->body_list);
    run->body = calloc(count + 1, sizeof *run->body);
    if (!run->body) return report_no_memory();
    run->body_count = run->part_count = (int)count;
    for (int b = 0; b < run->body_count && code == EXIT_GOOD; b++) code = open_body(run, b);
    if (code == EXIT_GOOD) code = open_moving_boundary(run);
    return code == EXIT_GOOD ? count_frames(run) : code;
}

void replay_close(struct run *run) {
    for (int b = 0; b < run->part_count; b++) {
        struct body *body = &run->body[b];
        json_decref(body->series);
        free(body->triangle);
        free(body->frame_points);
    }
    free(run->body);
    vtk_frame_free(&run->boundary);
    json_decref(run->metrics);
    json_decref(run->body_list);
    json_decref(run->report);
}
