/* Rigid bodies on their contacts: they do not rock, rise slowly after a fall, and roll freely; the
 * dashpots are the gradient of one energy and hold nothing together. */
#include "support.h"

#include <string.h>

#define BOX_AT(height)                                                                             \
    "{'name': 'box', 'rigid': {'box': {'minimum': [-0.05, 0, -0.05], 'maximum': [0.05, 0.1, "      \
    "0.05]}, 'translate': [0, " height ", 0], 'density': 500}"
#define BOX BOX_AT("0.0035")
#define BALL_OF(radius, height)                                                                    \
    "{'name': 'ball', 'rigid': {'sphere': {'center': [0, " height ", 0], 'radius': " radius "}, "  \
    "'density': 500}"

/* A body on a wide floor, with default settings but for the step length, s, and more of them;
 * gravity is inclined by an angle, degrees. */
static pdyn_sim *load(const char *body, const char *more, double degrees, double h) {
    char text[1024];
    double angle = degrees * acos(-1.0) / 180.0;
    snprintf(text, sizeof text,
             "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': %g}, 'gravity': "
             "[%.17g, %.17g, 0], 'contact': {'thickness': 0.004, 'friction': 0.5}%s, 'solids': "
             "[{'name': 'floor', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': "
             "20}}], 'bodies': [%s}]}",
             h, 9.81 * sin(angle), -9.81 * cos(angle), more, body);
    return test_open(text);
}

static double mean_of(const pdyn_sim *sim, const double *value, int axis) {
    double sum = 0.0;
    for (int i = 0; i < sim->body[0].count; i++) sum += value[3 * i + axis];
    return sum / sim->body[0].count;
}

static void step_to(pdyn_sim *sim, double time) {
    while (pdyn_time(sim) < time - 1e-9) test_step(sim);
}

/* Acceleration down a slope from 0.5 to 1 s, m/s^2; *speed: at the end, m/s. */
static double accelerate(const char *body, double degrees, double h, double *speed) {
    pdyn_sim *sim = load(body, "", degrees, h);
    step_to(sim, 0.5);
    double before = mean_of(sim, sim->v, 0);
    step_to(sim, 1.0);
    *speed = mean_of(sim, sim->v, 0);
    test_close(sim);
    return (*speed - before) / 0.5;
}

/* Coulomb's law, tan 26.57 degrees = 0.5: for steps that resolve the oscillation of the box on its
 * contacts, with a period of 0.04 s, and for longer ones. Friction makes this oscillation grow. */
static void test_slope(void **state) {
    (void)state;
    static const double h[] = {0.005, 0.001};
    double angle = 30.0 * acos(-1.0) / 180.0, theory = 9.81 * (sin(angle) - 0.5 * cos(angle));
    for (int k = 0; k < 2; k++) {
        double speed, found = accelerate(BOX, 30.0, h[k], &speed);
        accelerate(BOX, 25.0, h[k], &speed);
        print_message("h %g: %.4f m/s^2 at 30 degrees, theory %.4f; %.4f m/s at 25\n", h[k], found,
                      theory, speed);
        assert_true(fabs(found - theory) < 0.05 * theory);
        assert_true(fabs(speed) < 5e-3);
    }
}

/* A ball that rolls has 5/7 of the acceleration of one that slides without friction. Dashpots brake
 * it by the facets of its mesh: the smaller it is beside the thickness, the more. */
static void test_roll(void **state) {
    (void)state;
    static const char *const ball[] = {BALL_OF("0.05", "0.0535"), BALL_OF("0.1", "0.1035")};
    static const double most[] = {0.05, 0.03};
    double speed, angle = 10.0 * acos(-1.0) / 180.0, theory = 5.0 / 7.0 * 9.81 * sin(angle);
    for (int k = 0; k < 2; k++) {
        double found = accelerate(ball[k], 10.0, 0.005, &speed);
        print_message("ball: %.4f m/s^2, theory %.4f\n", found, theory);
        assert_true(fabs(found - theory) < most[k] * theory);
    }
}

/* A box that falls flat rises again with little more than the speed that a linear dashpot leaves of
 * it, exp(-0.3 pi / sqrt(1 - 0.3^2)) = 0.37 at the damping ratio 0.3: a barrier becomes stiffer
 * within a step, and the dashpot is that of its beginning. The mean load on the floor is the
 * weight, when the box is at rest at the end. */
static void test_rebound(void **state) {
    (void)state;
    static const double h[] = {0.005, 0.0005};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = load(BOX_AT("0.03") ", 'velocity': [0, -1.4, 0]", "", 0.0, h[k]);
        double impulse = 0.0, force[3], moment[3], up = 0.0;
        while (pdyn_time(sim) < 1.0) {
            test_step(sim);
            assert_int_equal(pdyn_solid_load(sim, 0, force, moment), PDYN_OK);
            impulse -= h[k] * force[1];
            up = fmax(up, mean_of(sim, sim->v, 1));
        }
        double due = 0.5 * (9.81 * pdyn_time(sim) + 1.4 + mean_of(sim, sim->v, 1));
        print_message("h %g: up with %.2f of 1.57 m/s, impulse %.4f, due %.4f N s\n", h[k], up,
                      impulse, due);
        assert_true(up < 0.45 * 1.57);
        assert_true(fabs(impulse - due) < 0.01 * due);
        test_close(sim);
    }
}

/* A slot 6 mm wider than the box touches it on both sides: without friction the box falls freely.
 */
static void test_slot(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': 0.005}, 'contact': "
        "{'thickness': 0.004, 'friction': 0}, 'solids': [{'box': {'minimum': [-0.053, 0, -1], "
        "'maximum': [0.053, 2, 1]}}], 'bodies': [" BOX_AT("1.5") "}]}");
    step_to(sim, 0.3);
    assert_int_equal(sim->objective.dashpots->view.elements, 4);
    print_message("slot: %.4f m/s after 0.3 s\n", mean_of(sim, sim->v, 1));
    assert_true(fabs(mean_of(sim, sim->v, 1) + 0.3 * 9.81) < 0.01);
    test_close(sim);
}

/* Height of the box over a floor that rises at a speed, m/s, after a second. */
static double height_over(double speed) {
    char text[1024];
    snprintf(
        text, sizeof text,
        "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': 0.005}, 'contact': "
        "{'thickness': 0.004}, 'bodies': [" BOX ", 'velocity': [0, %g, 0]}], 'solids': "
        "[{'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 2}, 'motion': [{'time': "
        "0}, {'time': 1, 'translate': [0, %g, 0]}]}]}",
        speed, speed);
    pdyn_sim *sim = test_open(text);
    step_to(sim, 1.0);
    double height = mean_of(sim, sim->x, 1) - speed;
    test_close(sim);
    return height;
}

/* Dashpots damp the motion relative to a floor: a lift at constant speed carries the box as a floor
 * at rest does. */
static void test_lift(void **state) {
    (void)state;
    double rest = height_over(0.0), lifted = height_over(0.2);
    print_message("over the floor %.6f m, over a lift %.6f m\n", rest, lifted);
    assert_true(fabs(lifted - rest) < 1e-6);
}

/* ---- the dashpots ---------------------------------------------------------------------------- */

/* Moves the box at rest by a distance along the normal and by turns, 1 mm at its corners. */
static void displace(const pdyn_sim *sim, double up, double *x) {
    for (int i = 0; i < sim->objective.particles; i++) {
        const double *at = sim->x + 3 * i;
        memcpy(x + 3 * i, at, 3 * sizeof *x);
        x[3 * i + 1] += up + 0.02 * at[0] - 0.01 * at[2];
    }
}

/* E of the dashpots at a displacement, and its slope along the normal. */
static double energy_at(pdyn_sim *sim, double up, double *slope) {
    double x[64] = {0}, gradient[64] = {0};
    struct batch *damping = sim->objective.dashpots;
    assert_true(3 * sim->objective.particles < 64);
    displace(sim, up, x);
    assert_int_equal(batch_local(damping, x, gradient), PDYN_OK);
    *slope = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) *slope += gradient[3 * i + 1];
    return damping->energy;
}

/* Its slope is the gradient, and it pulls with at most the weight of the box, 0.5 kg. */
static void test_energy(void **state) {
    (void)state;
    pdyn_sim *sim = load(BOX, ", 'solver': {'tolerance': 1e-6}", 0.0, 0.005);
    step_to(sim, 1.0);
    test_step(sim);
    assert_int_equal(sim->objective.dashpots->view.elements, 4);
    static const double up[] = {-1e-3, 1e-5, 1e-4, 3e-3};
    for (int k = 0; k < 4; k++) {
        double d = 1e-8, slope, unused;
        double expected = energy_at(sim, up[k] + d, &unused) - energy_at(sim, up[k] - d, &unused);
        energy_at(sim, up[k], &slope);
        print_message("%g m: slope %.6g N\n", up[k], slope);
        assert_true(fabs(expected / (2.0 * d) - slope) < 1e-5 * (1.0 + fabs(slope)));
        assert_true(slope < 1.001 * 0.5 * 9.81 && (up[k] > 0.0 || slope < -1.0));
    }
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slope), cmocka_unit_test(test_roll), cmocka_unit_test(test_rebound),
        cmocka_unit_test(test_slot),  cmocka_unit_test(test_lift), cmocka_unit_test(test_energy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
