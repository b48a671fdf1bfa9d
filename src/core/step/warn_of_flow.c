/* Warnings about inlets and outlets, and about what would begin after the end of the scene. */
#include "base/registry.h"
#include "live_particles.h"
#include "scene/inlet_motion.h"
#include "sim.h"
#include "warn.h"

#include "projdyn/vec3.h"

#include <string.h>

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

/* Six times the volume of a tetrahedron, m^3. */
static double volume6(const double *a, const double *b, const double *c, const double *d) {
    double n[3], e[3];
    vec3_normal(n, a, b, c);
    vec3_subtract(e, d, a);
    return vec3_dot(n, e);
}

/* Whether the segment from p to q crosses a triangle. */
static bool crosses(double triangle[3][3], const double p[3], const double q[3]) {
    const double *a = triangle[0], *b = triangle[1], *c = triangle[2];
    double side = volume6(p, q, a, b);
    return volume6(a, b, c, p) * volume6(a, b, c, q) < 0.0 && side * volume6(p, q, b, c) >= 0.0 &&
           side * volume6(p, q, c, a) >= 0.0;
}

/* The way of particle k of a layer: from one spacing behind the opening to half a spacing in front
 * of it. */
static void way_of(const struct scene_inlet *inlet, int k, double spacing, double p[3],
                   double q[3]) {
    double direction[3];
    inlet_direction(inlet, 0.0, direction);
    memcpy(p, inlet->layer.x + 3 * (size_t)k, 3 * sizeof *p);
    inlet_place(inlet, 0.0, p);
    memcpy(q, p, 3 * sizeof *q);
    vec3_add(p, -spacing, direction), vec3_add(q, 0.5 * spacing, direction);
}

/* Particle of a layer whose way crosses the surface; -1: none. */
static int find_crossing(const struct pdyn_sim *sim, const struct scene_inlet *inlet,
                         double spacing, const pdyn_body *surface) {
    double p[3], q[3], corner[3][3];
    struct box ways = box_empty;
    for (int k = 0; k < inlet->layer.count; k++)
        way_of(inlet, k, spacing, p, q), box_add(&ways, p), box_add(&ways, q);
    for (int t = 0; t < surface->triangles; t++) {
        for (int i = 0; i < 3; i++) {
            size_t vertex = (size_t)surface->first + (size_t)surface->triangle[3 * t + i];
            memcpy(corner[i], sim->x + 3 * vertex, sizeof corner[i]);
        }
        struct box box = box_around(corner[0], 3);
        for (int k = 0; box_overlaps(&box, &ways) && k < inlet->layer.count; k++) {
            way_of(inlet, k, spacing, p, q);
            if (crosses(corner, p, q)) return k;
        }
    }
    return -1;
}

/* Layers move through a surface that lies in their way: no step solves that with contact. */
static void check_ways(struct pdyn_sim *sim, const pdyn_body *body, int number) {
    const struct scene_inlet *inlet = &sim->scene.body[body - sim->body].inlet[number];
    double spacing = 2.0 * body->radius, p[3], q[3];
    for (int b = 0; b < sim->bodies && sim->scene.has_contact; b++) {
        if (sim->body[b].permeability > 0.0) continue;
        int k = find_crossing(sim, inlet, spacing, &sim->body[b]);
        if (k < 0) continue;
        way_of(inlet, k, spacing, p, q);
        WARN(sim, BLOCKED, body->name,
             "inlet %d moves its layers through \"%s\", near (%.4g, %.4g, %.4g) m; expected no "
             "surface from %.4g m behind the opening to %.4g m in front of it",
             number, sim->body[b].name, p[0], p[1], p[2], spacing, 0.5 * spacing);
    }
}

static void check_inlet(struct pdyn_sim *sim, const pdyn_body *body, int number) {
    const struct scene_inlet *inlet = &sim->scene.body[body - sim->body].inlet[number];
    check_cover(sim, body, number, &inlet->left_out, "these do not enter");
    check_cover(sim, body, number, &inlet->covered,
                "these enter all the same, as inlet or solid moves, and may burst out");
    check_ways(sim, body, number);
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

void warn_of_flow(struct pdyn_sim *sim) {
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
}
