/* A CSV file of a run that grows row by row, and that a resumed run cuts and continues. */
#ifndef PDYN_CSV_FILE_H
#define PDYN_CSV_FILE_H

#include "base/context.h"

#include <stdio.h>

struct csv_file {
    const char *name; /* in the directory of the run */
    FILE *stream;     /* unbuffered, so that a row reaches the file at once; NULL: closed */
    long size;        /* bytes of complete rows */
};

/* path: of the file. PDYN_IO_FAILED. */

/* Creates the file, or empties it. Does not follow a link. */
pdyn_status csv_create(pdyn_context *context, const char *path, struct csv_file *file);
/* Opens the file and removes the rows after `file->size`. PDYN_BAD_INPUT: it is shorter. */
pdyn_status csv_reopen(pdyn_context *context, const char *path, struct csv_file *file);
/* Appends a row, completely or not at all, even on a full disk. */
pdyn_status csv_append(const char *path, struct csv_file *file, const char *row);
void csv_close(struct csv_file *file);

#endif
