#include "given_motion.h"

#include "scene/poses.h"
#include "sim.h"

#include <math.h>
#include <string.h>

struct scene_key given_key(double time, const double translate[3], const double rotate[3]) {
    struct scene_key key = {.time = time};
    memcpy(key.translate, translate, sizeof key.translate);
    memcpy(key.rotate, rotate, sizeof key.rotate);
    return key;
}

static pdyn_status fail(const char *what, const char *expected) {
    return set_error(PDYN_BAD_INPUT, "%s: expected %s", what, expected);
}

static pdyn_status check(struct pdyn_sim *sim, const struct scene_motion *motion, const char *what,
                         const struct scene_key *to) {
    if (!motion->keys) return fail(what, "\"motion\" in the scene, with at least one key");
    if (!(to->time > sim->time && to->time <= SCENE_MAX_TIME))
        return fail(what, "a time after that of the simulation");
    for (int a = 0; a < 3; a++)
        if (!(fabs(to->translate[a]) <= SCENE_MAX_POSITION &&
              fabs(to->rotate[a]) <= SCENE_MAX_ANGLE))
            return fail(what, "finite coordinates and angles up to 1e6");
    return PDYN_OK;
}

struct scene_key given_motion_at(const struct scene_motion *motion, double time) {
    struct pose pose = pose_at(motion, time);
    struct scene_key key = given_key(time, pose.at.translate, pose.at.rotate);
    for (int a = 0; a < 3; a++) key.translate[a] -= motion->pivot[a];
    return key;
}

static pdyn_status resize_keys(struct pdyn_sim *sim, struct scene_motion *motion, int count) {
    if (count == motion->keys) return PDYN_OK;
    struct scene_key *key = NEW_ARRAY(sim->context, count, struct scene_key);
    if (!key) return PDYN_NO_MEMORY;
    FREE_ARRAY(sim->context, motion->key, motion->keys);
    motion->key = key, motion->keys = count;
    return PDYN_OK;
}

pdyn_status given_motion(struct pdyn_sim *sim, struct scene_motion *motion, const char *what,
                         const struct scene_key *to) {
    pdyn_status status = check(sim, motion, what, to);
    if (status != PDYN_OK) return status;
    struct scene_key from = given_motion_at(motion, sim->time);
    status = resize_keys(sim, motion, 2);
    if (status != PDYN_OK) return status;
    motion->key[0] = from, motion->key[1] = *to;
    sim->control.driven = true;
    return PDYN_OK;
}

void given_motion_persist(struct pdyn_sim *sim, struct scene_motion *motion,
                          struct snapshot_file *file) {
    int count = motion->keys;
    if (!count) return;
    snapshot_file_count(file, &count, sizeof *motion->key, "the number of keys is out of range");
    snapshot_file_require(file, count > 0, "a motion has no key");
    if (file->status == PDYN_OK) file->status = resize_keys(sim, motion, count);
    for (int k = 0; k < count && file->status == PDYN_OK; k++) {
        struct scene_key *key = &motion->key[k];
        snapshot_file_range(file, &key->time, 1, SCENE_MAX_TIME, "a time of a key");
        snapshot_file_range(file, key->translate, 3, SCENE_MAX_POSITION, "a translation of a key");
        snapshot_file_range(file, key->rotate, 3, SCENE_MAX_ANGLE, "a rotation of a key");
        snapshot_file_require(file, !k || key->time > key[-1].time, "keys are not in order");
    }
}
