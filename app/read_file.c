/* Reads a whole file into memory. */
#include "read_file.h"
#include "app.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int fail(const char *path, const char *what, const char *reason) {
    fprintf(stderr, "projdyn: %s: %s: %s\n", path, what, reason);
    return EXIT_BAD_INPUT;
}

/* Reads the open file; parameters and result as for read_file(). */
static int read_descriptor(const char *path, int descriptor, char **text, size_t *size) {
    struct stat info;
    if (fstat(descriptor, &info) || !S_ISREG(info.st_mode))
        return fail(path, "cannot read", "expected a regular file");
    size_t total = (size_t)info.st_size, length = 0;
    char *bytes = malloc(total + 1);
    if (!bytes) {
        fprintf(stderr, "projdyn: %s: out of memory (%zu bytes)\n", path, total + 1);
        return EXIT_FAILED;
    }
    while (length < total) {
        ssize_t more = read(descriptor, bytes + length, total - length);
        if (more <= 0) {
            free(bytes);
            return fail(path, "reading failed", more ? strerror(errno) : "the file shrank");
        }
        length += (size_t)more;
    }
    bytes[total] = '\0';
    *text = bytes;
    *size = total;
    return EXIT_GOOD;
}

int read_file(const char *path, char **text, size_t *size) {
    *text = NULL;
    /* O_NONBLOCK: opening a FIFO must not block. */
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return fail(path, "cannot open", strerror(errno));
    int code = read_descriptor(path, descriptor, text, size);
    close(descriptor);
    return code;
}
