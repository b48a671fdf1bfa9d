/* Settings of a scene: tables of parameters and their reading. A default outside of the bounds
 * means that the parameter is absent unless given. */
#include "base/registry.h"
#include "choices.h"
#include "keyed.h"
#include "params.h"
#include "reader.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SETTING(field) offsetof(struct scene_settings, field)

/* "gravity" is in no table, because its default differs between components, and it may have keys.
 */
static const pdyn_param gravity_param = {"gravity", PDYN_VECTOR, SETTING(gravity), false, 0,
                                         -1e6,      1e6,         "m/s^2",          ""};

const pdyn_param settings_general_params[] = {
    {"duration", PDYN_REAL, SETTING(duration), true, 0, 1e-6, 1e6, "s", "simulated time"},
    {"frame_interval", PDYN_REAL, SETTING(frame_interval), false, 1.0 / 30.0, 1e-6, 1e3, "s",
     "time between two frames of the output"},
    {0}};

const pdyn_param settings_time_step_params[] = {
    {"maximum", PDYN_REAL, SETTING(h_max), false, 0.005, 1e-9, 1e3, "s", "longest step"},
    {"minimum", PDYN_REAL, SETTING(h_min), false, 1e-5, 1e-9, 1e3, "s", "shortest step"},
    {"cfl", PDYN_REAL, SETTING(cfl), false, 1.0, 1e-3, 1e3, "1",
     "particle radii that a particle may travel in a step"},
    {"fixed", PDYN_REAL, SETTING(h_fixed), false, 0, 1e-9, 1e3, "s",
     "length of every step, instead of the other three"},
    {0}};

const pdyn_param settings_solver_params[] = {
    {"tolerance", PDYN_REAL, SETTING(tolerance), false, 0.1, 0, 1e3, "1",
     "a step is solved when |grad E| over weight (or impact) and load of every body falls below"},
    {"outer_iterations", PDYN_INT, SETTING(outer_iterations), false, 100, 1, 1e5, "",
     "local/global iterations of a step at most"},
    {"linear_tolerance", PDYN_REAL, SETTING(linear_tolerance), false, 0.01, 0, 0.9, "1",
     "a linear solve ends when its residual has fallen by this factor, or far enough for "
     "tolerance"},
    {"linear_iterations", PDYN_INT, SETTING(linear_iterations), false, 500, 1, 1e6, "",
     "iterations of a linear solve at most"},
    {"retries", PDYN_INT, SETTING(retries), false, 4, 0, 30, "",
     "attempts with shorter steps after one that diverged"},
    {0}};

/* ---- reading --------------------------------------------------------------------------------- */

/* A vector, or keys: then the scene is made for the largest of them. */
static pdyn_status read_gravity(const struct json_at *at, struct scene_settings *settings) {
    double *gravity = settings->gravity;
    pdyn_path *path = &settings->gravity_keys.path;
    gravity[1] = -9.81;
    if (!at->value) return PDYN_OK;
    pdyn_status status = keyed_refuse_rows(at, &gravity_param);
    if (status != PDYN_OK) return status;
    if (!keyed_given(at))
        return params_reals(at, 3, gravity_param.min, gravity_param.max, gravity_param.unit,
                            gravity);
    status = keyed_read_path(at, &gravity_param, path);
    gravity[1] = 0.0;
    for (int k = 0; k < path->count; k++)
        if (vec3_length(path->key + 4 * k + 1) > vec3_length(gravity))
            memcpy(gravity, path->key + 4 * k + 1, 3 * sizeof *gravity);
    return status;
}

static bool points_along_minus_z(const double g[3]) { return -g[2] > fmax(fabs(g[0]), fabs(g[1])); }

static pdyn_status read_general(struct reader *r, const struct json_at *root) {
    struct scene_settings *settings = &r->scene->settings;
    struct json_at name = json_member(root, "name"), gravity = json_member(root, "gravity");
    struct json_at schema = json_member(root, "$schema");
    if (name.value && !json_is_string(name.value)) return json_expected(&name, "a text");
    if (schema.value && !json_is_string(schema.value)) return json_expected(&schema, "a text");
    r->scene->name = context_copy_text(r->context, name.value ? json_string_value(name.value) : "");
    if (!r->scene->name) return PDYN_NO_MEMORY;
    pdyn_status status = params_read(root, settings_general_params, NULL, settings);
    if (status == PDYN_OK) status = read_gravity(&gravity, settings);
    settings->z_up = points_along_minus_z(settings->gravity);
    return status;
}

/* Reads the alternative named at `key` of an object; default: the first one. */
static pdyn_status read_named(const struct json_at *object, const char *key,
                              const struct choices *choices, const void **chosen) {
    struct json_at at = json_member(object, key);
    const char *names[READER_NAMES];
    int k = 0;
    for (int n = 0; n < choices->count; n++) names[n] = choices_text(choices, n, 0);
    pdyn_status status = reader_choice(&at, key, names, choices->count, &k);
    *chosen = choices_entry(choices, k);
    return status;
}

static pdyn_status read_time_step(struct reader *r, const struct json_at *at) {
    const void *chosen;
    static const char *const others[] = {"integrator", NULL}, *const excluded[] = {
                                                                  "maximum", "minimum", "cfl"};
    struct scene_settings *settings = &r->scene->settings;
    pdyn_status status =
        at->value ? params_check_keys(at, settings_time_step_params, others) : PDYN_OK;
    if (status == PDYN_OK) status = params_read(at, settings_time_step_params, NULL, settings);
    if (status == PDYN_OK) status = read_named(at, "integrator", &integrator_choices, &chosen);
    if (status == PDYN_OK) settings->integrator = chosen;
    if (status != PDYN_OK) return status;
    for (int k = 0; settings->h_fixed > 0.0 && k < 3; k++) {
        struct json_at other = json_member(at, excluded[k]);
        if (other.value)
            return json_fail_at_key(&other, "\"%s\" has no meaning beside \"fixed\"", excluded[k]);
    }
    if (settings->h_fixed > 0.0 || settings->h_min <= settings->h_max) return PDYN_OK;
    return json_fail(at, "expected a minimum of at most the maximum, found %.10g and %.10g s",
                     settings->h_min, settings->h_max);
}

static pdyn_status check_built(const pdyn_context *context, const struct json_at *type) {
    const char *name = json_string_value(type->value), *library = registry_absent(context, name);
    if (!library) return PDYN_OK;
    return json_fail(type, "this build has no solver \"%s\" (built without %s)", name, library);
}

static pdyn_status read_solver(struct reader *r, const struct json_at *at) {
    static const char *const others[] = {"type", "step", NULL}, *const steps[] = {"newton",
                                                                                  "projective"};
    const char *types[READER_NAMES] = {"auto"};
    struct json_at type = json_member(at, "type"), step = json_member(at, "step");
    struct scene_settings *settings = &r->scene->settings;
    int count = 1, chosen_type = 0, chosen_step = 0;
    for (int k = 0; registry_solver_at(r->context, k) && count < READER_NAMES; k++)
        types[count++] = registry_solver_at(r->context, k)->name;
    pdyn_status status =
        at->value ? params_check_keys(at, settings_solver_params, others) : PDYN_OK;
    if (status == PDYN_OK) status = params_read(at, settings_solver_params, NULL, settings);
    if (status == PDYN_OK) status = check_built(r->context, &type);
    if (status == PDYN_OK) status = reader_choice(&type, "solver", types, count, &chosen_type);
    if (status == PDYN_OK) status = reader_choice(&step, "step", steps, 2, &chosen_step);
    settings->newton = chosen_step == 0;
    snprintf(settings->solver_type, sizeof settings->solver_type, "%s", types[chosen_type]);
    return status;
}

static pdyn_status read_kernel(const struct json_at *root, struct scene_settings *settings) {
    struct json_at at = json_member(root, "kernel");
    const void *chosen;
    pdyn_status status = read_named(root, "kernel", &kernel_choices, &chosen);
    settings->kernel = chosen;
    if (status == PDYN_OK && chosen != choices_entry(&kernel_choices, 0) &&
        settings->boundary != choices_entry(&boundary_choices, 0))
        return json_fail(&at, "this kernel needs \"boundary\": \"%s\"",
                         choices_text(&boundary_choices, 0, 0));
    return status;
}

pdyn_status settings_read(struct reader *r, const struct json_at *root) {
    const void *chosen;
    struct json_at time_step = json_member(root, "time_step"), solver = json_member(root, "solver");
    pdyn_status status = read_general(r, root);
    if (status == PDYN_OK) status = read_named(root, "boundary", &boundary_choices, &chosen);
    if (status == PDYN_OK) r->scene->settings.boundary = chosen;
    if (status == PDYN_OK) status = read_kernel(root, &r->scene->settings);
    if (status == PDYN_OK) status = read_time_step(r, &time_step);
    return status == PDYN_OK ? read_solver(r, &solver) : status;
}
