/* Surface tension: a cube becomes a sphere and keeps its volume and momentum; wetting; bad input.
 */
#include "support.h"

#include "projdyn/vec3.h"

static const double d = 1e-3;

/* A block of half the size a times a times b, m, from the floor (y = 0) or around the origin. */
static pdyn_sim *load(double a, double b, bool floor, const char *tension) {
    char text[2048];
    snprintf(text, sizeof text,
             "{'gravity': [0, 0, 0], 'duration': 10, 'time_step': {'maximum': 5e-4}, 'solver': "
             "{'linear_tolerance': 0.1}, 'bodies': [{'particles': {'radius': %g, 'fill': [{'box': "
             "{'minimum': [%g, %g, %g], 'maximum': [%g, %g, %g]}}]}, 'constraints': [{'type': "
             "'fluid', 'sound_speed': 5, 'viscosity': 0.5}%s]}]%s}",
             0.5 * d, -a, floor ? 0.0 : -b, -a, a, floor ? 2.0 * b : b, a, tension,
             floor ? ", 'solids': [{'box': {'minimum': [-0.02, 0, -0.02], 'maximum': [0.02, 0.04, "
                     "0.02]}, 'open': ['+y']}]"
                   : "");
    return test_open(text);
}

#define TENSION(angle) ", {'type': 'surface_tension', 'tension': 0.072, 'contact_angle': " angle "}"

/* Mean position and mean squares of the distances from it. */
static void measure(const pdyn_sim *sim, double middle[3], double moments[3]) {
    pdyn_state state = pdyn_get_state(sim);
    int n = pdyn_get_body(sim, 0).count;
    for (int a = 0; a < 3; a++) middle[a] = moments[a] = 0.0;
    for (int k = 0; k < 3 * n; k++) middle[k % 3] += state.x[k] / n;
    for (int k = 0; k < 3 * n; k++) moments[k % 3] += pow(state.x[k] - middle[k % 3], 2) / n;
}

/* A flat block, whose moments differ by the factor 2, becomes round. Momentum stays zero,
 * angular momentum below a hundredth of mass x radius x speed. Without tension it stays as it is.
 */
static void test_drop(void **state) {
    (void)state;
    for (int with = 0; with < 2; with++) {
        pdyn_sim *sim = load(5.0 * d, 3.5 * d, false, with ? TENSION("90") : "");
        double middle[3], m[3], momentum = 0.0, turn[3] = {0}, mass = 1e3 * d * d * d;
        pdyn_step_info info;
        while (pdyn_time(sim) < 0.15) {
            info = test_step(sim);
            momentum = fmax(momentum, vec3_length(info.momentum));
        }
        int n = pdyn_get_body(sim, 0).count;
        measure(sim, middle, m);
        for (int i = 0; i < n; i++) {
            double l[3];
            vec3_cross(l, sim->x + 3 * i, sim->v + 3 * i);
            vec3_add(turn, mass, l);
        }
        double radius = sqrt(5.0 / 3.0 * (m[0] + m[1] + m[2]));
        double volume = 4.0 / 3.0 * acos(-1.0) * pow(radius, 3) / (n * d * d * d);
        if (with) assert_true(fabs(m[1] / m[0] - 1.0) < 0.12 && fabs(m[1] / m[2] - 1.0) < 0.12);
        else assert_true(m[1] / m[0] < 0.55);
        if (with) assert_true(fabs(volume - 1.0) < 0.05);
        assert_true(momentum < 1e-15 && vec3_length(turn) < 1e-9);
        test_close(sim);
    }
}

/* A block on a floor: the smaller the angle, the lower the drop. It does not leave the floor. */
static void test_wetting(void **state) {
    (void)state;
    static const char *const tension[] = {TENSION("40"), TENSION("90"), TENSION("130")};
    double height[3];
    for (int k = 0; k < 3; k++) {
        pdyn_sim *sim = load(4.0 * d, 3.0 * d, true, tension[k]);
        double middle[3], moments[3];
        while (pdyn_time(sim) < 0.1) test_step(sim);
        measure(sim, middle, moments);
        height[k] = middle[1] / d;
        test_close(sim);
    }
    assert_true(height[0] < 0.9 * height[1] && height[1] < 0.9 * height[2] && height[2] < 5.0);
}

/* A block on a floor with 60 degrees comes to rest as a cap, whose mean height is 1.81 d. */
static void test_rest(void **state) {
    (void)state;
    pdyn_sim *sim = load(5.5 * d, 3.0 * d, true, TENSION("60"));
    double middle[3], moments[3], height[2];
    for (int k = 0; k < 2; k++) {
        while (pdyn_time(sim) < 0.3 + 0.3 * k) test_step(sim);
        measure(sim, middle, moments);
        height[k] = middle[1] / d;
    }
    assert_true(fabs(height[0] - 1.81) < 0.3 && fabs(height[1] - height[0]) < 0.1);
    test_close(sim);
}

/* Mean pressure of the particles closer than `reach` to the origin, Pa. */
static double inner_pressure(const pdyn_sim *sim, double reach) {
    pdyn_state state = pdyn_get_state(sim);
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < pdyn_get_body(sim, 0).count; i++)
        if (vec3_length(state.x + 3 * i) < reach) sum += state.pressure[i], count++;
    return sum / count;
}

/* Laplace: 2 tension / R, with the kernel "wendland". */
static void test_pressure(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{'gravity': [0, 0, 0], 'duration': 1, 'kernel': 'wendland', 'time_step': "
        "{'maximum': 5e-4}, 'solver': {'linear_tolerance': 0.1}, 'bodies': [{'particles': "
        "{'radius': 5e-4, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': 7e-3}}]}, "
        "'constraints': [{'type': 'fluid', 'sound_speed': 5, 'viscosity': 0.2}" TENSION(
            "90") "]}]}");
    double radius = d * cbrt(3.0 * pdyn_get_body(sim, 0).count / (4.0 * acos(-1.0))), sum = 0.0;
    int steps = 0;
    while (pdyn_time(sim) < 0.25) {
        test_step(sim);
        if (pdyn_time(sim) > 0.12) sum += inner_pressure(sim, radius - 3.0 * d), steps++;
    }
    double expected = 2.0 * 0.072 / radius;
    print_message("pressure in a drop: %.2f Pa, 2 tension / R: %.2f Pa\n", sum / steps, expected);
    assert_true(fabs(sum / steps / expected - 1.0) < 0.08);
    test_close(sim);
}

/* A drop in the middle of a free rigid plate, all at rest, does not turn it: the drop pulls at the
 * points that it touches, not at the corners of the plate's triangles. */
static void test_plate(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{'gravity': [0, 0, 0], 'duration': 10, 'time_step': {'maximum': 5e-4}, 'bodies': ["
        "{'particles': {'radius': 5e-4, 'fill': [{'box': {'minimum': [-0.003, 0, -0.003], "
        "'maximum': [0.003, 0.006, 0.003]}}]}, 'constraints': [{'type': 'fluid', 'sound_speed': 5, "
        "'viscosity': 0.5}" TENSION("60") "]}, {'rigid': {'box': {'minimum': [-0.008, -0.0041, "
                                          "-0.008], 'maximum': [0.008, -0.0001, 0.008]}, "
                                          "'density': 3000}}]}");
    pdyn_body_info plate = pdyn_get_body(sim, 1);
    double v[3] = {0};
    while (pdyn_time(sim) < 0.02) test_step(sim);
    for (int i = plate.first; i < plate.first + plate.count; i++)
        vec3_add(v, 1.0 / plate.count, sim->v + 3 * i);
    for (int i = plate.first; i < plate.first + plate.count; i++)
        assert_true(vec3_distance(sim->v + 3 * i, v) < 0.01);
    test_close(sim);
}

/* Two particles alone on a floor draw together; they do not keep the solver from the rest. */
static void test_pair(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{'duration': 1, 'time_step': {'maximum': 0.001}, 'bodies': [{'particles': {'radius': "
        "0.0015, 'fill': [{'box': {'minimum': [-0.003, 0, -0.0015], 'maximum': [0.003, 0.003, "
        "0.0015]}}, {'box': {'minimum': [0.04, 0.1, 0], 'maximum': [0.058, 0.118, 0.018]}}]}, "
        "'constraints': [{'type': 'fluid', 'sound_speed': 30}, {'type': 'surface_tension', "
        "'tension': 0.072}]}], 'solids': [{'box': {'minimum': [-0.1, 0, -0.1], 'maximum': [0.1, "
        "0.3, 0.1]}, 'open': ['+y']}]}");
    while (pdyn_time(sim) < 0.06) {
        double residual = test_step(sim).step_residual;
        if (!(residual < 1.0)) fail_msg("residual %g at %g s", residual, pdyn_time(sim));
    }
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drop),  cmocka_unit_test(test_wetting),
        cmocka_unit_test(test_rest),  cmocka_unit_test(test_pressure),
        cmocka_unit_test(test_plate), cmocka_unit_test(test_pair)};
    return cmocka_run_group_tests_name("surface_tension", tests, NULL, NULL);
}
