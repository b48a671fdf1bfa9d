/* Inlets and outlets: mass, positions and density of emitted particles, flow against resistance,
 * removal and reuse. */
#include "sim/live_particles.h"
#include "support.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>

/* A jet of 8 x 4 particles of spacing 0.025 m. time: first keys of the scene; more: further keys of
 * the inlet; budget: further keys of the particles. */
#define JET(time, more, budget)                                                                    \
    "{" time                                                                                       \
    ", 'bodies': [{'name': 'water', 'particles': {'radius': 0.0125, 'inlets': [{'rectangle': "     \
    "{'center': [0, 0.5, 0], 'size': [0.2, 0.1]}, 'direction': [3, 0, 4], 'speed': 2" more         \
    "}]" budget "}, 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}]"
#define STEPS "'duration': 1, 'frame_interval': 0.003, 'time_step': {'fixed': 0.003}"
#define FLOAT ", 'gravity': [0, 0, 0]"
enum { LAYER = 8 * 4 };
static const double spacing = 0.025, direction[3] = {0.6, 0.0, 0.8};

/* A stream that falls out of an outlet, 4 x 4 particles per layer. */
static const char *const fountain =
    "{'duration': 2, 'frame_interval': 0.005, 'time_step': {'fixed': 0.005}, 'bodies': [{'name': "
    "'water', 'particles': {'radius': 0.0125, 'inlets': [{'rectangle': {'center': [0, 0.2, 0], "
    "'size': [0.1, 0.1]}, 'direction': [0, -1, 0], 'speed': 2}], 'budget': 400}, 'constraints': "
    "[{'type': 'fluid', 'stiffness': 1e5}]}], 'outlets': [{'box': {'minimum': [-1, 0, -1], "
    "'maximum': [1, 1, 1]}, 'outside': true}]}";

/* At the end of each step, the layers of the stream are present up to one spacing behind the
 * opening, each at its place. */
static void test_emitted_mass(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(JET(STEPS FLOAT, "", "") "}");
    const pdyn_state s = pdyn_get_state(sim);
    double particle = 1000.0 * spacing * spacing * spacing;
    for (int n = 1; n <= 60; n++) {
        pdyn_step_info info = test_step(sim);
        double mass = 0.0, expected = 1000.0 * 0.2 * 0.1 * 2.0 * info.time;
        for (int i = 0; i < s.particles; i++) {
            if (!s.live[i]) continue;
            double layers = (2.0 * info.time - vec3_dot(s.x + 3 * i, direction)) / spacing;
            assert_true(fabs(2.0 * layers - round(2.0 * layers)) < 2e-3); /* staggered */
            assert_true(fabs(s.x[3 * i + 1] - 0.5) < 0.05);
            mass += s.mass[i];
        }
        assert_true(mass >= expected + LAYER * particle - 1e-9);
        assert_true(mass <= expected + 2 * LAYER * particle + 1e-9);
        assert_true(fabs(mass - info.particles * particle) < 1e-9);
        assert_true(fabs(vec3_dot(info.momentum, direction) - 2.0 * mass) < 1e-6 * mass);
        assert_true(info.density_error_max < 0.005);
    }
    test_close(sim);
}

/* Layers enter at their exact position within the step, the second one a spacing behind the first;
 * every second particle of a disc lies in its plane, the others half a spacing in front. */
static void test_place(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{" STEPS FLOAT ", 'bodies': [{'particles': {'radius': 0.0125, 'inlets': [{'disc': "
        "{'center': [1, 2, 3], 'radius': 0.06}, 'direction': [0, -2, 0], 'up': "
        "[1, 5, 1], 'speed': 3, 'start': 0.0095, 'duration': 0.01}]}}]}");
    const pdyn_state s = pdyn_get_state(sim);
    int staggered = 0;
    const int in_disc = 21; /* lattice points with i^2 + j^2 <= 2.4^2 */
    assert_int_equal(s.particles, 2 * in_disc);
    for (int n = 0; n < 3; n++) assert_int_equal(test_step(sim).particles, 0);
    assert_int_equal(test_step(sim).particles, 2 * in_disc);
    for (int i = 0; i < 2 * in_disc; i++) {
        double *x = sim->x + 3 * i, back = i < in_disc ? 0.0 : spacing;
        double place = 2.0 + back - 3.0 * (0.012 - 0.0095), front = (place - x[1]) / spacing;
        assert_true(fabs(front) < 1e-9 || fabs(front - 0.5) < 1e-9);
        staggered += front > 0.25;
        assert_true(hypot(x[0] - 1.0, x[2] - 3.0) <= 0.06);
        double up = (x[0] - 1.0 + x[2] - 3.0) * sqrt(0.5) / spacing;
        assert_true(fabs(up - round(up)) < 1e-9);
        assert_true(sim->v[3 * i + 1] == -3.0);
    }
    assert_int_equal(staggered, 2 * 12);
    for (int n = 0; n < 10; n++) test_step(sim);
    assert_int_equal(sim->live->emitted, 2 * in_disc);
    test_close(sim);
}

/* Four of a layer's eight columns lie inside a block of water: no particle of the first two layers
 * enters there. */
static void test_blocked(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{" STEPS FLOAT
        ", 'bodies': [{'particles': {'radius': 0.0125, 'fill': [{'box': {'minimum': [0, "
        "0, 0], 'maximum': [0.1, 0.1, 0.1]}}], 'inlets': [{'rectangle': {'center': [0.05, "
        "0.05, 0.05], 'size': [0.2, 0.1]}, 'direction': [0, 0, 1], 'speed': 1}]}}]}");
    assert_int_equal(pdyn_get_body(sim, 0).live, 4 * 4 * 4 + LAYER);
    test_close(sim);
}

/* A layer of 8 x 8 particles, 0.2 m wide, that flows along x. */
#define BESIDE(solid, inlet)                                                                       \
    "{" STEPS FLOAT ", 'solids': [" solid "], 'bodies': [{'particles': {'radius': 0.0125, "        \
    "'inlets': [{'rectangle': {'center': [0, 0, 0], 'size': [0.2, 0.2]}, 'direction': [1, 0, 0], " \
    "'speed': 1" inlet "}]}, 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}]}"
#define CHANNEL(bottom, more)                                                                      \
    "{'box': {'minimum': [0, " bottom                                                              \
    ", -0.1], 'maximum': [1, 0.2, 0.1]}, 'open': ['+x', '+y']" more "}"
#define PLACED(key) ", 'pivot': [0, 0, 0], 'motion': [{'time': 0, " key "}]"
#define MOVING      ", 'motion': [{'time': 0}, {'time': 1, 'translate': [0, 0, 1]}]"

/* Particles that solids cover do not enter; those that solids cover at the start of a motion do. */
static void test_covered(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int left_out, covered;
    } cases[] = {
        /* an opening that fits its channel, half a spacing too low, two too low, above the floor */
        {BESIDE(CHANNEL("-0.1", ""), ""), 0, 0},
        {BESIDE(CHANNEL("-0.0875", ""), ""), 8, 0},
        {BESIDE(CHANNEL("-0.05", ""), ""), 16, 0},
        {BESIDE(CHANNEL("-0.5", ""), ""), 0, 0},
        /* poses of one key, of the inlet and of both; motions of the channel and of the inlet */
        {BESIDE(CHANNEL("0.0", ""), PLACED("'translate': [0, 0.05, 0]")), 16, 0},
        {BESIDE(CHANNEL("-0.1", PLACED("'rotate': [0, 0, 20]")), PLACED("'rotate': [0, 0, 20]")), 0,
         0},
        {BESIDE(CHANNEL("-0.05", MOVING), ""), 0, 16},
        {BESIDE(CHANNEL("-0.05", ""), MOVING), 0, 16},
        /* obstacles: a block below, a ball in a corner, a plane across the upper half */
        {BESIDE("{'box': {'minimum': [-1, -1, -1], 'maximum': [1, -0.05, 1]}}", ""), 16, 0},
        {BESIDE("{'sphere': {'center': [0.05, 0.1, 0.1], 'radius': 0.05}}", ""), 3, 0},
        {BESIDE("{'plane': {'center': [0.025, 0.5, 0], 'normal': [1, 0, 0], 'size': 1}}", ""), 32,
         0},
        /* an opening in the wall of a closed solid, and one within: the solid holds the fluid */
        {BESIDE("{'capsule': {'from': [0.5, 0, 0], 'to': [0.5, 0.01, 0], 'radius': 0.51}}", ""), 0,
         0},
        {BESIDE("{'sphere': {'center': [0, 0, 0], 'radius': 0.2}}", ""), 0, 0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        pdyn_sim *sim = test_open(cases[k].text);
        const struct scene_inlet *inlet = &sim->scene.body[0].inlet[0];
        assert_int_equal(inlet->left_out.count, cases[k].left_out);
        assert_int_equal(inlet->covered.count, cases[k].covered);
        assert_int_equal(pdyn_get_body(sim, 0).live, 2 * (64 - cases[k].left_out));
        test_close(sim);
    }
}

/* Half of an opening reaches into the floor of a channel: the flow stays calm. */
static void test_flow_beside_a_floor(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(BESIDE(CHANNEL("0.0", ""), ""));
    for (int n = 0; n < 60; n++) {
        pdyn_step_info info = test_step(sim);
        double mass = 1000.0 * pow(spacing, 3) * info.particles;
        assert_true(info.density_error_max < 0.01);
        assert_true(info.kinetic_energy < 0.6 * mass); /* at 1 m/s */
    }
    test_close(sim);
}

/* A free jet is nowhere above rest density. */
static void test_free_jet(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(JET("'duration': 1, 'time_step': {'maximum': 0.004}", "", "") "}");
    while (pdyn_time(sim) < 0.3) assert_true(test_step(sim).density_error_max < 0.005);
    test_close(sim);
}

/* Particles that are not live have no mass, energy, neighbours or constraints. */
static void test_before_the_start(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(JET(STEPS, ", 'start': 0.5", "") "}");
    uint64_t hash = pdyn_state_hash(sim);
    for (int n = 0; n < 5; n++) {
        pdyn_step_info info = test_step(sim);
        assert_true(info.particles == 0 && info.step_residual == 0.0);
        assert_true(info.kinetic_energy == 0.0 && info.potential_energy == 0.0);
        assert_true(info.constraint_energy == 0.0 && info.density_error_mean == 0.0);
    }
    assert_true(pdyn_state_hash(sim) == hash);
    assert_int_equal(pdyn_get_body(sim, 0).live, 0);
    test_close(sim);
}

/* Removed particles return to the budget: four times the budget flows through, without allocations
 * and with the same bits for any number of threads. */
static void test_outlet(void **state) {
    (void)state;
    uint64_t hash[3];
    for (int threads = 1; threads <= 3; threads++) {
        struct counter counter;
        long before = 0;
        pdyn_context *context = test_counting_context(threads, &counter);
        pdyn_sim *sim = test_load(context, fountain);
        const pdyn_state s = pdyn_get_state(sim);
        for (int n = 0; n < 250; n++) {
            pdyn_step_info info = test_step(sim);
            if (n == 100) before = counter.calls;
            assert_int_equal(info.particles, sim->live->emitted - sim->live->removed);
            assert_true(n < 100 || (info.particles > 60 && info.particles < 200));
            for (int i = 0; i < s.particles; i++) assert_true(!s.live[i] || s.x[3 * i + 1] >= 0.0);
        }
        assert_int_equal(counter.calls, before);
        assert_true(sim->live->removed > 1400 && !sim->live->inlet[0].closed);
        hash[threads - 1] = pdyn_state_hash(sim);
        test_close(sim);
        assert_true(hash[threads - 1] == hash[0]);
    }
}

/* Two blocks of water at -3 and -5 m/s. */
#define BLOCKS                                                                                     \
    "'radius': 0.0125, 'fill': [{'box': {'minimum': [0.2, 0, 0], 'maximum': [0.3, 0.1, 0.1]}, "    \
    "'velocity': [-3, 0, 0]}, {'box': {'minimum': [0.3, 0.013, 0], 'maximum': [0.4, 0.1, 0.1]}, "  \
    "'velocity': [-5, 0, 0]}]"

/* Water leaves under pressure, with BDF2: particles that are not live have no pressure and stay at
 * the origin. */
static void test_removed(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{" STEPS FLOAT ", 'bodies': [{'particles': {" BLOCKS "}, 'constraints': [{'type': "
        "'fluid', 'stiffness': 1e5}]}], 'outlets': [{'box': {'minimum': [-1, -1, -1], 'maximum': "
        "[0.25, 1, 1]}}]}");
    const pdyn_state s = pdyn_get_state(sim);
    for (int n = 0; n < 20; n++) {
        test_step(sim);
        for (int i = 0; i < s.particles; i++)
            assert_true(s.live[i] || (s.pressure[i] == 0.0 && vec3_length(s.x + 3 * i) == 0.0 &&
                                      vec3_length(s.v + 3 * i) == 0.0));
    }
    assert_true(sim->live->removed > s.particles / 2);
    test_close(sim);
}

/* A budget of three layers: then the inlet closes, with one warning. */
static void test_exhausted(void **state) {
    (void)state;
    struct warnings warnings = {"budget of 100 particles", 0};
    pdyn_context *context = test_warned_context(1, &warnings);
    pdyn_sim *sim = test_load(context, JET(STEPS FLOAT, "", ", 'budget': 100") "}");
    assert_int_equal(pdyn_get_state(sim).particles, 100);
    for (int n = 0; n < 40; n++) test_step(sim);
    assert_int_equal(pdyn_get_body(sim, 0).live, 3 * LAYER);
    assert_int_equal(warnings.count, 1);
    test_close(sim);
}

/* An unfinished solve gives no momentum to particles that are not live. */
static void test_momentum(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{" STEPS FLOAT
        ", 'solver': {'outer_iterations': 1, 'linear_iterations': 3}, 'bodies': [{'particles': "
        "{" BLOCKS ", 'inlets': [{'disc': {'center': [9, 9, 9], 'radius': "
        "0.01}, 'direction': [1, 0, 0], 'speed': 1, 'start': 0.9}]}, 'constraints': [{'type': "
        "'fluid', 'stiffness': 1e5}]}]}");
    double first[3] = {0}, touched = 0.0;
    const pdyn_state s = pdyn_get_state(sim);
    for (int i = 0; i < s.particles; i++) vec3_add(first, s.mass[i], s.v + 3 * i);
    for (int n = 0; n < 20; n++) {
        pdyn_step_info info = test_step(sim);
        touched = fmax(touched, info.constraint_energy);
        assert_true(vec3_distance(info.momentum, first) < 1e-12 * vec3_length(first));
    }
    assert_true(touched > 1e-6);
    test_close(sim);
}

/* A scene of scenes/ with one override. */
static pdyn_sim *load_shipped(pdyn_context *context, const char *name, const char *set) {
    char path[1024];
    pdyn_sim *sim = NULL;
    snprintf(path, sizeof path, "%s/scenes/%s.json", getenv("PROJDYN_SOURCE_ROOT"), name);
    assert_int_equal(pdyn_load(context, path, &set, 1, &sim), PDYN_OK);
    return sim;
}

/* With implicit Euler, the scene of a jet satisfies the claim of Weiler et al. 2016 for w = 1e6: in
 * steps of 6 ms and more, no particle's density error exceeds 0.01 %. Particles go beyond the walls
 * only by the compliance of the walls' samples. */
static void test_stiff_jet(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = load_shipped(context, "inlet", "time_step.integrator=euler");
    const pdyn_state s = pdyn_get_state(sim);
    const double high[3] = {0.8, 0.5, 0.4}, beyond = 0.003;
    for (int n = 0; n < 100; n++) { /* the jet has reached the opposite wall */
        pdyn_step_info info = test_step(sim);
        assert_true(info.h > 6e-3);
        assert_true(info.density_error_max < 1e-4);
        for (int k = 0; k < 3 * s.particles; k++)
            assert_true(!s.live[k / 3] || particle_is_pushed(sim, k / 3) ||
                        (s.x[k] > -beyond && s.x[k] < high[k % 3] + beyond));
    }
    test_close(sim);
}

/* A disc of 21 particles of spacing 0.02 m in the floor of a tank. fill, constraints: of the water;
 * high, open: of the tank. */
#define NOZZLE(speed, fill, constraints, high, open)                                               \
    "{'duration': 2, 'time_step': {'maximum': 0.004}, 'bodies': [{'name': 'water', 'particles': "  \
    "{'radius': 0.01, 'inlets': [{'disc': {'center': [0, 0, 0], 'radius': 0.05}, 'direction': "    \
    "[0, 1, 0], 'speed': " speed "}]" fill "}, 'constraints': [{'type': 'fluid', 'sound_speed': "  \
    "30}" constraints "]}], 'solids': [{'name': 'tank', 'box': {'minimum': [-0.16, 0, -0.16], "    \
    "'maximum': [0.16, " high ", 0.16]}" open "}]}"
#define TOP_OPEN ", 'open': ['+y']"

/* Runs the nozzle for some time; checks that fluid does not burst, and that steps are solved. */
static pdyn_step_info run_nozzle(pdyn_sim *sim, double seconds) {
    pdyn_step_info info = {0};
    while (pdyn_time(sim) < seconds) {
        info = test_step(sim);
        assert_true(info.step_residual < 0.1 && info.leaked == 0);
        assert_true(info.kinetic_energy < 10.0);
    }
    return info;
}

/* The flow is the area times the speed in free space, under water, and in front of a block that is
 * held together by its viscosity. Of the first two layers, those that begin in a fluid may be its
 * particles. */
static void test_flow(void **state) {
    (void)state;
    static const char *const scene[] = {
        NOZZLE("1", "", "", "0.4", TOP_OPEN),
        NOZZLE("1",
               ", 'fill': [{'box': {'minimum': [-0.16, 0, -0.16], 'maximum': [0.16, 0.12, 0.16]}}]",
               "", "0.4", TOP_OPEN),
        NOZZLE("1", ", 'fill': [{'box': {'minimum': [-0.1, 0, -0.1], 'maximum': [0.1, 0.2, 0.1]}}]",
               ", {'type': 'viscosity', 'viscosity': 1000}", "0.4", TOP_OPEN)};
    const int layers = 2 + (int)(0.31 / 0.02);
    for (int k = 0; k < 3; k++) {
        pdyn_sim *sim = test_open(scene[k]);
        pdyn_body_info water = pdyn_get_body(sim, 0);
        run_nozzle(sim, 0.31);
        int entered = pdyn_get_body(sim, 0).live - water.live;
        assert_int_equal(entered, 21 * (layers - 2));
        test_close(sim);
    }
}

/* A closed box is filled, not beyond: then nothing enters any more, with a warning. */
/* The length of the first step, s, of a pond whose bottom is at y. */
static double first_step(double y) {
    char text[2048];
    pdyn_step_info info;
    snprintf(text, sizeof text,
             SCENE("'duration': 1, 'frame_interval': 1, 'time_step': {'cfl': 10, 'maximum': 0.05}, "
                   "'solver': {'type': 'dual'}",
                   "{'particles': {'radius': 0.02, 'budget': 50, 'fill': [{'box': {'minimum': "
                   "[0, %g, 0], 'maximum': [0.4, %g, 0.4]}}], 'inlets': [{'disc': {'center': "
                   "[0.2, %g, 0.2], 'radius': 0.1}, 'direction': [0, -1, 0], 'speed': 0.1, "
                   "'start': 5}]}, 'constraints': [{'type': 'fluid', 'sound_speed': 20}]}",
                   ""),
             y, y + 0.2, y + 0.4);
    pdyn_sim *sim = test_open(text);
    assert_int_equal(pdyn_step(sim, &info), PDYN_OK);
    test_close(sim);
    return info.h;
}

/* Particles that are not live rest at the origin, however far it is from the water. */
static void test_far_from_origin(void **state) {
    (void)state;
    double near = first_step(0.0), far = first_step(1000.0);
    print_message("first steps %g and %g s\n", near, far);
    assert_true(near > 1e-3 && near < 0.01 && fabs(far / near - 1.0) < 1e-6);
}

static void test_full(void **state) {
    (void)state;
    struct warnings warnings = {"particles of inlet 0 did not enter", 0};
    pdyn_context *context = test_warned_context(1, &warnings);
    pdyn_sim *sim = test_load(context, NOZZLE("1", "", "", "0.06", ""));
    const int room = 16 * 16 * 3;
    pdyn_step_info info = run_nozzle(sim, 1.2);
    assert_in_range(pdyn_get_body(sim, 0).live, (int)(0.95 * room), (int)(1.15 * room));
    assert_true(info.density_error_mean < 0.1);
    assert_int_equal(warnings.count, 1);
    test_close(sim);
}

/* Mean squared distance from the axis of the particles in the stretch of a jet that falls from y =
 * 0.4 with 0.8 m/s, over that in its disc. */
static double jet_area(double low, double high) {
    pdyn_sim *sim = test_open(
        "{'duration': 1, 'frame_interval': 0.01, 'bodies': [{'particles': {'radius': "
        "0.006, 'inlets': [{'disc': {'center': [0, 0.4, 0], 'radius': 0.03}, 'direction': "
        "[0, -1, 0], 'speed': 0.8}]}, 'constraints': [{'type': 'fluid'}]}]}");
    double sum = 0.0, at_start = 0.0;
    int count = 0;
    while (pdyn_time(sim) < 0.3) test_step(sim);
    const struct point_list *layer = &sim->scene.body[0].inlet[0].layer;
    for (int k = 0; k < layer->count; k++)
        at_start += (pow(layer->x[3 * k], 2) + pow(layer->x[3 * k + 2], 2)) / layer->count;
    for (int i = 0; i < sim->objective.particles; i++) {
        const double *x = sim->x + 3 * i;
        if (!sim->live->live[i] || x[1] < low || x[1] > high) continue;
        sum += x[0] * x[0] + x[2] * x[2], count++;
    }
    assert_true(count > 20);
    test_close(sim);
    return sum / count / at_start;
}

/* A falling jet narrows as its speed w grows: its area is 0.8 m/s / w of that of the disc, here 0.5
 * and 0.37 where it has fallen by 0.1 and 0.2 m. Without suction it would keep its width. */
static void test_falling_jet(void **state) {
    (void)state;
    assert_true(fabs(jet_area(0.28, 0.32) - 0.5) < 0.1);
    assert_true(fabs(jet_area(0.18, 0.22) - 0.37) < 0.1);
}

/* A pushed layer moves exactly as the inlet says while water presses against it. */
static void test_pushed(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(NOZZLE("0.3",
                         ", 'fill': [{'box': {'minimum': [-0.16, 0.02, -0.16], 'maximum': "
                         "[0.16, 0.3, 0.16]}}]",
                         "", "0.4", TOP_OPEN));
    int pushed = 0;
    for (int n = 0; n < 60; n++) {
        double time = test_step(sim).time;
        for (int i = 0; i < sim->objective.particles; i++) {
            const double *x = sim->x + 3 * i, *v = sim->v + 3 * i;
            if (!particle_is_pushed(sim, i)) continue;
            double layer = (0.3 * time - x[1]) / 0.02;
            assert_true(v[0] == 0.0 && v[1] == 0.3 && v[2] == 0.0);
            assert_true(x[1] > -0.0201 && x[1] < 0.0201);
            assert_true(fabs(2.0 * layer - round(2.0 * layer)) < 1e-9);
            pushed++;
        }
    }
    assert_true(pushed > 60 * 21);
    test_close(sim);
}

static pdyn_sim *load_paste(pdyn_context *context) {
    return test_load(
        context,
        NOZZLE("1",
               ", 'fill': [{'box': {'minimum': [-0.1, 0, -0.1], 'maximum': [0.1, 0.06, 0.1]}}]",
               ", {'type': 'viscosity', 'viscosity': 100}", "0.4", TOP_OPEN));
}

/* The inlet is at the flag. */
static pdyn_sim *load_stream(pdyn_context *context) {
    return load_shipped(context, "flag_in_stream",
                        "bodies.water.particles.inlets[0].rectangle.center[0]=0.1");
}

/* A state that is saved after any step, whether a layer has just come or gone or not, is followed
 * by the same steps. */
static void test_saved(void **state) {
    (void)state;
    static pdyn_sim *(*const load[])(pdyn_context *) = {load_paste, load_stream};
    pdyn_context *context = test_context(1);
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = load[k](context);
        for (int n = 0; n < 15; n++) {
            pdyn_sim *resumed = load[k](context);
            assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
            assert_int_equal(pdyn_restore(resumed, "state"), PDYN_OK);
            test_step(sim), test_step(resumed);
            assert_true(pdyn_state_hash(sim) == pdyn_state_hash(resumed));
            pdyn_free(resumed);
        }
        pdyn_free(sim);
    }
    test_remove_file("state");
    pdyn_destroy(context);
}

static void test_failing_allocator(void **state) {
    (void)state;
    test_failing_scene(fountain);
    test_failing_scene(BESIDE("{'sphere': {'center': [0.05, 0.1, 0.1], 'radius': 0.05}}", ""));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_emitted_mass),
        cmocka_unit_test(test_place),
        cmocka_unit_test(test_blocked),
        cmocka_unit_test(test_covered),
        cmocka_unit_test(test_flow_beside_a_floor),
        cmocka_unit_test(test_free_jet),
        cmocka_unit_test(test_before_the_start),
        cmocka_unit_test(test_outlet),
        cmocka_unit_test(test_removed),
        cmocka_unit_test(test_exhausted),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_stiff_jet),
        cmocka_unit_test(test_flow),
        cmocka_unit_test(test_full),
        cmocka_unit_test(test_far_from_origin),
        cmocka_unit_test(test_falling_jet),
        cmocka_unit_test(test_pushed),
        cmocka_unit_test(test_saved),
        cmocka_unit_test(test_failing_allocator),
    };
    return cmocka_run_group_tests_name("inlet", tests, NULL, NULL);
}
