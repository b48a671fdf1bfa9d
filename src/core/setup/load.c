/* pdyn_load and pdyn_load_text: scenes of programs that change nothing but values. */
#include "base/bad_call.h"
#include "scene/scene_file.h"

/* Applies the overrides to a scene that was opened with `status`, loads it and frees it. */
static pdyn_status finish(pdyn_status status, pdyn_scene *scene, const char *const *set, int count,
                          pdyn_sim **out) {
    if (status == PDYN_OK) status = pdyn_scene_override(scene, set, count);
    if (status == PDYN_OK) status = pdyn_scene_load(scene, out);
    pdyn_scene_free(scene);
    return status;
}

pdyn_status pdyn_load(pdyn_context *context, const char *path, const char *const *set, int count,
                      pdyn_sim **out) {
    pdyn_scene *scene = NULL;
    if (out) *out = NULL;
    if (HAS_NULL(context, path, out) || scene_bad_overrides(__func__, set, count))
        return PDYN_BAD_CALL;
    pdyn_status status = pdyn_scene_open(context, path, &scene);
    return finish(status, scene, set, count, out);
}

pdyn_status pdyn_load_text(pdyn_context *context, const char *text, const char *name,
                           const char *const *set, int count, pdyn_sim **out) {
    pdyn_scene *scene = NULL;
    if (out) *out = NULL;
    if (HAS_NULL(context, text, name, out) || scene_bad_overrides(__func__, set, count))
        return PDYN_BAD_CALL;
    pdyn_status status = pdyn_scene_parse(context, text, name, &scene);
    return finish(status, scene, set, count, out);
}
