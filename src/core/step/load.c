/* pdyn_load and pdyn_load_text: scenes of programs that change nothing but values. */
#include "projdyn/scene.h"

/* Sets *out to NULL; false: PDYN_BAD_CALL. */
static bool begin(const char *const *set, int count, pdyn_sim **out) {
    if (!out) return false;
    *out = NULL;
    if (count < 0 || (count && !set)) return false;
    for (int k = 0; k < count; k++)
        if (!set[k]) return false;
    return true;
}

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
    if (!begin(set, count, out)) return PDYN_BAD_CALL;
    pdyn_status status = pdyn_scene_open(context, path, &scene);
    return finish(status, scene, set, count, out);
}

pdyn_status pdyn_load_text(pdyn_context *context, const char *text, const char *name,
                           const char *const *set, int count, pdyn_sim **out) {
    pdyn_scene *scene = NULL;
    if (!begin(set, count, out)) return PDYN_BAD_CALL;
    pdyn_status status = pdyn_scene_parse(context, text, name, &scene);
    return finish(status, scene, set, count, out);
}
