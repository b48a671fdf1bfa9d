/* Inner solves in floats: the product against the batches' own in doubles, where an iteration ends,
 * and what a solver makes of a sheet too stiff for floats. */
#include "support.h"

#include "../src/solvers/single_cg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A body of this shape with these constraints, three steps into its fall. */
static pdyn_sim *fall(pdyn_context *context, const char *shape, const char *constraints) {
    char text[2048];
    snprintf(text, sizeof text,
             "{\"duration\": 100, \"time_step\": {\"fixed\": 0.01}, \"solver\": {\"type\": "
             "\"hybrid\", \"tolerance\": 1e-3}, \"bodies\": [{%s, \"constraints\": [%s, {\"type\": "
             "\"pin\", \"vertices\": {\"vertices\": [0, 12]}}]}]}",
             shape, constraints);
    pdyn_sim *sim = test_load(context, text);
    for (int k = 0; k < 3; k++) test_step(context, sim);
    return sim;
}

static double *random_vector(int particles) {
    double *u = calloc(3 * (size_t)particles + 1, sizeof *u);
    uint64_t seed = 7;
    assert_non_null(u);
    /* as floats hold it, so that the products differ by their own roundings alone */
    for (int k = 0; k < 3 * particles; k++) u[k] = (double)(float)test_random(&seed);
    return u;
}

static float *to_floats(const struct objective *sys, const double *u) {
    float *out = calloc(single_size(sys), sizeof *out);
    assert_non_null(out);
    for (int k = 0; k < 3 * sys->particles; k++) out[k / 3 * 4 + k % 3] = (float)u[k];
    return out;
}

static void compare_diagonals(const struct single *s) {
    size_t numbers = 6 * (size_t)s->objective->particles;
    double *D = calloc(2 * numbers + 1, sizeof *D), *exact = D + numbers, most = 0.0;
    assert_non_null(D);
    single_diagonal(s, D), objective_diagonal(s->objective, exact);
    for (size_t k = 0; k < numbers; k++) most = fmax(most, fabs(exact[k]));
    for (size_t k = 0; k < numbers; k++) assert_true(fabs(D[k] - exact[k]) < 1e-12 * most);
    free(D);
}

/* H u, u.H u and the block diagonal as floats have them, against doubles. */
static void compare_products(struct objective *sys, double eps) {
    struct single s = {0};
    int n = sys->particles, size = 3 * n;
    double *u = random_vector(n), *y = calloc((size_t)size + 1, sizeof *y), most = 0.0, worst = 0.0;
    float *single_u = to_floats(sys, u), *single_y = calloc(single_size(sys), sizeof *single_y);
    assert_true(y && single_y);
    assert_int_equal(objective_linearise(sys, eps), PDYN_OK);
    assert_int_equal(single_create(&s, sys), PDYN_OK);
    single_prepare(&s);
    objective_apply(sys, u, y);
    double product = single_apply(&s, single_u, single_y), exact = 0.0;
    for (int k = 0; k < size; k++) {
        exact += u[k] * y[k], most = fmax(most, fabs(y[k]));
        worst = fmax(worst, fabs(y[k] - (double)single_y[k / 3 * 4 + k % 3]));
    }
    assert_true(exact > 0.0 && worst < 2e-6 * most && fabs(product - exact) < 1e-6 * exact);
    for (int i = 0; i <= n; i++) assert_true(single_y[4 * i + 3] == 0.0F);
    compare_diagonals(&s);
    single_free(&s);
    free(u), free(y), free(single_u), free(single_y);
}

/* Numbers, links, rows of one and of several particles, and what adds up of them; as many particles
 * as do and do not fill patches. */
static void test_product(void **state) {
    (void)state;
    static const char sheet[] =
        "\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [13, %d]}, "
        "\"area_density\": 0.2}";
    static const char solid[] =
        "\"volume\": {\"grid\": {\"size\": [0.3, 0.2, 0.1], \"cells\": [3, %d, "
        "1]}, \"density\": 1000}";
    static const struct {
        const char *shape, *constraints;
    } scene[] = {
        {sheet, "{\"type\": \"spring\", \"stretching_stiffness\": 400}"},
        {sheet, "{\"type\": \"bending\", \"bending_rigidity\": 0.1}"},
        {sheet, "{\"type\": \"spring\", \"stretching_stiffness\": 400, \"damping\": 0.01}, "
                "{\"type\": \"bending\", \"bending_rigidity\": 1e-2, \"damping\": 0.01}"},
        {sheet, "{\"type\": \"triangle\", \"stretching_stiffness\": 400}, {\"type\": \"bending\", "
                "\"bending_rigidity\": 1e-2}"},
        {solid, "{\"type\": \"tet\", \"stiffness\": 1e4}"},
    };
    for (size_t k = 0; k < sizeof scene / sizeof *scene; k++)
        for (int n = 5; n < 8; n++) {
            char shape[256];
            pdyn_context *context = test_context(2);
            snprintf(shape, sizeof shape, scene[k].shape, n);
            pdyn_sim *sim = fall(context, shape, scene[k].constraints);
            compare_products(&sim->objective, 0.0);
            compare_products(&sim->objective, 0.3);
            compare_products(&sim->objective, 1.0);
            pdyn_free(sim);
            assert_int_equal(pdyn_bytes_in_use(context), 0);
            pdyn_destroy(context);
        }
}

/* What all particles have in common meets inertia alone, however stiff the rest is: to a float's
 * last digit. */
static void test_common_motion(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = fall(context,
                         "\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [13, 6]}, "
                         "\"area_density\": 0.2}",
                         "{\"type\": \"spring\", \"stretching_stiffness\": 1e9}, {\"type\": "
                         "\"bending\", \"bending_rigidity\": 1e3}");
    struct objective *sys = &sim->objective;
    struct single s = {0};
    double *u = random_vector(sys->particles);
    for (int k = 0; k < 3 * sys->particles; k++) u[k] = 0.3;
    float *single_u = to_floats(sys, u), *y = calloc(single_size(sys), sizeof *y);
    assert_non_null(y);
    assert_int_equal(objective_linearise(sys, 0.0), PDYN_OK);
    assert_int_equal(single_create(&s, sys), PDYN_OK);
    single_prepare(&s);
    single_apply(&s, single_u, y);
    for (int i = 0; i < sys->particles; i++) {
        double expected = 0.3 * objective_inertia(sys, i);
        bool pinned = i == 0 || i == 12;
        assert_true(pinned || fabs((double)y[4 * i] - expected) < 3e-7 * expected);
    }
    single_free(&s);
    free(u), free(single_u), free(y);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* The residual that a solve leaves, of the one before, which is so small that no constraint changes
 * sides. */
static double left_by_solve(pdyn_sim *sim, double tolerance) {
    struct objective *sys = &sim->objective;
    int size = 3 * sys->particles, iterations;
    double *b = random_vector(sys->particles), *rest = random_vector(sys->particles);
    double *y = calloc((size_t)size + 1, sizeof *y), *q = calloc((size_t)size + 1, sizeof *q);
    const pdyn_stop stop = {.rel_tol = tolerance, .max_iterations = 100000, .first_of_step = true};
    assert_true(y && q);
    for (int k = 0; k < size; k++) b[k] *= 1e-6, rest[k] *= 1e-6;
    assert_int_equal(objective_linearise(sys, 0.0), PDYN_OK);
    assert_int_equal(sim->solver->solve(sim->solver_state, rest, y, &stop, &iterations), PDYN_OK);
    objective_apply(sys, y, q);
    for (int k = 0; k < size; k++) q[k] -= b[k];
    double left = objective_norm(sys, q) / objective_norm(sys, b);
    free(b), free(rest), free(y), free(q);
    return left;
}

/* Floats leave what doubles then see and go on with; and what they cannot solve at all is solved in
 * doubles. */
static void test_refined(void **state) {
    (void)state;
    static const double stiffness[] = {1e3, 1e6, 1e9, 1e12}, rigidity[] = {1e-4, 1.0, 1e6, 1e9};
    /* the last is at the end of doubles, too: one part in 1e16 of its stiffness is its inertia */
    static const double asked[] = {1e-9, 1e-9, 1e-5, 1e-2}, most[] = {1e-9, 1e-9, 1e-5, 0.05};
    for (int k = 0; k < 4; k++) {
        char constraints[256];
        pdyn_context *context = test_context(1);
        snprintf(constraints, sizeof constraints,
                 "{\"type\": \"spring\", \"stretching_stiffness\": %g}, {\"type\": \"bending\", "
                 "\"bending_rigidity\": %g}",
                 stiffness[k], rigidity[k]);
        pdyn_sim *sim = fall(context,
                             "\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [13, 13]}, "
                             "\"area_density\": 0.2}",
                             constraints);
        double left = left_by_solve(sim, asked[k]);
        if (!(left <= 1.01 * most[k])) fail_msg("stiffness %g leaves %g", stiffness[k], left);
        pdyn_free(sim);
        pdyn_destroy(context);
    }
}

/* ---- iterations ------------------------------------------------------------------------------ */

struct solves { /* a sheet, and what its linear solves are made of */
    pdyn_context *context;
    pdyn_sim *sim;
    struct jacobi jacobi;
    struct coarse coarse;
    struct single_cg single;
    double *b, *y;
};

static void solves_create(struct solves *t) {
    *t = (struct solves){.context = test_context(1)};
    t->sim = fall(t->context,
                  "\"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [13, 13]}, "
                  "\"area_density\": 0.2}",
                  "{\"type\": \"spring\", \"stretching_stiffness\": 400}, {\"type\": \"bending\", "
                  "\"bending_rigidity\": 1e-4}");
    struct objective *sys = &t->sim->objective;
    t->b = random_vector(sys->particles);
    t->y = calloc(3 * (size_t)sys->particles + 1, sizeof *t->y);
    assert_non_null(t->y);
    assert_int_equal(objective_linearise(sys, 0.0), PDYN_OK);
    assert_int_equal(jacobi_create(&t->jacobi, sys), PDYN_OK);
    assert_int_equal(coarse_create(&t->coarse, sys), PDYN_OK);
    assert_int_equal(single_cg_create(&t->single, sys, &t->jacobi, &t->coarse), PDYN_OK);
    single_cg_prepare(&t->single);
}

static void solves_free(struct solves *t) {
    single_cg_free(&t->single);
    coarse_free(&t->coarse);
    jacobi_free(&t->jacobi);
    free(t->b), free(t->y);
    pdyn_free(t->sim);
    assert_int_equal(pdyn_bytes_in_use(t->context), 0);
    pdyn_destroy(t->context);
}

/* So many iterations for H y = b, and what they leave of b; cut: as no more are allowed, or else as
 * they do not gain enough. */
static void solves_solve(struct solves *t, int iterations, bool first, bool cut, double *left) {
    const pdyn_stop stop = {.rel_tol = 1e-9,
                            .max_iterations = cut ? iterations : 100,
                            .min_progress = cut ? 0.0 : 1e9,
                            .min_iterations = cut || iterations == 1 ? 0 : iterations,
                            .first_of_step = first};
    struct objective *sys = &t->sim->objective;
    int done;
    memset(t->y, 0, objective_bytes(sys));
    assert_int_equal(single_cg_solve(&t->single, t->b, t->y, &stop, &done), SINGLE_ENOUGH);
    assert_int_equal(done, iterations);
    objective_apply(sys, t->y, left);
    for (int k = 0; k < 3 * sys->particles; k++) left[k] = t->b[k] - left[k];
}

/* Of a vector along another one. */
static double cosine(struct objective *sys, const double *a, const double *b) {
    return objective_dot(sys, a, b) / sqrt(objective_dot(sys, a, a) * objective_dot(sys, b, b));
}

/* Conjugate gradients leave a residual at right angles to all steps: after one iteration to the
 * first one, D^-1 b + P A^-1 P' b; after two, to both. */
static void test_directions(void **state) {
    (void)state;
    struct solves t;
    solves_create(&t);
    struct objective *sys = &t.sim->objective;
    double *left = random_vector(sys->particles), *block = random_vector(sys->particles);
    double *step = random_vector(sys->particles);
    solves_solve(&t, 1, true, false, left);
    memcpy(step, t.y, objective_bytes(sys));
    jacobi_prepare(&t.jacobi);
    jacobi_apply(&t.jacobi, t.b, block);
    coarse_add(&t.coarse, t.b, block);
    assert_true(cosine(sys, step, block) > 1.0 - 1e-9);
    assert_true(fabs(cosine(sys, left, block)) < 1e-5 && fabs(cosine(sys, left, step)) < 1e-5);
    solves_solve(&t, 2, true, false, left);
    assert_true(fabs(cosine(sys, left, step)) < 1e-4 && fabs(cosine(sys, left, t.y)) < 1e-4);
    free(left), free(block), free(step);
    solves_free(&t);
}

/* 1/2 y.H y - b.y, H y = b - left */
static double model(const struct solves *t, const double *left) {
    struct objective *sys = &t->sim->objective;
    return -0.5 * (objective_dot(sys, t->b, t->y) + objective_dot(sys, left, t->y));
}

/* A solve goes on from the one before: two of one iteration come to where one of two does, and
 * lower than two that begin anew. */
static void test_goes_on(void **state) {
    (void)state;
    struct solves t;
    solves_create(&t);
    struct objective *sys = &t.sim->objective;
    double *left = random_vector(sys->particles), *b = random_vector(sys->particles), after[2];
    double once = 0.0;
    solves_solve(&t, 2, true, false, left);
    double together = model(&t, left);
    for (int goes_on = 0; goes_on < 2; goes_on++) {
        memcpy(t.b, b, objective_bytes(sys));
        solves_solve(&t, 1, true, false, left);
        once = model(&t, left);
        memcpy(t.b, left, objective_bytes(sys));
        solves_solve(&t, 1, !goes_on, false, left);
        after[goes_on] = once + model(&t, left);
    }
    double second = once - together; /* what the second iteration gains */
    assert_true(fabs(after[1] - together) < 1e-5 * second);
    assert_true(after[0] > together + 0.005 * second);
    free(left), free(b);
    solves_free(&t);
}

/* A solve that is cut short ends with a step more, by blocks alone: lower, and at right angles to
 * both. */
static void test_cut_short(void **state) {
    (void)state;
    struct solves t;
    solves_create(&t);
    struct objective *sys = &t.sim->objective;
    double *left = random_vector(sys->particles), *step = random_vector(sys->particles);
    solves_solve(&t, 1, true, false, left);
    memcpy(step, t.y, objective_bytes(sys));
    double once = model(&t, left);
    solves_solve(&t, 1, true, true, left);
    if (!(model(&t, left) < 1.01 * once)) fail_msg("%g, %g", model(&t, left), once);
    assert_true(fabs(cosine(sys, left, step)) < 1e-4 && fabs(cosine(sys, left, t.y)) < 1e-4);
    free(left), free(step);
    solves_free(&t);
}

/* ---- with fluid ------------------------------------------------------------------------------ */

/* A sheet in water, and one of triangles; %g: stiffness. */
static const char tank[] =
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.01}, \"solver\": {\"type\": \"hybrid\", "
    "\"outer_iterations\": 5}, \"bodies\": [{\"particles\": {\"radius\": 0.02, \"fill\": "
    "[{\"box\": "
    "{\"minimum\": [-0.1, 0.02, -0.1], \"maximum\": [0.1, 0.1, 0.1]}}]}, \"constraints\": "
    "[{\"type\": \"fluid\", \"stiffness\": 3500}]}, {\"surface\": {\"grid\": {\"size\": [0.6, "
    "0.6], "
    "\"vertices\": [13, 14]}, \"area_density\": 0.3}, \"constraints\": [{\"type\": \"spring\", "
    "\"stretching_stiffness\": %g}, {\"type\": \"bending\", \"bending_rigidity\": 1e-3}, "
    "{\"type\": "
    "\"pin\", \"vertices\": {\"border\": true}}]}, {\"surface\": {\"grid\": {\"size\": [0.3, 0.3], "
    "\"vertices\": [4, 5]}, \"translate\": [0, -0.5, 0], \"area_density\": 0.3}, \"constraints\": "
    "[{\"type\": \"triangle\", \"stretching_stiffness\": 400}]}]}";

static pdyn_sim *fill_tank(pdyn_context *context, double stiffness) {
    char text[2048];
    snprintf(text, sizeof text, tank, stiffness);
    pdyn_sim *sim = test_load(context, text);
    for (int k = 0; k < 6; k++) test_step(context, sim);
    return sim;
}

/* Where a part of H changes and is left to doubles. */
static void test_left_out(void **state) {
    (void)state;
    pdyn_context *context = test_context(2);
    pdyn_sim *sim = fill_tank(context, 4000.0);
    assert_true(sim->samples && sim->samples->live > 0 && sim->samples->live < sim->samples->count);
    compare_products(&sim->objective, 0.0);
    compare_products(&sim->objective, 0.3);
    pdyn_free(sim);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* Rounds bring a residual down as far as those with all in doubles do. */
static void test_left_out_refined(void **state) {
    (void)state;
    static const double stiffness[] = {1e3, 1e5, 1e6, 1e9};
    for (int k = 0; k < 4; k++) {
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = fill_tank(context, stiffness[k]);
        double left = left_by_solve(sim, 1e-9);
        if (!(left <= 1.01e-9)) fail_msg("stiffness %g leaves %g", stiffness[k], left);
        pdyn_free(sim);
        pdyn_destroy(context);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_product),  cmocka_unit_test(test_common_motion),
        cmocka_unit_test(test_refined),  cmocka_unit_test(test_directions),
        cmocka_unit_test(test_goes_on),  cmocka_unit_test(test_cut_short),
        cmocka_unit_test(test_left_out), cmocka_unit_test(test_left_out_refined),
    };
    return cmocka_run_group_tests_name("single", tests, NULL, NULL);
}
