/* Pins with paths and turns, and several pins on one body. */
#include "support.h"

#include "projdyn/vec3.h"
#include "scene/transform.h"

static void test_turn(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        SCENE("'duration': 1, 'gravity': [0, 0, 0], 'frame_interval': 0.01, 'time_step': {'fixed': "
              "0.01}, 'solver': {'tolerance': 1e-6}",
              GRID_SHEET("", "1, 1", "2, 2", "'area_density': 1",
                         PAIR("{'type': 'pin', 'vertices': {'vertices': [0, 1]}, 'pivot': [0, 0, "
                              "-0.5], 'turn': [[0, 0, 0, 0], [0.1, 0, 0, 90], [0.2, 90, 0, 90]], "
                              "'path': [[0.1, 0, 0, 0], [0.2, 0, 0, 3]]}",
                              PINS("'vertices': [2, 3]"))),
              ""));
    const pdyn_state s = pdyn_get_state(sim);
    assert_int_equal(s.constraints, 2);
    for (int n = 1; n <= 20; n++) {
        test_step(sim);
        double first = fmin(1.0, 0.1 * n), then = 0.1 * n - first, turn = 0.5 * acos(-1.0) * first;
        /* the turn about x comes before z: the point on the axis through the pivot stays */
        double x[3] = {0.5 * cos(turn), 0.5 * sin(turn), -0.5 + 3.0 * then};
        assert_true(vec3_distance(s.x + 3, x) < 1e-3);
        assert_true(vec3_distance(s.x + 9, (double[]){0.5, 0, 0.5}) < 1e-3);
    }
    test_close(sim);
}

/* The order of turns is that of "rotate". */
static void test_order(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        SCENE("'duration': 1, 'gravity': [0, 0, 0], 'frame_interval': 0.01, 'time_step': {'fixed': "
              "0.01}, 'solver': {'tolerance': 1e-6}",
              GRID_SHEET("", "1, 1", "2, 2", "'area_density': 1",
                         "{'type': 'pin', 'vertices': {'all': true}, 'turn': [[0, 30, -40, 50]]}"),
              ""));
    struct transform transform = {.scale = {1, 1, 1}, .rotate = {30, -40, 50}};
    double expected[12];
    for (int k = 0; k < 12; k++) expected[k] = sim->x[k];
    transform_points(&transform, expected, 4);
    test_step(sim);
    assert_true(test_distance(sim->x, expected, 12) < 1e-3);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_turn), cmocka_unit_test(test_order)};
    return cmocka_run_group_tests_name("pin", tests, NULL, NULL);
}
