#include "record.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* DIR/run.json, or DIR/run.json.tmp; NULL with a message without memory. */
static char *path_in(const char *directory, const char *ending) {
    char *path;
    if (asprintf(&path, "%s/run.json%s", directory, ending) >= 0) return path;
    fprintf(stderr, "projdyn: out of memory\n");
    return NULL;
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool append_path(json_t *array, const char *path) {
    char *whole = realpath(path, NULL);
    bool good = whole && !json_array_append_new(array, json_string(whole));
    free(whole);
    return good;
}

/* Paths from the root, so that a run can go on from anywhere. */
static json_t *describe(const struct scene_options *o) {
    char *scene = realpath(o->scene, NULL);
    json_t *set = json_array(), *plugins = json_array(), *root = NULL;
    bool good = scene && set && plugins;
    for (int k = 0; k < o->sets && good; k++)
        good = !json_array_append_new(set, json_string(o->set[k]));
    for (int k = 0; k < o->plugins && good; k++) good = append_path(plugins, o->plugin[k]);
    if (good) root = json_pack("{s:s, s:O, s:O}", "scene", scene, "set", set, "plugins", plugins);
    free(scene);
    json_decref(set), json_decref(plugins);
    return root;
}

static bool dump(const json_t *root, const char *aside, const char *path) {
    return !json_dump_file(root, aside, JSON_INDENT(2)) && !rename(aside, path);
}

int record_write(const char *directory, const struct scene_options *options) {
    char *path = path_in(directory, ""), *aside = path_in(directory, ".tmp");
    json_t *root = describe(options);
    errno = 0;
    bool good = path && aside && root && dump(root, aside, path);
    if (!good && path && aside) {
        fprintf(stderr, "projdyn: %s: writing failed: %s\n", path,
                errno ? strerror(errno) : "a name is not UTF-8");
        remove(aside);
    }
    json_decref(root);
    free(path), free(aside);
    return good ? EXIT_GOOD : EXIT_FAILED;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Adds every text of an array. */
static bool take_all(const json_t *array, struct scene_options *o,
                     bool (*add)(struct scene_options *options, const char *text)) {
    for (size_t k = 0; k < json_array_size(array); k++) {
        const char *text = json_string_value(json_array_get(array, k));
        if (!text || !add(o, text)) return false;
    }
    return true;
}

static bool take(const json_t *root, struct scene_options *o) {
    const json_t *set = json_object_get(root, "set"), *plugins = json_object_get(root, "plugins");
    o->scene = json_string_value(json_object_get(root, "scene"));
    return o->scene && json_is_array(set) && take_all(set, o, scene_set) &&
           take_all(plugins, o, scene_plugin);
}

int record_read(const char *directory, struct scene_options *options, void **record) {
    json_error_t error;
    char *path = path_in(directory, "");
    if (!path) return EXIT_FAILED;
    json_t *root = *record = json_load_file(path, 0, &error);
    bool good = root && take(root, options);
    if (!root)
        fprintf(stderr, "projdyn: --resume: no run to go on with: %s: %s\n", path, error.text);
    else if (!good)
        fprintf(stderr, "projdyn: %s: expected the \"scene\" and the overrides \"set\" of a run\n",
                path);
    free(path);
    return good ? EXIT_GOOD : EXIT_BAD_INPUT;
}

void record_free(void *record) { json_decref(record); }
