/* Metadata of a replay page as JSON. */
#include "replay_page.h"
#include "replay_strings.h"

static json_t *box_to_json(const struct box *box) {
    return json_pack("[[f,f,f],[f,f,f]]", box->min[0], box->min[1], box->min[2], box->max[0],
                     box->max[1], box->max[2]);
}

static json_t *frame_points_to_json(const struct run *run, const struct part *part) {
    json_t *points = json_array();
    for (int f = 0; f < part_frames(run, part); f++)
        json_array_append_new(points, json_integer(part->frame_points[f]));
    return points;
}

/* Largest values of a part's channels, by the names that the page has for them. */
static json_t *most_to_json(const struct part *part) {
    static const char *const names[CHANNELS] = {"speed", "error", "pressure", "filled"};
    json_t *most = json_object();
    for (int c = 0; c < part->channels; c++)
        json_object_set_new(most, names[c], json_real(part->most[c]));
    return most;
}

static json_t *part_to_json(const struct run *run, const struct part *part) {
    return json_pack("{s:s, s:s?, s:s*, s:b, s:b, s:i, s:o, s:i, s:o, s:f, s:o}", "name",
                     part->name, "kind", part->shape, "color", part->color, "rest", part->rest,
                     "fluid", part->fluid, "count", part->count, "points",
                     frame_points_to_json(run, part), "triangles", part->triangles, "box",
                     box_to_json(&part->box), "radius", part->radius, "most", most_to_json(part));
}

/* Array of the parts of one kind; NULL if memory ran out. */
static json_t *parts_to_json(const struct run *run, enum part_kind kind) {
    json_t *parts = json_array();
    int failed = 0;
    for (int p = 0; p < run->parts; p++)
        if (run->part[p].kind == kind)
            failed |= json_array_append_new(parts, part_to_json(run, &run->part[p]));
    if (!failed) return parts;
    json_decref(parts);
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
    json_t *times = json_array();
    for (int f = 0; f < run->frames; f++)
        json_array_append_new(times, json_real(part_time(&run->part[0], f)));
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:O?, s:O*, s:O*, s:o}", "about",
                     facts_to_json(run), "times", times, "bodies", parts_to_json(run, BODY),
                     "solids", parts_to_json(run, SOLID), "boundary", parts_to_json(run, BOUNDARY),
                     "warnings", warnings_to_json(run), "metrics", run->metrics, "live", run->live,
                     "up", json_object_get(run->report, "up"), "strings", replay_strings(run));
}
