/* DIR/run.json, from which `projdyn run --resume DIR` reads scene, overrides, plug-ins, end and
 * --no-frames. */
#include "run_record.h"
#include "new_file.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* DIRECTORY/FILE; the caller frees it. NULL with a message if memory ran out. */
static char *file_in(const char *directory, const char *file) {
    char *path;
    if (asprintf(&path, "%s/%s", directory, file) >= 0) return path;
    report_no_memory();
    return NULL;
}

static bool has_file(const char *directory, const char *file) {
    char *path = file_in(directory, file);
    bool exists = path && !access(path, F_OK);
    free(path);
    return exists;
}

bool run_record_exists(const char *directory) { return has_file(directory, "run.json"); }

/* A run that was killed has no report. */
bool run_record_is_unfinished(const char *directory) {
    if (!run_record_exists(directory) || !has_file(directory, "state.pdyn")) return false;
    if (!has_file(directory, "report.json")) return true;
    char *path = file_in(directory, "report.json");
    json_t *report = path ? json_load_file(path, 0, NULL) : NULL;
    bool interrupted = json_is_true(json_object_get(report, "interrupted"));
    json_decref(report);
    free(path);
    return interrupted;
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool append_path(json_t *array, const char *path) {
    char *whole = realpath(path, NULL);
    bool good = whole && !json_array_append_new(array, json_string(whole));
    free(whole);
    return good;
}

/* The JSON object of run.json. Paths are absolute, so that a run can be resumed from any working
 * directory. NULL if memory ran out, a file is missing or a text is not UTF-8. */
static json_t *options_to_json(const struct scene_options *o, double end, bool no_frames) {
    char *scene = realpath(o->scene, NULL);
    json_t *set = json_array(), *plugins = json_array(), *root = NULL;
    bool good = scene && set && plugins;
    for (int k = 0; k < o->sets && good; k++)
        good = !json_array_append_new(set, json_string(o->set[k]));
    for (int k = 0; k < o->plugins && good; k++) good = append_path(plugins, o->plugin[k]);
    if (good) root = json_pack("{s:s, s:O, s:O}", "scene", scene, "set", set, "plugins", plugins);
    if (root && ((end > 0.0 && json_object_set_new(root, "time", json_real(end))) ||
                 (no_frames && json_object_set_new(root, "no_frames", json_true()))))
        json_decref(root), root = NULL;
    free(scene);
    json_decref(set), json_decref(plugins);
    return root;
}

/* Writes the JSON object to a file; false with errno on failure. */
static bool dump(const json_t *root, const char *path) {
    char *temporary;
    FILE *file = new_file_open(path, &temporary);
    return file && new_file_close(file, temporary, path, !json_dumpf(root, file, JSON_INDENT(2)));
}

int run_record_write(const char *directory, const struct scene_options *options, double end,
                     bool no_frames) {
    char *path = file_in(directory, "run.json");
    errno = 0;
    json_t *root = options_to_json(options, end, no_frames);
    if (errno != ENOMEM) errno = 0;
    bool good = path && root && dump(root, path);
    if (!good && path)
        fprintf(stderr, "projdyn: %s: writing failed: %s\n", path,
                errno ? strerror(errno) : "a name is not UTF-8");
    json_decref(root);
    free(path);
    return good ? EXIT_GOOD : EXIT_FAILED;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Passes every text of a JSON array to `add`; false if an element is no text or `add` fails. */
static bool add_texts(const json_t *array, struct scene_options *o,
                      bool (*add)(struct scene_options *options, const char *text)) {
    for (size_t k = 0; k < json_array_size(array); k++) {
        const char *text = json_string_value(json_array_get(array, k));
        if (!text || !add(o, text)) return false;
    }
    return true;
}

static bool options_from_json(const json_t *root, struct scene_options *o) {
    const json_t *set = json_object_get(root, "set"), *plugins = json_object_get(root, "plugins");
    o->scene = json_string_value(json_object_get(root, "scene"));
    return o->scene && json_is_array(set) && add_texts(set, o, scene_set) &&
           add_texts(plugins, o, scene_plugin);
}

int run_record_read(const char *directory, struct scene_options *options, double *end,
                    bool *no_frames, void **record) {
    json_error_t error;
    char *path = file_in(directory, "run.json");
    if (!path) return EXIT_FAILED;
    errno = 0;
    json_t *root = *record = json_load_file(path, 0, &error);
    bool good = root && options_from_json(root, options);
    bool no_memory = errno == ENOMEM, found = !good || !access(options->scene, F_OK);
    *end = json_number_value(json_object_get(root, "time"));
    *no_frames = json_is_true(json_object_get(root, "no_frames"));
    if (no_memory) report_no_memory();
    else if (!root)
        fprintf(stderr, "projdyn: --resume: no run to continue: %s: %s%s\n", path, error.text,
                !run_record_exists(directory) && has_file(directory, "state.pdyn")
                    ? "; a program wrote this state and continues it, in Python by sim.write(..., "
                      "resume=True)"
                    : "");
    else if (!good)
        fprintf(stderr,
                "projdyn: %s: expected a text \"scene\" and arrays \"set\" and \"plugins\"\n",
                path);
    else if (!found)
        fprintf(stderr,
                "projdyn: %s: \"scene\": %s: %s; if it was moved, write its present path here\n",
                path, options->scene, strerror(errno));
    good = good && found;
    free(path);
    return no_memory ? EXIT_FAILED : good ? EXIT_GOOD : EXIT_BAD_INPUT;
}

void run_record_free(void *record) { json_decref(record); }
