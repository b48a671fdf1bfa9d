/* Warnings about a scene: values that are legal but surely not meant: of contact, time, probes
 * and constraints. Calls the other files. */
#include "contact/contact.h"
#include "sim/extent.h"
#include "sim/sim.h"
#include "step/timestep.h"
#include "step/warn_of_step.h"
#include "warn.h"

#include <string.h>

/* Constraints whose `elements` returns 0: those of a plug-in that takes some of a body. */
static void check_elements(struct pdyn_sim *sim) {
    for (int k = 0; k < sim->objective.batches; k++) {
        const struct batch *batch = sim->objective.batch[k];
        if (batch->view.elements || !batch->type->elements || batch->type->matrix_free) continue;
        WARN(sim, NO_EFFECT, batch->view.body->name,
             "\"%s\" has no effect: it has no elements on this body", batch->type->name);
    }
}

/* Constraints whose elements all have the weight 0, which no key of the scene changes. A bending
 * rigidity of 0 is common: a sheet keeps together without. */
static void check_stiffness(struct pdyn_sim *sim, int k) {
    const struct scene_constraint *c = sim->constraint[k];
    const struct batch *batch = sim->objective.batch[k];
    double largest = 0.0;
    if (!batch_is_static(batch) || !batch_is_steady(batch) || batch->off) return;
    if (!batch->view.elements || c->keyed_params || !strcmp(c->type->name, "bending")) return;
    for (int e = 0; e < batch->view.elements; e++) largest = fmax(largest, batch->view.weight[e]);
    if (largest == 0.0)
        WARN(sim, NO_EFFECT, batch->view.body->name, "\"%s\" has no effect: its stiffness is 0",
             c->type->name);
}

/* Surfaces this part of the thickness apart press with the stiffness times the thickness, which by
 * default carries the heaviest body on one vertex. */
static const double min_gap = 0.5;

static bool can_move(const void *sim, const pdyn_contact *contact) {
    return warn_pinned_particle(sim, contact) < 0;
}

/* Surfaces that contact throws apart at the start: one warning for the closest. */
static void check_gap(struct pdyn_sim *sim) {
    if (!sim->objective.contact) return;
    struct contact_gap gap = contact_smallest_gap(sim->objective.contact, can_move, sim);
    if (gap.distance < min_gap * gap.thickness)
        WARN(sim, TOO_CLOSE, gap.name[0],
             "it starts %.3g m from \"%s\", near (%.4g, %.4g, %.4g) m, and contact throws them "
             "apart; leave a gap of its `thickness`, %.3g m, or take a smaller one",
             gap.distance, gap.name[1], gap.x[0], gap.x[1], gap.x[2], gap.thickness);
}

/* Free surfaces that something could stop: one warning for all. */
static void check_contact(struct pdyn_sim *sim) {
    if (sim->scene.contact.thickness > 0.0 && !sim->scene.has_contact)
        WARN(sim, NO_EFFECT, "contact", "it has no effect: no body has a surface");
    const char *first = NULL;
    int surfaces = sim->scene.solids, free = 0;
    for (int b = 0; b < sim->bodies; b++) surfaces += !body_is_particles(&sim->body[b]);
    for (int b = 0; b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (body_is_particles(body) || warn_is_held(&sim->scene.body[b])) continue;
        if (!free++) first = body->name;
    }
    if (sim->scene.has_contact || !free || surfaces < 2) return;
    if (free == 1)
        WARN(sim, NO_CONTACT, first,
             "the scene has no \"contact\": it passes through solids and other surfaces");
    else
        WARN(sim, NO_CONTACT, first,
             "the scene has no \"contact\": it and %d other bod%s pass through each other and "
             "through solids",
             free - 1, free == 2 ? "y" : "ies");
}

/* A fixed step that is shortened by a larger part is told. */
static const double max_shortened = 1e-3;

static void check_fixed(struct pdyn_sim *sim) {
    double fixed = sim->scene.settings.h_fixed, frame = sim->scene.settings.frame_interval;
    if (fixed == 0.0) return;
    double steps = timestep_count(frame, fixed), h = frame / steps;
    if (fabs(h - fixed) > max_shortened * fixed)
        WARN(sim, FRAMES, "",
             "steps that end at frames, every %g s, have %g s, not the fixed %g s; with the "
             "\"frame_interval\" %.9g they fit",
             frame, h, fixed, steps * fixed);
}

static void check_duration(struct pdyn_sim *sim) {
    const struct scene_settings *settings = &sim->scene.settings;
    if (settings->duration < (1.0 - 1e-9) * settings->frame_interval)
        WARN(sim, FRAMES, "",
             "the duration of %g s is shorter than the frame interval, the %g s between two frames",
             settings->duration, settings->frame_interval);
}

/* Half of the load of a body may then be without balance in a step that counts as solved. */
static const double loose_tolerance = 0.5;

static void check_tolerance(struct pdyn_sim *sim) {
    double tolerance = sim->scene.settings.tolerance;
    if (sim->objective.without_load && tolerance > loose_tolerance)
        WARN(sim, TOLERANCE, "",
             "with a tolerance of %g, steps count as solved although the forces of fluids are "
             "not balanced; expected at most %g",
             tolerance, loose_tolerance);
}

/* Probes at places that nothing will reach: often a place in millimetres. */
static void check_probes(struct pdyn_sim *sim) {
    struct box box = extent_of_scene(sim);
    if (box.min[0] > box.max[0]) return; /* everything is to come from inlets */
    box_grow(&box, box_extent(&box));
    for (int p = 0; p < sim->scene.probes; p++) {
        const struct scene_probe *probe = &sim->scene.probe[p];
        for (int k = 0; k < probe->at.count; k++) {
            const double *x = probe->at.x + 3 * (size_t)k;
            if (box_contains(&box, x)) continue;
            WARN(sim, PROBE, probe->name,
                 "(%g, %g, %g) is far from everything in the scene: it measures 0", x[0], x[1],
                 x[2]);
            break;
        }
    }
}

pdyn_status warn_of_scene(struct pdyn_sim *sim) {
    check_fixed(sim);
    check_duration(sim);
    check_tolerance(sim);
    check_probes(sim);
    warn_of_meshes(sim);
    check_elements(sim);
    for (int k = 0; k < sim->constraints; k++) check_stiffness(sim, k);
    check_contact(sim);
    check_gap(sim);
    pdyn_status status = warn_of_flow(sim);
    warn_of_values(sim);
    warn_of_water(sim);
    warn_of_points(sim);
    for (int b = 0; b < sim->bodies && status == PDYN_OK; b++) status = warn_of_body(sim, b);
    return status;
}
