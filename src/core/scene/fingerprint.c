#include "fingerprint.h"

#include "base/snapshot_file.h"
#include "json_file.h"
#include "table.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- values ---------------------------------------------------------------------------------- */

/* A copy of an object without some keys; NULL: no object, or no memory. */
static json_t *without(const json_t *object, const char *const *keys) {
    json_t *copy = json_copy((json_t *)object);
    for (; copy && *keys; keys++) json_object_del(copy, *keys);
    return copy;
}

/* Removes keys from a member of a copy of the scene, and the member if it becomes empty. */
static void ignore_keys(json_t *values, const char *member, const char *const *keys) {
    json_t *part = without(json_object_get(values, member), keys);
    if (part && json_object_size(part)) json_object_set_new(values, member, part);
    else json_decref(part), json_object_del(values, member);
}

/* Removes colours from a list of bodies or solids of a copy of the scene. */
static void ignore_colors(json_t *values, const char *list) {
    static const char *const color[] = {"color", NULL};
    json_t *copy = json_copy(json_object_get(values, list)), *one;
    size_t k;
    json_array_foreach(copy, k, one) json_array_set_new(copy, k, without(one, color));
    if (copy) json_object_set_new(values, list, copy);
}

/* Tables may come from files, whose numbers are not in the values. */
static uint64_t hash_tables(const struct scene *scene, uint64_t hash) {
    for (int b = 0; b < scene->bodies; b++)
        for (int k = 0; k < scene->body[b].constraints; k++) {
            const struct scene_constraint *c = &scene->body[b].constraint[k];
            hash = table_hash(hash, c->type->params, c->params);
        }
    return hash;
}

/* All keys of a scene but "$schema", "name" and "duration", which may change in a run, as may what
 * fixed_values leaves out: colours, step lengths, and tolerances and iterations of the solver. */
static const char *const keys[FINGERPRINTS] = {
    "bodies", "solids",  "contact",  "outlets", "probes",         "gravity",
    "solver", "plugins", "boundary", "kernel",  "frame_interval", "time_step"};

const char *fingerprint_key(int k) { return keys[k]; }

/* A copy of the scene without values that may change in a run. NULL: no memory. */
static json_t *fixed_values(const json_t *root) {
    static const char *const step[] = {"fixed", "minimum", "maximum", "cfl", NULL};
    static const char *const solver[] = {
        "tolerance", "outer_iterations", "linear_tolerance", "linear_iterations", "retries", NULL};
    json_t *values = json_copy((json_t *)root); /* without memory it may lack values */
    if (values) ignore_keys(values, "time_step", step), ignore_keys(values, "solver", solver);
    if (values) ignore_colors(values, "bodies"), ignore_colors(values, "solids");
    return values;
}

pdyn_status fingerprint_compute(pdyn_context *context, const json_t *root, struct scene *scene) {
    errno = 0;
    json_t *values = fixed_values(root);
    bool good = values && errno != ENOMEM;
    for (int k = 0; k < FINGERPRINTS && good; k++) {
        json_t *value = json_object_get(values, keys[k]);
        if (json_is_array(value) && !json_array_size(value)) value = NULL; /* as its default */
        char *dump =
            value ? json_compose(value, JSON_COMPACT | JSON_SORT_KEYS | JSON_ENCODE_ANY) : NULL;
        scene->fingerprint[k] = hash_bytes(HASH_BEGIN, dump, dump ? strlen(dump) : 0);
        good = dump || !value;
        free(dump);
    }
    json_decref(values);
    if (!good) return context_no_memory(context);
    scene->fingerprint[0] = hash_tables(scene, scene->fingerprint[0]);
    return PDYN_OK;
}

/* ---- meshes ---------------------------------------------------------------------------------- */

static uint64_t hash_triangles(uint64_t hash, const struct mesh *mesh) {
    return hash_bytes(hash, mesh->triangle, 3 * (size_t)mesh->triangles * sizeof *mesh->triangle);
}

uint64_t fingerprint_of_meshes(const struct scene *scene) {
    uint64_t hash = HASH_BEGIN;
    for (int b = 0; b < scene->bodies; b++) {
        const struct tets *tets = &scene->body[b].tets;
        hash = hash_triangles(hash, &scene->body[b].mesh);
        hash = hash_bytes(hash, tets->corner, 4 * (size_t)tets->count * sizeof *tets->corner);
    }
    for (int s = 0; s < scene->solids; s++) {
        const struct mesh *mesh = &scene->solid[s].mesh;
        hash = hash_bytes(hash, mesh->vertex, 3 * (size_t)mesh->vertices * sizeof *mesh->vertex);
        hash = hash_triangles(hash, mesh);
    }
    return hash;
}
