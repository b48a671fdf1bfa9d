/* Batches of a simulation, but for those of contact: the constraints of the scene, their dampers,
 * and the friction of surfaces with a fluid. */
#include "base/registry.h"
#include "build.h"
#include "sim.h"

static pdyn_status add_batch(struct pdyn_sim *sim, const pdyn_body *body,
                             const struct scene_constraint *c) {
    struct objective *sys = &sim->objective;
    const pdyn_neighbours *lists = sim->neighbours ? neighbours_view(sim->neighbours) : NULL;
    pdyn_status status = batch_create(sim->context, c->type, c->params, body, &sim->services, lists,
                                      false, &sys->batch[sys->batches]);
    if (status == PDYN_OK) sys->batches++;
    return status;
}

static pdyn_status add_constraint(struct pdyn_sim *sim, const pdyn_body *body,
                                  const struct scene_constraint *c) {
    struct objective *sys = &sim->objective;
    pdyn_status status = add_batch(sim, body, c);
    if (status != PDYN_OK) return status;
    if (c->type->matrix_free) sys->batch[sys->batches - 1]->samples = sim->samples;
    sys->dynamic_rows |= c->type->matrix_free || c->type->update;
    bool on_solids = c->type->matrix_free && c->type->matrix_free->boundary_force;
    sim->anchored |= (c->type->flags & PDYN_ANCHORED) || (on_solids && sim->boundary.at.count);
    sim->constraints = sys->batches;
    return batch_join_rows(sys->batch[sys->batches - 1]);
}

static pdyn_status add_damper(struct pdyn_sim *sim, const pdyn_body *body,
                              const struct scene_constraint *c) {
    if (!c->type->damping || c->type->damping(c->params) == 0.0) return PDYN_OK;
    pdyn_status status = add_batch(sim, body, c);
    if (status == PDYN_OK) sim->objective.batch[sim->objective.batches - 1]->damper = true;
    return status;
}

typedef pdyn_status add_fn(struct pdyn_sim *sim, const pdyn_body *body,
                           const struct scene_constraint *c);

/* Calls `add` for every constraint of every body. */
static pdyn_status add_each(struct pdyn_sim *sim, add_fn *add) {
    pdyn_status status = PDYN_OK;
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; k < sim->scene.body[b].constraints && status == PDYN_OK; k++)
            status = add(sim, &sim->body[b], &sim->scene.body[b].constraint[k]);
    return status;
}

/* The friction of surfaces with a fluid. */
static pdyn_status add_slip(struct pdyn_sim *sim) {
    struct objective *sys = &sim->objective;
    if (!sim->samples) return PDYN_OK;
    pdyn_status status =
        wet_sides_create(sim->context, &sim->scene, sim->body, sys->particles, sim->samples,
                         neighbours_view(sim->neighbours), &sys->wet_sides);
    if (status != PDYN_OK || !sys->wet_sides) return status;
    status = batch_create(sim->context, &pdyn_constraint_slip, NULL, &sys->wet_sides->all, NULL,
                          NULL, false, &sys->batch[sys->batches]);
    if (status != PDYN_OK) return status;
    sys->dynamic_rows = true;
    sys->batches++;
    for (int b = 0; b < sys->batches; b++) sys->batch[b]->view.wet_sides = &sys->wet_sides->view;
    return PDYN_OK;
}

pdyn_status batches_create(struct pdyn_sim *sim) {
    struct objective *sys = &sim->objective;
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) count += 2 * sim->scene.body[b].constraints;
    if (sim->scene.has_contact) count += 3; /* contact, its damping, friction */
    if (sim->samples) count++;              /* slip */
    sys->batch = NEW_ARRAY(sim->context, count, struct batch *);
    if (count && !sys->batch) return PDYN_NO_MEMORY;
    sys->capacity = count;
    pdyn_status status = add_each(sim, add_constraint);
    if (status == PDYN_OK) status = add_each(sim, add_damper);
    return status == PDYN_OK ? add_slip(sim) : status;
}

void batches_free(struct pdyn_sim *sim) {
    struct objective *sys = &sim->objective;
    for (int b = 0; b < sys->batches; b++) batch_free(sys->batch[b]);
    FREE_ARRAY(sim->context, sys->batch, sys->capacity);
    wet_sides_free(sys->wet_sides);
}
