/* Changes while a simulation runs: forces, gravity, positions, parameters, holds, solids, steps of
 * the caller; saved states with changes; failed allocations. */
#include "projdyn/control.h"
#include "projdyn/module.h"
#include "small_scenes.h"
#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

#define FIXED "'duration': 10, 'frame_interval': 0.05, 'time_step': {'fixed': 0.005}"
#define PINNED(settings, stiffness)                                                                \
    SCENE(settings,                                                                                \
          GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "7, 7", "'area_density': 0.5",               \
                     PAIR(PAIR(SPRINGS(stiffness), BENDING("1e-3")), PINS("'vertices': [0, 6]"))), \
          "")
#define SOLVER(type, step)                                                                         \
    FIXED ", 'solver': {'type': '" type "', 'step': '" step "', 'tolerance': 1e-3}"

static const char sheet[] = PINNED(FIXED, "1000");
enum { VERTICES = 49, SPRING = 0, BENDS = 1, PIN = 2, CORNER = 48 };

static pdyn_context *context;

static int set_up(void **state) {
    context = test_context(2);
    return test_enter_directory(state);
}

static int tear_down(void **state) {
    pdyn_destroy(context);
    return test_leave_directory(state);
}

static void good(pdyn_status status) {
    if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
}

static void refused(pdyn_status status, const char *expected) {
    assert_int_equal(status, PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), expected);
}

static void take_steps(pdyn_sim *sim, int count) {
    for (int k = 0; k < count; k++) good(pdyn_step(sim, NULL));
}

/* A simulation restored from a state saved now ends with the same bits. */
static void continues(pdyn_sim *sim, const char *text) {
    good(pdyn_save(sim, "state"));
    pdyn_sim *other = test_load(context, text);
    good(pdyn_restore(other, "state"));
    take_steps(sim, 5), take_steps(other, 5);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    pdyn_free(other);
    test_remove_file("state");
}

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
            "number 4: expected a force of at most 1e+15 N, found nan");
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
    refused(pdyn_set_gravity(sim, (double[]){0.0, INFINITY, 0.0}),
            "number 1: expected an acceleration of at most 1e+06 m/s^2, found inf");
    good(pdyn_set_gravity(sim, (double[]){0.0, 1e6, 0.0})); /* as in a scene */
    good(pdyn_set_gravity(sim, (double[]){0.0, 3.0, 0.0}));
    continues(sim, sheet);
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
            "number 2: expected a coordinate of at most 1e+06 m, found 2e+06");
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

/* ---- parameters ------------------------------------------------------------------------------ */

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
        "constraint \"spring\" on body \"sheet\": stretching_stiffness: expected 1 number from 0 "
        "to 1e+12 N/m");
    refused(
        pdyn_set_parameter(sim, SPRING, "stretching_stiffness", (double[]){1.0, 2.0}, 2),
        "constraint \"spring\" on body \"sheet\": stretching_stiffness: expected 1 number from 0 "
        "to 1e+12 N/m");
    refused(
        pdyn_set_parameter(sim, SPRING, "damping", (double[]){1.0}, 1),
        "constraint \"spring\" on body \"sheet\": damping must stay 0 while the simulation runs");
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
static int all_points(const void *par, const pdyn_body *body) { return (void)par, body->count; }
static void select_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}
static void weigh_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 1e5;
}
static void stop_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = k % 3 == 1 ? 0.0 : b->u[k];
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
                                               .project = stop_point};
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

/* ---- holds ----------------------------------------------------------------------------------- */

static void hold_and_release(const char *text) {
    if (test_lacks_solver(text)) return;
    pdyn_sim *sim = test_load(context, text);
    const double *x = pdyn_get_state(sim).x + 3 * CORNER;
    double target[3] = {0.2, 0.1, 0.1};
    pdyn_step_info info;
    take_steps(sim, 5);
    good(pdyn_hold(sim, CORNER, 1e4, target));
    take_steps(sim, 200);
    assert_true(vec3_distance(x, target) < 2e-3);
    for (int k = 0; k < 20; k++) {
        target[0] += 0.002;
        good(pdyn_hold(sim, CORNER, 1e4, target));
        good(pdyn_step(sim, &info));
    }
    assert_true(vec3_distance(x, target) < 0.02);
    assert_true(info.pin_reaction[1] > 0.0);
    continues(sim, text);
    good(pdyn_release(sim, CORNER));
    good(pdyn_release(sim, CORNER));
    take_steps(sim, 60);
    assert_true(x[1] < 0.0); /* it falls */
    good(pdyn_hold(sim, CORNER, 100.0, target));
    good(pdyn_release(sim, CORNER));
    good(pdyn_hold(sim, CORNER - 1, 100.0, target));
    continues(sim, text);
    pdyn_free(sim);
}

static void test_holds(void **state) {
    (void)state;
    hold_and_release(sheet);
    hold_and_release(PINNED(SOLVER("cholesky", "projective"), "1000"));
    hold_and_release(PINNED(SOLVER("cg", "newton"), "1000"));
}

/* In a fluid, and beside one. */
static void test_hold_in_water(void **state) {
    (void)state;
    static const char *const scenes[] = {fluid, hybrid};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_load(context, scenes[k]);
        const double target[3] = {0.1, 0.1, 0.1};
        take_steps(sim, 2);
        int particle = pdyn_get_state(sim).particles - 15;
        good(pdyn_hold(sim, particle, 1e5, target));
        take_steps(sim, 20);
        assert_true(vec3_distance(pdyn_get_state(sim).x + 3 * particle, target) < 0.02);
        continues(sim, scenes[k]);
        pdyn_free(sim);
    }
}

static void test_wrong_holds(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, inlet);
    const double target[3] = {0};
    assert_true(!pdyn_get_state(sim).live[399]);
    refused(pdyn_hold(sim, 399, 1.0, target), "particle 399 is not in the scene");
    assert_int_equal(pdyn_hold(sim, 400, 1.0, target), PDYN_BAD_CALL);
    assert_int_equal(pdyn_hold(sim, 0, 1.0, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_release(sim, -1), PDYN_BAD_CALL);
    pdyn_free(sim);
    sim = test_load(context, sheet);
    refused(pdyn_hold(sim, 0, -1.0, target), "expected a stiffness from 0 to 1e+15 N/m, found -1");
    refused(pdyn_hold(sim, 0, 1.0, (double[]){0, NAN, 0}),
            "expected a target from -1e+06 to 1e+06 m, found nan");
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
    assert_int_equal(pdyn_step_by(sim, 0.0, NULL), PDYN_BAD_INPUT);
    assert_int_equal(pdyn_step_by(sim, NAN, NULL), PDYN_BAD_INPUT);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forces),
        cmocka_unit_test(test_gravity),
        cmocka_unit_test(test_positions),
        cmocka_unit_test(test_place_in_contact),
        cmocka_unit_test(test_place_fluid),
        cmocka_unit_test(test_parameter_from_start),
        cmocka_unit_test(test_parameter_in_run),
        cmocka_unit_test(test_wrong_parameters),
        cmocka_unit_test(test_elements_stay),
        cmocka_unit_test(test_enable),
        cmocka_unit_test(test_enable_without_parameters),
        cmocka_unit_test(test_holds),
        cmocka_unit_test(test_hold_in_water),
        cmocka_unit_test(test_wrong_holds),
        cmocka_unit_test(test_move_solid),
        cmocka_unit_test(test_step_by),
        cmocka_unit_test(test_restore_without_changes),
        cmocka_unit_test(test_failing_allocations_of_changes),
    };
    return cmocka_run_group_tests_name("control", tests, set_up, tear_down);
}
