/* Writing a file that appears complete or not at all: the content goes to PATH.tmp, which is
 * renamed to PATH when everything was written. A path that exists and is no regular file (a device,
 * a pipe, a link) is written directly. */
#ifndef PDYN_FILE_OUT_H
#define PDYN_FILE_OUT_H

#include "context.h"
#include "text.h"

#include <stdio.h>

struct file_out {
    pdyn_context *context;
    const char *path; /* not copied: must stay valid until file_out_close */
    char *temporary;  /* the name PATH.tmp, temporary_size bytes; NULL: `path` itself is written */
    size_t temporary_size;
    FILE *stream;
    struct text_locale locale; /* makes printf write a decimal point in every locale */
    int error;                 /* errno of the first failure; 0: none */
    bool not_finite;           /* a value was not finite as a 32-bit float */
};

enum byte_order { LITTLE_ENDIAN_BYTES, BIG_ENDIAN_BYTES };

/* Opens the file for writing. After a failure (PDYN_IO_FAILED, PDYN_NO_MEMORY) there is nothing to
 * close. */
pdyn_status file_out_open(pdyn_context *context, const char *path, struct file_out *out);

/* Writing functions. The first error is stored and returned by file_out_close. */
void file_out_print(struct file_out *out, const char *format, ...) PDYN_PRINTF(2, 3);
void file_out_bytes(struct file_out *out, const void *data, size_t size);
/* Writes `count` numbers of 32 bits. A value that is not finite as a float makes file_out_close
 * fail. */
void file_out_reals(struct file_out *out, enum byte_order order, const double *value, size_t count);
void file_out_ints(struct file_out *out, enum byte_order order, const int *value, size_t count);

/* Closes the file and renames it to its path. PDYN_IO_FAILED: writing failed, and PATH.tmp was
 * removed. */
pdyn_status file_out_close(struct file_out *out);

#endif
