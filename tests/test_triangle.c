/* In-plane strain: projection against an iteration, tangent against finite differences, elastic
 * moduli. */
#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static pdyn_context *context;
static pdyn_sim *sim;

static int set_up(void **state) {
    (void)state;
    context = test_context(1);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    pdyn_destroy(context);
    return 0;
}

/* Loads a square of 2 x 2 m of two triangles with 5 N/m and this range. */
static struct batch *load(const char *range) {
    char text[512];
    snprintf(text, sizeof text,
             SCENE("'duration': 1",
                   GRID_SHEET("", "2, 2", "2, 2", "'area_density': 1", STRAIN("5%s")), ""),
             range);
    sim = test_load(context, text);
    sim->objective.h = 1.0;
    return sim->objective.batch[0];
}

/* u times the inverse square root of u'u, by Newton's iteration y = (y + y'^-1) / 2 on the 3 x 3
 * matrix of both columns and their normal. */
static void nearest_isometry(const double *u, double size, double *p) {
    double y[9];
    memcpy(y, u, 6 * sizeof *y);
    for (int k = 0; k < 6; k++) y[k] /= size;
    vec3_cross(y + 6, y, y + 3);
    double length = vec3_length(y + 6);
    for (int k = 6; k < 9; k++) y[k] /= length;
    for (int n = 0; n < 60; n++) {
        double inverse[9];
        for (int a = 0; a < 3; a++)
            vec3_cross(inverse + 3 * a, y + 3 * ((a + 1) % 3), y + 3 * ((a + 2) % 3));
        double volume = vec3_dot(y, inverse);
        for (int k = 0; k < 9; k++) y[k] = 0.5 * (y[k] + inverse[k] / volume);
    }
    for (int k = 0; k < 6; k++) p[k] = size * y[k];
}

static void project_at(struct batch *b, const double *u, double *p) {
    memcpy((double *)b->view.u, u, 6 * sizeof *u);
    b->type->project(b->params, &b->view, 0, 1);
    memcpy(p, b->view.p, 6 * sizeof *p);
}

static void random_gradient(uint64_t *seed, double stretch, double *u) {
    for (int k = 0; k < 6; k++) u[k] = 0.3 * test_random(seed) + (k % 4 == 0 ? stretch : 0.0);
}

static void test_isometry(void **state) {
    (void)state;
    struct batch *b = load("");
    double root = sqrt(2.0); /* square root of the area */
    uint64_t seed = 11;
    for (int n = 0; n < 200; n++) {
        double u[6], p[6], expected[6];
        random_gradient(&seed, root, u);
        project_at(b, u, p);
        nearest_isometry(u, root, expected);
        assert_true(test_distance(p, expected, 6) < 1e-12);
    }
    pdyn_free(sim);
}

/* Above its range no eigenvalue is clamped: the tangent is the derivative of the projection. Inside
 * the range it is the identity, except for the tilt of the plane. */
static void test_tangent(void **state) {
    (void)state;
    struct batch *b = load(", 'shortest': 0.9, 'longest': 1.1");
    double root = sqrt(2.0);
    uint64_t seed = 13;
    for (int n = 0; n < 200; n++) {
        double u[6], p[6], q[6], J[36] = {0}, d[6], h = 1e-6;
        random_gradient(&seed, root * (n % 2 ? 1.6 : 1.35), u);
        project_at(b, u, p);
        b->type->tangent(b->params, &b->view, 0, 1, J);
        if (test_distance(p, u, 6) < 1e-12) continue;
        for (int k = 0; k < 6; k++) {
            for (int i = 0; i < 6; i++) d[i] = u[i] + (i == k ? h : 0.0);
            project_at(b, d, p);
            d[k] -= 2.0 * h;
            project_at(b, d, q);
            for (int i = 0; i < 6; i++) assert_near((p[i] - q[i]) / (2.0 * h), J[6 * i + k], 1e-6);
        }
    }
    pdyn_free(sim);
}

/* A collapsed triangle gives finite numbers. */
static void test_collapsed(void **state) {
    (void)state;
    static const double u[3][6] = {{0}, {1, 0, 0, 0, 0, 0}, {1, 1, 0, 2, 2, 0}};
    struct batch *b = load("");
    for (int n = 0; n < 3; n++) {
        double p[6], J[36] = {0};
        project_at(b, u[n], p);
        b->type->tangent(b->params, &b->view, 0, 1, J);
        for (int k = 0; k < 6; k++) assert_true(isfinite(p[k]));
        for (int k = 0; k < 36; k++) assert_true(isfinite(J[k]));
    }
    pdyn_free(sim);
}

/* Energy of the sheet stretched to (1 + x, 1 + y) and sheared by the angle z, J. */
static double energy_of(const double strain[3]) {
    double x[12 + 1] = {0}, gradient[12 + 1], energy;
    for (int v = 0; v < 4; v++) {
        const double *r = sim->x + 3 * v;
        x[3 * v] = r[0] * (1.0 + strain[0]) + strain[2] * r[2];
        x[3 * v + 2] = r[2] * (1.0 + strain[1]);
    }
    assert_int_equal(objective_local(&sim->objective, x, &energy, gradient), PDYN_OK);
    return sim->objective.batch[0]->energy;
}

/* Young's modulus times thickness Y, no Poisson's effect, shear modulus Y / 2; no energy within the
 * range. */
static void test_moduli(void **state) {
    (void)state;
    const double e = 1e-4, area = 4.0, Y = 5.0;
    load("");
    assert_near(energy_of((double[]){e, 0, 0}) / (0.5 * Y * area * e * e), 1.0, 1e-3);
    assert_near(energy_of((double[]){e, e, 0}) / (Y * area * e * e), 1.0, 1e-3);
    assert_near(energy_of((double[]){e, -e, 0}) / (Y * area * e * e), 1.0, 1e-3);
    assert_near(energy_of((double[]){0, 0, e}) / (0.25 * Y * area * e * e), 1.0, 1e-3);
    pdyn_free(sim);
    load(", 'shortest': 0.8, 'longest': 1.1");
    assert_near(energy_of((double[]){-0.19, 0.09, 0}), 0.0, 1e-20);
    assert_near(energy_of((double[]){0.2, -0.3, 0}) / (0.5 * Y * area * 0.02), 1.0, 1e-9);
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isometry),
        cmocka_unit_test(test_tangent),
        cmocka_unit_test(test_collapsed),
        cmocka_unit_test(test_moduli),
    };
    return cmocka_run_group_tests_name("triangle", tests, set_up, tear_down);
}
