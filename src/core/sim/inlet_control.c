#include "inlet_control.h"

#include "base/bad_call.h"
#include "given_motion.h"
#include "live_particles.h"
#include "scene/inlet_motion.h"
#include "scene/keyed.h"

#include "projdyn/control.h"

#include <math.h>
#include <stdio.h>

int pdyn_inlets(const pdyn_sim *sim, int body) {
    return sim && body >= 0 && body < sim->bodies ? sim->scene.body[body].inlets : 0;
}

struct name {
    char text[128];
};

static struct name name_of(const struct pdyn_sim *sim, int body, int inlet) {
    struct name name;
    snprintf(name.text, sizeof name.text, "inlet %d of body \"%s\"", inlet, sim->body[body].name);
    return name;
}

/* Whether the simulation has failed, or there is no such inlet. */
static bool bad_inlet(const char *function, const pdyn_sim *sim, int body, int inlet) {
    return control_refuses(function, sim) || call_bad_index(function, "body", body, sim->bodies) ||
           call_bad_index(function, "inlet", inlet, pdyn_inlets(sim, body));
}

pdyn_status pdyn_move_inlet(pdyn_sim *sim, int body, int inlet, double time,
                            const double translate[3], const double rotate[3]) {
    if (HAS_NULL(sim, translate, rotate) || bad_inlet(__func__, sim, body, inlet))
        return PDYN_BAD_CALL;
    struct scene_key to = given_key(time, translate, rotate);
    return given_motion(sim, &sim->scene.body[body].inlet[inlet].motion,
                        name_of(sim, body, inlet).text, &to);
}

/* ---- speed ----------------------------------------------------------------------------------- */

static pdyn_status check_speed(struct pdyn_sim *sim, const struct scene_inlet *inlet,
                               const char *what, double time, double speed) {
    if (!(speed >= 0.0 && speed <= INLET_MAX_SPEED))
        return set_error(PDYN_BAD_INPUT, "%s: expected a speed from 0 to %g m/s, found %g", what,
                         INLET_MAX_SPEED, speed);
    if (!(fabs(time) <= SCENE_MAX_TIME))
        return set_error(PDYN_BAD_INPUT, "%s: expected a time from -1e6 to 1e6 s, found %g", what,
                         time);
    if (sim->time >= inlet->end)
        return set_error(PDYN_BAD_INPUT, "%s: its \"duration\" has ended at %g s", what,
                         inlet->end);
    return PDYN_OK;
}

pdyn_status pdyn_set_inlet_speed(pdyn_sim *sim, int body, int inlet, double time, double speed) {
    if (HAS_NULL(sim) || bad_inlet(__func__, sim, body, inlet)) return PDYN_BAD_CALL;
    struct scene_inlet *set = &sim->scene.body[body].inlet[inlet];
    pdyn_status status = check_speed(sim, set, name_of(sim, body, inlet).text, time, speed);
    bool later = time > sim->time;
    double now = inlet_speed(set, sim->time), travelled = inlet_travelled(set, sim->time);
    const double key[8] = {sim->time, later ? now : speed, 0.0, 0.0, time, speed};
    if (status == PDYN_OK) status = keyed_set_path(sim->context, &set->speed, key, later ? 2 : 1);
    if (status != PDYN_OK) return status;
    if (travelled >= 0.0) set->travelled = travelled, set->start = sim->time;
    sim->control.driven = true;
    return PDYN_OK;
}

/* ---- saved states ---------------------------------------------------------------------------- */

static void persist_speed(struct pdyn_sim *sim, pdyn_path *speed, struct snapshot_file *file) {
    keyed_persist_path(sim->context, speed, file);
    snapshot_file_require(file, speed->count > 0, "an inlet has no speed");
    for (int k = 0; k < speed->count; k++)
        snapshot_file_require(file, speed->key[4 * k + 1] >= 0.0, "a speed of a key");
}

void inlet_control_persist(struct pdyn_sim *sim, int inlet, struct snapshot_file *file) {
    struct scene_inlet *from = sim->live->inlet[inlet].from;
    given_motion_persist(sim, &from->motion, file);
    persist_speed(sim, &from->speed, file);
    snapshot_file_range(file, &from->start, 1, SCENE_MAX_TIME, "the start of an inlet");
    snapshot_file_range(file, &from->travelled, 1, STEP_MAX_POSITION, "the way of an inlet");
}
