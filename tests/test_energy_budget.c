/* Energy from nothing: the warning "energy", and the step that fails. */
#include "warning_support.h"

#include "projdyn/control.h"

#include <string.h>

/* Two lattices of water in each other, and further bodies. */
#define OVERLAPPING(bodies)                                                                        \
    SCENE("'time_step': {'fixed': 0.001}, 'duration': 1",                                          \
          "{'name': 'water', 'particles': {'radius': 0.01, 'fill': ["                              \
          "{'box': {'minimum': [0, 0, 0], 'maximum': [0.1, 0.1, 0.1]}}, {'box': "                  \
          "{'minimum': [0.01, 0.01, 0.01], 'maximum': [0.11, 0.11, 0.11]}}]}, "                    \
          "'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}" bodies,                          \
          "")

/* One of the first steps fails, and the state is that before it. The message names the causes that
 * the run has shown: the overlap, water that was compressed, and particles that passed. Water alone
 * has no use for contact. */
static void test_overlap(void **state) {
    (void)state;
    const char *const scene[] = {OVERLAPPING(""), OVERLAPPING(", " SHEET_AT("sheet", "-1"))};
    for (int sheet = 0; sheet < 2; sheet++) {
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = test_load(context, scene[sheet]);
        uint64_t hash = 0;
        pdyn_status status = PDYN_OK;
        warnings_count(&sim->warnings, WARNING_LEAK, "", 0.0, 1, 0.0);
        warnings_count(&sim->warnings, WARNING_COMPRESSED, "", 0.0, 1, 0.0);
        for (int n = 0; n < 5 && status == PDYN_OK; n++) {
            hash = pdyn_state_hash(sim);
            status = pdyn_step(sim, NULL);
        }
        assert_int_equal(status, PDYN_DIVERGED);
        const char *error = pdyn_last_error(context);
        assert_non_null(strstr(error, "the kinetic energy rises to"));
        assert_non_null(strstr(error, "J; particles overlap at the start"));
        assert_non_null(strstr(error, "; the fluid has been compressed by more than 10 %"));
        assert_non_null(strstr(error, "; bodies have passed through each other or through solids"));
        assert_int_equal(!!strstr(error, ", and the scene has no \"contact\""), sheet);
        assert_null(strstr(error, "unsolved"));
        assert_true(pdyn_state_hash(sim) == hash);
        test_close(sim);
    }
}

/* A stretched sheet releases the energy that the scene gives it. */
static void test_stretched(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        WEIGHTLESS ", 'solver': {'tolerance': 1e-4}",
        GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.2", SPRINGS("1e3")),
        ""));
    for (int k = 0; k < sim->objective.particles; k++) sim->x[3 * k] *= 2.0;
    double fastest = 0.0;
    for (int n = 0; n < 20; n++) fastest = fmax(fastest, test_step(sim).kinetic_energy);
    assert_true(fastest > 0.1);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* Two sheets that begin at a fifth of the contact thickness release the energy of contact. */
static void test_touching(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(WEIGHTLESS, PAIR(SHEET_AT("lower", "0"), SHEET_AT("upper", "0.002")),
                        ", 'contact': {'thickness': 0.01}"));
    double fastest = 0.0;
    for (int n = 0; n < 5; n++) fastest = fmax(fastest, test_step(sim).kinetic_energy);
    assert_true(fastest > 1e-4);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* A bat gives a sheet its speed; there is no fluid. */
static void test_bat(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(WEIGHTLESS, SHEET_AT("sheet", "0"),
                        ", 'contact': {'thickness': 0.01}, 'solids': [{'box': {'minimum': [-1, -1, "
                        "-1], 'maximum': [1, -0.02, 1]}, 'motion': [{'time': 0}, {'time': 1, "
                        "'translate': [0, 5, 0]}]}]"));
    double fastest = 0.0;
    for (int n = 0; n < 10; n++) fastest = fmax(fastest, test_step(sim).kinetic_energy);
    assert_true(fastest > 10.0 * sim->energy.mass);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* A sheet at rest without gravity has the energies of rounding. */
static void test_rounding(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(WEIGHTLESS ", 'solver': {'tolerance': 1e-13, 'outer_iterations': 2}",
                        GRID_SHEET("'name': 'sheet', ", "1, 1", "11, 11",
                                   "'area_density': 0.3, 'rotate': [10, 20, 30]",
                                   SPRINGS("1e6") ", {'type': 'bending', 'bending_rigidity': 0.1}"),
                        ""));
    for (int n = 0; n < 20; n++) test_step(sim);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* A stiff plate at rest in weightlessness, far from the origin: rounding makes its bending energy
 * negative, and it stays where it is. */
static void test_plate_at_rest(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        WEIGHTLESS,
        "{'name': 'plate', 'surface': {'grid': {'size': [3, 0.3], 'vertices': [13, 13]}, "
        "'rotate': [35, 42, -167], 'translate': [0, 4, 0], 'area_density': 60}, 'constraints': "
        "[{'type': 'triangle', 'stretching_stiffness': 3e6}, "
        "{'type': 'bending', 'bending_rigidity': 1e6}]}",
        ""));
    for (int n = 0; n < 3; n++) assert_true(test_step(sim).kinetic_energy < 1e-6);
    test_close(sim);
}

/* Steps with this kinetic energy, J, as the energy budget sees them. */
static void give_energy(pdyn_sim *sim, int steps, double kinetic) {
    pdyn_step_info info = {.kinetic_energy = kinetic};
    for (int k = 0; k < steps; k++) energy_budget_step(sim, &info);
}

/* The total energy falls for some steps and comes back: no warning. It rises after it has been
 * lower for a window of steps: a warning, although it does not reach its start. */
static void test_gain_after_loss(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(WEIGHTLESS, SHEET_AT("sheet", "0"), ""));
    test_step(sim);
    sim->energy.total = 10.0;
    give_energy(sim, 25, 10.0), give_energy(sim, 15, 6.0), give_energy(sim, 25, 10.0);
    assert_null(find_warning(sim, "energy", "").code);
    give_energy(sim, 40, 6.0);
    assert_null(find_warning(sim, "energy", "").code);
    give_energy(sim, 1, 7.0);
    assert_int_equal(find_warning(sim, "energy", "").count, 1);
    test_close(sim);
}

/* Pins let a sheet go, which falls without a warning. A gain after that is warned about; after a
 * constraint that begins, no energy is known to be too much. */
static void test_gain_after_release(void **state) {
    (void)state;
    for (int begins = 0; begins < 2; begins++) {
        pdyn_sim *sim = test_open(
            SCENE(STEPS,
                  GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.2",
                             SPRINGS("1e3") ", {'type': 'pin', 'until': 0.02, "
                                            "'vertices': {'border': true}}"),
                  ""));
        for (int n = 0; n < 20; n++) test_step(sim);
        assert_false(pdyn_is_enabled(sim, 1));
        assert_null(find_warning(sim, "energy", "").code);
        if (begins) assert_int_equal(pdyn_enable(sim, 1, true), PDYN_OK);
        give_energy(sim, 1, 1e3);
        assert_int_equal(find_warning(sim, "energy", "").count, !begins);
        test_close(sim);
    }
}

/* A pin that moves and then lets a sheet go gives energy until then; a gain after that is warned
 * about, after a return to a state before it, too. */
static void test_gain_after_path(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(STEPS,
                        GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.2",
                                   SPRINGS("1e3") ", {'type': 'pin', 'until': 0.02, 'vertices': "
                                                  "{'border': true}, 'path': [[0, 0, 0, 0], "
                                                  "[0.02, 0, 0.1, 0]]}"),
                        ""));
    static char state_memory[1 << 20];
    size_t size;
    for (int round = 0; round < 2; round++) {
        test_step(sim);
        if (!round)
            assert_int_equal(pdyn_save_memory(sim, state_memory, sizeof state_memory, &size),
                             PDYN_OK);
        give_energy(sim, 1, 1e3);
        for (int n = 0; n < 30; n++) test_step(sim);
        assert_false(pdyn_is_enabled(sim, 1));
        assert_null(find_warning(sim, "energy", "").code);
        if (!round) assert_int_equal(pdyn_restore_memory(sim, state_memory, size), PDYN_OK);
    }
    give_energy(sim, 1, 1e3);
    assert_int_equal(find_warning(sim, "energy", "").count, 1);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_overlap),         cmocka_unit_test(test_stretched),
        cmocka_unit_test(test_touching),        cmocka_unit_test(test_bat),
        cmocka_unit_test(test_rounding),        cmocka_unit_test(test_plate_at_rest),
        cmocka_unit_test(test_gain_after_loss), cmocka_unit_test(test_gain_after_release),
        cmocka_unit_test(test_gain_after_path),
    };
    return cmocka_run_group_tests_name("energy_budget", tests, NULL, NULL);
}
