/* Diverged steps are taken back and repeated with a quarter of the length. */
#include "warning_support.h"

#include <string.h>

static const char drop[] = SCENE(
    "'duration': 1, 'time_step': {'fixed': 0.004}, 'frame_interval': 0.01, 'solver': {'type': "
    "'cg', 'tolerance': 1e-6}",
    FLUID_BOX("'name': 'water', ", "0.02", "0, 0, 0", "0.2, 0.2, 0.2", ""),
    ", 'solids': [{'name': 'floor', 'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 1, 0.2]}}]");

/* The scene's solver, made to fail for steps longer than `longest`. */
static const pdyn_global_solver *own;
static struct objective *objective_of_own;
static double longest;

static pdyn_status fail_where_long(void *self, double *b, double *y, const pdyn_stop *stop,
                                   int *iterations) {
    pdyn_status status = own->solve(self, b, y, stop, iterations);
    if (objective_of_own->h > longest) y[4] = NAN;
    return status;
}

static pdyn_sim *load(pdyn_global_solver *failing, const char *set, double limit) {
    pdyn_sim *sim = test_open_with(drop, &set, 1);
    *failing = *(own = sim->solver), failing->solve = fail_where_long;
    objective_of_own = &sim->objective, longest = INFINITY, sim->solver = failing;
    for (int k = 0; k < 5; k++) assert_int_equal(test_step(sim).retries, 0);
    longest = limit;
    return sim;
}

static void test_shorter(void **state) {
    (void)state;
    pdyn_global_solver failing;
    pdyn_sim *sim = load(&failing, "solver.retries=4", 0.0006);
    double time = pdyn_time(sim);
    pdyn_step_info info = test_step(sim);
    assert_int_equal(info.retries, 2);
    assert_true(info.h <= 0.0006 && pdyn_time(sim) == time + info.h);
    const char *text = find_warning(sim, "retries", "").text;
    assert_non_null(strstr(text, "2 attempts at a step failed and were repeated with a shorter "
                                 "one; reason of the last one: the direction of solver \"cg\""));
    longest = INFINITY;
    for (int k = 0; k < 20; k++) info = test_step(sim);
    assert_true(info.retries == 0 && info.h > 0.003 && info.kinetic_energy < 0.1);
    test_close(sim);
}

static void ends(const char *set) {
    pdyn_global_solver failing;
    pdyn_sim *sim = load(&failing, set, 0.0);
    uint64_t hash = pdyn_state_hash(sim);
    double history = sim->history;
    assert_true(history > 0.0);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_DIVERGED);
    assert_error("step 6 of");
    assert_true(pdyn_state_hash(sim) == hash && sim->history == history);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_BAD_CALL);
    test_close(sim);
}

static void test_used_up(void **state) {
    (void)state;
    ends("solver.retries=0");
    ends("solver.retries=3");
}

/* A particle that moves faster than STEP_MAX_SPEED, or beyond STEP_MAX_POSITION. */
static void test_out_of_range(void **state) {
    (void)state;
    static const char falling[] = SCENE(
        "'duration': 1, 'time_step': {'fixed': 0.01}",
        GRID_SHEET("'name': 'sheet', ", "1, 1", "3, 3", "'area_density': 0.5", SPRINGS("1000")),
        "");
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(falling);
        int particles = pdyn_get_state(sim).particles;
        for (int i = 0; i < particles; i++) {
            if (k) sim->x[3 * i + 2] += 1.001 * STEP_MAX_POSITION;
            else sim->v[3 * i + 2] = 1.001 * STEP_MAX_SPEED;
        }
        uint64_t hash = pdyn_state_hash(sim);
        assert_int_equal(pdyn_step(sim, NULL), PDYN_DIVERGED);
        assert_error("beyond 1e+09 m or 1e+07 m/s");
        assert_true(pdyn_state_hash(sim) == hash);
        test_close(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shorter),
        cmocka_unit_test(test_used_up),
        cmocka_unit_test(test_out_of_range),
    };
    return cmocka_run_group_tests_name("retry", tests, NULL, NULL);
}
