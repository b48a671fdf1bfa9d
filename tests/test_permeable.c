/* Surfaces that a fluid passes: Darcy's law along and across a sheet, momentum, an undisturbed
 * fluid, contact, warnings. */
#include "support.h"

/* A block of water, 10 layers deep, that moves across a sheet in its middle. */
#define BLOCK(settings, velocity, surface, constraints)                                            \
    SCENE("'duration': 1, 'frame_interval': 0.005, 'gravity': [0, 0, 0], 'time_step': "            \
          "{'fixed': 0.005}, 'solver': {'tolerance': 1e-6, 'linear_tolerance': 1e-4}" settings,    \
          PAIR("{'name': 'water', 'velocity': " velocity ", 'particles': {'radius': 0.01, "        \
               "'fill': [{'box': {'minimum': [-0.12, -0.1, -0.12], 'maximum': [0.12, 0.1, "        \
               "0.12]}}]}, 'constraints': [{'type': 'fluid', 'viscosity': 0}]}",                   \
               GRID_SHEET("'name': 'net', ", "0.12, 0.12", "6, 6", surface, constraints)),         \
          "")

#define HELD_NET(velocity)                                                                         \
    BLOCK("", velocity, "'area_density': 0.2, 'permeability': 0.2", PINS("'all': true"))
#define FREE_NET(velocity)                                                                         \
    BLOCK("", velocity, "'area_density': 0.2, 'permeability': 0.5", SPRINGS("100"))

struct run {
    double net, water[3]; /* m/s: velocity of the net downwards; of the water */
    double pins;          /* N, on the net, downwards */
    double momentum;      /* change over that of the start */
    uint64_t hash;
};

/* Of the mass of a body. */
static double mean_velocity(const pdyn_sim *sim, const pdyn_body *body, int axis) {
    double sum = 0.0, mass = 0.0;
    for (int i = body->first; i < body->first + body->count; i++) {
        sum += sim->objective.mass[i] * sim->v[3 * i + axis];
        mass += sim->objective.mass[i];
    }
    return sum / mass;
}

static struct run run(const char *text, int threads, int steps) {
    pdyn_context *context = test_context(threads);
    pdyn_sim *sim = test_load(context, text);
    struct run run = {0};
    double start = 0.0, end = 0.0;
    for (int k = 0; k < sim->objective.particles; k++)
        start += sim->objective.mass[k] * sim->v[3 * k + 1];
    for (int step = 0; step < steps; step++) {
        pdyn_step_info info = test_step(sim);
        assert_int_equal(info.leaked, 0);
        run.pins = info.pin_reaction[1];
    }
    for (int k = 0; k < sim->objective.particles; k++)
        end += sim->objective.mass[k] * sim->v[3 * k + 1];
    run.net = -mean_velocity(sim, &sim->body[1], 1);
    for (int a = 0; a < 3; a++) run.water[a] = mean_velocity(sim, &sim->body[0], a);
    run.momentum = start == 0.0 ? 0.0 : fabs(end / start - 1.0), run.hash = pdyn_state_hash(sim);
    test_close(sim);
    return run;
}

/* A net held in a stream of velocity v across it feels A v / k, nothing from a stream along it. */
static void test_held(void **state) {
    (void)state;
    struct run across = run(HELD_NET("[0, -0.1, 0]"), 1, 8);
    struct run along = run(HELD_NET("[0.1, 0, 0]"), 1, 8);
    double exact = 0.12 * 0.12 * 0.1 / 0.2;
    assert_true(fabs(across.pins / exact - 1.0) < 0.01);
    assert_true(fabs(along.pins) < 1e-3 * exact);
    assert_true(fabs(along.water[0] - 0.1) < 1e-6);
}

/* A free net of mass s per area moves with v (1 - exp(-t / (k s))), where the water beside it
 * slows down by 1 %. Momentum is exact. */
static void test_carried(void **state) {
    (void)state;
    struct run net = run(FREE_NET("[0, -0.1, 0]"), 1, 20);
    assert_true(fabs(net.net / (0.1 * (1.0 - exp(-1.0))) - 1.0) < 0.02);
    assert_true(net.momentum < 1e-9);
}

static void test_threads(void **state) {
    (void)state;
    struct run one = run(FREE_NET("[0.05, -0.1, 0]"), 1, 10);
    struct run three = run(FREE_NET("[0.05, -0.1, 0]"), 3, 10);
    assert_true(one.hash == three.hash);
    test_failing_scene(FREE_NET("[0, -0.1, 0]"));
}

/* A net without resistance changes nothing: the water stays a lattice, also with contact. */
static void test_no_resistance(void **state) {
    (void)state;
    struct run net = run(BLOCK(", 'contact': {'thickness': 0.002}", "[0, -0.4, 0]",
                               "'area_density': 0.2, 'permeability': 1e6", PINS("'all': true")),
                         1, 40);
    assert_true(fabs(net.water[1] + 0.4) < 1e-6);
    assert_true(fabs(net.water[0]) < 1e-6);
}

/* Under its weight s g a net sinks with k s g in water at rest. Friction on both sides of 1 / (2 k)
 * keeps it from sliding edge-on. */
static void test_sinks_long(void **state) {
    (void)state;
    struct run net = run(
        SCENE(
            "'duration': 1, 'time_step': {'maximum': 0.005}, 'contact': {'thickness': 0.0002}",
            PAIR(FLUID_BOX("'name': 'water', ", "0.01", "-0.12, 0, -0.12", "0.12, 0.16, 0.12", ""),
                 GRID_SHEET("'name': 'net', ", "0.12, 0.12", "7, 7",
                            "'area_density': 0.3, 'permeability': 0.03, 'fluid_friction': 17, "
                            "'translate': [0, 0.18, 0]",
                            SPRINGS("500"))),
            ", 'solids': [{'box': {'minimum': [-0.12, 0, -0.12], 'maximum': [0.12, 1, 0.12]}}]"),
        1, 100);
    assert_true(fabs(net.net / (0.03 * 0.3 * 9.81) - 1.0) < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_held),       cmocka_unit_test(test_carried),
        cmocka_unit_test(test_threads),    cmocka_unit_test(test_no_resistance),
        cmocka_unit_test(test_sinks_long),
    };
    return cmocka_run_group_tests_name("permeable", tests, NULL, NULL);
}
