/* Reading JSON objects by tables of parameters. */
#include "params.h"

#include "angles.h"
#include "base/text.h"
#include "keyed.h"
#include "table.h"
#include "vertex_selection.h"

#include <limits.h>

enum { WHAT = 128 };

static pdyn_status read_vertices(const struct json_at *at, const pdyn_param *param,
                                 const struct scene_body *body, void *field) {
    (void)param;
    return vertex_selection_read(at, body->has_mesh ? &body->mesh : NULL, field);
}

static pdyn_status read_path(const struct json_at *at, const pdyn_param *param,
                             const struct scene_body *body, void *field) {
    (void)body;
    char unit[WHAT] = "", expected[WHAT] = "";
    pdyn_path *path = field;
    size_t count = json_array_size(at->value);
    text_append(unit, sizeof unit, "s, %s, %s, %s", param->unit, param->unit, param->unit);
    text_append(expected, sizeof expected, "an array of at least one [time, x, y, z] (%s)", unit);
    if (!count || count > INT_MAX / 4) return json_expected(at, expected);
    double *key = NEW_ARRAY(at->file->context, 4 * count, double);
    if (!key) return PDYN_NO_MEMORY;
    *path = (pdyn_path){(int)count, key};
    for (size_t k = 0; k < count; k++, key += 4) {
        struct json_at element = json_element(at, k);
        pdyn_status status =
            params_reals(&element, 4, -SCENE_MAX_POSITION, SCENE_MAX_POSITION, unit, key);
        if (status == PDYN_OK && k) status = keyed_check_time(&element, key[-4], key[0]);
        if (status != PDYN_OK) return status;
        angles_note(&element, param->unit, key + 1, 3);
    }
    return PDYN_OK;
}

/* Existence of the body is checked after all bodies were read (scene.c). */
static pdyn_status read_other(const struct json_at *at, const pdyn_param *param,
                              const struct scene_body *body, void *field) {
    (void)param, (void)body;
    if (!json_is_string(at->value)) return json_expected(at, "the name of another body");
    const char *name = context_copy_text(at->file->context, json_string_value(at->value));
    *(pdyn_other *)field = (pdyn_other){.name = name};
    return name ? PDYN_OK : PDYN_NO_MEMORY;
}

/* A number out of bounds is often meant for something else: the error says what the parameter is.
 */
static pdyn_status read_real(const struct json_at *at, const pdyn_param *param,
                             const struct scene_body *body, void *field) {
    (void)body;
    pdyn_status status = params_real(at, param->min, param->max, param->unit, field);
    if (status == PDYN_OK) angles_note(at, param->unit, field, 1);
    if (status == PDYN_OK || !json_is_number(at->value) || !*param->doc) return status;
    return set_error(status, "%s; meaning: %s", pdyn_last_error(NULL), param->doc);
}

static pdyn_status read_int(const struct json_at *at, const pdyn_param *param,
                            const struct scene_body *body, void *field) {
    (void)body;
    return params_int(at, param->min, param->max, field);
}

static pdyn_status read_bool(const struct json_at *at, const pdyn_param *param,
                             const struct scene_body *body, void *field) {
    (void)param, (void)body;
    *(bool *)field = json_is_true(at->value);
    return json_is_boolean(at->value) ? PDYN_OK : json_expected(at, "true or false");
}

static pdyn_status read_vector(const struct json_at *at, const pdyn_param *param,
                               const struct scene_body *body, void *field) {
    (void)body;
    pdyn_status status = params_reals(at, 3, param->min, param->max, param->unit, field);
    if (status == PDYN_OK) angles_note(at, param->unit, field, 3);
    return status;
}

static void default_real(const pdyn_param *param, void *field) { *(double *)field = param->def; }
static void default_int(const pdyn_param *param, void *field) { *(int *)field = (int)param->def; }
static void default_bool(const pdyn_param *param, void *field) {
    *(bool *)field = param->def != 0.0;
}
static void default_vector(const pdyn_param *param, void *field) {
    for (int k = 0; k < 3; k++) ((double *)field)[k] = param->def;
}

static pdyn_status read_table(const struct json_at *at, const pdyn_param *param,
                              const struct scene_body *body, void *field) {
    return table_read(at, param, body, field);
}

struct kind {
    pdyn_status (*read)(const struct json_at *at, const pdyn_param *param,
                        const struct scene_body *body, void *field);
    void (*set_default)(const pdyn_param *param, void *field); /* NULL: it stays zeroed */
};

static const struct kind kinds[] = {
    [PDYN_REAL] = {read_real, default_real}, [PDYN_INT] = {read_int, default_int},
    [PDYN_BOOL] = {read_bool, default_bool}, [PDYN_VECTOR] = {read_vector, default_vector},
    [PDYN_VERTICES] = {read_vertices, NULL}, [PDYN_PATH] = {read_path, NULL},
    [PDYN_OTHER] = {read_other, NULL},
};
static const struct kind tables = {read_table, NULL};

static const struct kind *kind_of(const pdyn_param *p) {
    return param_is_table(p) ? &tables : &kinds[p->kind];
}

pdyn_status params_read(const struct json_at *object, const pdyn_param *table,
                        const struct scene_body *body, void *params) {
    pdyn_status status = PDYN_OK;
    for (const pdyn_param *p = table; p->name; p++)
        if (kind_of(p)->set_default) kind_of(p)->set_default(p, (char *)params + p->offset);
    for (const pdyn_param *p = table; p->name && status == PDYN_OK; p++) {
        struct json_at at = json_member(object, p->name);
        if (at.value || p->required || param_is_table(p))
            status = kind_of(p)->read(&at, p, body, (char *)params + p->offset);
    }
    return status;
}

pdyn_status params_read_object(const struct json_at *object, const pdyn_param *table,
                               void *params) {
    static const char *const none[] = {NULL};
    pdyn_status status = params_check_keys(object, table, none);
    return status == PDYN_OK ? params_read(object, table, NULL, params) : status;
}

void params_free(pdyn_context *context, const pdyn_param *table, void *params) {
    for (const pdyn_param *p = table; p->name; p++) {
        void *field = (char *)params + p->offset;
        pdyn_vertices *vertices = p->kind == PDYN_VERTICES ? field : NULL;
        pdyn_path *path = p->kind == PDYN_PATH ? field : NULL;
        pdyn_other *other = p->kind == PDYN_OTHER ? field : NULL;
        pdyn_table *rows = param_is_table(p) ? field : NULL;
        if (vertices) FREE_ARRAY(context, vertices->index, vertices->count);
        if (path) keyed_free_path(context, path);
        if (rows) table_free(context, p, rows);
        if (other) context_free_text(context, other->name);
    }
}
