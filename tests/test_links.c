/* Tables whose rows begin with vertices: scenes, files, changes between steps, refused types; and
 * the example plug-in links.c by an exact solution. */
#include "support.h"

#include "projdyn/conformance.h"
#include "projdyn/control.h"
#include "projdyn/module.h"
#include "projdyn/vec3.h"

#include <string.h>

static pdyn_context *context;

static int set_up(void **state) {
    context = test_context(1);
    assert_int_equal(pdyn_register(context, &pdyn_plugin_table), PDYN_OK);
    return test_enter_directory(state);
}

static int tear_down(void **state) {
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    return test_leave_directory(state);
}

/* Four vertices in the x-z plane, 0.25 kg each; two of them are pinned. */
#define LINKS(link)                                                                                \
    SCENE("'duration': 10, 'time_step': {'fixed': 0.01, 'integrator': 'euler'}, 'solver': "        \
          "{'tolerance': 1e-6}",                                                                   \
          GRID_SHEET("", "1, 1", "2, 2", "'rotate': [90, 0, 0], 'area_density': 1",                \
                     "\n{'type': 'links', 'link': " link "}, " PINS("'vertices': [0, 1]")),        \
          "")
#define BOTH_LINKS "[[0, 2, 100], [3, 1, 200]]"

/* Vertices hang from the pins: the force of a spring is the weight, so it is longer by m g / k. */
static void test_hanging(void **state) {
    (void)state;
    static const double stiffness[] = {100, 200};
    pdyn_sim *sim = test_load(context, LINKS(BOTH_LINKS));
    while (pdyn_time(sim) < 8.0) test_step(sim);
    pdyn_state s = pdyn_get_state(sim);
    double distance[2];
    assert_int_equal(pdyn_element_values(sim, 0, NULL, distance), PDYN_OK);
    for (int e = 0; e < 2; e++) {
        double due = s.mass[2 + e] * 9.81 / stiffness[e];
        print_message("spring of %g N/m: longer by %.6g m, expected %.6g m\n", stiffness[e],
                      distance[e], due);
        assert_true(fabs(distance[e] / due - 1.0) < 0.01);
    }
    pdyn_free(sim);
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void fails(const char *text, const char *expected) {
    pdyn_sim *sim = NULL;
    assert_int_equal(pdyn_load_text(context, quoted(text), "s", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), expected);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

#define AT(column, where) "s:2:" column ": bodies[0].constraints[0].link" where ": "

static void test_bad_scenes(void **state) {
    (void)state;
    fails(LINKS("[[0, 2, 1], [0, 4, 1]]"),
          AT("43", "[1][1]") "expected a vertex from 0 to 3, another one than before it in the "
                             "row, found 4");
    fails(LINKS("[[-1, 2, 1]]"), AT("29", "[0][0]") "expected a vertex from 0 to 3, found -1");
    fails(LINKS("[[0.5, 2, 1]]"), AT("29", "[0][0]") "expected a vertex from 0 to 3, found 0.5");
    fails(LINKS("[[2, 2, 1]]"),
          AT("32", "[0][1]") "expected a vertex from 0 to 3, another one than before it in the "
                             "row, found 2");
    fails(LINKS("[[0, 2, -1]]"),
          AT("35", "[0][2]") "expected a number from 0 to 1e+12 N/m, found -1");
    fails(LINKS("[[0, 2]]"), AT("28", "[0]") "expected an array of 3 numbers, found an array of 2");
}

static void test_bad_files(void **state) {
    (void)state;
    test_write_text("f.txt", "# springs\n0 2 5\n\n1 4 5\n");
    fails(LINKS("'f.txt'"),
          AT("27", "") "f.txt:4: expected a vertex from 0 to 3, another one than before it in the "
                       "row, found \"4\"");
    test_write_text("f.txt", "0 2 5\n1.5 3 5\n");
    fails(LINKS("'f.txt'"), AT("27", "") "f.txt:2: expected a vertex from 0 to 3, found \"1.5\"");
    test_write_text("f.txt", "0 2 5\n1 3 5 7\n");
    fails(LINKS("'f.txt'"), AT("27", "") "f.txt:2: expected 3 numbers, found more than 3");
    test_write_text("f.txt", "0 2 5\n1 3 5\n");
    pdyn_free(test_load(context, LINKS("'f.txt'")));
    test_remove_file("f.txt");
}

/* Between two steps a program gives other vertices; wrong ones change nothing. */
static void test_changes(void **state) {
    (void)state;
    static const double other[] = {0, 3, 50, 1, 2, 60}, bad[] = {0, 2, 100, 3, 4, 100};
    pdyn_sim *sim = test_load(context, LINKS(BOTH_LINKS));
    assert_int_equal(pdyn_set_parameter(sim, 0, "link", bad, 6), PDYN_BAD_INPUT);
    assert_error("rows of 3 numbers, the first 2 different vertices from 0 to 3, the others from 0 "
                 "to 1e+12 N/m, found 4 in row 1");
    assert_int_equal(pdyn_set_parameter(sim, 0, "link", other, 6), PDYN_OK);
    test_step(sim);
    assert_memory_equal(pdyn_get_vector(sim, 0, 0).value, other, sizeof other);
    assert_int_equal(pdyn_save(sim, "links.state"), PDYN_OK);
    pdyn_sim *again = test_load(context, LINKS(BOTH_LINKS));
    assert_int_equal(pdyn_restore(again, "links.state"), PDYN_OK);
    assert_memory_equal(pdyn_get_vector(again, 0, 0).value, other, sizeof other);
    test_remove_file("links.state");
    pdyn_free(sim), pdyn_free(again);
}

/* ---- types ----------------------------------------------------------------------------------- */

static void assert_refused(pdyn_param_kind kind, unsigned flags, bool required, const char *fault) {
    pdyn_param table[2] = {pdyn_plugin_table.constraints[0]->params[0]};
    pdyn_constraint_type type = *pdyn_plugin_table.constraints[0];
    const pdyn_constraint_type *const list[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "wrong", list, NULL};
    table[0].kind = kind, table[0].required = required;
    type.name = "wrong", type.flags = flags, type.params = table;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_BAD_INPUT);
    assert_error(fault);
}

static void test_types(void **state) {
    (void)state;
    assert_refused(PDYN_VERTEX_TABLE(PDYN_ROWS, 2, 3), PDYN_ON_PARTICLES, true,
                   "vertices need PDYN_ON_SURFACE or PDYN_ON_VOLUME");
    assert_refused(PDYN_VERTEX_TABLE(PDYN_ROWS, 4, 3), PDYN_ON_SURFACE, true,
                   "its rows have more vertices than numbers");
    assert_refused(PDYN_VERTEX_TABLE(PDYN_ROWS, 2, 3), PDYN_ON_SURFACE, false,
                   "vertices have no default");
    assert_refused(PDYN_VERTEX_TABLE(0, 2, 3), PDYN_ON_SURFACE, true, "its kind is unknown");
}

static void tell(void *user, const char *text) { (void)user, print_message("%s\n", text); }

static void test_conformance(void **state) {
    (void)state;
    int faults = -1;
    assert_int_equal(pdyn_conformance(context, "links", tell, NULL, &faults), PDYN_OK);
    assert_int_equal(faults, 0);
}

/* ---- a type whose rows have one vertex ------------------------------------------------------- */

struct curve {
    pdyn_table vertex;
    double stiffness;
};

static pdyn_param_fault curve_resolve(void *par, const pdyn_scene_info *scene) {
    (void)scene;
    bool closed = ((const struct curve *)par)->vertex.count > 2;
    return (pdyn_param_fault){closed ? NULL : "a closed curve has at least three vertices", NULL};
}

static int curve_elements(const void *par, const pdyn_body *body) {
    (void)body;
    return ((const struct curve *)par)->vertex.count;
}

static void curve_select(const void *par, const pdyn_batch *b, int first, int last) {
    const pdyn_table *vertex = &((const struct curve *)par)->vertex;
    for (int e = first; e < last; e++) {
        int from = (int)vertex->value[e], to = (int)vertex->value[(e + 1) % vertex->count];
        b->column[2 * e] = b->body->first + from, b->coefficient[2 * e] = 1.0;
        b->column[2 * e + 1] = b->body->first + to, b->coefficient[2 * e + 1] = -1.0;
        ((double *)b->data)[e] = vec3_distance(b->body->rest + 3 * from, b->body->rest + 3 * to);
    }
}

static void curve_weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct curve *)par)->stiffness;
}

/* A spring between each vertex and the next one of a closed curve: conformance gives it a curve. */
static void test_curve(void **state) {
    (void)state;
    static const pdyn_param params[] = {{"vertex", PDYN_VERTEX_TABLE(PDYN_ROWS, 1, 1),
                                         offsetof(struct curve, vertex), true, 0, 0, 1, "1",
                                         "the vertices of the curve"},
                                        {"stiffness", PDYN_REAL, offsetof(struct curve, stiffness),
                                         true, 0, 0, 1e9, "N/m", "of each spring"},
                                        {0}};
    static pdyn_constraint_type type;
    static const pdyn_constraint_type *const list[] = {&type, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "curve", list, NULL};
    int faults = -1;
    type = *pdyn_plugin_table.constraints[0];
    type.name = "curve", type.params = params, type.params_size = sizeof(struct curve);
    type.flags = PDYN_ON_SURFACE | PDYN_ON_VOLUME, type.resolve = curve_resolve;
    type.elements = curve_elements, type.select = curve_select, type.weight = curve_weight;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    assert_int_equal(pdyn_conformance(context, "curve", tell, NULL, &faults), PDYN_OK);
    assert_int_equal(faults, 0);
}

static void append(void *user, const char *text) { strncat(user, text, 2000); }

static void test_description(void **state) {
    (void)state;
    char text[4096] = "";
    assert_int_equal(pdyn_describe(context, "links", append, text), PDYN_OK);
    assert_non_null(strstr(text, "2 vertices, number from 0 to 1e+12 per row"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hanging),   cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_bad_files), cmocka_unit_test(test_changes),
        cmocka_unit_test(test_types),     cmocka_unit_test(test_conformance),
        cmocka_unit_test(test_curve),     cmocka_unit_test(test_description)};
    return cmocka_run_group_tests_name("links", tests, set_up, tear_down);
}
