/* Reading JSON objects by tables of parameters. */
#include "params.h"

#include "angles.h"
#include "base/text.h"
#include "geometry/sampling.h"
#include "hint.h"
#include "keyed.h"
#include "misplaced.h"
#include "table.h"
#include "vertex_selection.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { WHAT = 128, KEYS = 64 };

/* ---- keys ------------------------------------------------------------------------------------ */

static bool is_known(const pdyn_param *table, const char *const *others, const char *key) {
    for (; table && table->name; table++)
        if (!strcmp(table->name, key)) return true;
    for (; *others; others++)
        if (!strcmp(*others, key)) return true;
    return false;
}

/* Collects the keys that an object may have. Returns their number. */
static int list_keys(const pdyn_param *table, const char *const *others, const char *names[KEYS]) {
    int count = 0;
    for (; *others && count < KEYS; others++) names[count++] = *others;
    for (; table && table->name && count < KEYS; table++) names[count++] = table->name;
    return count;
}

static bool has_text(const json_t *object, const char *key, const char *text) {
    const char *found = json_string_value(json_object_get(object, key));
    return found && !strcmp(found, text);
}

/* The key of an array of the object, one of whose elements has this name or type; NULL: none. */
static const char *array_of(json_t *object, const char *name) {
    const char *key;
    json_t *array, *element;
    size_t k;
    json_object_foreach(object, key, array) json_array_foreach(array, k, element) {
        if (has_text(element, "name", name) || has_text(element, "type", name)) return key;
    }
    return NULL;
}

static pdyn_status fail_unknown(const struct json_at *at, const pdyn_param *table,
                                const char *const *others) {
    const char *names[KEYS], *array = array_of(at->parent->value, at->key);
    char hint[768] = "", key[64];
    int count = list_keys(table, others, names);
    text_clip(key, sizeof key, at->key);
    if (array && is_known(table, others, array))
        text_append(hint, sizeof hint, "; did you mean \"%s.%s\"?", array, key);
    else if (!misplaced_hint(at, hint, sizeof hint))
        hint_append(hint, sizeof hint, at->key, names, count);
    return json_fail_at_key(at, "unknown key \"%s\"%s", key, hint);
}

static pdyn_status fail_no_object(const struct json_at *at, const pdyn_param *table,
                                  const char *const *others) {
    const char *names[KEYS];
    char what[768] = "an object {";
    int count = list_keys(table, others, names);
    for (int k = 0; k < count; k++)
        text_append(what, sizeof what, "%s%s", names[k], k + 1 < count ? ", " : "}");
    return json_expected(at, what);
}

pdyn_status params_check_keys(const struct json_at *object, const pdyn_param *table,
                              const char *const *others) {
    const char *key;
    json_t *value;
    if (!json_is_object(object->value)) return fail_no_object(object, table, others);
    json_object_foreach(object->value, key, value) {
        struct json_at at = json_member(object, key);
        if (!is_known(table, others, key)) return fail_unknown(&at, table, others);
    }
    return PDYN_OK;
}

pdyn_status params_check_alternatives(const struct json_at *object, const char *const *names) {
    const char *given = NULL;
    for (; names && *names; names++) {
        struct json_at at = json_member(object, *names);
        if (at.value && given)
            return json_fail_at_key(&at, "\"%s\" has no meaning beside \"%s\"", *names, given);
        if (at.value) given = *names;
    }
    return PDYN_OK;
}

/* ---- numbers --------------------------------------------------------------------------------- */

void params_describe_bounds(char *text, size_t size, const char *what, double min, double max,
                            const char *unit) {
    bool low = min > -HUGE_VAL, high = max < HUGE_VAL, named = *unit && strcmp(unit, "1") != 0;
    text_append(text, size, "%s", what);
    if (low && high) text_append(text, size, " from %.10g to %.10g", min, max);
    else if (low) text_append(text, size, " of at least %.10g", min);
    else if (high) text_append(text, size, " of at most %.10g", max);
    if (named) text_append(text, size, low || high ? " %s" : " (%s)", unit);
}

static pdyn_status expected_number(const struct json_at *at, const char *what, double min,
                                   double max, const char *unit) {
    char text[WHAT] = "";
    params_describe_bounds(text, sizeof text, what, min, max, unit);
    return json_expected(at, text);
}

pdyn_status params_real(const struct json_at *at, double min, double max, const char *unit,
                        double *out) {
    *out = json_number_value(at->value);
    if (json_is_number(at->value) && *out >= min && *out <= max) return PDYN_OK;
    return expected_number(at, "a number", min, max, unit);
}

pdyn_status params_int(const struct json_at *at, double min, double max, int *out) {
    min = fmax(min, INT_MIN), max = fmin(max, INT_MAX);
    double value = json_number_value(at->value); /* 30.0 is a whole number, too */
    bool fits = json_is_number(at->value) && value == floor(value) && value >= min && value <= max;
    *out = fits ? (int)value : 0;
    if (fits) return PDYN_OK;
    return expected_number(at, "a whole number", min, max, "");
}

pdyn_status params_ints(const struct json_at *at, int count, double min, double max, int *out) {
    char text[WHAT] = "";
    text_append(text, sizeof text, "an array of %d whole numbers", count);
    if (json_array_size(at->value) != (size_t)count) return json_expected(at, text);
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < count && status == PDYN_OK; k++) {
        struct json_at element = json_element(at, (size_t)k);
        status = params_int(&element, min, max, &out[k]);
    }
    return status;
}

pdyn_status params_reals(const struct json_at *at, int count, double min, double max,
                         const char *unit, double *out) {
    char text[WHAT] = "";
    if (!json_is_array(at->value) || json_array_size(at->value) != (size_t)count) {
        text_append(text, sizeof text, "an array of %d numbers", count);
        if (*unit && strcmp(unit, "1") != 0) text_append(text, sizeof text, " (%s)", unit);
        return json_expected(at, text);
    }
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < count && status == PDYN_OK; k++) {
        struct json_at element = json_element(at, (size_t)k);
        status = params_real(&element, min, max, unit, &out[k]);
    }
    return status;
}

pdyn_status params_box(const struct json_at *at, struct box *box) {
    static const pdyn_param table[] = {
        {"minimum", PDYN_VECTOR, offsetof(struct box, min), true, 0, -SCENE_MAX_POSITION,
         SCENE_MAX_POSITION, "m", ""},
        {"maximum", PDYN_VECTOR, offsetof(struct box, max), true, 0, -SCENE_MAX_POSITION,
         SCENE_MAX_POSITION, "m", ""},
        {0},
    };
    pdyn_status status = params_read_object(at, table, box);
    for (int a = 0; a < 3 && status == PDYN_OK; a++) {
        struct json_at maximum = json_member(at, "maximum"),
                       entry = json_element(&maximum, (size_t)a);
        if (!(box->max[a] > box->min[a]))
            status =
                json_fail(&entry, "expected a number above the minimum, %.10g m, found %.10g m",
                          box->min[a], box->max[a]);
    }
    return status;
}

pdyn_status params_sphere(const struct json_at *at, struct sphere *sphere) {
    static const pdyn_param table[] = {
        {"center", PDYN_VECTOR, offsetof(struct sphere, center), true, 0, -SCENE_MAX_POSITION,
         SCENE_MAX_POSITION, "m", ""},
        {"radius", PDYN_REAL, offsetof(struct sphere, radius), true, 0, 0, SCENE_MAX_POSITION, "m",
         ""},
        {0},
    };
    return params_read_object(at, table, sphere);
}

/* ---- reading by kind ------------------------------------------------------------------------- */

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
    if (status == PDYN_OK || !json_is_number(at->value) || !*param->doc) return status;
    char text[ERROR_LENGTH];
    text_clip(text, sizeof text, pdyn_last_error(NULL));
    return set_error(status, "%s; meaning: %s", text, param->doc);
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
