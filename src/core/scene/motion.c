#include "motion.h"

#include "keyed.h"
#include "params.h"
#include "reader.h"

const pdyn_param scene_key_params[] = {
    {"time", PDYN_REAL, offsetof(struct scene_key, time), true, 0, -SCENE_MAX_TIME, SCENE_MAX_TIME,
     "s", ""},
    {"translate", PDYN_VECTOR, offsetof(struct scene_key, translate), false, 0, -SCENE_MAX_POSITION,
     SCENE_MAX_POSITION, "m", ""},
    {"rotate", PDYN_VECTOR, offsetof(struct scene_key, rotate), false, 0, -SCENE_MAX_ANGLE,
     SCENE_MAX_ANGLE, "degrees", ""},
    {0},
};

static pdyn_status read_keys(const struct json_at *array, struct scene_motion *motion) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < motion->keys && status == PDYN_OK; k++) {
        struct json_at at = json_element(array, (size_t)k);
        struct scene_key *key = &motion->key[k];
        status = params_read_object(&at, scene_key_params, key);
        if (status != PDYN_OK || !k) continue;
        struct json_at time = json_member(&at, "time");
        status = keyed_check_time(&time, key[-1].time, key->time);
    }
    return status;
}

pdyn_status motion_read(const struct json_at *owner, struct scene_motion *motion) {
    struct json_at keys = json_member(owner, "motion"), pivot = json_member(owner, "pivot");
    int count;
    if (!keys.value && pivot.value) return json_fail_at_key(&pivot, "\"pivot\" needs a \"motion\"");
    pdyn_status status = reader_count(&keys, "an array of keys", &count);
    if (status != PDYN_OK || !keys.value) return status;
    if (!count) return json_expected(&keys, "at least one key");
    if (pivot.value)
        status =
            params_reals(&pivot, 3, -SCENE_MAX_POSITION, SCENE_MAX_POSITION, "m", motion->pivot);
    if (status != PDYN_OK) return status;
    motion->key = NEW_ARRAY(owner->file->context, count, struct scene_key);
    if (!motion->key) return PDYN_NO_MEMORY;
    motion->keys = count;
    return read_keys(&keys, motion);
}

void motion_free(pdyn_context *context, struct scene_motion *motion) {
    FREE_ARRAY(context, motion->key, motion->keys);
}
