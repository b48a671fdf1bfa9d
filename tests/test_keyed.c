/* Parameters and gravity that a scene gives over time: their values, what a program sets, saved
 * states, and keys that a scene must not have. */
#include "control_support.h"

#include <math.h>

#define EULER                                                                                      \
    "'duration': 10, 'frame_interval': 0.1, 'time_step': {'fixed': 0.02, 'integrator': 'euler'}"
#define GRAVITY                                                                                    \
    ", 'gravity': [{'time': 0.1, 'gravity': [0, -10, 0]}, {'time': 0.3, 'gravity': [0, 0, 2]}]"
#define FREE_SHEET(more)                                                                           \
    SCENE(EULER more,                                                                              \
          GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "3, 3", "'area_density': 0.5",               \
                     SPRINGS("1000")),                                                             \
          "")
#define STIFFENING                                                                                 \
    PINNED(FIXED, "[{'time': 0.05, 'stretching_stiffness': 1000}, {'time': 0.1, "                  \
                  "'stretching_stiffness': 3000}]")
#define JELLY(stiffness)                                                                           \
    "{" FIXED ", 'bodies': [{'name': 'jelly', 'volume': {'grid': {'size': [0.2, 0.2, 0.2], "       \
    "'cells': [2, 2, 2]}, 'density': 500}, 'constraints': [{'type': 'tet', " stiffness "}, "       \
    "{'type': 'pin', 'vertices': {'vertices': [0, 1, 2]}}]}]}"

static double linear(double time, double from, double to, double a, double b) {
    double part = fmin(fmax((time - from) / (to - from), 0.0), 1.0);
    return a + part * (b - a);
}

/* A sheet in flight gains h g in every step, with the g at the begin of the step. */
static void test_gravity(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, FREE_SHEET(GRAVITY));
    double v[3] = {0.0}, gravity[3];
    for (int k = 0; k < 25; k++) {
        double time = pdyn_time(sim);
        take_steps(sim, 1);
        v[1] += 0.02 * linear(time, 0.1, 0.3, -10.0, 0.0);
        v[2] += 0.02 * linear(time, 0.1, 0.3, 0.0, 2.0);
        for (int a = 0; a < 3; a++) assert_true(fabs(pdyn_get_state(sim).v[a] - v[a]) < 1e-9);
    }
    pdyn_get_gravity(sim, gravity);
    assert_true(gravity[1] == 0.0 && gravity[2] == 2.0);
    assert_true(sim->control.gravity == 10.0);
    pdyn_free(sim);
}

/* A scene is made for the largest gravity, whenever it acts. */
static void test_largest_gravity(void **state) {
    (void)state;
#define TANK(gravity)                                                                              \
    SCENE(EULER ", 'gravity': " gravity,                                                           \
          FLUID_BOX("'name': 'water', ", "0.02", "0, 0, 0", "0.16, 0.16, 0.16", ""),               \
          ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.3, 0.2]}}]")
#define KEY(time, gravity) "{'time': " time ", 'gravity': [0, " gravity ", 0]}"
    static const char *const scenes[][2] = {
        {TANK("[" KEY("1", "0") ", " KEY("2", "-9.81") "]"), TANK("[0, -9.81, 0]")},
        {TANK("[" KEY("1", "-3") ", " KEY("2", "-5") ", " KEY("3", "-1") "]"), TANK("[0, -5, 0]")}};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_load(context, scenes[k][0]), *other = test_load(context, scenes[k][1]);
        double stiffness = pdyn_get_parameter(sim, 0, 0).value;
        assert_true(stiffness > 0.0 && stiffness == pdyn_get_parameter(other, 0, 0).value);
        assert_true(sim->control.gravity == (k ? 5.0 : 9.81)); /* the tolerance, too */
        pdyn_free(sim), pdyn_free(other);
    }
}

static void test_parameter(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, STIFFENING);
    assert_true(pdyn_get_parameter(sim, SPRING, 0).value == 1000.0);
    for (int k = 0; k < 30; k++) {
        double time = pdyn_time(sim);
        take_steps(sim, 1);
        double expected = linear(time, 0.05, 0.1, 1000.0, 3000.0);
        assert_true(fabs(pdyn_get_parameter(sim, SPRING, 0).value - expected) < 1e-9 * expected);
    }
    pdyn_free(sim);
}

/* A type with a table: stiffness of each point's spring to the plane y = 0. */
struct level {
    pdyn_table stiffness;
};
static void weigh_point(const void *par, const pdyn_batch *b, int first, int last) {
    const struct level *level = par;
    for (int e = first; e < last; e++) b->weight[e] = level->stiffness.value[e];
}
static const pdyn_constraint_type level = {
    .name = "level",
    .summary = "pulls points to y = 0",
    .flags = PDYN_ANCHORED | PDYN_ON_SURFACE,
    .params_size = sizeof(struct level),
    .params = (const pdyn_param[]){{"stiffness", PDYN_TABLE(PDYN_PER_VERTEX, 1),
                                    offsetof(struct level, stiffness), true, 0, 0, 1e6, "N/m",
                                    "of each spring"},
                                   {0}},
    .elements = all_points,
    .rows = 1,
    .width = 1,
    .select = select_point,
    .weight = weigh_point,
    .project = put_on_plane};

/* The value of the keys is in every row of a table. */
static void test_table(void **state) {
    (void)state;
    static const pdyn_constraint_type *const types[] = {&level, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "level", types, NULL};
    static const char scene[] =
        SCENE(FIXED,
              GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "3, 3", "'area_density': 0.5",
                         "{'type': 'level', 'stiffness': [{'time': 0, 'stiffness': 100}, {'time': "
                         "1, 'stiffness': 0}]}"),
              "");
    good(pdyn_register(context, &plugin));
    pdyn_sim *sim = test_load(context, scene);
    take_steps(sim, 101);
    pdyn_vector_info stiffness = pdyn_get_vector(sim, 0, 0);
    assert_int_equal(stiffness.count, 9);
    for (int k = 0; k < stiffness.count; k++) assert_true(fabs(stiffness.value[k] - 50.0) < 1e-9);
    continues(sim, scene);
    pdyn_free(sim);
}

/* What a program sets stays, in a saved state, too. */
static void test_program(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, STIFFENING),
             *heavy = test_load(context, FREE_SHEET(GRAVITY));
    take_steps(sim, 12), take_steps(heavy, 2);
    continues(sim, STIFFENING), continues(heavy, FREE_SHEET(GRAVITY));
    good(pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){500.0}, 1));
    good(pdyn_set_gravity(heavy, (double[]){1, 2, 3}));
    continues(sim, STIFFENING), continues(heavy, FREE_SHEET(GRAVITY));
    take_steps(sim, 20), take_steps(heavy, 20);
    double gravity[3];
    pdyn_get_gravity(heavy, gravity);
    assert_true(pdyn_get_parameter(sim, SPRING, 0).value == 500.0);
    assert_true(gravity[0] == 1.0 && gravity[1] == 2.0 && gravity[2] == 3.0);
    pdyn_free(sim), pdyn_free(heavy);
}

/* A value that the type refuses leaves the keys in force. */
static void test_program_refused(void **state) {
    (void)state;
    static const char scene[] = PINNED(FIXED, "1000, 'damping': [{'time': 0, 'damping': 0.01}, "
                                              "{'time': 1, 'damping': 0.03}]");
    pdyn_sim *sim = test_load(context, scene);
    pdyn_status status = pdyn_set_parameter(sim, SPRING, "damping", (double[]){0.0}, 1);
    assert_int_equal(status, PDYN_BAD_INPUT);
    take_steps(sim, 2);
    double time = pdyn_time(sim);
    take_steps(sim, 1);
    assert_true(fabs(pdyn_get_parameter(sim, SPRING, 1).value - linear(time, 0, 1, 0.01, 0.03)) <
                1e-12);
    pdyn_free(sim);
}

/* Of two parameters with keys, both stay as a program sets them. */
static void test_two_parameters(void **state) {
    (void)state;
    static const char scene[] =
        PINNED(FIXED, "[{'time': 0, 'stretching_stiffness': 1000}, {'time': 1, "
                      "'stretching_stiffness': 3000}], 'damping': [{'time': 0, 'damping': 0.01}, "
                      "{'time': 1, 'damping': 0.03}]");
    pdyn_sim *sim = test_load(context, scene);
    take_steps(sim, 2);
    good(pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){500.0}, 1));
    good(pdyn_set_parameter(sim, SPRING, "damping", (double[]){0.005}, 1));
    take_steps(sim, 2);
    assert_true(pdyn_get_parameter(sim, SPRING, 0).value == 500.0);
    assert_true(pdyn_get_parameter(sim, SPRING, 1).value == 0.005);
    pdyn_free(sim);
}

/* A constraint that refuses a value does so when the scene is loaded. */
static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *scene, *message;
    } cases[] = {
        {JELLY(
             "'stiffness': 1e4, 'volume_stiffness': [{'time': 0, 'volume_stiffness': 0}, {'time': "
             "1, 'volume_stiffness': 1e5}]"),
         "scene.json: key at 1 s: constraint \"tet\" on body \"jelly\": it has other elements with "
         "this "
         "value than the scene gave it"},
        {JELLY("'stiffness': 1e4, 'damping': [{'time': 0, 'damping': 0.1}, {'time': 3, 'damping': "
               "0}, {'time': 4, 'damping': 0.1}]"),
         "scene.json: key at 3 s: constraint \"tet\" on body \"jelly\": damping must stay above 0 "
         "while the "
         "simulation runs"},
    };
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = NULL;
        refused(pdyn_load_text(context, quoted(cases[k].scene), "scene.json", NULL, 0, &sim),
                cases[k].message);
        assert_null(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gravity),        cmocka_unit_test(test_largest_gravity),
        cmocka_unit_test(test_parameter),      cmocka_unit_test(test_table),
        cmocka_unit_test(test_program),        cmocka_unit_test(test_program_refused),
        cmocka_unit_test(test_two_parameters), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests_name("keyed", tests, control_set_up, control_tear_down);
}
