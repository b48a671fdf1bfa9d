/* Names: suggestions for near misses, descriptions, and the JSON schema against the parameter
 * tables. */
#include "base/param_kind.h"
#include "base/registry.h"
#include "base/text.h"
#include "scene/fingerprint.h"
#include "scene/hint.h"
#include "scene/inlet.h"
#include "scene/keyed.h"
#include "scene_support.h"

#include <jansson.h>
#include <string.h>

static json_t *schema;

static int set_up(void **state) {
    const char *root = getenv("PROJDYN_SOURCE_ROOT");
    char path[1024];
    snprintf(path, sizeof path, "%s/schema/scene.schema.json", root ? root : ".");
    schema = json_load_file(path, JSON_REJECT_DUPLICATES, NULL);
    return schema ? scene_set_up(state) : -1;
}

static int tear_down(void **state) {
    json_decref(schema);
    return scene_tear_down(state);
}

/* ---- words ----------------------------------------------------------------------------------- */

static void test_near_miss(void **state) {
    (void)state;
    static const char *const names[] = {"radius", "rest_density", "fill", "stretching_stiffness",
                                        "type",   "duration"};
    static const struct {
        const char *word, *nearest;
    } cases[] = {
        {"raduis", "radius"},
        {"Radius", "radius"},
        {"rest-density", "rest_density"},
        {"density", "rest_density"},
        {"stiffness", "stretching_stiffness"},
        {"fil", "fill"},
        {"time", NULL},
        {"iterations", NULL},
        {"xyz", NULL},
        {"", NULL},
        {"temperature", NULL},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        const char *found = hint_closest(cases[k].word, names, COUNT(names));
        if (!cases[k].nearest) assert_null(found);
        else assert_string_equal(found ? found : "", cases[k].nearest);
    }
    char long_word[200];
    memset(long_word, 'r', sizeof long_word - 1);
    long_word[sizeof long_word - 1] = '\0';
    assert_null(hint_closest(long_word, names, COUNT(names)));
    char clipped[8];
    text_clip(clipped, sizeof clipped, "abc\xc3\xa4\n123456");
    assert_string_equal(clipped, "abc...");
    text_clip(clipped, sizeof clipped, "a\tb");
    assert_string_equal(clipped, "a?b");
}

struct text {
    char data[16384];
    size_t length;
};
static void collect(void *user, const char *piece) {
    struct text *text = user;
    size_t length = strlen(piece);
    assert_true(text->length + length < sizeof text->data);
    memcpy(text->data + text->length, piece, length + 1);
    text->length += length;
}

static const char *described(const char *name) {
    static struct text text;
    text = (struct text){.data = ""};
    assert_int_equal(pdyn_describe(context, name, collect, &text), PDYN_OK);
    return text.data;
}

static void test_describe(void **state) {
    (void)state;
    const char *all = described(NULL);
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t; t++)
        assert_non_null(strstr(all, (*t)->summary));
    for (const pdyn_global_solver *const *t = registry_builtin.solvers; *t; t++)
        assert_non_null(strstr(all, (*t)->summary));
    const char *fluid = described("fluid");
    for (const pdyn_param *p = registry_constraint(context, "fluid")->params; p->name; p++) {
        assert_non_null(strstr(fluid, p->name));
        assert_non_null(strstr(fluid, p->doc));
    }
    assert_non_null(
        strstr(described("fluid"), "at most one of: stiffness, compression, sound_speed\n"));
    assert_non_null(strstr(described("spring"),
                           "stretching_stiffness   N/m    required   number from 0 to 1e+12"));
    assert_non_null(strstr(described("pin"), "choice of vertices"));
    assert_non_null(strstr(
        described("cg"), "outer_iterations              100        whole number from 1 to 100000"));
    assert_int_equal(pdyn_describe(context, "fluit", collect, NULL), PDYN_BAD_INPUT);
    assert_message(
        "no constraint and no solver \"fluit\"; did you mean \"fluid\"?; known: attachment, *");
    assert_int_equal(pdyn_describe(NULL, NULL, collect, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_describe(context, NULL, NULL, NULL), PDYN_BAD_CALL);
}

/* ---- the schema ------------------------------------------------------------------------------ */

static const json_t *definition(const char *name) {
    const json_t *found = json_object_get(json_object_get(schema, "$defs"), name);
    if (!found) fail_msg("the schema has no $defs/%s", name);
    return found;
}

static void assert_number(const json_t *entry, const char *key, const char *name, double expected,
                          bool wanted) {
    const json_t *value = json_object_get(entry, key);
    if (!value != !wanted)
        fail_msg("schema: %s %s its %s", name, wanted ? "lacks" : "should not have", key);
    if (wanted && json_number_value(value) != expected)
        fail_msg("schema: %s of %s is %.17g, in the table %.17g", key, name,
                 json_number_value(value), expected);
}

static bool is_listed(const json_t *array, const char *word) {
    for (size_t k = 0; k < json_array_size(array); k++)
        if (!strcmp(json_string_value(json_array_get(array, k)), word)) return true;
    return false;
}

/* keyed: keys may stand in the place of the value. */
static void check_parameter(const json_t *object, const pdyn_param *p, bool keyed) {
    static const char *const types[] = {
        [PDYN_REAL] = "number", [PDYN_INT] = "integer", [PDYN_BOOL] = "boolean"};
    const json_t *entry = json_object_get(json_object_get(object, "properties"), p->name);
    if (!entry) fail_msg("the schema lacks %s", p->name);
    if (is_listed(json_object_get(object, "required"), p->name) != p->required)
        fail_msg("schema: %s is required in one of schema and table only", p->name);
    if (p->kind > PDYN_BOOL) {
        const char *ref = json_string_value(json_object_get(entry, "$ref"));
        assert_non_null(ref);
        if (p->kind == PDYN_VECTOR) assert_int_equal(keyed, strstr(ref, "_or_keys") != NULL);
        return;
    }
    bool has_default = !p->required && p->def >= p->min && p->def <= p->max;
    const json_t *kind = json_object_get(entry, "type");
    if (keyed && !(is_listed(kind, "array") && is_listed(kind, types[p->kind])))
        fail_msg("schema: %s may have keys", p->name);
    if (!keyed) assert_string_equal(json_string_value(kind), types[p->kind]);
    assert_non_null(json_object_get(entry, "description"));
    if (p->kind == PDYN_BOOL) {
        assert_int_equal(json_is_true(json_object_get(entry, "default")), p->def != 0.0);
        return;
    }
    assert_number(entry, "default", p->name, p->def, has_default);
    assert_number(entry, "minimum", p->name, p->min, isfinite(p->min));
    assert_number(entry, "maximum", p->name, p->max, isfinite(p->max));
}

/* The schema excludes every pair of alternatives: {"not": {"required": [a, b]}}. */
static void check_alternatives(const json_t *object, const char *const *names) {
    const json_t *excluded = json_object_get(object, "allOf");
    size_t count = 0, found = 0;
    while (names && names[count]) count++;
    for (size_t k = 0; k < json_array_size(excluded); k++) {
        const json_t *pair = json_object_get(json_array_get(excluded, k), "not");
        pair = json_object_get(pair, "required");
        for (size_t a = 0; a < count; a++)
            for (size_t b = 0; b < a; b++)
                found += is_listed(pair, names[a]) && is_listed(pair, names[b]);
    }
    assert_int_equal(found, count ? count * (count - 1) / 2 : 0);
    assert_int_equal(json_array_size(excluded), found);
}

/* The schema has the keys of the table and `others` more. type: that of a constraint, or NULL. */
static void check_params(const json_t *object, const pdyn_param *table,
                         const pdyn_constraint_type *type, size_t others) {
    size_t count = others;
    for (const pdyn_param *p = table; p->name; p++, count++)
        check_parameter(object, p, type && param_is_changeable(type, p));
    assert_true(json_is_false(json_object_get(object, "additionalProperties")));
    assert_int_equal(json_object_size(json_object_get(object, "properties")), count);
}

static void check_table(const json_t *object, const pdyn_param *table, size_t others) {
    check_params(object, table, NULL, others);
}

static void test_schema(void **state) {
    (void)state;
    check_table(schema, settings_general_params, 13);
    check_table(definition("time_step"), settings_time_step_params, 1);
    check_table(definition("solver"), settings_solver_params, 2);
    check_table(definition("motion_key"), scene_key_params, 0);
    check_table(definition("contact"), scene_contact_params, 0);
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t; t++) {
        char name[64];
        snprintf(name, sizeof name, "constraint_%s", (*t)->name);
        check_params(definition(name), (*t)->params, *t, (*t)->matrix_free ? 1 : 3);
        check_alternatives(definition(name), (*t)->alternatives);
    }
    for (const pdyn_param *p = scene_constraint_times; p->name; p++) {
        assert_number(definition(p->name), "default", p->name, p->def, isfinite(p->def));
        assert_number(definition(p->name), "minimum", p->name, p->min, true);
        assert_number(definition(p->name), "maximum", p->name, p->max, true);
    }
    const json_t *others = json_object_get(definition("constraint_of_plugin"), "properties");
    others = json_object_get(json_object_get(json_object_get(others, "type"), "not"), "enum");
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t; t++)
        assert_true(is_listed(others, (*t)->name));
    check_table(definition("inlet_rectangle"), inlet_params, 5);
    check_table(definition("inlet_disc"), inlet_params, 5);
    const pdyn_param speed_key[] = {keyed_time_param, inlet_speed_param, {0}};
    check_table(definition("speed_key"), speed_key, 0);
    check_table(definition("outlet"), outlet_params, 1);
    check_table(definition("probe"), scene_probe_params, 15);
    static const char *const fills[] = {"fill_box", "fill_sphere", "fill_mesh", "fill_file"};
    for (int k = 0; k < COUNT(fills); k++) {
        const json_t *fill = definition(fills[k]);
        assert_true(json_is_false(json_object_get(fill, "additionalProperties")));
        assert_true(is_listed(json_object_get(fill, "required"), fills[k] + strlen("fill_")));
        assert_int_equal(json_object_size(json_object_get(fill, "properties")), k < 2 ? 2 : 5);
    }
    const json_t *solver = json_object_get(definition("solver"), "properties");
    const json_t *types = json_object_get(json_object_get(solver, "type"), "enum");
    size_t count = 1;
    assert_true(is_listed(types, "auto"));
    for (const pdyn_global_solver *const *t = registry_builtin.solvers; *t; t++, count++)
        if (!is_listed(types, (*t)->name)) fail_msg("the schema lacks the solver %s", (*t)->name);
    assert_int_equal(json_array_size(types), count + test_lacks_solver("cholesky"));
}

/* A saved state belongs to all keys of a scene but three, which may change in a run. */
static void test_fingerprints(void **state) {
    (void)state;
    static const char *const may_change[] = {"$schema", "name", "duration"};
    const char *key;
    json_t *value;
    json_object_foreach(json_object_get(schema, "properties"), key, value) {
        int found = 0;
        for (int k = 0; k < FINGERPRINTS; k++) found += !strcmp(key, fingerprint_key(k));
        for (int k = 0; k < 3; k++) found += !strcmp(key, may_change[k]);
        assert_int_equal(found, 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_near_miss),
        cmocka_unit_test(test_describe),
        cmocka_unit_test(test_schema),
        cmocka_unit_test(test_fingerprints),
    };
    return cmocka_run_group_tests_name("schema", tests, set_up, tear_down);
}
