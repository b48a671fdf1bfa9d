/* Writes a file under a random name and renames it: see new_file.h. */
#include "new_file.h"
#include "signals.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

/* Whether the path is a name of an open descriptor: a symbolic link that must be followed. */
static bool is_descriptor(const char *path) {
    return !strcmp(path, "/dev/stdout") || !strcmp(path, "/dev/stderr") ||
           !strncmp(path, "/dev/fd/", 8) || !strncmp(path, "/proc/self/fd/", 14);
}

static bool is_written_directly(const char *path) {
    struct stat info;
    return is_descriptor(path) ||
           (lstat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISLNK(info.st_mode));
}

/* Opens the path itself, or a new file beside it. Returns the descriptor, or -1 with errno. */
static int create(const char *path, char **temporary) {
    const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    uint32_t random;
    *temporary = NULL;
    if (is_written_directly(path))
        return open(path, O_WRONLY | O_CLOEXEC | (is_descriptor(path) ? O_TRUNC : O_NOFOLLOW));
    if (getrandom(&random, sizeof random, 0) != sizeof random) return -1;
    if (asprintf(temporary, "%s.%08x.tmp", path, (unsigned)random) < 0) {
        *temporary = NULL;
        return errno = ENOMEM, -1;
    }
    return open(*temporary, flags, 0666);
}

/* The temporary file that a signal has to remove, or NULL. */
static char *volatile unfinished;

static void remove_and_die(int number) {
    if (unfinished) unlink(unfinished);
    signal(number, SIG_DFL);
    raise(number);
}

/* Lets Ctrl-C remove the file, in commands that do not handle signals themselves. */
static void remove_on_signal(char *temporary) {
    unfinished = temporary;
    signals_catch_default(remove_and_die);
}

FILE *new_file_open(const char *path, char **temporary) {
    int descriptor = create(path, temporary);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (file) {
        if (*temporary) remove_on_signal(*temporary);
        return file;
    }
    int error = errno;
    if (descriptor >= 0) close(descriptor);
    if (descriptor >= 0 && *temporary) unlink(*temporary);
    free(*temporary);
    errno = error;
    return NULL;
}

bool new_file_close(FILE *file, char *temporary, const char *path, bool good) {
    good = !ferror(file) && good;
    good = !fclose(file) && good;
    good = good && (!temporary || !rename(temporary, path));
    int error = errno;
    if (!good && temporary) unlink(temporary);
    if (unfinished == temporary) unfinished = NULL;
    free(temporary);
    errno = error;
    return good;
}
