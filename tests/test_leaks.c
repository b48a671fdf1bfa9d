/* The warning "leak": particles that pass sheets and solids. */
#include "sim/crossings.h"
#include "warning_support.h"

#include <string.h>

#define HELD_AT(name, place)                                                                       \
    GRID_SHEET("'name': '" name "', ", "0.16, 0.16", "9, 9",                                       \
               "'area_density': 0.2, 'translate': [" place "]", PINS("'all': true"))
#define HELD SHEET(PINS("'all': true"))

enum { DUST_COUNT = 216, LAYER = 36 };

/* Number of particles that passed `subject` after so many steps. */
static long leaks(const char *scene, const char *subject, int steps) {
    pdyn_context *context = test_context(2);
    pdyn_sim *sim = test_load(context, scene);
    pdyn_step_info info = {0};
    for (int n = 0; n < steps; n++) info = test_step(sim);
    pdyn_warning w = find_warning(sim, "leak", subject);
    assert_true(info.leaked >= w.count || !w.code);
    test_close(sim);
    return w.code ? w.count : 0;
}

/* All particles pass, through vertices and edges, too: the lattice lies on those of the mesh. */
static void test_sheet(void **state) {
    (void)state;
    const char *fast = SCENE(WEIGHTLESS, PAIR(DUST("0, -2, 0"), HELD), "");
    assert_int_equal(leaks(fast, "sheet", 1), 0);
    assert_int_equal(leaks(fast, "sheet", 2), LAYER);
    assert_int_equal(leaks(fast, "sheet", 8), DUST_COUNT);
    assert_int_equal(leaks(SCENE(STEPS, PAIR(DUST("0, -1, 0"), BORDER), ""), "sheet", 40),
                     DUST_COUNT);
    assert_int_equal(leaks(SCENE(WEIGHTLESS, PAIR(DUST("0, 2, 0"), HELD), ""), "sheet", 8), 0);
}

#define SHIFTED(z) SCENE(WEIGHTLESS, PAIR(DUST("0, -2, 0"), HELD_AT("sheet", "0.085, 0, " z)), "")

/* Half of the block is beside the sheet, and a sixth is closer to its border than a radius, also
 * where a triangle has a vertex on the border but no edge. */
static void test_border(void **state) {
    (void)state;
    assert_int_equal(leaks(SHIFTED("0"), "sheet", 8), DUST_COUNT / 3);
    assert_int_equal(leaks(SHIFTED("0.0075"), "sheet", 8), DUST_COUNT / 3);
    assert_int_equal(leaks(SHIFTED("0.0125"), "sheet", 8), DUST_COUNT / 3);
}

#define WALL                                                                                       \
    "{'name': 'wall', 'plane': {'center': [0.085, 0, 0], 'normal': [0, 1, 0], 'size': 0.16}}"

/* The same beside a solid, whose border lies at x = 0.005: a sixth of the dust is closer to it than
 * a radius. A plate below its border closes it, so that nothing goes around. */
static void test_rim(void **state) {
    (void)state;
#define BESIDE(more) SCENE(WEIGHTLESS, DUST("0, -2, 0"), ", 'solids': [" WALL more "]")
    assert_int_equal(leaks(BESIDE(""), "wall", 8), DUST_COUNT / 3);
    assert_int_equal(leaks(BESIDE(", {'name': 'plate', 'plane': {'center': [0, -0.08, 0], "
                                  "'normal': [1, 0, 0], 'size': 0.16}}"),
                           "wall", 8),
                     DUST_COUNT / 2);
}

/* Dust that is thrown up through the sheet and falls back is on its side again. */
static void test_return(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(STEPS, PAIR(DUST("0, 3, 0"), HELD_AT("sheet", "0, 0.3, 0")), ""));
    long most = 0, last = 0;
    for (int n = 0; n < 70; n++) {
        last = test_step(sim).leaked;
        most = last > most ? last : most;
    }
    assert_int_equal(most, DUST_COUNT);
    assert_int_equal(last, 0);
    test_close(sim);
}

/* Dust passes two sheets and comes back through both: it is counted once, and then not at all. The
 * warning keeps the largest number and the time at which it was reached. */
static void test_two_sheets(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        STEPS,
        PAIR(DUST("0, 3, 0"), PAIR(HELD_AT("low", "0, 0.3, 0"), HELD_AT("high", "0, 0.36, 0"))),
        ""));
    long most = 0, last = 0;
    char reached[32] = "";
    for (int n = 0; n < 70; n++) {
        last = test_step(sim).leaked;
        most = last > most ? last : most;
        if (!*reached && find_warning(sim, "leak", "high").count == DUST_COUNT)
            snprintf(reached, sizeof reached, "by %.3g s", pdyn_time(sim));
    }
    assert_int_equal(most, DUST_COUNT);
    assert_int_equal(last, 0);
    assert_int_equal(find_warning(sim, "leak", "high").count, DUST_COUNT);
    assert_string_equal(strstr(find_warning(sim, "leak", "high").text, "by "), reached);
    test_close(sim);
}

/* A box at rest, and a plane that rises through the dust. */
static void test_solids(void **state) {
    (void)state;
    const char *box = SCENE(STEPS, DUST("0, -1, 0"),
                            ", 'solids': [{'name': 'tank', 'box': {'minimum': [-0.07, 0, -0.07], "
                            "'maximum': [0.07, 0.2, 0.07]}}]");
    const char *rising =
        SCENE(WEIGHTLESS, DUST("0, 0, 0"),
              ", 'solids': [{'name': 'lift', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], "
              "'size': 0.3}, 'motion': [{'time': 0, 'translate': [0, 0, 0]}, {'time': 0.1, "
              "'translate': [0, 0.2, 0]}]}]");
    assert_int_equal(leaks(box, "tank", 30), DUST_COUNT);
    assert_int_equal(leaks(rising, "lift", 12), DUST_COUNT);
}

/* A hinge: the side x > 0 of a sheet swings from (1, 0) to `side`, x and y, while a particle goes
 * from `begin` to `end`, near the middle of the sheet in z. Returns how many particles passed. */
static long passed_hinge(const double side[2], const double begin[2], const double end[2]) {
    pdyn_sim *sim = test_open(
        SCENE(WEIGHTLESS,
              PAIR("{'name': 'dust', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': "
                   "[0, 0.5, 0.1], 'maximum': [0.02, 0.52, 0.12]}}]}, 'constraints': []}",
                   GRID_SHEET("'name': 'sheet', ", "2, 2", "3, 3", "'area_density': 0.2",
                              SPRINGS("100"))),
              ""));
    assert_int_equal(sim->body[0].count, 1);
    double *x = sim->x, *x_next = sim->x_next;
    for (int i = 0; i < 3 * sim->objective.particles; i++) x_next[i] = x[i];
    for (int a = 0; a < 2; a++) {
        x[a] = begin[a], x_next[a] = end[a];
        for (int i = 1; i < sim->objective.particles; i++)
            if (x[3 * i] > 0.5) x_next[3 * i + a] = side[a];
    }
    crossings_step(sim, 0.01);
    long passed = crossings_total(sim);
    test_close(sim);
    return passed;
}

/* The plane of a triangle turns within a step. The particle meets it at another time than the ratio
 * of the distances at both ends says: then beside the triangle, or in it. It may also meet the
 * plane twice, beside the triangle and in it. */
static void test_hinge(void **state) {
    (void)state;
    double side[3][2] = {{-0.9, -0.9}, {0, 0.9}, {1.4, -1.5}};
    double begin[3][2] = {{-0.6, -0.7}, {-0.7, 0.1}, {1.9, -0.1}};
    double end[3][2] = {{1.0, -1.0}, {0.3, 0.4}, {-1.5, -0.5}};
    for (int k = 0; k < 3; k++) assert_int_equal(passed_hinge(side[k], begin[k], end[k]), k > 0);
}

/* A sheet that falls through a plane passes it; one that is pinned in the plane and moves by a
 * thousandth of its edges does not. */
static void test_cloth(void **state) {
    (void)state;
#define FLOOR                                                                                      \
    ", 'solids': [{'name': 'floor', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': "  \
    "1}}]"
    const char *falls = SCENE(STEPS, SHEET_AT("sheet", "0.1"), FLOOR);
    const char *moves = SCENE(STEPS,
                              SHEET("{'type': 'pin', 'vertices': {'all': true}, 'path': [[0, 0, 0, "
                                    "0], [0.1, 0, 2e-5, 0], [0.2, 0, -2e-5, 0]]}"),
                              FLOOR);
    assert_int_equal(leaks(falls, "floor", 30), 81);
    assert_int_equal(leaks(moves, "floor", 30), 0);
#undef FLOOR
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sheet),      cmocka_unit_test(test_border),
        cmocka_unit_test(test_rim),        cmocka_unit_test(test_return),
        cmocka_unit_test(test_two_sheets), cmocka_unit_test(test_solids),
        cmocka_unit_test(test_hinge),      cmocka_unit_test(test_cloth),
    };
    return cmocka_run_group_tests_name("leaks", tests, NULL, NULL);
}
