/* Codes the state of a simulation for the page. */
#include "frame.h"
#include "projdyn/control.h"
#include "replay_filled.h"
#include "replay_planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- bytes ----------------------------------------------------------------------------------- */

/* Room for `size` bytes at the end, padded to a multiple of 4; NULL if memory ran out. */
static unsigned char *append(struct bytes *out, size_t size) {
    size_t padded = (size + 3) / 4 * 4;
    if (out->size + padded > out->capacity) {
        size_t capacity = 2 * out->capacity + padded;
        unsigned char *data = realloc(out->data, capacity);
        if (!data) return NULL;
        out->data = data;
        out->capacity = capacity;
    }
    unsigned char *at = memset(out->data + out->size, 0, padded);
    out->size += padded;
    return at;
}

/* ---- points ---------------------------------------------------------------------------------- */

static bool is_live(const pdyn_state *state, int i) { return !state->live || state->live[i]; }

static bool make_arrays(struct vtk_frame *frame, int count, bool values) {
    size_t n = (size_t)count + 1; /* + 1: there may be no point */
    *frame = (struct vtk_frame){.count = count, .x = malloc(3 * n * sizeof *frame->x)};
    if (!values) return frame->x;
    frame->velocity = malloc(3 * n * sizeof *frame->velocity);
    frame->density = malloc(n * sizeof *frame->density);
    frame->pressure = malloc(n * sizeof *frame->pressure);
    return frame->x && frame->velocity && frame->density && frame->pressure;
}

/* The live particles of a body with their values; false if memory ran out. */
static bool take_body(const pdyn_sim *sim, int body, struct vtk_frame *frame) {
    pdyn_state state = pdyn_get_state(sim);
    pdyn_body_info info = pdyn_get_body(sim, body);
    if (!make_arrays(frame, info.live, true)) return false;
    for (int i = info.first, n = 0; i < info.first + info.count; i++) {
        if (!is_live(&state, i)) continue;
        for (int k = 0; k < 3; k++) {
            frame->x[3 * n + k] = (float)state.x[3 * i + k];
            frame->velocity[3 * n + k] = (float)state.v[3 * i + k];
        }
        frame->density[n] = (float)state.density[i];
        frame->pressure[n++] = (float)state.pressure[i];
    }
    return true;
}

static bool take_solid(const pdyn_sim *sim, int solid, struct vtk_frame *frame) {
    int count = pdyn_solid_vertices(sim, solid, NULL);
    double *x = malloc(3 * (size_t)count * sizeof *x);
    bool good = x && make_arrays(frame, count, false);
    if (good) pdyn_solid_vertices(sim, solid, x);
    for (int i = 0; i < 3 * count && good; i++) frame->x[i] = (float)x[i];
    free(x);
    return good;
}

/* The boundary points on moving solids: the last ones. */
static bool take_boundary(const pdyn_sim *sim, struct vtk_frame *frame) {
    pdyn_state state = pdyn_get_state(sim);
    const double *x = state.boundary_x + 3 * (state.boundary - state.moving);
    if (!make_arrays(frame, state.moving, false)) return false;
    for (int i = 0; i < 3 * state.moving; i++) frame->x[i] = (float)x[i];
    return true;
}

/* index: of the part among those of its kind */
static bool take_part(const pdyn_sim *sim, enum part_kind kind, int index,
                      struct vtk_frame *frame) {
    *frame = (struct vtk_frame){0};
    if (kind == BODY) return take_body(sim, index, frame);
    return kind == SOLID ? take_solid(sim, index, frame) : take_boundary(sim, frame);
}

/* ---- coding ---------------------------------------------------------------------------------- */

static bool code_points(const struct vtk_frame *frame, const struct box *box, struct bytes *out) {
    uint16_t *x = (uint16_t *)(void *)append(out, 6 * (size_t)frame->count);
    if (!x) return false;
    for (int i = 0; i < 3 * frame->count; i++)
        x[i] = replay_code_position(frame, box, i / 3, i % 3);
    return true;
}

/* Codes the values of a channel up to the largest, *most. */
static bool code_channel(const struct part *part, const struct vtk_frame *frame,
                         enum channel channel, const double *filled, double *most,
                         struct bytes *out) {
    unsigned char *values = append(out, (size_t)frame->count);
    if (!values) return false;
    *most = 0.0;
    for (int i = 0; i < frame->count; i++)
        *most = fmax(*most, replay_value(part, frame, channel, i));
    for (int i = 0; i < frame->count; i++)
        values[i] = (unsigned char)replay_code_value(part, frame, channel, filled, *most, i);
    return true;
}

static json_t *part_to_json(const struct part *part, const struct vtk_frame *frame,
                            const struct box *box, const double most[CHANNELS]) {
    json_t *values = json_array();
    for (int c = 0; c < part->channels; c++) json_array_append_new(values, json_real(most[c]));
    return json_pack("{s:i, s:[[f,f,f],[f,f,f]], s:o}", "points", frame->count, "box", box->min[0],
                     box->min[1], box->min[2], box->max[0], box->max[1], box->max[2], "most",
                     values);
}

/* Appends the numbers of a part to `out` and its ranges to `parts`. */
static bool code_part(const struct part *part, const struct vtk_frame *frame, json_t *parts,
                      struct bytes *out) {
    struct box box = box_empty;
    double most[CHANNELS];
    double *filled = part->fluid ? replay_find_filled(frame, part->radius) : NULL;
    vtk_frame_extend_box(&box, frame);
    if (!frame->count) box = (struct box){0};
    bool good = (filled || !part->fluid) && code_points(frame, &box, out);
    for (int c = 0; c < part->channels && good; c++)
        good = code_channel(part, frame, (enum channel)c, filled, &most[c], out);
    free(filled);
    return good && !json_array_append_new(parts, part_to_json(part, frame, &box, most));
}

/* All parts that move, in the order of the page. */
static bool code_parts(const struct live *live, json_t *parts, struct bytes *out) {
    int index[BOUNDARY + 1] = {0};
    bool good = parts;
    for (int p = 0; p < live->run.parts && good; p++) {
        const struct part *part = &live->run.part[p];
        struct vtk_frame frame;
        int own = index[part->kind]++;
        if (part->rest) continue;
        good = take_part(live->sim, part->kind, own, &frame) && code_part(part, &frame, parts, out);
        vtk_frame_free(&frame);
    }
    return good;
}

/* ---- the JSON text --------------------------------------------------------------------------- */

static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

/* A row of the plots: the columns that the page has for a replay, too (replay_metrics.c). */
static json_t *row_to_json(const pdyn_step_info *step) {
    return json_pack(
        "{s:o, s:i, s:i, s:o, s:o, s:o, s:o, s:o}", "time_s", number(step->time),
        "outer_iterations", step->outer_iterations, "linear_iterations", step->linear_iterations,
        "density_error_mean", number(step->density_error_mean), "density_error_max",
        number(step->density_error_max), "kinetic_J", number(step->kinetic_energy), "potential_J",
        number(step->potential_energy), "constraint_J", number(step->constraint_energy));
}

static json_t *warnings_to_json(const pdyn_sim *sim) {
    json_t *list = json_array();
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++)
        json_array_append_new(list,
                              json_pack("{s:s, s:s, s:s, s:o}", "code", w.code, "subject",
                                        w.subject, "text", w.text, "first_s", number(w.first)));
    return list;
}

static void add_parameters(const pdyn_sim *sim, int constraint, json_t *list) {
    pdyn_constraint_info c = pdyn_get_constraint(sim, constraint);
    pdyn_parameter_info p;
    for (int k = 0; (p = pdyn_get_parameter(sim, constraint, k)).name; k++)
        if (p.changeable)
            json_array_append_new(list, json_pack("{s:i, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:s}",
                                                  "constraint", constraint, "type", c.type, "body",
                                                  c.body, "name", p.name, "unit", p.unit, "value",
                                                  number(p.value), "minimum", number(p.minimum),
                                                  "maximum", number(p.maximum), "doc", p.doc));
}

static json_t *parameters_to_json(const pdyn_sim *sim) {
    json_t *list = json_array();
    for (int c = 0; c < pdyn_get_state(sim).constraints; c++) add_parameters(sim, c, list);
    return list;
}

static json_t *gravity_to_json(const pdyn_sim *sim) {
    double g[3];
    pdyn_get_gravity(sim, g);
    return json_pack("[f,f,f]", g[0], g[1], g[2]);
}

/* Adds a member unless the page knows its value. */
static void tell(struct live *live, json_t *head, const char *name, json_t *value) {
    if (!json_equal(json_object_get(live->told, name), value)) {
        json_object_set(head, name, value);
        json_object_set(live->told, name, value);
    }
    json_decref(value);
}

static json_t *head_to_json(struct live *live, json_t *parts) {
    json_t *head = json_pack(
        "{s:f, s:i, s:I, s:f, s:f, s:b, s:b, s:b, s:O, s:O}", "time", pdyn_time(live->sim),
        "starts", live->starts, "steps", (json_int_t)live->steps, "h", live->step.h, "step_ms",
        live->step_ms, "running", live->running && !live->single, "real_time", live->real_time,
        "failed", live->failed, "notes", live->notes, "parts", parts);
    if (!head) return NULL;
    if (live->steps) json_object_set_new(head, "row", row_to_json(&live->step));
    tell(live, head, "warnings", warnings_to_json(live->sim));
    tell(live, head, "parameters", parameters_to_json(live->sim));
    tell(live, head, "gravity", gravity_to_json(live->sim));
    return head;
}

/* Length and text of the head, then the numbers. */
static bool join(json_t *head, const struct bytes *numbers, struct bytes *out) {
    char *text = head ? json_dumps(head, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    size_t length = text ? (strlen(text) + 3) / 4 * 4 : 0;
    unsigned char *at = text ? append(out, 4 + length + numbers->size) : NULL;
    if (at) {
        for (int k = 0; k < 4; k++) at[k] = (unsigned char)(length >> 8 * k);
        memset(at + 4, ' ', length);
        memcpy(at + 4, text, strlen(text));
        memcpy(at + 4 + length, numbers->data, numbers->size);
    }
    free(text);
    return at;
}

bool frame_make(struct live *live, struct bytes *out) {
    struct bytes numbers = {0};
    json_t *parts = json_array(), *head = NULL;
    *out = (struct bytes){0};
    bool good = code_parts(live, parts, &numbers) && append(&numbers, 4);
    if (good) head = head_to_json(live, parts);
    good = good && join(head, &numbers, out);
    if (good) json_array_clear(live->notes);
    json_decref(head);
    json_decref(parts);
    free(numbers.data);
    return good;
}
