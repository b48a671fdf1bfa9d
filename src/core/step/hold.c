#include "hold.h"

#include "base/registry.h"
#include "live_particles.h"
#include "sim.h"

#include "projdyn/control.h"

#include <math.h>
#include <string.h>

static const double max_stiffness = 1e15; /* N/m */

/* ---- parameters of a pin --------------------------------------------------------------------- */

static void *field_of(const pdyn_constraint_type *type, void *params, const char *name) {
    const pdyn_param *p = type->params;
    while (strcmp(p->name, name) != 0) p++;
    return (char *)params + p->offset;
}

static const pdyn_body *body_of(const struct pdyn_sim *sim, int particle) {
    return &sim->body[objective_body_of(&sim->objective, particle)];
}

static void set_params(struct pdyn_sim *sim, struct hold *h) {
    const pdyn_constraint_type *pin = registry_constraint(sim->context, "pin");
    const double *rest = sim->rest + 3 * (size_t)h->particle;
    h->index = h->particle - body_of(sim, h->particle)->first;
    for (int a = 0; a < 3; a++) h->key[1 + a] = h->target[a] - rest[a];
    *(pdyn_vertices *)field_of(pin, h->params, "vertices") = (pdyn_vertices){1, &h->index};
    *(pdyn_path *)field_of(pin, h->params, "path") = (pdyn_path){1, h->key};
    *(double *)field_of(pin, h->params, "stiffness") = h->stiffness;
}

/* ---- the list -------------------------------------------------------------------------------- */

static void free_hold(struct pdyn_sim *sim, struct hold *h) {
    size_t size = registry_constraint(sim->context, "pin")->params_size;
    if (h->params) context_resize(sim->context, h->params, size, 0);
    FREE_ARRAY(sim->context, h, 1);
}

static struct hold *add_hold(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    size_t size = registry_constraint(sim->context, "pin")->params_size;
    struct hold **list =
        context_grow(sim->context, c->hold, &c->room, c->holds + 1, sizeof *c->hold);
    if (!list) return NULL;
    c->hold = list;
    struct hold *h = NEW_ARRAY(sim->context, 1, struct hold);
    if (h && !(h->params = context_array(sim->context, 1, size))) FREE_ARRAY(sim->context, h, 1);
    if (h) c->hold[c->holds++] = h;
    return h;
}

/* The hold of a particle, or NULL. */
static struct hold *find_hold(const struct pdyn_sim *sim, int particle) {
    for (size_t k = 0; k < sim->control.holds; k++)
        if (sim->control.hold[k]->particle == particle) return sim->control.hold[k];
    return NULL;
}

/* A released hold stays until its batch is gone. */
static void remove_released(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    size_t kept = 0;
    for (size_t k = 0; k < c->holds; k++)
        if (c->hold[k]->released) free_hold(sim, c->hold[k]);
        else c->hold[kept++] = c->hold[k];
    c->holds = kept;
}

/* ---- batches --------------------------------------------------------------------------------- */

static void drop_batches(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    for (; sim->control.batches; sim->control.batches--)
        batch_free(objective->batch[--objective->batches]);
}

static pdyn_status reserve_batches(struct objective *objective, int count) {
    if (count <= objective->capacity) return PDYN_OK;
    struct batch **moved =
        context_resize(objective->context, objective->batch,
                       (size_t)objective->capacity * sizeof *moved, (size_t)count * sizeof *moved);
    if (!moved) return context_no_memory(objective->context);
    objective->batch = moved, objective->capacity = count;
    return PDYN_OK;
}

pdyn_status holds_make_batches(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    const pdyn_constraint_type *pin = registry_constraint(sim->context, "pin");
    const pdyn_neighbours *lists = sim->neighbours ? neighbours_view(sim->neighbours) : NULL;
    drop_batches(sim);
    remove_released(sim);
    pdyn_status status = reserve_batches(objective, objective->batches + (int)sim->control.holds);
    for (size_t k = 0; status == PDYN_OK && k < sim->control.holds; k++) {
        const struct hold *h = sim->control.hold[k];
        const struct batch_def def = {pin, h->params, body_of(sim, h->particle), lists,
                                      &sim->services};
        status = objective_add_batch(objective, &def);
        if (status == PDYN_OK) sim->control.batches++;
    }
    return status;
}

void holds_free(struct pdyn_sim *sim) {
    struct control *c = &sim->control;
    while (c->holds) free_hold(sim, c->hold[--c->holds]);
    FREE_ARRAY(sim->context, c->hold, c->room);
    c->room = 0;
}

/* ---- public functions ------------------------------------------------------------------------ */

static pdyn_status check_hold(struct pdyn_sim *sim, int particle, double stiffness,
                              const double *target) {
    if (!control_has_particles(sim, particle, 1) || !target) return PDYN_BAD_CALL;
    pdyn_status status = control_check(sim);
    if (status != PDYN_OK) return status;
    if (!particle_is_live(sim, particle))
        return context_fail(sim->context, PDYN_BAD_INPUT, "particle %d is not in the scene",
                            particle);
    if (particle >= body_of(sim, particle)->first + body_of(sim, particle)->count)
        return context_fail(sim->context, PDYN_BAD_INPUT,
                            "particle %d is a point within a rigid body, expected a vertex",
                            particle);
    if (!(stiffness >= 0.0 && stiffness <= max_stiffness))
        return context_fail(sim->context, PDYN_BAD_INPUT,
                            "expected a stiffness from 0 to %g N/m, found %g", max_stiffness,
                            stiffness);
    for (int a = 0; a < 3; a++)
        if (!(fabs(target[a]) <= SCENE_MAX_POSITION))
            return context_fail(sim->context, PDYN_BAD_INPUT,
                                "expected a target from -%g to %g m, found %g", SCENE_MAX_POSITION,
                                SCENE_MAX_POSITION, target[a]);
    return PDYN_OK;
}

pdyn_status pdyn_hold(pdyn_sim *sim, int particle, double stiffness, const double target[3]) {
    pdyn_status status = check_hold(sim, particle, stiffness, target);
    if (status != PDYN_OK) return status;
    struct hold *h = find_hold(sim, particle);
    if (h && h->stiffness == stiffness && !h->released) {
        memcpy(h->target, target, sizeof h->target);
        set_params(sim, h);
        return PDYN_OK;
    }
    if (!h && !(h = add_hold(sim))) return PDYN_NO_MEMORY;
    sim->control.driven = sim->control.stale = true;
    h->particle = particle, h->stiffness = stiffness, h->released = false;
    memcpy(h->target, target, sizeof h->target);
    set_params(sim, h);
    return PDYN_OK;
}

void holds_leave(struct pdyn_sim *sim, int particle) {
    struct hold *h = find_hold(sim, particle);
    if (h) h->released = sim->control.stale = true;
}

pdyn_status pdyn_release(pdyn_sim *sim, int particle) {
    if (!control_has_particles(sim, particle, 1)) return PDYN_BAD_CALL;
    pdyn_status status = control_check(sim);
    if (status == PDYN_OK) holds_leave(sim, particle);
    return status;
}

/* ---- saved states ---------------------------------------------------------------------------- */

/* Reads the particle, stiffness and target of a hold, or writes them. */
static void persist_hold(struct pdyn_sim *sim, struct hold *h, struct snapshot_file *a) {
    long particle = h->particle;
    snapshot_file_long(a, &particle, sim->objective.particles - 1, "a held particle");
    snapshot_file_range(a, h->target, 3, SCENE_MAX_POSITION, "the target of a hold");
    snapshot_file_range(a, &h->stiffness, 1, max_stiffness, "the stiffness of a hold");
    snapshot_file_require(a, h->stiffness >= 0.0, "the stiffness of a hold is negative");
    h->particle = (int)particle;
    if (a->status == PDYN_OK) set_params(sim, h);
}

/* Call after control_settle, so that no released hold is left. */
void holds_persist(struct pdyn_sim *sim, struct snapshot_file *a) {
    struct control *c = &sim->control;
    int count = (int)c->holds;
    snapshot_file_count(a, &count, 4 * sizeof(double), "the number of holds is out of range");
    if (a->view.reading && (count || c->holds)) {
        for (size_t k = 0; k < c->holds; k++) c->hold[k]->released = true;
        c->stale = true;
    }
    size_t first = a->view.reading ? c->holds : 0;
    for (int k = 0; k < count && a->status == PDYN_OK; k++) {
        if (a->view.reading && !add_hold(sim)) a->status = PDYN_NO_MEMORY;
        else persist_hold(sim, c->hold[first + (size_t)k], a);
    }
}
