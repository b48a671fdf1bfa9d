/* Batches of a simulation: the constraints of the scene, their dampers, what surfaces and a fluid
 * do to each other beside pressure, and contact. */
#include "base/registry.h"
#include "build.h"
#include "contact/contact.h"
#include "scene/json_file.h"
#include "sim/sim.h"

static pdyn_status add_batch(struct pdyn_sim *sim, const pdyn_body *body,
                             const struct scene_constraint *c, struct batch **added) {
    const pdyn_neighbours *lists = objective_lists(&sim->objective);
    const struct batch_def def = {c->type, c->params, body, lists, &sim->services};
    return objective_add_batch(&sim->objective, &def, added);
}

static pdyn_status add_constraint(struct pdyn_sim *sim, const pdyn_body *body,
                                  const struct scene_constraint *c) {
    struct objective *objective = &sim->objective;
    struct batch *added;
    pdyn_status status = add_batch(sim, body, c, &added);
    if (status != PDYN_OK) return status;
    sim->constraint[sim->constraints++] = c;
    if (c->type->matrix_free) added->samples = objective->samples;
    objective->dynamic |= c->type->matrix_free || c->type->update;
    return batch_join_rows(added);
}

static pdyn_status add_damper(struct pdyn_sim *sim, const pdyn_body *body,
                              const struct scene_constraint *c) {
    if (!c->type->damping || c->type->damping(c->params) == 0.0) return PDYN_OK;
    struct batch *added;
    pdyn_status status = add_batch(sim, body, c, &added);
    if (status == PDYN_OK) batch_make_damper(added);
    return status;
}

typedef pdyn_status add_fn(struct pdyn_sim *sim, const pdyn_body *body,
                           const struct scene_constraint *c);

/* Prepends the place of constraint k of body b to the error text. */
static pdyn_status wrap(const struct json_file *json, int b, int k, pdyn_status status) {
    struct json_at root = json_root(json), bodies = json_member(&root, "bodies");
    struct json_at body = json_element(&bodies, (size_t)b);
    struct json_at all = json_member(&body, "constraints"), at = json_element(&all, (size_t)k);
    return json_wrap(&at, status);
}

/* Calls `add` for every constraint of every body. */
static pdyn_status add_each(struct pdyn_sim *sim, const struct json_file *json, add_fn *add) {
    pdyn_status status = PDYN_OK;
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; k < sim->scene.body[b].constraints && status == PDYN_OK; k++)
            status = wrap(json, b, k, add(sim, &sim->body[b], &sim->scene.body[b].constraint[k]));
    return status;
}

/* Adds a batch for another key of the scene than a constraint; its rows come and go. added: may
 * be NULL. */
static pdyn_status add_own(struct objective *objective, const pdyn_constraint_type *type,
                           const pdyn_body *body, struct batch **added) {
    objective->dynamic = true;
    return objective_add_batch(objective, &(struct batch_def){.type = type, .body = body}, added);
}

/* Friction of a fluid along surfaces, and the resistance of those that it passes. */
static pdyn_status add_slip_and_seepage(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    bool slip = false, seepage = false;
    for (int b = 0; b < sim->bodies; b++) {
        slip |= sim->scene.body[b].fluid_friction > 0.0;
        seepage |= sim->body[b].permeability > 0.0;
    }
    if (!objective->samples || !(slip || seepage)) return PDYN_OK;
    pdyn_status status =
        wet_sides_create(sim->context, &sim->scene, sim->body, objective->samples,
                         neighbours_view(objective->neighbours), &objective->wet_sides);
    const pdyn_body *surfaces = status == PDYN_OK ? &objective->wet_sides->all : NULL;
    if (status == PDYN_OK && slip)
        status = add_own(objective, &pdyn_constraint_slip, surfaces, NULL);
    if (status == PDYN_OK && seepage)
        status = add_own(objective, &pdyn_constraint_seepage, surfaces, NULL);
    for (int b = 0; status == PDYN_OK && b < objective->batches; b++)
        objective->batch[b]->view.wet_sides = &objective->wet_sides->view;
    return status;
}

static int count_constraints(const struct pdyn_sim *sim) {
    int count = 0;
    for (int b = 0; b < sim->bodies; b++) count += sim->scene.body[b].constraints;
    return count;
}

pdyn_status batches_create(struct pdyn_sim *sim, const struct json_file *json) {
    struct objective *objective = &sim->objective;
    int constraints = count_constraints(sim), count = 2 * constraints;
    if (sim->scene.has_contact) count += 3; /* contact, its damping, friction */
    if (sim->objective.samples) count += 2; /* slip, seepage */
    objective->batch = NEW_ARRAY(sim->context, count, struct batch *);
    sim->constraint = NEW_ARRAY(sim->context, constraints, const struct scene_constraint *);
    objective->capacity = (size_t)count;
    if (count && !objective->batch) return PDYN_NO_MEMORY;
    if (constraints && !sim->constraint) return PDYN_NO_MEMORY;
    pdyn_status status = add_each(sim, json, add_constraint);
    if (status == PDYN_OK) status = add_each(sim, json, add_damper);
    return status == PDYN_OK ? add_slip_and_seepage(sim) : status;
}

/* ---- contact --------------------------------------------------------------------------------- */

/* Gives all constraints the contacts: those of the local step, or of the beginning of the step. */
static void share_contacts(struct objective *objective) {
    const struct contact *c = objective->contact;
    for (int k = 0; k < objective->batches; k++) {
        struct batch *b = objective->batch[k];
        bool always = b->type->flags & PDYN_EVERY_ITERATION;
        b->view.contacts = always ? contact_current(c) : contact_at_start(c);
    }
}

pdyn_status batches_add_contact(struct pdyn_sim *sim) {
    struct objective *o = &sim->objective;
    if (!o->contact) return PDYN_OK;
    const pdyn_body *all = contact_body(o->contact);
    pdyn_status status = add_own(o, &pdyn_constraint_contact, all, &o->barrier);
    if (status == PDYN_OK && contact_has_dashpots(o->contact))
        status = add_own(o, &pdyn_constraint_contact_damping, all, &o->dashpots);
    if (status == PDYN_OK && sim->scene.contact.friction > 0.0)
        status = add_own(o, &pdyn_constraint_friction, all, &o->friction);
    share_contacts(o);
    return status;
}

void batches_free(struct pdyn_sim *sim) {
    struct objective *objective = &sim->objective;
    for (int b = 0; b < objective->batches; b++) batch_free(objective->batch[b]);
    FREE_ARRAY(sim->context, objective->batch, objective->capacity);
    FREE_ARRAY(sim->context, sim->constraint, count_constraints(sim));
    wet_sides_free(objective->wet_sides);
}
