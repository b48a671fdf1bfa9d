/* Reading a whole file into memory. */
#ifndef READ_FILE_H
#define READ_FILE_H

#include <stddef.h>

/* Reads a regular file and appends a NUL that *size does not count. The caller frees *text.
 * Returns EXIT_GOOD; or, after a message, EXIT_BAD_INPUT (EXIT_FAILED: out of memory) with *text
 * = NULL. */
int read_file(const char *path, char **text, size_t *size);

#endif
