/* Creating, cutting and extending a CSV file. */
#include "csv_file.h"

#include "base/file_out.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

/* `create`: O_CREAT or 0. */
static pdyn_status open_stream(pdyn_context *context, const char *path, int create,
                               struct csv_file *file) {
    int descriptor;
    pdyn_status status = file_open_in_place(path, create, &descriptor);
    if (status != PDYN_OK) return status;
    file->stream = fdopen(descriptor, "r+b");
    if (!file->stream) {
        close(descriptor);
        return context_no_memory(context);
    }
    setvbuf(file->stream, NULL, _IONBF, 0);
    return PDYN_OK;
}

/* Removes what lies behind the complete rows. */
static bool cut_rest(struct csv_file *file) {
    return !ftruncate(fileno(file->stream), file->size) && !fseek(file->stream, 0, SEEK_END);
}

static pdyn_status cut(const char *path, struct csv_file *file) {
    if (cut_rest(file)) return PDYN_OK;
    return set_error(PDYN_IO_FAILED, "%.1024s: cannot be cut: %s", path, strerror(errno));
}

pdyn_status csv_create(pdyn_context *context, const char *path, struct csv_file *file) {
    pdyn_status status = open_stream(context, path, O_CREAT, file);
    return status == PDYN_OK ? cut(path, file) : status;
}

pdyn_status csv_reopen(pdyn_context *context, const char *path, struct csv_file *file) {
    pdyn_status status = open_stream(context, path, 0, file);
    if (status != PDYN_OK) return status;
    if (fseek(file->stream, 0, SEEK_END) || ftell(file->stream) < file->size)
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: the file is shorter than when the state was saved", path);
    return cut(path, file);
}

pdyn_status csv_append(const char *path, struct csv_file *file, const char *row) {
    size_t length = strlen(row);
    if (fwrite(row, 1, length, file->stream) == length) {
        file->size += (long)length;
        return PDYN_OK;
    }
    int error = errno;
    bool whole = cut_rest(file);
    clearerr(file->stream);
    return set_error(PDYN_IO_FAILED, "%.1024s: writing failed: %s%s", path, strerror(error),
                     whole ? "" : "; the last row is incomplete");
}

void csv_close(struct csv_file *file) {
    if (file->stream) fclose(file->stream);
    file->stream = NULL;
}
