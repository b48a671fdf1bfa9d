/* Several operators (matrix-free constraints) in one scene: core asks each for what it has. */
#include "support.h"

extern const pdyn_constraint_type pdyn_constraint_fluid;

#define WATER(constraints)                                                                         \
    "{\"duration\": 1, \"time_step\": {\"fixed\": 0.004, \"integrator\": \"euler\"}, "             \
    "\"frame_interval\": 0.01,"                                                                    \
    " \"solver\": {\"type\": \"cg\", \"tolerance\": 1e-9, \"linear_tolerance\": 1e-12,"            \
    " \"outer_iterations\": 60, \"linear_iterations\": 1000}, \"bodies\": [{\"name\": \"water\","  \
    " \"particles\": {\"radius\": 0.02, \"fill\": [{\"box\": {\"minimum\": [0, 0, 0],"             \
    " \"maximum\": [0.16, 0.12, 0.16]}}]}, \"constraints\": [" constraints                         \
    "]}], \"solids\": [{\"name\": \"floor\", \"box\": {\"minimum\": [0, 0, 0], \"maximum\":"       \
    " [0.2, 1, 0.2]}}]}"
#define DAMPED "\"viscosity\": 0, \"damping\": 0.01"
#define HALF   "\"stiffness\": 1000, " DAMPED

/* The fluid's constraint under another name, which changes no velocities and tells nothing. */
static pdyn_operator silent;
static pdyn_constraint_type twin;
static const pdyn_constraint_type *const types[] = {&twin, NULL};
static const pdyn_plugin plugin = {PDYN_ABI, "twin", types, NULL};

static pdyn_context *context_of_both(int threads) {
    pdyn_context *context = test_context(threads);
    silent = *pdyn_constraint_fluid.matrix_free;
    silent.density = silent.pressure = NULL, silent.velocity = NULL;
    twin = pdyn_constraint_fluid, twin.name = "twin", twin.matrix_free = &silent;
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    return context;
}

/* Two constraints of half the stiffness are one of the whole; not with bdf2, where the impact part
 * of a force depends on the stiffness of its own constraint. */
static void test_two(void **state) {
    static const char *const scene[] = {
        WATER("{\"type\": \"fluid\", \"stiffness\": 2000, " DAMPED "}"),
        WATER("{\"type\": \"fluid\", " HALF "}, {\"type\": \"twin\", " HALF "}"),
        WATER("{\"type\": \"twin\", " HALF "}, {\"type\": \"fluid\", " HALF "}")};
    const char *const set = *state;
    pdyn_context *context = context_of_both(2);
    pdyn_sim *sim[3];
    for (int k = 0; k < 3; k++) sim[k] = test_load_with(context, scene[k], &set, 1);
    int n = sim[0]->objective.particles;
    assert_true(sim[1]->objective.batches == 2 && sim[1]->anchored);
    for (int step = 0; step < 10; step++)
        for (int k = 0; k < 3; k++) test_step(sim[k]);
    for (int k = 1; k < 3; k++) {
        assert_true(test_distance(sim[0]->x, sim[k]->x, 3 * n) < 1e-5);
        for (int i = 0; i < n; i++) {
            assert_true(fabs(sim[0]->density[i] - sim[k]->density[i]) < 0.1);
            assert_true(fabs(0.5 * sim[0]->pressure[i] - sim[k]->pressure[i]) < 1.0);
            assert_true(fabs(0.5 * sim[0]->pressure_before[i] - sim[k]->pressure_before[i]) < 1.0);
        }
    }
    for (int k = 0; k < 3; k++) pdyn_free(sim[k]);
    pdyn_destroy(context);
}

int main(void) {
    static const char *const solver[] = {"solver.type=cg", "solver.type=dual"};
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(test_two, (void *)solver[0]),
                                       cmocka_unit_test_prestate(test_two, (void *)solver[1])};
    return cmocka_run_group_tests_name("operators", tests, NULL, NULL);
}
