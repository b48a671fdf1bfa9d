/* Bad scenes: syntax, values of the scene, and overrides, each with its message. test_bad_bodies.c
 * and test_bad_constraints.c have those of the parts of a scene. */
#include "scene_support.h"

#include <string.h>

#define SCENE_KEYS                                                                                 \
    "$schema, name, gravity, time_step, solver, bodies, solids, outlets, contact, plugins, "       \
    "boundary, kernel, probes, duration, frame_interval"

/* ---- scenes ---------------------------------------------------------------------------------- */

static const struct bad_scene bad_scenes[] = {
    /* syntax */
    {"", "scene.json:1:1: not valid JSON: *"},
    {"{'duration': 1,\n 'bodies': [}", "scene.json:2:13: not valid JSON: *"},
    {"{'duration': 1,\n 'duration': 2}",
     "scene.json:2:11: not valid JSON: duplicate object key near '\"duration\"'"},
    {"{\n// a comment\n'duration': 1}",
     "scene.json:2:1: not valid JSON: string or '}' expected near '/'; JSON has no comments"},
    {"{'duration': 1} x", "scene.json:1:17: not valid JSON: *"},
    {"{'duration': 1e999}", "scene.json:1:18: not valid JSON: *"},
    {"{'duration': 99999999999999999999}", "scene.json:1:33: not valid JSON: *"},
    {"\xef\xbb\xbf{'duration': NaN}", "scene.json:1:19: not valid JSON: *"}, /* byte order mark */
    {"{'duration': NaN}", "scene.json:1:16: not valid JSON: *"},
    {"{'\xff': 1}", "scene.json:1:2: not valid JSON: *"},
    {"{'name': 'a\\u0000b'}", "scene.json:1:19: not valid JSON: *"},
    {"[1, 2]", "scene.json:1:1: expected an object, found an array of 2"},
    /* the scene */
    {"{}", "scene.json:1:1: duration: missing, expected a number from 1e-06 to 1000000 s"},
    {"{'duration': 1}", "scene.json:1:1: bodies: missing, expected at least one body"},
    {"{'duration': 1, 'bodies': []}",
     "scene.json:1:27: bodies: expected at least one body, found an array of 0"},
    {"{'duration': 1, 'bodies': {}}",
     "scene.json:1:27: bodies: expected an array of bodies, found an object"},
    {TOP("'gravty': [0, 0, 0]"),
     "scene.json:2:2: unknown key \"gravty\"; did you mean \"gravity\"?; known: " SCENE_KEYS},
    {TOP("'integrator': 'euler'"),
     "scene.json:2:2: unknown key \"integrator\"; did you mean \"time_step\"?; known: " SCENE_KEYS},
    {TOP("'emitters': []"),
     "scene.json:2:2: unknown key \"emitters\"; did you mean \"bodies\"?; known: " SCENE_KEYS},
    {TOP("'\\u0067ravty': [0, 0, 0]"),
     "scene.json:2:2: unknown key \"gravty\"; did you mean \"gravity\"?; known: " SCENE_KEYS},
    {TOP("'gravity': [0, -9.81]"),
     "scene.json:2:13: gravity: expected an array of 3 numbers (m/s^2), found an array of "
     "2"},
    {TOP("'gravity': [0, '-9.81', 0]"),
     "scene.json:2:17: gravity[1]: expected a number from -1000000 to 1000000 m/s^2, "
     "found \"-9.81\"; JSON writes -9.81"},
    {TOP("'gravity': null"),
     "scene.json:2:13: gravity: expected an array of 3 numbers (m/s^2), found null"},
    {TOP("'$schema': 3"), "scene.json:2:13: $schema: expected a text, found 3"},
    {TOP("'name': 7"), "scene.json:2:10: name: expected a text, found 7"},
    {"{'name': '\xc3\xa4', 'duration': 0}",
     "scene.json:1:27: duration: expected a number from 1e-06 to 1000000 s, found 0"},
    {"{'duration': 0,\n 'bodies': [" WATER "]}",
     "scene.json:1:14: duration: expected a number from 1e-06 to 1000000 s, found 0"},
    {"{'duration': 'long', 'bodies': [" WATER "]}",
     "scene.json:1:14: duration: expected a number from 1e-06 to 1000000 s, found \"long\""},
    {TOP("'frame_interval': -0.1"),
     "scene.json:2:20: frame_interval: expected a number from 1e-06 to 1000 s, found -0.1"},
    /* steps and solvers */
    {TOP("'time_step': 0.1"), "scene.json:2:15: time_step: expected an object {integrator, "
                              "maximum, minimum, cfl, fixed}, found 0.1"},
    {TOP("'time_step': {'maximum': 0}"),
     "scene.json:2:27: time_step.maximum: expected a number from 1e-09 to 1000 s, found 0"},
    {TOP("'time_step': {'maximum': 1e-6}"),
     "scene.json:2:15: time_step: expected a minimum of at most the maximum, found 1e-05 "
     "and 1e-06 s"},
    {TOP("'time_step': {'fixed': 0.001, 'cfl': 2}"),
     "scene.json:2:32: time_step: \"cfl\" has no meaning beside \"fixed\""},
    {TOP("'time_step': {'fixed': 0}"),
     "scene.json:2:25: time_step.fixed: expected a number from 1e-09 to 1000 s, found 0"},
    {TOP("'time_step': {'max': 0.1}"),
     "scene.json:2:16: time_step: unknown key \"max\"; did you mean \"maximum\"?; known: "
     "integrator, maximum, minimum, cfl, fixed"},
    {TOP("'solver': {'type': 'hybird'}"),
     "scene.json:2:21: solver.type: unknown solver \"hybird\"; did you mean "
     "\"hybrid\"?; known: auto, *"},
    {TOP("'solver': null"),
     "scene.json:2:12: solver: expected an object {type, step, tolerance, "
     "outer_iterations, linear_tolerance, linear_iterations, retries}, found null"},
    {TOP("'solver': {'type': 1}"),
     "scene.json:2:21: solver.type: expected the name of a solver, found 1"},
    {TOP("'boundary': 'points', 'kernel': 'wendland'"),
     "scene.json:2:34: kernel: this kernel needs \"boundary\": \"surface\""},
    {TOP("'kernel': 'cubic'"),
     "scene.json:2:12: kernel: unknown kernel \"cubic\"; did you mean \"cubic_spline\"?; known: "
     "cubic_spline, wendland"},
    {TOP("'solver': {'step': 'Newton'}"),
     "scene.json:2:21: solver.step: unknown step \"Newton\"; did you mean \"newton\"?; "
     "known: newton, projective"},
    {TOP("'solver': {'outer_iterations': 20.5}"),
     "scene.json:2:33: solver.outer_iterations: expected a whole number from 1 to 100000, "
     "found 20.5"},
    {TOP("'solver': {'outer_iterations': 0}"),
     "scene.json:2:33: solver.outer_iterations: expected a whole number from 1 to 100000, "
     "found 0"},
    {TOP("'solver': {'linear_iterations': 5000000000}"),
     "scene.json:2:34: solver.linear_iterations: expected a whole number from 1 to "
     "1000000, found 5000000000"},
    {TOP("'solver': {'linear_tolerance': 1}"),
     "scene.json:2:33: solver.linear_tolerance: expected a number from 0 to 0.9, found 1"},
    {TOP("'solver': {'iterations': 2}"),
     "scene.json:2:13: solver: unknown key \"iterations\"; did you mean "
     "\"outer_iterations\"?; known: type, step, tolerance, outer_iterations, "
     "linear_tolerance, linear_iterations, retries"},
    /* contact */
    {"{'duration': 1, 'bodies': [" SHEET("") "],\n 'contact': {}}",
     "scene.json:2:13: contact.thickness: missing, expected a number from 1e-09 to 1000 m"},
    {"{'duration': 1, 'bodies': [" SHEET(
         "") "],\n 'contact': {'thickness': 0.001, 'friction': -1}}",
     "scene.json:2:46: contact.friction: expected a number from 0 to 100, found -1"},
};

static void test_bad_scenes(void **state) {
    (void)state;
    assert_bad_scenes(bad_scenes, COUNT(bad_scenes));
}

/* Nesting that would exhaust the stack of a careless reader. */
static void test_deep_nesting(void **state) {
    (void)state;
    struct scene scene;
    char text[5001];
    memset(text, '[', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_failure(read_text(text, NULL, 0, &scene), &scene,
                   "scene.json:1:2049: not valid JSON: *");
}
/* ---- overrides ------------------------------------------------------------------------------- */

static const struct {
    const char *set, *error;
} bad_overrides[] = {
    {"duration", "--set duration: expected PATH=VALUE, found no '='"},
    {"=1", "--set =1: expected PATH=VALUE, found an empty key"},
    {"bodies..name=1", "--set bodies..name=1: expected PATH=VALUE, found an empty key"},
    {"duration.=1", "--set duration.=1: expected PATH=VALUE, found an empty key"},
    {"a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1",
     "--set a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1: expected "
     "PATH=VALUE, found more than 32 keys"},
    {"name=\xff", "--set name=\xff"
                  ": expected PATH=VALUE in UTF-8"},
    {"duration=soon",
     "--set duration=soon: duration: expected a number from 1e-06 to 1000000 s, found "
     "\"soon\""},
    {"duration=1e999",
     "--set duration=1e999: duration: expected a number from 1e-06 to 1000000 s, found "
     "\"1e999\""},
    {"duration=-1",
     "--set duration=-1: duration: expected a number from 1e-06 to 1000000 s, found -1"},
    {"duration.seconds=1",
     "--set duration.seconds=1: \"seconds\" is a key of a value that is neither an "
     "object nor an array"},
    {"solver.typ=cg",
     "--set solver.typ=cg: solver: unknown key \"typ\"; did you mean \"type\"?; known: "
     "type, step, tolerance, outer_iterations, linear_tolerance, linear_iterations, "
     "retries"},
    {"solvr.type=cg",
     "--set solvr.type=cg: unknown key \"solvr\"; did you mean \"solver\"?; known: " SCENE_KEYS},
    {"solver.type=gc",
     "--set solver.type=gc: solver.type: unknown solver \"gc\"; did you mean \"cg\"?; "
     "known: auto, *"},
    {"solver={\"type\": \"cg\", \"step\": 2}",
     "--set solver={\"type\": \"cg\", \"step\": 2}: solver.step: expected the name of a "
     "step, found 2"},
    {"bodies.shet.velocity=[0, 0, 1]",
     "--set bodies.shet.velocity=[0, 0, 1]: no element \"shet\"; did you mean \"sheet\"?; "
     "known: 0 (water), 1 (sheet)"},
    {"water.velocity=[0, 0, 1]",
     "--set water.velocity=[0, 0, 1]: unknown key \"water\"; did you mean \"bodies.water\"?"},
    {"bodies.sheet.spring.stretching_stiffness=1",
     "--set bodies.sheet.spring.stretching_stiffness=1: bodies[1]: unknown key \"spring\"; did you "
     "mean \"constraints.spring\"?"},
    {"bodies.water.viscosity=1",
     "--set bodies.water.viscosity=1: bodies[0]: unknown key \"viscosity\"; did you mean "
     "\"viscosity\" in the \"constraints\" of a fluid?"},
    {"bodies.7.velocity=[0, 0, 1]", "--set bodies.7.velocity=[0, 0, 1]: no element \"7\"; known: 0 "
                                    "(water), 1 (sheet); to add one, set the whole array"},
    {"bodies.sheet.constraints.pin.stiffness=1",
     "--set bodies.sheet.constraints.pin.stiffness=1: no element \"pin\"; known: 0 "
     "(spring); to add one, set the whole array"},
    {"bodies.sheet.constraints.spring.stretching_stiffness=\"2\"",
     "--set bodies.sheet.constraints.spring.stretching_stiffness=\"2\": "
     "bodies[1].constraints[0].stretching_stiffness: expected a number from 0 to 1e+12 "
     "N/m, found \"2\"; JSON writes 2"},
    {"duration=.1",
     "--set duration=.1: duration: expected a number from 1e-06 to 1000000 s, found \".1\"; JSON "
     "writes 0.1"},
    {"bodies.0.particles.radius=true",
     "--set bodies.0.particles.radius=true: bodies[0].particles.radius: expected a number "
     "from 1e-06 to 1000 m, found true"},
    {"bodies.water.particles.fill.1.box=1", "--set bodies.water.particles.fill.1.box=1: no element "
                                            "\"1\"; known: 0; to add one, set the whole array"},
    {"bodies.water.particles.fill.0.box.maximum.1=-1",
     "--set bodies.water.particles.fill.0.box.maximum.1=-1: "
     "bodies[0].particles.fill[0].box.maximum[1]: expected a number above the minimum, 0 "
     "m, found -1 m"},
    {"bodies.0=null", ""},
    {"bodies.0={\"name\": null}",
     "--set bodies.0={\"name\": null}: bodies[0].name: expected a name of 1 to 64 letters, "
     "digits, '_' and '-', found null"},
    {"bodies=null", "scene.json:1:*"},
    {"bodies.shet=null", "--set bodies.shet=null: no element \"shet\"; did you mean \"sheet\"?; "
                         "known: 0 (water), 1 (sheet)"},
    {"bodies.sheet.velocty=null",
     "--set bodies.sheet.velocty=null: no key \"velocty\" to remove; known: *"},
    {"duration.seconds=null", "--set duration.seconds=null: no key \"seconds\" to remove"},
    {"bodies=[]", "--set bodies=[]: bodies: expected at least one body, found an array of 0"},
    {"bodies.sheet.constraints=[]", ""},
    {"bodies.sheet.surface.grid.vertices=[3, 3.5]",
     "--set bodies.sheet.surface.grid.vertices=[3, 3.5]: "
     "bodies[1].surface.grid.vertices[1]: expected a whole number from 2 to 134217728, "
     "found 3.5"},
};

static void test_bad_overrides(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(bad_overrides); k++) {
        struct scene scene;
        const char *const set[] = {"name=first", bad_overrides[k].set};
        pdyn_status status = read_text(BOTH, set, 2, &scene);
        if (status == PDYN_OK && !*bad_overrides[k].error) {
            free_good(&scene);
            continue;
        }
        assert_failure(status, &scene, bad_overrides[k].error);
    }
}

/* What an override leaves alone still stands in the file. */
static void test_place_beside_overrides(void **state) {
    (void)state;
    struct scene scene;
    static const char *const set[] = {"bodies.sheet.constraints.spring.stretching_stiffness=5",
                                      "bodies.sheet.velocity=[0, 0, 1]"};
    const char *text =
        "{'duration': 1, 'bodies': [\n {'name': 'sheet', 'surface': {'grid': {'size': [1, 1], "
        "'vertices': [3, 3]}, 'area_density': 1},\n"
        "  'constraints': [{'type': 'spring', 'stretching_stiffness': 1},\n"
        "   {'type': 'pin', 'vertices': {'all': 3}}]}]}";
    pdyn_status status = read_text(text, set, 2, &scene);
    assert_failure(
        status, &scene,
        "scene.json:4:40: bodies[0].constraints[1].vertices.all: expected true, found 3");
}

/* Elements behind one that was removed keep their line, and the label of a later change. */
static void test_place_after_removals(void **state) {
    (void)state;
    struct scene scene;
    static const char *const set[] = {
        "bodies.sheet.constraints.3.stiffness=-1",   "bodies.sheet.constraints.0=null",
        "bodies.sheet.constraints.bending=null",     "bodies.sheet.constraints.1.stiffness=-2",
        "bodies.sheet.constraints.1.stiffness=null", "bodies.sheet.constraints.1.stiffness=7"};
    const char *text =
        "{'duration': 1, 'bodies': [\n {'name': 'sheet', 'surface': {'grid': {'size': [1, 1], "
        "'vertices': [3, 3]}, 'area_density': 1},\n"
        "  'constraints': [{'type': 'spring', 'stretching_stiffness': 1},\n"
        "   {'type': 'bending', 'bending_rigidity': 1},\n"
        "   {'type': 'pin', 'vertices': {'all': %s}},\n"
        "   {'type': 'pin', 'vertices': {'all': %s}}]}]}";
    char given[1024];
    snprintf(given, sizeof given, text, "3", "true");
    assert_failure(
        read_text(given, set, 6, &scene), &scene,
        "scene.json:5:40: bodies[0].constraints[0].vertices.all: expected true, found 3");
    snprintf(given, sizeof given, text, "true", "4");
    assert_failure(
        read_text(given, set, 6, &scene), &scene,
        "scene.json:6:40: bodies[0].constraints[1].vertices.all: expected true, found 4");
    snprintf(given, sizeof given, text, "true", "true");
    assert_failure(read_text(given, set, 4, &scene), &scene,
                   "--set bodies.sheet.constraints.1.stiffness=-2: "
                   "bodies[0].constraints[1].stiffness: expected a number from 0 to 1e+15 N/m, "
                   "found -2");
    assert_failure(read_text(given, set, 3, &scene), &scene,
                   "--set bodies.sheet.constraints.3.stiffness=-1: "
                   "bodies[0].constraints[1].stiffness: expected a number from 0 to 1e+15 N/m, "
                   "found -1");
    assert_int_equal(read_text(given, set, 6, &scene), PDYN_OK);
    assert_int_equal(scene.body[0].constraints, 2);
    free_good(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_scenes),           cmocka_unit_test(test_deep_nesting),
        cmocka_unit_test(test_bad_overrides),        cmocka_unit_test(test_place_beside_overrides),
        cmocka_unit_test(test_place_after_removals),
    };
    return cmocka_run_group_tests_name("bad_scenes", tests, scene_set_up, scene_tear_down);
}
