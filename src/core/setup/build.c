/* Construction of a simulation from a scene, part by part (build.h), and its end. */
#include "build.h"

#include "base/bad_call.h"
#include "contact/contact.h"
#include "objective/residual.h"
#include "scene/scene_file.h"
#include "sim/crossings.h"
#include "sim/extent.h"
#include "sim/live_particles.h"
#include "sim/probes.h"
#include "sim/rigid_bodies.h"
#include "sim/schedule.h"
#include "sim/sim.h"
#include "step/carried.h"
#include "warn.h"

/* Prepends the place of "contact" to the error text where the bodies intersect. */
static pdyn_status create_contact(struct pdyn_sim *sim, const struct json_file *json) {
    struct json_at root = json_root(json), contact = json_member(&root, "contact");
    const struct contact_def def = {.scene = &sim->scene,
                                    .body = sim->body,
                                    .particles = sim->objective.particles,
                                    .live = sim->live ? sim->live->live : NULL,
                                    .rigid = sim->objective.rigid,
                                    .x = sim->x};
    return json_wrap(&contact, contact_create(sim->context, &def, &sim->objective.contact));
}

/* Prepends the place of the solver's name to the error text of a solver that does not fit. */
static pdyn_status create_solver(struct pdyn_sim *sim, const struct json_file *json) {
    struct json_at root = json_root(json), solver = json_member(&root, "solver");
    struct json_at type = json_member(&solver, "type");
    return json_wrap(&type, solver_choice_create(sim));
}

static pdyn_status build(struct pdyn_sim *sim, const struct json_file *json) {
    sim->services = context_services(sim->context);
    sim->objective.context = sim->context;
    pdyn_status status = bodies_create(sim);
    if (status == PDYN_OK) warn_of_memory(sim), warn_of_thickness(sim);
    if (status == PDYN_OK) status = rigid_bodies_create(sim);
    if (status == PDYN_OK) status = live_particles_create(sim);
    if (status == PDYN_OK) bodies_forget_start(sim);
    if (status == PDYN_OK) status = lists_create(sim);
    if (status == PDYN_OK) status = carried_create(sim);
    if (status == PDYN_OK) status = batches_create(sim, json);
    if (status == PDYN_OK) status = create_contact(sim, json);
    if (status == PDYN_OK) status = batches_add_contact(sim);
    if (status == PDYN_OK) status = residual_create(&sim->objective);
    if (status == PDYN_OK) status = solid_load_create(sim);
    if (status == PDYN_OK) control_find_anchored(sim);
    if (status == PDYN_OK) status = probes_create(sim, json);
    sim->eps = sim->scene.settings.newton ? 0.0 : 1.0;
    if (status == PDYN_OK) status = create_solver(sim, json);
    if (status == PDYN_OK) solver_choice_warn(sim);
    if (status == PDYN_OK) status = crossings_create(sim);
    if (status == PDYN_OK) status = energy_budget_create(sim);
    if (status != PDYN_OK) return status;
    sim->floor = extent_floor(sim);
    status = warn_of_scene(sim);
    return status == PDYN_OK ? schedule_start(sim) : status;
}

pdyn_status pdyn_scene_load(pdyn_scene *scene, pdyn_sim **out) {
    if (out) *out = NULL;
    if (HAS_NULL(scene, out)) return PDYN_BAD_CALL;
    pdyn_context *context = scene->json.context;
    struct pdyn_sim *sim = NEW_ARRAY(context, 1, struct pdyn_sim);
    if (!sim) return PDYN_NO_MEMORY;
    sim->context = context;
    pool_check_process(context->pool);
    pdyn_status status = scene_read(&scene->json, &sim->scene);
    if (status == PDYN_OK) status = build(sim, &scene->json);
    if (status == PDYN_OK) return *out = sim, PDYN_OK;
    pdyn_free(sim);
    return status;
}

void pdyn_free(pdyn_sim *sim) {
    if (!sim) return;
    pdyn_context *context = sim->context;
    carried_free(sim);
    solver_choice_free(sim);
    batches_free(sim);
    contact_free(sim->objective.contact);
    rigid_matrix_free(sim->objective.rigid_matrix);
    rigid_map_free(sim->objective.rigid);
    residual_free(&sim->objective);
    crossings_free(sim);
    energy_budget_free(sim);
    control_free(sim);
    live_particles_free(sim);
    solid_load_free(sim);
    probes_free(sim);
    lists_free(sim);
    bodies_free(sim);
    scene_free(context, &sim->scene);
    FREE_ARRAY(context, sim, 1);
}
