/* The coarse level of hybrid against plain sums and dense elimination, and what it is there for. */
#include "support.h"

#include "../src/solvers/groups.h"

#include <string.h>

/* ---- skyline --------------------------------------------------------------------------------- */

/* A random matrix with a dominant diagonal: x from A x, in rows of random length. */
static void test_skyline(void **state) {
    (void)state;
    enum { N = 60 };
    uint64_t seed = 7;
    pdyn_context *context = test_context(1);
    double A[N][N] = {{0}}, x[N], b[N] = {0};
    int first[N];
    struct skyline s = {0};
    for (int i = 0; i < N; i++) first[i] = (int)(0.5 * (1.0 + test_random(&seed)) * i);
    assert_int_equal(skyline_create(&s, context, N, first), PDYN_OK);
    for (int i = 0; i < N; i++) {
        x[i] = test_random(&seed);
        for (int j = first[i]; j < i; j++) A[i][j] = A[j][i] = test_random(&seed);
        A[i][i] = N;
        for (int j = first[i]; j <= i; j++) *skyline_at(&s, i, j) = A[i][j];
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) b[i] += A[i][j] * x[j];
    assert_true(skyline_factor(&s));
    skyline_solve(&s, b);
    assert_true(test_distance(b, x, N) < 1e-13);
    skyline_free(&s);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* ---- groups ---------------------------------------------------------------------------------- */

/* Two sheets, of springs and of triangles, which have one row and more an element; bending is one
 * matrix on the first and rows on the second, which is curved. */
static const char sheets[] =
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.01}, \"bodies\": ["
    "{\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [17, 17]}, \"area_density\": 0.2},"
    " \"constraints\": [{\"type\": \"spring\", \"stretching_stiffness\": 4000},"
    " {\"type\": \"bending\", \"bending_rigidity\": 1e-3},"
    " {\"type\": \"pin\", \"vertices\": {\"vertices\": [0, 16]}}]},"
    "{\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [9, 9], \"sag\": 0.2},"
    " \"translate\": [3, 0, 0], \"area_density\": 0.2}, \"constraints\": ["
    " {\"type\": \"triangle\", \"stretching_stiffness\": 400},"
    " {\"type\": \"bending\", \"bending_rigidity\": 1e-3},"
    " {\"type\": \"pin\", \"vertices\": {\"vertices\": [0, 8]}}]}]}";

static void check_members(const struct clusters *g, int particles) {
    int small = 0;
    assert_true(g->count > particles / 40 && g->count < particles / 4);
    assert_int_equal(g->first[g->count], particles);
    for (int k = 0; k < g->count; k++) {
        assert_true(g->first[k + 1] > g->first[k]);
        small += g->first[k + 1] - g->first[k] < 4;
        for (int m = g->first[k]; m < g->first[k + 1]; m++)
            assert_int_equal(g->of[g->member[m]], k);
    }
    assert_true(small < g->count / 2);
}

/* z = P A^-1 P' r: then P' H z = P' r, with H as the system has it. */
static void test_galerkin(void **state) {
    (void)state;
    pdyn_context *context = test_context(2);
    pdyn_sim *sim = test_load(context, sheets);
    struct system *sys = &sim->system;
    size_t n = (size_t)sys->particles;
    double *r = calloc(3 * n + 1, sizeof *r), *z = calloc(3 * n + 1, sizeof *z),
           *y = calloc(3 * n + 1, sizeof *y), rz = 0.0;
    struct groups g = {0};
    uint64_t seed = 3;
    for (int step = 0; step < 3; step++) test_step(context, sim);
    assert_int_equal(system_linearise(sys, 0.0), PDYN_OK);
    assert_int_equal(groups_create(&g, sys), PDYN_OK);
    check_members(&g.clusters, (int)n);
    for (size_t k = 0; k < 3 * n; k++) r[k] = test_random(&seed);
    groups_prepare(&g);
    double product = groups_add(&g, r, z);
    system_apply(sys, z, y);
    for (size_t k = 0; k < 3 * n; k++) rz += r[k] * z[k];
    assert_true(fabs(product / rz - 1.0) < 1e-12);
    for (int k = 0; k < 3 * g.clusters.count; k++) {
        double want = 0.0, have = 0.0, size = 0.0;
        for (int m = g.clusters.first[k / 3]; m < g.clusters.first[k / 3 + 1]; m++) {
            size_t at = 3 * (size_t)g.clusters.member[m] + (size_t)(k % 3);
            want += r[at], have += y[at], size += fabs(y[at]);
        }
        assert_true(fabs(want - have) < 1e-9 * (fabs(want) + size));
    }
    groups_free(&g);
    free(r), free(z), free(y);
    pdyn_free(sim);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* ---- fluid and cloth ------------------------------------------------------------------------- */

/* Water that falls on a part of a stiff sheet; %s: settings of the solver. */
static const char pool[] =
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.01}, \"solver\": {%s\"tolerance\": 0.1,"
    " \"linear_tolerance\": 0.03, \"outer_iterations\": 50}, \"bodies\": [{\"particles\":"
    " {\"radius\": 0.01, \"fill\": [{\"box\": {\"minimum\": [-0.1, 0.012, -0.1],"
    " \"maximum\": [0.1, 0.052, 0.1]}}]}, \"constraints\": [{\"type\": \"fluid\","
    " \"stiffness\": 3500, \"projection_tolerance\": 1e-3}]}, {\"surface\": {\"grid\":"
    " {\"size\": [1, 1], \"vertices\": [49, 49]}, \"area_density\": 0.3}, \"constraints\": ["
    "{\"type\": \"spring\", \"stretching_stiffness\": 40000}, {\"type\": \"bending\","
    " \"bending_rigidity\": 1e-4}, {\"type\": \"pin\", \"vertices\": {\"border\": true}}]}]}";

static pdyn_sim *load_pool(pdyn_context *context, const char *settings) {
    char text[2048];
    snprintf(text, sizeof text, pool, settings);
    return test_load(context, text);
}

/* Once the water lies there, fewer iterations than blocks alone need, to the same residual and
 * place. */
static void test_coupled(void **state) {
    (void)state;
    pdyn_context *context = test_context(2);
    pdyn_sim *sim[2] = {load_pool(context, "\"type\": \"cg\", "), load_pool(context, "")};
    long linear[2] = {0};
    assert_string_equal(pdyn_solver_type(sim[1]), "hybrid");
    for (int k = 0; k < 2; k++)
        for (int step = 0; step < 20; step++) {
            pdyn_step_info info = test_step(context, sim[k]);
            assert_true(info.step_residual <= 0.1);
            if (step >= 10) linear[k] += info.linear_iterations;
        }
    if (!(4 * linear[1] < 3 * linear[0])) fail_msg("%ld, %ld iterations", linear[0], linear[1]);
    assert_true(test_distance(sim[0]->x, sim[1]->x, 3 * sim[0]->system.particles) < 5e-2);
    pdyn_free(sim[0]), pdyn_free(sim[1]);
    pdyn_destroy(context);
}

/* Where nothing is static, hybrid is cg. */
static void test_without_groups(void **state) {
    (void)state;
    static const char *const solver[] = {"solver.type=cg", "solver.type=hybrid"};
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = NULL;
        assert_int_equal(pdyn_load_text(context,
                                        "{\"duration\": 1, \"time_step\": {\"fixed\": 0.005},"
                                        " \"bodies\": [{\"particles\": {\"radius\": 0.02, \"fill\":"
                                        " [{\"box\": {\"minimum\": [0, 0, 0], \"maximum\":"
                                        " [0.2, 0.2, 0.2]}}]}, \"constraints\": [{\"type\":"
                                        " \"fluid\", \"stiffness\": 1000}]}], \"solids\":"
                                        " [{\"box\": {\"minimum\": [0, 0, 0], \"maximum\":"
                                        " [0.4, 0.4, 0.4]}}]}",
                                        "water", &solver[k], 1, &sim),
                         PDYN_OK);
        for (int step = 0; step < 5; step++) test_step(context, sim);
        hash[k] = pdyn_state_hash(sim);
        pdyn_free(sim);
        pdyn_destroy(context);
    }
    assert_true(hash[0] == hash[1]);
}

static void test_failing_allocator(void **state) {
    (void)state;
    test_failing_scene(
        "{\"duration\": 1, \"time_step\": {\"fixed\": 0.01}, \"bodies\": [{\"particles\": "
        "{\"radius\":"
        " 0.05, \"fill\": [{\"box\": {\"minimum\": [-0.1, 0.06, -0.1], \"maximum\": [0.1, 0.16,"
        " 0.1]}}]}, \"constraints\": [{\"type\": \"fluid\", \"stiffness\": 1000}]}, {\"surface\":"
        " {\"grid\": {\"size\": [1, 1], \"vertices\": [5, 5]}, \"area_density\": 0.3},"
        " \"constraints\": [{\"type\": \"spring\", \"stretching_stiffness\": 400}, {\"type\":"
        " \"pin\", \"vertices\": {\"border\": true}}]}]}");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skyline),           cmocka_unit_test(test_galerkin),
        cmocka_unit_test(test_coupled),           cmocka_unit_test(test_without_groups),
        cmocka_unit_test(test_failing_allocator),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
