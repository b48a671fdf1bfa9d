/* Reading a probe: what it measures, and where. */
#include "base/param_kind.h"
#include "params.h"
#include "reader.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { MAX_POINTS = 1000 }; /* of a line */

const pdyn_param scene_probe_params[] = {
    {"radius", PDYN_REAL, offsetof(struct scene_probe, radius), false, 0, 1e-9, 1e6, "m", ""},
    {"time", PDYN_REAL, offsetof(struct scene_probe, time), false, 0, 0, 1e6, "s", ""},
    {0}};

static pdyn_status read_place(const struct json_at *at, double x[3]) {
    return params_reals(at, 3, -SCENE_MAX_POSITION, SCENE_MAX_POSITION, "m", x);
}

static pdyn_status read_point(struct reader *r, const struct json_at *at,
                              struct scene_probe *probe) {
    double x[3];
    pdyn_status status = read_place(at, x);
    return status == PDYN_OK ? point_list_add(r->context, &probe->at, x) : status;
}

static pdyn_status read_line(struct reader *r, const struct json_at *at,
                             struct scene_probe *probe) {
    static const char *const keys[] = {"from", "to", "count", NULL};
    struct json_at from = json_member(at, "from"), to = json_member(at, "to");
    struct json_at number = json_member(at, "count");
    double start[3], end[3];
    int count = 0;
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = read_place(&from, start);
    if (status == PDYN_OK) status = read_place(&to, end);
    if (status == PDYN_OK) status = params_int(&number, 2, MAX_POINTS, &count);
    for (int k = 0; k < count && status == PDYN_OK; k++) {
        double x[3] = {0}, part = (double)k / (count - 1);
        vec3_add(x, 1.0 - part, start);
        vec3_add(x, part, end);
        status = point_list_add(r->context, &probe->at, x);
    }
    return status;
}

static pdyn_status read_wall(struct reader *r, const struct json_at *at,
                             struct scene_probe *probe) {
    if (!r->scene->solids && probe->on_body < 0)
        return json_fail_at_key(at, "\"wall\" needs a scene with solids, or \"on\" a rigid body");
    return read_point(r, at, probe);
}

static pdyn_status read_height(struct reader *r, const struct json_at *at,
                               struct scene_probe *probe) {
    if (vec3_length(r->scene->settings.gravity) == 0.0)
        return json_fail_at_key(at, "\"height\" needs gravity: it is measured against it");
    return read_point(r, at, probe);
}

static pdyn_status read_region(struct reader *r, const struct json_at *at,
                               struct scene_probe *probe) {
    (void)r;
    return params_box(at, &probe->box);
}

struct objects { /* all solids or all bodies of a scene */
    const char *kind;
    int count;
    const char *(*name)(const struct scene *scene, int k);
};

static const char *name_of_solid(const struct scene *scene, int s) { return scene->solid[s].name; }
static const char *name_of_body(const struct scene *scene, int b) { return scene->body[b].name; }

static struct objects solids_of(const struct scene *scene) {
    return (struct objects){"solid", scene->solids, name_of_solid};
}
static struct objects bodies_of(const struct scene *scene) {
    return (struct objects){"body", scene->bodies, name_of_body};
}

/* "on": the solid or the rigid body that carries the place of the probe. */
static pdyn_status read_on(struct reader *r, const struct json_at *at, struct scene_probe *probe) {
    const struct scene *scene = r->scene;
    int solids = scene->solids, count = solids, found = 0;
    probe->on_solid = probe->on_body = -1;
    if (!at->value) return PDYN_OK;
    const char **names = NEW_ARRAY(r->context, solids + scene->bodies, const char *);
    if (!names) return PDYN_NO_MEMORY;
    for (int s = 0; s < solids; s++) names[s] = scene->solid[s].name;
    for (int b = 0; b < scene->bodies; b++)
        if (scene->body[b].is_rigid) names[count++] = scene->body[b].name;
    pdyn_status status =
        count ? reader_choice(at, "solid or rigid body", names, count, &found)
              : json_fail_at_key(at, "\"on\" needs a scene with a solid or a rigid body");
    if (status == PDYN_OK && found < solids) probe->on_solid = found;
    for (int b = 0; status == PDYN_OK && found >= solids && b < scene->bodies; b++)
        if (scene->body[b].name == names[found]) probe->on_body = b;
    FREE_ARRAY(r->context, names, solids + scene->bodies);
    return status;
}

/* Refuses the name of a body where that of a solid is expected, or the reverse. others: those that
 * are not expected. */
static pdyn_status check_kind(struct reader *r, const struct json_at *at, struct objects others) {
    const char *word = json_string_value(at->value);
    for (int k = 0; word && k < others.count; k++)
        if (!strcmp(word, others.name(r->scene, k)))
            return json_fail(at, "\"%s\" is a %s, expected the key \"%s\"", word, others.kind,
                             others.kind);
    return PDYN_OK;
}

static pdyn_status read_target(struct reader *r, const struct json_at *at, struct objects among,
                               struct scene_probe *probe) {
    const char **names = NEW_ARRAY(r->context, among.count, const char *);
    if (!names) return PDYN_NO_MEMORY;
    for (int k = 0; k < among.count; k++) names[k] = among.name(r->scene, k);
    pdyn_status status = reader_choice(at, among.kind, names, among.count, &probe->target);
    FREE_ARRAY(r->context, names, among.count);
    return status;
}

static pdyn_status read_solid(struct reader *r, const struct json_at *at,
                              struct scene_probe *probe) {
    pdyn_status status = check_kind(r, at, bodies_of(r->scene));
    if (status != PDYN_OK) return status;
    if (!r->scene->solids) return json_fail_at_key(at, "\"solid\" needs a scene with solids");
    return read_target(r, at, solids_of(r->scene), probe);
}

static pdyn_status read_body(struct reader *r, const struct json_at *at,
                             struct scene_probe *probe) {
    pdyn_status status = check_kind(r, at, solids_of(r->scene));
    if (status != PDYN_OK) return status;
    return read_target(r, at, bodies_of(r->scene), probe);
}

/* The same of a body that has a constraint with this flag, such as `example`. */
static pdyn_status read_body_with(struct reader *r, const struct json_at *at, unsigned flag,
                                  const char *example, struct scene_probe *probe) {
    pdyn_status status = read_body(r, at, probe);
    if (status != PDYN_OK) return status;
    const struct scene_body *body = &r->scene->body[probe->target];
    for (int k = 0; k < body->constraints; k++)
        if (body->constraint[k].type->flags & flag) return PDYN_OK;
    return json_fail(at, "expected a body with a \"%s\"", example);
}

static pdyn_status read_pins(struct reader *r, const struct json_at *at,
                             struct scene_probe *probe) {
    return read_body_with(r, at, PDYN_REACTION, "pin", probe);
}

static pdyn_status read_inside(struct reader *r, const struct json_at *at,
                               struct scene_probe *probe) {
    return read_body_with(r, at, PDYN_ON_CLOSED, "gas", probe);
}

/* The constraints of the body that count. */
static int count_constraints(const struct reader *r, const struct scene_probe *probe) {
    const struct scene_body *body = &r->scene->body[probe->target];
    int count = 0;
    for (int k = 0; k < body->constraints; k++)
        count += scene_probe_counts(probe, body->constraint[k].type);
    return count;
}

/* "constraint": the type of those constraints of a "body" that count. */
static pdyn_status read_constraint(const struct reader *r, const struct json_at *at,
                                   struct scene_probe *probe) {
    const char *body = r->scene->body[probe->target].name;
    if (probe->source)
        return json_fail_at_key(at, "\"constraint\" and \"source\": expected one of them");
    pdyn_status status = reader_constraint_type(at, &probe->type);
    if (status != PDYN_OK) return status;
    if (!type_acts_from_outside(probe->type))
        return json_fail(at,
                         "expected a type that holds or pushes \"%s\" from outside, such as "
                         "\"pin\" or \"attachment\", found \"%s\"",
                         body, probe->type->name);
    if (!count_constraints(r, probe))
        return json_fail(
            at, "\"%s\" has no constraint \"%s\"; expected the body whose \"constraints\" have it",
            body, probe->type->name);
    probe->kind = PROBE_CONSTRAINT;
    return PDYN_OK;
}

/* "pin", "number": one of the constraints that count. */
static pdyn_status read_number(const struct reader *r, const struct json_at *at,
                               struct scene_probe *probe) {
    probe->number = -1;
    return at->value ? params_int(at, 0, count_constraints(r, probe) - 1, &probe->number) : PDYN_OK;
}

/* "source": what a load counts. */
static pdyn_status read_source(const struct json_at *at, struct scene_probe *probe) {
    static const char *const names[] = {"fluid", "contact"};
    if (!at->value) return PDYN_OK;
    if (probe->kind != PROBE_SOLID && probe->kind != PROBE_BODY)
        return json_fail_at_key(at, "\"source\" needs a \"solid\" or \"body\"");
    int found;
    pdyn_status status = reader_choice(at, "source", names, 2, &found);
    probe->source = found ? PDYN_LOAD_CONTACT : PDYN_LOAD_FLUID;
    return status;
}

static const char *const names[PROBE_KINDS] = {
    [PROBE_POINT] = "point",     [PROBE_LINE] = "line", [PROBE_WALL] = "wall",
    [PROBE_HEIGHT] = "height",   [PROBE_BOX] = "box",   [PROBE_SOLID] = "solid",
    [PROBE_CONSTRAINT] = "pins", [PROBE_BODY] = "body", [PROBE_INSIDE] = "inside"};

static const struct {
    pdyn_status (*read)(struct reader *r, const struct json_at *at, struct scene_probe *probe);
    bool of_fluid, has_radius; /* those of the fluid have a place */
} kinds[PROBE_KINDS] = {
    [PROBE_POINT] = {read_point, true, true},       [PROBE_LINE] = {read_line, true, true},
    [PROBE_WALL] = {read_wall, true, true},         [PROBE_HEIGHT] = {read_height, true, false},
    [PROBE_BOX] = {read_region, true, false},       [PROBE_SOLID] = {read_solid, false, false},
    [PROBE_CONSTRAINT] = {read_pins, false, false}, [PROBE_BODY] = {read_body, false, false},
    [PROBE_INSIDE] = {read_inside, false, false},
};

/* Checks that the scene and the other keys fit to the kind of the probe. */
static pdyn_status check_kind_of(const struct reader *r, const struct json_at *at,
                                 enum probe_kind kind) {
    struct json_at place = json_member(at, names[kind]), radius = json_member(at, "radius");
    struct json_at pin = json_member(at, "pin"), on = json_member(at, "on");
    struct json_at constraint = json_member(at, "constraint"), number = json_member(at, "number");
    if (kinds[kind].of_fluid && !r->listed)
        return json_fail_at_key(&place, "\"%s\" needs a body with the constraint \"fluid\"",
                                names[kind]);
    if (radius.value && !kinds[kind].has_radius)
        return json_fail_at_key(&radius, "\"radius\" needs a \"point\", \"line\" or \"wall\"");
    if (pin.value && kind != PROBE_CONSTRAINT)
        return json_fail_at_key(&pin, "\"pin\" needs \"pins\"");
    if (constraint.value && kind != PROBE_BODY)
        return json_fail_at_key(&constraint, "\"constraint\" needs a \"body\"");
    if (number.value && !constraint.value)
        return json_fail_at_key(&number, "\"number\" needs a \"constraint\"");
    if (on.value && !kinds[kind].of_fluid)
        return json_fail_at_key(&on, "\"on\" needs a \"point\", \"line\", \"wall\", \"height\" or "
                                     "\"box\"");
    return PDYN_OK;
}

pdyn_status scene_read_probe(struct reader *r, const struct json_at *at, int index) {
    static const char *const keys[] = {
        "name", "point",  "line", "wall",       "height", "box", "solid",  "pins",
        "pin",  "inside", "body", "constraint", "number", "on",  "source", NULL};
    struct scene_probe *probe = &r->scene->probe[index];
    struct json_at on = json_member(at, "on"), source = json_member(at, "source");
    struct json_at constraint = json_member(at, "constraint");
    pdyn_status status = params_check_keys(at, scene_probe_params, keys);
    if (status == PDYN_OK) status = reader_name(r, at, "probe", index, &probe->name);
    if (status == PDYN_OK) status = params_read(at, scene_probe_params, NULL, probe);
    if (status == PDYN_OK) status = reader_one_of(at, names, PROBE_KINDS, &probe->kind);
    if (status == PDYN_OK) status = check_kind_of(r, at, probe->kind);
    if (status != PDYN_OK) return status;
    struct json_at place = json_member(at, names[probe->kind]);
    struct json_at number = json_member(at, constraint.value ? "number" : "pin");
    status = read_on(r, &on, probe);
    if (status == PDYN_OK) status = read_source(&source, probe);
    if (status == PDYN_OK) status = kinds[probe->kind].read(r, &place, probe);
    if (status == PDYN_OK && constraint.value) status = read_constraint(r, &constraint, probe);
    return status == PDYN_OK ? read_number(r, &number, probe) : status;
}
