/* Reading a whole file into memory. */
#include "file_in.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static pdyn_status load_open(pdyn_context *context, const char *path, int descriptor, char **data,
                             size_t *size) {
    struct stat info;
    if (fstat(descriptor, &info) || !S_ISREG(info.st_mode))
        return set_error(PDYN_IO_FAILED, "%.1024s: expected a regular file%s", path,
                         S_ISDIR(info.st_mode) ? ", found a folder" : "");
    *size = (size_t)info.st_size;
    *data = NEW_ARRAY(context, *size + 1, char);
    if (!*data) return PDYN_NO_MEMORY;
    for (size_t have = 0; have < *size;) {
        ssize_t more = read(descriptor, *data + have, *size - have);
        if (more <= 0)
            return set_error(PDYN_IO_FAILED, "%.1024s: reading stopped at byte %zu of %zu: %s",
                             path, have, *size, more ? strerror(errno) : "the file shrank");
        have += (size_t)more;
    }
    return PDYN_OK;
}

int file_open(const char *path) {
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        set_error(PDYN_IO_FAILED, "%.1024s: cannot open the file: %s", path, strerror(errno));
    return descriptor;
}

pdyn_status file_load(pdyn_context *context, const char *path, char **data, size_t *size) {
    int descriptor = file_open(path);
    if (descriptor < 0) return PDYN_IO_FAILED;
    pdyn_status status = load_open(context, path, descriptor, data, size);
    close(descriptor);
    return status;
}
