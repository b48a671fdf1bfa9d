/* What the solvers promise beyond conformance. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A sheet of n x n vertices held by two corners, with these settings. */
static pdyn_sim *hang(pdyn_context *context, int n, const char *settings) {
    char text[1024];
    snprintf(text, sizeof text,
             "{\"duration\": 100, %s, \"bodies\": [{\"surface\": {\"grid\": {\"size\": [1, 1], "
             "\"vertices\": [%d, %d]}, \"area_density\": 0.2}, \"constraints\": [{\"type\": "
             "\"spring\", \"stretching_stiffness\": 400}, {\"type\": \"bending\", "
             "\"bending_rigidity\": 1e-4}, {\"type\": \"pin\", \"vertices\": {\"vertices\": [0, "
             "%d]}}]}]}",
             settings, n, n, n - 1);
    return test_load(context, text);
}

/* On a hanging sheet the two-level preconditioner needs less than a third of the iterations of
 * block Jacobi alone, to the same place. */
static void test_hybrid(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    const char *settings = "\"time_step\": {\"fixed\": 0.02}, \"solver\": {\"type\": \"%s\", "
                           "\"tolerance\": 1e-4, \"outer_iterations\": 100}";
    static const char *const solver[] = {"cg", "hybrid"};
    long linear[2] = {0};
    pdyn_sim *sim[2];
    for (int k = 0; k < 2; k++) {
        char text[256];
        snprintf(text, sizeof text, settings, solver[k]);
        sim[k] = hang(context, 33, text);
        for (int step = 0; step < 10; step++) {
            pdyn_step_info info = test_step(sim[k]);
            assert_true(info.step_residual <= 1e-4);
            linear[k] += info.linear_iterations;
        }
    }
    assert_true(test_distance(sim[0]->x, sim[1]->x, 3 * 33 * 33) < 1e-4);
    if (!(linear[1] < linear[0] / 3)) fail_msg("%ld, %ld", linear[0], linear[1]);
    pdyn_free(sim[0]), pdyn_free(sim[1]);
    pdyn_destroy(context);
}

/* Twelve linear iterations of a simulation with this solver, in parts of so many; adds up y. */
static void solve_in_parts(pdyn_sim *sim, int part, const double *b, double *y) {
    size_t bytes = objective_bytes(&sim->objective), n = bytes / sizeof *y;
    size_t room = bytes + sizeof *y; /* for a fourth number of the last particle */
    double *rest = malloc(room), *more = malloc(room), *product = malloc(room);
    assert_true(rest && more && product);
    memcpy(rest, b, bytes);
    memset(y, 0, bytes);
    for (int done = 0; done < 12; done += part) {
        const pdyn_stop stop = {
            .rel_tol = 1e-12, .max_iterations = part, .first_of_step = done == 0};
        int iterations;
        memset(more, 0, bytes);
        assert_int_equal(sim->solver->solve(sim->solver_state, rest, more, &stop, &iterations),
                         PDYN_OK);
        assert_int_equal(iterations, part);
        for (size_t k = 0; k < n; k++) y[k] += more[k];
        objective_apply(&sim->objective, y, product);
        for (size_t k = 0; k < n; k++) rest[k] = b[k] - product[k];
    }
    free(rest), free(more), free(product);
}

/* A solve of cg goes on where the one before ended: several short ones are one long one. */
static void test_goes_on(void **state) {
    (void)state;
    enum { N = 3 * 17 * 17 };
    pdyn_context *context = test_context(1);
    double b[N], whole[N + 1], parts[N + 1]; /* vectors of the system have room for a fourth */
    uint64_t seed = 1;
    pdyn_sim *sim =
        hang(context, 17, "\"time_step\": {\"fixed\": 0.02}, \"solver\": {\"type\": \"cg\"}");
    for (int step = 0; step < 3; step++) test_step(sim);
    for (int i = 0; i < N; i++) b[i] = test_random(&seed);
    assert_int_equal(solver_view_linearise(&sim->model, 0.0), PDYN_OK);
    solve_in_parts(sim, 12, b, whole);
    solve_in_parts(sim, 3, b, parts);
    double size = test_distance(whole, (double[N]){0}, N);
    if (!(test_distance(whole, parts, N) < 1e-9 * size))
        fail_msg("%g apart", test_distance(whole, parts, N) / size);
    test_close(sim);
}

/* One solve for the right-hand side b with this stop; y: the solution. Returns the iterations. */
static int solve_once(pdyn_sim *sim, pdyn_stop stop, const double *b, double *y, double *rest) {
    size_t bytes = objective_bytes(&sim->objective);
    int iterations;
    stop.first_of_step = true;
    memcpy(rest, b, bytes), memset(y, 0, bytes);
    assert_int_equal(sim->solver->solve(sim->solver_state, rest, y, &stop, &iterations), PDYN_OK);
    return iterations;
}

/* Where min_progress of 0.02 ends a solve, from the minima of the model, (y.H y)/2 - b.y, after
 * 0, 1, 2, ... iterations; `first` ones come first. */
static int end_of_progress(pdyn_sim *sim, const double *b, double *y, double *rest, int first) {
    pdyn_model *m = &sim->model.model;
    double before = 0.0, all = 0.0, gain = INFINITY;
    for (int k = 1, counted = 0;; k++) {
        if (k > first && gain < 0.02 * all / fmax(counted, 1)) return k - 1;
        solve_once(sim, (pdyn_stop){.rel_tol = 1e-14, .max_iterations = k}, b, y, rest);
        double value = -0.5 * (m->dot(m, b, y) + m->dot(m, rest, y));
        gain = before - value, before = value;
        if (k > 1 || !first) all += gain, counted++;
    }
}

/* A solve of cg ends at the first of its criteria. */
static void test_stop(void **state) {
    (void)state;
    enum { N = 3 * 17 * 17 };
    pdyn_context *context = test_context(1);
    double b[N + 1], y[N + 1], rest[N + 1];
    uint64_t seed = 1;
    pdyn_sim *sim =
        hang(context, 17, "\"time_step\": {\"fixed\": 0.02}, \"solver\": {\"type\": \"cg\"}");
    pdyn_model *m = &sim->model.model;
    for (int step = 0; step < 3; step++) test_step(sim);
    for (int i = 0; i < N; i++) b[i] = test_random(&seed);
    assert_int_equal(solver_view_linearise(&sim->model, 0.0), PDYN_OK);
    pdyn_stop stop = {.rel_tol = 1e-3, .max_iterations = 1000};
    double target = 1e-3 * m->norm(m, b);
    int enough = solve_once(sim, stop, b, y, rest);
    assert_true(enough > 10 && m->norm(m, rest) <= target);
    stop.max_iterations = enough - 1;
    assert_int_equal(solve_once(sim, stop, b, y, rest), enough - 1);
    assert_true(m->norm(m, rest) > target);
    for (int first = 0; first < 4; first++) {
        stop = (pdyn_stop){.rel_tol = 1e-14, .min_progress = 0.02, .max_iterations = 1000};
        stop.min_iterations = first;
        int done = solve_once(sim, stop, b, y, rest);
        assert_int_equal(done, end_of_progress(sim, b, y, rest, first));
        stop.rel_tol = 1.0;
        assert_int_equal(solve_once(sim, stop, b, y, rest), first);
    }
    test_close(sim);
}

/* A right-hand side that is not finite leaves nothing to the solves of the next step. */
static void test_not_finite(void **state) {
    (void)state;
    enum { N = 3 * 17 * 17 };
    static const char *const settings[] = {"\"solver\": {\"type\": \"cg\"}",
                                           "\"solver\": {\"type\": \"hybrid\"}"};
    static const pdyn_stop stop = {.min_iterations = 1, .max_iterations = 2, .first_of_step = true};
    for (int k = 0; k < 2; k++) {
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = hang(context, 17, settings[k]);
        double b[N + 1], y[N + 1], before[N + 1], after[N + 1];
        uint64_t seed = 1;
        int iterations;
        test_step(sim);
        for (int i = 0; i < N; i++) b[i] = test_random(&seed);
        assert_int_equal(solver_view_linearise(&sim->model, 0.0), PDYN_OK);
        solve_in_parts(sim, 12, b, before);
        for (int i = 0; i < N; i++) b[i] = NAN, y[i] = 0.0;
        assert_int_equal(sim->solver->solve(sim->solver_state, b, y, &stop, &iterations), PDYN_OK);
        seed = 1;
        for (int i = 0; i < N; i++) b[i] = test_random(&seed);
        solve_in_parts(sim, 12, b, after);
        assert_memory_equal(before, after, N * sizeof *b);
        test_close(sim);
    }
}

/* Steps of two lengths in turn, as before frames: an old factor still serves, and nothing is
 * allocated but for a new one. */
static void test_changing_step(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *context = test_counting_context(2, &counter);
    pdyn_sim *sim = hang(context, 17,
                         "\"time_step\": {\"fixed\": 0.008}, \"frame_interval\": 0.01, "
                         "\"solver\": {\"tolerance\": 1e-3, \"outer_iterations\": 50}");
    assert_string_equal(pdyn_solver_type(sim), "hybrid");
    long quiet = 0;
    for (int step = 0; step < 60; step++) {
        long before = counter.calls;
        pdyn_step_info info = test_step(sim);
        assert_true(info.step_residual <= 1e-3);
        if (step >= 2) quiet += counter.calls == before;
    }
    assert_true(quiet >= 50);
    test_close(sim);
}

static void check_descent(void *user, const pdyn_iteration *it) {
    double *energy = user; /* of the iteration before */
    assert_true(it->energy <= *energy * (1.0 + 1e-12));
    *energy = it->energy;
}

/* With exact solves, no iteration of classic Projective Dynamics raises E: the first step of a
 * sheet that falls from the level. */
static void test_projective_descends(void **state) {
    (void)state;
    if (test_lacks_solver("cholesky")) skip();
    double energy = INFINITY;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = hang(context, 17,
                         "\"time_step\": {\"fixed\": 0.05}, \"solver\": {\"step\": "
                         "\"projective\", \"tolerance\": 0, \"outer_iterations\": 30, "
                         "\"type\": \"cholesky\"}");
    pdyn_observe(sim, check_descent, &energy);
    assert_int_equal(test_step(sim).outer_iterations, 30);
    test_close(sim);
}

static void test_failing_allocator(void **state) {
    (void)state;
    test_failing_scene(
        "{\"duration\": 1, \"bodies\": [{\"surface\": {\"grid\": {\"size\": [1, 1], "
        "\"vertices\": [5, 5]}, \"area_density\": 0.2}, \"constraints\": [{\"type\": "
        "\"spring\", \"stretching_stiffness\": 400}, {\"type\": \"pin\", "
        "\"vertices\": {\"vertices\": [0, 4]}}]}]}");
}

/* ---- bodies ---------------------------------------------------------------------------------- */

#define SHEET_AND(more)                                                                            \
    "{\"duration\": 1, \"frame_interval\": 0.1, \"time_step\": {\"fixed\": 0.01}, \"bodies\": "    \
    "[{\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [17, 17]}, \"translate\": [0, "    \
    "1.5, "                                                                                        \
    "0], \"area_density\": 0.2}, \"constraints\": [{\"type\": \"spring\", "                        \
    "\"stretching_stiffness\": 4000}, {\"type\": \"bending\", \"bending_rigidity\": 1e-3}, "       \
    "{\"type\": \"pin\", \"vertices\": {\"vertices\": [0, 16]}}]}" more "}"

/* A tank of water that is far away, 700 times as heavy as a hanging sheet, does not hide how far
 * the sheet is solved: it moves as it does alone. */
static void test_far_tank(void **state) {
    (void)state;
    static const char *const text[] = {
        SHEET_AND("]"),
        SHEET_AND(
            ", {\"particles\": {\"radius\": 0.05, \"fill\": [{\"box\": {\"minimum\": [3, 0, 0], "
            "\"maximum\": [3.4, 0.4, 0.4]}}]}, \"constraints\": [{\"type\": \"fluid\", "
            "\"stiffness\": 1e5}]}], \"solids\": [{\"box\": {\"minimum\": [3, 0, 0], \"maximum\": "
            "[3.4, 1, 0.4]}}]")};
    enum { VERTICES = 17 * 17 };
    double x[2][3 * VERTICES];
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(text[k]);
        for (int step = 0; step < 40; step++) {
            pdyn_step_info info = test_step(sim);
            assert_true(pdyn_get_body(sim, 0).residual <= info.step_residual);
        }
        memcpy(x[k], sim->x, sizeof x[k]);
        test_close(sim);
    }
    double apart = test_distance(x[0], x[1], 3 * VERTICES) / sqrt(VERTICES);
    if (!(apart < 5e-4)) fail_msg("%g m apart", apart);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_projective_descends),
        cmocka_unit_test(test_far_tank),
        cmocka_unit_test(test_hybrid),
        cmocka_unit_test(test_goes_on),
        cmocka_unit_test(test_stop),
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_changing_step),
        cmocka_unit_test(test_failing_allocator),
    };
    return cmocka_run_group_tests_name("solvers", tests, NULL, NULL);
}
