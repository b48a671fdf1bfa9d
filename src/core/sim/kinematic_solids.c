/* Solids with prescribed motion: boundary points, motion and speed. */
#include "kinematic_solids.h"

#include "base/bad_call.h"
#include "given_motion.h"
#include "scene/poses.h"
#include "sim.h"
#include "solid_points.h"

#include "projdyn/control.h"
#include "projdyn/vec3.h"

#include <stdio.h>
#include <string.h>

/* ---- points ---------------------------------------------------------------------------------- */

static pdyn_status allocate_solids(struct pdyn_sim *sim) {
    struct kinematic_solids *moving = &sim->kinematic;
    if (moving->solid) return PDYN_OK;
    moving->solid = NEW_ARRAY(sim->context, sim->scene.solids, struct moving_solid);
    if (!moving->solid) return PDYN_NO_MEMORY;
    moving->capacity = sim->scene.solids;
    return PDYN_OK;
}

static bool needs_layer(const struct scene *scene) {
    for (int b = 0; b < scene->bodies; b++)
        for (int k = 0; k < scene->body[b].constraints; k++)
            if (scene->body[b].constraint[k].type->flags & PDYN_FIRST_LAYER) return true;
    return false;
}

/* Adds the boundary point i, and, with `layer`, its place in the first layer: a point of a box
 * lies behind the face, and fluid rests half a spacing before it. */
static pdyn_status add_point(struct pdyn_sim *sim, int i, bool layer) {
    struct kinematic_solids *moving = &sim->kinematic;
    const struct boundary_point *point = &sim->boundary.point[i];
    double at[3], layer_distance = sim_behind_faces(sim) + 0.5 * sim_spacing(sim);
    memcpy(at, sim->boundary.at.x + 3 * (size_t)i, sizeof at);
    pdyn_status status = point_list_add(sim->context, &moving->rest, at);
    if (!layer) return status;
    if (point->of_box) vec3_add(at, layer_distance, point->normal);
    if (status == PDYN_OK) status = point_list_add(sim->context, &moving->rest_layer, at);
    return status == PDYN_OK ? point_list_add(sim->context, &moving->layer, at) : status;
}

pdyn_status kinematic_add(struct pdyn_sim *sim, const struct scene_solid *solid, int first) {
    struct kinematic_solids *moving = &sim->kinematic;
    struct moving_solid m = {solid, first, sim->boundary.at.count - first, {{0}, {0}}};
    pdyn_status status = allocate_solids(sim);
    bool layer = needs_layer(&sim->scene);
    for (int i = first; i < sim->boundary.at.count && status == PDYN_OK; i++)
        status = add_point(sim, i, layer);
    if (status != PDYN_OK) return status;
    if (m.count) m.box = box_around(moving->rest.x + 3 * (size_t)moving->points, m.count);
    moving->solid[moving->solids++] = m;
    moving->points = moving->rest.count;
    return PDYN_OK;
}

void kinematic_free(pdyn_context *context, struct kinematic_solids *moving) {
    FREE_ARRAY(context, moving->solid, moving->capacity);
    point_list_free(context, &moving->rest);
    point_list_free(context, &moving->rest_layer);
    point_list_free(context, &moving->layer);
}

int kinematic_first_point(const struct pdyn_sim *sim) {
    return sim->boundary.at.count - sim->kinematic.points;
}

/* ---- motion ---------------------------------------------------------------------------------- */

void kinematic_move(struct pdyn_sim *sim, double time) {
    const struct kinematic_solids *moving = &sim->kinematic;
    int resting = kinematic_first_point(sim);
    if (!moving->points) return;
    for (int k = 0; k < moving->solids; k++) {
        const struct moving_solid *m = &moving->solid[k];
        size_t at = 3 * (size_t)(m->first - resting);
        pose_place(&m->solid->motion, moving->rest.x + at, m->count, time,
                   sim->boundary.at.x + 3 * (size_t)m->first);
        if (sim->face_x) {
            double *face = sim->face_x + 3 * (size_t)m->first;
            solid_points_find_faces(sim, m->first, m->count, moving->rest.x + at);
            pose_place(&m->solid->motion, face, m->count, time, face);
        }
        if (!moving->layer.count) continue;
        pose_place(&m->solid->motion, moving->rest_layer.x + at, m->count, time,
                   moving->layer.x + at);
    }
    if (sim->objective.neighbours)
        neighbours_move_boundary(sim->objective.neighbours,
                                 sim->boundary.at.x + 3 * (size_t)resting);
}

/* ---- speed ----------------------------------------------------------------------------------- */

double kinematic_speed(const struct kinematic_solids *moving, double from, double to) {
    double speed = 0.0;
    for (int k = 0; k < moving->solids; k++)
        speed = fmax(speed, pose_top_speed(&moving->solid[k].solid->motion, &moving->solid[k].box,
                                           from, to));
    return speed;
}

double kinematic_top_speed(const struct pdyn_sim *sim) {
    double speed = 0.0, end = sim->scene.settings.duration;
    for (int s = 0; s < sim->scene.solids; s++)
        speed = fmax(speed, pose_top_speed_of_mesh(&sim->scene.solid[s], end));
    return speed;
}

/* ---- motion that a program gives, saving ----------------------------------------------------- */

pdyn_status pdyn_move_solid(pdyn_sim *sim, int solid, double time, const double translate[3],
                            const double rotate[3]) {
    char what[128];
    if (HAS_NULL(sim, translate, rotate) || BAD_INDEX(solid, sim->scene.solids) ||
        control_refuses(__func__, sim))
        return PDYN_BAD_CALL;
    snprintf(what, sizeof what, "solid \"%s\"", sim->scene.solid[solid].name);
    struct scene_key to = given_key(time, translate, rotate);
    pdyn_status status = given_motion(sim, &sim->scene.solid[solid].motion, what, &to);
    if (status == PDYN_OK) kinematic_move(sim, sim->time);
    return status;
}

pdyn_status pdyn_solid_pose(const pdyn_sim *sim, int solid, double translate[3], double rotate[3]) {
    struct scene_key now = {0};
    if (HAS_NULL(sim, translate, rotate) || BAD_INDEX(solid, sim->scene.solids))
        return PDYN_BAD_CALL;
    const struct scene_motion *motion = &sim->scene.solid[solid].motion;
    if (motion->keys) now = given_motion_at(motion, sim->time);
    memcpy(translate, now.translate, sizeof now.translate);
    memcpy(rotate, now.rotate, sizeof now.rotate);
    return PDYN_OK;
}

void kinematic_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    for (int s = 0; s < sim->scene.solids && file->status == PDYN_OK; s++)
        given_motion_persist(sim, &sim->scene.solid[s].motion, file);
}
