/* Inlets that move, open and shut: places and velocities of their layers against independent
 * formulas; changes by a program, saved states, failed allocations. */
#include "control_support.h"
#include "sim/live_particles.h"

#define STEP 0.004 /* s */
/* Particles without forces, of spacing 0.02 m, 3 x 3 in a layer; the stream is along x. inlet:
 * further keys. */
#define STREAM(inlet, more)                                                                        \
    "{'duration': 1, 'frame_interval': 0.004, 'time_step': {'fixed': 0.004}, 'gravity': [0, 0, "   \
    "0], 'bodies': [{'name': 'water', 'particles': {'radius': 0.01, 'inlets': [{'rectangle': "     \
    "{'center': [0.5, 0, 0], 'size': [0.06, 0.06]}, 'direction': [1, 0, 0]" inlet "}]" more "}}]}"
enum { LAYER = 9 };
static const double spacing = 0.02;

/* ---- speed over time ------------------------------------------------------------------------- */

#define TAP                                                                                        \
    ", 'speed': [{'time': 0.1, 'speed': 0}, {'time': 0.2, 'speed': 4}, {'time': 0.3, 'speed': 1}]"

/* Its speed, m/s, and the integral of the speed, m. */
static double tap_speed(double t) {
    return t < 0.1 ? 0.0 : t < 0.2 ? 40.0 * (t - 0.1) : t < 0.3 ? 4.0 - 30.0 * (t - 0.2) : 1.0;
}
static double tap_way(double t) {
    if (t < 0.1) return 0.0;
    if (t < 0.2) return 20.0 * (t - 0.1) * (t - 0.1);
    if (t < 0.3) return 0.2 + 4.0 * (t - 0.2) - 15.0 * (t - 0.2) * (t - 0.2);
    return 0.45 + t - 0.3;
}

/* Held layers are a whole number of spacings behind the first one and have the speed of the time.
 * Later ones go on with the speed at which they were let go. */
static void test_tap(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, STREAM(TAP, ""));
    assert_int_equal(sim->live->emitted, 2 * LAYER); /* the layers of a shut opening */
    for (int n = 0; n < 100; n++) {
        double time = test_step(sim).time, way = tap_way(time);
        int pushed = 0;
        for (int i = 0; i < sim->objective.particles; i++) {
            const double *x = sim->x + 3 * i, *v = sim->v + 3 * i;
            if (!particle_is_pushed(sim, i)) continue;
            double layer = (way - (x[0] - 0.5)) / spacing;
            assert_true(fabs(2.0 * layer - round(2.0 * layer)) < 1e-9); /* staggered */
            assert_true(x[0] - 0.5 > -1.001 * spacing && x[0] - 0.5 < 1.001 * spacing);
            assert_true(fabs(v[0] - tap_speed(time)) < 1e-9 && v[1] == 0.0 && v[2] == 0.0);
            pushed++;
        }
        assert_true(pushed == LAYER || pushed == 2 * LAYER);
        assert_int_equal(sim->live->emitted, LAYER * (floor(way / spacing + 1e-9) + 2.0));
    }
    assert_int_equal(pdyn_get_body(sim, 0).count, LAYER * floor((0.45 + 0.7) / spacing + 2.0001));
    pdyn_free(sim);
}

/* Layers that are behind the opening when the duration ends do not enter. */
static void test_duration(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, STREAM(TAP ", 'start': 0.05, 'duration': 0.15", ""));
    while (pdyn_time(sim) < 0.6) test_step(sim);
    assert_int_equal(sim->live->emitted, LAYER * 10); /* 0.2 m */
    refused(pdyn_set_inlet_speed(sim, 0, 0, 0.0, 1.0),
            "inlet 0 of body \"water\": its \"duration\" has ended at 0.2 s");
    pdyn_free(sim);
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* A quarter turn about z through the pivot [0.2, 0, 0] in half a second, while it rises. */
#define HOSE                                                                                       \
    ", 'speed': 2, 'pivot': [0.2, 0, 0], 'motion': [{'time': 0}, {'time': 0.5, 'rotate': [0, 0, "  \
    "90], 'translate': [0, 0, 0.3]}]"

/* Where a point of the layers is that was at `rest` + 2 t in the inlet at rest, and how fast. */
static void turned(const double rest[3], double t, double x[3], double v[3]) {
    double rate = acos(-1.0), c = cos(rate * t), s = sin(rate * t), out = rest[0] - 0.2 + 2.0 * t;
    x[0] = 0.2 + c * out - s * rest[1], x[1] = s * out + c * rest[1], x[2] = rest[2] + 0.6 * t;
    v[0] = 2.0 * c - rate * x[1], v[1] = 2.0 * s + rate * (x[0] - 0.2), v[2] = 0.6;
}

static void test_hose(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, STREAM(HOSE, ""));
    for (int n = 0; n < 100; n++) {
        double time = test_step(sim).time, c = cos(acos(-1.0) * time);
        double s = sin(acos(-1.0) * time);
        for (int i = 0; i < sim->objective.particles; i++) {
            const double *at = sim->x + 3 * i, arm[2] = {at[0] - 0.2, at[1]};
            double rest[3] = {0.2 + c * arm[0] + s * arm[1] - 2.0 * time, c * arm[1] - s * arm[0],
                              at[2] - 0.6 * time};
            double x[3], v[3], layer = (0.5 - rest[0]) / spacing;
            if (!particle_is_pushed(sim, i)) continue;
            assert_true(fabs(2.0 * layer - round(2.0 * layer)) < 1e-9);
            assert_true(fabs(rest[1]) < 0.0201 && fabs(rest[2]) < 0.0201);
            turned(rest, time, x, v);
            assert_true(test_distance(v, sim->v + 3 * i, 3) < 1e-9);
            if (sim->v_before && time > 2.0 * STEP) {
                turned(rest, time - STEP, x, v);
                assert_true(test_distance(v, sim->v_before + 3 * i, 3) < 1e-9);
            }
        }
    }
    assert_int_equal(sim->live->emitted, LAYER * 42);
    pdyn_free(sim);
}

/* ---- changes by a program -------------------------------------------------------------------- */

static const char *const still =
    STREAM(", 'speed': [{'time': 0, 'speed': 0}], 'motion': [{'time': 0}], 'pivot': [0.2, 0, 0]",
           ", 'budget': 900");

static void test_open_and_shut(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, still);
    assert_int_equal(pdyn_inlets(sim, 0), 1);
    assert_int_equal(pdyn_inlets(sim, 1), 0);
    take_steps(sim, 25);
    assert_int_equal(sim->live->emitted, 2 * LAYER);
    good(pdyn_set_inlet_speed(sim, 0, 0, 0.0, 3.0)); /* at once */
    take_steps(sim, 5);
    continues(sim, still);
    take_steps(sim, 15); /* 0.3 m */
    assert_int_equal(sim->live->emitted, LAYER * 17);
    good(pdyn_set_inlet_speed(sim, 0, 0, 0.3, 0.0)); /* within 0.1 s: 0.15 m */
    take_steps(sim, 12);
    continues(sim, still);
    take_steps(sim, 8);
    assert_int_equal(sim->live->emitted, LAYER * 24);
    pdyn_free(sim);
}

/* The same motion as that of the scene. */
static void test_move(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, STREAM(HOSE, ", 'budget': 900"));
    pdyn_sim *steered = test_load(context, still);
    good(pdyn_set_inlet_speed(steered, 0, 0, 0.0, 2.0));
    good(pdyn_move_inlet(steered, 0, 0, 0.5, (double[]){0, 0, 0.3}, (double[]){0, 0, 90}));
    take_steps(sim, 25), take_steps(steered, 20);
    continues(steered, still);
    take_steps(sim, 20), take_steps(steered, 20);
    assert_int_equal(sim->live->emitted, LAYER * 20);
    assert_true(test_distance(sim->x, steered->x, 3 * LAYER * 20) < 1e-9);
    assert_true(test_distance(sim->v, steered->v, 3 * LAYER * 20) < 1e-9);
    pdyn_free(sim), pdyn_free(steered);
}

static void test_refused(void **state) {
    (void)state;
    const double none[3] = {0};
    pdyn_sim *sim = test_load(context, STREAM(TAP, ""));
    refused(pdyn_move_inlet(sim, 0, 0, 9.0, none, none),
            "inlet 0 of body \"water\": expected \"motion\" in the scene, with at least one key");
    refused(pdyn_set_inlet_speed(sim, 0, 0, 0.0, -1.0),
            "inlet 0 of body \"water\": expected a speed from 0 to 1e+06 m/s, found -1");
    refused(pdyn_set_inlet_speed(sim, 0, 0, NAN, 1.0),
            "inlet 0 of body \"water\": expected a time from -1e6 to 1e6 s, found nan");
    assert_int_equal(pdyn_set_inlet_speed(sim, 0, 1, 0.0, 1.0), PDYN_BAD_CALL);
    assert_int_equal(pdyn_set_inlet_speed(sim, 1, 0, 0.0, 1.0), PDYN_BAD_CALL);
    assert_int_equal(pdyn_set_inlet_speed(sim, 0, -1, 0.0, 1.0), PDYN_BAD_CALL);
    assert_int_equal(pdyn_move_inlet(sim, 0, 0, 9.0, NULL, none), PDYN_BAD_CALL);
    pdyn_free(sim);
}

static void test_failing_allocator(void **state) {
    (void)state;
    test_failing_scene(STREAM(HOSE, ""));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tap),
        cmocka_unit_test(test_duration),
        cmocka_unit_test(test_hose),
        cmocka_unit_test(test_open_and_shut),
        cmocka_unit_test(test_move),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_failing_allocator),
    };
    return cmocka_run_group_tests_name("inlet motion", tests, control_set_up, control_tear_down);
}
