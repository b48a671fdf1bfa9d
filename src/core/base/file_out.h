/* A file that appears whole or not at all: it is written aside as PATH.tmp, and takes its name when
 * everything went well. What is no regular file (a device, a pipe, a link) is written directly. */
#ifndef PDYN_FILE_OUT_H
#define PDYN_FILE_OUT_H

#include "context.h"
#include "text.h"

#include <stdio.h>

struct file_out {
    pdyn_context *context;
    const char *path; /* the caller's, until the file is closed */
    char *aside;      /* aside_size bytes; NULL: path itself is written */
    size_t aside_size;
    FILE *stream;
    struct text_locale locale; /* numbers have a decimal point */
    int error;                 /* errno of the first failure; 0: none */
    bool unfit;                /* a number that no 32-bit float can hold */
};

enum byte_order { LITTLE_ENDIAN_BYTES, BIG_ENDIAN_BYTES };

/* On failure (PDYN_IO_FAILED, PDYN_NO_MEMORY) nothing is left to close. */
pdyn_status file_out_open(pdyn_context *context, const char *path, struct file_out *out);

/* These remember the first error; file_out_close tells it. */
void file_out_print(struct file_out *out, const char *format, ...) PDYN_PRINTF(2, 3);
void file_out_bytes(struct file_out *out, const void *data, size_t size);
/* 32-bit numbers. A value that is not finite as a float fails the file. */
void file_out_reals(struct file_out *out, enum byte_order order, const double *value, size_t count);
void file_out_ints(struct file_out *out, enum byte_order order, const int *value, size_t count);

/* Puts the file in its place. PDYN_IO_FAILED: something went wrong and no file was left behind. */
pdyn_status file_out_close(struct file_out *out);

#endif
