/* Finds parts and frames in the output directory of a run. */
#include "run_directory.h"

#include "read_file.h"
#include "skin.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- messages and paths ---------------------------------------------------------------------- */

int run_error(const char *format, ...) {
    va_list args;
    fputs("projdyn: ", stderr);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
    return EXIT_BAD_INPUT;
}

void run_path(char path[RUN_PATH], const struct run *run, const char *format, ...) {
    va_list args;
    int length = snprintf(path, RUN_PATH, "%s/", run->directory);
    va_start(args, format);
    if (length < RUN_PATH) vsnprintf(path + length, RUN_PATH - (size_t)length, format, args);
    va_end(args);
}

static bool is_plain_name(const char *name) { return name && *name && !strchr(name, '/'); }

/* The name of a body or a solid has at most PART_NAME bytes. */
static bool is_part_name(const char *name) {
    return is_plain_name(name) && strlen(name) <= PART_NAME;
}

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
        return run_error("%s:%d:%d: expected JSON: %s", path, error.line, error.column, error.text);
    if (!json_is_object(*out)) return run_error("%s: expected a JSON object", path);
    return EXIT_GOOD;
}

/* ---- names and files ------------------------------------------------------------------------- */

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

/* Bodies of a directory that has neither report.json nor files.json: each .vtk.series file but that
 * of the boundary. Solids are left out. */
static int find_series(struct run *run) {
    struct dirent **entry;
    int count = scandir(run->directory, &entry, is_series, compare_names);
    if (count < 0 && errno == ENOTDIR)
        return run_error(
            "%s: expected the directory of a run, found a file; 'projdyn run NAME.json' "
            "writes to out/NAME",
            run->directory);
    if (count < 0)
        return run_error("%s: cannot read the directory: %s", run->directory, strerror(errno));
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

/* Loads a file of the directory, if it is there; else *out stays NULL. */
static int load_member(struct run *run, const char *name, json_t **out) {
    char path[RUN_PATH];
    run_path(path, run, "%s", name);
    if (access(path, F_OK)) return EXIT_GOOD;
    run->source = name;
    return load_json(path, out);
}

/* Sets run->report from report.json or, of a run that has not ended or was killed, from files.json,
 * which is there from the start. */
static int find_report(struct run *run) {
    json_t *list = NULL;
    int code = load_member(run, "report.json", &run->report);
    if (code != EXIT_GOOD || run->report) return code;
    code = load_member(run, "files.json", &list);
    if (code == EXIT_GOOD) run->report = json_incref(json_object_get(list, "scene"));
    json_decref(list);
    return code;
}

/* Sets run->report and, from it or the names of files, run->body_list. */
static int find_bodies(struct run *run) {
    int code = find_report(run);
    if (code == EXIT_GOOD && !run->report) code = find_series(run);
    if (code != EXIT_GOOD) return code;
    if (run->report) run->body_list = json_incref(json_object_get(run->report, "bodies"));
    if (json_array_size(run->body_list)) return EXIT_GOOD;
    if (run->report)
        return run_error("%s/%s: expected an array \"bodies\" with a body in it", run->directory,
                         run->source);
    return run_error(
        "%s: expected the output of a run (report.json or NAME.vtk.series), found neither",
        run->directory);
}

/* Checks that the frames are file names without a directory, with increasing times. */
static int check_series(const struct part *part, const char *path) {
    double last = -INFINITY;
    if (!json_is_array(part->files)) return run_error("%s: expected an array \"files\"", path);
    for (size_t f = 0; f < json_array_size(part->files); f++) {
        json_t *entry = json_array_get(part->files, f), *time = json_object_get(entry, "time");
        if (!is_plain_name(json_string_value(json_object_get(entry, "name"))))
            return run_error(
                "%s: files[%zu]: expected the \"name\" of a file in the same directory", path, f);
        if (!json_is_number(time) || json_number_value(time) <= last)
            return run_error(
                "%s: files[%zu]: expected a \"time\" greater than that of the previous frame", path,
                f);
        last = json_number_value(time);
    }
    return EXIT_GOOD;
}

int part_open_series(const struct run *run, struct part *part) {
    char path[RUN_PATH], name[RUN_PATH];
    run_path(path, run, "%s%s.vtk.series", part->folder, part->name);
    snprintf(name, sizeof name, "%s.vtk", part->name);
    int code = EXIT_GOOD;
    if (part->rest)
        part->series = json_pack("{s:[{s:s, s:f}]}", "files", "name", name, "time", 0.0);
    else code = load_json(path, &part->series);
    part->files = json_object_get(part->series, "files");
    return code == EXIT_GOOD ? check_series(part, path) : code;
}

/* ---- the parts ------------------------------------------------------------------------------- */

/* A non-negative number of body b in report.json; 0 if it is missing or null. */
static int read_body_number(const struct run *run, int b, const char *key, double *out) {
    json_t *value = json_object_get(json_array_get(run->body_list, (size_t)b), key);
    *out = json_number_value(value);
    if (!value || json_is_null(value)) return EXIT_GOOD;
    if (json_is_number(value) && *out >= 0.0 && *out < 1e9) return EXIT_GOOD;
    return run_error("%s/%s: bodies[%d].%s: expected a number from 0 to 1e9", run->directory,
                     run->source, b, key);
}

/* Reads the "color" of an entry of report.json, which the page takes as it is; NULL without one. */
static int read_color(const struct run *run, const struct part *part, const json_t *entry,
                      const char **out) {
    json_t *value = json_object_get(entry, "color");
    const char *color = json_string_value(value);
    *out = color;
    if (!value || (color && color[0] == '#' && strlen(color) == 7 &&
                   strspn(color + 1, "0123456789abcdefABCDEF") == 6))
        return EXIT_GOOD;
    return run_error("%s/%s: \"%s\": expected a \"color\" \"#rrggbb\"", run->directory, run->source,
                     part->name);
}

/* Whether the report has the constraint "fluid" on a body. */
static bool is_fluid(const struct run *run, const char *body) {
    json_t *list = json_object_get(run->report, "parameters"), *one;
    size_t k;
    json_array_foreach(list, k, one) {
        const char *found = json_string_value(json_object_get(one, "type"));
        const char *on = json_string_value(json_object_get(one, "body"));
        if (found && on && !strcmp(found, "fluid") && !strcmp(on, body)) return true;
    }
    return false;
}

static int open_skin(const struct run *run, struct part *part) {
    char path[RUN_PATH];
    run_path(path, run, "%s.skin.vtk", part->name);
    return access(path, F_OK) ? EXIT_GOOD : vtk_frame_read_skin(path, &part->skin);
}

/* Reads name, list of frames, radius and rest density of body b. */
static int open_body(struct run *run, int b) {
    struct part *part = &run->part[run->parts++];
    json_t *entry = json_array_get(run->body_list, (size_t)b);
    *part = (struct part){.kind = BODY, .folder = ""};
    part->name = json_string_value(json_object_get(entry, "name"));
    if (!is_part_name(part->name))
        return run_error("%s/%s: bodies[%d]: expected a \"name\" without '/' of at most %d bytes",
                         run->directory, run->source, b, PART_NAME);
    part->fluid = !run->report || is_fluid(run, part->name);
    if (json_is_true(json_object_get(entry, "rigid"))) part->shape = "rigid";
    int code = part_open_series(run, part);
    if (code == EXIT_GOOD) code = read_body_number(run, b, "radius_m", &part->radius);
    if (code == EXIT_GOOD) code = read_body_number(run, b, "rest_density", &part->rest_density);
    if (code == EXIT_GOOD) code = read_color(run, part, entry, &part->color);
    if (code != EXIT_GOOD || run->live) return code; /* a live view sends vertices of the body */
    return open_skin(run, part);
}

/* Reads name, kind and list of frames of a solid in report.json; an entry without a file (of an
 * older run) is left out. */
static int open_solid(struct run *run, int s) {
    struct part part = {.kind = SOLID, .folder = "solids/"};
    int moving = 0;
    json_t *entry = json_array_get(json_object_get(run->report, "solids"), (size_t)s);
    if (!json_object_get(entry, "file")) return EXIT_GOOD;
    if (json_unpack(entry, "{s:s, s:s, s:b}", "name", &part.name, "kind", &part.shape, "moving",
                    &moving) ||
        !is_part_name(part.name))
        return run_error("%s/%s: solids[%d]: expected \"name\", \"kind\" and \"moving\", a name "
                         "without '/' of at most %d bytes",
                         run->directory, run->source, s, PART_NAME);
    part.rest = !moving;
    int code = read_color(run, &part, entry, &part.color);
    if (code != EXIT_GOOD) return code;
    run->part[run->parts] = part;
    return part_open_series(run, &run->part[run->parts++]);
}

/* Boundary points on solids at rest, and on those that move, if the files are there. */
static int open_boundary(struct run *run) {
    int code = EXIT_GOOD;
    for (int rest = 0; rest < 2 && code == EXIT_GOOD; rest++) {
        char path[RUN_PATH];
        run_path(path, run, "boundary%s", rest ? ".vtk" : ".vtk.series");
        if (access(path, F_OK)) continue;
        struct part *part = &run->part[run->parts++];
        *part = (struct part){.kind = BOUNDARY, .rest = rest, .folder = "", .name = "boundary"};
        code = part_open_series(run, part);
    }
    return code;
}

/* ---- the run --------------------------------------------------------------------------------- */

double part_time(const struct part *part, int f) {
    return json_number_value(json_object_get(json_array_get(part->files, (size_t)f), "time"));
}

bool part_has_time(const struct part *part, int f, double time) {
    return fabs(part_time(part, f) - time) <= 1e-9 * (1.0 + fabs(time));
}

int part_frames(const struct run *run, const struct part *part) {
    return part->rest ? 1 : run->frames;
}

int part_read_frame(const struct run *run, const struct part *part, int f, char path[RUN_PATH],
                    struct vtk_frame *frame) {
    json_t *entry = json_array_get(part->files, part->rest ? 0 : (size_t)f);
    const char *name = json_string_value(json_object_get(entry, "name"));
    run_path(path, run, "%s%s", part->folder, name);
    if (part->kind != BODY) return vtk_frame_read_geometry(path, frame);
    int code = vtk_frame_read(path, frame);
    if (code != EXIT_GOOD || !part->skin.count) return code;
    code = skin_carry(&part->skin, path, frame);
    if (code != EXIT_GOOD) vtk_frame_free(frame);
    return code;
}

/* Sets run->frames to the number of frames that all parts have (a killed run may lack the last
 * frame of some) and checks that their times agree. */
static int count_frames(struct run *run) {
    size_t frames = json_array_size(run->part[0].files);
    for (int p = 1; p < run->parts; p++) {
        size_t more = json_array_size(run->part[p].files);
        if (more < frames && !run->part[p].rest) frames = more;
    }
    if (!frames) return run_error("%s: expected at least one frame, found none", run->directory);
    run->frames = (int)frames;
    for (int p = 1; p < run->parts; p++)
        for (int f = 0; f < run->frames && !run->part[p].rest; f++) {
            double time = part_time(&run->part[p], f), expected = part_time(&run->part[0], f);
            if (!part_has_time(&run->part[p], f, expected))
                return run_error("%s/%s%s.vtk.series: files[%d]: expected the time %.9g of \"%s\", "
                                 "found %.9g",
                                 run->directory, run->part[p].folder, run->part[p].name, f,
                                 expected, run->part[0].name, time);
        }
    return EXIT_GOOD;
}

int run_open(struct run *run) {
    int code = find_bodies(run);
    if (code != EXIT_GOOD) return code;
    int bodies = (int)json_array_size(run->body_list);
    int solids = (int)json_array_size(json_object_get(run->report, "solids"));
    run->part = calloc((size_t)bodies + (size_t)solids + 2, sizeof *run->part);
    if (!run->part) return report_no_memory();
    for (int b = 0; b < bodies && code == EXIT_GOOD; b++) code = open_body(run, b);
    for (int s = 0; s < solids && code == EXIT_GOOD; s++) code = open_solid(run, s);
    if (code == EXIT_GOOD) code = open_boundary(run);
    return code == EXIT_GOOD ? count_frames(run) : code;
}

int run_open_with_report(struct run *run) {
    int code = run_open(run);
    if (code != EXIT_GOOD || run->report) return code;
    return run_error("%s: expected report.json or files.json of a run, found neither",
                     run->directory);
}

bool run_is_z_up(const struct run *run) {
    const char *up = json_string_value(json_object_get(run->report, "up"));
    return up && !strcmp(up, "z");
}

void run_close(struct run *run) {
    for (int p = 0; p < run->parts; p++) {
        struct part *part = &run->part[p];
        json_decref(part->series);
        free(part->triangle);
        free(part->frame_points);
        vtk_frame_free(&part->skin);
    }
    free(run->part);
    json_decref(run->metrics);
    json_decref(run->live);
    json_decref(run->body_list);
    json_decref(run->report);
}
