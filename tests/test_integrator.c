/* Time integration: free fall, order of convergence, variable steps, impacts. */
#include "support.h"

#include "projdyn/control.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { EULER, BDF2, INTEGRATORS };
static const char *const integrator[INTEGRATORS] = {"euler", "bdf2"};

/* ---- free fall ------------------------------------------------------------------------------- */

/* Both integrators for one particle in one dimension. before: length of the previous step, 0: none.
 */
struct fall {
    double x, v, x_before, v_before, before;
};

static void fall(struct fall *f, int kind, double h, double g) {
    double w = f->before > 0.0 ? h / f->before : INFINITY;
    bool bdf2 = kind == BDF2 && w <= 2.0;
    double c = bdf2 ? w * w / (1.0 + 2.0 * w) : 0.0;
    double H = bdf2 ? h * (1.0 + w) / (1.0 + 2.0 * w) : h;
    double x = f->x + c * (f->x - f->x_before), v = f->v + c * (f->v - f->v_before);
    f->x_before = f->x, f->v_before = f->v, f->before = h;
    f->v = v + H * g, f->x = x + H * f->v;
}

/* A sheet with any constraints falls as a particle does, also in steps of changing length; its
 * momentum is exact. */
static void test_free_fall(void **state) {
    (void)state;
    static const double step[] = {0.01, 0.01, 0.0025, 0.0025, 0.004, 0.01, 0.01};
    for (int kind = 0; kind < INTEGRATORS; kind++) {
        char text[1024];
        snprintf(text, sizeof text,
                 SCENE("'duration': 100, 'frame_interval': 100, 'time_step': {'fixed': 0.01, "
                       "'integrator': '%s'}",
                       GRID_SHEET("'velocity': [0, 2, 0], ", "1, 1", "9, 9", "'area_density': 0.3",
                                  SPRINGS("2000")),
                       ""),
                 integrator[kind]);
        pdyn_sim *sim = test_open(text);
        struct fall f = {.x = sim->x[1], .v = 2.0};
        for (int n = 0; n < 49; n++) {
            sim->scene.settings.h_fixed = step[n % 7];
            pdyn_step_info info = test_step(sim);
            fall(&f, kind, info.h, -9.81);
            for (int i = 0; i < sim->objective.particles; i++)
                assert_true(fabs(sim->x[3 * i + 1] - f.x) < 1e-11);
            assert_true(fabs(info.momentum[1] - 0.3 * (2.0 - 9.81 * info.time)) < 1e-11);
        }
        test_close(sim);
    }
}

/* ---- viscosity of the fluid ------------------------------------------------------------------ */

/* The part of their speed that two particles of water, which approach each other by less than 2 %,
 * keep in 50 steps; the viscosity of "fluid" acts on velocities between steps. */
static double kept_speed(int kind) {
    char text[1024];
    snprintf(text, sizeof text,
             "{'duration': 1, 'frame_interval': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': "
             "0.001, 'integrator': '%s'}, 'bodies': [{'particles': {'radius': 0.01, 'fill': "
             "[{'box': {'minimum': [0, 0, 0], 'maximum': [0.04, 0.02, 0.02]}}]}, 'constraints': "
             "[{'type': 'fluid', 'viscosity': 0.05}]}]}",
             integrator[kind]);
    pdyn_sim *sim = test_open(text);
    assert_int_equal(sim->objective.particles, 2);
    sim->v[0] = 0.005, sim->v[3] = -0.005;
    for (int n = 0; n < 50; n++) test_step(sim);
    double kept = (sim->v[0] - sim->v[3]) / 0.01;
    test_close(sim);
    return kept;
}

static void test_fluid_viscosity(void **state) {
    (void)state;
    double euler = kept_speed(EULER), bdf2 = kept_speed(BDF2);
    print_message("kept speed: euler %.5f, bdf2 %.5f\n", euler, bdf2);
    assert_true(euler > 0.1 && euler < 0.9 && fabs(log(bdf2) / log(euler) - 1.0) < 0.03);
}

/* ---- adaptive steps -------------------------------------------------------------------------- */

/* The length of the first step of water at rest, without gravity, with more in its scene or, above
 * 0, an applied force, m/s^2. */
static double step_length(const char *particles, const char *solids, double applied) {
    char text[1024];
    double force[24] = {0};
    snprintf(text, sizeof text,
             "{'duration': 100, 'frame_interval': 100, 'gravity': [0, 0, 0], 'time_step': "
             "{'maximum': 0.1}, 'bodies': [{'particles': {'radius': 0.01, 'fill': [{'box': "
             "{'minimum': [0, 0, 0], 'maximum': [0.04, 0.04, 0.04]}}]%s}, 'constraints': [{'type': "
             "'fluid', 'stiffness': 1e-3}]}], 'solids': [%s]}",
             particles, solids);
    pdyn_sim *sim = test_open(text);
    for (int i = 0; i < 8; i++) force[3 * i + 1] = applied * sim->objective.mass[i];
    assert_int_equal(pdyn_set_forces(sim, 0, 8, force), PDYN_OK);
    double h = test_step(sim).h;
    test_close(sim);
    return h;
}

/* Particles, moving solids and inlets, also those that become faster in the step, travel at most a
 * radius, 0.01 m. */
static void test_step_length(void **state) {
    (void)state;
    double still = step_length("", "", 0.0), forced = step_length("", "", 100.0);
    double solid = step_length("",
                               "{'sphere': {'center': [9, 9, 9], 'radius': 0.1}, 'motion': "
                               "[{'time': 0}, {'time': 1, 'translate': [4, 0, 0]}]}",
                               0.0);
    double inlet =
        step_length(", 'inlets': [{'disc': {'center': [5, 0, 0], 'radius': 0.02}, "
                    "'direction': [1, 0, 0], 'speed': [{'time': 0, 'speed': 0}, {'time': "
                    "0.1, 'speed': 2}]}], 'budget': 500",
                    "", 0.0);
    print_message("%g, %g, %g, %g s\n", still, forced, solid, inlet);
    assert_true(fabs(still - 0.1) < 1e-3);
    assert_true(100.0 * 0.1 * forced < 0.0101 && 100.0 * 0.1 * forced > 0.0099);
    assert_true(4.0 * solid < 0.0101 && 4.0 * solid > 0.0099);
    assert_true(2.0 * inlet < 0.0101 && 2.0 * inlet > 0.0099);
}

/* A solid makes steps short and comes to rest: from eleven steps in a frame on, they grow until one
 * fills a frame, and never to more than twice the length. */
static void test_steps_grow_again(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{'duration': 9, 'frame_interval': 0.1, 'time_step': {'maximum': 0.1}, 'gravity': "
        "[0, 0, 0], 'bodies': [{'particles': {'radius': 0.01, 'fill': [{'box': "
        "{'minimum': [0, 0, 0], 'maximum': [0.04, 0.04, 0.04]}}]}, 'constraints': "
        "[{'type': 'fluid', 'stiffness': 1e-3}]}], 'solids': [{'sphere': {'center': [9, "
        "9, 9], 'radius': 0.1}, 'motion': [{'time': 0}, {'time': 0.1, 'translate': [0.11, "
        "0, 0]}]}]}");
    double h = test_step(sim).h;
    assert_true(fabs(h - 0.1 / 11) < 1e-9);
    while (sim->time < 1.25) {
        double before = h;
        h = test_step(sim).h;
        assert_true(h <= 2.001 * before);
    }
    assert_true(fabs(h - 0.1) < 1e-9);
    test_close(sim);
}

/* ---- order ----------------------------------------------------------------------------------- */

/* end: position of a corner of a triangle on springs that rotates, oscillates and falls, after 0.8
 * s in steps of h, or of ratio x h between 0.3 and 0.5 s. */
static void swing(int kind, double damping, double h, double ratio, double end[3]) {
    static const double start[9] = {0.0, 2.0, 0.5, -1.5, -1.0, 0.0, 1.0, -1.0, -0.5};
    char text[1024];
    test_write_text("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0.5 0.8 0\nf 1 2 3\n");
    snprintf(text, sizeof text,
             "{'duration': 100, 'frame_interval': 0.1, 'time_step': {'fixed': %.17g, 'integrator': "
             "'%s'}, 'solver': {'tolerance': 1e-11, 'linear_tolerance': 1e-6, 'outer_iterations': "
             "100}, 'bodies': [{'surface': {'mesh': 'triangle.obj', 'area_density': 1}, "
             "'constraints': [{'type': 'spring', 'stretching_stiffness': 10, 'damping': %g}]}]}",
             h, integrator[kind], damping);
    pdyn_sim *sim = test_open(text);
    memcpy(sim->v, start, sizeof start);
    while (pdyn_time(sim) < 0.8 - 1e-9) {
        double t = pdyn_time(sim);
        sim->scene.settings.h_fixed = t > 0.3 - 1e-9 && t < 0.5 - 1e-9 ? ratio * h : h;
        test_step(sim);
    }
    memcpy(end, sim->x + 3, 3 * sizeof *end);
    test_close(sim);
    test_remove_file("triangle.obj");
}

/* exact: the end of steps so short that their error does not count. */
static double order_of(int kind, double damping, double ratio, const double exact[3]) {
    double end[2][3];
    for (int k = 0; k < 2; k++) swing(kind, damping, 0.1 / (16 << k), ratio, end[k]);
    double coarse = vec3_distance(end[0], exact), fine = vec3_distance(end[1], exact);
    print_message("%s, damping %g, ratio %g: %.3g and %.3g m, order %.2f\n", integrator[kind],
                  damping, ratio, coarse, fine, log2(coarse / fine));
    return log2(coarse / fine);
}

/* Halving all steps, some of which are four times as long or short as the others: the error falls
 * by four with BDF2, by two with Euler. */
static void test_order(void **state) {
    (void)state;
    static const double ratio[] = {1.0, 4.0, 0.25};
    double exact[3];
    swing(BDF2, 0.0, 0.1 / 2048, 1.0, exact);
    for (int k = 0; k < 3; k++) {
        double first = order_of(EULER, 0.0, ratio[k], exact);
        double second = order_of(BDF2, 0.0, ratio[k], exact);
        assert_true(first > 0.8 && first < 1.3);
        assert_true(second > 1.75 && second < 2.4);
    }
    /* the strain rate of a rotating body in a damper is not of second order */
    swing(BDF2, 0.02, 0.1 / 2048, 1.0, exact);
    assert_true(order_of(BDF2, 0.02, 1.0, exact) > 1.1);
}

/* ---- impacts --------------------------------------------------------------------------------- */

/* A sheet that hits a floor flat with 3.6 m/s, in steps that are all solved, stays there; without
 * loss of energy it would rise by 0.66 m. */
static void test_no_bounce(void **state) {
    (void)state;
    for (int kind = 0; kind < INTEGRATORS; kind++)
        for (int k = 0; k < 2; k++) {
            char text[1024];
            snprintf(
                text, sizeof text,
                SCENE("'duration': 1, 'frame_interval': 0.1, 'time_step': {'fixed': %g, "
                      "'integrator': '%s'}, 'solver': {'tolerance': 0.1, 'outer_iterations': 200}, "
                      "'contact': {'thickness': 0.01}",
                      GRID_SHEET("'velocity': [0, -3.6, 0], ", "0.5, 0.5", "6, 6",
                                 "'translate': [0, 0.05, 0], 'area_density': 0.3", SPRINGS("1000")),
                      ", 'solids': [{'box': {'minimum': [-1, 0, -1], 'maximum': [1, 1, 1]}}]"),
                k ? 0.01 : 0.005, integrator[kind]);
            pdyn_sim *sim = test_open(text);
            double highest = 0.0;
            int impacts = 0;
            while (pdyn_time(sim) < 0.3) {
                pdyn_step_info info = test_step(sim);
                impacts += info.impacts;
                for (int i = 0; info.time > 0.05 && i < sim->objective.particles; i++)
                    highest = fmax(highest, sim->x[3 * i + 1]);
            }
            if (!(highest < 0.2)) fail_msg("%s: up to %g m", integrator[kind], highest);
            assert_true((impacts > 0) == (kind == BDF2));
            test_close(sim);
        }
}

/* A drop falls at 4 m/s on a sheet whose vertices are all held: it bounces no more than on a solid.
 * Vertices of a twelfth of its particles' mass do not yield: pins hold them. */
static void test_held_sheet(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        "'duration': 1, 'frame_interval': 0.1",
        PAIR("{'velocity': [0, -4, 0], 'particles': {'radius': 0.006, 'fill': [{'sphere': "
             "{'center': [0, 0.3, 0], 'radius': 0.03}}]}, 'constraints': [{'type': 'fluid'}]}",
             GRID_SHEET("", "0.4, 0.4", "17, 17",
                        "'translate': [0, 0.2, 0], 'area_density': "
                        "0.25",
                        PAIR(SPRINGS("1000"), PINS("'all': true")))),
        ""));
    double fastest = 0.0, up = 0.0;
    const pdyn_body_info drop = pdyn_get_body(sim, 0);
    while (pdyn_time(sim) < 0.06) {
        test_step(sim);
        up = 0.0;
        for (int i = 0; i < drop.count; i++) up += sim->v[3 * i + 1] / drop.count;
        fastest = fmin(fastest, up);
    }
    assert_true(fastest < -4.0);
    if (!(up < 0.2 * -fastest)) fail_msg("bounces with %g of %g m/s", up, -fastest);
    test_close(sim);
}

/* Water falls on a light sheet that is held at its border, like on a trampoline. A part of the
 * forces counts as impacts by chance, which adds energy: at most an eighth of the kinetic one,
 * until the sheet has caught the water. */
static void test_caught_water(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        "'duration': 1, 'frame_interval': 0.1, 'time_step': {'fixed': 0.01}",
        PAIR(FLUID_BOX("", "0.03", "-0.15, 0.1, -0.15", "0.15, 0.25, 0.15", ", 'stiffness': 1e5"),
             GRID_SHEET("", "0.6, 0.6", "11, 11", "'area_density': 0.05",
                        PAIR(SPRINGS("1500"), PINS("'border': true")))),
        ""));
    double first = INFINITY, rise = 0.0, kinetic = 0.0;
    while (pdyn_time(sim) < 0.3) {
        pdyn_step_info info = test_step(sim);
        double all = info.kinetic_energy + info.potential_energy + info.constraint_energy;
        first = fmin(first, all);
        rise = fmax(rise, all - first), kinetic = fmax(kinetic, info.kinetic_energy);
    }
    if (!(rise < kinetic / 8)) fail_msg("gains %g of %g J", rise, kinetic);
    test_close(sim);
}

/* Water falls 6 cm onto a sheet with pinned borders, which throws it up again. The pressure that
 * slows the water down for many steps is no impact: counted as one, it would add 10 of 43 J. */
static void test_thrown_up(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        SCENE("'duration': 1, 'frame_interval': 0.1, 'time_step': {'fixed': 0.005}, 'contact': "
              "{'thickness': 0.01}",
              PAIR("{'particles': {'radius': 0.02, 'fill': [{'box': {'minimum': [-0.16, 0.06, "
                   "-0.16], 'maximum': [0.16, 0.3, 0.16]}}]}, 'constraints': [{'type': 'fluid'}]}",
                   GRID_SHEET("", "0.8, 0.8", "17, 17", "'area_density': 0.5",
                              PAIR(SPRINGS("1000"), PINS("'border': true")))),
              ""));
    double start = 0.0, lowest = INFINITY, gained = 0.0;
    while (pdyn_time(sim) < 0.5 - 1e-9) {
        pdyn_step_info info = test_step(sim);
        double all = info.kinetic_energy + info.potential_energy + info.constraint_energy;
        if (lowest == INFINITY) start = all;
        lowest = fmin(lowest, all);
        gained = fmax(gained, all - lowest);
    }
    print_message("gains %.3g of %.3g J\n", gained, start);
    assert_true(gained < 0.03 * start);
    test_close(sim);
}

/* A block of water hits a floor: its energy never rises, and it does not rise again. */
static void test_splash(void **state) {
    (void)state;
    for (int kind = 0; kind < INTEGRATORS; kind++) {
        char text[1024];
        snprintf(
            text, sizeof text,
            "{'duration': 1, 'frame_interval': 0.1, 'time_step': {'maximum': 0.004, 'integrator': "
            "'%s'}, 'solver': {'tolerance': 0.05}, 'bodies': [{'particles': {'radius': 0.02, "
            "'fill': [{'velocity': [0, -4, 0], 'box': {'minimum': [0.4, 0.05, 0.4], 'maximum': "
            "[0.6, 0.25, 0.6]}}]}, 'constraints': [{'type': 'fluid', 'stiffness': 1e7}]}], "
            "'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}}]}",
            integrator[kind]);
        pdyn_sim *sim = test_open(text);
        double energy = INFINITY, mean = 0.0;
        while (pdyn_time(sim) < 0.09) {
            pdyn_step_info info = test_step(sim);
            double all = info.kinetic_energy + info.potential_energy + info.constraint_energy;
            assert_true(all < energy * (1.0 + 1e-3));
            energy = fmin(energy, all);
        }
        for (int i = 0; i < sim->objective.particles; i++)
            mean += sim->x[3 * i + 1] / sim->objective.particles;
        print_message("%s: mean height %.4f m, energy %.4g J\n", integrator[kind], mean, energy);
        assert_true(mean < 0.022); /* the centre of one layer is 0.02 m above the floor */
        test_close(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_fall),       cmocka_unit_test(test_step_length),
        cmocka_unit_test(test_fluid_viscosity), cmocka_unit_test(test_order),
        cmocka_unit_test(test_no_bounce),       cmocka_unit_test(test_held_sheet),
        cmocka_unit_test(test_caught_water),    cmocka_unit_test(test_splash),
        cmocka_unit_test(test_thrown_up),       cmocka_unit_test(test_steps_grow_again),
    };
    return cmocka_run_group_tests_name("integrator", tests, test_enter_directory,
                                       test_leave_directory);
}
