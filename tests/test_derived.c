/* Parameters that a type computes with `resolve`: they follow each change of another parameter, and
 * a rule of the type holds for every change. */
#include "control_support.h"

/* Springs to the plane y = 0: `first` and `second`, of which the first one is the stiffer one. */
struct pair {
    double first, second;
    pdyn_path path;
    double sum; /* computed: no parameter of a scene */
};

static pdyn_param_fault add(void *par, const pdyn_scene_info *scene) {
    struct pair *pair = par;
    pair->sum = pair->first + pair->second + 0.0 * scene->step;
    if (pair->path.count && pair->path.key[0] < 0.0)
        return (pdyn_param_fault){"a path begins at 0 s", "path"};
    return (pdyn_param_fault){pair->first < pair->second ? "below \"second\"" : NULL, "first"};
}

static void weigh(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct pair *)par)->sum;
}

static const pdyn_constraint_type type = {
    .name = "pair",
    .summary = "pulls points to y = 0",
    .flags = PDYN_ANCHORED | PDYN_ON_SURFACE,
    .params_size = sizeof(struct pair),
    .params =
        (const pdyn_param[]){
            {"first", PDYN_REAL, offsetof(struct pair, first), false, 20, 0, 1e6, "N/m", ""},
            {"second", PDYN_REAL, offsetof(struct pair, second), false, 10, 0, 1e6, "N/m", ""},
            {"path", PDYN_PATH, offsetof(struct pair, path), false, 0, 0, 0, "m", ""},
            {0}},
    .resolve = add,
    .elements = all_points,
    .rows = 1,
    .width = 1,
    .select = select_point,
    .weight = weigh,
    .project = put_on_plane};

#define SCENE_OF(keys)                                                                             \
    SCENE(FIXED,                                                                                   \
          GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "3, 3", "'area_density': 0.5",               \
                     "{'type': 'pair'" keys "}"),                                                  \
          "")
#define KEYS(name, first, second)                                                                  \
    ", '" name "': [{'time': 0, '" name "': " first "}, {'time': 0.1, '" name "': " second "}]"

static int set_up(void **state) {
    static const pdyn_constraint_type *const types[] = {&type, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "pair", types, NULL};
    int failed = control_set_up(state);
    if (!failed) good(pdyn_register(context, &plugin));
    return failed;
}

static double weight_of(const pdyn_sim *sim) { return sim->objective.batch[0]->view.weight[0]; }

static void test_derived(void **state) {
    (void)state;
    static const char plain[] = SCENE_OF("");
    pdyn_sim *sim = test_load(context, plain);
    assert_true(weight_of(sim) == 30.0);
    good(pdyn_set_parameter(sim, 0, "first", (double[]){50.0}, 1));
    assert_true(weight_of(sim) == 60.0);
    good(pdyn_set_parameter(sim, 0, "path", (double[]){0, 1, 2, 3}, 4));
    assert_true(pdyn_get_vector(sim, 0, 0).value[3] == 3.0);
    take_steps(sim, 3);
    continues(sim, plain);
    pdyn_free(sim);
}

static void test_rule(void **state) {
    (void)state;
    static const char plain[] = SCENE_OF("");
    pdyn_sim *sim = test_load(context, plain), *other = test_load(context, plain);
    take_steps(sim, 2), take_steps(other, 2);
    refused(pdyn_set_parameter(sim, 0, "second", (double[]){21.0}, 1),
            "constraint \"pair\" on body \"sheet\": first: below \"second\"");
    refused(pdyn_set_parameter(sim, 0, "path", (double[]){-1, 0, 0, 0}, 4),
            "constraint \"pair\" on body \"sheet\": path: a path begins at 0 s");
    assert_true(pdyn_get_parameter(sim, 0, 1).value == 10.0 && weight_of(sim) == 30.0);
    assert_int_equal(pdyn_get_vector(sim, 0, 0).count, 0);
    take_steps(sim, 5), take_steps(other, 5);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    pdyn_free(sim), pdyn_free(other);
}

/* Keys of two parameters may need each other: at 0.1 s both are below the second one at 0 s. */
static void test_keys(void **state) {
    (void)state;
    static const char falling[] = SCENE_OF(KEYS("first", "20", "2") KEYS("second", "10", "1")),
                      wrong[] = SCENE_OF(KEYS("first", "20", "2"));
    pdyn_sim *sim = test_load(context, falling), *none = NULL;
    assert_true(weight_of(sim) == 30.0);
    take_steps(sim, 12);
    continues(sim, falling);
    take_steps(sim, 12);
    assert_true(weight_of(sim) == 3.0);
    pdyn_free(sim);
    refused(pdyn_load_text(context, quoted(wrong), "s.json", NULL, 0, &none),
            "s.json: key at 0.1 s: constraint \"pair\" on body \"sheet\": first: below \"second\"");
    assert_null(none);
}

/* A state that ends too early leaves parameters and what is computed from them as they were. */
static void test_bad_state(void **state) {
    (void)state;
    static unsigned char bytes[1 << 16];
    static const char plain[] = SCENE_OF("");
    size_t size;
    pdyn_sim *sim = test_load(context, plain);
    good(pdyn_set_parameter(sim, 0, "path", (double[]){0, 1, 2, 3}, 4));
    good(pdyn_save_memory(sim, bytes, sizeof bytes, &size));
    good(pdyn_set_parameter(sim, 0, "first", (double[]){50.0}, 1));
    good(pdyn_set_parameter(sim, 0, "path", (double[]){0, 4, 5, 6, 1, 0, 0, 0}, 8));
    for (size_t part = size - 1; part > 0; part--) {
        assert_int_equal(pdyn_restore_memory(sim, bytes, part), PDYN_BAD_INPUT);
        assert_true(weight_of(sim) == 60.0 && pdyn_get_parameter(sim, 0, 0).value == 50.0);
        assert_true(pdyn_get_vector(sim, 0, 0).value[3] == 6.0);
    }
    good(pdyn_restore_memory(sim, bytes, size));
    assert_true(weight_of(sim) == 30.0 && pdyn_get_vector(sim, 0, 0).value[3] == 3.0);
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_derived),
        cmocka_unit_test(test_rule),
        cmocka_unit_test(test_keys),
        cmocka_unit_test(test_bad_state),
    };
    return cmocka_run_group_tests_name("derived", tests, set_up, control_tear_down);
}
