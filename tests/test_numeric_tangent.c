/* PDYN_NUMERIC_TANGENT: copies of built-in types without their tangent against the types; what it
 * leaves as it was; types without any tangent; and the example plug-in magnet.c. */
#include "support.h"

#include "base/registry.h"
#include "projdyn/module.h"
#include "rows/numeric_tangent.h"

#include <string.h>

/* ---- copies of built-in types ---------------------------------------------------------------- */

#define SHEET(constraint)                                                                          \
    SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.01}",                     \
          GRID_SHEET("", "1, 1", "9, 9", "'area_density': 1", constraint), "")
#define BLOCK(constraint)                                                                          \
    SCENE("'duration': 1, 'gravity': [0, 0, 0]",                                                   \
          "{'volume': {'grid': {'size': [1, 1, 1], 'cells': [3, 3, 3]}, 'density': 1000}, "        \
          "'constraints': [" constraint "]}",                                                      \
          "")

static const struct {
    const char *name, *scene; /* of the type; of its copy "copy" */
} copied[] = {
    {"spring", SHEET("{'type': 'copy', 'stretching_stiffness': 100}")},
    {"triangle",
     SHEET("{'type': 'copy', 'stretching_stiffness': 100, 'shortest': 0.95, 'longest': 1.05}")},
    {"tet", BLOCK("{'type': 'copy', 'stiffness': 1e5, 'volume_stiffness': 1e5}")},
};

/* Registers a copy of a built-in type without its tangent; flags: PDYN_NUMERIC_TANGENT or 0. */
static void register_copy(pdyn_context *context, const char *name, unsigned flags) {
    static pdyn_constraint_type copy;
    static const pdyn_constraint_type *const types[] = {&copy, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    copy = *registry_constraint(context, name);
    copy.name = "copy", copy.flags |= flags;
    copy.tangent = NULL, copy.tangent_rank1 = NULL;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
}

/* Loads the scene with `name` for the type "copy". */
static pdyn_sim *load_as(pdyn_context *context, const char *scene, const char *name) {
    char text[1024];
    const char *at = strstr(scene, "'copy'");
    snprintf(text, sizeof text, "%.*s'%s'%s", (int)(at - scene), scene, name, at + 6);
    return test_load(context, text);
}

/* y = G' B G u at positions that differ from those at rest by a tenth of the spacing. */
static void product(pdyn_sim *sim, double eps, double *y) {
    struct batch *b = sim->objective.batch[0];
    int n = 3 * sim->objective.particles;
    double *x = test_vector(n), *u = test_vector(n), *gradient = test_vector(n);
    uint64_t seed = 5;
    for (int k = 0; k < n; k++) x[k] = sim->x[k] + 0.02 * test_random(&seed);
    for (int k = 0; k < n; k++) u[k] = test_random(&seed);
    assert_int_equal(batch_local(b, x, gradient), PDYN_OK);
    assert_int_equal(batch_linearise(b, eps), PDYN_OK);
    batch_apply(b, u, y);
    free(x), free(u), free(gradient);
}

static void test_copies(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof copied / sizeof *copied; k++) {
        pdyn_context *context = test_context(1);
        register_copy(context, copied[k].name, PDYN_NUMERIC_TANGENT);
        pdyn_sim *exact = load_as(context, copied[k].scene, copied[k].name);
        pdyn_sim *numeric = load_as(context, copied[k].scene, "copy");
        int n = 3 * exact->objective.particles;
        double *none = test_vector(n), *y = test_vector(n), *z = test_vector(n);
        product(exact, 1.0, none), product(exact, 0.0, y), product(numeric, 0.0, z);
        double size = test_distance(y, none, n); /* the part of the tangent */
        if (!(test_distance(y, z, n) < 1e-6 * size))
            fail_msg("%s: differs by %.3g of %.3g", copied[k].name, test_distance(y, z, n), size);
        free(none), free(y), free(z);
        pdyn_free(exact), pdyn_free(numeric);
        pdyn_destroy(context);
    }
}

/* u and p of all elements have the same bits afterwards. */
static void test_restores(void **state) {
    (void)state;
    pdyn_context *context = test_context(3);
    register_copy(context, "triangle", PDYN_NUMERIC_TANGENT);
    pdyn_sim *sim = test_load(context, copied[1].scene);
    const struct batch *b = sim->objective.batch[0];
    int n = 3 * b->rows;
    double *y = test_vector(3 * sim->objective.particles), *u = test_vector(n), *p = test_vector(n);
    product(sim, 1.0, y); /* projects, without tangents */
    memcpy(u, b->view.u, (size_t)n * sizeof *u), memcpy(p, b->view.p, (size_t)n * sizeof *p);
    product(sim, 0.0, y);
    assert_memory_equal(b->view.u, u, (size_t)n * sizeof *u);
    assert_memory_equal(b->view.p, p, (size_t)n * sizeof *p);
    free(y), free(u), free(p);
    test_close(sim);
}

/* Steps of two lengths: a matrix is made once for each, as with the projective step, and without
 * the warning of those that change. */
static void test_without(void **state) {
    (void)state;
    struct warnings factor = {.text = "is factored in every iteration"};
    pdyn_context *context = test_warned_context(1, &factor);
    pdyn_matrix matrix[3];
    register_copy(context, "spring", 0);
    pdyn_sim *sim = test_load(context, copied[0].scene);
    if (!test_lacks_solver("cholesky")) assert_string_equal(sim->solver->name, "cholesky");
    assert_int_equal(factor.count, 0);
    for (int k = 0; k < 3; k++) {
        sim->objective.h = k < 2 ? 0.01 : 0.02;
        sim->x[0] += 0.01;
        double energy, *gradient = test_vector(3 * sim->objective.particles);
        assert_int_equal(objective_local(&sim->objective, sim->x, &energy, gradient), PDYN_OK);
        assert_int_equal(solver_view_linearise(&sim->model, 0.0), PDYN_OK);
        assert_int_equal(sim->model.model.matrix(&sim->model.model, &matrix[k]), PDYN_OK);
        assert_int_equal(matrix[k].dim, 1);
        free(gradient);
    }
    assert_int_equal(matrix[0].values, matrix[1].values);
    assert_int_not_equal(matrix[1].values, matrix[2].values);
    test_close(sim);
}

/* Eigenvalues -1, 0.5 and 3 become 0, 0.5 and 1; an asymmetric part is left out. */
static void test_clamp(void **state) {
    (void)state;
    double A[9] = {1, 2, 0, 2, 1, 0, 0, 0, 0.5};
    static const double expected[9] = {0.5, 0.5, 0, 0.5, 0.5, 0, 0, 0, 0.5};
    A[2] += 7.0, A[6] -= 7.0;
    tangent_clamp(A, 3);
    assert_true(test_distance(A, expected, 9) < 1e-14);
}

/* ---- steps of the example -------------------------------------------------------------------- */

#define MAGNET                                                                                     \
    SCENE("'duration': 1, 'time_step': {'fixed': 0.01}, 'solver': {'tolerance': 1e-6}",            \
          GRID_SHEET(                                                                              \
              "", "1, 1", "33, 33", "'area_density': 0.3",                                         \
              PAIR("{'type': 'magnet', 'strength': 0.001, 'place': [0, 0.2, 0]}", STRAIN("100"))), \
          "")

/* The same bits with any number of threads, and no allocation in a warmed-up step. */
static void test_steps(void **state) {
    (void)state;
    double *x[2];
    int n = 0;
    for (int run = 0; run < 2; run++) {
        struct counter counter;
        pdyn_context *context = test_counting_context(1 + 2 * run, &counter);
        assert_int_equal(pdyn_register(context, &pdyn_plugin_table), PDYN_OK);
        pdyn_sim *sim = test_load(context, MAGNET);
        for (int k = 0; k < 3; k++) test_step(sim);
        long before = counter.calls;
        for (int k = 0; k < 3; k++) test_step(sim);
        assert_int_equal(counter.calls, before);
        n = 3 * sim->objective.particles;
        x[run] = test_vector(n);
        memcpy(x[run], sim->x, (size_t)n * sizeof **x);
        test_close(sim);
    }
    assert_memory_equal(x[0], x[1], (size_t)n * sizeof **x);
    free(x[0]), free(x[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_copies), cmocka_unit_test(test_restores),
        cmocka_unit_test(test_without), cmocka_unit_test(test_clamp), cmocka_unit_test(test_steps)};
    return cmocka_run_group_tests_name("numeric tangent", tests, NULL, NULL);
}
