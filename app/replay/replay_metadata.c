/* Metadata of a replay page as JSON. */
#include "replay_page.h"

static json_t *box_to_json(const struct box *box) {
    return json_pack("[[f,f,f],[f,f,f]]", box->min[0], box->min[1], box->min[2], box->max[0],
                     box->max[1], box->max[2]);
}

static json_t *frame_points_to_json(const struct run *run, const struct body *body) {
    json_t *points = json_array();
    for (int f = 0; f < run->frames; f++)
        json_array_append_new(points, json_integer(body->frame_points[f]));
    return points;
}

/* Array of the bodies; NULL if memory ran out. */
static json_t *bodies_to_json(const struct run *run) {
    json_t *bodies = json_array();
    int failed = 0;
    for (int b = 0; b < run->body_count; b++) {
        const struct body *body = &run->body[b];
        failed |= json_array_append_new(
            bodies,
            json_pack("{s:s, s:i, s:o, s:i, s:f, s:b, s:f, s:f}", "name", body->name, "count",
                      body->count, "points", frame_points_to_json(run, body), "triangles",
                      body->triangles, "radius", body->radius, "density", body->rest_density > 0.0,
                      "max_speed", body->max_speed, "max_error", body->max_error));
    }
    if (!failed) return bodies;
    json_decref(bodies);
    return NULL;
}

/* Facts of report.json for the page's header line; missing ones are left out. */
static json_t *facts_to_json(const struct run *run) {
    static const char *const keys[] = {"name",    "scene",       "version",
                                       "threads", "simulated_s", "wall_s"};
    json_t *facts = json_object();
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        json_t *value = json_object_get(run->report, keys[k]);
        if (json_is_string(value) || json_is_number(value)) json_object_set(facts, keys[k], value);
    }
    const json_t *step = json_object_get(run->report, "time_step");
    json_t *integrator = json_object_get(step, "integrator");
    if (json_is_string(integrator)) json_object_set(facts, "integrator", integrator);
    return facts;
}

/* The warnings of report.json that have the members the page shows; NULL if memory ran out. */
static json_t *warnings_to_json(const struct run *run) {
    json_t *list = json_array(), *one;
    size_t k;
    json_array_foreach(json_object_get(run->report, "warnings"), k, one) {
        const char *code, *subject, *text;
        double first;
        if (json_unpack(one, "{s:s, s:s, s:s, s:F}", "code", &code, "subject", &subject, "text",
                        &text, "first_s", &first))
            continue;
        if (json_array_append(list, one)) return json_decref(list), NULL;
    }
    return list;
}

json_t *replay_metadata(const struct run *run) {
    json_t *times = json_array(), *boundary = json_null(), *moving = json_null();
    for (int f = 0; f < run->frames; f++)
        json_array_append_new(times, json_real(replay_time(&run->body[0], f)));
    if (run->boundary.count)
        boundary = json_pack("{s:i, s:o}", "count", run->boundary.count, "box",
                             box_to_json(&run->boundary_box));
    if (run->part_count > run->body_count)
        moving = json_pack("{s:i}", "count", run->body[run->body_count].count);
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:O?}", "about", facts_to_json(run),
                     "times", times, "box", box_to_json(&run->box), "bodies", bodies_to_json(run),
                     "boundary", boundary, "moving", moving, "warnings", warnings_to_json(run),
                     "metrics", run->metrics);
}
