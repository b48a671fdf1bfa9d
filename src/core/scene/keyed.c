#include "keyed.h"

#include "angles.h"
#include "base/param_kind.h"
#include "params.h"

#include <limits.h>
#include <string.h>

/* ---- keys ------------------------------------------------------------------------------------ */

bool keyed_given(const struct json_at *at) { return json_is_object(json_array_get(at->value, 0)); }

pdyn_status keyed_refuse_rows(const struct json_at *at, const pdyn_param *p) {
    size_t numbers = json_array_size(json_array_get(at->value, 0));
    if (numbers != 1 + (size_t)param_numbers(p)) return PDYN_OK;
    return json_fail(at,
                     "expected values over time as [{\"time\": 0, \"%s\": ...}, ...], found arrays "
                     "of %zu",
                     p->name, numbers);
}

const pdyn_param keyed_time_param = {.name = "time",
                                     .kind = PDYN_REAL,
                                     .required = true,
                                     .min = -SCENE_MAX_TIME,
                                     .max = SCENE_MAX_TIME,
                                     .unit = "s",
                                     .doc = ""};

pdyn_status keyed_check_time(const struct json_at *at, double before, double time) {
    if (time > before) return PDYN_OK;
    return json_fail(at, "expected a time after %.10g s, found %.10g s", before, time);
}

static pdyn_status read_numbers(const struct json_at *owner, const pdyn_param *p, double *out) {
    struct json_at at = json_member(owner, p->name);
    int numbers = param_numbers(p);
    pdyn_status status = numbers == 1 ? params_real(&at, p->min, p->max, p->unit, out)
                                      : params_reals(&at, numbers, p->min, p->max, p->unit, out);
    if (status == PDYN_OK) angles_note(&at, p->unit, out, numbers);
    return status;
}

/* Reads {"time": s, "NAME": value}. */
static pdyn_status read_key(const struct json_at *at, const pdyn_param *p, double key[4]) {
    const char *const names[] = {keyed_time_param.name, p->name, NULL};
    pdyn_status status = params_check_keys(at, NULL, names);
    if (status == PDYN_OK) status = read_numbers(at, &keyed_time_param, key);
    return status == PDYN_OK ? read_numbers(at, p, key + 1) : status;
}

pdyn_status keyed_read_path(const struct json_at *at, const pdyn_param *param, pdyn_path *out) {
    size_t count = json_array_size(at->value);
    if (count > INT_MAX / 4) return json_fail(at, "more than %d keys", INT_MAX / 4);
    double *key = NEW_ARRAY(at->file->context, 4 * count, double);
    if (!key) return PDYN_NO_MEMORY;
    *out = (pdyn_path){(int)count, key};
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < count && status == PDYN_OK; k++, key += 4) {
        struct json_at element = json_element(at, k);
        status = read_key(&element, param, key);
        struct json_at time = json_member(&element, keyed_time_param.name);
        if (status == PDYN_OK && k) status = keyed_check_time(&time, key[-4], key[0]);
    }
    return status;
}

pdyn_status keyed_set_path(pdyn_context *context, pdyn_path *path, const double *key, int count) {
    double *copy = NEW_ARRAY(context, 4 * (size_t)count, double);
    if (!copy) return PDYN_NO_MEMORY;
    memcpy(copy, key, 4 * (size_t)count * sizeof *copy);
    keyed_free_path(context, path);
    *path = (pdyn_path){count, copy};
    return PDYN_OK;
}

void keyed_persist_path(pdyn_context *context, pdyn_path *path, struct snapshot_file *file) {
    int count = path->count;
    snapshot_file_count(file, &count, 4 * sizeof(double), "the number of keys is out of range");
    if (file->status != PDYN_OK) return;
    if (file->view.reading) {
        keyed_free_path(context, path);
        *path = (pdyn_path){0};
        double *key = NEW_ARRAY(context, 4 * (size_t)count, double);
        if (count && !key) file->status = PDYN_NO_MEMORY;
        else *path = (pdyn_path){count, key};
    }
    snapshot_file_range(file, (double *)path->key, 4 * (size_t)path->count, SCENE_MAX_POSITION,
                        "a key of a path is out of range");
    for (int k = 4; k < 4 * path->count; k += 4)
        snapshot_file_require(file, path->key[k] > path->key[k - 4], "keys are not in order");
}

void keyed_free_path(pdyn_context *context, pdyn_path *path) {
    FREE_ARRAY(context, path->key, 4 * (size_t)path->count);
}

/* ---- parameters of a constraint -------------------------------------------------------------- */

/* Whether there are keys for a parameter. Others than numbers may be arrays of objects, too. */
static bool has_keys(const struct json_at *object, const pdyn_param *p) {
    struct json_at at = json_member(object, p->name);
    return param_numbers(p) && keyed_given(&at);
}

static int count_keyed(const struct json_at *object, const pdyn_param *p) {
    int count = 0;
    for (; p->name; p++) count += has_keys(object, p);
    return count;
}

bool keyed_allowed(const pdyn_constraint_type *type, const pdyn_param *p) {
    int numbers = param_numbers(p);
    return param_is_changeable(type, p) && numbers >= 1 && numbers <= 3 &&
           (!param_is_table(p) || (param_rows(p, 1, 1, 1) && !param_vertices(p)));
}

static pdyn_status refuse_rows(const struct json_at *object, const pdyn_constraint_type *type) {
    pdyn_status status = PDYN_OK;
    for (const pdyn_param *p = type->params; p->name && status == PDYN_OK; p++) {
        struct json_at at = json_member(object, p->name);
        if (keyed_allowed(type, p)) status = keyed_refuse_rows(&at, p);
    }
    return status;
}

static pdyn_status read_all_keys(const struct json_at *object, struct scene_constraint *c) {
    pdyn_context *context = object->file->context;
    pdyn_status status = PDYN_OK;
    int count = count_keyed(object, c->type->params);
    struct scene_keyed *keyed = c->keyed = NEW_ARRAY(context, count, struct scene_keyed);
    if (!count) return PDYN_OK;
    if (!keyed) return PDYN_NO_MEMORY;
    c->keyed_params = count;
    for (const pdyn_param *p = c->type->params; p->name && status == PDYN_OK; p++) {
        struct json_at at = json_member(object, p->name);
        if (!has_keys(object, p)) continue;
        if (!keyed_allowed(c->type, p))
            return json_fail(&at, "\"%s\" cannot change over time, found keys", p->name);
        keyed->param = p;
        status = keyed_read_path(&at, p, &keyed++->path);
    }
    return status;
}

/* A copy of the object in which the first value of each parameter stands for its keys; NULL: no
 * memory. */
static json_t *with_first_values(const struct json_at *object, const struct scene_constraint *c) {
    json_t *copy = json_copy(object->value);
    for (int k = 0; copy && k < c->keyed_params; k++) {
        const char *name = c->keyed[k].param->name;
        json_t *first = json_array_get(json_object_get(object->value, name), 0);
        if (json_object_set(copy, name, json_object_get(first, name)) == 0) continue;
        json_decref(copy);
        return NULL;
    }
    return copy;
}

pdyn_status keyed_read_params(const struct json_at *object, const struct scene_body *body,
                              struct scene_constraint *c) {
    struct json_at at = *object;
    pdyn_status status = refuse_rows(object, c->type);
    if (status == PDYN_OK) status = read_all_keys(object, c);
    if (status != PDYN_OK) return status;
    if (!c->keyed_params) return params_read(object, c->type->params, body, c->params);
    at.value = with_first_values(object, c);
    if (!at.value) return context_no_memory(object->file->context);
    status = params_read(&at, c->type->params, body, c->params);
    json_decref(at.value);
    return status;
}

void keyed_free(pdyn_context *context, struct scene_constraint *c) {
    for (int k = 0; k < c->keyed_params; k++) keyed_free_path(context, &c->keyed[k].path);
    FREE_ARRAY(context, c->keyed, c->keyed_params);
}
