/* Files of the program that appear complete or not at all: the content goes to a new file with a
 * random name beside the target, which is renamed to the target. A symbolic or hard link at the
 * target is replaced, and the file that it leads to stays as it is. A device, a pipe and the names
 * of open descriptors (/dev/stdout, /dev/stderr, /dev/fd/N, /proc/self/fd/N) are written directly.
 * Signals (signals.h) remove the new file opened last, in commands without own handlers. */
#ifndef NEW_FILE_H
#define NEW_FILE_H

#include <stdbool.h>
#include <stdio.h>

/* Opens a new file PATH.RANDOM.tmp for writing; *temporary is its name, or NULL if the path is
 * written directly. Returns NULL with errno on failure; there is then nothing to close. */
FILE *new_file_open(const char *path, char **temporary);

/* Closes the file and frees `temporary`. good: renames the file to `path`; otherwise, or if closing
 * or renaming fails, removes it. Returns whether the file is at `path`; errno if not. */
bool new_file_close(FILE *file, char *temporary, const char *path, bool good);

#endif
