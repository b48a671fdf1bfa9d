/* Several liquids in one scene: one liquid in two bodies, layers at rest, momentum, inlets, saved
 * states, bits for any number of threads. */
#include "support.h"

#include "sim/live_particles.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

/* A box of a liquid of a density, with keys of its constraint, each with a comma before it. */
#define LIQUID(name, radius, density, minimum, maximum, fluid)                                     \
    "{'name': '" name "', 'particles': {'radius': " radius ", 'rest_density': " density            \
    ", 'fill': [{'box': {'minimum': [" minimum "], 'maximum': [" maximum "]}}]}, 'constraints': "  \
    "[{'type': 'fluid'" fluid "}]}"
#define TANK(maximum)                                                                              \
    ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [" maximum "]}}]"

/* ---- one liquid in two bodies ---------------------------------------------------------------- */

/* With euler: bdf2 estimates the impact part of a force by the forces of its own body. */
#define SOFT ", 'stiffness': 2000, 'viscosity': 0, 'damping': 0"
#define SOLVED(bodies, solver)                                                                     \
    SCENE("'duration': 1, 'time_step': {'fixed': 0.004, 'integrator': 'euler'}, "                  \
          "'frame_interval': 0.01, 'solver': {'type': '" solver "', 'tolerance': 1e-8, "           \
          "'linear_tolerance': 1e-10, 'outer_iterations': 60, 'linear_iterations': 1000}",         \
          bodies, TANK("0.2, 1, 0.2"))
#define WHOLE LIQUID("water", "0.02", "1000", "0, 0, 0", "0.16, 0.12, 0.16", SOFT)
#define HALVES                                                                                     \
    PAIR(LIQUID("left", "0.02", "1000", "0, 0, 0", "0.08, 0.12, 0.16", SOFT),                      \
         LIQUID("right", "0.02", "1000", "0.08, 0, 0", "0.16, 0.12, 0.16", SOFT))

/* The particle of `other` that was at the start where particle i of `sim` was. */
static int same_start(const pdyn_sim *sim, int i, const pdyn_sim *other) {
    for (int j = 0; j < other->objective.particles; j++)
        if (vec3_distance(sim->rest + 3 * i, other->rest + 3 * j) < 1e-9) return j;
    fail_msg("no particle starts at the place of particle %d", i);
    return -1;
}

static void compare(const char *whole, const char *halves) {
    pdyn_context *context = test_context(1);
    pdyn_sim *one = test_load(context, whole), *two = test_load(context, halves);
    assert_true(one->objective.particles == two->objective.particles);
    for (int step = 0; step < 10; step++) test_step(one), test_step(two);
    for (int i = 0; i < one->objective.particles; i++) {
        int j = same_start(one, i, two);
        assert_true(vec3_distance(one->x + 3 * i, two->x + 3 * j) < 1e-9);
        assert_true(fabs(one->density[i] - two->density[j]) < 1e-5);
        assert_true(fabs(one->pressure[i] - two->pressure[j]) < 1e-3);
    }
    pdyn_free(one), pdyn_free(two);
    pdyn_destroy(context);
}

static void test_halves(void **state) {
    (void)state;
    compare(SOLVED(WHOLE, "cg"), SOLVED(HALVES, "cg"));
    compare(SOLVED(WHOLE, "dual"), SOLVED(HALVES, "dual"));
    compare(SOLVED(WHOLE, "cg"), SOLVED(HALVES, "dual"));
}

/* ---- layers at rest -------------------------------------------------------------------------- */

#define CALM ", 'compression': 1e-3, 'viscosity': 0.2"
static const char layers[] =
    SCENE("'duration': 1, 'time_step': {'maximum': 0.005}",
          PAIR(LIQUID("water", "0.01", "1000", "0, 0, 0", "0.2, 0.2, 0.2", CALM),
               LIQUID("oil", "0.01", "500", "0, 0.2, 0", "0.2, 0.4, 0.2", CALM)),
          TANK("0.2, 1, 0.2") ", 'probes': [{'name': 'all', 'box': {'minimum': [-1, -1, -1], "
                              "'maximum': [1, 2, 1]}}, {'name': 'level', 'height': [0.1, 0, "
                              "0.1]}]");

/* Mean pressure of particles of a body between two heights, Pa. */
static double mean_pressure(const pdyn_sim *sim, double low, double high) {
    double sum = 0.0, count = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) {
        const double *x = sim->x + 3 * i;
        if (x[1] < low || x[1] > high) continue;
        sum += sim->pressure[i], count++;
    }
    return sum / count;
}

static void test_layers(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(layers);
    double in_oil = 0.0, in_water = 0.0, states = 0.0;
    assert_string_equal(pdyn_solver_type(sim), "dual");
    while (pdyn_time(sim) < 0.3) {
        test_step(sim);
        if (pdyn_time(sim) < 0.15) continue;
        in_oil += mean_pressure(sim, 0.26, 0.34), in_water += mean_pressure(sim, 0.06, 0.14);
        states++;
    }
    assert_true(fabs(in_oil / states / (9.81 * 500 * 0.1) - 1.0) < 0.06);
    assert_true(fabs(in_water / states / (9.81 * (500 * 0.2 + 1000 * 0.1)) - 1.0) < 0.06);
    int beyond = 0;
    for (int i = 0; i < sim->objective.particles; i++) {
        bool water = i < sim->body[1].first;
        beyond += water ? sim->x[3 * i + 1] > 0.22 : sim->x[3 * i + 1] < 0.18;
        assert_true(sim->density[i] < 1.01 * (water ? 1000 : 500));
    }
    assert_true(beyond < 0.01 * sim->objective.particles);
    assert_true(fabs(pdyn_get_probe(sim, 0).value[0] - 0.2 * 0.2 * 0.4) < 1e-9);
    assert_true(fabs(pdyn_get_probe(sim, 1).value[0] - 0.4) < 0.01);
    test_close(sim);
}

/* ---- momentum -------------------------------------------------------------------------------- */

static const char drops[] =
    SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.002}",
          "{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': [0, 0, 0], "
          "'maximum': [0.1, 0.1, 0.1]}, 'velocity': [2, 0.3, 0]}]}, 'constraints': [{'type': "
          "'fluid', 'sound_speed': 40}]}, " LIQUID("foam", "0.01", "100", "0.11, 0.05, 0",
                                                   "0.21, 0.15, 0.1", ", 'sound_speed': 40"),
          "");

static void add_momentum(const pdyn_sim *sim, double sign, double sum[3]) {
    for (int i = 0; i < sim->objective.particles; i++)
        vec3_add(sum, sign * sim->objective.mass[i], sim->v + 3 * i);
}

static void test_momentum(void **state) {
    (void)state;
    static const char *const solver[] = {"solver.type=dual", "solver.type=cg"};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open_with(drops, &solver[k], 1);
        double change[3] = {0};
        add_momentum(sim, -1.0, change);
        for (int step = 0; step < 60; step++) test_step(sim);
        add_momentum(sim, 1.0, change);
        assert_true(vec3_length(change) < 1e-12 * 2.0);
        double moved = 0.0; /* the foam is pushed */
        for (int i = sim->body[1].first; i < sim->objective.particles; i++)
            moved = fmax(moved, sim->v[3 * i]);
        assert_true(moved > 0.5);
        test_close(sim);
    }
}

/* ---- inlets ---------------------------------------------------------------------------------- */

/* An inlet of oil inside water emits nothing where there is no room; one above it fills its budget.
 */
static const char filling[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.005}",
          PAIR(LIQUID("water", "0.01", "1000", "0, 0, 0", "0.2, 0.1, 0.2", ""),
               "{'name': 'oil', 'particles': {'radius': 0.01, 'rest_density': 800, 'budget': 64, "
               "'inlets': [{'rectangle': {'center': [0.1, 0.05, 0.1], 'size': [0.08, 0.08]}, "
               "'direction': [0, 1, 0], 'speed': 0.01}, {'rectangle': {'center': [0.1, 0.3, 0.1], "
               "'size': [0.08, 0.08]}, 'direction': [0, -1, 0], 'speed': 1}]}, 'constraints': "
               "[{'type': 'fluid'}]}"),
          TANK("0.2, 0.4, 0.2"));

static void test_inlets(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(filling);
    assert_int_equal(live_particles_count(sim, 0), 10 * 5 * 10);
    assert_int_equal(live_particles_count(sim, 1), 32); /* two layers of the upper inlet */
    while (pdyn_time(sim) < 0.2) test_step(sim);
    assert_int_equal(live_particles_count(sim, 1), 64);
    for (int i = sim->body[1].first; i < sim->objective.particles; i++)
        assert_true(fabs(sim->objective.mass[i] - 800 * 8e-6) < 1e-12);
    test_close(sim);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static void test_memory(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *context = test_counting_context(2, &counter);
    pdyn_sim *sim = test_load(context, drops);
    for (int step = 0; step < 60; step++) test_step(sim);
    long before = counter.calls;
    for (int step = 0; step < 10; step++) test_step(sim);
    assert_int_equal(counter.calls, before);
    test_close(sim);
    test_failing_scene(SOLVED(HALVES, "dual"));
}

/* ---- bits ------------------------------------------------------------------------------------ */

/* Two liquids, a sheet between them, a moving solid. */
static const char coupled[] = SCENE(
    "'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}",
    PAIR(PAIR(LIQUID("water", "0.02", "1000", "0, 0, 0", "0.2, 0.12, 0.4", ""),
              GRID_SHEET("'name': 'sheet', ", "0.3, 0.3", "9, 9",
                         "'translate': [0.2, 0.2, 0.2], 'area_density': 0.5", SPRINGS("1000"))),
         LIQUID("oil", "0.02", "800", "0.2, 0, 0", "0.4, 0.12, 0.4", ", 'stiffness': 2e5")),
    ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.4, 0.6, 0.4]}}, "
    "{'name': 'stirrer', 'sphere': {'center': [0.3, 0.1, 0.1], 'radius': 0.05}, 'motion': "
    "[{'time': 0}, {'time': 1, 'translate': [0, 0.2, 0.2]}]}]");

/* Runs 20 steps, of which `before` are followed by saving and restoring. */
static uint64_t run(const char *text, const char *set, int threads, int before) {
    pdyn_context *context = test_context(threads);
    pdyn_sim *sim = test_load_with(context, text, &set, 1);
    for (int step = 0; step < 20; step++) {
        if (step == before) {
            assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
            pdyn_free(sim);
            sim = test_load_with(context, text, &set, 1);
            assert_int_equal(pdyn_restore(sim, "state"), PDYN_OK);
            test_remove_file("state");
        }
        test_step(sim);
    }
    uint64_t hash = pdyn_state_hash(sim);
    test_close(sim);
    return hash;
}

static void test_threads(void **state) {
    (void)state;
    static const char *const text[] = {coupled, coupled, filling};
    static const char *const set[] = {"solver.type=auto", "solver.type=dual", "solver.type=auto"};
    for (int k = 0; k < 3; k++) {
        uint64_t hash = run(text[k], set[k], 1, -1);
        assert_true(hash == run(text[k], set[k], 3, -1));
        assert_true(hash == run(text[k], set[k], 2, 10));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_halves),   cmocka_unit_test(test_layers),
        cmocka_unit_test(test_momentum), cmocka_unit_test(test_inlets),
        cmocka_unit_test(test_threads),  cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests_name("liquids", tests, test_enter_directory,
                                       test_leave_directory);
}
