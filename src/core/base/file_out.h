/* Writing a file that appears complete or not at all: the content goes to a new file
 * PATH.RANDOM.tmp, which is renamed to PATH when everything was written. A symbolic or hard link at
 * PATH is replaced, and the file that it leads to stays as it is. A device, a pipe and the names of
 * open descriptors (/dev/stdout, /dev/stderr, /dev/fd/N, /proc/self/fd/N) are written directly. */
#ifndef PDYN_FILE_OUT_H
#define PDYN_FILE_OUT_H

#include "context.h"
#include "text.h"

#include <stdio.h>

struct file_out {
    pdyn_context *context;
    const char *path; /* not copied: must stay valid until file_out_close */
    char *temporary;  /* temporary_size bytes: PATH.RANDOM.tmp; NULL: `path` itself is written */
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
/* Writes `count` numbers of 64 bits, little endian. */
void file_out_doubles(struct file_out *out, const double *value, size_t count);

/* Waits until everything written so far is on the disk: after a power failure the path has the old
 * content or the new one, whole. */
void file_out_sync(struct file_out *out);

/* Closes the file and renames it to its path. PDYN_IO_FAILED: writing failed, and the
 * temporary file was removed. */
pdyn_status file_out_close(struct file_out *out);
/* Closes the file and removes it; a file that was at its path before stays. */
void file_out_discard(struct file_out *out);

/* Removes the temporary files that killed processes left in a directory. No process may write to
 * the directory at the same time. */
void file_out_remove_leftovers(const char *directory);

/* Opens a regular file for reading and writing in place. `create`: O_CREAT, or 0 for a file that
 * must exist. PDYN_BAD_INPUT: the path is a symbolic link, has a second hard link, or is no regular
 * file, so that writing would change another file. PDYN_IO_FAILED: it cannot be opened. */
pdyn_status file_open_in_place(const char *path, int create, int *descriptor);

#endif
