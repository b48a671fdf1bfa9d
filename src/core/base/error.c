#include "error.h"

#include "text.h"

#include <stdarg.h>
#include <string.h>

static _Thread_local char last_error[ERROR_LENGTH];
static _Thread_local unsigned count;

const char *pdyn_last_error(const pdyn_context *context) {
    (void)context;
    return last_error;
}

pdyn_status set_error(pdyn_status status, const char *format, ...) {
    char text[ERROR_LENGTH]; /* the arguments may contain the last error */
    va_list args;
    va_start(args, format);
    text_write(text, sizeof text, format, args);
    va_end(args);
    memcpy(last_error, text, sizeof text);
    count++;
    return status;
}

unsigned error_count(void) { return count; }

pdyn_status error_of_module(const char *name, pdyn_status status, unsigned errors) {
    if (status == PDYN_OK || errors != count) return status;
    return set_error(status, "%s (\"%s\")", pdyn_status_text(status), name);
}
