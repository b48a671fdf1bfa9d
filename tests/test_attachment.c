/* Attachment: static equilibrium of hanging weights, conservation of momentum, seams, undamped
 * oscillation, a rigid weight on cloth, strings that go slack. */
#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

static const char settings[] =
    "'duration': 1e6, 'frame_interval': 1e3, 'time_step': {'fixed': %g}, 'gravity': [0, %g, 0], "
    "'solver': {'type': '%s', 'tolerance': 1e-9, 'outer_iterations': 100}";

static pdyn_sim *load(pdyn_context *context, double h, double gravity, const char *solver,
                      const char *bodies) {
    char text[4096], head[512];
    snprintf(head, sizeof head, settings, h, gravity, solver);
    snprintf(text, sizeof text, "{%s, 'bodies': [%s]}", head, bodies);
    return test_load(context, text);
}

/* Four vertices of a load, each on a spring to a compliant sheet above ("roof"), to points inside
 * and on the sides of its triangles. The roof follows in the list of bodies. */
static const char hanging[] = PAIR(
    GRID_SHEET(
        "'name': 'load', ", "0.5, 0.5", "2, 2", "'translate': [0.1, -0.5, 0.07], 'area_density': 4",
        "{'type': 'attachment', 'to': 'roof', 'vertices': {'all': true}, 'stiffness': 1000}"),
    GRID_SHEET("'name': 'roof', ", "1, 1", "3, 3", "'area_density': 1",
               "{'type': 'pin', 'vertices': {'all': true}, 'stiffness': 1e4}"));

/* In equilibrium each spring is extended by weight / stiffness, and the pins of the roof carry the
 * whole weight, with its torque. */
static void test_weight(void **state) {
    (void)state;
    static const char *const solvers[] = {"auto", "cholesky", "cg"};
    const double g = 9.81, k = 1000.0, pin = 1e4;
    for (size_t n = 0; n < sizeof solvers / sizeof *solvers; n++) {
        if (test_lacks_solver(solvers[n])) continue;
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = load(context, 10.0, -g, solvers[n], hanging);
        const double *rest = sim->body[1].rest;
        double given = 0.0, turn[2] = {0.0}, weight = 0.0;
        for (int step = 0; step < 20; step++) test_step(sim);
        for (int i = 0; i < 4; i++) { /* the roof is tilted: the spring is not vertical */
            double force = g * sim->body[0].mass[i], x = sim->body[0].rest[3 * i];
            double slack = fabs(sim->x[3 * i + 1] - sim->body[0].rest[3 * i + 1]) - force / k;
            assert_true(slack > 0.0 && slack < 2.0 * 9.0 * force / pin);
            weight += force, turn[0] += force * x;
        }
        for (int i = 0; i < 9; i++) {
            double force =
                pin * (rest[3 * i + 1] - sim->x[3 * (4 + i) + 1]) - g * sim->body[1].mass[i];
            given += force, turn[1] += force * rest[3 * i];
        }
        assert_true(fabs(given - weight) < 1e-6 * weight);
        assert_true(fabs(turn[1] - turn[0]) < 0.01 * weight);
        test_close(sim);
    }
}

/* Bodies of a scene: two free sheets; springs of half their initial length. */
static const char pulled[] = PAIR(
    GRID_SHEET("", "1, 1", "5, 4", "'area_density': 0.3",
               PAIR(STRAIN("1000"),
                    "{'type': 'attachment', 'to': 'body1', 'vertices': {'border': "
                    "true}, 'stiffness': 50, 'length': 0.5, 'damping': %g, 'tension_only': %s}")),
    GRID_SHEET("", "0.8, 0.7", "4, 6",
               "'rotate': [20, 30, 10], 'translate': [0.1, 0.4, 0], 'area_density': 0.2",
               SPRINGS("800")));

static void momentum(const pdyn_sim *sim, double p[6]) {
    memset(p, 0, 6 * sizeof *p);
    for (int i = 0; i < sim->objective.particles; i++) {
        double turn[3];
        vec3_cross(turn, sim->x + 3 * i, sim->v + 3 * i);
        vec3_add(p, sim->objective.mass[i], sim->v + 3 * i);
        vec3_add(p + 3, sim->objective.mass[i], turn);
    }
}

/* p: linear and angular momentum (about the origin) after 0.1 s with steps of h. */
static void pull(double h, double damping, bool string, double p[6]) {
    char bodies[2048];
    pdyn_context *context = test_context(2);
    snprintf(bodies, sizeof bodies, pulled, damping, string ? "true" : "false");
    pdyn_sim *sim = load(context, h, 0.0, "auto", bodies);
    while (sim->time < 0.1 - 0.5 * h) test_step(sim);
    momentum(sim, p);
    test_close(sim);
}

/* Momentum is conserved to rounding; the error of angular momentum is proportional to the step. */
static void test_momentum(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        double long_steps[6], short_steps[6], damping = k % 2 ? 0.05 : 0.0;
        pull(4e-3, damping, k > 1, long_steps);
        pull(5e-4, damping, k > 1, short_steps);
        assert_true(vec3_length(long_steps) < 1e-13 && vec3_length(short_steps) < 1e-13);
        assert_true(vec3_length(short_steps + 3) < 0.25 * vec3_length(long_steps + 3));
    }
}

/* Two sheets with a gap of 5 cm between borders with different vertices are pulled together. */
static void test_seam(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = load(
        context, 0.01, 0.0, "auto",
        PAIR(GRID_SHEET("'name': 'a', ", "1, 1", "6, 6", "'area_density': 0.3", STRAIN("1000")),
             GRID_SHEET("", "1, 1", "7, 9", "'translate': [1.05, 0, 0], 'area_density': 0.3",
                        PAIR(STRAIN("1000"),
                             "{'type': 'attachment', 'to': 'a', 'length': 0, 'stiffness': "
                             "100, 'damping': 0.05, 'vertices': {'box': {'minimum': [0.5, "
                             "-1, -1], 'maximum': [0.6, 1, 1]}}}"))));
    const pdyn_batch *seam = &sim->objective.batch[2]->view;
    assert_int_equal(seam->elements, 9);
    for (int e = 0; e < 9; e++) assert_true(fabs(vec3_length(seam->u + 3 * e)) < 1e-15);
    for (int n = 0; n < 500; n++) test_step(sim);
    for (int e = 0; e < 9; e++) {
        double gap[3] = {0};
        for (int k = 4 * e; k < 4 * e + 4; k++)
            vec3_add(gap, seam->coefficient[k], sim->x + 3 * seam->column[k]);
        assert_true(vec3_length(gap) < 1e-3);
    }
    test_close(sim);
}

static void test_memory(void **state) {
    (void)state;
    char text[4096], head[512];
    snprintf(head, sizeof head, settings, 0.01, -9.81, "auto");
    snprintf(text, sizeof text, "{%s, 'bodies': [%s]}", head, hanging);
    test_failing_scene(text);
}

/* Two balls of 1 kg on a spring of 10 N/m, without gravity, stretched by `stretch`, m: the largest
 * kinetic energy in the first and in the last second of 10 s. */
static void oscillate(double stretch, double damping, double highest[2]) {
    static const char pair[] =
        "{'duration': 10, 'frame_interval': 10, 'gravity': [0, 0, 0], 'time_step': {'fixed': "
        "0.01}, 'bodies': ["
        "{'name': 'a', 'rigid': {'sphere': {'center': [-0.35, 0, 0], 'radius': 0.05}, 'mass': 1}},"
        "{'name': 'b', 'rigid': {'sphere': {'center': [0.35, 0, 0], 'radius': 0.05}, 'mass': 1},"
        " 'constraints': [{'type': 'attachment', 'to': 'a', 'vertices': {'box': {"
        "   'minimum': [0.2995, -0.002, -0.002], 'maximum': [0.3005, 0.002, 0.002]}},"
        "  'stiffness': 10, 'length': %.17g, 'damping': %g}]}]}";
    char text[1024];
    snprintf(text, sizeof text, pair, 1.0 - stretch / 0.6, damping);
    pdyn_sim *sim = test_open(text);
    highest[0] = highest[1] = 0.0;
    for (int step = 0; step < 1000; step++) {
        pdyn_step_info info = test_step(sim);
        if (step < 100) highest[0] = fmax(highest[0], info.kinetic_energy);
        if (step >= 900) highest[1] = fmax(highest[1], info.kinetic_energy);
    }
    test_close(sim);
}

/* The default tolerance, a tenth of the weight, is more than the force of a spring that is hardly
 * stretched. A step that repeated the forces of the last one would leave it as it is, or feed the
 * oscillation. BDF2 takes 2 % of its energy in 7 periods of 1.4 s. */
static void test_oscillation_long(void **state) {
    (void)state;
    static const double stretch[] = {0.2, 0.05, 0.01};
    for (int k = 0; k < 3; k++) {
        double highest[2], energy = 0.5 * 10.0 * stretch[k] * stretch[k];
        oscillate(stretch[k], 0.0, highest);
        assert_true(fabs(highest[0] / energy - 1.0) < 0.01);
        assert_true(fabs(highest[1] / energy - 1.0) < 0.05);
    }
}

/* A force of 10 N/m x 5 ms times the rate of stretch takes the part 1 - exp(-0.1 t) of the energy;
 * the first and the last of the largest kinetic energies are 6.5 periods apart. */
static void test_damped_oscillation_long(void **state) {
    (void)state;
    double highest[2], time = 6.5 * 2.0 * acos(-1.0) / sqrt(20.0);
    oscillate(0.05, 0.005, highest);
    print_message("%g, expected %g\n", highest[1] / highest[0], exp(-0.1 * time));
    assert_true(fabs(highest[1] / highest[0] / exp(-0.1 * time) - 1.0) < 0.02);
}

/* ---- a rigid weight -------------------------------------------------------------------------- */

enum { STRAP_STEPS = 40 };

/* A rigid box of 0.13 kg hangs on a strap of 2 g by a stiff attachment; a drop may fall
 * beside it. Returns outer iterations a step; y: heights of the first vertex of the box. */
static double hang_on_strap(const char *solver, bool drop, double y[STRAP_STEPS]) {
    static const char hanging_box[] = PAIR(
        "{'name': 'weight', 'velocity': [0, 0, 0.2], 'rigid': {'box': {'minimum': [-0.02, -0.54, "
        "-0.02], 'maximum': [0.02, -0.5, 0.02]}, 'density': 2000}}",
        GRID_SHEET("'name': 'strap', ", "0.02, 0.5", "3, 26",
                   "'rotate': [90, 0, 0], 'translate': [0, -0.25, 0], 'area_density': 0.2",
                   SPRINGS("20000") ", " BENDING(
                       "1e-3") ", {'type': 'pin', 'vertices': {'box': {'minimum': [-1, -0.0001, "
                               "-1], 'maximum': [1, 1, 1]}}}, {'type': 'attachment', 'to': "
                               "'weight', 'vertices': {'box': {'minimum': [-1, -0.5001, -1], "
                               "'maximum': [1, -0.4999, 1]}}, 'stiffness': 1e6}"));
    static const char falling[] = ", " FLUID_BOX("'name': 'drop', ", "0.01", "0.2, 0, 0",
                                                 "0.26, 0.06, 0.06", ", 'stiffness': 1e4");
    static const char frame[] =
        "{'duration': 1, 'frame_interval': 1, 'time_step': {'fixed': 0.005}, 'solver': {'type': "
        "'%s', 'tolerance': 1e-4, 'outer_iterations': 100}, 'bodies': [%s%s]}";
    char text[4096];
    snprintf(text, sizeof text, frame, solver, hanging_box, drop ? falling : "");
    pdyn_sim *sim = test_open(text);
    int outer = 0;
    for (int k = 0; k < STRAP_STEPS; k++) {
        pdyn_step_info info = test_step(sim);
        assert_true(info.step_residual <= 1e-4);
        outer += info.outer_iterations;
        y[k] = sim->x[1];
    }
    test_close(sim);
    return (double)outer / STRAP_STEPS;
}

/* In the coarse space of `hybrid` and `dual` the box stands still. Their motion is that of `cg`.
 * With vertices of the box as C-points, 100 iterations would not solve a step. */
static void test_rigid_weight(void **state) {
    (void)state;
    double expected[STRAP_STEPS], y[STRAP_STEPS];
    double most = 2.0 * hang_on_strap("cg", false, expected);
    for (int drop = 0; drop < 2; drop++) {
        assert_true(hang_on_strap(drop ? "dual" : "hybrid", drop, y) < most);
        for (int k = 0; k < STRAP_STEPS; k++) assert_true(fabs(y[k] - expected[k]) < 1e-5);
    }
}

/* ---- strings --------------------------------------------------------------------------------- */

static const double gravity = 9.81; /* m/s^2 */

struct string {
    const char *velocity; /* of the load, m/s */
    double stiffness, length, damping;
    double pin; /* N/m, of the pins of the roof */
};

/* The four vertices of a sheet without stiffness, the load of 1 kg, each on a string to the roof,
 * 0.5 m above; a probe of the tension of all four. Beside them falls a drop, if the solver is one
 * of fluids. */
static pdyn_sim *load_strings(pdyn_context *context, double h, const char *solver,
                              const struct string *s) {
    static const char tied[] = PAIR(
        GRID_SHEET("'name': 'load', 'velocity': [%s], ", "0.3, 0.3", "2, 2",
                   "'translate': [0, -0.5, 0], 'area_density': 11.111111111111111",
                   "{'type': 'attachment', 'to': 'roof', 'vertices': {'all': true}, 'stiffness': "
                   "%g, 'length': %g, 'damping': %g, 'tension_only': true}"),
        GRID_SHEET("'name': 'roof', ", "1, 1", "4, 4", "'area_density': 1",
                   "{'type': 'pin', 'vertices': {'all': true}, 'stiffness': %g}"));
    static const char drop[] = ", " FLUID_BOX("'name': 'drop', ", "0.01", "2, 0, 0",
                                              "2.06, 0.06, 0.06", ", 'stiffness': 1e4");
    char bodies[2048];
    snprintf(bodies, sizeof bodies, tied, s->velocity, s->stiffness, s->length, s->damping, s->pin);
    if (!strcmp(solver, "dual")) strcat(bodies, drop);
    strcat(bodies, "], 'probes': [{'name': 'line', 'body': 'load', 'constraint': 'attachment'}");
    return load(context, h, -gravity, solver, bodies);
}

static const char *const all_solvers[] = {"auto", "cg", "hybrid", "cholesky", "dual"};
enum { SOLVERS = sizeof all_solvers / sizeof *all_solvers };

/* A load on slack strings, whose damping does nothing, flies with the bits of one on strings
 * without stiffness; without pins, the roof falls, too. */
static void test_slack(void **state) {
    (void)state;
    for (int n = 0; n < 2 * SOLVERS; n++) {
        const struct string slack = {"1, 2, 0.5", 1e6, 2.5, 0.05, n % 2 ? 1e8 : 0.0};
        const struct string none = {"1, 2, 0.5", 0.0, 2.5, 0.0, slack.pin};
        if (test_lacks_solver(all_solvers[n / 2])) continue;
        pdyn_sim *sim = load_strings(test_context(2), 0.01, all_solvers[n / 2], &slack);
        pdyn_sim *free = load_strings(test_context(1), 0.01, all_solvers[n / 2], &none);
        for (int step = 0; step < 25; step++) {
            test_step(sim), test_step(free);
            assert_memory_equal(sim->x, free->x, 12 * sizeof *sim->x);
        }
        test_close(sim);
        test_close(free);
    }
}

/* Strings without length are never slack: a seam of them takes the first step with the bits of one
 * of springs. The sheets of the seam lie on each other. */
static void test_seam_of_strings(void **state) {
    (void)state;
    static const char seam[] =
        PAIR(GRID_SHEET("", "1, 1", "4, 4", "'area_density': 1",
                        "{'type': 'attachment', 'to': 'roof', 'vertices': {'border': true}, "
                        "'stiffness': 1000, 'length': 0, 'damping': 0.01, 'tension_only': %s}"),
             GRID_SHEET("'name': 'roof', ", "1, 1", "4, 4", "'area_density': 1",
                        "{'type': 'pin', 'vertices': {'all': true}, 'stiffness': 1e4}"));
    pdyn_sim *sim[2];
    for (int k = 0; k < 2; k++) {
        char bodies[2048];
        snprintf(bodies, sizeof bodies, seam, k ? "true" : "false");
        sim[k] = load(test_context(1), 0.01, -gravity, "auto", bodies);
        test_step(sim[k]);
    }
    assert_memory_equal(sim[0]->x, sim[1]->x, 96 * sizeof *sim[0]->x);
    test_close(sim[0]);
    test_close(sim[1]);
}

/* N, the force of all strings on the load in the last step. */
static double tension(const pdyn_sim *sim) { return vec3_length(pdyn_get_probe(sim, 0).value); }

/* A load that falls until its strings are taut hangs at the length of each string plus m g / k. Its
 * probe reads m g, upwards. */
static void test_hanging(void **state) {
    (void)state;
    const struct string s = {"0, 0, 0", 1000.0, 1.2, 0.05, 1e10};
    for (int n = 0; n < SOLVERS; n++) {
        if (test_lacks_solver(all_solvers[n])) continue;
        pdyn_sim *sim = load_strings(test_context(1), 0.01, all_solvers[n], &s);
        pdyn_parameter_info p = pdyn_get_parameter(sim, 0, 3);
        assert_string_equal(p.name, "tension_only");
        assert_true(p.value == 1.0 && !p.changeable);
        for (int step = 0; step < 300; step++) test_step(sim);
        for (int i = 0; i < 4; i++) {
            double due = 0.6 + sim->body[0].mass[i] * gravity / s.stiffness;
            assert_true(fabs(-sim->x[3 * i + 1] / due - 1.0) < 1e-8);
        }
        pdyn_probe_info line = pdyn_get_probe(sim, 0);
        assert_string_equal(line.column[1], "line.force_y_N");
        assert_true(fabs(line.value[1] / gravity - 1.0) < 1e-7);
        assert_true(fabs(tension(sim) / gravity - 1.0) < 1e-7);
        test_close(sim);
    }
}

/* Swung with v^2 = 3.5 g l, a load leaves its circle at 120 degrees, flies as high as 27/16 l above
 * its start, and is caught again. Springs would keep it on the circle, up to 7/4 l. */
static void test_circle(void **state) {
    (void)state;
    const struct string s = {"4.1432475, 0, 0", 1e5, 1.0, 0.0, 1e10};
    pdyn_sim *sim = load_strings(test_context(1), 0.001, "auto", &s);
    double highest = -1.0;
    for (int step = 0; step < 600; step++) {
        test_step(sim);
        highest = fmax(highest, sim->x[1] + 0.5);
    }
    print_message("%g, expected %g\n", highest / 0.5, 27.0 / 16.0);
    assert_true(fabs(highest / 0.5 - 27.0 / 16.0) < 0.005);
    test_close(sim);
}

/* A load that swings up to 60 degrees and back has 3 m g - 2 m g cos 60 = 2 m g in its strings at
 * the lowest point, and m g cos 60 where it turns. */
static void test_tension(void **state) {
    (void)state;
    const struct string s = {"2.2147234, 0, 0", 1e5, 1.0, 0.002, 1e10};
    pdyn_sim *sim = load_strings(test_context(1), 0.001, "auto", &s);
    double least = INFINITY, most = 0.0;
    for (int step = 0; step < 1000; step++) {
        test_step(sim);
        if (step < 100) continue; /* the strings stretch, and come to rest */
        least = fmin(least, tension(sim));
        most = fmax(most, tension(sim));
    }
    print_message("%g, expected 0.5; %g, expected 2\n", least / gravity, most / gravity);
    assert_true(fabs(least / gravity - 0.5) < 0.005 && fabs(most / gravity - 2.0) < 0.02);
    test_close(sim);
}

static double energy_of(const pdyn_step_info *info) {
    return info->kinetic_energy + info->potential_energy + info->constraint_energy;
}

/* s, of a pendulum of 0.5 m with this speed at its lowest point, by the arithmetic-geometric mean.
 */
static double exact_period(double speed) {
    double squares = 0.25 * speed * speed / (gravity * 0.5), a = 1.0, b = sqrt(1.0 - squares);
    for (int k = 0; k < 6; k++) {
        double mean = 0.5 * (a + b);
        b = sqrt(a * b), a = mean;
    }
    return 2.0 * acos(-1.0) * sqrt(0.5 / gravity) / a;
}

/* A pendulum of 2 J keeps its period and its energy, however stiff the string is: the force that
 * holds it on its circle is no impact. */
static void test_pendulum(void **state) {
    (void)state;
    static const double stiffness[] = {1e4, 1e6, 1e8};
    const double h = 0.005, middle = -0.15, due = exact_period(2.0); /* x of the first vertex, m */
    for (int k = 0; k < 3; k++) {
        const struct string s = {"2, 0, 0", stiffness[k], 1.0, 0.0, 1e12};
        pdyn_sim *sim = load_strings(test_context(1), h, "auto", &s);
        pdyn_step_info info = test_step(sim);
        double first = energy_of(&info), x = sim->x[0], period = 0.0;
        for (int found = 0; found < 3; x = sim->x[0]) {
            info = test_step(sim);
            if (!(x < middle && sim->x[0] >= middle)) continue;
            found++;
            period = (sim->time - h * (sim->x[0] - middle) / (sim->x[0] - x)) / found;
        }
        print_message("%g s, exact %g s; %g J lost\n", period, due, first - energy_of(&info));
        assert_true(fabs(period / due - 1.0) < 1e-3);
        assert_true(fabs(first - energy_of(&info)) < 0.01);
        test_close(sim);
    }
}

/* Up to 1 s: the height to which the load rises when its strings are taut, over that of its fall,
 * m.
 */
static double rebound(pdyn_sim *sim, double fall) {
    double taut = sim->x[1] - fall, highest = 0.0;
    bool fallen = false;
    while (sim->time < 1.0) {
        test_step(sim);
        fallen |= sim->x[1] < taut;
        if (fallen) highest = fmax(highest, (sim->x[1] - taut) / fall);
    }
    assert_true(fallen);
    return highest;
}

/* Strings too stiff for the step stop a fall, in whichever part of a step they become taut. */
static void test_snap(void **state) {
    (void)state;
    double highest = 0.0;
    for (int k = 0; k < 8; k++) {
        const struct string s = {"0, 0, 0", k % 2 ? 1e8 : 1e6, 1.3 + 0.01 * k, k < 4 ? 0.0 : 0.05,
                                 1e12};
        pdyn_sim *sim = load_strings(test_context(1), 0.005, "auto", &s);
        highest = fmax(highest, rebound(sim, 0.5 * (s.length - 1.0)));
        test_close(sim);
    }
    print_message("%g\n", highest);
    assert_true(highest < 0.1);
}

/* A rigid box of 1 kg on one string to the middle of its top: there its mass is that of the string,
 * although it is less across, in the mean over all directions half of it. */
static void test_snap_of_box(void **state) {
    (void)state;
    static const char tied[] = PAIR(
        "{'name': 'load', 'rigid': {'box': {'minimum': [-0.05, -0.7, -0.05], 'maximum': [0.05, "
        "-0.5, 0.05]}, 'mass': 1}}",
        GRID_SHEET("", "1, 1", "3, 3", "'area_density': 1",
                   "{'type': 'pin', 'vertices': {'all': true}, 'stiffness': 1e12}, {'type': "
                   "'attachment', 'to': 'load', 'vertices': {'vertices': [4]}, 'stiffness': %g, "
                   "'length': %g, 'tension_only': true}"));
    double highest = 0.0;
    for (int k = 0; k < 8; k++) {
        char bodies[1024];
        double length = 1.3 + 0.01 * k;
        snprintf(bodies, sizeof bodies, tied, k % 2 ? 1e8 : 1e7, length);
        pdyn_sim *sim = load(test_context(1), 0.005, -gravity, "auto", bodies);
        highest = fmax(highest, rebound(sim, 0.5 * (length - 1.0)));
        test_close(sim);
    }
    print_message("%g\n", highest);
    assert_true(highest < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_weight),
                                       cmocka_unit_test(test_momentum),
                                       cmocka_unit_test(test_seam),
                                       cmocka_unit_test(test_memory),
                                       cmocka_unit_test(test_oscillation_long),
                                       cmocka_unit_test(test_damped_oscillation_long),
                                       cmocka_unit_test(test_rigid_weight),
                                       cmocka_unit_test(test_slack),
                                       cmocka_unit_test(test_seam_of_strings),
                                       cmocka_unit_test(test_hanging),
                                       cmocka_unit_test(test_circle),
                                       cmocka_unit_test(test_tension),
                                       cmocka_unit_test(test_pendulum),
                                       cmocka_unit_test(test_snap),
                                       cmocka_unit_test(test_snap_of_box)};
    return cmocka_run_group_tests_name("attachment", tests, NULL, NULL);
}
