/* Parameters of constraints that a program changes, and constraints that it switches off. */
#include "control_support.h"

#include "projdyn/vec3.h"

static const char sheet[] = SHEET;

/* Changed before the first step, a parameter gives the bits of a scene with that value. */
static void test_parameter_from_start(void **state) {
    (void)state;
    static const char *const stiff[] = {PINNED(SOLVER("hybrid", "newton"), "1000"),
                                        PINNED(SOLVER("hybrid", "newton"), "200"),
                                        PINNED(SOLVER("cholesky", "projective"), "1000"),
                                        PINNED(SOLVER("cholesky", "projective"), "200"),
                                        PINNED(SOLVER("cg", "newton"), "1000"),
                                        PINNED(SOLVER("cg", "newton"), "200")};
    for (int k = 0; k < 6; k += 2) {
        if (test_lacks_solver(stiff[k])) continue;
        pdyn_sim *sim = test_load(context, stiff[k]), *other = test_load(context, stiff[k + 1]);
        good(pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){200.0}, 1));
        assert_true(pdyn_get_parameter(sim, SPRING, 0).value == 200.0);
        take_steps(sim, 10), take_steps(other, 10);
        assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
        pdyn_free(sim);
        pdyn_free(other);
    }
}

static void test_parameter_in_run(void **state) {
    (void)state;
    static const char *const scenes[] = {sheet, PINNED(SOLVER("cholesky", "projective"), "1000"),
                                         PINNED(SOLVER("cg", "newton"), "1000")};
    for (int k = 0; k < 3; k++) {
        if (test_lacks_solver(scenes[k])) continue;
        pdyn_sim *sim = test_load(context, scenes[k]);
        take_steps(sim, 40);
        double before = pdyn_get_state(sim).x[3 * CORNER + 1];
        good(pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){20.0}, 1));
        take_steps(sim, 20);
        assert_true(pdyn_get_state(sim).x[3 * CORNER + 1] < before - 0.05); /* it sags */
        good(pdyn_set_parameter(sim, PIN, "path", (double[]){0, 0, 1, 0}, 4));
        continues(sim, scenes[k]);
        take_steps(sim, 100);
        assert_true(fabs(pdyn_get_state(sim).x[1] - 1.0) < 1e-3);
        pdyn_free(sim);
    }
}

static void test_wrong_parameters(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, sheet), *water = test_load(context, fluid);
    uint64_t hash = pdyn_state_hash(sim);
    refused(
        pdyn_set_parameter(sim, SPRING, "stretching_stifness", (double[]){1.0}, 1),
        "constraint \"spring\" on body \"sheet\": no parameter \"stretching_stifness\" that can "
        "be changed while the simulation runs; did you mean \"stretching_stiffness\"?; known: "
        "stretching_stiffness, damping");
    refused(
        pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){-1.0}, 1),
        "constraint \"spring\" on body \"sheet\": stretching_stiffness: expected a number from 0 "
        "to 1e+12 N/m, found -1");
    refused(
        pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){1.0, 2.0}, 2),
        "constraint \"spring\" on body \"sheet\": stretching_stiffness: expected a number from 0 "
        "to 1e+12 N/m, found 2 numbers");
    refused(pdyn_set_parameter(sim, SPRING, "damping", (double[]){1.0}, 1),
            "constraint \"spring\" on body \"sheet\": damping must stay 0 while the simulation "
            "runs: to "
            "change it, give it a value above 0 in the scene");
    refused(
        pdyn_set_parameter(sim, PIN, "path", (double[]){1, 0, 0, 0, 1, 0, 0, 0}, 8),
        "constraint \"pin\" on body \"sheet\": path: expected 4 finite numbers for each key: an "
        "ascending time and a vector");
    assert_int_equal(pdyn_set_parameter(sim, 3, "damping", (double[]){0.0}, 1), PDYN_BAD_CALL);
    assert_int_equal(pdyn_set_parameter(water, 0, "stiffness", (double[]){1e5}, 1), PDYN_BAD_INPUT);
    good(pdyn_set_parameter(water, 0, "viscosity", (double[]){0.3}, 1));
    continues(water, fluid);
    assert_true(pdyn_state_hash(sim) == hash);
    take_steps(sim, 1);
    pdyn_free(sim);
    pdyn_free(water);
}

/* An allocator without blocks of more than *user bytes. */
static void *allocate_small(void *user, void *block, size_t old_size, size_t new_size) {
    (void)old_size;
    if (new_size > *(const size_t *)user) return NULL;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

/* Without memory for the arrays of a changed constraint, a parameter keeps its value, and the
 * simulation goes on with it. */
static void test_parameter_without_memory(void **state) {
    (void)state;
    size_t largest = SIZE_MAX;
    pdyn_options options = pdyn_default_options();
    options.threads = 1, options.allocate = allocate_small, options.allocate_user = &largest;
    pdyn_context *small = NULL;
    good(pdyn_create(&options, &small));
    pdyn_sim *sim = test_load(small, sheet), *other = test_load(context, sheet);
    largest = 128;
    assert_int_equal(pdyn_set_parameter(sim, BENDS, "bending_rigidity", (double[]){1e-2}, 1),
                     PDYN_NO_MEMORY);
    largest = SIZE_MAX;
    assert_true(pdyn_get_parameter(sim, BENDS, 0).value == 1e-3);
    for (int k = 0; k < 5; k++) test_step(sim), test_step(other);
    for (int k = 0; k < 3 * VERTICES; k++) assert_true(fabs(sim->x[k] - other->x[k]) < 1e-6);
    pdyn_free(sim);
    pdyn_free(other);
    assert_int_equal(pdyn_bytes_in_use(small), 0);
    pdyn_destroy(small);
}

/* A parameter that changes neither rows nor weights costs no new solvers: the step needs no memory.
 * A weight does, and that of a damper. */
static void test_solvers_stay(void **state) {
    (void)state;
    static const char *const weights[] = {"stiffness", "damping"};
    static const char hung[] = SCENE(
        SOLVER("hybrid", "newton"),
        PAIR(GRID_SHEET("'name': 'a', ", "0.4, 0.4", "7, 7", "'area_density': 0.5",
                        PAIR(SPRINGS("1000"), PINS("'vertices': [0, 6]"))),
             GRID_SHEET("'name': 'b', ", "0.4, 0.4", "7, 7",
                        "'translate': [0, -0.1, 0], 'area_density': 0.5",
                        PAIR(SPRINGS("1000"),
                             "{'type': 'attachment', 'to': 'a', 'stiffness': 100, 'damping': 0.01, "
                             "'vertices': {'vertices': [0, 6, 42, 48]}}"))),
        "");
    enum { TIES = 3 };
    size_t largest;
    pdyn_options options = pdyn_default_options();
    options.threads = 1, options.allocate = allocate_small, options.allocate_user = &largest;
    for (int k = 0; k < 2; k++) {
        pdyn_context *small = NULL;
        largest = SIZE_MAX;
        good(pdyn_create(&options, &small));
        pdyn_sim *sim = test_load(small, hung);
        take_steps(sim, 5);
        largest = 0;
        good(pdyn_set_parameter(sim, TIES, "length", (double[]){0.5}, 1));
        take_steps(sim, 100);
        /* It is drawn up. */
        assert_true(fabs(pdyn_get_state(sim).x[1 + 3 * VERTICES] + 0.05) < 0.02);
        good(pdyn_set_parameter(sim, TIES, weights[k], (double[]){0.5}, 1));
        assert_int_equal(pdyn_step(sim, NULL), PDYN_NO_MEMORY);
        pdyn_free(sim);
        pdyn_destroy(small);
    }
}

/* A state from before a program set a parameter that the scene leaves out. */
static void test_absent_parameter(void **state) {
    (void)state;
    static unsigned char bytes[1 << 20];
    size_t size;
    pdyn_sim *water = test_load(context, fluid);
    double damping = pdyn_get_parameter(water, 0, 4).value, other = damping + 0.25;
    assert_string_equal(pdyn_get_parameter(water, 0, 4).name, "damping");
    good(pdyn_save_memory(water, bytes, sizeof bytes, &size));
    good(pdyn_set_parameter(water, 0, "damping", &other, 1));
    assert_true(pdyn_get_parameter(water, 0, 4).value == other);
    good(pdyn_restore_memory(water, bytes, size));
    assert_true(pdyn_get_parameter(water, 0, 4).value == damping);
    pdyn_free(water);
}

/* The volume term of "tet" has elements of its own, which cannot appear in a run. */
static void test_elements_stay(void **state) {
    (void)state;
    static const char soft[] =
        "{'duration': 1, 'bodies': [{'name': 'jelly', 'volume': {'grid': {'size': [0.2, 0.2, 0.2], "
        "'cells': [2, 2, 2]}, 'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': "
        "2e4}]}]}";
    pdyn_sim *sim = test_load(context, soft), *other = test_load(context, soft);
    refused(pdyn_set_parameter(sim, 0, "volume_stiffness", (double[]){1e5}, 1),
            "constraint \"tet\" on body \"jelly\": it has other elements with this value than the "
            "scene gave it");
    assert_false(sim->control.driven); /* the energy is still checked */
    take_steps(sim, 5), take_steps(other, 5);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    pdyn_free(sim);
    pdyn_free(other);
}

static void test_enable(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, sheet), *water = test_load(context, fluid);
    pdyn_step_info info;
    take_steps(sim, 10);
    good(pdyn_enable(sim, PIN, false));
    assert_true(!pdyn_is_enabled(sim, PIN) && pdyn_is_enabled(sim, SPRING));
    continues(sim, sheet);
    for (int k = 0; k < 15; k++) good(pdyn_step(sim, &info));
    assert_true(vec3_length(info.pin_reaction) == 0.0);
    assert_true(pdyn_get_state(sim).x[1] < -0.03); /* it falls */
    good(pdyn_enable(sim, PIN, true));
    take_steps(sim, 40);
    assert_true(fabs(pdyn_get_state(sim).x[1]) < 1e-3);
    refused(pdyn_enable(water, 0, false),
            "constraint \"fluid\" on body \"water\" is matrix-free and cannot be switched off");
    assert_int_equal(pdyn_enable(sim, 3, false), PDYN_BAD_CALL);
    pdyn_free(sim);
    pdyn_free(water);
}

/* A type without parameters: its constraints have nothing but their bodies to tell them apart. */
static void weigh_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 1e5;
}
static void test_enable_without_parameters(void **state) {
    (void)state;
    static const pdyn_param none[] = {{0}};
    static const pdyn_constraint_type level = {.name = "level",
                                               .summary = "keeps points at y = 0",
                                               .flags = PDYN_ANCHORED,
                                               .params = none,
                                               .elements = all_points,
                                               .rows = 1,
                                               .width = 1,
                                               .select = select_point,
                                               .weight = weigh_point,
                                               .project = put_on_plane};
    static const pdyn_constraint_type *const types[] = {&level, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "level", types, NULL};
    static const char two[] =
        SCENE(FIXED,
              PAIR(GRID_SHEET("'name': 'a', ", "0.4, 0.4", "3, 3", "'area_density': 0.5",
                              "{'type': 'level'}"),
                   GRID_SHEET("'name': 'b', ", "0.4, 0.4", "3, 3",
                              "'translate': [1, 0, 0], 'area_density': 0.5", "{'type': 'level'}")),
              "");
    good(pdyn_register(context, &plugin));
    pdyn_sim *sim = test_load(context, two);
    good(pdyn_enable(sim, 0, false));
    assert_true(!pdyn_is_enabled(sim, 0) && pdyn_is_enabled(sim, 1));
    take_steps(sim, 20);
    assert_true(pdyn_get_state(sim).x[1] < -0.03 && fabs(pdyn_get_state(sim).x[3 * 9 + 1]) < 1e-3);
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parameter_from_start),
        cmocka_unit_test(test_parameter_in_run),
        cmocka_unit_test(test_wrong_parameters),
        cmocka_unit_test(test_parameter_without_memory),
        cmocka_unit_test(test_solvers_stay),
        cmocka_unit_test(test_absent_parameter),
        cmocka_unit_test(test_elements_stay),
        cmocka_unit_test(test_enable),
        cmocka_unit_test(test_enable_without_parameters),
    };
    return cmocka_run_group_tests_name("parameters", tests, control_set_up, control_tear_down);
}
