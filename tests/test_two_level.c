/* The two-level preconditioner of hybrid: its parts against dense ones, and what it gains. */
#include "support.h"

#include "../src/solvers/coarse_space.h"
#include "base/registry.h"

/* ---- skyline --------------------------------------------------------------------------------- */

enum { NODES = 40, N = 3 * NODES };

/* Number (i, j) of the factor, which has the inverse of its diagonal. */
static double factor_at(const struct skyline *s, int i, int j) {
    int first = 3 * s->first[i / 3];
    if (j < first || j > i) return 0.0;
    double value = skyline_row(s, i / 3, i % 3)[j - first];
    return j == i ? 1.0 / value : value;
}

/* A random matrix with a dominant diagonal, in block rows of random length: L L' = A, and x from A
 * x, for which L has single precision. */
static void test_skyline(void **state) {
    (void)state;
    uint64_t seed = 7;
    pdyn_context *context = test_context(2);
    pdyn_services services = context_services(context);
    static double A[N][N];
    double x[N], b[N] = {0};
    int first[NODES];
    struct skyline s = {0};
    for (int i = 0; i < NODES; i++) first[i] = (int)(0.5 * (1.0 + test_random(&seed)) * i);
    assert_int_equal(skyline_create(&s, &services, NODES, first), PDYN_OK);
    for (int i = 0; i < N; i++) {
        x[i] = test_random(&seed);
        for (int j = 3 * first[i / 3]; j < i; j++) A[i][j] = A[j][i] = test_random(&seed);
        A[i][i] = N;
        for (int j = 3 * s.first[i / 3]; j <= i; j++)
            skyline_row(&s, i / 3, i % 3)[j - 3 * s.first[i / 3]] = A[i][j];
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) b[i] += A[i][j] * x[j];
    assert_true(skyline_factor(&s));
    for (int i = 0; i < N; i++)
        for (int j = 0; j <= i; j++) {
            double sum = 0.0;
            for (int k = 0; k <= j; k++) sum += factor_at(&s, i, k) * factor_at(&s, j, k);
            assert_true(fabs(sum - A[i][j]) < 1e-13 * N);
        }
    skyline_solve(&s, b);
    assert_true(test_distance(b, x, N) < 1e-6);
    skyline_free(&s);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* ---- sparse matrices ------------------------------------------------------------------------- */

enum { WIDTH = 7 };

/* Some entries of a dense matrix. */
static void make_sparse(const pdyn_services *services, float dense[WIDTH][WIDTH], uint64_t *seed,
                        struct sparse *out) {
    int counts[WIDTH] = {0};
    for (int i = 0; i < WIDTH; i++)
        for (int j = 0; j < WIDTH; j++) {
            dense[i][j] = test_random(seed) > 0.2 ? (float)test_random(seed) : 0.0F;
            counts[i] += dense[i][j] != 0.0F;
        }
    assert_int_equal(sparse_create(out, services, WIDTH, WIDTH, counts), PDYN_OK);
    for (int i = 0; i < WIDTH; i++)
        for (int j = WIDTH - 1, k = out->start[i]; j >= 0; j--)
            if (dense[i][j] != 0.0F) out->entry[k++] = (struct entry){j, dense[i][j]};
}

/* Transposes and products, as dense ones are. */
static void test_sparse(void **state) {
    (void)state;
    uint64_t seed = 5;
    pdyn_context *context = test_context(1);
    pdyn_services services = context_services(context);
    float a[WIDTH][WIDTH], b[WIDTH][WIDTH];
    struct sparse A, B, back, product;
    make_sparse(&services, a, &seed, &A), make_sparse(&services, b, &seed, &B);
    assert_int_equal(sparse_transpose(&A, &back), PDYN_OK);
    assert_int_equal(sparse_multiply(&back, &B, 0.1F, &product), PDYN_OK);
    for (int i = 0; i < WIDTH; i++) {
        float row[WIDTH] = {0};
        for (int k = product.start[i]; k < product.start[i + 1]; k++)
            row[product.entry[k].column] += product.entry[k].value;
        for (int j = 0; j < WIDTH; j++) {
            float want = 0.0F;
            for (int k = 0; k < WIDTH; k++) want += a[k][i] * b[k][j];
            assert_true(fabsf(row[j] - (fabsf(want) > 0.1F ? want : 0.0F)) < 1e-6F);
        }
    }
    sparse_free(&A), sparse_free(&B), sparse_free(&back), sparse_free(&product);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* ---- the coarse space ------------------------------------------------------------------------ */

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

/* At most a quarter are nodes; all but pins follow some, by weights that add up to 1 where no pin
 * is near. */
static void check_nodes(const struct amg_interpolation *p, int particles) {
    int whole = 0;
    assert_true(p->nodes > particles / 40 && p->nodes <= particles / 4);
    assert_true(p->restriction.rows == p->nodes && p->prolongation.rows == particles);
    for (int i = 0; i < particles; i++) {
        double sum = 0.0;
        for (int k = p->prolongation.start[i]; k < p->prolongation.start[i + 1]; k++) {
            assert_true(p->prolongation.entry[k].value > 0.0F);
            sum += (double)p->prolongation.entry[k].value;
        }
        assert_true(sum < 1.0 + 1e-6);
        whole += sum > 1.0 - 1e-6;
    }
    assert_true(whole > particles * 9 / 10 && whole < particles);
}

/* C r = I A^-1 I' r is symmetric, and A is about I' H I: then z = C r has z.H z = r.z. */
static void check_correction(pdyn_sim *sim, double eps) {
    pdyn_model *model = &sim->model.model;
    size_t n = (size_t)model->particles;
    double *r[2], *z[2], *y = calloc(3 * n + 1, sizeof *y);
    struct coarse_space c = {0};
    uint64_t seed = 3;
    assert_int_equal(solver_view_linearise(&sim->model, eps), PDYN_OK);
    assert_int_equal(coarse_space_create(&c, model), PDYN_OK);
    check_nodes(&c.interpolation, (int)n);
    coarse_space_update(&c, true);
    for (int k = 0; k < 2; k++) {
        r[k] = calloc(3 * n + 1, sizeof *y), z[k] = calloc(3 * n + 1, sizeof *y);
        assert_true(r[k] && z[k] && y);
        for (size_t i = 0; i < 3 * n; i++) r[k][i] = test_random(&seed);
        coarse_space_correct(&c, r[k], z[k]);
        model->product(model, z[k], y);
        double ratio = model->dot(model, z[k], y) / model->dot(model, r[k], z[k]);
        if (!(fabs(ratio - 1.0) < (eps > 0.0 ? 0.08 : 0.02)))
            fail_msg("eps = %g: z.H z is %g of r.z", eps, ratio);
    }
    double one = model->dot(model, r[0], z[1]), other = model->dot(model, r[1], z[0]);
    assert_true(fabs(one - other) < 1e-12 * model->dot(model, r[0], z[0]));
    for (int k = 0; k < 2; k++) free(r[k]), free(z[k]);
    free(y);
    coarse_space_free(&c);
}

/* Blocks of elements are of rank 1 with eps = 0, full between 0 and 1, and multiples of I with 1.
 */
static void test_galerkin(void **state) {
    (void)state;
    pdyn_context *context = test_context(2);
    pdyn_sim *sim = test_load(context, sheets);
    for (int step = 0; step < 3; step++) test_step(sim);
    for (int k = 0; k < 3; k++) check_correction(sim, 0.5 * k);
    test_close(sim);
}

/* The blocks of a particle's dynamic constraints lie in the pattern of A, for all nodes that it
 * prolongation: rows of tetrahedra leave weak nodes out. */
static void test_dynamic_pattern(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    struct coarse_space c = {0};
    char path[1024];
    snprintf(path, sizeof path, "%s/scenes/soft_ball.json", getenv("PROJDYN_SOURCE_ROOT"));
    assert_int_equal(pdyn_load(context, path, NULL, 0, &sim), PDYN_OK);
    test_step(sim);
    assert_int_equal(coarse_space_create(&c, &sim->model.model), PDYN_OK);
    const struct sparse *prolongation = &c.interpolation.prolongation;
    assert_non_null(c.dynamic);
    for (int i = 0; i < prolongation->rows; i++)
        for (int k = prolongation->start[i]; k < prolongation->start[i + 1]; k++)
            for (int m = prolongation->start[i]; m < prolongation->start[i + 1]; m++)
                if (prolongation->entry[m].column <= prolongation->entry[k].column)
                    assert_true(prolongation->entry[m].column >=
                                c.a.first[prolongation->entry[k].column]);
    coarse_space_free(&c);
    test_close(sim);
}

/* A hanging sheet of %d x %d vertices, with springs of type %s. */
static const char hanging[] =
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.0166}, \"solver\": {\"type\": \"hybrid\"},"
    " \"bodies\": [{\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [%d, %d]},"
    " \"area_density\": 0.2}, \"constraints\": [{\"type\": \"%s\","
    " \"stretching_stiffness\": 4000}, {\"type\": \"bending\", \"bending_rigidity\": 1e-4},"
    " {\"type\": \"pin\", \"vertices\": {\"vertices\": [0, %d]}}]}]}";

/* Linear iterations of its first eight steps. */
static int hanging_iterations(pdyn_context *context, const char *type, int n) {
    char text[1024];
    int linear = 0;
    snprintf(text, sizeof text, hanging, n, n, type, n - 1);
    pdyn_sim *sim = test_load(context, text);
    for (int step = 0; step < 8; step++) linear += test_step(sim).linear_iterations;
    pdyn_free(sim);
    return linear;
}

/* A sheet of nine times as many vertices needs few more iterations. */
static void test_sizes(void **state) {
    (void)state;
    pdyn_context *context = test_context(2);
    int small = hanging_iterations(context, "spring", 33);
    int large = hanging_iterations(context, "spring", 97);
    if (!(large < 1.5 * small)) fail_msg("%d, %d iterations", small, large);
    pdyn_destroy(context);
}

static void begin_nothing(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

/* The reason of the solver that `auto` chooses for a sheet of this type alone. */
static void expect_reason(pdyn_context *context, const char *type, const char *expected) {
    char text[512];
    snprintf(text, sizeof text,
             "{\"duration\": 1, \"bodies\": [{\"surface\": {\"grid\": {\"size\": [1, 1],"
             " \"vertices\": [5, 5]}, \"area_density\": 0.2}, \"constraints\": [{\"type\": \"%s\", "
             "\"stretching_stiffness\": 4000}]}]}",
             type);
    pdyn_sim *sim = test_load(context, text);
    assert_string_equal(pdyn_solver_type(sim), "hybrid");
    if (!strstr(pdyn_solver_reason(sim), expected)) fail_msg("%s", pdyn_solver_reason(sim));
    pdyn_free(sim);
}

/* Elements of a type with `begin` are in the coarse space if it says that their weights depend on
 * parameters alone. */
static void test_steady(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_constraint_type steady = *registry_constraint(context, "spring"), other = steady;
    steady.name = "steady", steady.begin = begin_nothing, steady.flags |= PDYN_STEADY;
    other.name = "other", other.begin = begin_nothing;
    const pdyn_constraint_type *const types[] = {&steady, &other, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "springs", types, NULL};
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    int springs = hanging_iterations(context, "spring", 33);
    assert_int_equal(hanging_iterations(context, "steady", 33), springs);
    assert_true(hanging_iterations(context, "other", 33) > springs);
    expect_reason(context, "steady", "two-level");
    expect_reason(context, "other", "no coarse space, because no elements with constant weights");
    pdyn_destroy(context);
}

/* ---- fluid and cloth ------------------------------------------------------------------------- */

/* Water that lies on a part of a stiff sheet; %s: settings of the solver. */
static const char pool[] =
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.005}, \"solver\": {%s\"tolerance\": 0.02,"
    " \"linear_tolerance\": 0.03, \"outer_iterations\": 50}, \"bodies\": [{\"particles\":"
    " {\"radius\": 0.01, \"fill\": [{\"box\": {\"minimum\": [-0.1, 0, -0.1],"
    " \"maximum\": [0.1, 0.04, 0.1]}}]}, \"constraints\": [{\"type\": \"fluid\","
    " \"stiffness\": 3500}]}, {\"surface\": {\"grid\":"
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
        for (int step = 0; step < 12; step++) {
            pdyn_step_info info = test_step(sim[k]);
            assert_true(info.step_residual <= 0.02);
            if (step >= 6) linear[k] += info.linear_iterations;
        }
    if (!(4 * linear[1] < 3 * linear[0])) fail_msg("%ld, %ld iterations", linear[0], linear[1]);
    assert_true(test_distance(sim[0]->x, sim[1]->x, 3 * sim[0]->objective.particles) < 5e-2);
    pdyn_free(sim[0]), pdyn_free(sim[1]);
    pdyn_destroy(context);
}

/* Where nothing is static, hybrid is cg. */
static void test_without_nodes(void **state) {
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
        for (int step = 0; step < 5; step++) test_step(sim);
        hash[k] = pdyn_state_hash(sim);
        test_close(sim);
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
        " {\"grid\": {\"size\": [0.3, 0.3], \"vertices\": [5, 5]}, \"area_density\": 0.3},"
        " \"constraints\": [{\"type\": \"spring\", \"stretching_stiffness\": 400}, {\"type\":"
        " \"bending\", \"bending_rigidity\": 1e-3}, {\"type\":"
        " \"pin\", \"vertices\": {\"border\": true}}]}]}");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skyline),
        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_galerkin),
        cmocka_unit_test(test_dynamic_pattern),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_steady),
        cmocka_unit_test(test_coupled),
        cmocka_unit_test(test_without_nodes),
        cmocka_unit_test(test_failing_allocator),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
