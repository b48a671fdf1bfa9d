/* A series is extended in place, so that a long run does not write it anew for every frame. */
#include "series.h"

#include "base/file_out.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static const char brackets[] = "]}\n"; /* the end of a series */

struct entry {
    char text[NAME_LENGTH + 96];
};

/* The entry of frame f in a series, followed by `end`. Call in the C locale. */
static struct entry entry_of(const pdyn_writer *writer, struct part part, int f, const char *end) {
    struct entry entry;
    snprintf(entry.text, sizeof entry.text,
             "%s\n{\"name\": \"%s_%06d" SHAPE_ENDING "\", \"time\": %.17g}%s", f ? "," : "",
             part.name, f, writer->time[f], end);
    return entry;
}

static const char *series_path(pdyn_writer *writer, struct part part) {
    return writer_path(writer, "%s%s" SERIES_ENDING, part.folder, part.name);
}

pdyn_status series_write(pdyn_writer *writer, struct part part, int frames) {
    struct file_out file;
    if (!part.name) return PDYN_OK;
    pdyn_status status = file_out_open(writer->context, series_path(writer, part), &file);
    if (status != PDYN_OK) return status;
    file_out_print(&file, "{\"file-series-version\": \"1.0\", \"files\": [");
    for (int f = 0; f < frames; f++)
        file_out_print(&file, "%s", entry_of(writer, part, f, "").text);
    file_out_print(&file, "%s", brackets);
    return file_out_close(&file);
}

/* Whether a file ends with `text`. *size: its bytes. */
static bool ends_with(int descriptor, const char *text, off_t *size) {
    struct entry end;
    size_t length = strlen(text);
    *size = lseek(descriptor, 0, SEEK_END);
    return *size >= (off_t)length &&
           pread(descriptor, end.text, length, *size - (off_t)length) == (ssize_t)length &&
           !memcmp(end.text, text, length);
}

static bool write_at(int descriptor, off_t at, const char *text) {
    size_t length = strlen(text);
    return pwrite(descriptor, text, length, at) == (ssize_t)length;
}

/* Replaces the brackets at the end of a series of `size` bytes, in one write: a killed run leaves a
 * whole series. */
static pdyn_status replace_brackets(pdyn_writer *writer, struct part part, int descriptor,
                                    off_t size, const char *text) {
    off_t at = size - (off_t)strlen(brackets);
    errno = ENOSPC; /* what a shorter write means */
    if (write_at(descriptor, at, text)) return PDYN_OK;
    int error = errno;
    bool whole = write_at(descriptor, at, brackets) && !ftruncate(descriptor, size);
    return set_error(PDYN_IO_FAILED, "%.1024s: writing failed: %s%s", series_path(writer, part),
                     strerror(error), whole ? "" : "; its end is missing");
}

pdyn_status series_append(pdyn_writer *writer, struct part part, int f) {
    int descriptor;
    off_t size;
    pdyn_status status = PDYN_OK;
    if (!f || file_open_in_place(series_path(writer, part), 0, &descriptor))
        return series_write(writer, part, f + 1);
    bool known = ends_with(descriptor, entry_of(writer, part, f - 1, brackets).text, &size);
    if (known)
        status = replace_brackets(writer, part, descriptor, size,
                                  entry_of(writer, part, f, brackets).text);
    bool closed = !close(descriptor);
    return status != PDYN_OK || (known && closed) ? status : series_write(writer, part, f + 1);
}
