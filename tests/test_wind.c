/* Wind and drag: terminal velocity, direction of the pressure, stability for sheets of small mass.
 */
#include "support.h"

#include "projdyn/vec3.h"

static const double g = 9.81, air = 1.2;

/* A sheet of 1 m^2 of this mass in kg, rotated about x by an angle in degrees; wind along y in m/s.
 */
static pdyn_sim *load(double h, double mass, double angle, double wind, const char *more) {
    char text[1024];
    snprintf(
        text, sizeof text,
        SCENE("'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': %.17g, "
              "'integrator': 'euler'}, 'solver': {'tolerance': 1e-10, 'linear_tolerance': 1e-6%s}",
              GRID_SHEET(
                  "", "1, 1", "4, 3", "'rotate': [%.17g, 0, 0], 'area_density': %.17g",
                  PAIR(STRAIN("10"), "{'type': 'wind', 'drag': 1.5, 'velocity': [0, %.17g, 0]}")),
              ""),
        h, more, angle, mass, wind);
    return test_open(text);
}

/* Falling flat, m (v' + g) = 1/2 rho drag v^2 with one of the two v implicit, up to the terminal
 * velocity. With the projective step the matrix follows the weights. */
static void test_terminal_velocity(void **state) {
    (void)state;
    static const struct {
        double h, mass;
        const char *solver;
    } runs[] = {{0.01, 0.2, ""}, {0.1, 1e-3, ""}, {0.1, 1e-3, ", 'step': 'projective'"}};
    for (int k = 0; k < 3; k++) {
        double h = runs[k].h, m = runs[k].mass, v = 0.0;
        pdyn_sim *sim = load(h, m, 0.0, 0.0, runs[k].solver);
        for (int n = 0; n < 300; n++) {
            pdyn_step_info info = test_step(sim);
            double push = 0.5 * air * 1.5 * fabs(v);
            v = (v - h * g) / (1.0 + h * push / m);
            for (int i = 0; i < 12; i++) assert_true(fabs(sim->v[3 * i + 1] / v - 1.0) < 1e-6);
            assert_true(info.constraint_energy < 1e-9);
        }
        assert_true(fabs(v / -sqrt(2.0 * m * g / (air * 1.5)) - 1.0) < 1e-3);
        test_close(sim);
    }
}

/* The pressure is normal to the sheet for both orientations and proportional to the square of the
 * normal wind speed. */
static void test_direction(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        double angle = 30.0 + 180.0 * (k / 2), wind = k % 2 ? 5.0 : -5.0, h = 1e-5;
        pdyn_sim *sim = load(h, 0.2, angle, wind, "");
        pdyn_step_info info = test_step(sim);
        double c = cos(angle * acos(-1.0) / 180.0), s = sin(angle * acos(-1.0) / 180.0);
        double across = wind * c, force = 0.5 * air * 1.5 * across * fabs(across);
        double expected[3] = {0.0, h * (force * c - 0.2 * g), h * force * s};
        assert_true(vec3_distance(info.momentum, expected) < 1e-3 * vec3_length(expected));
        test_close(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_terminal_velocity),
        cmocka_unit_test(test_direction),
    };
    return cmocka_run_group_tests_name("wind", tests, NULL, NULL);
}
