/* The text of the last error, one for each thread: what was given, what was expected. */
#ifndef PDYN_ERROR_H
#define PDYN_ERROR_H

#include "projdyn/projdyn.h"

enum { ERROR_LENGTH = 2048 }; /* of a text, the closing NUL included; a longer one is cut */

/* Sets the text (printf format) and returns `status`. An argument may be the text of the error
 * before (pdyn_last_error). */
pdyn_status set_error(pdyn_status status, const char *format, ...) PDYN_PRINTF(2, 3);

/* Errors of this thread so far. */
unsigned error_count(void);

/* The status of a callback of the module `name`, which may have failed without a text: then it gets
 * that of the status. errors: error_count() before the callback. */
pdyn_status error_of_module(const char *name, pdyn_status status, unsigned errors);

#endif
