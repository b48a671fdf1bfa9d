/* Viscosity and no_slip: the stress of a shear, rigid rotation, momentum, flow between walls. */
#include "support.h"

#include "projdyn/scene.h"
#include "projdyn/vec3.h"

#include <string.h>

enum { MOST = 4096 };

static const double spacing = 0.01;

struct block { /* particles of a lattice */
    int count;
    double x[MOST][3], v[MOST][3];
};

static void add_block(struct block *b, int nx, int ny, int nz) {
    b->count = 0;
    for (int k = 0; k < nx * ny * nz; k++, b->count++) {
        const int cell[3] = {k % nx, k / nx % ny, k / nx / ny};
        const int size[3] = {nx, ny, nz};
        for (int a = 0; a < 3; a++) {
            b->x[k][a] = spacing * (cell[a] + 0.5 - 0.5 * size[a]);
            b->v[k][a] = 0.0;
        }
    }
}

static void set(pdyn_scene *scene, const char *path, const char *value) {
    if (pdyn_scene_set(scene, path, "%s", quoted(value)) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(NULL));
}

/* The block with viscosity mu, Pa s; more: keys and values, ends with NULL. */
static pdyn_sim *load(int threads, const struct block *b, const char *mu, const char *const *more) {
    pdyn_scene *scene;
    pdyn_sim *sim;
    assert_int_equal(pdyn_scene_create(test_context(threads), "viscosity", &scene), PDYN_OK);
    assert_int_equal(pdyn_scene_particles(scene, "p.ply", b->count, b->x[0], b->v[0]), PDYN_OK);
    set(scene, "duration", "1000");
    set(scene, "frame_interval", "1000");
    set(scene, "gravity", "[0, 0, 0]");
    set(scene, "solver", "{'tolerance': 1e-9, 'linear_tolerance': 1e-4}");
    set(scene, "bodies.honey.particles", "{'radius': 0.005, 'fill': [{'file': 'p.ply'}]}");
    set(scene, "bodies.honey.constraints.fluid", "{'sound_speed': 30, 'viscosity': 0}");
    set(scene, "bodies.honey.constraints.viscosity.viscosity", mu);
    for (; *more; more += 2) set(scene, more[0], more[1]);
    if (pdyn_scene_load(scene, &sim) != PDYN_OK) fail_msg("%s", pdyn_last_error(NULL));
    pdyn_scene_free(scene);
    return sim;
}

/* The power of the stress in a uniform shear inside a lattice is mu times the square of the shear
 * rate, along the axes of the lattice and along its diagonals. */
static void test_stress(void **state) {
    (void)state;
    static const double shear[2][9] = {{0, 1, 0, 0, 0, 0, 0, 0, 0},
                                       {0.5, 0, 0, 0, -0.5, 0, 0, 0, 0}};
    static const char *const more[] = {"time_step.fixed", "1e-4", NULL};
    static struct block b;
    add_block(&b, 9, 9, 9);
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = load(1, &b, "10", more);
        test_step(sim);
        struct batch *batch = sim->objective.batch[1];
        double power = 0.0;
        int centre = 4 + 9 * (4 + 9 * 4);
        for (int e = 0; e < batch->view.elements; e++) {
            const int *pair = batch->view.column + 2 * e;
            double u[3], rate = 0.0;
            if (pair[0] != centre && pair[1] != centre) continue;
            vec3_subtract(u, b.x[pair[0]], b.x[pair[1]]);
            for (int i = 0; i < 9; i++) rate += u[i / 3] * shear[k][i] * u[i % 3];
            rate /= vec3_length(u);
            power += 0.5 * batch->view.weight[e] * batch->view.h * rate * rate;
        }
        assert_true(fabs(power / (10.0 * pow(spacing, 3)) - 1.0) < 0.01);
        test_close(sim);
    }
}

struct sums {
    double linear[3], angular[3], radius, size;
};

static struct sums sums_of(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    struct sums sum = {0};
    for (int i = 0; i < s.particles; i++) {
        double moment[3];
        vec3_cross(moment, s.x + 3 * i, s.v + 3 * i);
        vec3_add(sum.linear, s.mass[i], s.v + 3 * i);
        vec3_add(sum.angular, s.mass[i], moment);
        sum.radius += hypot(s.x[3 * i], s.x[3 * i + 1]);
        sum.size += s.mass[i] * vec3_length(s.v + 3 * i);
    }
    return sum;
}

/* A block so viscous that it is rigid turns by 114 degrees: it keeps its size, its linear and its
 * angular momentum. The rotation that a step resolves badly makes it neither larger nor smaller. */
static void test_rotation(void **state) {
    (void)state;
    static const char *const more[][5] = {
        {"time_step", "{'fixed': 0.005}", NULL},
        {"time_step", "{'fixed': 0.005, 'integrator': 'euler'}", NULL}};
    static const double largest_loss[] = {5e-3, 0.1};
    static struct block b;
    for (int k = 0; k < 2; k++) {
        add_block(&b, 6, 6, 3);
        for (int i = 0; i < b.count; i++) {
            b.v[i][0] = 0.3 - 10.0 * b.x[i][1], b.v[i][1] = -0.2 + 10.0 * b.x[i][0];
            b.v[i][2] = 0.1;
        }
        pdyn_sim *sim = load(1, &b, "1e5", more[k]);
        struct sums before = sums_of(sim);
        for (int n = 0; n < 40; n++) test_step(sim);
        for (int i = 0; i < b.count; i++) /* relative to the centre */
            for (int a = 0; a < 3; a++) sim->x[3 * i + a] -= 0.2 * (double[]){0.3, -0.2, 0.1}[a];
        struct sums after = sums_of(sim);
        assert_true(vec3_distance(before.linear, after.linear) < 1e-12 * before.size);
        assert_true(fabs(after.radius / before.radius - 1.0) < 1e-3);
        double loss = 1.0 - after.angular[2] / before.angular[2];
        assert_true(fabs(loss) < largest_loss[k]);
        test_close(sim);
    }
}

/* Plane Couette flow between a wall at rest and one that moves: a linear profile, and the load
 * mu v / H per area on both walls, which acts on their faces. */
static void test_couette(void **state) {
    (void)state;
    enum { LAYERS = 6 };
    static const char *const more[] = {
        "time_step.fixed",
        "0.05",
        "bodies.honey.constraints.no_slip.viscosity",
        "10",
        "solids.low",
        "{'box': {'minimum': [-1, -0.03, -1], 'maximum': [1, 0.5, 1]}, 'open': ['+y', '+x', '-x', "
        "'+z', '-z']}",
        "solids.top",
        "{'box': {'minimum': [-1, -0.5, -1], 'maximum': [1, 0.03, 1]}, 'open': ['-y', '+x', '-x', "
        "'+z', '-z'], 'motion': [{'time': 0}, {'time': 100, 'translate': [0.01, 0, 0]}]}",
        NULL};
    static struct block b;
    const double speed = 1e-4, height = LAYERS * spacing;
    add_block(&b, 36, LAYERS, 6);
    pdyn_sim *sim = load(1, &b, "10", more);
    for (int n = 0; n < 20; n++) test_step(sim);
    for (int i = 0; i < b.count; i++) {
        double exact = speed * (b.x[i][1] / height + 0.5);
        if (fabs(b.x[i][0]) < 0.5 * height) assert_true(fabs(sim->v[3 * i] - exact) < 0.02 * speed);
    }
    double low[3], top[3], low_moment[3], top_moment[3],
        exact = 10.0 * speed / height * 36 * 6 * spacing * spacing;
    assert_int_equal(pdyn_solid_load(sim, 0, low, low_moment), PDYN_OK);
    assert_int_equal(pdyn_solid_load(sim, 1, top, top_moment), PDYN_OK);
    /* on the faces, the forces on the layers at half a spacing have twice this arm in excess */
    double arm = (low_moment[2] + top_moment[2]) / low[0];
    if (fabs(arm / spacing - 1.0) > 0.02) fail_msg("arm of %g m, spacing %g m", arm, spacing);
    assert_true(fabs(low[0] / -top[0] - 1.0) < 0.01);
    assert_true(fabs(low[0] / exact - 1.0) < 0.15); /* free sides: the outer layers pull less */
    test_close(sim);
}

/* A sheet in the middle of a block that is at rest takes the velocity of the block, and the block
 * gets the momentum that the sheet loses. */
static void test_sheet(void **state) {
    (void)state;
    static const char *const more[] = {
        "time_step.fixed",
        "0.001",
        "bodies.honey.constraints.no_slip.viscosity",
        "10",
        "bodies.sheet",
        "{'surface': {'grid': {'size': [0.06, 0.06], 'vertices': [7, 7]}, 'area_density': 1}, "
        "'velocity': [0.1, 0, 0]}",
        NULL};
    static struct block b;
    add_block(&b, 6, 6, 6);
    pdyn_sim *sim = load(1, &b, "10", more);
    struct sums before = sums_of(sim);
    for (int n = 0; n < 100; n++) test_step(sim);
    struct sums after = sums_of(sim);
    double mean = 0.0;
    for (int i = 0; i < 49; i++) mean += sim->v[3 * (sim->body[1].first + i)] / 49.0;
    assert_true(vec3_distance(before.linear, after.linear) < 1e-6 * before.size);
    assert_true(fabs(mean) < 0.03);
    test_close(sim);
}

/* Fluid in a box that turns comes to turn as fast as the box, with both kernels: the points of a
 * box, which lie a fifth of its half width outside of this one, move faster than its faces. */
static void test_turning_box(void **state) {
    static struct block b;
    const double turning = 0.5 * M_PI; /* 1/s */
    const char *more[] = {"kernel",
                          "cubic_spline",
                          "time_step.fixed",
                          "0.002",
                          "bodies.honey.constraints.no_slip.viscosity",
                          "10",
                          "solids.box",
                          "{'box': {'minimum': [-0.05, -0.03, -0.05], 'maximum': [0.05, 0.03, "
                          "0.05]}, 'motion': [{'time': 0}, {'time': 1, 'rotate': [0, 90, 0]}]}",
                          NULL};
    (void)state;
    add_block(&b, 10, 6, 10);
    for (int kernel = 0; kernel < 2; kernel++) {
        if (kernel) more[1] = "wendland";
        pdyn_sim *sim = load(1, &b, "10", more);
        double moment = 0.0, inertia = 0.0;
        for (int n = 0; n < 40; n++) test_step(sim);
        const pdyn_state s = pdyn_get_state(sim);
        for (int i = 0; i < s.particles; i++) {
            const double *x = s.x + 3 * i, *v = s.v + 3 * i;
            moment += x[2] * v[0] - x[0] * v[2], inertia += x[0] * x[0] + x[2] * x[2];
        }
        if (fabs(moment / inertia / turning - 1.0) > 0.01)
            fail_msg("%s: the fluid turns %.4f times as fast as its box", more[1],
                     moment / inertia / turning);
        test_close(sim);
    }
}

static const char *const stirred[] = {
    "time_step.fixed",
    "0.002",
    "gravity",
    "[0, -9.81, 0]",
    "bodies.honey.constraints.no_slip.viscosity",
    "10",
    "bodies.sheet",
    "{'surface': {'grid': {'size': [0.06, 0.06], 'vertices': [7, 7]}, 'area_density': 1}, "
    "'velocity': [0.1, 0, 0]}",
    "solids.tray",
    "{'box': {'minimum': [-0.04, -0.04, -0.04], 'maximum': [0.04, 0.1, 0.04]}, 'open': ['+y'], "
    "'motion': [{'time': 0}, {'time': 1, 'rotate': [0, 90, 0]}]}",
    NULL};

/* The state after some steps has the same bits for any number of threads, and after a restart from
 * a saved state. */
static void test_threads(void **state) {
    (void)state;
    static struct block b;
    uint64_t hash = 0;
    add_block(&b, 8, 6, 8);
    for (int threads = 1; threads <= 3; threads += 2) {
        pdyn_sim *sim = load(threads, &b, "10", stirred), *again = load(threads, &b, "10", stirred);
        for (int n = 0; n < 3; n++) test_step(sim);
        assert_int_equal(pdyn_save(sim, "state.pdyn"), PDYN_OK);
        assert_int_equal(pdyn_restore(again, "state.pdyn"), PDYN_OK);
        for (int n = 0; n < 3; n++) test_step(sim), test_step(again);
        assert_true(pdyn_state_hash(sim) == pdyn_state_hash(again));
        if (threads > 1) assert_true(pdyn_state_hash(sim) == hash);
        hash = pdyn_state_hash(sim);
        test_remove_file("state.pdyn");
        test_close(sim), test_close(again);
    }
}

/* Viscosity alone keeps no particles apart. */
static void test_warning(void **state) {
    (void)state;
    struct warnings warnings = {"no constraint keeps its particles apart", 0};
    pdyn_context *context = test_warned_context(1, &warnings);
    test_close(test_load(context,
                         "{'duration': 1, 'bodies': [{'particles': {'radius': 0.1, 'fill': "
                         "[{'box': {'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}}]}, "
                         "'constraints': [{'type': 'viscosity', 'viscosity': 1}]}]}"));
    assert_int_equal(warnings.count, 1);
}

/* A viscosity of 0 has no element, and its step is that of the fluid alone. */
static void test_zero(void **state) {
    (void)state;
    static const char *const more[] = {"time_step.fixed", "0.001", NULL};
    static struct block b;
    add_block(&b, 4, 4, 4);
    pdyn_sim *sim = load(1, &b, "0", more);
    test_step(sim);
    assert_int_equal(sim->objective.batch[1]->view.elements, 0);
    test_close(sim);
}

/* In a layer of a lattice the rows of `viscosity` that select a particle have diagonal blocks, as
 * the inertia has: `dual` must not take such a particle for one in no row. */
static void test_beside_pressures(void **state) {
    (void)state;
    static const char *const solver[] = {"{'type': 'cg', 'tolerance': 1e-6}",
                                         "{'type': 'dual', 'tolerance': 1e-6}"};
    static struct block b;
    double x[2][3 * 7 * 7];
    int linear[2] = {0};
    add_block(&b, 7, 1, 7);
    for (int i = 0; i < b.count; i++) b.v[i][0] = -4.0 * b.x[i][0], b.v[i][2] = 4.0 * b.x[i][2];
    for (int k = 0; k < 2; k++) {
        const char *const more[] = {"time_step.fixed", "0.002", "solver", solver[k], NULL};
        pdyn_sim *sim = load(1, &b, "600", more);
        for (int n = 0; n < 3; n++) {
            pdyn_step_info info = test_step(sim);
            assert_true(info.step_residual <= 1e-6);
            linear[k] += info.linear_iterations;
        }
        memcpy(x[k], sim->x, sizeof x[k]);
        test_close(sim);
    }
    assert_true(test_distance(x[0], x[1], 3 * b.count) < 1e-3 * spacing);
    assert_true(10 * linear[1] < 17 * linear[0]); /* 100 and 70 */
}

/* Two particles that come so close in a step that the length of their dashpot, extrapolated, would
 * be negative: the steps are solved all the same. */
static void test_approach(void **state) {
    (void)state;
    static const char *const more[] = {"time_step.fixed", "0.001",
                                       "bodies.honey.constraints.fluid.sound_speed", "1e-3", NULL};
    static struct block b;
    add_block(&b, 2, 1, 1);
    b.x[1][0] = b.x[0][0] + 1.9 * spacing;
    b.v[0][0] = 1500 * spacing;
    pdyn_sim *sim = load(1, &b, "1e-9", more);
    for (int n = 0; n < 3; n++) {
        assert_true(test_step(sim).step_residual <= 1e-9);
        if (n == 0) assert_true(fabs(sim->x[3] - sim->x[0] - 0.4 * spacing) < 1e-6);
    }
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stress),           cmocka_unit_test(test_rotation),
        cmocka_unit_test(test_couette),          cmocka_unit_test(test_sheet),
        cmocka_unit_test(test_beside_pressures), cmocka_unit_test(test_zero),
        cmocka_unit_test(test_threads),          cmocka_unit_test(test_warning),
        cmocka_unit_test(test_approach),         cmocka_unit_test(test_turning_box)};
    return cmocka_run_group_tests_name("viscosity", tests, test_enter_directory,
                                       test_leave_directory);
}
