/* Warnings about inlets and outlets, and about what would begin after the end of the scene. */
#include "base/param_kind.h"
#include "geometry/mesh_query.h"
#include "scene/inlet_motion.h"
#include "sim/live_particles.h"
#include "sim/sim.h"
#include "warn.h"

#include "projdyn/vec3.h"

/* Share of the particles at the start that outlets may remove at once. */
static const double max_removed = 0.5;
/* Share of an inlet's layer that solids may cover. */
static const double max_covered = 0.1;

/* ---- inlets ---------------------------------------------------------------------------------- */

static void check_cover(struct pdyn_sim *sim, const pdyn_body *body, int number,
                        const struct scene_cover *cover, const char *effect) {
    const struct scene_inlet *inlet = &sim->scene.body[body - sim->body].inlet[number];
    int count = inlet->layer.count + inlet->left_out.count;
    if (cover->count <= max_covered * count) return;
    WARN(sim, BLOCKED, body->name,
         "solids cover %d of %d particles of a layer of inlet %d, the first at (%.4g, %.4g, %.4g) "
         "m by \"%s\", and %s; expected an opening that fits beside them: move, turn (\"up\") or "
         "shrink it",
         cover->count, count, number, cover->first[0], cover->first[1], cover->first[2],
         cover->solid->name, effect);
}

/* Whether the surface lies in the way of a layer, which goes from behind the opening to where it is
 * free; x: where, m. */
static bool is_in_way(const struct mesh_query *surface, const struct scene_inlet *inlet,
                      double spacing, double x[3]) {
    const double part = 0.125; /* of a spacing, between two places on the way */
    double direction[3];
    inlet_direction(inlet, 0.0, direction);
    for (int k = 0; k < inlet->layer.count; k++) {
        inlet_place(inlet, k, 0.0, 0.0, x);
        vec3_add(x, -INLET_BEHIND * spacing, direction);
        for (double at = -INLET_BEHIND; at <= INLET_STAGGER; at += part) {
            if (mesh_query_is_close(surface, x, 0.5 * part * spacing)) return true;
            vec3_add(x, part * spacing, direction);
        }
    }
    return false;
}

/* Whether a particle of a layer enters inside of the surface of a rigid body; x: where, m. */
static bool is_within(const struct mesh_query *surface, const struct scene_inlet *inlet,
                      double x[3]) {
    for (int k = 0; k < inlet->layer.count; k++) {
        inlet_place(inlet, k, 0.0, 0.0, x);
        if (mesh_query_contains(surface, x)) return true;
    }
    return false;
}

static void check_way(struct pdyn_sim *sim, const pdyn_body *body, int number,
                      const struct mesh_query *query, const struct scene_body *surface) {
    const struct scene_inlet *inlet = &sim->scene.body[body - sim->body].inlet[number];
    double spacing = 2.0 * body->radius, x[3];
    if (is_in_way(query, inlet, spacing, x))
        WARN(sim, BLOCKED, body->name,
             "inlet %d moves its layers through \"%s\", near (%.4g, %.4g, %.4g) m; expected no "
             "surface from %.4g m behind the opening to %.4g m in front of it",
             number, surface->name, x[0], x[1], x[2], INLET_BEHIND * spacing,
             INLET_STAGGER * spacing);
    else if (surface->is_rigid && is_within(query, inlet, x))
        WARN(sim, BLOCKED, body->name,
             "inlet %d is inside of the rigid body \"%s\", near (%.4g, %.4g, %.4g) m, and contact "
             "keeps there what enters; expected an opening outside of it",
             number, surface->name, x[0], x[1], x[2]);
}

/* Layers move through a surface that lies in their way: no step solves that with contact. A sheet
 * may hold what enters inside of it, as a balloon does; a rigid body is solid there. */
static pdyn_status check_ways(struct pdyn_sim *sim, const struct scene_body *surface) {
    struct mesh_query query;
    pdyn_status status = mesh_query_create(sim->context, &surface->mesh, &query);
    if (status != PDYN_OK) return status;
    for (int b = 0; b < sim->bodies; b++)
        for (int k = 0; k < sim->scene.body[b].inlets; k++)
            check_way(sim, &sim->body[b], k, &query, surface);
    mesh_query_free(sim->context, &query);
    return PDYN_OK;
}

static void check_inlet(struct pdyn_sim *sim, const pdyn_body *body, int number) {
    const struct scene_inlet *inlet = &sim->scene.body[body - sim->body].inlet[number];
    check_cover(sim, body, number, &inlet->left_out, "these do not enter");
    check_cover(sim, body, number, &inlet->covered,
                "these enter all the same, as inlet or solid moves, and may burst out");
}

static pdyn_status check_surfaces(struct pdyn_sim *sim) {
    pdyn_status status = PDYN_OK;
    bool inlets = sim->live && sim->live->inlets;
    for (int b = 0; b < sim->bodies && inlets && status == PDYN_OK; b++)
        if (sim->body[b].triangles && sim->body[b].permeability == 0.0)
            status = check_ways(sim, &sim->scene.body[b]);
    return status;
}

/* ---- outlets --------------------------------------------------------------------------------- */

static void check_outlets(struct pdyn_sim *sim, const pdyn_body *body) {
    long live = 0, removed = 0;
    for (int i = body->first; i < body->first + body->count; i++) {
        if (!particle_is_live(sim, i)) continue;
        live++, removed += outlets_contain(&sim->scene, sim->x + 3 * (size_t)i);
    }
    if ((double)removed > max_removed * (double)live)
        WARN(sim, OUTLET, body->name,
             "outlets remove %ld of its %ld particles in the first step; an outlet around a scene "
             "needs \"outside\": true",
             removed, live);
}

/* ---- times ----------------------------------------------------------------------------------- */

/* What begins at a time, s, never does in a scene that ends before. */
static void check_time(struct pdyn_sim *sim, const char *subject, const char *what, double time) {
    double end = sim->scene.settings.duration;
    if (time > 0.0 && time >= end)
        WARN(sim, NEVER, subject, "%s begins at %g s, but the scene ends at %g s", what, time, end);
}

static void check_paths(struct pdyn_sim *sim, const char *subject,
                        const struct scene_constraint *c) {
    for (const pdyn_param *p = c->type->params; p->name; p++) {
        const pdyn_path *path = param_path(p, c->params);
        if (path && path->count > 1) check_time(sim, subject, p->name, path->key[0]);
    }
}

static void check_times_of_body(struct pdyn_sim *sim, const struct scene_body *body) {
    for (int k = 0; k < body->constraints; k++) {
        check_time(sim, body->name, body->constraint[k].type->name, body->constraint[k].from);
        check_paths(sim, body->name, &body->constraint[k]);
    }
    for (int k = 0; k < body->inlets; k++) {
        check_time(sim, body->name, "the flow of an inlet", body->inlet[k].start);
        if (body->inlet[k].motion.keys > 1)
            check_time(sim, body->name, "the motion of an inlet",
                       body->inlet[k].motion.key[0].time);
    }
}

/* ---- all ------------------------------------------------------------------------------------- */

pdyn_status warn_of_flow(struct pdyn_sim *sim) {
    for (int b = 0; b < sim->bodies; b++) {
        const struct scene_body *body = &sim->scene.body[b];
        check_times_of_body(sim, body);
        for (int k = 0; k < body->inlets; k++) check_inlet(sim, &sim->body[b], k);
        if (body_is_particles(&sim->body[b])) check_outlets(sim, &sim->body[b]);
    }
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct scene_motion *motion = &sim->scene.solid[s].motion;
        if (motion->keys > 1)
            check_time(sim, sim->scene.solid[s].name, "its motion", motion->key[0].time);
    }
    return sim->scene.has_contact ? check_surfaces(sim) : PDYN_OK;
}
