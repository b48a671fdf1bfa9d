#include "job_inputs.h"

#include "jobs.h"
#include "read_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

uint64_t hash_text(uint64_t hash, const char *text, size_t length) {
    for (size_t k = 0; k <= length; k++)
        hash = (hash ^ (k < length ? (unsigned char)text[k] : 0xff)) * 0x100000001b3u;
    return hash;
}

uint64_t hash_file(uint64_t hash, const char *path) {
    struct stat status;
    char *text;
    size_t size;
    if (stat(path, &status) || !S_ISREG(status.st_mode)) return hash;
    if (read_file(path, &text, &size) != EXIT_GOOD) return hash;
    hash = hash_text(hash, text, size);
    free(text);
    return hash;
}

/* A file that a scene names. A mesh of TetGen has two files, of which the scene names one. */
static uint64_t hash_mesh(uint64_t hash, const char *path) {
    static const char *const pair[] = {".node", ".ele"};
    char file[JOB_PATH + 8];
    const char *ending = strrchr(path, '.');
    if (!ending || (strcasecmp(ending, pair[0]) && strcasecmp(ending, pair[1])))
        return hash_file(hash, path);
    for (int k = 0; k < 2; k++) {
        snprintf(file, sizeof file, "%.*s%s", (int)(ending - path), path, pair[k]);
        hash = hash_file(hash, file);
    }
    return hash;
}

/* A file that the text names, from the folder of the scene file. */
static uint64_t hash_named(uint64_t hash, const char *scene, const char *text) {
    char path[JOB_PATH];
    const char *slash = strrchr(scene, '/');
    int folder = slash && *text != '/' ? (int)(slash - scene) + 1 : 0;
    int length = snprintf(path, sizeof path, "%.*s%s", folder, scene, text);
    return length < JOB_PATH ? hash_mesh(hash, path) : hash;
}

uint64_t hash_named_files(uint64_t hash, const char *scene, const json_t *value) {
    const char *key;
    json_t *part;
    size_t k;
    if (json_is_string(value)) return hash_named(hash, scene, json_string_value(value));
    json_array_foreach(value, k, part) hash = hash_named_files(hash, scene, part);
    json_object_foreach((json_t *)value, key, part) hash = hash_named_files(hash, scene, part);
    return hash;
}
