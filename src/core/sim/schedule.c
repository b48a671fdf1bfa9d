#include "schedule.h"

#include "control.h"
#include "parameters.h"
#include "sim.h"

#include "projdyn/control.h"
#include "projdyn/path.h"
#include "projdyn/vec3.h"

#include <string.h>

/* Times that differ by rounding alone are equal: the time of a simulation is a sum of steps, which
 * may be 0.30000000000000004 s where a scene has 0.3 s. */
static bool is_over(double time, double now) { return time <= now * (1.0 + 1e-12); }

/* Whether the next step is the first one that begins at a time or later. */
static bool is_now(const struct pdyn_sim *sim, double time) {
    return is_over(time, sim->time) && (!sim->steps || !is_over(time, sim->time - sim->last_h));
}

/* ---- keys ------------------------------------------------------------------------------------ */

/* Whether there are keys that count. */
static bool is_followed(const struct scene_keyed *keyed) {
    return keyed->path.count && !keyed->replaced;
}

static void follow_gravity(struct pdyn_sim *sim) {
    double gravity[3], *now = sim->scene.settings.gravity;
    if (!is_followed(&sim->scene.settings.gravity_keys)) return;
    path_at(&sim->scene.settings.gravity_keys.path, sim->time, gravity);
    sim->control.driven = true;
    if (memcmp(gravity, now, sizeof gravity)) control_set_gravity(sim, gravity);
}

/* Sets every parameter to the value of its keys at a time. Returns the status of the last one that
 * is refused. */
static pdyn_status set_all(struct pdyn_sim *sim, int k, const struct scene_constraint *c,
                           double time) {
    pdyn_status status = PDYN_OK, last;
    double value[3];
    for (int m = 0; m < c->keyed_params && status != PDYN_NO_MEMORY; m++) {
        if (!is_followed(&c->keyed[m])) continue;
        path_at(&c->keyed[m].path, time, value);
        last = parameters_follow(sim, k, c->keyed[m].param, value);
        if (last != PDYN_OK) status = last;
    }
    return status;
}

/* A type may refuse a value while another parameter still has its old one. As many rounds as there
 * are parameters find an order in which it accepts all. */
static pdyn_status follow_to(struct pdyn_sim *sim, int k, const struct scene_constraint *c,
                             double time) {
    pdyn_status status = set_all(sim, k, c, time);
    for (int m = 1; m < c->keyed_params && status == PDYN_BAD_INPUT; m++)
        status = set_all(sim, k, c, time);
    return status;
}

static pdyn_status follow_keys(struct pdyn_sim *sim, int k, const struct scene_constraint *c) {
    for (int m = 0; m < c->keyed_params; m++) sim->control.driven |= is_followed(&c->keyed[m]);
    return follow_to(sim, k, c, sim->time);
}

/* Goes through the times of all keys of a parameter: a constraint may refuse a value, which is an
 * error of the scene. */
static pdyn_status try_keys(struct pdyn_sim *sim, int k, const struct scene_constraint *c,
                            const pdyn_path *path) {
    const double *key = path->key, *end = key + 4 * path->count;
    pdyn_status status = PDYN_OK;
    for (; key < end && status == PDYN_OK; key += 4) status = follow_to(sim, k, c, key[0]);
    if (status != PDYN_BAD_INPUT) return status;
    return set_error(status, "%s: key at %.10g s: %s", sim->scene.file, key[-4],
                     pdyn_last_error(NULL));
}

/* ---- all constraints ------------------------------------------------------------------------- */

static pdyn_status start_one(struct pdyn_sim *sim, int k, const struct scene_constraint *c) {
    pdyn_status status = PDYN_OK;
    for (int m = 0; m < c->keyed_params && status == PDYN_OK; m++)
        status = try_keys(sim, k, c, &c->keyed[m].path);
    if (status == PDYN_OK) status = follow_keys(sim, k, c);
    return status == PDYN_OK && c->from > 0.0 ? pdyn_enable(sim, k, false) : status;
}

static pdyn_status switch_one(struct pdyn_sim *sim, int k, const struct scene_constraint *c) {
    pdyn_status status = follow_keys(sim, k, c);
    if (status != PDYN_OK) return status;
    if (is_now(sim, c->until)) return pdyn_enable(sim, k, false);
    return c->from > 0.0 && is_now(sim, c->from) ? pdyn_enable(sim, k, true) : PDYN_OK;
}

typedef pdyn_status one_fn(struct pdyn_sim *sim, int k, const struct scene_constraint *c);

static pdyn_status for_all(struct pdyn_sim *sim, one_fn *one) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < sim->constraints && status == PDYN_OK; k++)
        status = one(sim, k, sim->constraint[k]);
    return status;
}

pdyn_status schedule_start(struct pdyn_sim *sim) {
    sim->control.gravity = vec3_length(sim->scene.settings.gravity);
    follow_gravity(sim);
    return for_all(sim, start_one);
}

pdyn_status schedule_switch(struct pdyn_sim *sim) {
    follow_gravity(sim);
    return for_all(sim, switch_one);
}

bool schedule_has_ended(const struct pdyn_sim *sim, const struct scene_constraint *constraint) {
    return is_over(constraint->until, sim->time);
}

void schedule_replace(struct pdyn_sim *sim, int constraint, const pdyn_param *param) {
    const struct scene_constraint *c = sim->constraint[constraint];
    for (int m = 0; m < c->keyed_params; m++) c->keyed[m].replaced |= c->keyed[m].param == param;
}

/* ---- saved states ---------------------------------------------------------------------------- */

static const char bad_flag[] = "the flag of keys is neither 0 nor 1";

void schedule_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    snapshot_file_flags(file, &sim->scene.settings.gravity_keys.replaced, 1, bad_flag);
    for (int k = 0; k < sim->constraints; k++)
        for (int m = 0; m < sim->constraint[k]->keyed_params; m++)
            snapshot_file_flags(file, &sim->constraint[k]->keyed[m].replaced, 1, bad_flag);
}
