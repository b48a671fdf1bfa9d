/* Reading a body of particles: volumes to fill, and inlets. */
#include "fill.h"
#include "inlet.h"
#include "inlet_motion.h"
#include "scene_body.h"

#include <math.h>

static const pdyn_param params[] = {
    {"radius", PDYN_REAL, offsetof(struct scene_body, radius), true, 0, 1e-6, 1e3, "m", ""},
    {"rest_density", PDYN_REAL, offsetof(struct scene_body, rest_density), false, 1000, 1e-3, 1e6,
     "kg/m^3", ""},
    {"budget", PDYN_INT, offsetof(struct scene_body, budget), false, 0, 1, MAX_PARTICLES, "", ""},
    {0}};

static pdyn_status read_fill(struct reader *r, const struct json_at *at, int index) {
    return fill_read(r, at, &r->body->fill[index]);
}

static pdyn_status read_inlet(struct reader *r, const struct json_at *at, int index) {
    return inlet_read(at, r->body, &r->body->inlet[index]);
}

/* Reads the number of particles that inlets may add. Default: all that they emit, and at least 1,
 * because the scene may end before an inlet starts. */
static pdyn_status read_budget(struct reader *r, const struct json_at *owner,
                               const struct json_at *inlets) {
    struct scene_body *body = r->body;
    struct json_at at = json_member(owner, "budget");
    double total = 0.0, end = r->scene->settings.duration;
    for (int k = 0; k < body->inlets; k++)
        total +=
            inlet_layers(&body->inlet[k], end, 2.0 * body->radius) * body->inlet[k].layer.count;
    if (body->inlets) total = fmax(total, 1.0);
    if (at.value && !body->inlets) return json_fail_at_key(&at, "\"budget\" needs \"inlets\"");
    pdyn_status status =
        reader_add_particles(r, at.value ? &at : inlets, at.value ? body->budget : total);
    if (status == PDYN_OK && !at.value) body->budget = (int)total;
    return status;
}

static pdyn_status read_inlets(struct reader *r, const struct json_at *owner) {
    struct scene_body *body = r->body;
    struct json_at array = json_member(owner, "inlets");
    pdyn_status status = reader_array(r, &array, "an array of inlets", read_inlet,
                                      sizeof *body->inlet, &body->inlet, &body->inlets);
    if (status != PDYN_OK) return status;
    inlet_note_areas(r->context, body);
    return read_budget(r, owner, &array);
}

static pdyn_status read_overlap(struct reader *r, const struct json_at *owner) {
    static const char *const names[] = {"remove", "keep"};
    struct json_at at = json_member(owner, "overlap");
    int keep = 0;
    if (!at.value) return PDYN_OK;
    pdyn_status status = reader_choice(&at, "overlap", names, 2, &keep);
    r->body->keep_overlap = keep;
    return status;
}

static pdyn_status read(struct reader *r, const struct json_at *at) {
    struct scene_body *body = r->body;
    struct json_at fill = json_member(at, "fill"), inlets = json_member(at, "inlets");
    pdyn_status status = reader_array(r, &fill, "an array of volumes to fill", read_fill,
                                      sizeof *body->fill, &body->fill, &body->fills);
    if (status == PDYN_OK && !body->fills && !json_array_size(inlets.value))
        status = json_expected(&fill, "at least one volume to fill, or \"inlets\"");
    if (status == PDYN_OK) status = read_overlap(r, at);
    return status == PDYN_OK ? read_inlets(r, at) : status;
}

static const char *const others[] = {"fill", "inlets", "overlap", NULL};
const struct scene_kind scene_particles = {"particles", params, others, read};
