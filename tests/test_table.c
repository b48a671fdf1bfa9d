/* Tables of constraints: what a scene gives, files, changes between steps, saved states; and the
 * example plug-in muscle.c by exact solutions. */
#include "support.h"

#include "projdyn/conformance.h"
#include "projdyn/control.h"
#include "projdyn/module.h"
#include "projdyn/vec3.h"

/* ---- a type with tables of every kind -------------------------------------------------------- */

struct params {
    pdyn_table stiffness, target, share, pair;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_TABLE(PDYN_PER_VERTEX, 1), offsetof(struct params, stiffness), false, 100, 0,
     1e6, "N/m", "of the spring to each target"},
    {"target", PDYN_TABLE(PDYN_PER_VERTEX, 3), offsetof(struct params, target), false, HUGE_VAL,
     -1e6, 1e6, "m", "a place for each vertex"},
    {"share", PDYN_TABLE(PDYN_PER_TRIANGLE, 1), offsetof(struct params, share), false, 1, 0,
     HUGE_VAL, "1", "of each triangle"},
    {"pair", PDYN_TABLE(PDYN_ROWS, 2), offsetof(struct params, pair), false, -1, 0, 1e6, "",
     "two numbers"},
    {0}};

static int elements(const void *par, const pdyn_body *body) { return (void)par, body->count; }

static void select_points(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++) b->weight[e] = q->stiffness.value[e];
}

/* A fault: counts its rows from the first element of the call. */
static void weight_from_first(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++) b->weight[e] = q->stiffness.value[e - first];
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    const double *place = q->target.count ? q->target.value : b->body->rest;
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = place[k];
}

static pdyn_constraint_type type = {.name = "pose",
                                    .summary = "pulls each vertex to a target",
                                    .flags = PDYN_ON_SURFACE | PDYN_ANCHORED,
                                    .params_size = sizeof(struct params),
                                    .params = params,
                                    .elements = elements,
                                    .rows = 1,
                                    .width = 1,
                                    .select = select_points,
                                    .weight = weight,
                                    .project = project};
static const pdyn_constraint_type *const types[] = {&type, NULL};
static const pdyn_plugin plugin = {PDYN_ABI, "pose", types, NULL};

static pdyn_context *context;

static int set_up(void **state) {
    context = test_context(1);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    assert_int_equal(pdyn_register(context, &pdyn_plugin_table), PDYN_OK);
    return test_enter_directory(state);
}

static int tear_down(void **state) {
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    return test_leave_directory(state);
}

/* Four vertices, two triangles. */
#define POSE(tables)                                                                               \
    SCENE("'duration': 1, 'time_step': {'fixed': 0.01}",                                           \
          GRID_SHEET("", "1, 1", "2, 2", "'area_density': 1", "\n{'type': 'pose', " tables "}"),   \
          "")

static const struct params *params_of(const pdyn_sim *sim) {
    return sim->objective.batch[0]->params;
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static void assert_rows(pdyn_table table, int count, const double *value, int numbers) {
    assert_int_equal(table.count, count);
    for (int k = 0; k < numbers; k++) assert_true(table.value[k] == value[k]);
}

static void test_forms(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_load(context, POSE("'stiffness': [1, 2, 3, 4], 'target': [[0, 1, 2], "
                                "[3, 4, 5], [6, 7, 8], [9, 10, 11]], 'pair': [[5, 6]]"));
    const struct params *q = params_of(sim);
    assert_rows(q->stiffness, 4, (double[]){1, 2, 3, 4}, 4);
    assert_rows(q->target, 4, (double[]){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, 12);
    assert_rows(q->share, 2, (double[]){1, 1}, 2);
    assert_rows(q->pair, 1, (double[]){5, 6}, 2);
    pdyn_free(sim);
    sim = test_load(context, POSE("'target': [7, 8, 9], 'share': 0.5, 'pair': [1, 2]"));
    q = params_of(sim);
    assert_rows(q->stiffness, 4, (double[]){100, 100, 100, 100}, 4);
    assert_rows(q->target, 4, (double[]){7, 8, 9, 7, 8, 9, 7, 8, 9, 7, 8, 9}, 12);
    assert_rows(q->share, 2, (double[]){0.5, 0.5}, 2);
    assert_rows(q->pair, 1, (double[]){1, 2}, 2);
    pdyn_free(sim);
    sim = test_load(context, POSE("'share': 0"));
    assert_rows(params_of(sim)->target, 0, NULL, 0);
    assert_rows(params_of(sim)->pair, 0, NULL, 0);
    pdyn_free(sim);
}

static void fails(const char *text, const char *expected) {
    pdyn_sim *sim = NULL;
    assert_int_equal(pdyn_load_text(context, quoted(text), "s", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), expected);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

static void test_bad_scenes(void **state) {
    (void)state;
    fails(POSE("'stiffness': [1, 2, 3]"),
          "s:2:31: bodies[0].constraints[0].stiffness: expected an "
          "array of 4 numbers, one per vertex, or one number for all, found an array of 3");
    fails(POSE("'target': [[1, 2, 3]]"),
          "s:2:28: bodies[0].constraints[0].target: expected an array of 4 rows of 3 numbers, one "
          "per vertex, or one array of 3 numbers for all, found an array of 1");
    fails(POSE("'target': [1, 2]"), "s:2:28: bodies[0].constraints[0].target: expected an array of "
                                    "3 numbers (m), found an array of 2");
    fails(POSE("'target': true"),
          "s:2:28: bodies[0].constraints[0].target: expected an array of 4 "
          "rows of 3 numbers, one per vertex, or one array of 3 numbers for all, found true");
    fails(POSE("'stiffness': [1, 2, -3, 4]"), "s:2:38: bodies[0].constraints[0].stiffness[2]: "
                                              "expected a number from 0 to 1000000 N/m, found -3");
    fails(POSE("'stiffness': 2e6"), "s:2:31: bodies[0].constraints[0].stiffness: expected a number "
                                    "from 0 to 1000000 N/m, found 2000000.0");
    fails(POSE("'pair': []"), "s:2:26: bodies[0].constraints[0].pair: expected an array of rows of "
                              "2 numbers, found an array of 0");
}

/* ---- files ----------------------------------------------------------------------------------- */

static void test_files(void **state) {
    (void)state;
    test_write_text("target.txt", "# a comment\n0 1 2\n\n 3,4, 5 # another one\r\n6\t7 8\n9 10 11");
    test_write_text("share.txt", "0.5\v\n\f2\n");
    pdyn_sim *sim = test_load(context, POSE("'target': 'target.txt', 'share': 'share.txt'"));
    assert_rows(params_of(sim)->target, 4, (double[]){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, 12);
    assert_rows(params_of(sim)->share, 2, (double[]){0.5, 2}, 2);
    pdyn_free(sim);
    test_remove_file("target.txt");
    test_remove_file("share.txt");
}

static void test_bad_files(void **state) {
    (void)state;
    static const struct {
        const char *text, *error;
    } bad[] = {
        {"1\n2\n3\n", "f.txt: expected 4 lines of 1 number, one per vertex, found 3"},
        {"1\n2\n\f\n4\n", "f.txt: expected 4 lines of 1 number, one per vertex, found 3"},
        {"", "f.txt: expected 4 lines of 1 number, one per vertex, found 0"},
        {"1\n2\n\n3 3\n4\n", "f.txt:4: expected 1 number, found more than 1"},
        {"1\n2\n#\n-3\n4\n", "f.txt:4: expected a number from 0 to 1000000 N/m, found \"-3\""},
        {"1\nnan\n3\n4\n", "f.txt:2: expected a number from 0 to 1000000 N/m, found \"nan\""},
        {"1\n2x\n3\n4\n", "f.txt:2: expected a number from 0 to 1000000 N/m, found \"2x\""},
        {"1\n2\n3\nfour\n", "f.txt:4: expected a number from 0 to 1000000 N/m, found \"four\""}};
    char expected[256];
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        test_write_text("f.txt", bad[k].text);
        snprintf(expected, sizeof expected, "s:2:31: bodies[0].constraints[0].stiffness: %s",
                 bad[k].error);
        fails(POSE("'stiffness': 'f.txt'"), expected);
    }
    test_write_text("f.txt", "1 2 3\n4 5\n6 7 8\n9 9 9");
    fails(POSE("'target': 'f.txt'"),
          "s:2:28: bodies[0].constraints[0].target: f.txt:2: expected 3 numbers, found 2");
    test_write_text("f.txt", "1\ninf\n");
    fails(POSE("'share': 'f.txt'"), "s:2:27: bodies[0].constraints[0].share: f.txt:2: expected a "
                                    "number of at least 0, found \"inf\"");
    test_remove_file("f.txt");
}

/* A file in the folder of the scene; the command line names one, too. */
static void test_folder(void **state) {
    (void)state;
    pdyn_sim *sim = NULL;
    test_write_text("scene.json", quoted(POSE("'stiffness': 5")));
    test_write_text("four.txt", "1\n2\n3\n4\n");
    static const char *const set[] = {"bodies.0.constraints.pose.stiffness=four.txt"};
    assert_int_equal(pdyn_load(context, "./scene.json", set, 1, &sim), PDYN_OK);
    assert_rows(params_of(sim)->stiffness, 4, (double[]){1, 2, 3, 4}, 4);
    pdyn_free(sim);
    test_remove_file("scene.json");
    test_remove_file("four.txt");
}

/* ---- changes between steps ------------------------------------------------------------------- */

static void steps(pdyn_sim *sim, int count) {
    for (int k = 0; k < count; k++) test_step(sim);
}

static const double four[] = {1, 200, 3, 4};
#define FOUR "'stiffness': [1, 200, 3, 4]"

static void test_set(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, POSE("'stiffness': 7")),
             *other = test_load(context, POSE(FOUR));
    assert_int_equal(pdyn_set_parameter(sim, 0, "stiffness", four, 4), PDYN_OK);
    pdyn_vector_info info = pdyn_get_vector(sim, 0, 0);
    assert_string_equal(info.name, "stiffness");
    assert_true(info.count == 4 && info.width == 1 && info.changeable && info.value[1] == 200.0);
    assert_true(pdyn_get_vector(sim, 0, 1).count == 0 && pdyn_get_vector(sim, 0, 1).width == 3);
    assert_null(pdyn_get_vector(sim, 0, -1).name);
    steps(sim, 5), steps(other, 5);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    assert_int_equal(pdyn_set_parameter(sim, 0, "target", (double[]){0, 1, 0}, 3), PDYN_OK);
    assert_rows(params_of(sim)->target, 4, (double[]){0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, 12);
    pdyn_free(sim);
    pdyn_free(other);
}

static void refuses(pdyn_sim *sim, const char *name, const double *value, int count,
                    const char *expected) {
    char text[256];
    assert_int_equal(pdyn_set_parameter(sim, 0, name, value, count), PDYN_BAD_INPUT);
    snprintf(text, sizeof text, "constraint \"pose\" on body \"body0\": %s: expected %s", name,
             expected);
    assert_string_equal(pdyn_last_error(context), text);
}

static void test_bad_set(void **state) {
    (void)state;
#define EXPECTED "4 numbers, one per vertex, or one row for all, from 0 to 1000000 N/m, found "
    pdyn_sim *sim = test_load(context, POSE(FOUR));
    refuses(sim, "stiffness", four, 3, EXPECTED "3 numbers");
    refuses(sim, "stiffness", four, 0, EXPECTED "0 numbers");
    refuses(sim, "stiffness", (double[]){1, 2, 3, -1}, 4, EXPECTED "-1 in row 3");
    refuses(sim, "stiffness", (double[]){NAN}, 1, EXPECTED "nan in row 0");
    refuses(sim, "share", (double[]){INFINITY}, 1,
            "2 numbers, one per triangle, or one row for all, of at least 0, found inf in row 0");
    refuses(sim, "pair", four, 3, "rows of 2 numbers, from 0 to 1000000, found 3 numbers");
    assert_rows(params_of(sim)->stiffness, 4, four, 4);
    pdyn_free(sim);
}

/* ---- saved states ---------------------------------------------------------------------------- */

static void test_resume(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, POSE("'stiffness': 7")),
             *other = test_load(context, POSE("'stiffness': 7"));
    assert_int_equal(pdyn_save(sim, "start"), PDYN_OK);
    assert_int_equal(pdyn_set_parameter(sim, 0, "stiffness", four, 4), PDYN_OK);
    assert_int_equal(pdyn_set_parameter(sim, 0, "target", (double[]){0, 1, 0}, 3), PDYN_OK);
    steps(sim, 3);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    assert_int_equal(pdyn_restore(other, "state"), PDYN_OK);
    assert_rows(params_of(other)->stiffness, 4, four, 4);
    steps(sim, 3), steps(other, 3);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    assert_int_equal(pdyn_restore(other, "start"), PDYN_OK);
    assert_rows(params_of(other)->stiffness, 4, (double[]){7, 7, 7, 7}, 4);
    assert_rows(params_of(other)->target, 0, NULL, 0);
    pdyn_free(sim);
    pdyn_free(other);
    test_remove_file("start");
    test_remove_file("state");
}

/* A file with other numbers is another scene, as other numbers in the scene are. */
static void test_changed_file(void **state) {
    (void)state;
    static const char scene[] = POSE("'stiffness': 'f.txt'");
    test_write_text("f.txt", "1\n2\n3\n4\n");
    pdyn_sim *sim = test_load(context, scene);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    pdyn_free(sim);
    test_write_text("f.txt", "1.0\n2\n3 # the same\n4\n");
    sim = test_load(context, scene);
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_OK);
    pdyn_free(sim);
    test_write_text("f.txt", "1\n2\n3\n5\n");
    sim = test_load(context, scene);
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_BAD_INPUT);
    pdyn_free(sim);
    test_remove_file("f.txt");
    test_remove_file("state");
}

/* ---- memory ---------------------------------------------------------------------------------- */

static pdyn_context *counting;

static pdyn_status load_and_set(const void *text) {
    pdyn_sim *sim = NULL;
    pdyn_status status = pdyn_load_text(counting, quoted(text), "s", NULL, 0, &sim);
    if (status == PDYN_OK) assert_rows(params_of(sim)->share, 2, (double[]){1, 2}, 2);
    if (status == PDYN_OK) status = pdyn_restore(sim, "state");
    if (status == PDYN_OK) assert_rows(params_of(sim)->stiffness, 4, four, 4);
    if (status == PDYN_OK) status = pdyn_set_parameter(sim, 0, "stiffness", (double[]){5}, 1);
    if (status == PDYN_OK) assert_rows(params_of(sim)->stiffness, 4, (double[]){5, 5, 5, 5}, 4);
    if (status == PDYN_OK) status = pdyn_step(sim, NULL);
    pdyn_free(sim);
    return status;
}

static void test_failing_memory(void **state) {
    (void)state;
    struct counter counter;
    counting = test_counting_context(1, &counter);
    assert_int_equal(pdyn_register(counting, &plugin), PDYN_OK);
    test_write_text("f.txt", "1\n2\n");
    static const char scene[] = POSE("'share': 'f.txt', 'target': [1, 2, 3], 'pair': [[1, 2]]");
    pdyn_sim *sim = test_load(counting, scene);
    assert_int_equal(pdyn_set_parameter(sim, 0, "stiffness", four, 4), PDYN_OK);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    pdyn_free(sim);
    test_failing_allocations(counting, &counter, load_and_set, scene);
    test_remove_file("state");
    test_remove_file("f.txt");
    pdyn_destroy(counting);
}

/* ---- conformance ----------------------------------------------------------------------------- */

static void count_fault(void *user, const char *text) {
    (void)text;
    ++*(int *)user;
}

static int faults_of(const char *name) {
    int faults = -1, told = 0;
    assert_int_equal(pdyn_conformance(context, name, count_fault, &told, &faults), PDYN_OK);
    assert_int_equal(faults, told);
    return faults;
}

static void test_conformance(void **state) {
    (void)state;
    assert_int_equal(faults_of("pose"), 0);
    assert_int_equal(faults_of("muscle"), 0);
    type.weight = weight_from_first;
    assert_true(faults_of("pose") > 0);
    type.weight = weight;
}

/* ---- muscle ---------------------------------------------------------------------------------- */

/* A free bar along x of 2 x 1 x 1 cells. */
#define BAR(constraints)                                                                           \
    SCENE("'duration': 10, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.01, 'integrator': "      \
          "'euler'}, 'solver': {'tolerance': 1e-8, 'outer_iterations': 100, 'linear_tolerance': "  \
          "1e-10}",                                                                                \
          "{'volume': {'grid': {'size': [0.4, 0.2, 0.2], 'cells': [2, 1, 1]}, 'density': 1000}, "  \
          "'constraints': [" constraints "]}",                                                     \
          "")
#define FIBRES "{'type': 'muscle', 'fibre': [3, 0, 0], 'activation': 0.3, 'stiffness': 3e4}"

/* The largest difference of the stretch of an edge along x or y (stride 1 or 3) from `expected`. */
static double deviation(const pdyn_sim *sim, int stride, double expected) {
    double worst = 0.0;
    for (int i = 0; i + stride < sim->objective.particles; i++) {
        if (stride == 1 ? i % 3 == 2 : i % 6 >= 3) continue;
        double length = vec3_distance(sim->x + 3 * i, sim->x + 3 * (i + stride));
        worst = fmax(worst, fabs(length / 0.2 - expected));
    }
    return worst;
}

/* Without other forces, fibres shorten to 1 - activation, also after the program has changed it. */
static void test_free_fibres(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, BAR(FIBRES));
    steps(sim, 600);
    assert_true(deviation(sim, 1, 0.7) < 1e-6);
    assert_int_equal(pdyn_set_parameter(sim, 0, "activation", (double[]){0.1}, 1), PDYN_OK);
    steps(sim, 600);
    assert_true(deviation(sim, 1, 0.9) < 1e-6);
    pdyn_free(sim);
}

/* In a solid of Young's modulus E without Poisson's effect, k (s - l) + E (s - 1) = 0. Fibres that
 * turn to y between two steps shorten the bar there. */
static void test_fibres_in_solid(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, BAR(PAIR(FIBRES, "{'type': 'tet', 'stiffness': 1e4}")));
    double exact = (3e4 * 0.7 + 1e4) / 4e4;
    steps(sim, 1500);
    assert_true(deviation(sim, 1, exact) < 1e-4);
    assert_true(deviation(sim, 3, 1.0) < 1e-4);
    assert_int_equal(pdyn_set_parameter(sim, 0, "fibre", (double[]){0, 1, 0}, 3), PDYN_OK);
    steps(sim, 1500);
    assert_true(deviation(sim, 1, 1.0) < 1e-4);
    assert_true(deviation(sim, 3, exact) < 1e-4);
    assert_int_equal(pdyn_set_parameter(sim, 0, "fibre", (double[]){0, 0, 0}, 3), PDYN_OK);
    steps(sim, 1500);
    assert_true(deviation(sim, 3, 1.0) < 1e-4);
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),          cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_files),          cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_folder),         cmocka_unit_test(test_set),
        cmocka_unit_test(test_bad_set),        cmocka_unit_test(test_resume),
        cmocka_unit_test(test_changed_file),   cmocka_unit_test(test_failing_memory),
        cmocka_unit_test(test_conformance),    cmocka_unit_test(test_free_fibres),
        cmocka_unit_test(test_fibres_in_solid)};
    return cmocka_run_group_tests_name("table", tests, set_up, tear_down);
}
