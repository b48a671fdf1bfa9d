/* The output directory of a run: frames and their series, metrics.csv, report.json, state.pdyn. */
#include "base/clock.h"
#include "base/file_out.h"
#include "output.h"
#include "snapshot.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    ROW = 1024,
    ROW_BODY = 80
}; /* bytes of a row of metrics.csv: for the numbers of a step, and for each body */

struct pdyn_writer {
    pdyn_sim *sim;
    pdyn_context *context; /* context of the simulation */
    char *path; /* path_size bytes: the directory, followed by the file of the last path_of */
    size_t path_size, directory;
    bool ply;
    FILE *metrics; /* unbuffered, so that a row reaches the file at once */
    long metrics_size;
    char *row; /* row_size: the current row of metrics.csv */
    size_t row_size;
    int frames, capacity;
    double *time; /* capacity: times of the frames, s */
    struct report report;
};

/* ---- paths ----------------------------------------------------------------------------------- */

/* DIR/FILE; valid until the next call. */
static const char *path_of(pdyn_writer *writer, const char *format, ...) PDYN_PRINTF(2, 3);
static const char *path_of(pdyn_writer *writer, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(writer->path + writer->directory, writer->path_size - writer->directory, format,
              args);
    va_end(args);
    return writer->path;
}

/* Number of parts of a frame, one file each: the bodies, then the moving boundary points. */
static int parts(const pdyn_writer *writer) {
    return writer->sim->bodies + (writer->sim->motion.points > 0);
}

static const char *part_name(const pdyn_writer *writer, int part) {
    return part < writer->sim->bodies ? pdyn_get_body(writer->sim, part).name : "boundary";
}

static pdyn_status store_directory(pdyn_writer *writer, const char *directory) {
    size_t longest = strlen("boundary.vtk");
    for (int b = 0; b < writer->sim->bodies; b++) {
        size_t length = strlen(part_name(writer, b));
        if (length > longest) longest = length;
    }
    writer->directory = strlen(directory) + 1;
    writer->path_size = writer->directory + longest + sizeof "_0123456789.vtk.series";
    writer->path = NEW_ARRAY(writer->context, writer->path_size, char);
    if (!writer->path) return PDYN_NO_MEMORY;
    snprintf(writer->path, writer->path_size, "%s/", directory);
    return PDYN_OK;
}

static bool is_directory(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* Creates the directory and its parents. The path is cut at each slash in turn. */
static pdyn_status make_directory(pdyn_writer *writer) {
    char *path = writer->path;
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        int error = mkdir(path, 0777) ? errno : 0;
        if (error && !is_directory(path))
            return context_fail(writer->context,
                                error == EEXIST || error == ENOTDIR ? PDYN_BAD_INPUT
                                                                    : PDYN_IO_FAILED,
                                "%.1024s: cannot make the directory: %s", path, strerror(error));
        *slash = '/';
    }
    return PDYN_OK;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* Writes the file NAME.vtk.series, which lists the first `frames` frames of a part. */
static pdyn_status write_series(pdyn_writer *writer, int part, int frames) {
    const char *name = part_name(writer, part);
    struct file_out file;
    pdyn_status status =
        file_out_open(writer->context, path_of(writer, "%s.vtk.series", name), &file);
    if (status != PDYN_OK) return status;
    file_out_print(&file, "{\"file-series-version\": \"1.0\", \"files\": [");
    for (int f = 0; f < frames; f++)
        file_out_print(&file, "%s\n{\"name\": \"%s_%06d.vtk\", \"time\": %.17g}", f ? "," : "",
                       name, f, writer->time[f]);
    file_out_print(&file, "]}\n");
    return file_out_close(&file);
}

static pdyn_status write_part(pdyn_writer *writer, int part) {
    const char *name = part_name(writer, part);
    const char *path = path_of(writer, "%s_%06d.vtk", name, writer->frames);
    if (part == writer->sim->bodies) return vtk_write_boundary(writer->sim, true, path);
    pdyn_status status = vtk_write_body(writer->sim, part, path);
    if (status != PDYN_OK || !writer->ply) return status;
    return ply_write_body(writer->sim, part, path_of(writer, "%s_%06d.ply", name, writer->frames));
}

static pdyn_status reserve_times(pdyn_writer *writer, int frames) {
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
    pdyn_status status = reserve_times(writer, writer->frames + 1);
    if (status == PDYN_OK) writer->time[writer->frames] = pdyn_time(writer->sim);
    return status;
}

/* Writes the files of a frame before the series that list them: a series never names a missing
 * file. */
static pdyn_status write_frame(pdyn_writer *writer) {
    pdyn_status status = append_time(writer);
    for (int p = 0; p < parts(writer) && status == PDYN_OK; p++) status = write_part(writer, p);
    for (int p = 0; p < parts(writer) && status == PDYN_OK; p++)
        status = write_series(writer, p, writer->frames + 1);
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

/* NAME_dddddd.vtk with at least six digits: only such files are frames of this program. */
static bool is_frame(const char *file, const char *name) {
    size_t length = strlen(name);
    if (strncmp(file, name, length) || file[length] != '_') return false;
    size_t digits = strspn(file + length + 1, "0123456789");
    return digits >= 6 && digits <= 10 && !strcmp(file + length + 1 + digits, ".vtk");
}

static pdyn_status remove_file(pdyn_writer *writer, const char *path) {
    if (!unlink(path) || errno == ENOENT) return PDYN_OK;
    return context_fail(writer->context, PDYN_IO_FAILED,
                        "%.1024s: cannot remove the file of a previous run: %s", path,
                        strerror(errno));
}

static pdyn_status remove_frame(pdyn_writer *writer, const char *file) {
    static const char *const endings[] = {"vtk", "ply"};
    int stem = (int)(strlen(file) - strlen("vtk"));
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 2 && status == PDYN_OK; k++)
        status = remove_file(writer, path_of(writer, "%.*s%s", stem, file, endings[k]));
    return status;
}

/* Removes the frames that a series lists. A series that cannot be read lists nothing. */
static pdyn_status remove_frames(pdyn_writer *writer, const char *name) {
    const char *path = path_of(writer, "%s.vtk.series", name);
    struct stat info;
    if (stat(path, &info) || !S_ISREG(info.st_mode)) return PDYN_OK;
    json_t *series = json_load_file(path, 0, NULL), *files = json_object_get(series, "files");
    pdyn_status status = PDYN_OK;
    for (size_t i = 0; i < json_array_size(files) && status == PDYN_OK; i++) {
        const char *file = json_string_value(json_object_get(json_array_get(files, i), "name"));
        if (file && is_frame(file, name)) status = remove_frame(writer, file);
    }
    json_decref(series);
    return status;
}

/* ---- metrics --------------------------------------------------------------------------------- */

/* Appends a row, completely or not at all, even on a full disk. */
static pdyn_status write_row(pdyn_writer *writer) {
    size_t length = strlen(writer->row);
    if (fwrite(writer->row, 1, length, writer->metrics) == length) {
        writer->metrics_size += (long)length;
        return PDYN_OK;
    }
    int error = errno;
    if (ftruncate(fileno(writer->metrics), writer->metrics_size))
        errno = error; /* no truncation: metrics is not a regular file */
    clearerr(writer->metrics);
    return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: writing failed: %s",
                        path_of(writer, "metrics.csv"), strerror(error));
}

static pdyn_status open_metrics(pdyn_writer *writer) {
#define STEP_HEADER(column, member) "," #column
    static const char header[] = STEP_NUMBERS(STEP_HEADER);
#undef STEP_HEADER
    const char *path = path_of(writer, "metrics.csv");
    writer->metrics = fopen(path, "wbe");
    if (!writer->metrics)
        return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot create the file: %s",
                            path, strerror(errno));
    setvbuf(writer->metrics, NULL, _IONBF, 0);
    *writer->row = '\0';
    text_append(writer->row, writer->row_size, "%s", header + 1);
    for (int b = 0; b < writer->sim->bodies; b++)
        text_append(writer->row, writer->row_size, ",residual_%s", writer->sim->body[b].name);
    text_append(writer->row, writer->row_size, "\n");
    return write_row(writer);
}

/* Appends a column; it is empty for a number that is not finite. */
static void append_number(pdyn_writer *writer, double number) {
    text_append(writer->row, writer->row_size, *writer->row ? "," : "");
    if (isfinite(number)) text_append(writer->row, writer->row_size, "%.9g", number);
}

static pdyn_status append_step(pdyn_writer *writer, const pdyn_step_info *info) {
    double number[STEP_COLUMNS];
    struct text_locale locale;
    if (!text_begin(&locale)) return context_no_memory(writer->context);
    step_numbers(info, number);
    *writer->row = '\0';
    for (int k = 0; k < STEP_COLUMNS; k++) append_number(writer, number[k]);
    for (int b = 0; b < writer->sim->bodies; b++)
        append_number(writer, writer->sim->objective.body[b].residual);
    text_append(writer->row, writer->row_size, "\n");
    text_end(&locale);
    return write_row(writer);
}

pdyn_status pdyn_writer_step(pdyn_writer *writer, const pdyn_step_info *info) {
    if (!writer || !info) return PDYN_BAD_CALL;
    double start = clock_ms();
    pdyn_status status = append_step(writer, info);
    report_step(&writer->report, writer->sim, info);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

/* ---- saving and resuming --------------------------------------------------------------------- */

/* Saves or reads the state of the writer. */
static void persist_writer(pdyn_writer *writer, struct snapshot_file *a) {
    struct report *report = &writer->report;
    double run_ms = clock_ms() - report->opened_ms;
    snapshot_file_expect(a, sizeof *report, "numbers in its report");
    SNAPSHOT(a, writer->ply);
    SNAPSHOT(a, writer->metrics_size);
    SNAPSHOT(a, run_ms);
    struct report_stats *residual = report->residual;
    report->residual = NULL; /* saves zeros in place of the address */
    SNAPSHOT(a, *report);
    report->residual = residual;
    snapshot_file_bytes(a, residual, (size_t)writer->sim->bodies * sizeof *residual);
    SNAPSHOT(a, writer->frames);
    report->opened_ms = clock_ms() - run_ms;
}

static pdyn_status persist_all(pdyn_writer *writer, struct snapshot_file *a) {
    pdyn_status status = snapshot_simulation(writer->sim, a);
    if (status != PDYN_OK) return status;
    persist_writer(writer, a);
    if (a->view.reading && a->status == PDYN_OK) a->status = reserve_times(writer, writer->frames);
    if (a->status == PDYN_OK)
        snapshot_file_bytes(a, writer->time, (size_t)writer->frames * sizeof *writer->time);
    return a->status;
}

pdyn_status pdyn_writer_save(pdyn_writer *writer) {
    struct snapshot_file a;
    if (!writer) return PDYN_BAD_CALL;
    double start = clock_ms();
    pdyn_status status = snapshot_file_create(writer->context, path_of(writer, "state.pdyn"), &a);
    if (status != PDYN_OK) return status;
    persist_all(writer, &a);
    status = snapshot_file_close(&a);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

static pdyn_status load_state(pdyn_writer *writer) {
    struct snapshot_file a;
    pdyn_status status = snapshot_file_open(writer->context, path_of(writer, "state.pdyn"), &a);
    if (status != PDYN_OK) return status;
    persist_all(writer, &a);
    return snapshot_file_close(&a);
}

/* Opens metrics.csv and removes the rows after the saved state: these steps will be repeated. */
static pdyn_status reopen_metrics(pdyn_writer *writer) {
    const char *path = path_of(writer, "metrics.csv");
    writer->metrics = fopen(path, "r+be");
    if (!writer->metrics)
        return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot open the file: %s",
                            path, strerror(errno));
    setvbuf(writer->metrics, NULL, _IONBF, 0);
    if (fseek(writer->metrics, 0, SEEK_END) || ftell(writer->metrics) < writer->metrics_size)
        return context_fail(writer->context, PDYN_BAD_INPUT,
                            "%.1024s: the file is shorter than when the state was saved", path);
    if (ftruncate(fileno(writer->metrics), writer->metrics_size) ||
        fseek(writer->metrics, 0, SEEK_END))
        return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot be cut: %s", path,
                            strerror(errno));
    return PDYN_OK;
}

static pdyn_status resume(pdyn_writer *writer, const char *directory) {
    pdyn_status status = store_directory(writer, directory);
    if (status == PDYN_OK) status = load_state(writer);
    if (status == PDYN_OK) status = reopen_metrics(writer);
    for (int p = 0; p < parts(writer) && status == PDYN_OK; p++)
        status = write_series(writer, p, writer->frames);
    return status;
}

/* ---- opening and closing
 * ------------------------------------------------------------------------------- */

/* Writes the points on solids at rest, once. Removes files of a previous run that would be shown
 * together with the new ones. */
static pdyn_status begin_boundary(pdyn_writer *writer) {
    pdyn_state state = pdyn_get_state(writer->sim);
    const char *path = path_of(writer, "boundary.vtk");
    pdyn_status status = state.boundary > state.moving
                             ? vtk_write_boundary(writer->sim, false, path)
                             : remove_file(writer, path);
    if (status == PDYN_OK) status = remove_frames(writer, "boundary");
    if (status != PDYN_OK || state.moving) return status;
    return remove_file(writer, path_of(writer, "boundary.vtk.series"));
}

static pdyn_status prepare(pdyn_writer *writer, const char *directory) {
    pdyn_status status = store_directory(writer, directory);
    if (status == PDYN_OK) status = make_directory(writer);
    if (status == PDYN_OK) status = remove_file(writer, path_of(writer, "state.pdyn"));
    if (status == PDYN_OK) status = begin_boundary(writer);
    for (int p = 0; p < parts(writer) && status == PDYN_OK; p++) {
        status = remove_frames(writer, part_name(writer, p));
        if (status == PDYN_OK) status = write_series(writer, p, 0);
    }
    return status == PDYN_OK ? open_metrics(writer) : status;
}

static pdyn_status open_writer(pdyn_sim *sim, const char *directory, bool ply,
                               pdyn_status (*begin)(pdyn_writer *writer, const char *directory),
                               pdyn_writer **out) {
    if (!sim || !directory || !out) return PDYN_BAD_CALL;
    *out = NULL;
    if (!*directory)
        return context_fail(sim->context, PDYN_BAD_CALL, "the output directory has an empty name");
    pdyn_writer *writer = NEW_ARRAY(sim->context, 1, pdyn_writer);
    if (!writer) return PDYN_NO_MEMORY;
    writer->sim = sim;
    writer->context = sim->context;
    writer->ply = ply;
    writer->row_size = ROW + ROW_BODY * (size_t)sim->bodies;
    writer->row = NEW_ARRAY(sim->context, writer->row_size, char);
    pdyn_status status = writer->row ? report_open(&writer->report, sim) : PDYN_NO_MEMORY;
    if (status == PDYN_OK) status = begin(writer, directory);
    if (status == PDYN_OK) *out = writer;
    else pdyn_writer_close(writer);
    return status;
}

pdyn_status pdyn_writer_open(pdyn_sim *sim, const char *directory, bool ply, pdyn_writer **out) {
    return open_writer(sim, directory, ply, prepare, out);
}

pdyn_status pdyn_writer_resume(pdyn_sim *sim, const char *directory, pdyn_writer **out) {
    return open_writer(sim, directory, false, resume, out);
}

pdyn_status pdyn_writer_report(pdyn_writer *writer, const char *path, bool interrupted,
                               const char *failed) {
    if (!writer) return PDYN_BAD_CALL;
    return report_write(&writer->report, writer->sim, path ? path : path_of(writer, "report.json"),
                        interrupted, failed);
}

void pdyn_writer_close(pdyn_writer *writer) {
    if (!writer) return;
    pdyn_context *context = writer->context;
    if (writer->metrics) fclose(writer->metrics);
    report_close(&writer->report, writer->sim);
    FREE_ARRAY(context, writer->row, writer->row_size);
    FREE_ARRAY(context, writer->time, writer->capacity);
    FREE_ARRAY(context, writer->path, writer->path_size);
    FREE_ARRAY(context, writer, 1);
}
