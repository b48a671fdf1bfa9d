/* Frames of a run: VTK and PLY files, the series that list them, and removal of the frames of a
 * previous run. */
#include "base/clock.h"
#include "base/file_out.h"
#include "writer.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- parts ----------------------------------------------------------------------------------- */

/* A part of a frame, one file: of a body, the moving boundary points, or a moving solid. */
struct part {
    const char *folder, *name; /* folder: "" or SOLIDS_FOLDER; name NULL: the part is at rest */
    int body, solid;           /* index; -1: none */
};

static int count_parts(const pdyn_writer *writer) {
    return writer->sim->bodies + 1 + writer->sim->scene.solids;
}

static struct part part_of_frame(const pdyn_writer *writer, int part) {
    const pdyn_sim *sim = writer->sim;
    int solid = part - sim->bodies - 1;
    if (part < sim->bodies) return (struct part){"", pdyn_get_body(sim, part).name, part, -1};
    if (solid < 0) return (struct part){"", sim->motion.points ? BOUNDARY : NULL, -1, -1};
    const struct scene_solid *s = &sim->scene.solid[solid];
    return (struct part){SOLIDS_FOLDER, s->motion.keys ? s->name : NULL, -1, solid};
}

/* ---- series ---------------------------------------------------------------------------------- */

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

static pdyn_status write_series(pdyn_writer *writer, struct part part, int frames) {
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

pdyn_status frames_write_series(pdyn_writer *writer, int frames) {
    pdyn_status status = PDYN_OK;
    for (int p = 0; p < count_parts(writer) && status == PDYN_OK; p++)
        status = write_series(writer, part_of_frame(writer, p), frames);
    return status;
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
    return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: writing failed: %s%s",
                        series_path(writer, part), strerror(error),
                        whole ? "" : "; its end is missing");
}

/* Lists frame f in a series. A file that is not the series of the frames before is replaced. */
static pdyn_status append_to_series(pdyn_writer *writer, struct part part, int f) {
    int descriptor;
    off_t size;
    pdyn_status status = PDYN_OK;
    if (!f || file_open_in_place(writer->context, series_path(writer, part), 0, &descriptor))
        return write_series(writer, part, f + 1);
    bool known = ends_with(descriptor, entry_of(writer, part, f - 1, brackets).text, &size);
    if (known)
        status = replace_brackets(writer, part, descriptor, size,
                                  entry_of(writer, part, f, brackets).text);
    bool closed = !close(descriptor);
    return status != PDYN_OK || (known && closed) ? status : write_series(writer, part, f + 1);
}

/* Lists frame f in all series. */
static pdyn_status list_frame(pdyn_writer *writer, int f) {
    struct text_locale locale;
    pdyn_status status = PDYN_OK;
    if (!text_begin(&locale)) return context_no_memory(writer->context);
    for (int p = 0; p < count_parts(writer) && status == PDYN_OK; p++) {
        struct part part = part_of_frame(writer, p);
        if (part.name) status = append_to_series(writer, part, f);
    }
    text_end(&locale);
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static pdyn_status write_part(pdyn_writer *writer, struct part part) {
    if (!part.name) return PDYN_OK;
    const char *path =
        writer_path(writer, "%s%s_%06d" SHAPE_ENDING, part.folder, part.name, writer->frames);
    if (part.solid >= 0) return vtk_write_solid(writer->sim, part.solid, path);
    if (part.body < 0) return vtk_write_boundary(writer->sim, true, path);
    pdyn_status status = vtk_write_body(writer->sim, part.body, path);
    if (status != PDYN_OK || !writer->ply) return status;
    return ply_write_body(writer->sim, part.body,
                          writer_path(writer, "%s_%06d" PLY_ENDING, part.name, writer->frames));
}

pdyn_status frames_reserve_times(pdyn_writer *writer, int frames) {
    size_t size = (size_t)writer->capacity * sizeof(double);
    size_t grown = (2 * (size_t)frames + 64) * sizeof(double);
    if (frames <= writer->capacity) return PDYN_OK;
    double *moved =
        frames < INT32_MAX / 4 ? context_resize(writer->context, writer->time, size, grown) : NULL;
    if (!moved) return context_no_memory(writer->context);
    writer->time = moved;
    writer->capacity = (int)(grown / sizeof(double));
    return PDYN_OK;
}

static pdyn_status append_time(pdyn_writer *writer) {
    pdyn_status status = frames_reserve_times(writer, writer->frames + 1);
    if (status == PDYN_OK) writer->time[writer->frames] = pdyn_time(writer->sim);
    return status;
}

/* Writes the files of a frame before the series that list them: a series never names a missing
 * file. */
static pdyn_status write_frame(pdyn_writer *writer) {
    pdyn_status status = append_time(writer);
    for (int p = 0; p < count_parts(writer) && status == PDYN_OK; p++)
        status = write_part(writer, part_of_frame(writer, p));
    if (status == PDYN_OK) status = list_frame(writer, writer->frames);
    if (status == PDYN_OK) writer->frames++;
    return status;
}

pdyn_status pdyn_writer_frame(pdyn_writer *writer) {
    if (!writer) return PDYN_BAD_CALL;
    double start = clock_ms();
    pdyn_status status = write_frame(writer);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

/* ---- frames of a previous run ---------------------------------------------------------------- */

static bool is_frame_of(const char *name, const char *file) {
    size_t length = strlen(name);
    const char *ending = strncmp(file, name, length) ? NULL : frame_ending(file + length);
    return ending && !strcmp(ending, SHAPE_ENDING);
}

pdyn_status frames_remove_file(pdyn_writer *writer, const char *path) {
    if (!unlink(path) || errno == ENOENT) return PDYN_OK;
    return context_fail(writer->context, PDYN_IO_FAILED,
                        "%.1024s: cannot remove the file of a previous run: %s", path,
                        strerror(errno));
}

static pdyn_status remove_frame(pdyn_writer *writer, const char *folder, const char *file) {
    static const char *const endings[] = {SHAPE_ENDING, PLY_ENDING, OBJ_ENDING};
    int stem = (int)(strlen(file) - strlen(SHAPE_ENDING)),
        kinds = strcmp(folder, MESH_FOLDER) ? 2 : 3;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < kinds && status == PDYN_OK; k++)
        status = frames_remove_file(
            writer, writer_path(writer, "%s%.*s%s", folder, stem, file, endings[k]));
    return status;
}

pdyn_status frames_load_json(pdyn_writer *writer, const char *path, json_t **out) {
    struct stat info;
    *out = NULL;
    if (stat(path, &info) || !S_ISREG(info.st_mode)) return PDYN_OK;
    errno = 0;
    *out = json_load_file(path, 0, NULL);
    return errno == ENOMEM ? context_no_memory(writer->context) : PDYN_OK;
}

pdyn_status frames_remove_listed(pdyn_writer *writer, const char *list, const char *name,
                                 const char *folder) {
    json_t *series, *files;
    pdyn_status status =
        frames_load_json(writer, writer_path(writer, "%s%s" SERIES_ENDING, list, name), &series);
    files = json_object_get(series, "files");
    for (size_t i = 0; i < json_array_size(files) && status == PDYN_OK; i++) {
        const char *file = json_string_value(json_object_get(json_array_get(files, i), "name"));
        if (file && is_frame_of(name, file)) status = remove_frame(writer, folder, file);
    }
    json_decref(series);
    return status;
}
