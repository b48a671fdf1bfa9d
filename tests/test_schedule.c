/* Constraints with "from" and "until": when they act, what a program may change, saved states. */
#include "projdyn/control.h"
#include "small_scenes.h"
#include "support.h"

#define HELD_BY(integrator, times)                                                                 \
    SCENE(                                                                                         \
        "'duration': 10, 'frame_interval': 0.1, 'time_step': {'fixed': 0.02, 'integrator': "       \
        "'" integrator "'}, 'solver': {'tolerance': 1e-6}",                                        \
        GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "5, 5", "'area_density': 0.5",                 \
                   PAIR(SPRINGS("1000"), "{'type': 'pin', 'vertices': {'all': true}" times "}")),  \
        "")

#define HELD(times) HELD_BY("euler", times)

enum { PIN = 1, VERTICES = 25 };

static pdyn_context *context;

static int set_up(void **state) {
    context = test_context(1);
    return test_enter_directory(state);
}

static int tear_down(void **state) {
    pdyn_destroy(context);
    return test_leave_directory(state);
}

static pdyn_step_info step(pdyn_sim *sim) {
    pdyn_step_info info = {0};
    if (pdyn_step(sim, &info) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    return info;
}

static double mass_of(const pdyn_sim *sim) {
    double sum = 0.0;
    for (int i = 0; i < VERTICES; i++) sum += pdyn_get_state(sim).mass[i];
    return sum;
}

/* The sheet is at rest until the pins let go, falls freely, and is caught again. 0.3 is not a
 * multiple of 0.02 in binary, nor is 0.5. */
static void test_times(void **state) {
    (void)state;
    pdyn_sim *until = test_load(context, HELD(", 'until': 0.3"));
    pdyn_sim *from = test_load(context, HELD(", 'from': 0.3, 'until': 0.5"));
    double impulse = mass_of(until) * 9.81 * 0.02;
    for (int k = 0; k < 40; k++) {
        pdyn_step_info held = step(until), caught = step(from);
        int free = k < 15 ? 0 : k - 14;
        assert_int_equal(pdyn_is_enabled(until, PIN), k < 15);
        assert_true(fabs(held.momentum[1] + free * impulse) < (free ? 1e-9 : 1e-3) * impulse);
        assert_int_equal(pdyn_is_enabled(from, PIN), k >= 15 && k < 25);
        if (k < 15) assert_true(fabs(caught.momentum[1] + (k + 1) * impulse) < 1e-9 * impulse);
        else if (k > 16 && k < 25) assert_true(fabs(pdyn_get_state(from).x[1]) < 1e-6);
    }
    pdyn_free(until), pdyn_free(from);
}

/* With BDF2, too, the sheet falls freely from the step on in which the pins let go: the weight that
 * they carried in the step before does not go on. */
static void test_release(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, HELD_BY("bdf2", ", 'until': 0.3"));
    double impulse = mass_of(sim) * 9.81 * 0.02;
    for (int k = 0; k < 20; k++)
        assert_true(fabs(step(sim).momentum[1] + (k < 15 ? 0 : k - 14) * impulse) < 1e-3 * impulse);
    pdyn_free(sim);
}

/* A program may switch the constraint after its time, too. */
static void test_program(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, HELD(", 'until': 0.1"));
    for (int k = 0; k < 6; k++) step(sim);
    assert_false(pdyn_is_enabled(sim, PIN));
    assert_int_equal(pdyn_enable(sim, PIN, true), PDYN_OK);
    for (int k = 0; k < 6; k++) step(sim);
    assert_true(pdyn_is_enabled(sim, PIN));
    pdyn_free(sim);
}

/* Before the first step, too. */
static void test_program_starts(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, HELD(", 'from': 0.1"));
    assert_false(pdyn_is_enabled(sim, PIN));
    assert_int_equal(pdyn_enable(sim, PIN, true), PDYN_OK);
    for (int k = 0; k < 3; k++) step(sim);
    assert_true(pdyn_is_enabled(sim, PIN));
    assert_true(fabs(pdyn_get_state(sim).v[1]) < 1e-3);
    pdyn_free(sim);
}

/* Saved before, at and after the time, a run continues with the same bits. */
static void test_resume(void **state) {
    (void)state;
    static const char text[] = HELD(", 'until': 0.1");
    for (int saved = 3; saved < 8; saved++) {
        pdyn_sim *sim = test_load(context, text), *other = test_load(context, text);
        for (int k = 0; k < saved; k++) step(sim);
        assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
        assert_int_equal(pdyn_restore(other, "state"), PDYN_OK);
        for (int k = 0; k < 5; k++) step(sim), step(other);
        assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
        pdyn_free(sim), pdyn_free(other);
    }
    test_remove_file("state");
}

/* Water hits a sheet that its pin has let go before, without gravity. */
#define RELEASED(more)                                                                             \
    SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.005}",                    \
          PAIR(GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "7, 7", "'area_density': 0.5",          \
                          PAIR(SPRINGS("500"),                                                     \
                               "{'type': 'pin', 'vertices': {'vertices': [0]}, 'until': 0.01}")),  \
               FLUID_BOX("'velocity': [0, -2, 0], ", "0.01", "-0.04, 0.05, -0.04",                 \
                         "0.04, 0.13, 0.04", ", 'sound_speed': 30" more)),                         \
          "")

/* The momentum does not change where nothing is anchored any more, also in steps that end at a
 * rough tolerance. */
static void check_momentum(const char *text) {
    pdyn_sim *sim = test_load(context, text);
    pdyn_step_info before = {0}, info;
    for (int k = 0; k < 40; k++) {
        info = step(sim);
        if (k == 4) before = info;
        for (int a = 0; a < 3 && k > 4; a++)
            assert_true(fabs(info.momentum[a] - before.momentum[a]) < 1e-12);
    }
    assert_true(fabs(before.momentum[1]) > 0.5);
    pdyn_free(sim);
}

static void test_momentum(void **state) {
    (void)state;
    check_momentum(RELEASED(""));
    check_momentum(RELEASED("}, {'type': 'no_slip', 'viscosity': 0.5"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_times),   cmocka_unit_test(test_release),
        cmocka_unit_test(test_program), cmocka_unit_test(test_program_starts),
        cmocka_unit_test(test_resume),  cmocka_unit_test(test_momentum),
    };
    return cmocka_run_group_tests_name("schedule", tests, set_up, tear_down);
}
