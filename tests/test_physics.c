/* Exact physical results, and the guarantees of a step. */
#include "support.h"

#include "projdyn/vec3.h"

#include <math.h>

#define ELASTIC PAIR(SPRINGS("2000"), BENDING("1e-3"))
#define SHEET(n, constraints)                                                                      \
    GRID_SHEET("'name': 'sheet', ", "1, 1", n ", " n,                                              \
               "'translate': [0.2, 0.55, 0.2], 'area_density': 0.3", constraints)
#define WATER(keys, minimum, maximum)                                                              \
    FLUID_BOX("'name': 'water', " keys, "0.025", minimum, maximum,                                 \
              ", 'stiffness': 1e5, 'viscosity': 0.02")

/* Water hits a free sheet: momentum is conserved to rounding with any solver and number of
 * iterations. */
static void test_momentum(void **state) {
    (void)state;
    static const char *const solvers[] = {
        "{'outer_iterations': 1, 'linear_iterations': 3}",
        "{'outer_iterations': 4, 'linear_tolerance': 0.1}",
        "{'step': 'projective', 'outer_iterations': 3}",
        "{'step': 'projective', 'type': 'cholesky', 'outer_iterations': 3}",
    };
    for (size_t k = 0; k < sizeof solvers / sizeof *solvers; k++) {
        if (test_lacks_solver(solvers[k])) continue;
        char text[2048];
        snprintf(text, sizeof text,
                 SCENE("'duration': 1, 'gravity': [0, 0, 0], 'frame_interval': 0.005, 'time_step': "
                       "{'fixed': 0.005}, 'solver': %s",
                       PAIR(WATER("'velocity': [0.5, -2, 0.25], ", "0, 0.6, 0", "0.4, 0.8, 0.4"),
                            SHEET("31", ELASTIC)),
                       ""),
                 solvers[k]);
        pdyn_sim *sim = test_open(text);
        double mass = 0.0, first[3] = {0};
        const pdyn_state s = pdyn_get_state(sim);
        for (int i = 0; i < s.particles; i++)
            mass += s.mass[i], vec3_add(first, s.mass[i], s.v + 3 * i);
        bool touched = false;
        for (int n = 0; n < 15; n++) {
            pdyn_step_info info = test_step(sim);
            touched |= info.constraint_energy > 1e-6;
            if (vec3_distance(info.momentum, first) > 1e-12 * vec3_length(first))
                fail_msg("solver %zu, step %d: momentum moved by %g of %g", k, n,
                         vec3_distance(info.momentum, first), vec3_length(first));
        }
        assert_true(touched && mass > 30.0);
        test_close(sim);
    }
}

static void add_linear(void *user, const pdyn_iteration *it) {
    *(int *)user += it->linear_iterations;
}

/* Water of this width and depth in a tank of this height, m. */
#define TANK(settings, width, depth, height, fluid)                                                \
    SCENE("'duration': 2, " settings,                                                              \
          FLUID_BOX("'name': 'water', ", "0.01", "0, 0, 0", width ", " depth ", " width,           \
                    ", " fluid),                                                                   \
          ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [" width ", " height ", " width  \
          "]}, 'open': ['+y']}]")

/* A stiff column that starts at rest density everywhere, so that every constraint is about to
 * change sides: each step is solved to its tolerance. */
static void test_stiff_column(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(TANK("'time_step': {'fixed': 0.005}, 'solver': {'tolerance': 0.1, "
                                   "'linear_tolerance': 0.1, 'linear_iterations': 2000}",
                                   "0.08", "0.4", "0.5", "'stiffness': 4e6"));
    int linear = 0;
    pdyn_observe(sim, add_linear, &linear);
    for (int step = 0; step < 20; step++) {
        pdyn_step_info info = test_step(sim);
        assert_int_equal(linear, info.linear_iterations); /* the observer sees every iteration */
        linear = 0;
        assert_true(info.step_residual <= 0.1);
        assert_true(info.density_error_max < 1e-3);
    }
    test_close(sim);
}

/* A tank of forty particles' depth with ten iterations per step from the start: the water comes to
 * rest without splashes, which steps of 5 ms would cause. */
static void test_deep_water(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(TANK("'time_step': {'maximum': 0.005}, 'solver': {'tolerance': 0, "
                       "'linear_tolerance': 0, 'outer_iterations': 1, 'linear_iterations': 10}",
                       "0.08", "0.8", "1", "'stiffness': 7e4"));
    pdyn_step_info info = {0};
    while (info.time < 1.0) {
        info = test_step(sim);
        assert_true(info.kinetic_energy < 0.01 * info.potential_energy);
        assert_true(info.density_error_max < 0.005);
    }
    assert_true(info.kinetic_energy < 1e-3 * info.potential_energy);
    test_close(sim);
}

/* With steps of 5 ms there is one warning; none if every step is solved. */
static void test_long_step(void **state) {
    (void)state;
    static const char *const scene[] = {
        TANK("'time_step': {'fixed': 0.005}, 'solver': {'outer_iterations': 1, "
             "'linear_iterations': 4}",
             "0.08", "0.8", "1", "'stiffness': 7e4"),
        TANK("'time_step': {'fixed': 0.005}, 'solver': {'linear_iterations': 5000}", "0.08", "0.8",
             "1", "'stiffness': 7e4")};
    for (int solved = 0; solved < 2; solved++) {
        struct warnings warnings = {"the fixed step", 0};
        pdyn_context *context = test_warned_context(1, &warnings);
        pdyn_sim *sim = test_load(context, scene[solved]);
        for (int step = 0; step < 20; step++) test_step(sim);
        assert_int_equal(warnings.count, !solved);
        test_close(sim);
    }
}

/* In a tank of eight by eight particles, pressure increases with depth by rho g and up to 9 % more:
 * walls push along their normals, so the particles at walls are carried by the others. */
static void test_narrow_tank(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(TANK("'time_step': {'maximum': 0.005}, 'solver': {'tolerance': 0.01, "
                       "'linear_tolerance': 0, 'outer_iterations': 1, 'linear_iterations': 20}",
                       "0.16", "0.4", "0.6", "'stiffness': 4e4"));
    const pdyn_state s = pdyn_get_state(sim);
    double sum[2] = {0}, count[2] = {0}, middle[2] = {0.1, 0.3};
    while (pdyn_time(sim) < 1.5) {
        pdyn_step_info info = test_step(sim);
        if (info.time < 1.0) continue;
        for (int i = 0; i < s.particles; i++)
            for (int k = 0; k < 2; k++)
                if (fabs(s.x[3 * i + 1] - middle[k]) < 0.04) sum[k] += s.pressure[i], count[k]++;
    }
    double slope = (sum[0] / count[0] - sum[1] / count[1]) / (middle[1] - middle[0]);
    assert_true(slope > 0.99 * 1000.0 * 9.81 && slope < 1.09 * 1000.0 * 9.81);
    test_close(sim);
}

/* Kinetic energy of a block of water 0.25 s after its release, J. */
static double collapsed_energy(const char *solver) {
    char text[1024];
    pdyn_step_info info = {0};
    snprintf(text, sizeof text,
             SCENE("'duration': 0.25, 'frame_interval': 0.25, 'time_step': {'fixed': 0.005}, "
                   "'solver': {%s}",
                   FLUID_BOX("'name': 'water', ", "0.025", "0, 0, 0", "0.5, 0.5, 0.5",
                             ", 'stiffness': 3e5"),
                   ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [1.5, 1, 1]}}]"),
             solver);
    pdyn_sim *sim = test_open(text);
    for (int step = 0; step < 50; step++) info = test_step(sim);
    assert_true(info.density_error_mean < 1e-3);
    test_close(sim);
    return info.kinetic_energy;
}

/* Steps with few iterations move the fluid as solved steps do: only the pressures are inaccurate.
 */
static void test_cut_short(void **state) {
    (void)state;
    double solved = collapsed_energy("'tolerance': 1e-3, 'outer_iterations': 100");
    double cut =
        collapsed_energy("'outer_iterations': 1, 'linear_iterations': 8, 'linear_tolerance': 0");
    if (fabs(cut / solved - 1.0) > 0.01) fail_msg("%g J, solved %g J", cut, solved);
}

/* Highest place of the middle of a block of water, m, after it fell by 0.2 m into a shaft of its
 * own width, where it comes to rest at 0.06 m. */
static double bounce(const char *compression) {
    char text[1024];
    double lowest = 1.0, after = 0.0;
    snprintf(text, sizeof text,
             SCENE("'duration': 0.5, 'frame_interval': 0.05, 'time_step': {'maximum': 0.001}, "
                   "'solver': {'tolerance': 0.01}",
                   FLUID_BOX("'name': 'water', ", "0.01", "0, 0.2, 0", "0.12, 0.32, 0.12",
                             ", 'compression': %s"),
                   ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.12, 1, 0.12]}}]"),
             compression);
    pdyn_sim *sim = test_open(text);
    const pdyn_state state = pdyn_get_state(sim);
    while (pdyn_time(sim) < 0.5) {
        double middle = 0.0;
        test_step(sim);
        for (int i = 0; i < state.particles; i++) middle += state.x[3 * i + 1] / state.particles;
        if (middle < lowest) lowest = middle, after = middle;
        after = fmax(after, middle);
    }
    test_close(sim);
    return after;
}

/* Water that lands stays down, whether a step of 1 ms resolves its sound (compression 1e-3) or not.
 * Without damping it bounces to 0.18 m at 1e-3; if pressures that rise suddenly are not treated as
 * impacts, to 0.15 m at 1e-5. */
static void test_landing(void **state) {
    (void)state;
    assert_true(bounce("1e-3") < 0.11);
    assert_true(bounce("1e-5") < 0.07);
}

/* Pressure over rho g depth, of particles at least 0.1 m (a support radius) away from surface and
 * floor. */
static double relative_pressure(const pdyn_state *s, double surface) {
    double sum = 0.0, expected = 0.0;
    for (int i = 0; i < s->particles; i++) {
        double y = s->x[3 * i + 1];
        if (y < 0.1 || y > surface - 0.1) continue;
        sum += s->pressure[i], expected += 1000.0 * 9.81 * (surface - y);
    }
    return sum / expected;
}

/* Water in a full tank stays at rest: no motion, inside the tank, constant level, pressure of its
 * depth (and up to 9 % more, see test_narrow_tank). */
static void test_hydrostatic_rest(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE("'duration': 2, 'frame_interval': 0.02, 'time_step': {'maximum': "
                        "0.005}, 'solver': {'tolerance': 0.01, 'linear_tolerance': 0.01}",
                        WATER("", "0, 0, 0", "0.4, 0.5, 0.4"),
                        ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.4, "
                        "0.8, 0.4]}, 'open': ['+y']}]"));
    const pdyn_state s = pdyn_get_state(sim);
    pdyn_step_info info;
    double top = 0.0, pressed = 0.0;
    while (pdyn_time(sim) < 0.9) info = test_step(sim);
    for (int frame = 0; frame < 10; frame += info.frame) {
        info = test_step(sim);
        if (info.frame) pressed += 0.1 * relative_pressure(&s, 0.495);
    }
    for (int i = 0; i < s.particles; i++) {
        for (int a = 0; a < 3; a += 2) assert_true(s.x[3 * i + a] > -0.01 && s.x[3 * i + a] < 0.41);
        assert_true(s.x[3 * i + 1] > -0.01);
        top = fmax(top, s.x[3 * i + 1] + 0.025);
    }
    assert_true(fabs(top - 0.5) < 0.05); /* one spacing */
    assert_true(pressed > 0.99 && pressed < 1.09);
    assert_true(info.density_error_mean < 1e-3 && info.density_error_max < 1e-2);
    assert_true(info.kinetic_energy < 1e-3 * info.potential_energy);
    test_close(sim);
}

/* A hanging sheet at rest: the pins carry its weight. Their reaction is the gradient of everything
 * else at the pinned points. */
static void test_pin_reaction(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE("'duration': 60, 'frame_interval': 0.05, 'time_step': {'fixed': "
                        "0.05, 'integrator': 'euler'}, 'solver': {'tolerance': 1e-6, "
                        "'linear_tolerance': 1e-3, 'outer_iterations': 100}",
                        SHEET("9", PAIR(ELASTIC, PINS("'vertices': [0, 8]"))), ""));
    pdyn_step_info info;
    for (int n = 0; n < 400; n++) info = test_step(sim);
    assert_true(info.kinetic_energy < 1e-6);
    assert_true(fabs(info.pin_reaction[1] / (0.3 * 9.81) - 1.0) < 0.005);
    assert_true(fabs(info.pin_reaction[0]) < 0.01 && fabs(info.pin_reaction[2]) < 0.01);
    test_close(sim);
}

/* Pinned points follow their path. */
static void test_pin_path(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        SCENE("'duration': 1, 'gravity': [0, 0, 0], 'frame_interval': 0.01, 'time_step': {'fixed': "
              "0.01}, 'solver': {'tolerance': 1e-6}",
              SHEET("5", PAIR(ELASTIC, "{'type': 'pin', 'vertices': {'all': true}, 'path': [[0, 0, "
                                       "0, 0], [0.1, 1, 0, 0], [0.2, 1, 2, 0]]}")),
              ""));
    const pdyn_state s = pdyn_get_state(sim);
    double start[3] = {s.x[0], s.x[1], s.x[2]};
    for (int n = 1; n <= 30; n++) {
        test_step(sim);
        double t = 0.01 * n,
               expected[3] = {start[0] + fmin(1.0, 10.0 * t),
                              start[1] + 20.0 * fmin(0.1, fmax(0.0, t - 0.1)), start[2]};
        assert_true(vec3_distance(s.x, expected) < 1e-3);
    }
    test_close(sim);
}

/* A coupled scene with many parallel blocks: the same bits for any number of threads. */
static void test_threads(void **state) {
    (void)state;
    static const int threads[] = {1, 2, 3, 8};
    uint64_t hash[4];
    for (int k = 0; k < 4; k++) {
        pdyn_context *context = test_context(threads[k]);
        pdyn_sim *sim =
            test_load(context, SCENE("'duration': 1, 'solver': {'linear_tolerance': 0.1}",
                                     PAIR(WATER("", "0, 0.56, 0", "0.5, 0.9, 0.5"),
                                          SHEET("41", PAIR(ELASTIC, PINS("'border': true")))),
                                     ", 'solids': [{'box': {'minimum': [-1, 0, -1], 'maximum': "
                                     "[1.4, 1, 1.4]}, 'open': ['+y']}]"));
        for (int n = 0; n < 6; n++) test_step(sim);
        hash[k] = pdyn_state_hash(sim);
        test_close(sim);
        assert_true(hash[k] == hash[0]);
    }
}

/* All steps of a fixed length have the same bits, so rounding causes no factorisation. */
static void test_one_length(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE("'duration': 10, 'frame_interval': 0.02, 'time_step': {'fixed': 0.01}",
                        SHEET("3", ELASTIC), ""));
    double h = test_step(sim).h;
    for (int k = 1; k < 200; k++) assert_true(test_step(sim).h == h);
    assert_true(fabs(pdyn_time(sim) - 2.0) < 1e-12);
    test_close(sim);
}

/* 49 steps of 1/49 s are a duration of 1 s, although their sum is less by rounding. */
static void test_finished(void **state) {
    (void)state;
    char text[1024];
    int steps = 0;
    snprintf(text, sizeof text,
             SCENE("'duration': 1, 'frame_interval': %.17g, 'time_step': {'fixed': %.17g}",
                   SHEET("3", ELASTIC), ""),
             1.0 / 49.0, 1.0 / 49.0);
    pdyn_sim *sim = test_open(text);
    for (; !pdyn_is_finished(sim); steps++) test_step(sim);
    assert_int_equal(steps, 49);
    assert_true(pdyn_has_reached(sim, 1.0) && !pdyn_has_reached(sim, 1.001));
    test_close(sim);
}

/* Of two bodies of particles, the smaller particles limit the step, in any order. */
static void test_two_radii(void **state) {
    (void)state;
#define DROPS(radius, x)                                                                           \
    "{'velocity': [0, -8, 0], 'particles': {'radius': " radius ", 'fill': [{'sphere': "            \
    "{'center': [" x ", 0, 0], 'radius': 0.2}}]}}"
    static const char *const scenes[] = {
        SCENE("'duration': 1, 'time_step': {'maximum': 0.1}, 'gravity': [0, 0, 0]",
              DROPS("0.01", "0") ", " DROPS("0.1", "1"), ""),
        SCENE("'duration': 1, 'time_step': {'maximum': 0.1}, 'gravity': [0, 0, 0]",
              DROPS("0.1", "1") ", " DROPS("0.01", "0"), "")};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(scenes[k]);
        double h = test_step(sim).h;
        assert_true(h <= 0.01 / 8 * (1 + 1e-9) && h > 0.8 * 0.01 / 8);
        test_close(sim);
    }
}

/* A diverging step fails, and the state before it stays. */
static void test_divergence(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE("'duration': 1000, 'frame_interval': 100, 'time_step': {'fixed': 100}, "
                        "'solver': {'retries': 0}",
                        WATER("'velocity': [1e6, 0, 0], ", "0, 0, 0", "0.2, 0.2, 0.2"), ""));
    uint64_t before = pdyn_state_hash(sim);
    pdyn_step_info info;
    assert_int_equal(pdyn_step(sim, &info), PDYN_DIVERGED);
    assert_error("diverged");
    assert_true(pdyn_state_hash(sim) == before);
    assert_int_equal(pdyn_step(sim, &info), PDYN_BAD_CALL);
    test_close(sim);
}

static const char *coupled = SCENE(
    "'duration': 1, 'time_step': {'fixed': 0.002}, 'frame_interval': 0.002",
    PAIR(WATER("", "0, 0.56, 0", "0.2, 0.7, 0.2"),
         SHEET("11", PAIR(ELASTIC, PINS("'border': true")))),
    ", 'solids': [{'box': {'minimum': [-1, 0, -1], 'maximum': [1.4, 1, 1.4]}, 'open': ['+y']}]");

/* Bodies, constraints and parameters by index; empty results beyond the last. */
static void test_numbers(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(coupled);
    const pdyn_state s = pdyn_get_state(sim);
    for (int b = 0; b < s.bodies; b++) assert_non_null(pdyn_get_body(sim, b).name);
    for (int k = 0; k < s.constraints; k++) assert_non_null(pdyn_get_constraint(sim, k).type);
    assert_null(pdyn_get_body(sim, -1).name);
    assert_null(pdyn_get_body(sim, s.bodies).name);
    assert_null(pdyn_get_constraint(sim, -1).type);
    assert_null(pdyn_get_constraint(sim, s.constraints).type);
    assert_string_equal(pdyn_get_parameter(sim, 0, 0).name, "stiffness");
    assert_null(pdyn_get_parameter(sim, -1, 0).name);
    assert_null(pdyn_get_parameter(sim, s.constraints, 0).name);
    assert_null(pdyn_get_parameter(sim, 0, -1).name);
    assert_null(pdyn_get_parameter(sim, 0, 99).name);
    test_close(sim);
}

/* A warmed-up step allocates nothing. Lists grow until the water has spread on the sheet. */
static void test_no_allocation(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *context = test_counting_context(2, &counter);
    pdyn_sim *sim = test_load(context, coupled);
    for (int n = 0; n < 400; n++) test_step(sim);
    long before = counter.calls;
    for (int n = 0; n < 20; n++) test_step(sim);
    assert_int_equal(counter.calls, before);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_momentum),      cmocka_unit_test(test_hydrostatic_rest),
        cmocka_unit_test(test_stiff_column),  cmocka_unit_test(test_cut_short),
        cmocka_unit_test(test_landing),       cmocka_unit_test(test_deep_water),
        cmocka_unit_test(test_narrow_tank),   cmocka_unit_test(test_long_step),
        cmocka_unit_test(test_pin_reaction),  cmocka_unit_test(test_pin_path),
        cmocka_unit_test(test_threads),       cmocka_unit_test(test_one_length),
        cmocka_unit_test(test_two_radii),     cmocka_unit_test(test_finished),
        cmocka_unit_test(test_divergence),    cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_no_allocation),
    };
    return cmocka_run_group_tests_name("physics", tests, NULL, NULL);
}
