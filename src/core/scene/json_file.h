/* A JSON text with its overrides, and places in it: a value together with the way to it, so that an
 * error can say where it stands. */
#ifndef PDYN_JSON_FILE_H
#define PDYN_JSON_FILE_H

#include "base/context.h"

#include <jansson.h>

struct json_override { /* a text PATH=VALUE */
    char *path;        /* size bytes: a copy, cut into its keys and the value */
    size_t size;
    const json_t *container; /* what got something new, */
    const char *key;         /* under this key of an object */
    size_t index;            /* or in this element of an array (key NULL) */
};

struct json_file {
    pdyn_context *context;
    const char *name; /* for messages */
    const char *text; /* ends with NUL */
    char *loaded;     /* the text, where it came from a file of `size` bytes */
    size_t size;
    json_t *root; /* an object, with the overrides done */
    const char *const *set;
    int overrides, capacity;
    struct json_override *override;
};

/* A value, or the lack of one. Lives no longer than its file and its parent. */
struct json_at {
    const struct json_file *file;
    const struct json_at *parent; /* NULL: the root */
    const char *key;              /* in a parent that is an object, otherwise NULL */
    size_t index;
    json_t *value; /* NULL: missing */
};

/* text NULL: reads the file `name`. set: overrides PATH=VALUE. On failure *file needs no closing.
 */
pdyn_status json_file_open(pdyn_context *context, const char *name, const char *text,
                           const char *const *set, int sets, struct json_file *file);
void json_file_close(struct json_file *file);

struct json_at json_root(const struct json_file *file);
struct json_at json_member(const struct json_at *object, const char *key);
struct json_at json_element(const struct json_at *array, size_t index);

/* Errors, all PDYN_BAD_INPUT: the place (that of the object around it for a missing value), the
 * path and the message. */
pdyn_status json_fail(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);
pdyn_status json_fail_at_key(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);
/* "expected WHAT, found ...", or "missing, expected WHAT" */
pdyn_status json_expected(const struct json_at *at, const char *what);
/* Adds place and path to the error of someone else; any status comes back unchanged. */
pdyn_status json_wrap(const struct json_at *at, pdyn_status status);

#endif
