/* Particles that a program holds (pdyn_hold). */
#include "control_support.h"

#include "projdyn/vec3.h"

static const char sheet[] = SHEET;

/* The energy of a hold is that of a spring, and a part of the energy of constraints. */
static void assert_energy(const pdyn_sim *sim, double energy, double stiffness, double distance) {
    double scene = 0.0;
    for (int k = 0; k < sim->constraints; k++) scene += sim->objective.batch[k]->energy;
    double held = 0.5 * stiffness * distance * distance;
    assert_true(held > 0.0 && fabs(energy - scene - held) < 1e-9 * energy);
}

static void hold_and_release(const char *text) {
    if (test_lacks_solver(text)) return;
    pdyn_sim *sim = test_load(context, text);
    const double *x = pdyn_get_state(sim).x + 3 * CORNER;
    double target[3] = {0.2, 0.1, 0.1};
    pdyn_step_info info;
    take_steps(sim, 5);
    good(pdyn_hold(sim, CORNER, 1e4, target));
    take_steps(sim, 200);
    assert_true(vec3_distance(x, target) < 2e-3);
    for (int k = 0; k < 20; k++) {
        target[0] += 0.002;
        good(pdyn_hold(sim, CORNER, 1e4, target));
        good(pdyn_step(sim, &info));
    }
    assert_true(vec3_distance(x, target) < 0.02);
    assert_true(info.pin_reaction[1] > 0.0);
    assert_energy(sim, info.constraint_energy, 1e4, vec3_distance(x, target));
    continues(sim, text);
    good(pdyn_release(sim, CORNER));
    good(pdyn_release(sim, CORNER));
    take_steps(sim, 60);
    assert_true(x[1] < 0.0); /* it falls */
    good(pdyn_hold(sim, CORNER, 100.0, target));
    good(pdyn_release(sim, CORNER));
    good(pdyn_hold(sim, CORNER - 1, 100.0, target));
    continues(sim, text);
    pdyn_free(sim);
}

static void test_holds(void **state) {
    (void)state;
    hold_and_release(sheet);
    hold_and_release(PINNED(SOLVER("cholesky", "projective"), "1000"));
    hold_and_release(PINNED(SOLVER("cg", "newton"), "1000"));
}

/* A held sheet of 1 kg falls from its release on: its speed is g times the time since then. */
static void test_released_sheet(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(
        context, "{'duration': 9, 'frame_interval': 0.1, 'time_step': {'fixed': 0.01}, 'bodies': "
                 "[{'surface': {'grid': {'size': [1, 1], 'vertices': [2, 2]}, 'rotate': [90, 0, "
                 "0], 'area_density': 1}, 'constraints': [{'type': 'spring', "
                 "'stretching_stiffness': 100}]}]}");
    const pdyn_state at = pdyn_get_state(sim);
    for (int i = 0; i < 4; i++) good(pdyn_hold(sim, i, 1e4, at.x + 3 * i));
    take_steps(sim, 100);
    for (int i = 0; i < 4; i++) good(pdyn_release(sim, i));
    for (int n = 1; n <= 20; n++) {
        take_steps(sim, 1);
        assert_true(fabs(at.v[1] + 0.0981 * n) < 2e-3);
    }
    pdyn_free(sim);
}

/* In a fluid, and beside one. */
static void test_hold_in_water(void **state) {
    (void)state;
    static const char *const scenes[] = {fluid, hybrid};
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_load(context, scenes[k]);
        const double target[3] = {0.1, 0.1, 0.1};
        take_steps(sim, 2);
        int particle = pdyn_get_state(sim).particles - 15;
        good(pdyn_hold(sim, particle, 1e5, target));
        take_steps(sim, 20);
        assert_true(vec3_distance(pdyn_get_state(sim).x + 3 * particle, target) < 0.02);
        continues(sim, scenes[k]);
        pdyn_free(sim);
    }
}

/* An outlet removes a particle that is held and pushed: both end with it. */
static void test_hold_removed(void **state) {
    (void)state;
    static const char dust[] =
        "{'duration': 9, 'gravity': [0, 0, 0], 'bodies': [{'name': 'dust', 'particles': {'radius': "
        "0.01, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.06, 0.02, 0.02]}}]}, "
        "'constraints': [{'type': 'viscosity', 'viscosity': 1}]}], 'outlets': [{'box': "
        "{'minimum': [0.2, -9, -9], 'maximum': [9, 9, 9]}}]}";
    pdyn_sim *sim = test_load(context, dust);
    const pdyn_state s = pdyn_get_state(sim);
    const double target[3] = {0.9, 0.01, 0.01};
    good(pdyn_hold(sim, 0, 1.0, target));
    good(pdyn_set_forces(sim, 0, 1, (double[]){1e-3, 0, 0}));
    pdyn_step_info info = {0};
    for (int k = 0; k < 2000 && s.live[0]; k++) good(pdyn_step(sim, &info));
    assert_false(s.live[0]);
    take_steps(sim, 20);
    assert_true(vec3_length(s.x) == 0.0 && vec3_length(s.v) == 0.0);
    continues(sim, dust);
    pdyn_free(sim);
}

/* Steps from a state, restored into a simulation whose hold is at another place or has another
 * stiffness, have the bits of the first time. Solvers are made anew for another stiffness only. */
static void restored(pdyn_sim *sim, const void *state, size_t size, uint64_t hash,
                     double stiffness) {
    good(pdyn_hold(sim, CORNER, stiffness, (double[]){0.3, 0.2, 0.2}));
    take_steps(sim, 3);
    static const char mark[] = "lost where solvers are made anew";
    sim->choice.reason = mark;
    good(pdyn_restore_memory(sim, state, size));
    assert_true((sim->choice.reason == mark) == (stiffness == 1e4));
    take_steps(sim, 5);
    assert_true(pdyn_state_hash(sim) == hash);
}

/* A state brings holds back that were released since. */
static void restored_after_release(pdyn_sim *sim, const void *state, size_t size, uint64_t hash) {
    for (int i = 0; i < VERTICES; i++) good(pdyn_release(sim, i));
    take_steps(sim, 3);
    good(pdyn_restore_memory(sim, state, size));
    take_steps(sim, 5);
    assert_true(pdyn_state_hash(sim) == hash);
}

static void restore_holds(const char *text) {
    if (test_lacks_solver(text)) return;
    static unsigned char bytes[1 << 20];
    size_t size;
    pdyn_sim *sim = test_load(context, text);
    good(pdyn_hold(sim, CORNER, 1e4, (double[]){0.2, 0.1, 0.1}));
    good(pdyn_hold(sim, CORNER - 1, 1e3, (double[]){0.1, 0.1, 0.1}));
    take_steps(sim, 5);
    good(pdyn_save_memory(sim, bytes, sizeof bytes, &size));
    take_steps(sim, 5);
    uint64_t hash = pdyn_state_hash(sim);
    restored(sim, bytes, size, hash, 1e4);
    restored(sim, bytes, size, hash, 2e4);
    good(pdyn_release(sim, CORNER));
    good(pdyn_hold(sim, CORNER - 2, 1e4, (double[]){0.1, 0.1, 0.1}));
    restored(sim, bytes, size, hash, 2e4);
    restored_after_release(sim, bytes, size, hash);
    continues(sim, text);
    pdyn_free(sim);
}

static void test_restored_holds(void **state) {
    (void)state;
    restore_holds(sheet);
    restore_holds(PINNED(SOLVER("cholesky", "projective"), "1000"));
    restore_holds(PINNED(SOLVER("cg", "newton"), "1000"));
    restore_holds(PINNED(SOLVER("hybrid", "newton"), "1000"));
}

static void test_wrong_holds(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, inlet);
    const double target[3] = {0};
    assert_true(!pdyn_get_state(sim).live[399]);
    refused(pdyn_hold(sim, 399, 1.0, target), "pdyn_hold: particle 399 is not in the scene");
    assert_int_equal(pdyn_hold(sim, 400, 1.0, target), PDYN_BAD_CALL);
    assert_int_equal(pdyn_hold(sim, 0, 1.0, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_release(sim, -1), PDYN_BAD_CALL);
    pdyn_free(sim);
    sim = test_load(context, sheet);
    refused(pdyn_hold(sim, 0, -1.0, target),
            "pdyn_hold: expected a stiffness from 0 to 1e+15 N/m, found -1");
    refused(pdyn_hold(sim, 0, 1.0, (double[]){0, NAN, 0}),
            "pdyn_hold: expected a target from -1e+06 to 1e+06 m, found nan");
    pdyn_free(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_holds),          cmocka_unit_test(test_released_sheet),
        cmocka_unit_test(test_hold_in_water),  cmocka_unit_test(test_hold_removed),
        cmocka_unit_test(test_restored_holds), cmocka_unit_test(test_wrong_holds),
    };
    return cmocka_run_group_tests_name("hold", tests, control_set_up, control_tear_down);
}
