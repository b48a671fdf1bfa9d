/* Warnings about a body: what holds it together, its density, and what it starts inside of. */
#include "base/param_kind.h"
#include "geometry/mesh_query.h"
#include "sim/extent.h"
#include "sim/sim.h"
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

/* Whether it is a string that is longer than its distance at the start. */
static bool is_slack(const struct scene_constraint *c) {
    return c->type->one_sided && c->type->one_sided(c->params) && warn_parameter(c, "length") > 1.0;
}

bool warn_is_held(const struct scene_body *body) {
    for (int k = 0; k < body->constraints; k++) {
        const struct scene_constraint *c = &body->constraint[k];
        if (c->type->flags & PDYN_REACTION) return true;
        if (type_ties_to_other(c->type) && !is_slack(c)) return true;
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
            if (param_body(p, c->params) == other) return true;
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

pdyn_status warn_of_body(struct pdyn_sim *sim, int b) {
    check_constraints(sim, b);
    check_effect(sim, b);
    pdyn_status status = check_places(sim, b);
    check_density(sim, b);
    check_overlap(sim, b);
    return status;
}
