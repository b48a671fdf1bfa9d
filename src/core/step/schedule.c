#include "schedule.h"

#include "projdyn/control.h"

/* Times are equal that differ by rounding alone: 0.3 is a step's begin that was summed to
 * 0.30000000000000004. */
static bool is_over(double time, double now) { return time <= now * (1.0 + 1e-12); }

/* Whether the next step is the first one that begins at a time or later. */
static bool is_now(const struct pdyn_sim *sim, double time) {
    return is_over(time, sim->time) && (!sim->steps || !is_over(time, sim->time - sim->last_h));
}

static pdyn_status start_one(struct pdyn_sim *sim, int k, const struct scene_constraint *c) {
    return c->from > 0.0 ? pdyn_enable(sim, k, false) : PDYN_OK;
}

static pdyn_status switch_one(struct pdyn_sim *sim, int k, const struct scene_constraint *c) {
    if (is_now(sim, c->until)) return pdyn_enable(sim, k, false);
    return c->from > 0.0 && is_now(sim, c->from) ? pdyn_enable(sim, k, true) : PDYN_OK;
}

typedef pdyn_status one_fn(struct pdyn_sim *sim, int k, const struct scene_constraint *c);

static pdyn_status for_all(struct pdyn_sim *sim, one_fn *one) {
    pdyn_status status = PDYN_OK;
    for (int b = 0, k = 0; b < sim->bodies; b++)
        for (int m = 0; m < sim->scene.body[b].constraints && status == PDYN_OK; m++, k++)
            status = one(sim, k, &sim->scene.body[b].constraint[m]);
    return status;
}

pdyn_status schedule_start(struct pdyn_sim *sim) { return for_all(sim, start_one); }

pdyn_status schedule_switch(struct pdyn_sim *sim) { return for_all(sim, switch_one); }
