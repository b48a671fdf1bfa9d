/* Protection of the files that a scene has read from its own run. */
#include "writer.h"

#include <string.h>
#include <sys/stat.h>

static bool same_file(const char *path, const struct stat *file) {
    struct stat other;
    return !stat(path, &other) && other.st_ino == file->st_ino && other.st_dev == file->st_dev;
}

bool own_source(const pdyn_sim *sim, const char *path) {
    const struct sources *sources = &sim->scene.sources;
    struct stat file;
    if (stat(path, &file)) return false;
    for (size_t k = 0; k < sources->count; k++)
        if (same_file(sources->path[k], &file)) return true;
    return false;
}

static pdyn_status refuse(const pdyn_sim *sim, const char *path) {
    if (!own_source(sim, path)) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT,
                     "%.1024s: the scene reads this file, which the run would replace: "
                     "expected another directory for the run",
                     path);
}

/* Whether a file may be a frame of this run, or of one before that this run removes. */
static bool is_frame(const char *file) {
    const char *number = strrchr(file, '_'), *ending = number ? frame_ending(number) : NULL;
    return ending && ending == strrchr(file, '.');
}

/* A frame in `folder` of the directory that the scene has read. */
static pdyn_status refuse_frames(pdyn_writer *writer, const char *folder) {
    const struct sources *sources = &writer->sim->scene.sources;
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < sources->count && status == PDYN_OK; k++) {
        const char *slash = strrchr(sources->path[k], '/');
        const char *name = slash ? slash + 1 : sources->path[k];
        if (is_frame(name)) status = refuse(writer->sim, writer_path(writer, "%s%s", folder, name));
    }
    return status;
}

pdyn_status own_sources_check(pdyn_writer *writer) {
    static const char *const folders[] = {"", SOLIDS_FOLDER, MESH_FOLDER};
    static const char *const files[] = {METRICS_FILE, PROBES_FILE, BOUNDARY SHAPE_ENDING,
                                        RECORD_FILE,  REPORT_FILE, LIST_FILE};
    const pdyn_sim *sim = writer->sim;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 3 && status == PDYN_OK; k++) status = refuse_frames(writer, folders[k]);
    for (int k = 0; k < 6 && status == PDYN_OK; k++)
        status = refuse(sim, writer_path(writer, "%s", files[k]));
    for (int b = 0; b < sim->bodies && status == PDYN_OK; b++)
        status = refuse(sim, writer_path(writer, "%s" OBJ_ENDING, sim->body[b].name));
    for (int b = 0; b < sim->bodies && status == PDYN_OK; b++)
        status = refuse(sim, writer_path(writer, "%s" SKIN_ENDING, sim->body[b].name));
    return status;
}
