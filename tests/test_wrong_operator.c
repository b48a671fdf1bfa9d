/* Operators with one fault each: conformance reports it. All are variants of a correct one, that of
 * the example grains.c, which is linked with this program. */
#include "wrong_support.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { ROOM = 1 << 15 }; /* constraints, and numbers of a vector */

static pdyn_operator good;
static int particles; /* of a vector */

static bool neighbours(void *self, const pdyn_neighbours *lists) {
    particles = lists->particles;
    return good.neighbours(self, lists);
}

/* The arrays of the operator, which it may change. */
static double *numbers(const double *array) { return (double *)array; }

/* ---- local ----------------------------------------------------------------------------------- */

static double local_double(void *self, const double *x, double *gradient) {
    return 2.0 * good.local(self, x, gradient);
}

static double local_overwrites(void *self, const double *x, double *gradient) {
    memset(gradient, 0, 3 * (size_t)particles * sizeof *gradient);
    return good.local(self, x, gradient);
}

/* Constraints that have slack have energy, too. */
static double local_of_all(void *self, const double *x, double *gradient) {
    double energy = good.local(self, x, gradient);
    pdyn_one_sided s = good.one_sided(self);
    for (int c = 0; c < s.count; c++) energy += 0.5 * s.stiffness[c] * fmin(s.value[c], 0.0);
    return energy;
}

static double local_without_gradient(void *self, const double *x, double *gradient) {
    static double unused[ROOM];
    (void)gradient;
    return good.local(self, x, unused);
}

static double local_stiffens(void *self, const double *x, double *gradient) {
    double energy = good.local(self, x, gradient);
    pdyn_one_sided s = good.one_sided(self);
    for (int c = 0; c < s.count; c++) numbers(s.stiffness)[c] *= 1.01;
    return energy;
}

/* ---- one_sided ------------------------------------------------------------------------------- */

static pdyn_one_sided one_sided_unsigned(void *self) {
    pdyn_one_sided s = good.one_sided(self);
    for (int c = 0; c < s.count; c++) numbers(s.value)[c] = fabs(s.value[c]);
    return s;
}

static pdyn_one_sided one_sided_unit_squares(void *self) {
    pdyn_one_sided s = good.one_sided(self);
    for (int c = 0; c < s.count; c++) numbers(s.squares)[c] = 1.0;
    return s;
}

static pdyn_one_sided one_sided_not_held(void *self) {
    pdyn_one_sided s = good.one_sided(self);
    for (int i = 0; i < particles; i++) numbers(s.weight_sum)[i] = 0.0;
    return s;
}

/* ---- rate, force, diagonal ------------------------------------------------------------------- */

static void rate_sign(void *self, const bool *which, const double *u, double *rate) {
    good.rate(self, which, u, rate);
    for (int c = 0; c < good.one_sided(self).count; c++) rate[c] *= -1.0;
}

static void rate_of_all(void *self, const bool *which, const double *u, double *rate) {
    static bool all[ROOM];
    (void)which;
    memset(all, 1, sizeof all);
    good.rate(self, all, u, rate);
}

static void force_overwrites(void *self, const double *multiplier, double *y) {
    memset(y, 0, 3 * (size_t)particles * sizeof *y);
    good.force(self, multiplier, y);
}

/* Some particles get no force: the reaction is missing. */
static void force_one_way(void *self, const double *multiplier, double *y) {
    static double all[ROOM];
    memset(all, 0, sizeof all);
    good.force(self, multiplier, all);
    for (int i = 0; i < particles; i += 2) vec3_add(y + 3 * i, 1.0, all + 3 * i);
}

static void force_stiff(void *self, const double *multiplier, double *y) {
    static double stiff[ROOM];
    pdyn_one_sided s = good.one_sided(self);
    for (int c = 0; c < s.count; c++) stiff[c] = s.stiffness[c] * multiplier[c];
    good.force(self, stiff, y);
}

static void diagonal_overwrites(void *self, const double *stiffness, double *blocks) {
    memset(blocks, 0, 6 * (size_t)particles * sizeof *blocks);
    good.diagonal(self, stiffness, blocks);
}

static void diagonal_twice(void *self, const double *stiffness, double *blocks) {
    good.diagonal(self, stiffness, blocks), good.diagonal(self, stiffness, blocks);
}

/* ---- create ---------------------------------------------------------------------------------- */

static void *leaked[64]; /* memory that the operator does not free; freed by the test */

static void *create_leaks(const void *par, const pdyn_body *body, const pdyn_services *services) {
    int k = 0;
    while (leaked[k]) k++;
    leaked[k] = services->allocate(services->core, NULL, 0, 8);
    return good.create(par, body, services);
}

/* ---- the tests ------------------------------------------------------------------------------- */

static bool is_reported(pdyn_operator op, const char *expected) {
    pdyn_constraint_type type = *pdyn_plugin_table.constraints[0];
    type.matrix_free = &op;
    return wrong_type_is_reported(type, expected);
}

static int set_up(void **state) {
    (void)state;
    good = *pdyn_plugin_table.constraints[0]->matrix_free;
    return 0;
}

static void test_good(void **state) {
    (void)state;
    assert_true(is_reported(good, NULL));
}

/* Constraints of pairs have numbers beyond those of particles, where no array of particles may be
 * read (address sanitizer): a pile of grains falls on a floor and stays on it. */
static void test_pairs(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &pdyn_plugin_table), PDYN_OK);
    pdyn_sim *sim = test_load(
        context, "{'duration': 1, 'time_step': {'fixed': 0.005}, 'boundary': 'points', 'bodies': "
                 "[{'particles': {'radius': 0.02, 'rest_density': 2000, 'fill': [{'box': "
                 "{'minimum': [-0.1, 0.02, -0.1], 'maximum': [0.1, 0.18, 0.1]}}]}, 'velocity': [0, "
                 "-1, 0], 'constraints': [{'type': 'grains'}]}], 'solids': [{'box': {'minimum': "
                 "[-0.4, 0, -0.4], 'maximum': [0.4, 1, 0.4]}, 'open': ['+y']}]}");
    int impacts = 0;
    for (int n = 0; n < 20; n++) impacts += (int)test_step(sim).impacts;
    const pdyn_state s = pdyn_get_state(sim);
    assert_true(impacts > 0);
    for (int i = 0; i < s.particles; i++) assert_true(s.x[3 * i + 1] > 0.0);
    test_close(sim);
}

#define WRONG(callback, wrong, text)                                                               \
    op = good, op.neighbours = neighbours, op.callback = wrong, missed += !is_reported(op, text)

static void test_wrong(void **state) {
    (void)state;
    pdyn_operator op;
    int missed = 0;
    WRONG(local, local_double, "have different energies");
    WRONG(local, local_overwrites, "local overwrites");
    WRONG(local, local_of_all, "have different energies");
    WRONG(local, local_without_gradient, "have different gradients");
    WRONG(local, local_stiffens, "the operator's energy");
    WRONG(one_sided, one_sided_unsigned, "the operator's energy");
    WRONG(one_sided, one_sided_unit_squares, "has squares = 1");
    WRONG(one_sided, one_sided_not_held, "falls with the damping");
    WRONG(rate, rate_sign, "H is not");
    WRONG(rate, rate_of_all, "which is not marked");
    WRONG(force, force_overwrites, "force overwrites");
    WRONG(force, force_one_way, "H is not symmetric");
    WRONG(force, force_stiff, "have different products");
    WRONG(diagonal, diagonal_overwrites, "diagonal overwrites");
    WRONG(diagonal, diagonal_twice, "block diagonal");
    WRONG(create, create_leaks, "were not given back");
    for (int k = 0; leaked[k]; k++) free(leaked[k]);
    assert_int_equal(missed, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_good), cmocka_unit_test(test_pairs),
                                       cmocka_unit_test(test_wrong)};
    return cmocka_run_group_tests_name("wrong operator", tests, set_up, NULL);
}
