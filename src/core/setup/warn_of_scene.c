/* Warnings about a scene: values that are legal but surely not meant. */
#include "base/param_kind.h"
#include "contact/contact.h"
#include "geometry/mesh_query.h"
#include "step/extent.h"
#include "step/sim.h"
#include "step/timestep.h"
#include "step/warn_of_step.h"
#include "warn.h"

#include "projdyn/vec3.h"

#include <string.h>

/* Ranges of values that occur in practice. */
static const double min_density = 10.0, max_density = 3e4;             /* kg/m^3 */
static const double min_area_density = 1e-3, max_area_density = 100.0; /* kg/m^2 */
/* Share of the particles that may be left out where they overlap with something. */
static const double max_left_out = 0.3;

/* ---- properties of bodies -------------------------------------------------------------------- */

double warn_mean_edge(const pdyn_body *body) {
    double sum = 0.0;
    for (int e = 0; e < body->edges; e++)
        sum += vec3_distance(body->rest + 3 * (size_t)body->edge[2 * e],
                             body->rest + 3 * (size_t)body->edge[2 * e + 1]);
    return sum / fmax(1.0, body->edges);
}

bool warn_is_held(const struct scene_body *body) {
    for (int k = 0; k < body->constraints; k++) {
        const pdyn_constraint_type *type = body->constraint[k].type;
        if (type->flags & PDYN_REACTION || type_ties_to_other(type)) return true;
    }
    return false;
}

/* ---- checks ---------------------------------------------------------------------------------- */

/* Whether a constraint acts besides viscosity. */
static bool is_constrained(const struct scene_body *body) {
    for (int k = 0; k < body->constraints; k++)
        if (!(body->constraint[k].type->flags & PDYN_NEIGHBOURS)) return true;
    return false;
}

/* Whether bending alone holds the vertices of a body together. */
static bool only_bends(const struct scene_body *body) {
    bool bends = false;
    for (int k = 0; k < body->constraints; k++) {
        const pdyn_constraint_type *type = body->constraint[k].type;
        bool outer = type->flags & (PDYN_ANCHORED | PDYN_LOSSY) || type_ties_to_other(type);
        if (!outer && strcmp(type->name, "bending")) return false;
        bends |= !outer;
    }
    return bends;
}

/* The vertices of a body that no constraint acts on; 0 where a constraint takes others from step to
 * step. */
static int count_loose(const struct pdyn_sim *sim, const pdyn_body *body) {
    int loose = 0;
    for (int k = 0; k < sim->constraints; k++) {
        const struct batch *batch = sim->objective.batch[k];
        if (batch->view.body == body && !batch_is_static(batch)) return 0;
    }
    for (int i = body->first; i < body->first + body->count; i++)
        loose += !sim->model.model.in_rows[i];
    return loose;
}

static void check_loose(struct pdyn_sim *sim, const pdyn_body *body) {
    int loose = body_is_particles(body) ? 0 : count_loose(sim, body);
    if (loose)
        WARN(sim, UNCONSTRAINED, body->name, "no constraint acts on %d of its %d vertices%s", loose,
             body->count,
             body->tets ? "; the inside of a soft body needs {\"type\": \"tet\"}" : "");
}

static void check_constraints(struct pdyn_sim *sim, int b) {
    if (sim->scene.body[b].is_rigid) return;
    if (only_bends(&sim->scene.body[b]))
        WARN(sim, UNCONSTRAINED, sim->body[b].name,
             "only \"bending\" holds its vertices together, and it stretches without limit; cloth "
             "needs {\"type\": \"triangle\"} or {\"type\": \"spring\"}");
    if (is_constrained(&sim->scene.body[b])) {
        check_loose(sim, &sim->body[b]);
        return;
    }
    if (!body_is_particles(&sim->body[b]))
        WARN(sim, UNCONSTRAINED, sim->body[b].name, "no constraint holds its vertices together");
    else
        WARN(
            sim, UNCONSTRAINED, sim->body[b].name,
            "no constraint keeps its particles apart and they pass through each other; water needs "
            "{\"type\": \"fluid\"}");
}

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

/* Forces within a rigid body add up to nothing. */
static void check_effect(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    for (int k = 0; k < body->constraints && body->is_rigid; k++) {
        const pdyn_constraint_type *type = body->constraint[k].type;
        if (!type_acts_from_outside(type))
            WARN(sim, NO_EFFECT, body->name,
                 "\"%s\" has no effect on a rigid body, which keeps its shape", type->name);
    }
}

static void check_density(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    double density = body->rest_density > 0.0 ? body->rest_density : body->density;
    double area = density > 0.0 ? 0.0 : body->area_density;
    if (density > 0.0 && (density < min_density || density > max_density))
        WARN(sim, DENSITY, body->name, "a density of %g kg/m^3 is unusual; water has 1000 kg/m^3",
             density);
    if (area > 0.0 && (area < min_area_density || area > max_area_density))
        WARN(sim, DENSITY, body->name,
             "an area density of %g kg/m^2 is unusual; cloth has 0.05 to 1 kg/m^2", area);
}

/* Is the body, with the bounding box `box`, inside a closed mesh? */
static pdyn_status find_inside(const struct pdyn_sim *sim, const pdyn_body *body,
                               const struct box *box, const struct mesh *mesh, bool *inside) {
    struct box around = box_around(mesh->vertex, mesh->vertices);
    struct mesh_query query;
    *inside = box_contains(&around, box->min) && box_contains(&around, box->max);
    if (!*inside) return PDYN_OK;
    pdyn_status status = mesh_query_create(sim->context, mesh, &query);
    if (status != PDYN_OK) return status;
    *inside = mesh_query_contains(&query, sim->x + 3 * (size_t)body->first);
    mesh_query_free(sim->context, &query);
    return PDYN_OK;
}

static pdyn_status check_inside(struct pdyn_sim *sim, const pdyn_body *body, const struct box *box,
                                const struct mesh *mesh, const char *kind, const char *name) {
    bool inside;
    pdyn_status status = find_inside(sim, body, box, mesh, &inside);
    if (status == PDYN_OK && inside)
        WARN(sim, OVERLAP, body->name, "it starts inside of the %s \"%s\"", kind, name);
    return status;
}

/* Whether a constraint of the body, as an attachment, ties it to the other one. */
static bool is_tied(const struct scene_body *body, const pdyn_body *other) {
    for (int k = 0; k < body->constraints; k++) {
        const struct scene_constraint *c = &body->constraint[k];
        for (const pdyn_param *p = c->type->params; p->name; p++)
            if (param_other(p, c->params) && param_other(p, c->params)->body == other) return true;
    }
    return false;
}

/* Whether contact holds bodies in the other one that start inside of it. What is tied to a soft
 * body, as its bones, is meant to be there. */
static bool holds_inside(const struct pdyn_sim *sim, int b, int other) {
    const struct scene_body *body = sim->scene.body;
    if (other == b || body[other].is_rigid) return other != b;
    return sim->scene.has_contact && sim->body[other].tets &&
           !is_tied(&body[b], &sim->body[other]) && !is_tied(&body[other], &sim->body[b]);
}

/* Bodies inside a rigid body, a volume or a solid ball: contact holds them there. */
static pdyn_status check_places(struct pdyn_sim *sim, int b) {
    const pdyn_body *body = &sim->body[b];
    pdyn_status status = PDYN_OK;
    if (body_is_particles(body)) return PDYN_OK;
    struct box box = extent_of_body(sim, body);
    for (int k = 0; k < sim->bodies && status == PDYN_OK; k++) {
        const struct scene_body *other = &sim->scene.body[k];
        if (holds_inside(sim, b, k))
            status = check_inside(sim, body, &box, &other->mesh,
                                  other->is_rigid ? "rigid body" : "volume", other->name);
    }
    for (int s = 0; s < sim->scene.solids && status == PDYN_OK; s++) {
        const struct scene_solid *solid = &sim->scene.solid[s];
        if (solid->kind == SOLID_SPHERE || solid->kind == SOLID_CAPSULE)
            status = check_inside(sim, body, &box, &solid->mesh, "solid", solid->name);
    }
    return status;
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

static void check_overlap(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    int count = sim->body[b].count + body->overlapping;
    if (body->crossing)
        WARN(sim, OVERLAP, body->name,
             "%d piece%s of its mesh %s partly inside another one: the common part counts twice in "
             "its volume",
             body->crossing, body->crossing == 1 ? "" : "s", body->crossing == 1 ? "is" : "are");
    if (body->overlapping <= max_left_out * count) return;
    WARN(sim, OVERLAP, body->name, "%d of %d particles overlap solids or surfaces and are left out",
         body->overlapping, count);
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
    for (int b = 0; b < sim->bodies && status == PDYN_OK; b++) {
        check_constraints(sim, b);
        check_effect(sim, b);
        status = check_places(sim, b);
        check_density(sim, b);
        check_overlap(sim, b);
    }
    return status;
}
