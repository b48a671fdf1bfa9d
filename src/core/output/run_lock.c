/* The lock of an output directory: a file `lock` in it that holds the process id of the run that
 * writes to the directory. The kernel releases the lock when the process ends in any way; the file
 * stays. */
#include "base/file_out.h"
#include "writer.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

/* The process id in the file; 0: none. */
static long read_holder(int descriptor) {
    char text[32] = "";
    ssize_t length = pread(descriptor, text, sizeof text - 1, 0);
    return length > 0 ? strtol(text, NULL, 10) : 0;
}

static bool write_holder(int descriptor) {
    char text[32];
    int length = snprintf(text, sizeof text, "%ld\n", (long)getpid());
    return !ftruncate(descriptor, 0) && pwrite(descriptor, text, (size_t)length, 0) == length;
}

/* errno is that of flock or write_holder. */
static pdyn_status fail_lock(pdyn_writer *writer, const char *path) {
    long holder = errno == EWOULDBLOCK ? read_holder(writer->lock) : -1;
    if (holder == getpid())
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: another writer of this program writes to this directory: close "
                         "it first, or choose another directory",
                         path);
    if (holder >= 0)
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: another run writes to this directory: process %ld", path,
                         holder);
    return set_error(PDYN_IO_FAILED, "%.1024s: cannot lock the file: %s", path, strerror(errno));
}

/* Whether errno says that the file system has no locks, as some network file systems. */
static bool has_no_locks(void) { return errno == ENOSYS || errno == EOPNOTSUPP || errno == ENOLCK; }

pdyn_status run_lock(pdyn_writer *writer) {
    const char *path = writer_path(writer, LOCK_FILE);
    pdyn_status status = file_open_in_place(path, O_CREAT, &writer->lock);
    if (status != PDYN_OK) return status;
    if (flock(writer->lock, LOCK_EX | LOCK_NB)) {
        if (!has_no_locks()) return fail_lock(writer, path);
        context_log(writer->context, PDYN_LOG_WARNING,
                    "%.1024s: the file system has no locks: a second run could write to the "
                    "directory at the same time",
                    path);
        return PDYN_OK;
    }
    if (!write_holder(writer->lock)) return fail_lock(writer, path);
    file_out_remove_leftovers(writer_path(writer, "%s", ""));
    file_out_remove_leftovers(writer_path(writer, SOLIDS_FOLDER));
    return PDYN_OK;
}

void run_unlock(pdyn_writer *writer) {
    if (writer->lock >= 0) close(writer->lock);
}
