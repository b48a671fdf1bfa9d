/* Fluid stiffness from compression or speed of sound: the formula, the head that it uses, and the
 * compression of a settled tank. */
#include "scene_support.h"

#include "projdyn/kernel.h"
#include "projdyn/vec3.h"
#include "scene/choices.h"

#include <string.h>

/* A scene: particles, their fluid constraint, the rest. */
#define FLUID(particles, constraint, rest)                                                         \
    "{'duration': 2, 'time_step': {'maximum': 0.005}, 'solver': {'tolerance': 0.01, "              \
    "'linear_tolerance': 0, 'outer_iterations': 1, 'linear_iterations': 20}, 'bodies': [{"         \
    "'particles': {" particles "}, 'constraints': [{'type': 'fluid', " constraint "}]}" rest "}"
#define BOX_OF(radius, width, depth)                                                               \
    "'radius': " radius ", 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [" width ", " depth  \
    ", " width "]}}]"
#define BLOCK BOX_OF("0.01", "0.16", "0.4")
#define DROP(velocity)                                                                             \
    "'radius': 0.01, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.16, 0.1, 0.16]}}, {"    \
    "'box': {'minimum': [0, 0.8, 0], 'maximum': [0.1, 0.9, 0.1]}, 'velocity': " velocity "}]"
#define JET                                                                                        \
    "'radius': 0.01, 'inlets': [{'rectangle': {'center': [0.05, 0.5, 0.08], 'size': [0.1, 0.1]}, " \
    "'direction': [1, 0, 0], 'speed': 3}]"
#define SHEET_BELOW                                                                                \
    ", {'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, 'translate': [0, -0.3, 0], "     \
    "'area_density': 1}}]"
#define SECOND(low, high, density)                                                                 \
    ", {'particles': {'rest_density': " density                                                    \
    ", 'radius': 0.01, 'fill': [{'box': {'minimum': [0, " low ", 0], 'maximum': [0.16, " high      \
    ", 0.16]}}]}, 'constraints': [{'type': 'fluid'}]}]"
#define TANK(floor)                                                                                \
    "], 'solids': [{'box': {'minimum': [0, " floor                                                 \
    ", 0], 'maximum': [0.16, 9, 0.16]}, 'open': ['+y']}]"

static double parameter(const pdyn_sim *sim, const char *name) {
    pdyn_parameter_info p;
    for (int k = 0; (p = pdyn_get_parameter(sim, 0, k)).name; k++)
        if (!strcmp(p.name, name)) return p.value;
    return 0.0;
}

/* |grad C|^2 d^2 of a particle in a cubic lattice of spacing d = 1 m, by summing the kernel. */
static double lattice_squares(void) {
    struct kernel kernel = kernel_make(choices_entry(&kernel_choices, 0), 2.0);
    double sum = 0.0;
    for (int k = 0; k < 125; k++) {
        double x[3] = {k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2}, r = vec3_length(x);
        double slope = kernel_slope(&kernel, r) * r;
        sum += slope * slope;
    }
    return sum;
}

/* ---- the formula ----------------------------------------------------------------------------- */

#define C "'compression': 0.002"

static const struct {
    const char *text;
    double spacing, density, gravity, head; /* SI */
    double compression, sound_speed;        /* as given in the scene; 0: not given */
} scenes[] = {
    {FLUID(BLOCK, C, "]"), 0.02, 1000, 9.81, 0.4, 0.002, 0},
    {FLUID(BOX_OF("0.02", "0.16", "0.4"), C, "]"), 0.04, 1000, 9.81, 0.4, 0.002, 0},
    {FLUID(BOX_OF("0.01", "0.16", "0.8"), C, "]"), 0.02, 1000, 9.81, 0.8, 0.002, 0},
    {FLUID(BLOCK, "'compression': 0.01", "]"), 0.02, 1000, 9.81, 0.4, 0.01, 0},
    {FLUID(BLOCK ", 'rest_density': 700", C, "]"), 0.02, 700, 9.81, 0.4, 0.002, 0},
    {FLUID(BLOCK, C, "], 'gravity': [-1.6, 0, 0]"), 0.02, 1000, 1.6, 0.16, 0.002, 0},
    {FLUID(BLOCK, "'sound_speed': 50", "]"), 0.02, 1000, 9.81, 0.4, 0, 50},
    {FLUID(BLOCK, "'sound_speed': 50", "], 'gravity': [0, 0, 0]"), 0.02, 1000, 0, 0, 0, 50},
    {FLUID(BLOCK, "'stiffness': 1e5", "]"), 0.02, 1000, 9.81, 0.4, 0, 0},
    /* water that falls to a floor; to a sheet */
    {FLUID(BLOCK, C, TANK("-0.5")), 0.02, 1000, 9.81, 0.9, 0.002, 0},
    {FLUID(BLOCK, C, SHEET_BELOW), 0.02, 1000, 9.81, 0.7, 0.002, 0},
    /* under a lighter and under a heavier fluid, beside a lighter one */
    {FLUID(BLOCK, C, SECOND("0.4", "0.6", "800")), 0.02, 1000, 9.81, 0.4 + 0.16, 0.002, 0},
    {FLUID(BLOCK, C, SECOND("0.4", "0.6", "2000")), 0.02, 1000, 9.81, 1.2, 0.002, 0},
    {FLUID(BLOCK, C, SECOND("0", "0.2", "800")), 0.02, 1000, 9.81, 0.4, 0.002, 0},
    /* a drop above a tank, at rest and with 4 m/s; a jet of 3 m/s in a box */
    {FLUID(DROP("[0, 0, 0]"), C, TANK("0")), 0.02, 1000, 9.81, 0.9, 0.002, 0},
    {FLUID(DROP("[0, 4, 0]"), C, TANK("0")), 0.02, 1000, 9.81, 0.9 + 16 / 19.62, 0.002, 0},
    {FLUID(JET, C, TANK("0")), 0.02, 1000, 9.81, 0.55 + 9 / 19.62, 0.002, 0},
};

static void assert_near(int scene, const char *what, double found, double expected) {
    if (!(fabs(found - expected) <= 1e-4 * fabs(expected)))
        fail_msg("scene %d: %s %.9g, expected %.9g", scene, what, found, expected);
}

static void test_formula(void **state) {
    (void)state;
    double c = lattice_squares();
    for (int k = 0; k < COUNT(scenes); k++) {
        pdyn_sim *sim = test_open(scenes[k].text);
        double rho = scenes[k].density, pressure = rho * scenes[k].gravity * scenes[k].head;
        double w = 1e5, speed = scenes[k].sound_speed, length = c * scenes[k].spacing;
        if (scenes[k].compression > 0.0) w = length * pressure / scenes[k].compression;
        if (speed > 0.0) w = length * rho * speed * speed;
        assert_near(k, "stiffness", parameter(sim, "stiffness"), w);
        assert_near(k, "compression", parameter(sim, "compression"), length * pressure / w);
        assert_near(k, "speed of sound", parameter(sim, "sound_speed"), sqrt(w / length / rho));
        test_close(sim);
    }
}

/* A scene that gives none of the three: 0.001 of compression, less under a body that is heavy or
 * comes from above, and before a solid that moves; without gravity a stiffness, N/m; the largest
 * stiffness where the pressure is beyond all bounds. */
static void test_default(void **state) {
    (void)state;
#define DEFAULT(rest) FLUID(BLOCK, "'viscosity': 0.1", rest)
    static const struct {
        const char *text, *name;
        double value;
    } cases[] = {
        {DEFAULT("]"), "compression", 1e-3},
        {DEFAULT(", {'rigid': {'density': 2500, 'box': {'minimum': [0.02, 0.5, 0.02], 'maximum': "
                 "[0.1, 0.6, 0.1]}}, 'velocity': [0, 1.980909, 0]}]"),
         "compression", 1e-3 * 0.4 / (2.5 * 0.8)},
        {DEFAULT("], 'solids': [{'box': {'minimum': [1, 0, 0], 'maximum': [2, 1, 1]}, 'motion': "
                 "[{'time': 0}, {'time': 1, 'translate': [5, 0, 0]}]}]"),
         "compression", 1e-3 * 9.81 * 0.4 / 12.5},
        {DEFAULT("], 'gravity': [0, 0, 0]"), "stiffness", 1e6},
        {DEFAULT(
             ", {'rigid': {'density': 1e6, 'box': {'minimum': [0, 1e5, 0], 'maximum': [1, 100001, "
             "1]}}, 'velocity': [0, 1e6, 0]}]"),
         "stiffness", 1e15},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        pdyn_sim *sim = test_open(cases[k].text);
        assert_near(k, cases[k].name, parameter(sim, cases[k].name), cases[k].value);
        test_close(sim);
    }
}

/* ---- a tank at rest -------------------------------------------------------------------------- */

/* Mean of C over its expected value, compression x depth / head, at one to six spacings above the
 * floor: the lowest layer has fewer moving neighbours. */
static void test_settled_tank(void **state) {
    (void)state;
    const double depth = 0.4, spacing = 0.02, compression = 0.002;
    pdyn_sim *sim = test_open(FLUID(BLOCK, C, TANK("0")));
    const pdyn_state s = pdyn_get_state(sim);
    double found = 0.0, expected = 0.0;
    while (pdyn_time(sim) < 1.5) {
        pdyn_step_info info = test_step(sim);
        for (int i = 0; i < s.particles && info.time > 1.0; i++) {
            double y = s.x[3 * i + 1];
            if (y < spacing || y > 6.0 * spacing) continue;
            found += s.density[i] / 1000.0 - 1.0;
            expected += compression * (depth - y) / depth;
        }
    }
    if (fabs(found / expected - 1.0) > 0.2)
        fail_msg("the deep layers have %.4g times the compression asked for", found / expected);
    test_close(sim);
}

/* Means of the density error and of the energy, J, of shallow water from 0.5 to 1 s. */
static void settle(const char *text, double mean[2]) {
    pdyn_sim *sim = test_open(text);
    double time = 0.0;
    mean[0] = mean[1] = 0.0;
    while (pdyn_time(sim) < 1.0) {
        pdyn_step_info info = test_step(sim);
        if (info.time < 0.5) continue;
        time += info.h;
        mean[0] += info.h * info.density_error_mean, mean[1] += info.h * info.constraint_energy;
    }
    mean[0] /= time, mean[1] /= time;
    test_close(sim);
}

#define SHALLOW(damping)                                                                           \
    FLUID(BOX_OF("0.01", "0.16", "0.1"),                                                           \
          "'sound_speed': 20, 'viscosity': 0.3, 'damping': " damping, TANK("0"))

/* Damping acts on what changes: water at rest has the same compression and energy with it. */
static void test_damped_tank(void **state) {
    (void)state;
    double without[2], with[2];
    settle(SHALLOW("0"), without), settle(SHALLOW("0.004"), with);
    print_message("%g and %g, %g and %g J\n", without[0], with[0], without[1], with[1]);
    for (int k = 0; k < 2; k++) assert_true(fabs(with[k] / without[k] - 1.0) < 0.02);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formula),
        cmocka_unit_test(test_default),
        cmocka_unit_test(test_settled_tank),
        cmocka_unit_test(test_damped_tank),
    };
    return cmocka_run_group_tests_name("fluid_stiffness", tests, scene_set_up, scene_tear_down);
}
