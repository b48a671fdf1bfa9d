/* Damping: decay of oscillators, no force on rigid motions. */
#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

static pdyn_context *context;

#define GRID(vertices)                                                                             \
    "'surface': {'grid': {'size': [1, 1], 'vertices': " vertices "}, 'area_density': 1}"

static int set_up(void **state) {
    (void)state;
    context = test_context(1);
    return test_enter_directory(state);
}

static int tear_down(void **state) {
    pdyn_destroy(context);
    return test_leave_directory(state);
}

static pdyn_sim *load(const char *integrator, const char *body, double h, const char *constraint) {
    char text[1024];
    snprintf(text, sizeof text,
             "{'duration': 100, 'gravity': [0, 0, 0], 'frame_interval': 100, 'time_step': "
             "{'integrator': '%s', 'fixed': %.17g}, 'solver': {'type': 'cg', 'tolerance': "
             "1e-13, 'linear_tolerance': 1e-9, 'outer_iterations': 100}, 'bodies': [{%s, "
             "'constraints': [%s]}]}",
             integrator, h, body, constraint);
    return test_load(context, text);
}

/* An equilateral triangle of side 1 m in uniform oscillation, x = s x_0: I s'' = -2 Y A ((s - 1) +
 * damping s') with I the sum of m |x_0|^2, for springs and for strain. For a stretch in both
 * directions, springs have 3/2 of their Y. */
static void breathe(const char *type, double stiffness) {
    static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0.5 0.86602540378443865 0\nf 1 2 3\n";
    const double h = 0.01, damping = 0.05, area = sqrt(0.75) / 2.0;
    char text[200];
    test_write_text("triangle.obj", mesh);
    snprintf(text, sizeof text, "{'type': '%s', 'stretching_stiffness': 10, 'damping': %g}", type,
             damping);
    pdyn_sim *sim =
        load("euler", "'surface': {'mesh': 'triangle.obj', 'area_density': 1}", h, text);
    test_remove_file("triangle.obj");
    double inertia = area / 3.0 * 3.0 * (1.0 / 3.0), k = 2.0 * stiffness * area / inertia;
    double middle[3] = {0.5, sqrt(1.0 / 12.0), 0.0}, s = 1.0, rate = 0.5;
    for (int i = 0; i < 9; i++) sim->v[i] = rate * (sim->x[i] - middle[i % 3]);
    for (int n = 0; n < 200; n++) {
        test_step(sim);
        double next = (s + h * rate + h * h * k * (1.0 + damping * s / h)) /
                      (1.0 + h * h * k * (1.0 + damping / h));
        rate = (next - s) / h, s = next;
        double found = vec3_distance(sim->x, sim->x + 3);
        if (fabs(found - s) > 1e-9)
            fail_msg("%s, step %d: %.12g, expected %.12g", type, n, found, s);
    }
    assert_true(fabs(s - 1.0) < 5e-3);
    pdyn_free(sim);
}

static void test_breathing(void **state) {
    (void)state;
    breathe("triangle", 10.0);
    breathe("spring", 15.0);
}

/* A regular simplex, mean position 0, in a uniform motion x = (1 + s A) x_0 that passes through its
 * rest shape: A is uniform, along one axis, or a shear, so that the principal stretches cross. For
 * strain I s'' = -k (s + damping s') with the same I / k for each A: k = w volume, I the sum of
 * m x_0^2. */
static void strain(const char *scene, const char *constraint, double k, double A[3][3]) {
    const double h = 0.05, damping = 0.05;
    char text[200];
    snprintf(text, sizeof text, constraint, damping);
    pdyn_sim *sim = load("euler", scene, h, text);
    int count = sim->objective.particles;
    double middle[3] = {0}, start[12], inertia = 0.0, s = 0.0, rate = 0.5, largest = 0.0;
    for (int i = 0; i < count; i++) vec3_add(middle, 1.0 / count, sim->x + 3 * i);
    for (int i = 0; i < count; i++) {
        double *x = start + 3 * i;
        vec3_subtract(x, sim->x + 3 * i, middle);
        inertia += sim->objective.mass[i] * x[0] * x[0];
        for (int a = 0; a < 3; a++) sim->v[3 * i + a] = rate * vec3_dot(A[a], x);
    }
    k /= inertia;
    for (int n = 0; n < 60; n++) {
        test_step(sim);
        double next =
            (s + h * rate + h * h * k * damping / h * s) / (1.0 + h * h * k * (1.0 + damping / h));
        rate = (next - s) / h, s = next, largest = fmax(largest, fabs(s));
        for (int i = 0; i < 3 * count; i++) {
            double x = middle[i % 3] + start[i] + s * vec3_dot(A[i % 3], start + i / 3 * 3);
            if (fabs(sim->x[i] - x) > 1e-6 * largest)
                fail_msg("%s, step %d: %.12g, expected %.12g", constraint, n, sim->x[i], x);
        }
    }
    pdyn_free(sim);
}

static void test_strain(void **state) {
    (void)state;
    static double motions[3][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}},
                                      {{1, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                                      {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}};
    test_write_text("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0.5 0.86602540378443865 0\nf 1 2 3\n");
    test_write_text("tet.node", "4 3 0 0\n1 1 1 1\n2 1 -1 -1\n3 -1 1 -1\n4 -1 -1 1\n");
    test_write_text("tet.ele", "1 4 0\n1 1 2 3 4\n");
    for (int m = 0; m < 3; m++) {
        strain("'surface': {'mesh': 'triangle.obj', 'area_density': 1}",
               "{'type': 'triangle', 'stretching_stiffness': 10, 'damping': %g}",
               10.0 * sqrt(0.75) / 2.0, motions[m]);
        strain("'volume': {'mesh': 'tet.ele', 'density': 1}",
               "{'type': 'tet', 'stiffness': 100, 'damping': %g}", 100.0 * 8.0 / 3.0, motions[m]);
    }
    test_remove_file("triangle.obj"), test_remove_file("tet.node"), test_remove_file("tet.ele");
}

/* Two triangles fold about their common side. A small vibration of a flat plate decays as
 * exp(-(damping + h) omega^2 t / 2): by the damping and by implicit Euler. BDF2 adds no term of
 * this order. */
static void fold(const char *integrator, double own) {
    const double h = 2e-4, damping = 4e-3, rigidity = 0.5;
    char text[200];
    snprintf(text, sizeof text, "{'type': 'bending', 'bending_rigidity': %g, 'damping': %g}",
             rigidity, damping);
    pdyn_sim *sim = load(integrator, GRID("[2, 2]"), h, text);
    const struct batch *b = sim->objective.batch[0];
    double mode[4] = {0}, square = 0.0, omega2 = 0.0;
    for (int e = 0; e < b->view.elements; e++) {
        double sum = 0.0;
        for (int k = b->view.row_entry[e]; k < b->view.row_entry[e + 1]; k++)
            sum += b->view.coefficient[k] * b->view.coefficient[k];
        if (sum < 1e-12) continue;
        for (int k = b->view.row_entry[e]; k < b->view.row_entry[e + 1]; k++)
            mode[b->view.column[k]] =
                b->view.coefficient[k] / sim->objective.mass[b->view.column[k]];
    }
    for (int i = 0; i < 4; i++) square += sim->objective.mass[i] * mode[i] * mode[i];
    for (int e = 0; e < b->view.elements; e++) {
        double u = 0.0;
        for (int k = b->view.row_entry[e]; k < b->view.row_entry[e + 1]; k++)
            u += b->view.coefficient[k] * mode[b->view.column[k]];
        omega2 += b->view.weight[e] * u * u / square;
    }
    for (int i = 0; i < 4; i++) sim->v[3 * i + 1] = 1e-4 * mode[i];
    double period = 2.0 * acos(-1.0) / sqrt(omega2), first = 0.0, last = 0.0;
    int steps = (int)lround(period / h);
    for (int n = 0; n < 5 * steps; n++) {
        pdyn_step_info info = test_step(sim);
        double energy = info.kinetic_energy + info.constraint_energy;
        if (n < steps) first += energy;
        if (n >= 4 * steps) last += energy;
    }
    double expected = (damping + own * h) * omega2 * 4.0 * steps * h;
    if (fabs(log(first / last) / expected - 1.0) > 0.03)
        fail_msg("%s: decay %g, expected %g", integrator, log(first / last), expected);
    pdyn_free(sim);
}

static void test_folding(void **state) {
    (void)state;
    fold("euler", 1.0);
    fold("bdf2", 0.0);
}

/* A damper exerts no total force and no total torque, and no force at all on a rigid motion. */
static void test_balance(void **state) {
    (void)state;
    static const char *const constraints[] = {
        "{'type': 'spring', 'stretching_stiffness': 10, 'damping': 1}",
        "{'type': 'triangle', 'stretching_stiffness': 10, 'damping': 1}",
        "{'type': 'bending', 'bending_rigidity': 10, 'damping': 1}"};
    static const double turn[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6};
    for (int c = 0; c < 3; c++) {
        pdyn_sim *sim = load("bdf2", GRID("[5, 5]"), 0.01, constraints[c]);
        uint64_t seed = 17;
        double y[76], sum[3] = {0}, torque[3] = {0}, scale = 0.0;
        assert_int_equal(sim->objective.batches, 2);
        assert_int_equal(pdyn_get_state(sim).constraints, 1);
        struct batch *damper = sim->objective.batch[1];
        for (int k = 0; k < 75; k++) sim->x[k] += 0.05 * test_random(&seed);
        const struct batch_step step = {.length = 0.01, .h = 0.01};
        const struct step_start start = {sim->x, sim->v, NULL, sim->x, sim->v};
        assert_int_equal(batch_begin(damper, &start, &step), PDYN_OK);
        for (int k = 0; k < 75; k++) y[k] = sim->x[k] + 0.05 * test_random(&seed);
        double gradient[76] = {0};
        assert_int_equal(batch_local(damper, y, gradient), PDYN_OK);
        for (int i = 0; i < 25; i++) {
            double t[3];
            vec3_cross(t, y + 3 * i, gradient + 3 * i);
            vec3_add(sum, 1.0, gradient + 3 * i), vec3_add(torque, 1.0, t);
            scale += vec3_length(gradient + 3 * i);
        }
        assert_true(scale > 1.0);
        assert_true(vec3_length(sum) < 1e-12 * scale && vec3_length(torque) < 1e-12 * scale);
        for (int i = 0; i < 25; i++) vec3_multiply(y + 3 * i, turn, sim->x + 3 * i);
        memset(gradient, 0, sizeof gradient);
        assert_int_equal(batch_local(damper, y, gradient), PDYN_OK);
        assert_true(test_distance(gradient, (double[75]){0}, 75) < 1e-10 * scale);
        pdyn_free(sim);
    }
}

/* The extrapolated rest length of an element that shrinks to nothing is 0, not negative. */
static void test_vanishing(void **state) {
    (void)state;
    static const char *const constraints[] = {
        "{'type': 'spring', 'stretching_stiffness': 10, 'damping': 1}",
        "{'type': 'bending', 'bending_rigidity': 10, 'damping': 1}"};
    for (int c = 0; c < 2; c++) {
        pdyn_sim *sim = load("bdf2", GRID("[5, 5]"), 0.01, constraints[c]);
        struct batch *damper = sim->objective.batch[1];
        double at_one_place[76] = {0};
        uint64_t seed = 17;
        for (int k = 0; k < 75; k++) sim->x[k] += 0.05 * test_random(&seed);
        const struct batch_step step = {.length = 0.01, .extrapolation = 0.5, .h = 0.01};
        const struct step_start start = {at_one_place, sim->v, sim->x, at_one_place, sim->v};
        assert_int_equal(batch_begin(damper, &start, &step), PDYN_OK);
        for (int e = 0; e < damper->view.elements; e++)
            assert_true(((const double *)damper->view.data)[e] == 0.0);
        pdyn_free(sim);
    }
}

/* A sheet of 1 kg/m^2 that rotates in its plane with 5 rad/s, h = 0.02 s. The centrifugal force
 * stretches a side by some rho L^2 omega^2 / (12 Y), 0.2 %; a damper adds nothing to it. */
static void test_rotation(void **state) {
    (void)state;
    static const char *const constraints[] = {
        "{'type': 'spring', 'stretching_stiffness': 1000, 'damping': 1}",
        "{'type': 'triangle', 'stretching_stiffness': 1000, 'damping': 1}"};
    for (int c = 0; c < 2; c++) {
        pdyn_sim *sim = load("bdf2", GRID("[3, 3]"), 0.02, constraints[c]);
        for (int i = 0; i < 9; i++) {
            sim->v[3 * i] = 5.0 * sim->x[3 * i + 2];
            sim->v[3 * i + 2] = -5.0 * sim->x[3 * i];
        }
        for (int n = 0; n < 100; n++) test_step(sim);
        double side = vec3_distance(sim->x, sim->x + 6);
        if (side > 1.005) fail_msg("%s: a side is %g times as long", constraints[c], side);
        pdyn_free(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_breathing), cmocka_unit_test(test_folding),
        cmocka_unit_test(test_balance),   cmocka_unit_test(test_vanishing),
        cmocka_unit_test(test_rotation),  cmocka_unit_test(test_strain),
    };
    return cmocka_run_group_tests_name("damping", tests, set_up, tear_down);
}
