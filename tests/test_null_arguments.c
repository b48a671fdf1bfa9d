/* Public functions of projdyn.h, scene.h, control.h, probe.h and module.h with NULL where it is not
 * allowed: functions with a status return PDYN_BAD_CALL, the others a value of zeros, "" or NULL,
 * or do nothing. */
#include "support.h"

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

static pdyn_status describe(void) { return pdyn_describe(NULL, "fluid", discard, NULL); }
static pdyn_status describe_nowhere(void) { return pdyn_describe(context, NULL, NULL, NULL); }

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

static pdyn_status open_writer(pdyn_sim *of, const char *directory) {
    pdyn_writer *out = writer; /* a failure sets it to NULL */
    pdyn_status status = pdyn_writer_open(of, directory, false, &out);
    assert_null(out);
    return status;
}

static pdyn_status resume_writer(pdyn_sim *of, const char *directory) {
    pdyn_writer *out = writer; /* a failure sets it to NULL */
    pdyn_status status = pdyn_writer_resume(of, directory, &out);
    assert_null(out);
    return status;
}

/* One row per call. */
#define CALLS(X)                                                                                   \
    X(pdyn_create(NULL, NULL))                                                                     \
    X(pdyn_load_plugin(NULL, "plugin.so"))                                                         \
    X(pdyn_load_plugin(context, NULL))                                                             \
    X(pdyn_register(NULL, NULL))                                                                   \
    X(pdyn_register(context, NULL))                                                                \
    X(describe())                                                                                  \
    X(describe_nowhere())                                                                          \
    X(load(NULL, "scene.json", NULL, 0))                                                           \
    X(load(context, NULL, NULL, 0))                                                                \
    X(load(context, "scene.json", NULL, 1))                                                        \
    X(load(context, "scene.json", NULL, -1))                                                       \
    X(load(context, "scene.json", &no_text, 1))                                                    \
    X(pdyn_load(context, "scene.json", NULL, 0, NULL))                                             \
    X(load_text(NULL, "{}", "scene", NULL, 0))                                                     \
    X(load_text(context, NULL, "scene", NULL, 0))                                                  \
    X(load_text(context, "{}", NULL, NULL, 0))                                                     \
    X(load_text(context, "{}", "scene", NULL, 1))                                                  \
    X(load_text(context, "{}", "scene", &no_text, 1))                                              \
    X(pdyn_load_text(context, "{}", "scene", NULL, 0, NULL))                                       \
    X(pdyn_scene_create(NULL, "scene", &scene_out))                                                \
    X(pdyn_scene_create(context, NULL, &scene_out))                                                \
    X(pdyn_scene_create(context, "scene", NULL))                                                   \
    X(pdyn_scene_open(NULL, "scene.json", &scene_out))                                             \
    X(pdyn_scene_open(context, NULL, &scene_out))                                                  \
    X(pdyn_scene_open(context, "scene.json", NULL))                                                \
    X(pdyn_scene_parse(NULL, "{}", "scene", &scene_out))                                           \
    X(pdyn_scene_parse(context, NULL, "scene", &scene_out))                                        \
    X(pdyn_scene_parse(context, "{}", NULL, &scene_out))                                           \
    X(pdyn_scene_parse(context, "{}", "scene", NULL))                                              \
    X(pdyn_scene_set(NULL, "duration", "1"))                                                       \
    X(pdyn_scene_set(scene, NULL, "1"))                                                            \
    X(pdyn_scene_set(scene, "duration", NULL))                                                     \
    X(pdyn_scene_override(NULL, NULL, 0))                                                          \
    X(pdyn_scene_override(scene, NULL, 1))                                                         \
    X(pdyn_scene_override(scene, NULL, -1))                                                        \
    X(pdyn_scene_override(scene, &no_text, 1))                                                     \
    X(pdyn_scene_mesh(NULL, "a.ply", 3, x, 1, corner))                                             \
    X(pdyn_scene_mesh(scene, NULL, 3, x, 1, corner))                                               \
    X(pdyn_scene_mesh(scene, "a.ply", 3, NULL, 1, corner))                                         \
    X(pdyn_scene_mesh(scene, "a.ply", 3, x, 1, NULL))                                              \
    X(pdyn_scene_tets(NULL, "a.msh", 4, x, 1, corner))                                             \
    X(pdyn_scene_tets(scene, NULL, 4, x, 1, corner))                                               \
    X(pdyn_scene_tets(scene, "a.msh", 4, NULL, 1, corner))                                         \
    X(pdyn_scene_tets(scene, "a.msh", 4, x, 1, NULL))                                              \
    X(pdyn_scene_particles(NULL, "a.ply", 4, x, NULL))                                             \
    X(pdyn_scene_particles(scene, NULL, 4, x, NULL))                                               \
    X(pdyn_scene_particles(scene, "a.ply", 4, NULL, x))                                            \
    X(pdyn_scene_load(NULL, &sim_out))                                                             \
    X(pdyn_scene_load(scene, NULL))                                                                \
    X(pdyn_scene_text(NULL, discard, NULL))                                                        \
    X(pdyn_scene_text(scene, NULL, NULL))                                                          \
    X(pdyn_scene_write(NULL, "scene.json"))                                                        \
    X(pdyn_scene_write(scene, NULL))                                                               \
    X(pdyn_step(NULL, NULL))                                                                       \
    X(pdyn_step(NULL, &info))                                                                      \
    X(pdyn_solid_load(NULL, 0, force, moment))                                                     \
    X(pdyn_solid_load(sim, 0, NULL, moment))                                                       \
    X(pdyn_solid_load(sim, 0, force, NULL))                                                        \
    X(pdyn_set_forces(NULL, 0, 1, position))                                                       \
    X(pdyn_add_forces(NULL, 0, 1, position))                                                       \
    X(pdyn_add_forces(sim, 0, 1, NULL))                                                            \
    X(pdyn_set_gravity(NULL, position))                                                            \
    X(pdyn_set_gravity(sim, NULL))                                                                 \
    X(pdyn_set_positions(NULL, 0, 1, position))                                                    \
    X(pdyn_set_positions(sim, 0, 1, NULL))                                                         \
    X(pdyn_set_velocities(NULL, 0, 1, position))                                                   \
    X(pdyn_set_velocities(sim, 0, 1, NULL))                                                        \
    X(pdyn_set_parameter(NULL, 0, "damping", position, 1))                                         \
    X(pdyn_set_parameter(sim, 0, NULL, position, 1))                                               \
    X(pdyn_set_parameter(sim, 0, "damping", NULL, 1))                                              \
    X(pdyn_enable(NULL, 0, true))                                                                  \
    X(pdyn_hold(NULL, 0, 1.0, position))                                                           \
    X(pdyn_hold(sim, 0, 1.0, NULL))                                                                \
    X(pdyn_release(NULL, 0))                                                                       \
    X(pdyn_move_solid(NULL, 0, 1.0, position, position))                                           \
    X(pdyn_solid_pose(NULL, 0, force, moment))                                                     \
    X(pdyn_solid_pose(sim, 0, NULL, moment))                                                       \
    X(pdyn_move_inlet(NULL, 0, 0, 1.0, position, position))                                        \
    X(pdyn_set_inlet_speed(NULL, 0, 0, 1.0, 1.0))                                                  \
    X(pdyn_step_by(NULL, 0.1, NULL))                                                               \
    X(pdyn_constraint_forces(NULL, 0, force))                                                      \
    X(pdyn_constraint_forces(sim, 0, NULL))                                                        \
    X(pdyn_constraint_load(NULL, 0, force, moment))                                                \
    X(pdyn_constraint_load(sim, 0, NULL, moment))                                                  \
    X(pdyn_constraint_load(sim, 0, force, NULL))                                                   \
    X(pdyn_solid_load_by(NULL, 0, PDYN_LOAD_FLUID, force, moment))                                 \
    X(pdyn_solid_load_by(sim, 0, PDYN_LOAD_FLUID, NULL, moment))                                   \
    X(pdyn_solid_load_by(sim, 0, PDYN_LOAD_FLUID, force, NULL))                                    \
    X(pdyn_body_load_by(NULL, 0, PDYN_LOAD_FLUID, force, moment))                                  \
    X(pdyn_body_load_by(sim, 0, PDYN_LOAD_FLUID, NULL, moment))                                    \
    X(pdyn_body_load_by(sim, 0, PDYN_LOAD_FLUID, force, NULL))                                     \
    X(pdyn_contact_forces(NULL, force))                                                            \
    X(pdyn_contact_forces(sim, NULL))                                                              \
    X(pdyn_element_values(NULL, 0, force, force))                                                  \
    X(pdyn_fluid_at(NULL, 1, force, force, force))                                                 \
    X(pdyn_fluid_at(sim, 1, NULL, force, force))                                                   \
    X(pdyn_save(NULL, "state"))                                                                    \
    X(pdyn_save(sim, NULL))                                                                        \
    X(pdyn_restore(NULL, "state"))                                                                 \
    X(pdyn_restore(sim, NULL))                                                                     \
    X(pdyn_save_memory(NULL, NULL, 0, &size))                                                      \
    X(pdyn_save_memory(sim, NULL, 0, NULL))                                                        \
    X(pdyn_save_memory(sim, NULL, 1, &size))                                                       \
    X(pdyn_restore_memory(NULL, force, sizeof force))                                              \
    X(pdyn_restore_memory(sim, NULL, 0))                                                           \
    X(open_writer(NULL, "out"))                                                                    \
    X(open_writer(sim, NULL))                                                                      \
    X(pdyn_writer_open(sim, "out", false, NULL))                                                   \
    X(resume_writer(NULL, "out"))                                                                  \
    X(resume_writer(sim, NULL))                                                                    \
    X(pdyn_writer_resume(sim, "out", NULL))                                                        \
    X(pdyn_writer_frame(NULL))                                                                     \
    X(pdyn_writer_step(NULL, &info))                                                               \
    X(pdyn_writer_step(writer, NULL))                                                              \
    X(pdyn_writer_report(NULL, "report.json", false, NULL))                                        \
    X(pdyn_writer_save(NULL))

static void test_status(void **state) {
    (void)state;
    static const char *const no_text = NULL;
    pdyn_step_info info = {0};
    const double x[12] = {0};
    const int corner[4] = {0, 1, 2, 3};
    double force[3], moment[3];
    pdyn_scene *scene_out = NULL;
    pdyn_sim *sim_out = NULL;
    size_t size = 0;
#define CHECK(call)                                                                                \
    if ((call) != PDYN_BAD_CALL) fail_msg("%s does not return PDYN_BAD_CALL", #call);
    CALLS(CHECK)
#undef CHECK
    assert_true(!scene_out && !sim_out);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
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
    assert_string_equal(pdyn_last_error(NULL), "");
    assert_true(pdyn_state_hash(NULL) == 0);
    assert_true(found.particles == no_state.particles && !found.x && !found.v && !found.bodies);
    assert_null(pdyn_get_body(NULL, 0).name);
    assert_null(pdyn_get_constraint(NULL, 0).type);
    assert_null(pdyn_get_parameter(NULL, 0, 0).name);
    assert_null(pdyn_get_vector(NULL, 0, 0).name);
    assert_null(pdyn_solid_name(NULL, 0));
    assert_null(pdyn_get_probe(NULL, 0).name);
    assert_int_equal(pdyn_solid_vertices(NULL, 0, NULL), 0);
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
        cmocka_unit_test(test_status),
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_nothing),
    };
    return cmocka_run_group_tests_name("null_arguments", tests, set_up, tear_down);
}
