#include "inlet_control.h"

#include "given_motion.h"
#include "live_particles.h"
#include "scene/inlet_motion.h"

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

pdyn_status pdyn_move_inlet(pdyn_sim *sim, int body, int inlet, double time,
                            const double translate[3], const double rotate[3]) {
    if (inlet < 0 || inlet >= pdyn_inlets(sim, body) || !translate || !rotate) return PDYN_BAD_CALL;
    struct scene_key to = given_key(time, translate, rotate);
    return given_motion(sim, &sim->scene.body[body].inlet[inlet].motion,
                        name_of(sim, body, inlet).text, &to);
}

/* ---- speed ----------------------------------------------------------------------------------- */

static pdyn_status check_speed(struct pdyn_sim *sim, const struct scene_inlet *inlet,
                               const char *what, double time, double speed) {
    pdyn_status status = control_check(sim);
    if (status != PDYN_OK) return status;
    if (!(speed >= 0.0 && speed <= INLET_MAX_SPEED))
        return context_fail(sim->context, PDYN_BAD_INPUT,
                            "%s: expected a speed from 0 to %g m/s, found %g", what,
                            INLET_MAX_SPEED, speed);
    if (!(fabs(time) <= SCENE_MAX_POSITION))
        return context_fail(sim->context, PDYN_BAD_INPUT,
                            "%s: expected a time from -1e6 to 1e6 s, found %g", what, time);
    if (sim->time >= inlet->end)
        return context_fail(sim->context, PDYN_BAD_INPUT, "%s: its \"duration\" has ended at %g s",
                            what, inlet->end);
    return PDYN_OK;
}

static pdyn_status resize_speeds(struct pdyn_sim *sim, struct scene_inlet *inlet, int count) {
    if (count == inlet->speeds) return PDYN_OK;
    struct scene_speed *speed = NEW_ARRAY(sim->context, count, struct scene_speed);
    if (!speed) return PDYN_NO_MEMORY;
    FREE_ARRAY(sim->context, inlet->speed, inlet->speeds);
    inlet->speed = speed, inlet->speeds = count;
    return PDYN_OK;
}

pdyn_status pdyn_set_inlet_speed(pdyn_sim *sim, int body, int inlet, double time, double speed) {
    if (inlet < 0 || inlet >= pdyn_inlets(sim, body)) return PDYN_BAD_CALL;
    struct scene_inlet *set = &sim->scene.body[body].inlet[inlet];
    pdyn_status status = check_speed(sim, set, name_of(sim, body, inlet).text, time, speed);
    bool later = time > sim->time;
    double now = inlet_speed(set, sim->time), travelled = inlet_travelled(set, sim->time);
    if (status == PDYN_OK) status = resize_speeds(sim, set, later ? 2 : 1);
    if (status != PDYN_OK) return status;
    set->speed[0] = (struct scene_speed){sim->time, later ? now : speed};
    if (later) set->speed[1] = (struct scene_speed){time, speed};
    if (travelled >= 0.0) set->travelled = travelled, set->start = sim->time;
    sim->control.driven = true;
    return PDYN_OK;
}

/* ---- saved states ---------------------------------------------------------------------------- */

static void persist_speeds(struct pdyn_sim *sim, struct scene_inlet *inlet,
                           struct snapshot_file *a) {
    int count = inlet->speeds;
    snapshot_file_count(a, &count, sizeof *inlet->speed, "the number of keys is out of range");
    snapshot_file_require(a, count > 0, "an inlet has no speed");
    if (a->status == PDYN_OK) a->status = resize_speeds(sim, inlet, count);
    for (int k = 0; k < count && a->status == PDYN_OK; k++) {
        struct scene_speed *speed = &inlet->speed[k];
        snapshot_file_range(a, &speed->time, 1, SCENE_MAX_POSITION, "a time of a key");
        snapshot_file_range(a, &speed->speed, 1, INLET_MAX_SPEED, "a speed of a key");
        snapshot_file_require(a, speed->speed >= 0.0, "a speed of a key");
        snapshot_file_require(a, !k || speed->time > speed[-1].time, "keys are not in order");
    }
}

void inlet_control_persist(struct pdyn_sim *sim, int inlet, struct snapshot_file *a) {
    struct scene_inlet *from = sim->live->inlet[inlet].from;
    given_motion_persist(sim, &from->motion, a);
    persist_speeds(sim, from, a);
    snapshot_file_range(a, &from->start, 1, SCENE_MAX_POSITION, "the start of an inlet");
    snapshot_file_range(a, &from->travelled, 1, STEP_MAX_POSITION, "the way of an inlet");
}
