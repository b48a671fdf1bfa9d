/* Reading a whole file into memory. */
#ifndef PDYN_FILE_IN_H
#define PDYN_FILE_IN_H

#include "context.h"

/* Opens a file for reading; a pipe does not make it wait. Returns its descriptor, or -1 with the
 * error text of PDYN_IO_FAILED. */
int file_open(const char *path);

/* Reads a regular file. *data: *size bytes and a closing NUL, an array of *size + 1 chars that the
 * caller frees, after a failure, too (NULL: none). PDYN_IO_FAILED: the file cannot be opened or
 * read, or is not a regular file. PDYN_NO_MEMORY. */
pdyn_status file_load(pdyn_context *context, const char *path, char **data, size_t *size);

#endif
