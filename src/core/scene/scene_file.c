/* Scenes made by a program (projdyn/scene.h): opening, changing, writing. setup/build.c loads them.
 */
#include "scene_file.h"

#include "array_file.h"
#include "base/bad_call.h"
#include "base/file_out.h"
#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- opening --------------------------------------------------------------------------------- */

static pdyn_status open_file(pdyn_context *context, const char *name, bool on_disk,
                             const char *text, struct json_file *file) {
    struct text_locale locale;
    if (!text_begin(&locale)) return context_no_memory(context);
    pdyn_status status = json_file_open(context, name, on_disk, text, file);
    if (status != PDYN_OK) json_file_close(file);
    text_end(&locale);
    return status;
}

static pdyn_status open_scene(pdyn_context *context, const char *name, bool on_disk,
                              const char *text, pdyn_scene **out) {
    pdyn_scene *scene = NEW_ARRAY(context, 1, pdyn_scene);
    if (!scene) return PDYN_NO_MEMORY;
    pdyn_status status = open_file(context, name, on_disk, text, &scene->json);
    if (status == PDYN_OK) return *out = scene, PDYN_OK;
    FREE_ARRAY(context, scene, 1);
    return status;
}

pdyn_status pdyn_scene_create(pdyn_context *context, const char *name, pdyn_scene **out) {
    if (out) *out = NULL;
    if (HAS_NULL(context, name, out)) return PDYN_BAD_CALL;
    return open_scene(context, name, false, NULL, out);
}

pdyn_status pdyn_scene_open(pdyn_context *context, const char *path, pdyn_scene **out) {
    if (out) *out = NULL;
    if (HAS_NULL(context, path, out)) return PDYN_BAD_CALL;
    return open_scene(context, path, true, NULL, out);
}

pdyn_status pdyn_scene_parse(pdyn_context *context, const char *text, const char *name,
                             pdyn_scene **out) {
    if (out) *out = NULL;
    if (HAS_NULL(context, text, name, out)) return PDYN_BAD_CALL;
    return open_scene(context, name, false, text, out);
}

void pdyn_scene_free(pdyn_scene *scene) {
    if (!scene) return;
    pdyn_context *context = scene->json.context;
    array_file_free_all(context, &scene->json.arrays);
    json_file_close(&scene->json);
    FREE_ARRAY(context, scene, 1);
}

/* ---- values ---------------------------------------------------------------------------------- */

/* Prints the value and sets it. */
static pdyn_status set(pdyn_scene *scene, const char *path, const char *value, va_list args) {
    pdyn_context *context = scene->json.context;
    va_list again;
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, value, again);
    va_end(again);
    if (length < 0)
        return set_error(PDYN_BAD_INPUT, "%.1024s: %.256s: cannot print the value",
                         scene->json.name, path);
    char *text = NEW_ARRAY(context, (size_t)length + 1, char);
    if (!text) return PDYN_NO_MEMORY;
    vsnprintf(text, (size_t)length + 1, value, args);
    pdyn_status status = json_set(&scene->json, path, text);
    FREE_ARRAY(context, text, (size_t)length + 1);
    return status;
}

pdyn_status pdyn_scene_set(pdyn_scene *scene, const char *path, const char *value, ...) {
    struct text_locale locale;
    va_list args;
    if (HAS_NULL(scene, path, value)) return PDYN_BAD_CALL;
    if (!text_begin(&locale)) return context_no_memory(scene->json.context);
    va_start(args, value);
    pdyn_status status = set(scene, path, value, args);
    va_end(args);
    text_end(&locale);
    return status;
}

bool scene_bad_overrides(const char *function, const char *const *set, int count) {
    if (call_bad_array(function, "set", set, count)) return true;
    for (int k = 0; k < count; k++)
        if (!set[k]) return bad_call(function, "set[%d] is NULL, count is %d", k, count), true;
    return false;
}

pdyn_status pdyn_scene_override(pdyn_scene *scene, const char *const *set, int count) {
    struct text_locale locale;
    pdyn_status status = PDYN_OK;
    if (HAS_NULL(scene) || scene_bad_overrides(__func__, set, count)) return PDYN_BAD_CALL;
    if (!text_begin(&locale)) return context_no_memory(scene->json.context);
    for (int k = 0; k < count && status == PDYN_OK; k++)
        status = json_override(&scene->json, set[k]);
    text_end(&locale);
    return status;
}

/* ---- arrays ---------------------------------------------------------------------------------- */

static pdyn_status add(pdyn_scene *scene, const char *file, const struct array_file *arrays) {
    return array_file_add(scene->json.context, &scene->json.arrays, file, arrays);
}

pdyn_status pdyn_scene_mesh(pdyn_scene *scene, const char *file, int vertices, const double *vertex,
                            int triangles, const int *triangle) {
    if (HAS_NULL(scene, file, vertex, triangle)) return PDYN_BAD_CALL;
    return add(scene, file,
               &(struct array_file){.kind = &array_surface,
                                    .points = vertices,
                                    .x = vertex,
                                    .elements = triangles,
                                    .corner = triangle});
}

pdyn_status pdyn_scene_tets(pdyn_scene *scene, const char *file, int vertices, const double *vertex,
                            int tets, const int *tet) {
    if (HAS_NULL(scene, file, vertex, tet)) return PDYN_BAD_CALL;
    return add(scene, file,
               &(struct array_file){.kind = &array_volume,
                                    .points = vertices,
                                    .x = vertex,
                                    .elements = tets,
                                    .corner = tet});
}

pdyn_status pdyn_scene_particles(pdyn_scene *scene, const char *file, int count, const double *x,
                                 const double *v) {
    if (HAS_NULL(scene, file, x)) return PDYN_BAD_CALL;
    return add(scene, file,
               &(struct array_file){.kind = &array_particles, .points = count, .x = x, .v = v});
}

/* ---- text ------------------------------------------------------------------------------------ */

/* The JSON text with 15 digits if they give the same values, else with 17. NULL: no memory. */
static char *compose(const json_t *root) {
    static const size_t flags[] = {JSON_INDENT(2) | JSON_REAL_PRECISION(15),
                                   JSON_INDENT(2) | JSON_REAL_PRECISION(17)};
    char *text = json_compose(root, flags[0]);
    json_t *read = text ? json_parse(text, strlen(text), 0, NULL) : NULL;
    bool no_memory = text && !read && errno == ENOMEM, same = json_equal(read, root);
    json_decref(read);
    if (same) return text;
    free(text);
    return no_memory ? NULL : json_compose(root, flags[1]);
}

pdyn_status pdyn_scene_text(pdyn_scene *scene, void (*write)(void *user, const char *text),
                            void *user) {
    struct text_locale locale;
    if (HAS_NULL(scene)) return PDYN_BAD_CALL;
    if (!write) return bad_call(__func__, "write is NULL");
    if (!text_begin(&locale)) return context_no_memory(scene->json.context);
    char *text = compose(scene->json.root);
    text_end(&locale);
    if (!text) return context_no_memory(scene->json.context);
    write(user, text);
    free(text);
    return PDYN_OK;
}

static void print_text(void *user, const char *text) { file_out_print(user, "%s\n", text); }

pdyn_status pdyn_scene_write(pdyn_scene *scene, const char *path) {
    struct file_out out;
    pdyn_status status = PDYN_OK;
    if (HAS_NULL(scene, path)) return PDYN_BAD_CALL;
    pdyn_context *context = scene->json.context;
    const char *slash = strrchr(path, '/');
    if (array_file_find(scene->json.arrays, slash ? slash + 1 : path))
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: expected another name than that of the scene's arrays", path);
    for (const struct array_file *file = scene->json.arrays; file && status == PDYN_OK;
         file = file->next)
        status = array_file_write(context, file, path);
    if (status == PDYN_OK) status = file_out_open(context, path, &out);
    if (status != PDYN_OK) return status;
    status = pdyn_scene_text(scene, print_text, &out);
    if (status == PDYN_OK) return file_out_close(&out);
    return file_out_discard(&out), status;
}
