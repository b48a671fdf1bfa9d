/* Reading a body: what all kinds have, then its kind, then its constraints. */
#include "scene_body.h"
#include "params.h"

static const pdyn_param body_params[] = {{"velocity", PDYN_VECTOR,
                                          offsetof(struct scene_body, velocity), false, 0, -1e6,
                                          1e6, "m/s", ""},
                                         {0}};

pdyn_status scene_read_body(struct reader *r, const struct json_at *at, int index) {
    static const char *const others[] = {"name",   "color", "particles",   "surface",
                                         "volume", "rigid", "constraints", NULL};
    static const char *const kinds[] = {"particles", "surface", "volume", "rigid"};
    static scene_read_kind_fn *const readers[] = {scene_read_particles, scene_read_surface,
                                                  scene_read_volume, scene_read_rigid};
    int kind;
    struct scene_body *body = r->body = &r->scene->body[index];
    struct json_at constraints = json_member(at, "constraints");
    pdyn_status status = params_check_keys(at, body_params, others);
    if (status == PDYN_OK) status = reader_name(r, at, "body", index, &body->name);
    if (status == PDYN_OK) status = reader_color(at, body->color);
    if (status == PDYN_OK) status = reader_one_of(at, kinds, 4, &kind);
    if (status == PDYN_OK) status = params_read(at, body_params, NULL, body);
    if (status != PDYN_OK) return status;
    struct json_at body_at = json_member(at, kinds[kind]);
    status = readers[kind](r, &body_at);
    return status == PDYN_OK ? scene_read_constraints(r, &constraints) : status;
}
