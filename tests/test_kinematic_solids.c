/* Moving solids: positions and speeds of their points, and their effect on water. */
#include "support.h"

#include "projdyn/scene.h"
#include "projdyn/vec3.h"

#include <stdlib.h>
#include <string.h>

/* ---- points ---------------------------------------------------------------------------------- */

static const char *turning = SCENE(
    "'duration': 1, 'boundary': 'points'",
    FLUID_BOX("", "0.05", "0, 0, 0", "0.2, 0.2, 0.2",
              "") ", " FLUID_BOX("", "0.05", "1.4, 1.9, 2.9", "1.6, 2.1, 3.1", ""),
    ", 'solids': [{'box': {'minimum': [1, 1, 1], 'maximum': [2, 3, 4]}, 'pivot': [1, 2, 3], "
    "'motion': [{'time': 1}, {'time': 3, 'rotate': [0, 0, 720], 'translate': [2, 0, 0]}, {'time': "
    "4, 'rotate': [90, 90, 720], 'translate': [2, 0, 1]}]}, {'box': {'minimum': [0, 0, 0], "
    "'maximum': [0.2, 0.2, 0.2]}}]");

/* Asserts the position of the last boundary point at a time: rotated from r about the pivot, then
 * translated. */
static void assert_carried(pdyn_sim *sim, double time, const double turned[3],
                           const double moved[3]) {
    static const double pivot[3] = {1.0, 2.0, 3.0};
    const pdyn_state s = pdyn_get_state(sim);
    kinematic_move(sim, time);
    for (int a = 0; a < 3; a++)
        assert_true(fabs(s.boundary_x[3 * (s.boundary - 1) + a] - pivot[a] - turned[a] - moved[a]) <
                    1e-12);
}

static void test_carry(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(turning);
    const pdyn_state s = pdyn_get_state(sim);
    double x = 1.06, y = 1.06,
           z = 1.06; /* the corner of maximum coordinates, 0.6 spacings out, from the pivot */
    assert_true(s.moving > 0 && s.moving < s.boundary); /* the other solid does not move */
    assert_carried(sim, 0.0, (double[]){x, y, z}, (double[]){0, 0, 0});
    assert_carried(sim, 1.25, (double[]){-y, x, z}, (double[]){0.25, 0, 0});
    assert_carried(sim, 1.5, (double[]){-x, -y, z}, (double[]){0.5, 0, 0});
    assert_carried(sim, 2.25, (double[]){-y, x, z},
                   (double[]){1.25, 0, 0}); /* in the second turn */
    assert_carried(sim, 3.0, (double[]){x, y, z}, (double[]){2, 0, 0});
    assert_carried(sim, 9.0, (double[]){y, -z, -x}, (double[]){2, 0, 1});
    test_close(sim);
}

/* Places of the first layer are kept in a scene with a constraint that reads them, for all moving
 * points. */
static void test_layer(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    for (int with = 0; with < 2; with++) {
        pdyn_scene *scene = NULL;
        pdyn_sim *sim = NULL;
        assert_int_equal(pdyn_scene_parse(context, quoted(turning), "turning", &scene), PDYN_OK);
        if (with)
            assert_int_equal(pdyn_scene_set(scene, "bodies.1.constraints.no_slip.viscosity", "1"),
                             PDYN_OK);
        assert_int_equal(pdyn_scene_load(scene, &sim), PDYN_OK);
        const struct kinematic_solids *moving = &sim->kinematic;
        assert_true(moving->points > 0);
        assert_int_equal(moving->layer.count, with ? moving->points : 0);
        assert_int_equal(moving->rest_layer.count, moving->layer.count);
        assert_true(!neighbours_view(sim->objective.neighbours)->layer_x == !with);
        pdyn_free(sim);
        pdyn_scene_free(scene);
    }
    pdyn_destroy(context);
}

/* The mesh of a solid is where its pose at the current time puts it; that of a solid at rest stays.
 */
static void test_vertices(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(turning);
    double before[2][24], after[2][24];
    for (int s = 0; s < 2; s++) {
        assert_int_equal(pdyn_solid_vertices(sim, s, NULL), 8);
        assert_int_equal(pdyn_solid_vertices(sim, s, before[s]), 8);
    }
    assert_int_equal(pdyn_solid_vertices(sim, 2, NULL), 0);
    assert_int_equal(pdyn_solid_vertices(sim, -1, NULL), 0);
    sim->time = 3.0; /* two turns later, 2 m further */
    for (int s = 0; s < 2; s++) pdyn_solid_vertices(sim, s, after[s]);
    for (int i = 0; i < 24; i++)
        assert_true(fabs(after[0][i] - before[0][i] - (i % 3 ? 0.0 : 2.0)) < 1e-12);
    assert_memory_equal(before[1], after[1], sizeof before[1]);
    test_close(sim);
}

/* The triangles of a box of 1 m x 1 m x 1 m without its top face outwards: the volume that they
 * enclose with the origin, which lies in the plane of the top, is that of the box. */
static void test_triangles(void **state) {
    (void)state;
    static const char tank[] = SCENE(
        "'duration': 1", GRID_SHEET("", "0.2, 0.2", "3, 3", "'area_density': 1", SPRINGS("10")),
        ", 'solids': [{'box': {'minimum': [-0.5, -1, -0.5], 'maximum': [0.5, 0, 0.5]}, "
        "'open': ['+y']}]");
    pdyn_sim *sim = test_open(tank);
    double x[24], volume = 0.0;
    int triangle[30];
    assert_int_equal(pdyn_solid_vertices(sim, 0, x), 8);
    assert_int_equal(pdyn_solid_triangles(sim, 0, NULL), 10);
    assert_int_equal(pdyn_solid_triangles(sim, 0, triangle), 10);
    assert_int_equal(pdyn_solid_triangles(sim, 1, triangle), 0);
    for (int t = 0; t < 10; t++) {
        double normal[3];
        vec3_cross(normal, x + 3 * triangle[3 * t], x + 3 * triangle[3 * t + 1]);
        volume += vec3_dot(normal, x + 3 * triangle[3 * t + 2]) / 6.0;
    }
    assert_true(fabs(volume - 1.0) < 1e-12);
    test_close(sim);
}

/* Largest speed of a point by central differences, m/s. */
static double measured_speed(pdyn_sim *sim, double *before, double time) {
    const pdyn_state s = pdyn_get_state(sim);
    double speed = 0.0, dt = 1e-6;
    kinematic_move(sim, time - dt);
    memcpy(before, s.boundary_x, 3 * (size_t)s.boundary * sizeof *before);
    kinematic_move(sim, time + dt);
    for (int i = 0; i < s.boundary; i++)
        speed = fmax(speed, vec3_distance(before + 3 * i, s.boundary_x + 3 * i) / (2.0 * dt));
    return speed;
}

/* The largest speed is that of a corner of the box, which is a boundary point. */
static void test_speed(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(turning);
    double *before = malloc(3 * (size_t)sim->boundary.at.count * sizeof *before);
    assert_non_null(before);
    for (double t = 0.1; t < 5.0; t += 0.1) {
        if (fabs(t - round(t)) < 0.01) continue; /* the speed is discontinuous at a key */
        double expected = measured_speed(sim, before, t);
        assert_true(fabs(kinematic_speed(&sim->kinematic, t, t + 1e-9) - expected) <
                    1e-5 * (1.0 + expected));
    }
    assert_true(kinematic_speed(&sim->kinematic, 0.0, 1.0) == 0.0);
    assert_true(kinematic_speed(&sim->kinematic, 0.0, 1.001) > 10.0); /* the next key counts */
    assert_true(kinematic_speed(&sim->kinematic, 2.999, 3.1) > 10.0); /* so does the current one */
    free(before);
    test_close(sim);
}

/* ---- a tank that is carried ------------------------------------------------------------------ */

static pdyn_sim *pour(pdyn_context *context, double speed) {
    char text[2048];
    snprintf(text, sizeof text,
             "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.0025}, 'solver': "
             "{'tolerance': 1e-3, 'linear_tolerance': 1e-3}, 'bodies': [{'particles': {'radius': "
             "0.02, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.24, 0.16]}}]}, "
             "'velocity': [%g, 0, 0], 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}], "
             "'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.4, 0.5, 0.16]}, 'open': "
             "['+y'], 'motion': [{'time': 0}, {'time': 10, 'translate': [%g, 0, 0]}]}]}",
             speed, 10.0 * speed);
    return test_load(context, text);
}

/* Water in a tank that moves at constant speed behaves as in a tank at rest. */
static void test_carried_tank(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *resting = pour(context, 0.0), *carried = pour(context, 2.0);
    const pdyn_state a = pdyn_get_state(resting), b = pdyn_get_state(carried);
    double farthest = 0.0;
    while (pdyn_time(resting) < 0.3) test_step(resting), test_step(carried);
    for (int i = 0; i < a.particles; i++) {
        double shifted[3] = {b.x[3 * i] - 2.0 * pdyn_time(carried), b.x[3 * i + 1], b.x[3 * i + 2]};
        farthest = fmax(farthest, vec3_distance(a.x + 3 * i, shifted));
    }
    assert_true(farthest < 1e-4);
    pdyn_free(resting);
    pdyn_free(carried);
    pdyn_destroy(context);
}

/* ---- a paddle -------------------------------------------------------------------------------- */

enum { TURNS_PER_SECOND = 1 };
static const double length = 0.3, height = 0.3; /* of the paddle, which has no thickness, m */

static void write_paddle(void) {
    char text[256];
    double end = 0.5 * length;
    snprintf(text, sizeof text, "v %g 0.01 0\nv %g 0.01 0\nv %g %g 0\nv %g %g 0\nf 1 2 3 4\n", -end,
             end, end, height, -end, height);
    test_write_text("paddle.obj", text);
}

static pdyn_sim *stir(pdyn_context *context) {
    char text[2048];
    write_paddle();
    snprintf(text, sizeof text,
             "{'duration': 1, 'frame_interval': 0.05, 'time_step': {'maximum': 0.05}, 'solver': "
             "{'linear_tolerance': 0.1}, 'bodies': [{'particles': {'radius': 0.02, 'fill': "
             "[{'box': {'minimum': [-0.24, 0, -0.24], 'maximum': [0.24, 0.2, -0.04]}}, {'box': "
             "{'minimum': [-0.24, 0, 0.04], 'maximum': [0.24, 0.2, 0.24]}}]}, 'constraints': "
             "[{'type': 'fluid', 'stiffness': 1e5}]}], 'solids': [{'mesh': 'paddle.obj', 'motion': "
             "[{'time': 0}, {'time': 10, 'rotate': [0, %d, 0]}]}, {'box': {'minimum': [-0.24, 0, "
             "-0.24], 'maximum': [0.24, 0.5, 0.24]}, 'open': ['+y']}]}",
             3600 * TURNS_PER_SECOND);
    pdyn_sim *sim = test_load(context, text);
    test_remove_file("paddle.obj");
    return sim;
}

/* Coordinates of the particles relative to the paddle: along it, up, normal to it. */
static void see_from_paddle(const pdyn_sim *sim, double *seen) {
    const pdyn_state s = pdyn_get_state(sim);
    double angle = 2.0 * acos(-1.0) * TURNS_PER_SECOND * pdyn_time(sim);
    for (int i = 0; i < s.particles; i++) {
        const double *x = s.x + 3 * i;
        seen[3 * i] = cos(angle) * x[0] - sin(angle) * x[2];
        seen[3 * i + 1] = x[1];
        seen[3 * i + 2] = sin(angle) * x[0] + cos(angle) * x[2];
    }
}

/* True if a particle passed through the paddle at least a spacing away from its edges. */
static bool went_through(const double *before, const double *now) {
    double along = fmax(fabs(before[0]), fabs(now[0])), up = fmax(before[1], now[1]);
    return before[2] * now[2] < 0.0 && along < 0.5 * length - 0.04 && up < height - 0.04;
}

static void assert_in_tank(const pdyn_state *s, double slack) {
    for (int i = 0; i < s->particles; i++) {
        const double *x = s->x + 3 * i;
        if (fabs(x[0]) > 0.24 + slack || fabs(x[2]) > 0.24 + slack || x[1] < -slack)
            fail_msg("particle %d is at (%g, %g, %g)", i, x[0], x[1], x[2]);
    }
}

/* The paddle moves the water and lets none through; the tank loses none. */
static void test_paddle_long(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = stir(context);
    const pdyn_state s = pdyn_get_state(sim);
    size_t size = 3 * (size_t)s.particles * sizeof(double);
    double *before = malloc(size), *now = malloc(size), spin = 0.0;
    int through = 0;
    assert_true(before && now);
    while (pdyn_time(sim) < 1.5) {
        see_from_paddle(sim, before);
        pdyn_step_info info = test_step(sim);
        see_from_paddle(sim, now);
        assert_in_tank(&s, 0.01);
        for (int i = 0; i < s.particles; i++) through += went_through(before + 3 * i, now + 3 * i);
        double tip = 2.0 * acos(-1.0) * TURNS_PER_SECOND * 0.5 * length;
        assert_true(tip * info.h <= 0.02 * (1.0 + 1e-9)); /* one radius per step */
    }
    for (int i = 0; i < s.particles; i++)
        spin += (s.x[3 * i + 2] * s.v[3 * i] - s.x[3 * i] * s.v[3 * i + 2]) / s.particles;
    assert_int_equal(through, 0);
    assert_true(spin > 0.03); /* m^2/s; rotating with the paddle the water would have 0.24 */
    free(before), free(now);
    test_close(sim);
}

/* ---- a piston -------------------------------------------------------------------------------- */

/* Starts at full speed against water, the part of a spacing that `gap` says away from it. */
static void write_piston(double gap, char text[2048]) {
    snprintf(text, 2048,
             "{'duration': 0.02, 'frame_interval': 0.02, 'time_step': {'fixed': 0.002}, 'bodies': "
             "[{'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': "
             "[0.4, 0.1, 0.1]}}]}, 'constraints': [{'type': 'fluid'}]}], 'solids': [{'box': "
             "{'minimum': [-0.2, 0, 0], 'maximum': [0.4, 0.4, 0.1]}, 'open': ['+y']}, {'box': "
             "{'minimum': [-0.1, 0.001, 0], 'maximum': [%g, 0.3, 0.1]}, 'motion': [{'time': 0}, "
             "{'time': 0.1, 'translate': [0.5, 0, 0]}]}]}",
             -0.02 * gap);
}

/* It moves by half a spacing in a step, as far as the first layer is away from its face, and drives
 * that layer before it. */
static void test_piston_long(void **state) {
    (void)state;
    for (double gap = 0.0; gap < 0.9; gap += 0.2) {
        char text[2048];
        write_piston(gap, text);
        pdyn_sim *sim = test_open(text);
        const pdyn_state s = pdyn_get_state(sim);
        while (pdyn_time(sim) < 0.0199) assert_int_equal(test_step(sim).leaked, 0);
        for (int i = 0; i < s.particles; i++) assert_true(s.x[3 * i] > 0.1 - 0.02 * gap);
        test_close(sim);
    }
}

/* ---- promises of a step ---------------------------------------------------------------------- */

static void test_threads(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        pdyn_context *context = test_context(1 + 2 * k);
        pdyn_sim *sim = stir(context);
        for (int n = 0; n < 40; n++) test_step(sim);
        hash[k] = pdyn_state_hash(sim);
        test_close(sim);
    }
    assert_true(hash[0] == hash[1]);
}

static void test_no_allocation(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *context = test_counting_context(1, &counter);
    pdyn_sim *sim = stir(context);
    while (pdyn_time(sim) < 0.5) test_step(sim);
    long before = counter.calls;
    unsigned lists = neighbours_view(sim->objective.neighbours)->revision;
    for (int n = 0; n < 20; n++) test_step(sim);
    assert_int_equal(counter.calls, before);
    assert_true(neighbours_view(sim->objective.neighbours)->revision > lists);
    test_close(sim);
}

static void test_failing_allocator(void **state) {
    (void)state;
    char text[2048];
    write_piston(0.0, text);
    test_failing_scene(turning);
    test_failing_scene(text);
}

/* A failed step leaves the solids at their previous positions, too. */
static void test_divergence(void **state) {
    (void)state;
    static const char *const set[] = {"bodies.0.velocity=[1e6, 0, 0]", "time_step.fixed=1000",
                                      "frame_interval=1000", "solver.retries=0"};
    pdyn_sim *sim = test_open_with(turning, set, 4);
    const pdyn_state s = pdyn_get_state(sim);
    size_t size = 3 * (size_t)s.boundary * sizeof *s.boundary_x;
    double *before = malloc(size);
    assert_non_null(before);
    memcpy(before, s.boundary_x, size);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_DIVERGED);
    assert_memory_equal(before, s.boundary_x, size);
    free(before);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_carry),
        cmocka_unit_test(test_layer),
        cmocka_unit_test(test_vertices),
        cmocka_unit_test(test_triangles),
        cmocka_unit_test(test_speed),
        cmocka_unit_test(test_carried_tank),
        cmocka_unit_test(test_paddle_long),
        cmocka_unit_test(test_piston_long),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_no_allocation),
        cmocka_unit_test(test_failing_allocator),
        cmocka_unit_test(test_divergence),
    };
    return cmocka_run_group_tests_name("motion", tests, test_enter_directory, test_leave_directory);
}
