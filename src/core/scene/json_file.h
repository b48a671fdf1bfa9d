/* A JSON text with overrides, and locations in it: a value with the path to it, so that an error
 * can give line, column and path. */
#ifndef PDYN_JSON_FILE_H
#define PDYN_JSON_FILE_H

#include "base/context.h"

#include <jansson.h>

struct json_override { /* an override PATH=VALUE */
    char *path;        /* size bytes: a copy, split into keys and value */
    size_t size;
    const json_t *container; /* object or array that was changed, */
    const char *key;         /* at this key of an object, */
    size_t index;            /* or at this index of an array (key NULL) */
};

struct json_file {
    pdyn_context *context;
    const char *name; /* name of the file, for messages */
    const char *text; /* ends with NUL */
    char *loaded;     /* the text if it was read from a file, size + 1 bytes */
    size_t size;
    json_t *root; /* an object, overrides applied */
    const char *const *set;
    int overrides, capacity;
    struct json_override *override;
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

/* Opens a JSON text; text NULL: reads the file `name`. set: `sets` overrides PATH=VALUE. After a
 * failure there is nothing to close. PDYN_BAD_CALL: an override is NULL. */
pdyn_status json_file_open(pdyn_context *context, const char *name, const char *text,
                           const char *const *set, int sets, struct json_file *file);
void json_file_close(struct json_file *file);

struct json_at json_root(const struct json_file *file);
struct json_at json_member(const struct json_at *object, const char *key);
struct json_at json_element(const struct json_at *array, size_t index);

/* Errors: set the error text "FILE:LINE:COLUMN: PATH: MESSAGE" and return PDYN_BAD_INPUT. The
 * position is that of the value (json_fail), of its key (json_fail_at_key), or, for a missing
 * value, of the object that lacks it. */
pdyn_status json_fail(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);
pdyn_status json_fail_at_key(const struct json_at *at, const char *format, ...) PDYN_PRINTF(2, 3);
/* MESSAGE is "expected WHAT, found ...", or "missing, expected WHAT". */
pdyn_status json_expected(const struct json_at *at, const char *what);
/* Prepends position and path to the error text of another function; returns `status`. PDYN_OK and
 * PDYN_NO_MEMORY: does nothing. */
pdyn_status json_wrap(const struct json_at *at, pdyn_status status);

#endif
