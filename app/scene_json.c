/* Values of a scene's JSON, with the defaults of docs/guide/scene.md. */
#include "scene_json.h"

#include <string.h>

/* Callback of pdyn_scene_text(). */
static void parse_text(void *user, const char *text) {
    *(json_t **)user = json_loads(text, 0, NULL);
}

int scene_json(const struct scene_options *scene, json_t **json) {
    pdyn_context *context = NULL;
    pdyn_scene *file = NULL;
    int code = scene_open(scene, &context, &file);
    if (code == EXIT_GOOD) {
        pdyn_status status = pdyn_scene_text(file, parse_text, json);
        if (status != PDYN_OK) code = report_status(context, status);
    }
    pdyn_scene_free(file);
    pdyn_destroy(context);
    return code == EXIT_GOOD && !*json ? report_no_memory() : code;
}

double scene_number(const json_t *object, const char *key, double fallback) {
    json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : fallback;
}

const json_t *scene_fluid(const json_t *scene, size_t body, size_t *constraint) {
    const json_t *owner = json_array_get(json_object_get(scene, "bodies"), body);
    json_t *c;
    size_t k;
    json_array_foreach(json_object_get(owner, "constraints"), k, c) {
        const char *type = json_string_value(json_object_get(c, "type"));
        if (!type || strcmp(type, "fluid") != 0) continue;
        *constraint = k;
        return c;
    }
    return NULL;
}

double scene_viscosity(const json_t *fluid) { return scene_number(fluid, "viscosity", 0.02); }
