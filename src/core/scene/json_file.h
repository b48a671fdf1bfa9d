/* A JSON text that can be changed, and locations in it: a value with the path to it, so that an
 * error can give line, column and path. */
#ifndef PDYN_JSON_FILE_H
#define PDYN_JSON_FILE_H

#include "base/context.h"

#include <jansson.h>

struct json_change {          /* a place of the root that was set or removed after parsing */
    struct json_change *next; /* older ones */
    json_t *container;        /* object or array, */
    const char *key;          /* key of an object; NULL: */
    size_t index;             /* index of an array; if removed: in the text */
    bool removed;             /* an element of an array */
    char *label;              /* for messages; NULL: the name of the file */
};

struct array_file;
struct sources;

struct json_file {
    pdyn_context *context;
    char *name; /* name of the file, for messages */
    char *text; /* size bytes and a closing NUL; NULL: made by a program */
    size_t size;
    bool on_disk;               /* the text was read from the file `name` */
    json_t *root;               /* an object, changes applied */
    struct json_change *change; /* newest first */
    struct array_file *arrays;  /* arrays that stand for files it names (array_file.h) */
    struct sources *sources;    /* gets the files it names, while a scene is read; else NULL */
};

/* json_loadb and json_dumps, which ignore some failed allocations and then give an error of syntax
 * or another text. NULL with errno ENOMEM: no memory. Other errors are in *error, which may be
 * NULL. */
json_t *json_parse(const char *text, size_t size, size_t flags, json_error_t *error);
char *json_compose(const json_t *value, size_t flags);

/* A value, or a missing value, and its path. Must not outlive its file and its parent. */
struct json_at {
    const struct json_file *file;
    const struct json_at *parent; /* NULL: the root */
    const char *key; /* key in a parent that is an object; NULL: the parent is an array */
    size_t index;
    json_t *value; /* NULL: missing */
};

/* Reads the file `name` (on_disk), parses a copy of `text`, or makes an empty object (text NULL).
 * The caller calls json_file_close, after a failure, too. PDYN_BAD_INPUT: not a JSON object. */
pdyn_status json_file_open(pdyn_context *context, const char *name, bool on_disk, const char *text,
                           struct json_file *file);
void json_file_close(struct json_file *file);

/* The index in the text of an element of an array, before the removals. */
size_t json_text_index(const struct json_file *file, const json_t *array, size_t index);

/* Changes a value, or removes it: value null; a failed call changes nothing. json_override:
 * "PATH=VALUE", for which an element of an array must exist, and messages begin with --set
 * PATH=VALUE. json_set: elements are made as pdyn_scene_set says, and messages begin with the name
 * of the file. */
pdyn_status json_override(struct json_file *file, const char *text);
pdyn_status json_set(struct json_file *file, const char *path, const char *value);
void json_changes_free(struct json_file *file); /* part of json_file_close */

struct json_at json_root(const struct json_file *file);
struct json_at json_member(const struct json_at *object, const char *key);
struct json_at json_element(const struct json_at *array, size_t index);

/* Errors: set the error text "FILE:LINE:COLUMN: PATH: MESSAGE" and return PDYN_BAD_INPUT. The
 * position is that of the value (json_fail), of its key (json_fail_at_key), or, for a missing
 * value, of the object that lacks it. A changed value has the label of its change instead of a
 * position, or the name alone. */
pdyn_status json_fail(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);
pdyn_status json_fail_at_key(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);
/* MESSAGE is "expected WHAT, found ...", or "missing, expected WHAT". */
pdyn_status json_expected(const struct json_at *at, const char *what);
/* Prepends position and path to the error text of another function; returns `status`. PDYN_OK and
 * PDYN_NO_MEMORY: does nothing. */
pdyn_status json_wrap(const struct json_at *at, pdyn_status status);
/* A note, which is no error: logs "FILE:LINE:COLUMN: PATH: MESSAGE". */
void json_note(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);

#endif
