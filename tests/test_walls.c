/* Fast water against walls at the CFL limit: none passes a wall or a plate; bodies on the other
 * side of a wall; the same bits for any number of threads; allocation failures. */
#include "support.h"

#include "projdyn/probe.h"

/* A box of water of this velocity, in a scene with these solids. */
#define SPLASH(velocity, minimum, maximum, solids)                                                 \
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005, 'cfl': 1}, "     \
          "'solver': {'tolerance': 0.5, 'outer_iterations': 10}",                                  \
          FLUID_BOX("'name': 'water', 'velocity': " velocity ", ", "0.0125", minimum, maximum,     \
                    ", 'stiffness': 1e6"),                                                         \
          ", 'solids': [" solids "]")

/* 20 m/s into a corner */
static const char *jet = SPLASH("[-11.5, -11.5, -11.5]", "0.3, 0.3, 0.3", "0.5, 0.5, 0.5",
                                "{'box': {'minimum': [0, 0, 0], 'maximum': [0.6, 0.6, 0.6]}}");

/* The largest distance of a particle's centre beyond the faces of the box [0, size]^3, m. */
static double beyond(const pdyn_state *s, double size) {
    double most = -INFINITY;
    for (int k = 0; k < 3 * s->particles; k++) most = fmax(most, fmax(-s->x[k], s->x[k] - size));
    return most;
}

static void test_corner(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(jet);
    const pdyn_state s = pdyn_get_state(sim);
    double most = -INFINITY;
    while (pdyn_time(sim) < 0.06) {
        test_step(sim);
        most = fmax(most, beyond(&s, 0.6));
    }
    assert_true(most > -0.0125); /* the water has arrived */
    if (most > 0.0) fail_msg("a particle is %g m behind a wall", most);
    test_close(sim);
}

/* A plate without thickness across a shaft. */
static const char *plate = "v 0 0.2 0\nv 0.3 0.2 0\nv 0.3 0.2 0.3\nv 0 0.2 0.3\nf 1 2 3\nf 1 3 4\n";
static const char *shaft =
    SPLASH("[0, -10, 0]", "0.05, 0.3, 0.05", "0.25, 0.5, 0.25",
           "{'box': {'minimum': [0, 0, 0], 'maximum': [0.3, 0.8, 0.3]}}, {'mesh': 'plate.obj'}");

/* Water falls on the plate with 10 m/s and stays above. */
static void test_plate(void **state) {
    (void)state;
    test_write_text("plate.obj", plate);
    pdyn_sim *sim = test_open(shaft);
    test_remove_file("plate.obj");
    const pdyn_state s = pdyn_get_state(sim);
    double lowest = INFINITY;
    while (pdyn_time(sim) < 0.1) {
        test_step(sim);
        for (int i = 0; i < s.particles; i++) lowest = fmin(lowest, s.x[3 * i + 1]);
    }
    assert_true(lowest < 0.23);
    if (lowest < 0.2) fail_msg("a particle is %g m below the plate", 0.2 - lowest);
    test_close(sim);
}

/* The points of a plane are a lattice that reaches its corners; their areas sum to that of it. */
static void test_plane(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        "'duration': 1", FLUID_BOX("'name': 'water', ", "0.02", "0, 0, 0", "0.2, 0.2, 0.2", ""),
        ", 'solids': [{'plane': {'center': [0, -1, 0], 'normal': [0, 2, 0], "
        "'size': 2}}]"));
    int side = (int)ceil(2.0 / (0.8 * 0.43 * 0.04)) + 1;
    const struct boundary_points *points = &sim->boundary;
    struct box box = box_around(points->at.x, points->at.count);
    double area = 0.0;
    assert_int_equal(points->at.count, side * side);
    for (int k = 0; k < points->at.count; k++) {
        area += points->point[k].area;
        for (int a = 0; a < 3; a++) assert_true(points->point[k].normal[a] == (a == 1));
    }
    assert_true(fabs(area - 4.0) < 1e-9);
    for (int a = 0; a < 3; a++) {
        assert_true(fabs(box.min[a] + 1.0) < 1e-12);
        assert_true(fabs(box.max[a] - (a == 1 ? -1.0 : 1.0)) < 1e-12);
    }
    test_close(sim);
}

/* A box with two open sides, far thinner than its points are apart. */
static void test_thin_box(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        "'duration': 1", FLUID_BOX("'name': 'water', ", "0.02", "0.1, 0, 0", "0.3, 0.2, 0.2", ""),
        ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [1e-13, 1, 1]}, "
        "'open': ['-x', '+x']}]"));
    const struct boundary_points *points = &sim->boundary;
    for (int k = 0; k < 3 * points->at.count; k++) assert_true(fabs(points->at.x[k]) < 1.1);
    test_close(sim);
}

#define PRESSED(more)                                                                              \
    SCENE("'duration': 1, 'time_step': {'maximum': 0.004}",                                        \
          FLUID_BOX("'name': 'water', 'velocity': [1, 0, 0.5], ", "0.02", "0, 0, 0",               \
                    "0.24, 0.2, 0.24", ""),                                                        \
          ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.4, 0.4, 0.24]}" more "}]")

/* Water at rest in a tank, 8 x 8 x 8 particles, and a second body. more: keys of the tank */
#define BESIDE(body, more)                                                                         \
    SCENE("'duration': 1, 'time_step': {'maximum': 0.004}",                                        \
          PAIR(FLUID_BOX("'name': 'water', ", "0.01", "0, 0, 0", "0.16, 0.16, 0.16", ""), body),   \
          ", 'solids': [{" more "}]")

/* An upright sheet at x, m; turn: "0, 0, 90" for one along the wall x = 0 */
#define SHEET(x, turn)                                                                             \
    GRID_SHEET("'name': 'curtain', ", "0.3, 0.3", "13, 13",                                        \
               "'rotate': [" turn "], 'translate': [" x ", 0.1, 0.08], 'area_density': 0.3",       \
               PAIR(SPRINGS("100"), PINS("'all': true")))

/* 0.7 spacings outside of the wall x = 0 */
#define CURTAIN(more) BESIDE(SHEET("-0.014", "0, 0, 90"), more)

/* The second tank lies on its side at rest, 1 m away, and its motion brings it to the water. */
#define UPRIGHT "'box': {'minimum': [0, 0, 0], 'maximum': [0.16, 0.3, 0.16]}, 'open': ['+y']"
#define TURNED                                                                                     \
    "'box': {'minimum': [1, 0, -0.14], 'maximum': [1.16, 0.16, 0.16]}, 'open': ['-z'], "           \
    "'pivot': [1.08, 0.08, 0.08], 'motion': [{'time': 0, 'translate': [-1, 0, 0], 'rotate': [90, " \
    "0, 0]}]"

static uint64_t hash_of(int threads, const char *scene) {
    pdyn_context *context = test_context(threads);
    pdyn_sim *sim = test_load(context, scene);
    for (int n = 0; n < 20; n++) test_step(sim);
    uint64_t hash = pdyn_state_hash(sim);
    test_close(sim);
    return hash;
}

static void check_threads(const char *scene) {
    uint64_t hash = hash_of(1, scene);
    assert_true(hash_of(2, scene) == hash);
    assert_true(hash_of(3, scene) == hash);
    assert_true(hash_of(8, scene) == hash);
}

static void test_threads(void **state) {
    (void)state;
    check_threads(PRESSED(""));
    check_threads(BESIDE(SHEET("0", "90, 0, 0"), TURNED));
}

static void test_failing_allocator(void **state) {
    (void)state;
    test_failing_scene(PRESSED(""));
    test_failing_scene(PRESSED(", 'motion': [{'time': 0}, {'time': 1, 'translate': [1, 0, 0]}]"));
    test_failing_scene(CURTAIN(UPRIGHT));
}

/* Water at rest, 20 x 8 x 8 particles, with solids; `less` particles are left out. */
static void check_rest(const char *scene, int less) {
    pdyn_sim *sim = test_open(scene);
    const pdyn_state s = pdyn_get_state(sim);
    assert_int_equal(s.particles, 20 * 8 * 8 - less);
    double fastest = 0.0;
    for (int n = 0; n < 5; n++) {
        test_step(sim);
        for (int k = 0; k < 3 * s.particles; k++) fastest = fmax(fastest, fabs(s.v[k]));
    }
    if (fastest > 0.3) fail_msg("water at rest moves with %g m/s", fastest);
    test_close(sim);
}

#define REST(solids)                                                                               \
    SCENE("'duration': 1, 'time_step': {'maximum': 0.004}",                                        \
          FLUID_BOX("'name': 'water', ", "0.01", "0, 0, 0", "0.4, 0.16, 0.16", ""),                \
          ", 'solids': [" solids "]")
#define TANK(end) "{'box': {'minimum': [0, 0, 0], 'maximum': [" end ", 0.3, 0.16]}, 'open': ['+y']}"
#define BLOCK     "'box': {'minimum': [0.16, 0.04, 0.04], 'maximum': [0.24, 0.1, 0.12]}"
#define HELD      ", 'motion': [{'time': 0, 'rotate': [0, 0, 180]}]"

/* A closed box is an obstacle where fluid surrounds it: 4 x 3 x 4 particles are inside. */
static void test_block(void **state) {
    (void)state;
    check_rest(REST(TANK("0.4") ", {" BLOCK "}"), 48);
    check_rest(REST(TANK("0.4") ", {" BLOCK HELD "}"), 48);
}

/* Of water on both sides of a wall, that closer than 2.5 spacings behind it is left out. */
static void test_outside(void **state) {
    (void)state;
    check_rest(REST(TANK("0.342")), 3 * 8 * 8);
    check_rest(
        REST("{'box': {'minimum': [0, 0, 0], 'maximum': [0.342, 0.16, 0.3]}, 'open': ['+z'], "
             "'pivot': [0.17, 0.08, 0.08], 'motion': [{'time': 0, 'rotate': [-90, 0, 0]}]}"),
        3 * 8 * 8);
}

/* The points of a wall lie behind its face: a sheet between both hides none from the water. */
static void check_curtain(const char *scene) {
    pdyn_sim *sim = test_open(scene);
    const pdyn_state s = pdyn_get_state(sim);
    double lowest = INFINITY;
    while (pdyn_time(sim) < 0.1) test_step(sim);
    for (int i = 0; i < 512; i++) lowest = fmin(lowest, s.x[3 * i]);
    if (lowest < 0.005) fail_msg("a particle is at %g m from the wall", lowest);
    test_close(sim);
}

static void test_curtain(void **state) {
    (void)state;
    check_curtain(CURTAIN(UPRIGHT));
    check_curtain(CURTAIN(TURNED));
}

/* The largest force of the water on the second body in 20 steps, N. */
static double push_on(const char *scene) {
    pdyn_sim *sim = test_open(scene);
    double most = 0.0;
    for (int n = 0; n < 20; n++) {
        double force[3], moment[3];
        test_step(sim);
        assert_int_equal(pdyn_body_load_by(sim, 1, PDYN_LOAD_FLUID, force, moment), PDYN_OK);
        for (int a = 0; a < 3; a++) most = fmax(most, fabs(force[a]));
    }
    test_close(sim);
    return most;
}

#define RIGID(shape)                                                                               \
    "{'name': 'body', 'rigid': {" shape                                                            \
    ", 'density': 500}, 'constraints': [" PINS("'all': true") "]}"
#define BOX(minimum, maximum) RIGID("'box': {'minimum': [" minimum "], 'maximum': [" maximum "]}")
#define CRATE                 BOX("-0.103, 0.02, 0.03", "-0.003, 0.12, 0.13")
#define ON_GROUND(x)          BOX("-0.1, 0, 0.03", x ", 0.1, 0.13")
#define BELOW                 BOX("0.03, -0.1, 0.03", "0.13, 0, 0.13")
#define SOFT                                                                                       \
    "{'name': 'body', 'volume': {'grid': {'size': [0.1, 0.1, 0.1], 'cells': [5, 5, 5]}, "          \
    "'translate': [-0.05, 0.07, 0.08], 'density': 500}, 'constraints': [{'type': 'tet', "          \
    "'stiffness': 1e5}, " PINS("'all': true") "]}"
#define GROUND "}, {'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 2}"
#define BALL   RIGID("'sphere': {'center': [-0.063, 0.06, 0.08], 'radius': 0.06}")

/* Water pushes nothing that stands 0.15 spacings outside of a wall, and no crate, cube or ball that
 * touches it from there, up to rounding. It pushes sheets that lie on the wall, and all that is
 * inside of the tank. */
static void test_push(void **state) {
    (void)state;
    const char *outside[] = {BESIDE(CRATE, UPRIGHT),
                             BESIDE(CRATE, TURNED),
                             BESIDE(BALL, UPRIGHT),
                             BESIDE(SHEET("-0.003", "0, 0, 90"), UPRIGHT),
                             BESIDE(ON_GROUND("-0.003"), UPRIGHT GROUND),
                             BESIDE(ON_GROUND("0"), UPRIGHT GROUND),
                             BESIDE(ON_GROUND("0"), TURNED),
                             BESIDE(ON_GROUND("1e-4"), UPRIGHT),
                             BESIDE(BELOW, UPRIGHT),
                             BESIDE(SOFT, UPRIGHT)};
    const char *inside[] = {BESIDE(SHEET("0", "0, 0, 90"), UPRIGHT),
                            BESIDE(SHEET("-1e-4", "0, 0, 90"), UPRIGHT),
                            BESIDE(SHEET("-1e-4", "0, 0, 90"), TURNED),
                            BESIDE(SHEET("0.003", "0, 0, 90"), UPRIGHT),
                            BESIDE(BOX("0, 0, 0", "0.06, 0.06, 0.06"), UPRIGHT),
                            BESIDE(BOX("-1e-4, 0.04, 0.04", "0.06, 0.1, 0.1"), UPRIGHT)};
    for (int k = 0; k < 10; k++) {
        double push = push_on(outside[k]);
        if (push > 0.0) fail_msg("body %d outside feels %g N", k, push);
    }
    for (int k = 0; k < 6; k++) {
        double push = push_on(inside[k]);
        if (push < 5.0) fail_msg("body %d inside feels %g N", k, push);
    }
}

static bool is_listed(const pdyn_neighbours *l, int i, int j) {
    for (int s = l->start[i]; s < l->end[i]; s++)
        if (l->index[s] == j) return true;
    return false;
}

/* A sheet passes the wall x = 0. Its samples outside are in no list, nor have they one; of all
 * others, a pair is in both lists. */
static void test_pairs(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(BESIDE(SHEET("0", "90, 0, 0"), UPRIGHT));
    const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
    const double *x = sim->objective.samples->x;
    int first = sim->objective.particles, pairs = 0;
    for (int i = 0; i < 512; i++)
        for (int s = l->surface_start[i]; s < l->boundary_start[i]; s++, pairs++) {
            assert_true(is_listed(l, l->index[s], i));
            assert_true(x[3 * l->index[s]] > -0.0003);
        }
    assert_true(pairs > 1000);
    for (int j = first; j < l->particles; j++) pairs -= l->end[j] - l->start[j];
    assert_int_equal(pairs, 0);
    test_close(sim);
}

/* A sheet that lies on the wall x = 0, up to rounding, hides the points of the wall; a crate that
 * stands on its other side hides none. */
static void test_wall_points(void **state) {
    (void)state;
    const char *scenes[] = {BESIDE(SHEET("1e-12", "0, 0, 90"), UPRIGHT),
                            BESIDE(ON_GROUND("1e-12"), UPRIGHT)};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(scenes[k]);
        const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
        int seen = 0;
        for (int i = 0; i < 512; i++)
            for (int s = l->boundary_start[i]; s < l->end[i]; s++) {
                const double *at = sim->boundary.at.x + 3 * (l->index[s] - l->particles);
                bool middle = at[1] > 0.03 && at[1] < 0.1 && at[2] > 0.04 && at[2] < 0.12;
                seen += at[0] < 0.0 && middle;
            }
        if (k ? seen < 100 : seen > 0) fail_msg("scene %d: %d pairs with the wall", k, seen);
        test_close(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plane),   cmocka_unit_test(test_thin_box),
        cmocka_unit_test(test_corner),  cmocka_unit_test(test_plate),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_failing_allocator),
        cmocka_unit_test(test_block),   cmocka_unit_test(test_outside),
        cmocka_unit_test(test_curtain), cmocka_unit_test(test_push),
        cmocka_unit_test(test_pairs),   cmocka_unit_test(test_wall_points),
    };
    return cmocka_run_group_tests_name("walls", tests, test_enter_directory, test_leave_directory);
}
