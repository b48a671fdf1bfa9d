#include "bad_call.h"

#include "context.h"

#include <stdio.h>
#include <string.h>

pdyn_status bad_call(const char *function, const char *format, ...) {
    const char *end = strstr(function, "_sized");
    char text[ERROR_LENGTH / 2];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return set_error(PDYN_BAD_CALL, "%.*s: %s",
                     (int)(end ? (size_t)(end - function) : strlen(function)), function, text);
}

/* names: as HAS_NULL has them, with ", " between them. */
bool call_has_null(const char *function, const char *names, const void *const *pointer) {
    for (size_t length; *names; names += length + strspn(names + length, ", "), pointer++) {
        length = strcspn(names, ",");
        if (!*pointer) return bad_call(function, "%.*s is NULL", (int)length, names), true;
    }
    return false;
}

bool call_bad_index(const char *function, const char *name, int index, int count) {
    if (index >= 0 && index < count) return false;
    if (count) bad_call(function, "%s: expected 0 to %d, found %d", name, count - 1, index);
    else bad_call(function, "%s: there is none, found %d", name, index);
    return true;
}

bool call_bad_array(const char *function, const char *name, const void *array, int count) {
    if (count < 0) bad_call(function, "count: expected at least 0, found %d", count);
    else if (count && !array) bad_call(function, "%s is NULL, count is %d", name, count);
    else return false;
    return true;
}
