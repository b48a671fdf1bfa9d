/* Messages of the page: JSON objects with the member "do", the name of an action, and what it
 * needs:
 *
 *     {"do": "run"}, {"do": "pause"}, {"do": "step"}, {"do": "restart"}, {"do": "save"}
 *     {"do": "hello"}                                        a page that knows the first frame only
 *     {"do": "speed", "real_time": true}
 *     {"do": "hold", "particle": 7, "target": [0, 1, 0]}     m; one particle at a time
 *     {"do": "release"}
 *     {"do": "set", "constraint": 0, "name": "stretching_stiffness", "value": 2000}
 *     {"do": "gravity", "value": [0, -9.81, 0]}              m/s^2 */
#include "live.h"
#include "projdyn/box.h"
#include "projdyn/control.h"
#include "projdyn/vec3.h"
#include "save.h"

#include <math.h>
#include <string.h>

static void check(struct live *live, pdyn_status status) {
    live->stale = true;
    if (status != PDYN_OK) live_note(live, true, "%s", pdyn_last_error(live->context));
}

/* ---- the simulation -------------------------------------------------------------------------- */

static void release(struct live *live, const json_t *message) {
    (void)message;
    if (live->held >= 0) check(live, pdyn_release(live->sim, live->held));
    live->held = -1;
}

static void hello(struct live *live, const json_t *message) {
    release(live, message);
    json_object_clear(live->told);
    live->stale = true;
}

static void run(struct live *live, const json_t *message) {
    (void)message;
    live->running = !live->failed;
    live->stale = true;
}

static void pause(struct live *live, const json_t *message) {
    (void)message;
    live->running = live->single = false;
    live->stale = true;
}

static void step(struct live *live, const json_t *message) {
    (void)message;
    live->running = live->single = !live->failed;
}

static void restart(struct live *live, const json_t *message) {
    (void)message;
    live_restart(live);
}

static void speed(struct live *live, const json_t *message) {
    live->real_time = json_is_true(json_object_get(message, "real_time"));
    live->clock_s = wall_seconds() - pdyn_time(live->sim);
    live->stale = true;
}

/* ---- changes --------------------------------------------------------------------------------- */

static bool get_vector(const json_t *message, const char *name, double v[3]) {
    return !json_unpack((json_t *)message, "{s:[F,F,F]}", name, v, v + 1, v + 2);
}

/* The number of the body that a particle belongs to; behind the last one: none. */
static int find_body(const pdyn_sim *sim, int particle) {
    pdyn_body_info body;
    int b = 0;
    while ((body = pdyn_get_body(sim, b)).name &&
           (particle < body.first || particle >= body.first + body.count))
        b++;
    return b;
}

/* Diagonal of the box around a body at rest, m. */
static double size_of(const pdyn_body_info *body) {
    struct box box = box_around(body->rest, body->count);
    return vec3_distance(box.min, box.max);
}

/* Stiffness of a hold, N/m: ten times that of the inertia of a vertex over a step, m / h^2, and
 * enough to carry the body with a stretch of a hundredth of its size. */
static double hold_stiffness(const struct live *live, int particle) {
    int b = find_body(live->sim, particle), end = body_end(live->sim, b);
    pdyn_body_info body = pdyn_get_body(live->sim, b);
    pdyn_state state = pdyn_get_state(live->sim);
    double gravity[3], mass = 0.0;
    double h = live->step.h > 0.0 ? live->step.h : pdyn_frame_interval(live->sim);
    pdyn_get_gravity(live->sim, gravity);
    for (int i = body.first; i < end; i++) mass += state.mass[i];
    double weight = mass * fmax(9.81, vec3_length(gravity));
    return fmax(10.0 * mass / body.count / (h * h), 100.0 * weight / size_of(&body));
}

static void hold(struct live *live, const json_t *message) {
    int particle;
    double target[3];
    if (json_unpack((json_t *)message, "{s:i}", "particle", &particle) ||
        !get_vector(message, "target", target) ||
        !pdyn_get_body(live->sim, find_body(live->sim, particle)).triangles) {
        live_note(live, true, "hold: expected a \"particle\" of a surface and its \"target\"");
        return;
    }
    if (live->held != particle) release(live, message);
    live->held = particle;
    check(live, pdyn_hold(live->sim, particle, hold_stiffness(live, particle), target));
}

static void set(struct live *live, const json_t *message) {
    const char *name;
    double value;
    int constraint;
    if (json_unpack((json_t *)message, "{s:i, s:s, s:F}", "constraint", &constraint, "name", &name,
                    "value", &value))
        live_note(live, true, "set: expected \"constraint\", \"name\" and \"value\"");
    else check(live, pdyn_set_parameter(live->sim, constraint, name, &value, 1));
}

static void gravity(struct live *live, const json_t *message) {
    double value[3];
    if (get_vector(message, "value", value)) check(live, pdyn_set_gravity(live->sim, value));
    else live_note(live, true, "gravity: expected a \"value\" of three numbers");
}

static void save(struct live *live, const json_t *message) {
    (void)message;
    save_run(live);
}

/* ---- dispatch -------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    void (*act)(struct live *live, const json_t *message);
} actions[] = {{"hello", hello},     {"run", run},         {"pause", pause}, {"step", step},
               {"restart", restart}, {"speed", speed},     {"hold", hold},   {"release", release},
               {"set", set},         {"gravity", gravity}, {"save", save}};

void live_act(struct live *live, const json_t *message) {
    const char *name = json_string_value(json_object_get(message, "do"));
    for (size_t k = 0; k < sizeof actions / sizeof *actions; k++)
        if (name && !strcmp(name, actions[k].name)) {
            actions[k].act(live, message);
            return;
        }
    live_note(live, true, "expected an action in \"do\", found \"%.40s\"", name ? name : "");
}
