/* Reading a body: what all kinds have, then its kind, then its constraints. */
#include "scene_body.h"
#include "params.h"

const pdyn_param scene_body_params[] = {{"velocity", PDYN_VECTOR,
                                         offsetof(struct scene_body, velocity), false, 0, -1e6, 1e6,
                                         "m/s", ""},
                                        {0}};
const char *const scene_body_others[] = {"name",   "color", "particles",   "surface",
                                         "volume", "rigid", "constraints", NULL};
const struct scene_kind *const scene_kinds[SCENE_KINDS] = {&scene_particles, &scene_surface,
                                                           &scene_volume, &scene_rigid};

static pdyn_status read_kind(struct reader *r, const struct json_at *owner) {
    const char *names[SCENE_KINDS];
    int found;
    for (int k = 0; k < SCENE_KINDS; k++) names[k] = scene_kinds[k]->name;
    pdyn_status status = reader_one_of(owner, names, SCENE_KINDS, &found);
    if (status != PDYN_OK) return status;
    const struct scene_kind *kind = scene_kinds[found];
    struct json_at at = json_member(owner, kind->name);
    status = params_check_keys(&at, kind->params, kind->others);
    if (status == PDYN_OK) status = params_read(&at, kind->params, NULL, r->body);
    return status == PDYN_OK ? kind->read(r, &at) : status;
}

pdyn_status scene_read_body(struct reader *r, const struct json_at *at, int index) {
    struct scene_body *body = r->body = &r->scene->body[index];
    struct json_at constraints = json_member(at, "constraints");
    pdyn_status status = params_check_keys(at, scene_body_params, scene_body_others);
    if (status == PDYN_OK) status = reader_name(r, at, "body", index, &body->name);
    if (status == PDYN_OK) status = reader_color(at, body->color);
    if (status == PDYN_OK) status = params_read(at, scene_body_params, NULL, body);
    if (status == PDYN_OK) status = read_kind(r, at);
    return status == PDYN_OK ? scene_read_constraints(r, &constraints) : status;
}
