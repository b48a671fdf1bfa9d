/* The output directory of a run: opening, saving and resuming, the report. */
#include "writer.h"

#include "base/bad_call.h"
#include "base/clock.h"
#include "snapshot.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- paths ----------------------------------------------------------------------------------- */

const char *writer_path(pdyn_writer *writer, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(writer->path + writer->directory, writer->path_size - writer->directory, format,
              args);
    va_end(args);
    return writer->path;
}

static pdyn_status store_directory(pdyn_writer *writer, const char *directory) {
    writer->directory = strlen(directory) + 1;
    writer->path_size =
        writer->directory + sizeof SOLIDS_FOLDER + NAME_LENGTH + sizeof "_0123456789" SERIES_ENDING;
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
            return set_error(error == EEXIST || error == ENOTDIR ? PDYN_BAD_INPUT : PDYN_IO_FAILED,
                             "%.1024s: cannot make the directory: %s", path, strerror(error));
        *slash = '/';
    }
    return PDYN_OK;
}

/* ---- saving and resuming --------------------------------------------------------------------- */

/* Saves or reads the report. Its pointer is saved as zeros in place of the address. */
static void persist_report(pdyn_writer *writer, struct snapshot_file *file) {
    struct report *report = &writer->report;
    struct report_stats *residual = report->residual;
    report->residual = NULL;
    SNAPSHOT(file, *report);
    report->residual = residual;
    snapshot_file_bytes(file, residual, (size_t)writer->sim->bodies * sizeof *residual);
    unsigned char flag[2];
    memcpy(flag, &report->start.frame, 1), memcpy(flag + 1, &report->end.frame, 1);
    snapshot_file_require(file, flag[0] <= 1 && flag[1] <= 1,
                          "a flag of its report is neither 0 nor 1");
    snapshot_file_require(file, report->steps >= 0 && report->unsolved >= 0,
                          "a number of steps in its report is negative");
}

/* Saves or reads the state of the writer. */
static void persist_writer(pdyn_writer *writer, struct snapshot_file *file) {
    struct report *report = &writer->report;
    double run_ms = clock_ms() - report->opened_ms;
    snapshot_file_expect(file, sizeof *report, "numbers in its report");
    snapshot_file_flags(file, &writer->ply, 1, "the flag of PLY files is neither 0 nor 1");
    snapshot_file_long(file, &writer->metrics.size, LONG_MAX,
                       "the size of metrics.csv is negative");
    snapshot_file_long(file, &writer->probes.size, LONG_MAX, "the size of probes.csv is negative");
    snapshot_file_numbers(file, &run_ms, 1, "the time of the run is not finite");
    persist_report(writer, file);
    snapshot_file_count(file, &writer->frames, sizeof *writer->time,
                        "the number of its frames is out of range");
    report->opened_ms = clock_ms() - run_ms;
}

static pdyn_status persist_output(pdyn_writer *writer, struct snapshot_file *file) {
    persist_writer(writer, file);
    if (file->view.reading && file->status == PDYN_OK)
        file->status = frames_reserve_times(writer, writer->frames);
    if (file->status == PDYN_OK)
        snapshot_file_numbers(file, writer->time, (size_t)writer->frames,
                              "the time of a frame is not finite");
    return file->status;
}

pdyn_status pdyn_writer_save(pdyn_writer *writer) {
    struct snapshot_file file;
    if (HAS_NULL(writer) || control_is_in_step(__func__, writer->sim)) return PDYN_BAD_CALL;
    double start = clock_ms();
    pdyn_status status =
        snapshot_file_create(writer->context, writer_path(writer, STATE_FILE), &file);
    if (status != PDYN_OK) return status;
    if (snapshot_write(writer->sim, &file) == PDYN_OK) persist_output(writer, &file);
    status = snapshot_file_close(&file);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

/* Reads the states of simulation and writer; that of the simulation before goes to `before`. */
static pdyn_status load_state(pdyn_writer *writer, struct snapshot_file *before) {
    struct snapshot_file file;
    pdyn_status status =
        snapshot_file_open(writer->context, writer_path(writer, STATE_FILE), &file);
    if (status != PDYN_OK) return status;
    if (snapshot_read(writer->sim, &file, before) == PDYN_OK) persist_output(writer, &file);
    return snapshot_file_close(&file);
}

/* Before the lock, which would be a file in a directory that no run has written. */
static pdyn_status check_state(pdyn_writer *writer) {
    const char *path = writer_path(writer, STATE_FILE);
    if (!access(path, F_OK)) return PDYN_OK;
    return set_error(PDYN_IO_FAILED,
                     "%.1024s: cannot open: %s; expected the directory of a run that has saved "
                     "its state",
                     path, strerror(errno));
}

static pdyn_status resume(pdyn_writer *writer, const char *directory) {
    struct snapshot_file before = {0};
    pdyn_status status = store_directory(writer, directory);
    if (status == PDYN_OK) status = check_state(writer);
    if (status == PDYN_OK) status = run_lock(writer);
    if (status == PDYN_OK) status = load_state(writer, &before);
    if (status == PDYN_OK) status = previous_run_list(writer);
    if (status == PDYN_OK) status = metrics_reopen(writer);
    if (status == PDYN_OK) status = frames_write_series(writer, writer->frames);
    return snapshot_end_read(writer->sim, &before, status);
}

/* ---- opening and closing --------------------------------------------------------------------- */

/* Writes the points on solids at rest, once. Removes files of a previous run that would be shown
 * together with the new ones. */
static pdyn_status begin_boundary(pdyn_writer *writer) {
    pdyn_state state = pdyn_get_state(writer->sim);
    const char *path = writer_path(writer, BOUNDARY SHAPE_ENDING);
    pdyn_status status = state.boundary > state.moving
                             ? vtk_write_boundary(writer->sim, false, path)
                             : previous_run_remove_file(path);
    if (status == PDYN_OK) status = previous_run_remove_frames(writer, "", BOUNDARY, "");
    if (status != PDYN_OK || state.moving) return status;
    return previous_run_remove_file(writer_path(writer, BOUNDARY SERIES_ENDING));
}

/* Writes a solid at rest, once. Removes the files of a solid of this name in a previous run. */
static pdyn_status begin_solid(pdyn_writer *writer, int s) {
    const struct scene_solid *solid = &writer->sim->scene.solid[s];
    pdyn_status status =
        previous_run_remove_frames(writer, SOLIDS_FOLDER, solid->name, SOLIDS_FOLDER);
    if (status != PDYN_OK) return status;
    if (solid->motion.keys)
        return previous_run_remove_file(
            writer_path(writer, SOLIDS_FOLDER "%s" SHAPE_ENDING, solid->name));
    status = previous_run_remove_file(
        writer_path(writer, SOLIDS_FOLDER "%s" SERIES_ENDING, solid->name));
    if (status != PDYN_OK) return status;
    return vtk_write_solid(writer->sim, s,
                           writer_path(writer, SOLIDS_FOLDER "%s" SHAPE_ENDING, solid->name));
}

static pdyn_status begin_solids(pdyn_writer *writer) {
    int solids = writer->sim->scene.solids;
    if (!solids) return PDYN_OK;
    writer_path(writer, SOLIDS_FOLDER);
    pdyn_status status = make_directory(writer);
    for (int s = 0; s < solids && status == PDYN_OK; s++) status = begin_solid(writer, s);
    return status;
}

/* Writes the skin of a body, once, or removes that of a previous run. */
static pdyn_status begin_skin(pdyn_writer *writer, int b) {
    const char *path = writer_path(writer, "%s" SKIN_ENDING, writer->sim->body[b].name);
    return writer->sim->scene.body[b].skin.vertices ? vtk_write_skin(writer->sim, b, path)
                                                    : previous_run_remove_file(path);
}

/* Removes the frames of a body in a previous run; writes the OBJ file of a surface, once. */
static pdyn_status begin_body(pdyn_writer *writer, int b) {
    pdyn_body_info info = pdyn_get_body(writer->sim, b);
    pdyn_status status = previous_run_remove_frames(writer, "", info.name, "");
    if (status == PDYN_OK) status = begin_skin(writer, b);
    if (status != PDYN_OK || !info.triangles) return status;
    return obj_write_body(writer->sim, b, writer_path(writer, "%s" OBJ_ENDING, info.name));
}

static pdyn_status prepare(pdyn_writer *writer, const char *directory) {
    pdyn_status status = store_directory(writer, directory);
    if (status == PDYN_OK) status = make_directory(writer);
    if (status == PDYN_OK) status = run_lock(writer);
    if (status == PDYN_OK) status = own_sources_check(writer);
    if (status == PDYN_OK) status = previous_run_remove_file(writer_path(writer, STATE_FILE));
    if (status == PDYN_OK) status = previous_run_remove(writer);
    if (status == PDYN_OK) status = previous_run_list(writer);
    if (status == PDYN_OK) status = begin_boundary(writer);
    if (status == PDYN_OK) status = begin_solids(writer);
    for (int b = 0; b < writer->sim->bodies && status == PDYN_OK; b++)
        status = begin_body(writer, b);
    if (status == PDYN_OK) status = frames_write_series(writer, 0);
    return status == PDYN_OK ? metrics_open(writer) : status;
}

static pdyn_status open_writer(pdyn_sim *sim, const char *directory, bool ply,
                               pdyn_status (*begin)(pdyn_writer *writer, const char *directory),
                               pdyn_writer **out) {
    pdyn_writer *writer = NEW_ARRAY(sim->context, 1, pdyn_writer);
    if (!writer) return PDYN_NO_MEMORY;
    writer->sim = sim;
    writer->context = sim->context;
    writer->ply = ply;
    writer->lock = -1;
    writer->metrics.name = METRICS_FILE, writer->probes.name = PROBES_FILE;
    writer->row_size = metrics_row_size(sim);
    writer->row = NEW_ARRAY(sim->context, writer->row_size, char);
    pdyn_status status = writer->row ? report_open(&writer->report, sim) : PDYN_NO_MEMORY;
    if (status == PDYN_OK) status = begin(writer, directory);
    if (status == PDYN_OK) *out = writer;
    else pdyn_writer_close(writer);
    return status;
}

static bool has_no_name(const char *function, const char *directory) {
    return !*directory && bad_call(function, "directory is empty");
}

pdyn_status pdyn_writer_open(pdyn_sim *sim, const char *directory, bool ply, pdyn_writer **out) {
    if (out) *out = NULL;
    if (HAS_NULL(sim, directory, out) || has_no_name(__func__, directory)) return PDYN_BAD_CALL;
    return open_writer(sim, directory, ply, prepare, out);
}

pdyn_status pdyn_writer_resume(pdyn_sim *sim, const char *directory, pdyn_writer **out) {
    if (out) *out = NULL;
    if (HAS_NULL(sim, directory, out) || has_no_name(__func__, directory) ||
        control_is_in_step(__func__, sim))
        return PDYN_BAD_CALL;
    return open_writer(sim, directory, false, resume, out);
}

pdyn_status pdyn_writer_report(pdyn_writer *writer, const char *path, bool interrupted,
                               const char *failed) {
    if (HAS_NULL(writer)) return PDYN_BAD_CALL;
    return report_write(&writer->report, writer->sim,
                        path ? path : writer_path(writer, REPORT_FILE), interrupted, failed);
}

void pdyn_writer_close(pdyn_writer *writer) {
    if (!writer) return;
    pdyn_context *context = writer->context;
    csv_close(&writer->metrics);
    csv_close(&writer->probes);
    run_unlock(writer);
    report_close(&writer->report, writer->sim);
    FREE_ARRAY(context, writer->row, writer->row_size);
    FREE_ARRAY(context, writer->time, writer->capacity);
    FREE_ARRAY(context, writer->path, writer->path_size);
    FREE_ARRAY(context, writer, 1);
}
