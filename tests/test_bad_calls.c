/* Public functions with NULL where it is not allowed, with an index that is out of range, or of a
 * simulation that has failed: functions with a status return PDYN_BAD_CALL and set the text of the
 * last error, the others return a value of zeros, "" or NULL, or do nothing. */
#include "support.h"

#include "projdyn/conformance.h"
#include "projdyn/control.h"
#include "projdyn/module.h"
#include "projdyn/probe.h"
#include "projdyn/scene.h"

#include <string.h>

static pdyn_context *context;
static pdyn_scene *scene;
static pdyn_sim *sim;
static pdyn_writer *writer;
static const double position[3];

static void discard(void *user, const char *text) { (void)user, (void)text; }

/* Loads text with the overrides `set`; name: of the file in messages. */
static pdyn_status load_text(pdyn_context *in, const char *text, const char *name,
                             const char *const *set, int count) {
    pdyn_sim *out = sim; /* a failure sets it to NULL */
    pdyn_status status = pdyn_load_text(in, text, name, set, count, &out);
    assert_null(out);
    return status;
}

static pdyn_status load(pdyn_context *in, const char *path, const char *const *set, int count) {
    pdyn_sim *out = sim; /* a failure sets it to NULL */
    pdyn_status status = pdyn_load(in, path, set, count, &out);
    assert_null(out);
    return status;
}

static pdyn_status writer_open(pdyn_sim *of, const char *directory) {
    pdyn_writer *out = writer; /* a failure sets it to NULL */
    pdyn_status status = pdyn_writer_open(of, directory, false, &out);
    assert_null(out);
    return status;
}

static pdyn_status writer_resume(pdyn_sim *of, const char *directory) {
    pdyn_writer *out = writer; /* a failure sets it to NULL */
    pdyn_status status = pdyn_writer_resume(of, directory, &out);
    assert_null(out);
    return status;
}

/* One row per call: the call, and the text that it sets. */
#define CALLS(X)                                                                                   \
    X(pdyn_create(NULL, NULL), "out is NULL")                                                      \
    X(pdyn_create(&(pdyn_options){.threads = -1}, &context_out),                                   \
      "options.threads: expected 0 to 1024, found -1")                                             \
    X(pdyn_create(&(pdyn_options){.threads = 1025}, &context_out),                                 \
      "options.threads: expected 0 to 1024, found 1025")                                           \
    X(pdyn_load_plugin(NULL, "plugin.so"), "context is NULL")                                      \
    X(pdyn_load_plugin(context, NULL), "path is NULL")                                             \
    X(pdyn_load_plugin(context, ""), "path is empty")                                              \
    X(pdyn_register(NULL, NULL), "context is NULL")                                                \
    X(pdyn_register(context, NULL), "plugin is NULL")                                              \
    X(pdyn_describe(NULL, "fluid", discard, NULL), "context is NULL")                              \
    X(pdyn_describe(context, NULL, NULL, NULL), "write is NULL")                                   \
    X(load(NULL, "scene.json", NULL, 0), "context is NULL")                                        \
    X(load(context, NULL, NULL, 0), "path is NULL")                                                \
    X(load(context, "scene.json", NULL, 1), "set is NULL, count is 1")                             \
    X(load(context, "scene.json", NULL, -1), "count: expected at least 0, found -1")               \
    X(load(context, "scene.json", &no_text, 1), "set[0] is NULL, count is 1")                      \
    X(load(context, "scene.json", &no_text, -2), "count: expected at least 0, found -2")           \
    X(pdyn_load(context, "scene.json", NULL, 0, NULL), "out is NULL")                              \
    X(load_text(NULL, "{}", "scene", NULL, 0), "context is NULL")                                  \
    X(load_text(context, NULL, "scene", NULL, 0), "text is NULL")                                  \
    X(load_text(context, "{}", NULL, NULL, 0), "name is NULL")                                     \
    X(load_text(context, "{}", "scene", NULL, 1), "set is NULL, count is 1")                       \
    X(load_text(context, "{}", "scene", &no_text, 1), "set[0] is NULL, count is 1")                \
    X(pdyn_load_text(context, "{}", "scene", NULL, 0, NULL), "out is NULL")                        \
    X(pdyn_scene_create(NULL, "scene", &scene_out), "context is NULL")                             \
    X(pdyn_scene_create(context, NULL, &scene_out), "name is NULL")                                \
    X(pdyn_scene_create(context, "scene", NULL), "out is NULL")                                    \
    X(pdyn_scene_open(NULL, "scene.json", &scene_out), "context is NULL")                          \
    X(pdyn_scene_open(context, NULL, &scene_out), "path is NULL")                                  \
    X(pdyn_scene_open(context, "scene.json", NULL), "out is NULL")                                 \
    X(pdyn_scene_parse(NULL, "{}", "scene", &scene_out), "context is NULL")                        \
    X(pdyn_scene_parse(context, NULL, "scene", &scene_out), "text is NULL")                        \
    X(pdyn_scene_parse(context, "{}", NULL, &scene_out), "name is NULL")                           \
    X(pdyn_scene_parse(context, "{}", "scene", NULL), "out is NULL")                               \
    X(pdyn_scene_set(NULL, "duration", "1"), "scene is NULL")                                      \
    X(pdyn_scene_set(scene, NULL, "1"), "path is NULL")                                            \
    X(pdyn_scene_set(scene, "duration", NULL), "value is NULL")                                    \
    X(pdyn_scene_override(NULL, NULL, 0), "scene is NULL")                                         \
    X(pdyn_scene_override(scene, NULL, 1), "set is NULL, count is 1")                              \
    X(pdyn_scene_override(scene, NULL, -1), "count: expected at least 0, found -1")                \
    X(pdyn_scene_override(scene, &no_text, 1), "set[0] is NULL, count is 1")                       \
    X(pdyn_scene_mesh(NULL, "a.ply", 3, x, 1, corner), "scene is NULL")                            \
    X(pdyn_scene_mesh(scene, NULL, 3, x, 1, corner), "file is NULL")                               \
    X(pdyn_scene_mesh(scene, "a.ply", 3, NULL, 1, corner), "vertex is NULL")                       \
    X(pdyn_scene_mesh(scene, "a.ply", 3, x, 1, NULL), "triangle is NULL")                          \
    X(pdyn_scene_tets(NULL, "a.msh", 4, x, 1, corner), "scene is NULL")                            \
    X(pdyn_scene_tets(scene, NULL, 4, x, 1, corner), "file is NULL")                               \
    X(pdyn_scene_tets(scene, "a.msh", 4, NULL, 1, corner), "vertex is NULL")                       \
    X(pdyn_scene_tets(scene, "a.msh", 4, x, 1, NULL), "tet is NULL")                               \
    X(pdyn_scene_particles(NULL, "a.ply", 4, x, NULL), "scene is NULL")                            \
    X(pdyn_scene_particles(scene, NULL, 4, x, NULL), "file is NULL")                               \
    X(pdyn_scene_particles(scene, "a.ply", 4, NULL, x), "x is NULL")                               \
    X(pdyn_scene_load(NULL, &sim_out), "scene is NULL")                                            \
    X(pdyn_scene_load(scene, NULL), "out is NULL")                                                 \
    X(pdyn_scene_text(NULL, discard, NULL), "scene is NULL")                                       \
    X(pdyn_scene_text(scene, NULL, NULL), "write is NULL")                                         \
    X(pdyn_scene_write(NULL, "scene.json"), "scene is NULL")                                       \
    X(pdyn_scene_write(scene, NULL), "path is NULL")                                               \
    X(pdyn_step(NULL, NULL), "sim is NULL")                                                        \
    X(pdyn_step(NULL, &info), "sim is NULL")                                                       \
    X(pdyn_solid_load(NULL, 0, force, moment), "sim is NULL")                                      \
    X(pdyn_solid_load(sim, 0, NULL, moment), "force is NULL")                                      \
    X(pdyn_solid_load(sim, 0, force, NULL), "moment is NULL")                                      \
    X(pdyn_solid_load(sim, 1, force, moment), "solid: expected 0 to 0, found 1")                   \
    X(pdyn_set_forces(NULL, 0, 1, position), "sim is NULL")                                        \
    X(pdyn_set_forces(sim, -1, 1, position), "first -1, count 1: there are 9 particles")           \
    X(pdyn_set_forces(sim, 9, 1, position), "first 9, count 1: there are 9 particles")             \
    X(pdyn_add_forces(NULL, 0, 1, position), "sim is NULL")                                        \
    X(pdyn_add_forces(sim, 0, 1, NULL), "force is NULL")                                           \
    X(pdyn_add_forces(sim, 0, 10, position), "first 0, count 10: there are 9 particles")           \
    X(pdyn_set_gravity(NULL, position), "sim is NULL")                                             \
    X(pdyn_set_gravity(sim, NULL), "gravity is NULL")                                              \
    X(pdyn_set_positions(NULL, 0, 1, position), "sim is NULL")                                     \
    X(pdyn_set_positions(sim, 0, 1, NULL), "x is NULL")                                            \
    X(pdyn_set_positions(sim, 0, -1, position), "first 0, count -1: there are 9 particles")        \
    X(pdyn_set_velocities(NULL, 0, 1, position), "sim is NULL")                                    \
    X(pdyn_set_velocities(sim, 0, 1, NULL), "v is NULL")                                           \
    X(pdyn_set_velocities(sim, 5, 2147483647, position),                                           \
      "first 5, count 2147483647: there are 9 particles")                                          \
    X(pdyn_set_parameter(NULL, 0, "damping", position, 1), "sim is NULL")                          \
    X(pdyn_set_parameter(sim, 0, NULL, position, 1), "name is NULL")                               \
    X(pdyn_set_parameter(sim, 0, "damping", NULL, 1), "value is NULL")                             \
    X(pdyn_set_parameter(sim, 1, "damping", position, 1), "constraint: expected 0 to 0, found 1")  \
    X(pdyn_enable(NULL, 0, true), "sim is NULL")                                                   \
    X(pdyn_enable(sim, -1, true), "constraint: expected 0 to 0, found -1")                         \
    X(pdyn_hold(NULL, 0, 1.0, position), "sim is NULL")                                            \
    X(pdyn_hold(sim, 0, 1.0, NULL), "target is NULL")                                              \
    X(pdyn_hold(sim, 9, 1.0, position), "particle: expected 0 to 8, found 9")                      \
    X(pdyn_release(NULL, 0), "sim is NULL")                                                        \
    X(pdyn_release(sim, -1), "particle: expected 0 to 8, found -1")                                \
    X(pdyn_move_solid(NULL, 0, 1.0, position, position), "sim is NULL")                            \
    X(pdyn_move_solid(sim, 1, 1.0, position, position), "solid: expected 0 to 0, found 1")         \
    X(pdyn_move_solid(sim, 0, 1.0, NULL, position), "translate is NULL")                           \
    X(pdyn_move_solid(sim, 0, 1.0, position, NULL), "rotate is NULL")                              \
    X(pdyn_solid_pose(NULL, 0, force, moment), "sim is NULL")                                      \
    X(pdyn_solid_pose(sim, 0, NULL, moment), "translate is NULL")                                  \
    X(pdyn_solid_pose(sim, -1, force, moment), "solid: expected 0 to 0, found -1")                 \
    X(pdyn_solid_pose(sim, 0, force, NULL), "rotate is NULL")                                      \
    X(pdyn_move_inlet(NULL, 0, 0, 1.0, position, position), "sim is NULL")                         \
    X(pdyn_move_inlet(sim, 1, 0, 1.0, position, position), "body: expected 0 to 0, found 1")       \
    X(pdyn_move_inlet(sim, 0, 0, 1.0, position, position), "inlet: there is none, found 0")        \
    X(pdyn_move_inlet(sim, 0, 0, 1.0, NULL, position), "translate is NULL")                        \
    X(pdyn_move_inlet(sim, 0, 0, 1.0, position, NULL), "rotate is NULL")                           \
    X(pdyn_set_inlet_speed(NULL, 0, 0, 1.0, 1.0), "sim is NULL")                                   \
    X(pdyn_set_inlet_speed(sim, -1, 0, 1.0, 1.0), "body: expected 0 to 0, found -1")               \
    X(pdyn_set_inlet_speed(sim, 0, -1, 1.0, 1.0), "inlet: there is none, found -1")                \
    X(pdyn_step_by(NULL, 0.1, NULL), "sim is NULL")                                                \
    X(pdyn_constraint_forces(NULL, 0, force), "sim is NULL")                                       \
    X(pdyn_constraint_forces(sim, 0, NULL), "force is NULL")                                       \
    X(pdyn_constraint_forces(sim, 1, force), "constraint: expected 0 to 0, found 1")               \
    X(pdyn_constraint_load(NULL, 0, force, moment), "sim is NULL")                                 \
    X(pdyn_constraint_load(sim, 0, NULL, moment), "force is NULL")                                 \
    X(pdyn_constraint_load(sim, 0, force, NULL), "moment is NULL")                                 \
    X(pdyn_constraint_load(sim, -1, force, moment), "constraint: expected 0 to 0, found -1")       \
    X(pdyn_solid_load_by(NULL, 0, PDYN_LOAD_FLUID, force, moment), "sim is NULL")                  \
    X(pdyn_solid_load_by(sim, 0, PDYN_LOAD_FLUID, NULL, moment), "force is NULL")                  \
    X(pdyn_solid_load_by(sim, 0, PDYN_LOAD_FLUID, force, NULL), "moment is NULL")                  \
    X(pdyn_solid_load_by(sim, 1, PDYN_LOAD_ALL, force, moment), "solid: expected 0 to 0, found 1") \
    X(pdyn_solid_load_by(sim, 0, 3, force, moment), "source: expected 0 to 2, found 3")            \
    X(pdyn_body_load_by(NULL, 0, PDYN_LOAD_FLUID, force, moment), "sim is NULL")                   \
    X(pdyn_body_load_by(sim, 0, PDYN_LOAD_FLUID, NULL, moment), "force is NULL")                   \
    X(pdyn_body_load_by(sim, 0, PDYN_LOAD_FLUID, force, NULL), "moment is NULL")                   \
    X(pdyn_body_load_by(sim, 1, PDYN_LOAD_ALL, force, moment), "body: expected 0 to 0, found 1")   \
    X(pdyn_body_load_by(sim, 0, -1, force, moment), "source: expected 0 to 2, found -1")           \
    X(pdyn_contact_forces(NULL, force), "sim is NULL")                                             \
    X(pdyn_contact_forces(sim, NULL), "force is NULL")                                             \
    X(pdyn_element_values(NULL, 0, force, force), "sim is NULL")                                   \
    X(pdyn_element_values(sim, 1, force, force), "constraint: expected 0 to 0, found 1")           \
    X(pdyn_fluid_at(NULL, 1, force, force, force), "sim is NULL")                                  \
    X(pdyn_fluid_at(sim, 1, NULL, force, force), "x is NULL, count is 1")                          \
    X(pdyn_fluid_at(sim, -1, force, force, force), "count: expected at least 0, found -1")         \
    X(pdyn_save(NULL, "state"), "sim is NULL")                                                     \
    X(pdyn_save(sim, NULL), "path is NULL")                                                        \
    X(pdyn_restore(NULL, "state"), "sim is NULL")                                                  \
    X(pdyn_restore(sim, NULL), "path is NULL")                                                     \
    X(pdyn_save_memory(NULL, NULL, 0, &size), "sim is NULL")                                       \
    X(pdyn_save_memory(sim, NULL, 0, NULL), "size is NULL")                                        \
    X(pdyn_save_memory(sim, NULL, 1, &size), "buffer is NULL, capacity is 1")                      \
    X(pdyn_save_memory(sim, force, 1, &size), "capacity: expected at least 2399, found 1")         \
    X(pdyn_restore_memory(NULL, force, sizeof force), "sim is NULL")                               \
    X(pdyn_restore_memory(sim, NULL, 0), "buffer is NULL")                                         \
    X(writer_open(NULL, "out"), "sim is NULL")                                                     \
    X(writer_open(sim, NULL), "directory is NULL")                                                 \
    X(writer_open(sim, ""), "directory is empty")                                                  \
    X(pdyn_writer_open(sim, "out", false, NULL), "out is NULL")                                    \
    X(writer_resume(NULL, "out"), "sim is NULL")                                                   \
    X(writer_resume(sim, NULL), "directory is NULL")                                               \
    X(writer_resume(sim, ""), "directory is empty")                                                \
    X(pdyn_writer_resume(sim, "out", NULL), "out is NULL")                                         \
    X(pdyn_writer_frame(NULL), "writer is NULL")                                                   \
    X(pdyn_writer_step(NULL, &info), "writer is NULL")                                             \
    X(pdyn_writer_step(writer, NULL), "info is NULL")                                              \
    X(pdyn_writer_report(NULL, "report.json", false, NULL), "writer is NULL")                      \
    X(pdyn_writer_save(NULL), "writer is NULL")                                                    \
    X(pdyn_conformance(NULL, "spring", NULL, NULL, &count), "context is NULL")                     \
    X(pdyn_conformance(context, "spring", NULL, NULL, NULL), "faults is NULL")

/* text: what follows the name of the function. */
static void check(pdyn_status status, const char *call, const char *text) {
    char expected[256];
    snprintf(expected, sizeof expected, "%s%.*s: %s", strncmp(call, "pdyn_", 5) ? "pdyn_" : "",
             (int)strcspn(call, "("), call, text);
    if (status != PDYN_BAD_CALL || strcmp(pdyn_last_error(context), expected))
        fail_msg("%s: %s: %s", call, pdyn_status_text(status), pdyn_last_error(context));
    set_error(PDYN_OK, "not the text of the next call");
}

static void test_status(void **state) {
    (void)state;
    static const char *const no_text = NULL;
    pdyn_step_info info = {0};
    const double x[12] = {0};
    const int corner[4] = {0, 1, 2, 3};
    double force[3], moment[3];
    pdyn_context *context_out = NULL;
    pdyn_scene *scene_out = NULL;
    pdyn_sim *sim_out = NULL;
    size_t size = 0;
    int count;
#define CHECK(call, text) check(call, #call, text);
    CALLS(CHECK)
#undef CHECK
    assert_true(!context_out && !scene_out && !sim_out);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
}

/* Nothing can be changed after a failed step. */
#define CHANGES(X)                                                                                 \
    X(pdyn_step(sim, NULL))                                                                        \
    X(pdyn_step_by(sim, 0.1, NULL))                                                                \
    X(pdyn_set_forces(sim, 0, 1, position))                                                        \
    X(pdyn_add_forces(sim, 0, 1, position))                                                        \
    X(pdyn_set_gravity(sim, position))                                                             \
    X(pdyn_set_positions(sim, 0, 1, position))                                                     \
    X(pdyn_set_velocities(sim, 0, 1, position))                                                    \
    X(pdyn_set_parameter(sim, 0, "damping", position, 1))                                          \
    X(pdyn_enable(sim, 0, false))                                                                  \
    X(pdyn_hold(sim, 0, 1.0, position))                                                            \
    X(pdyn_release(sim, 0))                                                                        \
    X(pdyn_move_solid(sim, 0, 1.0, position, position))

static void test_failed(void **state) {
    (void)state;
    sim->failed = true;
#define CHECK(call) check(call, #call, "the simulation has failed before: restore a state first");
    CHANGES(CHECK)
#undef CHECK
    sim->failed = false;
}

/* Nor can it by an observer, within a step, and nothing is saved or restored there. */
#define WITHIN(X)                                                                                  \
    X(pdyn_save(sim, "state"))                                                                     \
    X(pdyn_save_memory(sim, NULL, 0, &size))                                                       \
    X(pdyn_restore(sim, "state"))                                                                  \
    X(pdyn_restore_memory(sim, position, sizeof position))                                         \
    X(writer_resume(sim, "out"))                                                                   \
    X(pdyn_writer_save(writer))

static void observe(void *user, const pdyn_iteration *iteration) {
    int *calls = user;
    size_t size;
    ++*calls;
    assert_non_null(iteration->x);
#define CHECK(call) check(call, #call, "within a step an observer may only read the simulation");
    CHANGES(CHECK)
    WITHIN(CHECK)
#undef CHECK
}

static void test_observer(void **state) {
    (void)state;
    int calls = 0;
    pdyn_observe(sim, observe, &calls);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
    assert_true(calls > 0);
    pdyn_observe(sim, NULL, NULL);
    assert_int_equal(pdyn_release(sim, 0), PDYN_OK);
}

static void *no_memory(void *user, void *block, size_t old_size, size_t new_size) {
    (void)user, (void)block, (void)old_size, (void)new_size;
    return NULL;
}

/* A context that cannot be made leaves its text, too. */
static void test_no_context(void **state) {
    (void)state;
    pdyn_context *none = context;
    const pdyn_options options = {.allocate = no_memory};
    assert_int_equal(pdyn_create(&options, &none), PDYN_NO_MEMORY);
    assert_null(none);
    assert_string_equal(pdyn_last_error(NULL), "out of memory (0 bytes in use)");
}

static void test_values(void **state) {
    (void)state;
    static const pdyn_state no_state;
    pdyn_state found = pdyn_get_state(NULL);
    assert_true(pdyn_time(NULL) == 0.0 && pdyn_duration(NULL) == 0.0);
    assert_true(pdyn_has_reached(NULL, 1.0) && pdyn_is_finished(NULL));
    assert_true(pdyn_frame_interval(NULL) == 0.0);
    assert_string_equal(pdyn_solver_type(NULL), "");
    assert_string_equal(pdyn_solver_reason(NULL), "");
    assert_string_equal(pdyn_integrator(NULL), "");
    assert_string_equal(pdyn_step_type(NULL), "");
    assert_true(pdyn_contact_stiffness(NULL) == 0.0);
    assert_false(pdyn_is_enabled(NULL, 0));
    double gravity[3] = {1.0, 1.0, 1.0};
    pdyn_get_gravity(NULL, gravity);
    pdyn_get_gravity(sim, NULL);
    assert_true(gravity[0] == 0.0 && gravity[2] == 0.0);
    assert_true(pdyn_state_hash(NULL) == 0);
    assert_true(found.particles == no_state.particles && !found.x && !found.v && !found.bodies);
    assert_null(pdyn_get_body(NULL, 0).name);
    assert_null(pdyn_get_constraint(NULL, 0).type);
    assert_null(pdyn_get_parameter(NULL, 0, 0).name);
    assert_null(pdyn_get_vector(NULL, 0, 0).name);
    assert_null(pdyn_solid_name(NULL, 0));
    assert_null(pdyn_get_probe(NULL, 0).name);
    assert_int_equal(pdyn_solid_vertices(NULL, 0, NULL), 0);
    assert_int_equal(pdyn_solid_triangles(NULL, 0, NULL), 0);
    assert_int_equal(pdyn_thread_count(NULL), 0);
    assert_int_equal(pdyn_bytes_in_use(NULL), 0);
    assert_int_equal(pdyn_peak_bytes(NULL), 0);
}

static void test_nothing(void **state) {
    (void)state;
    pdyn_observe(NULL, NULL, NULL);
    pdyn_observe(sim, NULL, NULL);
    pdyn_free(NULL);
    pdyn_scene_free(NULL);
    pdyn_writer_close(NULL);
    pdyn_destroy(NULL);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
}

static int set_up(void **state) {
    static const char text[] = SCENE(
        "'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}",
        GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "3, 3", "'area_density': 0.5", SPRINGS("1000")),
        ", 'solids': [{'sphere': {'center': [0, -1, 0], 'radius': 0.1}}]");
    if (test_enter_directory(state)) return 1;
    context = test_context(1);
    sim = test_load(context, text);
    if (pdyn_scene_create(context, "scene", &scene) != PDYN_OK) return 1;
    return pdyn_writer_open(sim, "out", false, &writer) != PDYN_OK;
}

static int tear_down(void **state) {
    static const char *const file[] = {
        "out/metrics.csv", "out/sheet.vtk.series",  "out/lock",   "out/files.json",
        "out/sheet.obj",   "out/solids/solid0.vtk", "out/solids", "out"};
    pdyn_writer_close(writer);
    pdyn_free(sim);
    pdyn_scene_free(scene);
    pdyn_destroy(context);
    for (size_t k = 0; k < sizeof file / sizeof *file; k++)
        if (remove(file[k])) return 1;
    return test_leave_directory(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_status),     cmocka_unit_test(test_failed),
        cmocka_unit_test(test_no_context), cmocka_unit_test(test_values),
        cmocka_unit_test(test_nothing),    cmocka_unit_test(test_observer),
    };
    return cmocka_run_group_tests_name("bad_calls", tests, set_up, tear_down);
}
