/* Solids with prescribed motion: boundary points, motion and speed. */
#include "kinematic_solids.h"

#include "scene/poses.h"
#include "sim.h"

#include "projdyn/control.h"
#include "projdyn/vec3.h"

#include <string.h>

/* ---- points ---------------------------------------------------------------------------------- */

static pdyn_status allocate_solids(struct pdyn_sim *sim) {
    struct kinematic_solids *motion = &sim->motion;
    if (motion->solid) return PDYN_OK;
    motion->solid = NEW_ARRAY(sim->context, sim->scene.solids, struct moving_solid);
    if (!motion->solid) return PDYN_NO_MEMORY;
    motion->capacity = sim->scene.solids;
    return PDYN_OK;
}

pdyn_status kinematic_add(struct pdyn_sim *sim, const struct scene_solid *solid, int first) {
    struct kinematic_solids *motion = &sim->motion;
    struct moving_solid m = {solid, first, sim->boundary.at.count - first, {{0}, {0}}};
    pdyn_status status = allocate_solids(sim);
    for (int i = first; i < sim->boundary.at.count && status == PDYN_OK; i++) {
        double from_pivot[3];
        vec3_subtract(from_pivot, sim->boundary.at.x + 3 * (size_t)i, solid->pivot);
        status = point_list_add(sim->context, &motion->placed, from_pivot);
    }
    if (status != PDYN_OK) return status;
    if (m.count) m.box = box_around(motion->placed.x + 3 * (size_t)motion->points, m.count);
    motion->solid[motion->solids++] = m;
    motion->points = motion->placed.count;
    return PDYN_OK;
}

void kinematic_free(pdyn_context *context, struct kinematic_solids *motion) {
    FREE_ARRAY(context, motion->solid, motion->capacity);
    point_list_free(context, &motion->placed);
}

/* ---- motion ---------------------------------------------------------------------------------- */

void kinematic_move(struct pdyn_sim *sim, double time) {
    const struct kinematic_solids *motion = &sim->motion;
    int resting = sim->boundary.at.count - motion->points;
    if (!motion->points) return;
    for (int k = 0; k < motion->solids; k++) {
        const struct moving_solid *m = &motion->solid[k];
        pose_place(m->solid, motion->placed.x + 3 * (size_t)(m->first - resting), m->count, time,
                   sim->boundary.at.x + 3 * (size_t)m->first);
    }
    if (sim->neighbours)
        neighbours_move_boundary(sim->neighbours, sim->boundary.at.x + 3 * (size_t)resting);
}

/* ---- speed ----------------------------------------------------------------------------------- */

/* Largest speed of the corners of the solid's bounding box; no point is faster. */
static double max_corner_speed(const struct moving_solid *m, const struct pose *pose) {
    double axis[3], speed = 0.0;
    pose_turning_axis(pose, axis);
    for (int corner = 0; corner < 8; corner++) {
        double r[3], v[3];
        for (int a = 0; a < 3; a++) r[a] = corner >> a & 1 ? m->box.max[a] : m->box.min[a];
        transform_directions(&pose->at, r, 1);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            v[a] = pose->velocity[a] + axis[b] * r[c] - axis[c] * r[b];
        }
        speed = fmax(speed, vec3_length(v));
    }
    return speed;
}

/* Largest speed between two times: evaluated at both ends of every interval between keys. */
static double max_solid_speed(const struct moving_solid *m, double from, double to) {
    const struct scene_solid *solid = m->solid;
    double speed = 0.0;
    for (int k = pose_key_before(solid, from); k < solid->keys; k++) {
        double begin = k < 0 ? from : fmax(from, solid->key[k].time);
        double end = k + 1 < solid->keys ? fmin(to, solid->key[k + 1].time) : to;
        if (begin >= to) break;
        struct pose first = pose_between(solid, k, begin), last = pose_between(solid, k, end);
        speed = fmax(speed, fmax(max_corner_speed(m, &first), max_corner_speed(m, &last)));
    }
    return speed;
}

double kinematic_speed(const struct kinematic_solids *motion, double from, double to) {
    double speed = 0.0;
    for (int k = 0; k < motion->solids; k++)
        speed = fmax(speed, max_solid_speed(&motion->solid[k], from, to));
    return speed;
}

/* The solid with the box of its mesh. */
static struct moving_solid whole_solid(const struct scene_solid *solid) {
    struct moving_solid m = {.solid = solid,
                             .box = box_around(solid->mesh.vertex, solid->mesh.vertices)};
    vec3_add(m.box.min, -1.0, solid->pivot), vec3_add(m.box.max, -1.0, solid->pivot);
    return m;
}

double kinematic_top_speed(const struct pdyn_sim *sim) {
    double speed = 0.0;
    for (int s = 0; s < sim->scene.solids; s++) {
        const struct scene_solid *solid = &sim->scene.solid[s];
        if (!solid->keys) continue;
        const struct moving_solid m = whole_solid(solid);
        speed = fmax(speed, max_solid_speed(&m, 0.0, sim->scene.settings.duration));
    }
    return speed;
}

/* ---- motion that a program gives ------------------------------------------------------------- */

static pdyn_status fail_move(struct pdyn_sim *sim, int solid, const char *expected) {
    return context_fail(sim->context, PDYN_BAD_INPUT, "solid \"%s\": expected %s",
                        sim->scene.solid[solid].name, expected);
}

static pdyn_status check_move(struct pdyn_sim *sim, int solid, const struct scene_key *key) {
    pdyn_status status = control_check(sim);
    if (status != PDYN_OK) return status;
    if (!sim->scene.solid[solid].keys)
        return fail_move(sim, solid, "\"motion\" in the scene, with at least one key");
    if (!(key->time > sim->time && key->time <= SCENE_MAX_POSITION))
        return fail_move(sim, solid, "a time after that of the simulation");
    for (int a = 0; a < 3; a++)
        if (!(fabs(key->translate[a]) <= SCENE_MAX_POSITION &&
              fabs(key->rotate[a]) <= SCENE_MAX_POSITION))
            return fail_move(sim, solid, "finite coordinates and angles up to 1e6");
    return PDYN_OK;
}

/* The pose of a solid at a time, as a key. */
static struct scene_key key_at(const struct scene_solid *solid, double time) {
    struct pose pose = pose_between(solid, pose_key_before(solid, time), time);
    struct scene_key key = {.time = time};
    for (int a = 0; a < 3; a++) {
        key.translate[a] = pose.at.translate[a] - solid->pivot[a];
        key.rotate[a] = pose.at.rotate[a];
    }
    return key;
}

static pdyn_status resize_keys(struct pdyn_sim *sim, struct scene_solid *solid, int count) {
    if (count == solid->keys) return PDYN_OK;
    struct scene_key *key = NEW_ARRAY(sim->context, count, struct scene_key);
    if (!key) return PDYN_NO_MEMORY;
    FREE_ARRAY(sim->context, solid->key, solid->keys);
    solid->key = key, solid->keys = count;
    return PDYN_OK;
}

pdyn_status pdyn_move_solid(pdyn_sim *sim, int solid, double time, const double translate[3],
                            const double rotate[3]) {
    struct scene_key key[2] = {{0}, {.time = time}};
    if (!pdyn_solid_name(sim, solid) || !translate || !rotate) return PDYN_BAD_CALL;
    memcpy(key[1].translate, translate, sizeof key->translate);
    memcpy(key[1].rotate, rotate, sizeof key->rotate);
    pdyn_status status = check_move(sim, solid, &key[1]);
    if (status != PDYN_OK) return status;
    struct scene_solid *moved = &sim->scene.solid[solid];
    key[0] = key_at(moved, sim->time);
    status = resize_keys(sim, moved, 2);
    if (status != PDYN_OK) return status;
    memcpy(moved->key, key, sizeof key);
    sim->control.driven = true;
    kinematic_move(sim, sim->time);
    return PDYN_OK;
}

static void persist_keys(struct pdyn_sim *sim, struct scene_solid *solid, struct snapshot_file *a) {
    int count = solid->keys;
    snapshot_file_count(a, &count, sizeof *solid->key, "the number of keys is out of range");
    snapshot_file_require(a, count > 0, "a moving solid has no key");
    if (a->status == PDYN_OK) a->status = resize_keys(sim, solid, count);
    for (int k = 0; k < count && a->status == PDYN_OK; k++) {
        struct scene_key *key = &solid->key[k];
        snapshot_file_range(a, &key->time, 1, SCENE_MAX_POSITION, "a time of a key");
        snapshot_file_range(a, key->translate, 3, SCENE_MAX_POSITION, "a translation of a key");
        snapshot_file_range(a, key->rotate, 3, SCENE_MAX_POSITION, "a rotation of a key");
        snapshot_file_require(a, !k || key->time > key[-1].time, "keys are not in order");
    }
}

void kinematic_persist(struct pdyn_sim *sim, struct snapshot_file *a) {
    for (int s = 0; s < sim->scene.solids && a->status == PDYN_OK; s++)
        if (sim->scene.solid[s].keys) persist_keys(sim, &sim->scene.solid[s], a);
}
