#include "derived.h"

#include "base/context.h"
#include "head.h"

#include <math.h>
#include <string.h>

/* Of all fluids, at their start. */
static double count_particles(const struct scene *scene) {
    double count = 0.0;
    for (int b = 0; b < scene->bodies; b++) count += scene->body[b].start.count;
    return count;
}

static pdyn_scene_info describe(const struct scene *scene, const struct scene_body *body) {
    const struct scene_settings *settings = &scene->settings;
    pdyn_scene_info info = {.radius = body->radius,
                            .rest_density = body->rest_density,
                            .head = scene_head(scene, body),
                            .kernel = settings->kernel,
                            .size = 2.0 * body->radius * cbrt(count_particles(scene)),
                            .step = settings->h_fixed > 0.0 ? settings->h_fixed : settings->h_max,
                            .vertices = body->mesh.vertices,
                            .triangles = body->mesh.triangles,
                            .tets = body->tets.count};
    if (!body->has_mesh) info.pressure = scene_pressure(scene, body);
    memcpy(info.gravity, settings->gravity, sizeof info.gravity);
    return info;
}

pdyn_status derived_create(pdyn_context *context, const struct scene *scene,
                           const struct scene_body *body, struct scene_constraint *c) {
    size_t size = c->type->params_size;
    if (!c->type->resolve) return PDYN_OK;
    c->info = describe(scene, body);
    if (!size) return PDYN_OK;
    if (!(c->given = context_array(context, size, 1))) return PDYN_NO_MEMORY;
    memcpy(c->given, c->params, size);
    return PDYN_OK;
}

pdyn_param_fault derived_compute(const struct scene_constraint *c) {
    if (!c->type->resolve) return (pdyn_param_fault){0};
    if (c->given) memcpy(c->params, c->given, c->type->params_size);
    return c->type->resolve(c->params, &c->info);
}

void derived_free(pdyn_context *context, struct scene_constraint *c) {
    if (c->given) context_resize(context, c->given, c->type->params_size, 0);
}
