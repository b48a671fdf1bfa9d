/* The hash that names a job: over texts, and over the files that a scene names. */
#ifndef JOB_INPUTS_H
#define JOB_INPUTS_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* FNV-1a; a hash starts with this number. */
static const uint64_t hash_start = 0xcbf29ce484222325u;

/* Adds a text and an end mark, so that "ab" + "c" and "a" + "bc" differ. */
uint64_t hash_text(uint64_t hash, const char *text, size_t length);

/* Adds the contents of the file, if there is one. */
uint64_t hash_file(uint64_t hash, const char *path);

/* Adds the contents of all files (meshes, particles, plug-ins) that a value of the scene names: of
 * each of its texts that is the path of a file, from the folder of the scene file. */
uint64_t hash_named_files(uint64_t hash, const char *scene, const json_t *value);

#endif
