/* DIR/files.json names the files and series that a run writes to its directory, so that the next
 * run in the directory removes them, whatever its scene contains, and no file of somebody else.
 * "scene" has the members of report.json that are known at the start, so that programs can show a
 * run that has no report yet:
 *
 *     {"files": ["report.json", "sheet.obj", "solids/tank.vtk"],
 *      "series": ["sheet", "water", "solids/paddle"],
 *      "scene": {"bodies": [...], "solids": [...], ...}}
 *
 * The state, metrics, probes and boundary points have fixed names and are replaced without it. */
#include "base/file_out.h"
#include "scene/json_file.h"
#include "writer.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the list of this run -------------------------------------------------------------------- */

/* The next element of the array that `count` counts. */
static void print_element(struct file_out *file, int *count, const char *folder, const char *name,
                          const char *ending) {
    file_out_print(file, "%s\"%s%s%s\"", (*count)++ ? ", " : "", folder, name, ending);
}

static void print_list(struct file_out *file, const pdyn_sim *sim, const char *scene_text) {
    const struct scene *scene = &sim->scene;
    int files = 0, series = 0;
    file_out_print(file, "{\"files\": [");
    print_element(file, &files, "", REPORT_FILE, "");
    for (int b = 0; b < sim->bodies; b++)
        if (sim->body[b].triangles) print_element(file, &files, "", sim->body[b].name, OBJ_ENDING);
    for (int b = 0; b < sim->bodies; b++)
        if (scene->body[b].skin.vertices)
            print_element(file, &files, "", sim->body[b].name, SKIN_ENDING);
    for (int s = 0; s < scene->solids; s++)
        if (!scene->solid[s].motion.keys)
            print_element(file, &files, SOLIDS_FOLDER, scene->solid[s].name, SHAPE_ENDING);
    file_out_print(file, "],\n \"series\": [");
    for (int b = 0; b < sim->bodies; b++) print_element(file, &series, "", sim->body[b].name, "");
    for (int s = 0; s < scene->solids; s++)
        if (scene->solid[s].motion.keys)
            print_element(file, &series, SOLIDS_FOLDER, scene->solid[s].name, "");
    file_out_print(file, "],\n \"scene\": %s}\n", scene_text);
}

/* The caller frees the text. NULL: no memory. */
static char *scene_text(const pdyn_writer *writer) {
    json_t *scene = report_scene(&writer->report, writer->sim);
    char *text = scene ? json_compose(scene, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    json_decref(scene);
    return text;
}

pdyn_status previous_run_list(pdyn_writer *writer) {
    struct file_out file;
    char *text = scene_text(writer);
    if (!text) return context_no_memory(writer->context);
    pdyn_status status = file_out_open(writer->context, writer_path(writer, LIST_FILE), &file);
    if (status == PDYN_OK) {
        print_list(&file, writer->sim, text);
        status = file_out_close(&file);
    }
    free(text);
    return status;
}

/* ---- removal --------------------------------------------------------------------------------- */

static bool is_frame_of(const char *name, const char *file) {
    size_t length = strlen(name);
    const char *ending = strncmp(file, name, length) ? NULL : frame_ending(file + length);
    return ending && !strcmp(ending, SHAPE_ENDING);
}

pdyn_status previous_run_remove_file(const char *path) {
    if (!unlink(path) || errno == ENOENT) return PDYN_OK;
    return set_error(PDYN_IO_FAILED, "%.1024s: cannot remove the file of a previous run: %s", path,
                     strerror(errno));
}

static pdyn_status remove_frame(pdyn_writer *writer, const char *folder, const char *file) {
    static const char *const endings[] = {SHAPE_ENDING, PLY_ENDING, OBJ_ENDING};
    int stem = (int)(strlen(file) - strlen(SHAPE_ENDING)),
        kinds = strcmp(folder, MESH_FOLDER) ? 2 : 3;
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < kinds && status == PDYN_OK; k++)
        status = previous_run_remove_file(
            writer_path(writer, "%s%.*s%s", folder, stem, file, endings[k]));
    return status;
}

/* Reads a JSON file; *out, which the caller frees, is NULL if it is missing or damaged. */
static pdyn_status load_json(pdyn_writer *writer, const char *path, json_t **out) {
    struct stat info;
    *out = NULL;
    if (stat(path, &info) || !S_ISREG(info.st_mode)) return PDYN_OK;
    errno = 0;
    *out = json_load_file(path, 0, NULL);
    return errno == ENOMEM ? context_no_memory(writer->context) : PDYN_OK;
}

pdyn_status previous_run_remove_frames(pdyn_writer *writer, const char *list, const char *name,
                                       const char *folder) {
    json_t *series, *files;
    pdyn_status status =
        load_json(writer, writer_path(writer, "%s%s" SERIES_ENDING, list, name), &series);
    files = json_object_get(series, "files");
    for (size_t i = 0; i < json_array_size(files) && status == PDYN_OK; i++) {
        const char *file = json_string_value(json_object_get(json_array_get(files, i), "name"));
        if (file && is_frame_of(name, file)) status = remove_frame(writer, folder, file);
    }
    json_decref(series);
    return status;
}

/* ---- all that the list of the previous run names --------------------------------------------- */

/* A name of a body or a solid, then `ending`, in the directory or its folder for solids; *folder:
 * which one. NULL: another path, which no run writes. */
static const char *own_name(const char *path, const char *ending, const char **folder) {
    size_t length = strlen(SOLIDS_FOLDER), name;
    *folder = path && !strncmp(path, SOLIDS_FOLDER, length) ? SOLIDS_FOLDER : "";
    if (!path) return NULL;
    path += strlen(*folder);
    name = strspn(path, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-");
    return name && name <= NAME_LENGTH && !strcmp(path + name, ending) ? path : NULL;
}

static pdyn_status remove_file(pdyn_writer *writer, const char *path) {
    const char *folder;
    bool own =
        path && (!strcmp(path, REPORT_FILE) || own_name(path, OBJ_ENDING, &folder) ||
                 own_name(path, SKIN_ENDING, &folder) || own_name(path, SHAPE_ENDING, &folder));
    if (!own) return PDYN_OK;
    path = writer_path(writer, "%s", path);
    return own_source(writer->sim, path) ? PDYN_OK : previous_run_remove_file(path);
}

/* Surfaces of a fluid by `projdyn mesh`, one for each frame, or fewer; a link is not followed. */
static pdyn_status remove_surfaces(pdyn_writer *writer, const char *name) {
    struct stat info;
    if (lstat(writer_path(writer, "mesh"), &info) || !S_ISDIR(info.st_mode)) return PDYN_OK;
    pdyn_status status = previous_run_remove_frames(writer, "", name, MESH_FOLDER);
    if (status != PDYN_OK) return status;
    return previous_run_remove_file(writer_path(writer, MESH_FOLDER "%s" SERIES_ENDING, name));
}

static pdyn_status remove_series(pdyn_writer *writer, const char *path) {
    const char *folder, *name = own_name(path, "", &folder);
    if (!name) return PDYN_OK;
    pdyn_status status = *folder ? PDYN_OK : remove_surfaces(writer, name);
    if (status == PDYN_OK) status = previous_run_remove_frames(writer, folder, name, folder);
    if (status != PDYN_OK) return status;
    return previous_run_remove_file(writer_path(writer, "%s%s" SERIES_ENDING, folder, name));
}

static pdyn_status remove_each(pdyn_writer *writer, const json_t *paths,
                               pdyn_status (*remove)(pdyn_writer *writer, const char *path)) {
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < json_array_size(paths) && status == PDYN_OK; k++)
        status = remove(writer, json_string_value(json_array_get(paths, k)));
    return status;
}

pdyn_status previous_run_remove(pdyn_writer *writer) {
    static const char *const folders[] = {"solids", "mesh"};
    json_t *list;
    pdyn_status status = load_json(writer, writer_path(writer, LIST_FILE), &list);
    if (status == PDYN_OK)
        status = remove_each(writer, json_object_get(list, "files"), remove_file);
    if (status == PDYN_OK)
        status = remove_each(writer, json_object_get(list, "series"), remove_series);
    for (int k = 0; k < 2; k++) rmdir(writer_path(writer, "%s", folders[k])); /* if empty */
    json_decref(list);
    return status;
}
