/* Unusual meshes that can be simulated: warnings, and a finite motion of the sheet. */
#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

#define A "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\n"
#define B "v 5 0 0\nv 6 0 0\nv 5 0 1\n"

/* Loads a sheet of this mesh with all types of constraints for sheets. */
static pdyn_status load(pdyn_context *context, const char *mesh, pdyn_sim **sim) {
    test_write_text("mesh.obj", mesh);
    pdyn_status status = pdyn_load_text(
        context,
        quoted("{'duration': 10, 'time_step': {'fixed': 0.01}, 'solver': {'tolerance': 1e-9, "
               "'outer_iterations': 100}, 'bodies': [{'name': 'sheet', 'surface': {'mesh': "
               "'mesh.obj', "
               "'area_density': 0.2}, 'velocity': [1, 0, 0], 'constraints': [{'type': 'triangle', "
               "'stretching_stiffness': 100, 'damping': 0.01}, {'type': 'spring', "
               "'stretching_stiffness': "
               "100, 'damping': 0.01}, {'type': 'bending', 'bending_rigidity': 0.01, 'damping': "
               "0.01}, "
               "{'type': 'wind', 'velocity': [1, 2, 3]}, {'type': 'pin', 'vertices': {'vertices': "
               "[0]}}]}]}"),
        "test", NULL, 0, sim);
    test_remove_file("mesh.obj");
    return status;
}

/* Takes 30 steps, expects this number of warnings; x: final position of a vertex. */
static void run(const char *mesh, int vertex, int warnings, double x[3]) {
    struct warnings counter = {"lie where another one does", 0};
    pdyn_context *context = test_warned_context(1, &counter);
    pdyn_sim *sim;
    if (load(context, mesh, &sim) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    for (int n = 0; n < 30; n++) test_step(sim);
    const pdyn_state s = pdyn_get_state(sim);
    for (int k = 0; k < 3 * s.particles; k++) assert_true(fabs(s.x[k]) < 100.0);
    for (int k = 0; k < 3; k++) x[k] = s.x[3 * vertex + k];
    assert_int_equal(counter.count, warnings);
    test_close(sim);
}

/* The orientation of triangles has no effect; disconnected pieces do not affect each other. */
static void test_same(void **state) {
    (void)state;
    double x[3], y[3];
    run(A "f 1 2 3\nf 3 2 4\n", 3, 0, x);
    run(A "f 1 2 3\nf 2 3 4\n", 3, 0, y);
    assert_true(vec3_distance(x, y) < 1e-6);
    run(A B "f 1 2 3\nf 3 2 4\nf 5 6 7\n", 3, 0, y);
    assert_true(vec3_distance(x, y) < 1e-6);
}

static void test_finite(void **state) {
    (void)state;
    double x[3];
    run(A "v 1 0 0\nv 0 0 1\nf 1 2 3\nf 5 6 4\n", 3, 1, x); /* a seam */
    run("v 0 0 0\nv 1 0 0\nv 0 0 1\nv -1 0 0\nv 0 0 -1\nf 1 2 3\nf 1 4 5\n", 4, 0,
        x);                                                                        /* a bow tie */
    run("v 0 0 0\nv 1 0 0\nv 0.5 0 1e-5\nv 0.5 1 0\nf 1 2 3\nf 2 1 4\n", 3, 0, x); /* a sliver */
    run("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 0.001 1\nf 1 2 3\nf 2 1 4\n", 3, 0, x);    /* folded flat */
    run("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n", 3, 0, x);
}

/* Square A and a second one beside it or below it, which no vertex joins. */
#define SECOND(x, y) "v " #x " " #y " 0\nv 1 " #y " 0\nv " #x " " #y " 1\nv 1 " #y " 1\n"
#define PIECES       "f 1 2 3\nf 3 2 4\nf 5 6 7\nf 7 6 8\n"

/* Height of the free corner of A after 20 steps. */
static double swing(const char *mesh, int contact) {
    static const char text[] =
        "{'duration': 1, 'bodies': [{'surface': {'mesh': 'mesh.obj', 'area_density': 0.2}, "
        "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1000}, {'type': 'pin', "
        "'vertices': {'vertices': [0, 2, 4, 6]}}]}]}";
    const char *set[] = {"contact={\"thickness\": 0.005}"};
    test_write_text("mesh.obj", mesh);
    pdyn_sim *sim = test_open_with(text, set, contact);
    test_remove_file("mesh.obj");
    for (int n = 0; n < 20; n++) assert_true(test_step(sim).step_residual <= 0.1);
    double height = pdyn_get_state(sim).x[3 * 3 + 1];
    test_close(sim);
    return height;
}

/* Parts of a sheet that lie on each other at rest are no contacts: they swing as without. */
static void test_joined(void **state) {
    (void)state;
    static const char *const meshes[] = {A SECOND(2, 0) PIECES, A SECOND(0, 0) PIECES,
                                         A SECOND(0, -1e-5) PIECES};
    for (int k = 0; k < 3; k++) {
        double free_height = swing(meshes[k], 0);
        assert_true(free_height < -0.01);
        assert_true(fabs(swing(meshes[k], 1) - free_height) < 1e-6);
    }
}

static void test_twice(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim;
    assert_int_equal(load(context, A "f 1 2 3\nf 2 3 4\nf 3 1 2\n", &sim), PDYN_BAD_INPUT);
    const char *message = pdyn_last_error(context);
    assert_non_null(strstr(message, "as placed: triangles 0 and 2 have the same vertices"));
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same),
        cmocka_unit_test(test_finite),
        cmocka_unit_test(test_joined),
        cmocka_unit_test(test_twice),
    };
    return cmocka_run_group_tests_name("odd meshes", tests, test_enter_directory,
                                       test_leave_directory);
}
