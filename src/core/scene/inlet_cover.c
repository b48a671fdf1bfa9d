/* The part of an inlet's opening that a solid covers, at the start of the scene:
 *
 *     opening  front
 *        o ---> x          one spacing apart; the fluid is free there
 *        o ---> x
 *     ===o======x=======   a wall: this particle would enter inside of it and burst out
 *
 * The opening itself may lie in a wall that the fluid flows out of, so the front is tested. */
#include "inlet_cover.h"

#include "geometry/mesh_query.h"
#include "inlet_motion.h"
#include "poses.h"
#include "vessel.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* A particle that enters closer to a surface, in radii, bursts away from it. Measured in a channel
 * 0.6 m long with water 0.1 m deep and 20 mm spacing, which flows at 0.5 m/s: the largest kinetic
 * energy is 1.3 times that of an opening that fits at 0.5 radii, 2.5 times at 0.25, 8 times at 0.
 */
static const double min_clearance = 0.6;

struct cover {
    const struct scene_inlet *inlet;
    const struct scene_solid *solid;
    struct mesh_query query; /* of the solid at rest */
    double radius, plane;    /* m: of the particles; of the opening, along the flow at rest */
    double behind;           /* m: distance within which the walls of a vessel cover */
    bool inside;             /* particles inside of the solid are covered */
};

/* ---- places, in the coordinates of the solid at rest ----------------------------------------- */

/* The place of particle k of a layer, at a distance, m, in front of the opening. */
static void place(const struct cover *c, int k, double distance, double rest[3]) {
    const struct scene_inlet *inlet = c->inlet;
    double along = vec3_dot(inlet->layer.x + 3 * (size_t)k, inlet->direction), x[3];
    inlet_place(inlet, k, c->plane + distance - along, 0.0, x);
    pose_to_rest(&c->solid->motion, 0.0, x, rest);
}

static void place_front(const struct cover *c, int k, double rest[3]) {
    place(c, k, 2.0 * c->radius, rest);
}

static bool is_close(const struct cover *c, const double rest[3]) {
    return mesh_query_is_close(&c->query, rest, min_clearance * c->radius);
}

static bool is_covered(const struct cover *c, int k) {
    double front[3];
    place_front(c, k, front);
    if (is_close(c, front)) return true;
    if (c->solid->is_vessel) return vessel_is_behind_wall(c->solid, front, c->behind);
    return c->inside && mesh_query_contains(&c->query, front);
}

/* ---- solids ---------------------------------------------------------------------------------- */

/* Whether most of a layer flows within a closed solid, and does not enter it from outside. */
static bool flows_within(const struct cover *c) {
    int within = 0, outside = 0, count = c->inlet->layer.count;
    for (int k = 0; k < count; k++) {
        double front[3], opening[3];
        place_front(c, k, front);
        place(c, k, 0.0, opening);
        within += mesh_query_contains(&c->query, front);
        outside += !mesh_query_contains(&c->query, opening) && !is_close(c, opening);
    }
    return 2 * within > count && 2 * outside <= count;
}

/* Whether at least half of a layer flows within the box of a vessel. */
static bool flows_within_box(const struct cover *c) {
    int within = 0, count = c->inlet->layer.count;
    for (int k = 0; k < count; k++) {
        double front[3];
        place_front(c, k, front);
        within += box_contains(&c->solid->box, front);
    }
    return 2 * within >= count;
}

static pdyn_status find_inside(pdyn_context *context, struct cover *c) {
    const struct scene_solid *solid = c->solid;
    if (solid->is_vessel) {
        c->behind = flows_within_box(c) ? INFINITY : VESSEL_WALL_REACH * c->radius;
        return PDYN_OK;
    }
    pdyn_status closed = mesh_check_closed(context, &solid->mesh, solid->name);
    c->inside = closed == PDYN_OK && !flows_within(c);
    return closed == PDYN_NO_MEMORY ? closed : PDYN_OK;
}

/* Whether the solid may cover some particle. */
static bool is_near(const struct cover *c) {
    struct box layer = box_empty,
               solid = box_around(c->solid->mesh.vertex, c->solid->mesh.vertices);
    for (int k = 0; k < c->inlet->layer.count; k++) {
        double front[3];
        place_front(c, k, front);
        box_add(&layer, front);
    }
    box_grow(&layer, VESSEL_WALL_REACH * c->radius);
    return box_overlaps(&layer, &solid);
}

/* ---- layers ---------------------------------------------------------------------------------- */

static void count_covered(struct scene_cover *sum, const struct cover *c, int k) {
    if (sum->count++) return;
    sum->solid = c->solid;
    inlet_place(c->inlet, k, 0.0, 0.0, sum->first);
}

/* Counts the particles that the solid covers, and leaves them out of the layer if it rests. */
static struct scene_cover uncover(const struct cover *c, struct scene_inlet *inlet, bool rests) {
    struct scene_cover found = {0};
    int kept = 0;
    for (int k = 0; k < inlet->layer.count; k++) {
        bool covered = is_covered(c, k);
        if (covered) count_covered(&found, c, k);
        if (covered && rests) continue;
        memmove(inlet->layer.x + 3 * (size_t)kept++, inlet->layer.x + 3 * (size_t)k,
                3 * sizeof *inlet->layer.x);
    }
    inlet->layer.count = kept;
    return found;
}

static void add_cover(struct scene_cover *sum, const struct scene_cover *found) {
    if (sum->count) sum->count += found->count;
    else *sum = *found;
}

static pdyn_status resolve_near(const struct json_at *at, const struct cover *c,
                                struct scene_inlet *inlet) {
    bool rests = inlet->motion.keys <= 1 && c->solid->motion.keys <= 1;
    const struct scene_cover found = uncover(c, inlet, rests);
    const double *x = found.first;
    add_cover(rests ? &inlet->left_out : &inlet->covered, &found);
    if (inlet->layer.count) return PDYN_OK;
    return json_fail(at,
                     "solid \"%s\" covers %d particles of a layer, the first at (%.6g, %.6g, %.6g) "
                     "m, and none is left to flow in; expected an opening that flows beside solids "
                     "or out of a wall",
                     c->solid->name, found.count, x[0], x[1], x[2]);
}

static pdyn_status resolve_solid(const struct json_at *at, struct cover *c,
                                 struct scene_inlet *inlet) {
    pdyn_context *context = at->file->context;
    if (!is_near(c)) return PDYN_OK;
    pdyn_status status = mesh_query_create(context, &c->solid->mesh, &c->query);
    if (status != PDYN_OK) return status;
    status = find_inside(context, c);
    if (status == PDYN_OK) status = resolve_near(at, c, inlet);
    mesh_query_free(context, &c->query);
    return status;
}

/* The hindmost particles of a layer lie in the opening. */
static double plane_of(const struct scene_inlet *inlet) {
    double plane = INFINITY;
    for (int k = 0; k < inlet->layer.count; k++)
        plane = fmin(plane, vec3_dot(inlet->layer.x + 3 * (size_t)k, inlet->direction));
    return plane;
}

static pdyn_status resolve_inlet(const struct json_at *at, const struct scene *scene,
                                 const struct scene_body *body, struct scene_inlet *inlet) {
    pdyn_status status = PDYN_OK;
    double plane = plane_of(inlet);
    for (int s = 0; s < scene->solids && status == PDYN_OK; s++) {
        struct cover cover = {
            .inlet = inlet, .solid = &scene->solid[s], .radius = body->radius, .plane = plane};
        status = resolve_solid(at, &cover, inlet);
    }
    return status;
}

static void note_left_out(pdyn_context *context, const struct scene_body *body, int number) {
    const struct scene_inlet *inlet = &body->inlet[number];
    int left_out = inlet->left_out.count;
    if (left_out)
        context_log(
            context, PDYN_LOG_INFO,
            "body \"%s\": solids cover %d of %d particles of a layer of inlet %d, and these "
            "do not enter",
            body->name, left_out, inlet->layer.count + left_out, number);
}

pdyn_status inlet_cover_resolve(const struct json_at *at, const struct scene *scene,
                                struct scene_body *body) {
    struct json_at array = json_member(at, "inlets");
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < body->inlets && status == PDYN_OK; k++) {
        struct json_at inlet = json_element(&array, (size_t)k);
        status = resolve_inlet(&inlet, scene, body, &body->inlet[k]);
        if (status == PDYN_OK) note_left_out(at->file->context, body, k);
    }
    return status;
}
