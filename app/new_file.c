/* Writes a file under a random name and renames it: see new_file.h. */
#include "new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

static int create(const char *path, char **temporary) {
    const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    uint32_t random;
    *temporary = NULL;
    if (getrandom(&random, sizeof random, 0) != sizeof random) return -1;
    if (asprintf(temporary, "%s.%08x.tmp", path, (unsigned)random) < 0) {
        *temporary = NULL;
        return errno = ENOMEM, -1;
    }
    return open(*temporary, flags, 0666);
}

FILE *new_file_open(const char *path, char **temporary) {
    int descriptor = create(path, temporary);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (file) return file;
    int error = errno;
    if (descriptor >= 0) close(descriptor), unlink(*temporary);
    free(*temporary);
    errno = error;
    return NULL;
}

bool new_file_close(FILE *file, char *temporary, const char *path, bool good) {
    good = !ferror(file) && good;
    good = !fclose(file) && good;
    good = good && !rename(temporary, path);
    int error = errno;
    if (!good) unlink(temporary);
    free(temporary);
    errno = error;
    return good;
}
