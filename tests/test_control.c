/* Changes while a simulation runs: forces, gravity, positions, solids, steps of the caller; saved
 * states with changes; failed allocations. Parameters: test_parameters.c; holds: test_hold.c. */
#include "control_support.h"

#include <string.h>

static const char sheet[] = SHEET;

/* ---- forces ---------------------------------------------------------------------------------- */

static void test_forces(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(
        context,
        SCENE("'duration': 10, 'frame_interval': 0.05, 'time_step': {'fixed': "
              "0.005, 'integrator': 'euler'}",
              GRID_SHEET("", "0.4, 0.4", "7, 7", "'area_density': 0.5", SPRINGS("1000")), ""));
    const pdyn_state s = pdyn_get_state(sim);
    double force[3 * VERTICES] = {0}, mass = 0.0;
    for (int i = 0; i < VERTICES; i++) force[3 * i + 1] = 9.81 * s.mass[i], mass += s.mass[i];
    good(pdyn_set_forces(sim, 0, VERTICES, force)); /* carries the weight */
    take_steps(sim, 20);
    for (int i = 0; i < VERTICES; i++) assert_true(fabs(s.x[3 * i + 1]) < 1e-12);
    good(pdyn_add_forces(sim, CORNER, 1, (double[]){0.0, 0.0, 0.3}));
    pdyn_step_info info = {0};
    for (int k = 0; k < 20; k++) good(pdyn_step(sim, &info));
    assert_true(fabs(info.momentum[2] - 0.3 * 20 * 0.005) < 1e-12); /* its impulse */
    assert_true(fabs(info.momentum[1]) < 1e-12);
    good(pdyn_set_forces(sim, 0, VERTICES, NULL));
    good(pdyn_step(sim, &info));
    assert_true(fabs(info.momentum[1] + mass * 9.81 * 0.005) < 1e-12);

    assert_int_equal(pdyn_set_forces(sim, 1, VERTICES, force), PDYN_BAD_CALL);
    assert_int_equal(pdyn_set_forces(sim, -1, 1, force), PDYN_BAD_CALL);
    assert_int_equal(pdyn_add_forces(sim, 0, 1, NULL), PDYN_BAD_CALL);
    force[4] = NAN;
    refused(pdyn_set_forces(sim, 0, VERTICES, force),
            "pdyn_set_forces: number 4: expected a force of at most 1e+15 N, found nan");
    pdyn_free(sim);
}

static void test_gravity(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, sheet);
    pdyn_step_info info;
    double g[3];
    good(pdyn_set_gravity(sim, (double[]){0.0, 0.0, 0.0}));
    take_steps(sim, 5);
    for (int k = 0; k < 3 * VERTICES; k++) assert_true(fabs(pdyn_get_state(sim).v[k]) < 1e-9);
    good(pdyn_set_gravity(sim, (double[]){0.0, 3.0, 0.0}));
    for (int k = 0; k < 5; k++) good(pdyn_step(sim, &info));
    assert_true(info.momentum[1] > 0.0);
    pdyn_get_gravity(sim, g);
    assert_true(g[1] == 3.0);
    refused(
        pdyn_set_gravity(sim, (double[]){0.0, INFINITY, 0.0}),
        "pdyn_set_gravity: number 1: expected an acceleration of at most 1e+06 m/s^2, found inf");
    good(pdyn_set_gravity(sim, (double[]){0.0, 1e6, 0.0})); /* as in a scene */
    good(pdyn_set_gravity(sim, (double[]){0.0, 3.0, 0.0}));
    continues(sim, sheet);
    pdyn_free(sim);
}

/* The acceleration, m/s^2, by which a step's residual is measured: that of the sheet's weight. */
static double residual_gravity(pdyn_sim *sim) {
    double squares = 0.0;
    take_steps(sim, 1);
    for (int i = 0; i < VERTICES; i++) squares += sim->objective.mass[i] * sim->objective.mass[i];
    return sim->objective.body[0].weight / sqrt(squares);
}

/* It is the largest gravity of the run, and that of the Earth where there was none. */
static void test_residual(void **state) {
    (void)state;
    static const double gravity[] = {2.0, 20.0, 1.0}, expected[] = {2.0, 20.0, 20.0};
    pdyn_sim *sim = NULL;
    const char *const none = "gravity=[0, 0, 0]";
    good(pdyn_load_text(context, quoted(sheet), "sheet", &none, 1, &sim));
    assert_true(fabs(residual_gravity(sim) - 9.81) < 1e-12);
    for (int k = 0; k < 3; k++) {
        good(pdyn_set_gravity(sim, (double[]){0.0, -gravity[k], 0.0}));
        assert_true(fabs(residual_gravity(sim) - expected[k]) < 1e-12);
    }
    pdyn_free(sim);
}

/* A hanging sheet whose gravity fades out: every step is solved in a few iterations, and a saved
 * state continues with the same tolerance. */
static void test_fading_gravity(void **state) {
    (void)state;
    static const char scene[] = SCENE(
        "'duration': 1, 'frame_interval': 0.1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.005}",
        GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "9, 9", "'area_density': 0.5",
                   SPRINGS("1000") ", " PINS("'vertices': [0, 8]")),
        "");
    pdyn_sim *sim = test_load(context, scene);
    pdyn_step_info info;
    for (int k = 0; k < 40; k++) {
        good(pdyn_set_gravity(sim, (double[]){0.0, -300.0 * pow(0.4, k), 0.0}));
        good(pdyn_step(sim, &info));
        assert_true(info.step_residual <= 0.1 && info.outer_iterations <= 10);
        if (k == 12) continues(sim, scene);
    }
    pdyn_free(sim);
}

/* ---- state ----------------------------------------------------------------------------------- */

/* A run that is put back to an earlier state repeats itself. */
static void test_positions(void **state) {
    (void)state;
    static const char euler[] =
        PINNED("'duration': 10, 'frame_interval': 0.05, 'time_step': {'fixed': 0.005, "
               "'integrator': 'euler'}, 'solver': {'tolerance': 1e-6}",
               "1000");
    pdyn_sim *sim = test_load(context, euler);
    const pdyn_state s = pdyn_get_state(sim);
    double x[3 * VERTICES], v[3 * VERTICES], end[3 * VERTICES];
    take_steps(sim, 10);
    memcpy(x, s.x, sizeof x), memcpy(v, s.v, sizeof v);
    take_steps(sim, 10);
    memcpy(end, s.x, sizeof end);
    good(pdyn_set_positions(sim, 0, VERTICES, x));
    good(pdyn_set_velocities(sim, 0, VERTICES, v));
    take_steps(sim, 10);
    assert_true(test_distance(end, s.x, 3 * VERTICES) < 1e-5);
    continues(sim, euler);
    assert_int_equal(pdyn_set_positions(sim, 1, VERTICES, x), PDYN_BAD_CALL);
    assert_int_equal(pdyn_set_positions(sim, 0, 1, NULL), PDYN_BAD_CALL);
    x[2] = 2e6;
    refused(pdyn_set_positions(sim, 0, VERTICES, x),
            "pdyn_set_positions: number 2: expected a coordinate of at most 1e+06 m, found 2e+06");
    memset(x, 0, sizeof x);
    refused(pdyn_set_positions(sim, 0, VERTICES, x),
            "body \"sheet\": expected places that differ, found one place for all of it");
    good(pdyn_set_positions(sim, 0, 2, x)); /* a part may be folded */
    pdyn_free(sim);
}

/* Where surfaces would intersect, nothing is placed. */
static void test_place_in_contact(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, cloth), *other = test_load(context, cloth);
    const pdyn_state s = pdyn_get_state(sim);
    double x[3 * 81];
    take_steps(sim, 3), take_steps(other, 3);
    for (int k = 0; k < 3 * 81; k++) x[k] = s.x[k] - 0.05 * (k % 3 == 1);
    assert_int_equal(pdyn_set_positions(sim, 0, 81, x), PDYN_BAD_INPUT);
    take_steps(sim, 3), take_steps(other, 3);
    assert_true(test_distance(s.x, pdyn_get_state(other).x, 3 * 81) < 1e-9);
    for (int k = 0; k < 3 * 81; k++) x[k] = s.x[k] + 0.05 * (k % 3 == 1);
    good(pdyn_set_positions(sim, 0, 81, x));
    take_steps(sim, 3);
    pdyn_free(sim);
    pdyn_free(other);
}

/* Water that is moved behind a wall has not leaked. */
static void test_place_fluid(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, fluid);
    const pdyn_state s = pdyn_get_state(sim);
    double *x = malloc(3 * (size_t)s.particles * sizeof *x);
    pdyn_step_info info = {0};
    take_steps(sim, 3);
    for (int k = 0; k < 3 * s.particles; k++) x[k] = s.x[k] + 1.0 * (k % 3 == 0);
    good(pdyn_set_positions(sim, 0, s.particles, x));
    for (int k = 0; k < 3; k++) good(pdyn_step(sim, &info));
    assert_int_equal(info.leaked, 0);
    free(x);
    continues(sim, fluid);
    pdyn_free(sim);
}

/* ---- solids ---------------------------------------------------------------------------------- */

static void test_move_solid(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, cloth);
    const double up[3] = {0, 0.3, 0}, none[3] = {0};
    double highest = -1.0;
    take_steps(sim, 5);
    good(pdyn_move_solid(sim, 0, 0.35, up, none));
    continues(sim, cloth);
    take_steps(sim, 30);
    const pdyn_state s = pdyn_get_state(sim);
    for (int i = 0; i < s.particles; i++) highest = fmax(highest, s.x[3 * i + 1]);
    assert_true(highest > 0.39); /* the sphere has lifted the sheet */
    refused(pdyn_move_solid(sim, 0, 0.1, up, none),
            "solid \"solid0\": expected a time after that of the simulation");
    assert_int_equal(pdyn_move_solid(sim, 1, 9.0, up, none), PDYN_BAD_CALL);
    assert_int_equal(pdyn_move_solid(sim, 0, 9.0, NULL, none), PDYN_BAD_CALL);
    pdyn_free(sim);
    sim = test_load(context, fluid);
    refused(pdyn_move_solid(sim, 0, 9.0, up, none),
            "solid \"tank\": expected \"motion\" in the scene, with at least one key");
    good(pdyn_move_solid(sim, 1, 0.05, (double[]){0, 0.02, 0}, none));
    take_steps(sim, 3);
    continues(sim, fluid);
    pdyn_free(sim);
}

/* ---- steps ----------------------------------------------------------------------------------- */

static void test_step_by(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, sheet), *other = test_load(context, sheet);
    pdyn_step_info info;
    int frames = 0;
    for (int k = 0; k < 20; k++) {
        good(pdyn_step_by(sim, 0.005, &info));
        frames += info.frame;
    }
    take_steps(other, 20);
    assert_int_equal(frames, 2);
    assert_true(test_distance(pdyn_get_state(sim).x, pdyn_get_state(other).x, 3 * VERTICES) < 1e-9);
    good(pdyn_step_by(sim, 0.012, &info));
    assert_true(!info.frame && info.h == 0.012);
    good(pdyn_step_by(sim, 0.13, &info)); /* over two frames */
    assert_true(info.frame && fabs(info.time - 0.242) < 1e-12);
    continues(sim, sheet);
    good(pdyn_step(sim, &info));
    assert_true(info.time < 0.3);
    good(pdyn_step_by(sim, 0.3 - 1e-7 - info.time, &info)); /* the frame at 0.3 is left out */
    good(pdyn_step(sim, &info));
    assert_true(!info.frame && info.time > 0.3);
    continues(sim, sheet);
    refused(pdyn_step_by(sim, 0.0, NULL),
            "pdyn_step_by: expected a step from 1e-09 to 1000 s, found 0 s");
    assert_int_equal(pdyn_step_by(sim, NAN, NULL), PDYN_BAD_INPUT);
    assert_error("pdyn_step_by: expected a step from");
    assert_int_equal(pdyn_step_by(NULL, 0.1, NULL), PDYN_BAD_CALL);
    pdyn_free(sim);
    pdyn_free(other);
}

/* ---- failures -------------------------------------------------------------------------------- */

/* A state without changes takes all changes back. */
static void test_restore_without_changes(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, sheet), *other = test_load(context, sheet);
    take_steps(other, 8);
    good(pdyn_save(other, "before"));
    good(pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){20.0}, 1));
    good(pdyn_set_gravity(sim, (double[]){1, 2, 3}));
    good(pdyn_set_forces(sim, 0, 1, (double[]){1, 2, 3}));
    good(pdyn_hold(sim, CORNER, 1e3, (double[]){0, 0, 0}));
    good(pdyn_enable(sim, PIN, false));
    take_steps(sim, 3);
    good(pdyn_restore(sim, "before"));
    test_remove_file("before");
    take_steps(sim, 5), take_steps(other, 5);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    pdyn_free(sim);
    pdyn_free(other);
}

static pdyn_status change_all(pdyn_sim *sim) {
    pdyn_status status = pdyn_set_forces(sim, 0, 1, (double[]){1, 0, 0});
    if (status == PDYN_OK)
        status = pdyn_set_parameter(sim, PIN, "path", (double[]){0, 0, 0.01, 0}, 4);
    if (status == PDYN_OK)
        status = pdyn_set_parameter(sim, BENDS, "bending_rigidity", (double[]){1e-2}, 1);
    if (status == PDYN_OK) status = pdyn_hold(sim, CORNER, 1e3, (double[]){0, 0, 0});
    if (status == PDYN_OK) status = pdyn_set_positions(sim, 1, 1, (double[]){0, 0, 0});
    return status == PDYN_OK ? pdyn_step(sim, NULL) : status;
}

static void test_failing_allocations_of_changes(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *counting = test_counting_context(1, &counter);
    pdyn_status status = PDYN_NO_MEMORY;
    for (long left = 0; status != PDYN_OK; left++) {
        test_allow(&counter, -1);
        pdyn_sim *sim = test_load(counting, sheet);
        good(pdyn_step(sim, NULL));
        test_allow(&counter, left);
        status = change_all(sim);
        test_allow(&counter, -1);
        assert_true(status == PDYN_OK || status == PDYN_NO_MEMORY);
        assert_non_null(pdyn_solver_reason(sim));
        good(pdyn_save(sim, "state"));
        pdyn_sim *other = test_load(counting, sheet);
        assert_int_equal(pdyn_restore(other, "state"), PDYN_OK);
        assert_int_equal(pdyn_step(other, NULL), PDYN_OK);
        pdyn_free(other);
        pdyn_free(sim);
        assert_int_equal(pdyn_bytes_in_use(counting), 0);
    }
    test_remove_file("state");
    pdyn_destroy(counting);
}

/* Water falls as in vacuum by steps in which it moves by several radii: "cfl" does not limit steps
 * that a program gives. */
static void test_long_steps(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, "{'duration': 1, 'bodies': [{'name': 'w', 'particles': "
                                       "{'radius': 0.01, 'fill': [{'box': {'minimum': [0, 2, 0], "
                                       "'maximum': [0.08, 2.08, 0.08]}}]}, 'constraints': "
                                       "[{'type': 'fluid', 'compression': 0.001}]}]}");
    const double height = sim->x[1];
    pdyn_step_info info;
    for (int k = 0; k < 30; k++) {
        good(pdyn_step_by(sim, 1.0 / 60.0, &info));
        assert_true(!info.retries && info.h == 1.0 / 60.0);
    }
    assert_true(fabs(height - sim->x[1] - 0.5 * 9.81 * 0.25) < 0.01);
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forces),
        cmocka_unit_test(test_gravity),
        cmocka_unit_test(test_residual),
        cmocka_unit_test(test_fading_gravity),
        cmocka_unit_test(test_positions),
        cmocka_unit_test(test_place_in_contact),
        cmocka_unit_test(test_place_fluid),
        cmocka_unit_test(test_move_solid),
        cmocka_unit_test(test_step_by),
        cmocka_unit_test(test_long_steps),
        cmocka_unit_test(test_restore_without_changes),
        cmocka_unit_test(test_failing_allocations_of_changes),
    };
    return cmocka_run_group_tests_name("control", tests, control_set_up, control_tear_down);
}
