#include "hold.h"

#include "base/bad_call.h"
#include "live_particles.h"
#include "sim.h"

#include "projdyn/control.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double max_stiffness = 1e15; /* N/m */

/* ---- the constraint -------------------------------------------------------------------------- */

static const struct hold *hold_at(const void *par, int element) {
    const struct hold_group *group = par;
    return group->control->hold + group->first + element;
}

static int elements(const void *par, const pdyn_body *body) {
    (void)body;
    return ((const struct hold_group *)par)->count;
}

static void select_points(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->column[e] = hold_at(par, e)->particle, b->coefficient[e] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = hold_at(par, e)->stiffness;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        memcpy(b->p + 3 * (size_t)e, hold_at(par, e)->target, 3 * sizeof *b->p);
}

static const pdyn_constraint_type held = {
    .name = "hold",
    .summary = "holds points where a program says",
    .flags = PDYN_ANCHORED | PDYN_REACTION,
    .params_size = sizeof(struct hold_group),
    .params = (const pdyn_param[]){{0}},
    .elements = elements,
    .rows = 1,
    .width = 1,
    .select = select_points,
    .weight = weight,
    .project = project,
};

/* ---- the list -------------------------------------------------------------------------------- */

static struct hold *add_hold(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    if (!c->hold_of && !(c->hold_of = NEW_ARRAY(sim->context, sim->objective.particles, int)))
        return NULL;
    struct hold *list =
        context_grow(sim->context, c->hold, &c->room, c->holds + 1, sizeof *c->hold);
    if (!list) return NULL;
    c->hold = list;
    list[c->holds] = (struct hold){0}; /* the place may have been that of a released one */
    return &list[c->holds++];
}

static int compare_holds(const void *a, const void *b) {
    return ((const struct hold *)a)->particle - ((const struct hold *)b)->particle;
}

/* The hold of a particle, or NULL. */
static struct hold *find_hold(const struct pdyn_sim *sim, int particle) {
    const struct control *c = &sim->control;
    int number = c->hold_of ? c->hold_of[particle] : 0;
    return number ? &c->hold[number - 1] : NULL;
}

/* A released hold stays until its batch is gone. */
static void remove_released(struct control *c) {
    size_t kept = 0;
    for (size_t k = 0; k < c->holds; k++)
        if (!c->hold[k].released) c->hold[kept++] = c->hold[k];
    c->holds = kept;
}

/* Sorts the holds by particle. */
static void sort_holds(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    if (!c->hold) return;
    qsort(c->hold, c->holds, sizeof *c->hold, compare_holds);
    memset(c->hold_of, 0, (size_t)sim->objective.particles * sizeof *c->hold_of);
    for (size_t k = 0; k < c->holds; k++) c->hold_of[c->hold[k].particle] = (int)k + 1;
}

/* ---- batches --------------------------------------------------------------------------------- */

static const pdyn_body *body_of(const struct pdyn_sim *sim, int particle) {
    return &sim->body[objective_body_of(&sim->objective, particle)];
}

static void drop_batches(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    for (; sim->control.batches; sim->control.batches--)
        batch_free(objective->batch[--objective->batches]);
}

static pdyn_status reserve_batches(struct objective *objective, int count) {
    struct batch **grown = context_grow(objective->context, objective->batch, &objective->capacity,
                                        (size_t)count, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    objective->batch = grown;
    return PDYN_OK;
}

/* Makes the batch of the holds from *first on that have its body; moves *first behind them. */
static pdyn_status make_batch(struct pdyn_sim *sim, size_t *first) {
    struct control *c = &sim->control;
    const pdyn_neighbours *lists = objective_lists(&sim->objective);
    const pdyn_body *body = body_of(sim, c->hold[*first].particle);
    struct hold_group *group = &c->group[c->batches];
    *group = (struct hold_group){c, *first, 0};
    for (; *first < c->holds && body_of(sim, c->hold[*first].particle) == body; ++*first)
        group->count++;
    const struct batch_def def = {&held, group, body, lists, &sim->services};
    pdyn_status status = objective_add_batch(&sim->objective, &def, NULL);
    if (status == PDYN_OK) c->batches++;
    return status;
}

pdyn_status holds_make_batches(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    drop_batches(sim);
    remove_released(c);
    sort_holds(sim);
    if (c->holds && !c->group &&
        !(c->group = NEW_ARRAY(sim->context, sim->bodies, struct hold_group)))
        return PDYN_NO_MEMORY;
    pdyn_status status = reserve_batches(&sim->objective, sim->objective.batches + sim->bodies);
    for (size_t k = 0; status == PDYN_OK && k < c->holds;) status = make_batch(sim, &k);
    return status;
}

void holds_free(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    FREE_ARRAY(sim->context, c->hold, c->room);
    FREE_ARRAY(sim->context, c->group, sim->bodies);
    FREE_ARRAY(sim->context, c->hold_of, sim->objective.particles);
    c->holds = c->room = 0;
}

/* ---- public functions ------------------------------------------------------------------------ */

static pdyn_status check_hold(struct pdyn_sim *sim, int particle, double stiffness,
                              const double *target) {
    if (!particle_is_live(sim, particle))
        return set_error(PDYN_BAD_INPUT, "pdyn_hold: particle %d is not in the scene", particle);
    if (particle >= body_of(sim, particle)->first + body_of(sim, particle)->count)
        return set_error(PDYN_BAD_INPUT,
                         "pdyn_hold: particle %d is a point within a rigid body, expected a vertex",
                         particle);
    if (!(stiffness >= 0.0 && stiffness <= max_stiffness))
        return set_error(PDYN_BAD_INPUT,
                         "pdyn_hold: expected a stiffness from 0 to %g N/m, found %g",
                         max_stiffness, stiffness);
    for (int a = 0; a < 3; a++)
        if (!(fabs(target[a]) <= SCENE_MAX_POSITION))
            return set_error(PDYN_BAD_INPUT,
                             "pdyn_hold: expected a target from -%g to %g m, found %g",
                             SCENE_MAX_POSITION, SCENE_MAX_POSITION, target[a]);
    return PDYN_OK;
}

pdyn_status pdyn_hold(pdyn_sim *sim, int particle, double stiffness, const double target[3]) {
    if (HAS_NULL(sim, target) || BAD_INDEX(particle, sim->objective.particles) ||
        control_refuses(__func__, sim))
        return PDYN_BAD_CALL;
    pdyn_status status = check_hold(sim, particle, stiffness, target);
    if (status != PDYN_OK) return status;
    struct hold *h = find_hold(sim, particle);
    bool acts = h && !h->released, same = acts && h->stiffness == stiffness;
    if (!h && !(h = add_hold(sim))) return PDYN_NO_MEMORY;
    sim->control.hold_of[particle] = (int)(h - sim->control.hold) + 1;
    sim->control.driven = true;
    sim->control.stale |= !same;
    if (!acts) sim->history = 0.0; /* as in pdyn_enable */
    *h = (struct hold){.particle = particle, .stiffness = stiffness};
    memcpy(h->target, target, sizeof h->target);
    return PDYN_OK;
}

void holds_leave(struct pdyn_sim *sim, int particle) {
    struct hold *h = find_hold(sim, particle);
    if (h) h->released = sim->control.stale = true;
}

pdyn_status pdyn_release(pdyn_sim *sim, int particle) {
    if (HAS_NULL(sim) || BAD_INDEX(particle, sim->objective.particles) ||
        control_refuses(__func__, sim))
        return PDYN_BAD_CALL;
    const struct hold *h = find_hold(sim, particle);
    if (h && !h->released) sim->history = 0.0; /* as in pdyn_enable */
    holds_leave(sim, particle);
    return PDYN_OK;
}

/* ---- saved states ---------------------------------------------------------------------------- */

/* Reads the particle, stiffness and target of a hold, or writes them. */
static void persist_hold(struct pdyn_sim *sim, struct hold *h, struct snapshot_file *file) {
    long particle = h->particle;
    snapshot_file_long(file, &particle, sim->objective.particles - 1, "a held particle");
    snapshot_file_range(file, h->target, 3, SCENE_MAX_POSITION, "the target of a hold");
    snapshot_file_range(file, &h->stiffness, 1, max_stiffness, "the stiffness of a hold");
    snapshot_file_require(file, h->stiffness >= 0.0, "the stiffness of a hold is negative");
    h->particle = (int)particle;
}

/* Whether the holds from `first` on are those before it, but for their targets. */
static bool same_holds(const struct control *c, size_t first) {
    bool same = c->holds == 2 * first;
    for (size_t k = 0; same && k < first; k++) {
        const struct hold *old = &c->hold[k], *read = &c->hold[first + k];
        same =
            !old->released && old->particle == read->particle && old->stiffness == read->stiffness;
    }
    return same;
}

/* Replaces the holds before `first` by those from there on. Solvers depend on particles and
 * stiffness, not on targets. */
static void replace_holds(struct control *c, size_t first) {
    if (same_holds(c, first)) {
        if (first) memcpy(c->hold, c->hold + first, first * sizeof *c->hold);
        c->holds = first;
        return;
    }
    for (size_t k = 0; k < first; k++) c->hold[k].released = true;
    c->stale = true;
}

/* Call after control_settle, so that no released hold is left. */
void holds_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    struct control *c = &sim->control;
    int count = (int)c->holds;
    size_t first = file->view.reading ? c->holds : 0;
    snapshot_file_count(file, &count, 4 * sizeof(double), "the number of holds is out of range");
    for (int k = 0; k < count && file->status == PDYN_OK; k++) {
        if (file->view.reading && !add_hold(sim)) file->status = PDYN_NO_MEMORY;
        else persist_hold(sim, &c->hold[first + (size_t)k], file);
    }
    if (file->view.reading && file->status == PDYN_OK) replace_holds(c, first);
    else if (file->view.reading) c->holds = first;
}
