/* Saved states: resuming gives the same bits; a state of another scene is refused. */
#include "support.h"

#include "projdyn/control.h"

/* All kinds of state that last from step to step: lists, pressures, emitted particles, moving
 * solids, boundary pressures. */
static const char fluid[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'solver': "
    "{'outer_iterations': 1, 'linear_iterations': 8}, 'bodies': [{'name': 'water', 'particles': "
    "{'radius': 0.02, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.2, 0.2]}}], "
    "'inlets': [{'rectangle': {'center': [0.3, 0.5, 0.2], 'size': [0.12, 0.12]}, 'direction': [0, "
    "-1, 0], 'speed': 2}]}, 'constraints': [{'type': 'fluid'}]}], 'outlets': [{'box': {'minimum': "
    "[0, 0, 0.3], 'maximum': [0.4, 0.03, 0.4]}}], 'solids': [{'name': 'tank', 'box': {'minimum': "
    "[0, 0, 0], 'maximum': [0.4, 0.6, 0.4]}}, {'name': 'stirrer', 'sphere': {'center': [0.28, 0.1, "
    "0.1], 'radius': 0.05}, 'motion': [{'time': 0}, {'time': 1, 'translate': [0, 0.2, 0.2]}]}]}";

static const char sheet[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}",
          PAIR(FLUID_BOX("'name': 'water', ", "0.02", "-0.1, 0.03, -0.1", "0.1, 0.07, 0.1", ""),
               GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.5",
                          PAIR(SPRINGS("1000"), PINS("'border': true")))),
          "");

/* Friction with memory, contact pairs, a moving solid. */
static const char touching[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'contact': "
          "{'thickness': 0.01, 'friction': 0.5}",
          GRID_SHEET("", "0.4, 0.4", "9, 9", "'translate': [0.01, 0.12, 0], 'area_density': 0.5",
                     SPRINGS("1000")),
          ", 'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 0.1}, 'motion': [{'time': 0}, "
          "{'time': 1, 'translate': [0, 0.2, 0], 'rotate': [0, 90, 0]}]}]");

/* An inlet lets go of lists while a solid moves past the places of its points at the start. */
static const char stirred[] =
    "{'duration': 1, 'frame_interval': 0.02, 'time_step': {'maximum': 0.004}, 'bodies': [{'name': "
    "'water', 'particles': {'radius': 0.02, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': "
    "[0.8, 0.24, 0.24]}}], 'inlets': [{'rectangle': {'center': [0.7, 0.5, 0.12], 'size': [0.08, "
    "0.08]}, 'direction': [0, -1, 0], 'speed': 2}]}, 'constraints': [{'type': 'fluid'}]}], "
    "'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.8, 0.6, 0.24]}}, "
    "{'name': 'ball', 'sphere': {'center': [0.12, 0.1, 0.12], 'radius': 0.07}, 'motion': [{'time': "
    "0}, {'time': 1, 'translate': [0.6, 0, 0]}]}]}";

/* Surface tension reads the points of a moving solid where they are at the beginning of a step. */
static const char drawn[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'contact': "
    "{'thickness': 0.008, 'friction': 0.3}, 'bodies': [{'name': 'water', 'particles': {'radius': "
    "0.02, 'fill': [{'box': {'minimum': [0.04, 0, 0.04], 'maximum': [0.36, 0.16, 0.36]}}]}, "
    "'constraints': [{'type': 'fluid'}, {'type': 'surface_tension', 'tension': 0.07}]}, {'name': "
    "'bag', 'surface': {'grid': {'size': [0.3, 0.3], 'vertices': [9, 9]}, 'translate': [0.2, 0.3, "
    "0.2], 'area_density': 0.5}, 'constraints': [{'type': 'triangle', 'stretching_stiffness': "
    "1000}]}], 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.4, 0.6, "
    "0.4]}}, {'name': 'ball', 'sphere': {'center': [0.2, 0.08, 0.2], 'radius': 0.05}, 'motion': "
    "[{'time': 0}, {'time': 1, 'translate': [0, 0.2, 0], 'rotate': [0, 90, 0]}]}]}";

/* Contact of two sheets, which looks at the particles that an inlet and an outlet move in the step
 * after. */
static const char fed[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'contact': "
    "{'thickness': 0.01, 'friction': 0.3}, 'solver': {'type': 'cg'}, 'bodies': [{'name': 'low', "
    "'surface': {'grid': {'size': [0.3, 0.3], 'vertices': [9, 9]}, 'area_density': 0.5}, "
    "'constraints': [{'type': 'spring', 'stretching_stiffness': 300}, {'type': 'pin', 'stiffness': "
    "1e5, 'vertices': {'border': true}}]}, {'name': 'high', 'surface': {'grid': {'size': [0.3, "
    "0.3], 'vertices': [9, 9]}, 'rotate': [0, 0.2, 0], 'translate': [0.01, 0.006, 0.013], "
    "'area_density': 0.5}, 'constraints': [{'type': 'spring', 'stretching_stiffness': 300}]}, "
    "{'name': 'water', 'particles': {'radius': 0.01, 'budget': 200, 'inlets': [{'rectangle': "
    "{'center': [0, 3, 0], 'size': [0.06, 0.08]}, 'direction': [1, 0, 0], 'speed': 2.1}]}, "
    "'constraints': [{'type': 'fluid', 'stiffness': 1e4}]}], 'outlets': [{'box': {'minimum': "
    "[0.05, 2, -1], 'maximum': [9, 4, 1]}}]}";

/* Solvers are made anew when the pin lets go, where dampers have other weights than at the start.
 */
static const char let_go[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.005}",
          GRID_SHEET("", "0.4, 0.4", "17, 17", "'area_density': 0.5",
                     PAIR("{'type': 'spring', 'stretching_stiffness': 1000, 'damping': 0.02}",
                          PAIR(PINS("'box': {'minimum': [-1, -1, -1], 'maximum': [-0.19, 1, 1]}"),
                               "{'type': 'pin', 'vertices': {'box': {'minimum': [0.19, -1, -1], "
                               "'maximum': [1, 1, 1]}}, 'until': 0.025}"))),
          "");

/* The same beside rows that come and go. */
static const char thick[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.005}, 'solver': {'type': "
    "'cg'}, 'bodies': [{'name': 'water', 'particles': {'radius': 0.02, 'fill': [{'box': "
    "{'minimum': [0, 0, 0], 'maximum': [0.24, 0.28, 0.24]}}]}, 'constraints': [{'type': 'fluid', "
    "'compression': 1e-5}, {'type': 'viscosity', 'viscosity': 5}]}, {'name': 'sheet', 'surface': "
    "{'grid': {'size': [0.2, 0.2], 'vertices': [6, 6]}, 'translate': [0.12, 0.5, 0.12], "
    "'area_density': 0.5}, 'constraints': [{'type': 'spring', 'stretching_stiffness': 1000}, "
    "{'type': 'pin', 'vertices': {'all': true}, 'until': 0.025}]}], 'solids': [{'name': 'tank', "
    "'box': {'minimum': [0, 0, 0], 'maximum': [0.24, 0.7, 0.24]}}]}";

/* A sheet is drawn through water: pairs around its border become hidden and visible. */
static const char parted[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.005}, 'bodies': [{'name': "
    "'water', 'particles': {'radius': 0.02, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': "
    "[0.4, 0.2, 0.24]}}]}, 'constraints': [{'type': 'fluid'}]}, {'name': 'sheet', 'surface': "
    "{'grid': {'size': [0.16, 0.16], 'vertices': [5, 5]}, 'translate': [0.12, 0.1, 0.12], "
    "'area_density': 0.5}, 'constraints': [{'type': 'pin', 'vertices': {'all': true}, 'path': "
    "[[0, 0, 0, 0], [1, 2, 0, 0]]}]}], 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], "
    "'maximum': [0.4, 0.7, 0.24]}}]}";

static void step_often(pdyn_sim *sim, int steps) {
    for (int k = 0; k < steps; k++) test_step(sim);
}

/* Saves after `before` steps, restores into a new simulation and compares further steps. */
static void goes_on(const char *text, const char *set, int before) {
    pdyn_context *context = test_context(2);
    pdyn_sim *first = test_load_with(context, text, &set, 1);
    step_often(first, before);
    assert_int_equal(pdyn_save(first, "state"), PDYN_OK);
    step_often(first, 6);
    pdyn_sim *second = test_load_with(context, text, &set, 1);
    assert_int_equal(pdyn_restore(second, "state"), PDYN_OK);
    step_often(second, 6);
    assert_true(pdyn_time(first) == pdyn_time(second));
    assert_true(pdyn_state_hash(first) == pdyn_state_hash(second));
    pdyn_free(first), pdyn_free(second);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    test_remove_file("state");
}

static void test_same_bits(void **state) {
    (void)state;
    for (int before = 0; before <= 8; before += 8) {
        goes_on(fluid, "solver.type=auto", before);
        goes_on(fluid, "solver.type=cg", before);
        goes_on(sheet, "solver.type=auto", before);
        goes_on(touching, "solver.type=auto", before);
        goes_on(sheet, "solver.step=projective", before);
        goes_on(sheet, "bodies.sheet.surface.fluid_friction=50", before);
    }
}

enum { MOST_STEPS = 100, FURTHER = 4 };

/* Saves after each of some steps, and makes further ones from each of the states. */
static void goes_on_from_each(const char *text, int steps) {
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, text);
    uint64_t hash[MOST_STEPS + 1];
    char name[32];
    for (int step = 0; step < steps; step++) {
        snprintf(name, sizeof name, "state_%d", step);
        assert_int_equal(pdyn_save(sim, name), PDYN_OK);
        test_step(sim);
        hash[step + 1] = pdyn_state_hash(sim);
    }
    pdyn_free(sim);
    for (int begin = 0; begin < steps; begin++) {
        snprintf(name, sizeof name, "state_%d", begin);
        sim = test_load(context, text);
        assert_int_equal(pdyn_restore(sim, name), PDYN_OK);
        for (int step = begin; step < steps && step < begin + FURTHER; step++) {
            test_step(sim);
            if (pdyn_state_hash(sim) != hash[step + 1])
                fail_msg("from step %d on, step %d differs", begin, step);
        }
        pdyn_free(sim);
        test_remove_file(name);
    }
    pdyn_destroy(context);
}

static void test_every_step_long(void **state) {
    (void)state;
    goes_on_from_each(stirred, 100);
    goes_on_from_each(drawn, 40);
    goes_on_from_each(let_go, 20);
    goes_on_from_each(thick, 20);
    goes_on_from_each(fed, 24);
    goes_on_from_each(parted, 16);
}

/* What a program has changed does not outlast the restoring of a state without it. */
static void test_program(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(sheet);
    double *force = calloc(3 * (size_t)sim->objective.particles, sizeof *force), stiffness = 500.0;
    step_often(sim, 2);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    assert_int_equal(pdyn_set_forces(sim, 0, sim->objective.particles, force), PDYN_OK);
    assert_int_equal(pdyn_set_parameter(sim, 1, "stretching_stiffness", &stiffness, 1), PDYN_OK);
    assert_true(sim->control.driven && sim->control.force);
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_OK);
    assert_true(!sim->control.driven && !sim->control.force);
    free(force);
    test_close(sim);
    test_remove_file("state");
}

/* A state in memory has the bytes of the file, and restoring it gives the same steps. */
static void goes_on_in_memory(const char *text) {
    pdyn_context *context = test_context(1);
    pdyn_sim *first = test_load(context, text), *second = test_load(context, text);
    size_t size = 0, again = 0;
    step_often(first, 8);
    assert_int_equal(pdyn_save_memory(first, NULL, 0, &size), PDYN_OK);
    unsigned char *buffer = malloc(size), *bytes = malloc(size);
    assert_int_equal(pdyn_save_memory(first, buffer, size - 1, &again), PDYN_BAD_CALL);
    assert_true(again == size);
    assert_int_equal(pdyn_save_memory(first, buffer, size, &again), PDYN_OK);
    assert_int_equal(pdyn_save(first, "state"), PDYN_OK);
    FILE *file = fopen("state", "rb");
    assert_true(file && fread(bytes, 1, size, file) == size && fgetc(file) == EOF);
    assert_int_equal(fclose(file), 0);
    assert_memory_equal(bytes, buffer, size);
    assert_int_equal(pdyn_restore_memory(second, buffer, size), PDYN_OK);
    step_often(first, 6), step_often(second, 6);
    assert_true(pdyn_state_hash(first) == pdyn_state_hash(second));
    free(buffer), free(bytes);
    pdyn_free(first), pdyn_free(second);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    test_remove_file("state");
}

static void test_memory(void **state) {
    (void)state;
    goes_on_in_memory(fluid);
    goes_on_in_memory(sheet);
    goes_on_in_memory(touching);
}

/* Loads the sheet with an override; restoring its state must be refused with this text. */
static void refused(const char *set, const char *says) {
    pdyn_sim *sim = test_open_with(sheet, &set, 1);
    uint64_t hash = pdyn_state_hash(sim);
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_BAD_INPUT);
    assert_error(says);
    assert_true(pdyn_state_hash(sim) == hash);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
    test_close(sim);
}

static void damage(long at, int by) {
    FILE *file = fopen("state", "r+b");
    assert_true(file && !fseek(file, at, at < 0 ? SEEK_END : SEEK_SET));
    int byte = fgetc(file);
    assert_true(byte != EOF && !fseek(file, -1, SEEK_CUR) && fputc(byte ^ by, file) != EOF);
    assert_int_equal(fclose(file), 0);
}

/* Step lengths, tolerances, iterations and colours may be others than those of the state. */
static void test_other_settings(void **state) {
    (void)state;
    static const char *const sets[] = {"solver.tolerance=0.01",
                                       "solver.outer_iterations=7",
                                       "solver.linear_iterations=9",
                                       "time_step.maximum=0.001",
                                       "duration=7",
                                       "bodies.sheet.color=\"#102030\""};
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, sheet);
    step_often(sim, 3);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    pdyn_sim *other = test_load_with(context, sheet, sets, sizeof sets / sizeof *sets);
    if (pdyn_restore(other, "state") != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    assert_true(pdyn_time(other) == pdyn_time(sim));
    assert_true(pdyn_state_hash(other) == pdyn_state_hash(sim));
    assert_true(test_step(other).h < 0.00101);
    test_remove_file("state");
    pdyn_free(sim), pdyn_free(other);
    pdyn_destroy(context);
}

static void test_refused(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(sheet);
    step_often(sim, 3);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    refused("bodies.sheet.constraints.spring.stretching_stiffness=1001", "\"bodies\" in its scene");
    refused("bodies.water.particles.radius=0.019", "\"bodies\" in its scene");
    refused("solver.step=projective", "\"solver\" in its scene");
    damage(20, 1);
    refused("duration=1", "checksum");
    damage(20, 1), damage(-1, 4);
    refused("duration=1", "checksum");
    damage(-1, 4), damage(3, 1);
    refused("duration=1", "expected a state");
    damage(3, 1), damage(9, 1);
    refused("duration=1", "byte order");
    damage(9, 1);
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_OK);
    for (int size = 0; size < 100; size += 9) {
        char part[100] = "PDYNSTA4";
        test_write_file("state", part, (size_t)size);
        refused("duration=1", "state");
    }
    assert_int_equal(pdyn_restore(sim, "nothing"), PDYN_IO_FAILED);
    assert_int_equal(pdyn_save(sim, "no/directory"), PDYN_IO_FAILED);
    test_close(sim);
    test_remove_file("state");
}

/* Meshes of files that have changed since: a solid with another vertex, and a bipyramid that is cut
 * into two tetrahedra, then into three. */
static void test_changed_meshes(void **state) {
    (void)state;
    static const char *const rock[] = {"v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n",
                                       "v 0 0 0\nv 2 0 0\nv 0 0 1\nf 1 2 3\n"};
    static const char *const cut[] = {"2 4 0\n1 1 3 4 5\n2 2 3 4 5\n",
                                      "3 4 0\n1 1 2 3 4\n2 1 2 4 5\n3 1 2 5 3\n"};
    for (int k = 1; k < 3; k++) {
        for (int changed = 0; changed < 2; changed++) {
            test_write_text("rock.obj", rock[changed && k == 1]);
            test_write_text("soft.node",
                            "5 3 0 0\n1 0 1 0\n2 0 -1 0\n3 1 0 0\n4 -1 0 1\n5 -1 0 -1\n");
            test_write_text("soft.ele", cut[changed && k == 2]);
            pdyn_sim *sim = test_open(
                "{'duration': 1, 'bodies': [{'volume': {'mesh': 'soft.ele', 'density': 500}, "
                "'constraints': [{'type': 'spring', 'stretching_stiffness': 100}]}], "
                "'solids': [{'mesh': 'rock.obj'}]}");
            if (!changed) assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
            if (changed) assert_int_equal(pdyn_restore(sim, "state"), PDYN_BAD_INPUT);
            if (changed) assert_error("meshes");
            test_close(sim);
        }
    }
    test_remove_file("rock.obj"), test_remove_file("soft.node"), test_remove_file("soft.ele");
    test_remove_file("state");
}

static pdyn_status fail_to_persist(void *self, pdyn_snapshot *snapshot) {
    (void)self, (void)snapshot;
    return PDYN_SOLVER_FAILED;
}

/* A module that cannot write makes the save fail, and the file of the last save stays. */
static void test_failing_module(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(sheet);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    uint64_t hash = pdyn_state_hash(sim);
    pdyn_global_solver failing = *sim->choice.slot[0].solver;
    sim->choice.slot[0].solver = &failing, failing.persist = fail_to_persist;
    step_often(sim, 3);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_SOLVER_FAILED);
    assert_int_equal(pdyn_save(sim, "other"), PDYN_SOLVER_FAILED);
    assert_int_equal(pdyn_restore(sim, "other"), PDYN_IO_FAILED);
    failing.persist = NULL;
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_OK);
    assert_true(pdyn_state_hash(sim) == hash);
    test_close(sim);
    test_remove_file("state");
}

/* Memory for the batch of a new hold is missing: the save fails, and the file stays. */
static void test_failing_hold(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *context = test_counting_context(1, &counter);
    pdyn_sim *sim = test_load(context, sheet);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    uint64_t hash = pdyn_state_hash(sim);
    step_often(sim, 3);
    assert_int_equal(pdyn_hold(sim, 0, 10.0, (double[]){0, 0, 0}), PDYN_OK);
    test_allow(&counter, 1);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_NO_MEMORY);
    test_allow(&counter, -1);
    pdyn_free(sim);
    sim = test_load(context, sheet);
    assert_int_equal(pdyn_restore(sim, "state"), PDYN_OK);
    assert_true(pdyn_state_hash(sim) == hash);
    test_close(sim);
    test_remove_file("state");
}

static pdyn_status load_and_restore(const void *what) {
    pdyn_context *context = *(pdyn_context *const *)what;
    pdyn_sim *sim = NULL;
    pdyn_status status = pdyn_load_text(context, quoted(sheet), "sheet", NULL, 0, &sim);
    if (status == PDYN_OK) status = pdyn_restore(sim, "state");
    if (status == PDYN_OK) status = pdyn_save(sim, "again");
    pdyn_free(sim);
    return status;
}

static void test_failing_allocator(void **state) {
    (void)state;
    struct counter counter;
    pdyn_context *context = test_counting_context(1, &counter);
    pdyn_sim *sim = test_load(context, sheet);
    step_often(sim, 3);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    pdyn_free(sim);
    assert_true(test_failing_allocations(context, &counter, load_and_restore, &context) > 50);
    pdyn_destroy(context);
    test_remove_file("state"), test_remove_file("again");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),         cmocka_unit_test(test_every_step_long),
        cmocka_unit_test(test_other_settings),    cmocka_unit_test(test_refused),
        cmocka_unit_test(test_changed_meshes),    cmocka_unit_test(test_failing_module),
        cmocka_unit_test(test_failing_allocator), cmocka_unit_test(test_failing_hold),
        cmocka_unit_test(test_program),           cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests_name("persist", tests, test_enter_directory,
                                       test_leave_directory);
}
