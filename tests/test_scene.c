/* Scenes: good ones with all that comes of them, bad ones with their messages, overrides,
 * allocation failure, and the schema against the tables of parameters. Texts here have ' for ". */
#include "inlet.h"
#include "near.h"
#include "registry.h"
#include "scene.h"

#include <glob.h>
#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define COUNT(array)       ((int)(sizeof(array) / sizeof *(array)))
#define assert_close(a, b) assert_true(fabs((a) - (b)) <= 1e-12)

static char directory[512];
static char scenes[1024]; /* the pattern of the shipped ones */
static pdyn_context *context;
static json_t *schema;

/* ---- helpers -------------------------------------------------------------------------------- */

/* An allocator that fails for good once `left` allocations were made; left < 0: never. */
static int allocations_left = -1;
static void *counting_allocate(void *user, void *block, size_t old_size, size_t new_size) {
    (void)old_size;
    int *left = user;
    if (!new_size) return free(block), NULL;
    if (*left == 0) return NULL;
    if (*left > 0) --*left;
    return realloc(block, new_size);
}

static int set_up(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR"), *root = getenv("PROJDYN_SOURCE_ROOT");
    char path[1024], *absolute = realpath(root ? root : ".", NULL);
    if (!absolute) return -1;
    snprintf(path, sizeof path, "%s/schema/scene.schema.json", absolute);
    snprintf(scenes, sizeof scenes, "%s/scenes/*.json", absolute);
    free(absolute);
    schema = json_load_file(path, JSON_REJECT_DUPLICATES, NULL);
    snprintf(directory, sizeof directory, "%s/test_scene_XXXXXX", base ? base : "/tmp");
    if (!schema || !mkdtemp(directory) || chdir(directory)) return -1;
    pdyn_options options = pdyn_default_options();
    options.threads = 1;
    options.allocate = counting_allocate;
    options.allocate_user = &allocations_left;
    return pdyn_create(&options, &context) == PDYN_OK ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    pdyn_destroy(context);
    json_decref(schema);
    return chdir("/") || rmdir(directory); /* every test removes its files */
}

static const char *quoted(const char *text) {
    static char out[8192];
    assert_true(strlen(text) < sizeof out);
    strcpy(out, text);
    for (char *c = out; *c; c++)
        if (*c == '\'') *c = '"';
    return out;
}

static void write_file(const char *name, const char *text) {
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static void read_good(const char *text, const char *const *set, int sets, struct scene *scene) {
    pdyn_status status = scene_read(context, "scene.json", quoted(text), set, sets, scene);
    if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
}

static void free_good(struct scene *scene) {
    scene_free(context, scene);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    assert_null(scene->body);
}

/* A message that ends with '*' may go on. */
static void assert_message(const char *expected) {
    const char *found = pdyn_last_error(context);
    size_t length = strlen(expected);
    if (length && expected[length - 1] == '*' && !strncmp(found, expected, length - 1)) return;
    assert_string_equal(found, expected);
}

static void assert_failure(pdyn_status status, const struct scene *scene, const char *expected) {
    assert_int_equal(status, PDYN_BAD_INPUT);
    assert_message(expected);
    static const struct scene empty;
    assert_memory_equal(scene, &empty, sizeof empty);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

/* ---- bad scenes ----------------------------------------------------------------------------- */

#define BOX        "{'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}"
#define WATER      "{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}}"
#define TOP(extra) "{'duration': 1, 'bodies': [" WATER "],\n " extra "}"
#define BODY(text) "{'duration': 1, 'bodies': [\n  " text "]}"
#define SHEET(extra)                                                                               \
    "{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, 'area_density': 1" extra "}}"
#define CLOTH(constraints)                                                                         \
    BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, 'area_density': 1},\n"        \
         " 'constraints': [" constraints "]}")
#define FLUID(constraints)                                                                         \
    BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]},\n"                            \
         " 'constraints': [" constraints "]}")
#define INLETS(text)    BODY("{'particles': {'radius': 0.1,\n" text "}}")
#define DISC            "'disc': {'center': [0, 0, 0], 'radius': 1}, "
#define RECTANGLE(size) "'rectangle': {'center': [0, 0, 0], 'size': [" size "]}, "
#define LETTERS_13      "abcdefghijklm"
#define LETTERS_65      LETTERS_13 LETTERS_13 LETTERS_13 LETTERS_13 LETTERS_13
#define PIN(vertices)   CLOTH("{'type': 'pin', 'vertices': " vertices "}")

static const struct {
    const char *text, *error;
} bad_scenes[] = {
    /* syntax */
    {"", "scene.json:1:1: no valid JSON: *"},
    {"{'duration': 1,\n 'bodies': [}", "scene.json:2:13: no valid JSON: *"},
    {"{'duration': 1,\n 'duration': 2}",
     "scene.json:2:11: no valid JSON: duplicate object key near '\"duration\"'"},
    {"{'duration': 1} x", "scene.json:1:17: no valid JSON: *"},
    {"{'duration': 1e999}", "scene.json:1:18: no valid JSON: *"},
    {"{'duration': 99999999999999999999}", "scene.json:1:33: no valid JSON: *"},
    {"{'duration': NaN}", "scene.json:1:16: no valid JSON: *"},
    {"{'\xff': 1}", "scene.json:1:2: no valid JSON: *"},
    {"{'name': 'a\\u0000b'}", "scene.json:1:19: no valid JSON: *"},
    {"[1, 2]", "scene.json:1:1: expected an object, found an array of 2"},
    /* the scene */
    {"{}", "scene.json:1:1: duration: missing, expected a number from 1e-06 to 1000000 s"},
    {"{'duration': 1}", "scene.json:1:1: bodies: missing, expected at least one body"},
    {"{'duration': 1, 'bodies': []}",
     "scene.json:1:27: bodies: expected at least one body, found an array of 0"},
    {"{'duration': 1, 'bodies': {}}",
     "scene.json:1:27: bodies: expected an array of bodies, found an object"},
    {TOP("'gravty': [0, 0, 0]"),
     "scene.json:2:2: unknown key \"gravty\"; did you mean \"gravity\"?; known: $schema, "
     "name, gravity, time_step, solver, bodies, solids, outlets, duration, frame_interval"},
    {TOP("'\\u0067ravty': [0, 0, 0]"),
     "scene.json:2:2: unknown key \"gravty\"; did you mean \"gravity\"?; known: $schema, "
     "name, gravity, time_step, solver, bodies, solids, outlets, duration, frame_interval"},
    {TOP("'gravity': [0, -9.81]"),
     "scene.json:2:13: gravity: expected an array of 3 numbers (m/s^2), found an array of "
     "2"},
    {TOP("'gravity': [0, '-9.81', 0]"),
     "scene.json:2:17: gravity[1]: expected a number from -1000000 to 1000000 m/s^2, "
     "found \"-9.81\""},
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
    {TOP("'time_step': 0.1"), "scene.json:2:15: time_step: expected an object, found 0.1"},
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
     "scene.json:2:16: time_step: unknown key \"max\"; known: maximum, minimum, cfl, fixed"},
    {TOP("'solver': {'type': 'choleski'}"),
     "scene.json:2:21: solver.type: unknown solver \"choleski\"; did you mean "
     "\"cholesky\"?; known: auto, *"},
    {TOP("'solver': null"), "scene.json:2:12: solver: expected an object, found null"},
    {TOP("'solver': {'type': 1}"),
     "scene.json:2:21: solver.type: expected the name of a solver, found 1"},
    {TOP("'solver': {'step': 'Newton'}"),
     "scene.json:2:21: solver.step: unknown step \"Newton\"; did you mean \"newton\"?; "
     "known: newton, projective"},
    {TOP("'solver': {'outer_iterations': 20.0}"),
     "scene.json:2:33: solver.outer_iterations: expected a whole number from 1 to 100000, "
     "found 20.0"},
    {TOP("'solver': {'outer_iterations': 0}"),
     "scene.json:2:33: solver.outer_iterations: expected a whole number from 1 to 100000, "
     "found 0"},
    {TOP("'solver': {'linear_iterations': 5000000000}"),
     "scene.json:2:34: solver.linear_iterations: expected a whole number from 1 to "
     "1000000, found 5000000000"},
    {TOP("'solver': {'linear_tolerance': 2}"),
     "scene.json:2:33: solver.linear_tolerance: expected a number from 0 to 1, found 2"},
    {TOP("'solver': {'iterations': 2}"),
     "scene.json:2:13: solver: unknown key \"iterations\"; did you mean "
     "\"linear_iterations\"?; known: type, step, tolerance, outer_iterations, "
     "linear_tolerance, linear_iterations"},
    /* bodies of particles */
    {BODY("7"), "scene.json:2:3: bodies[0]: expected an object, found 7"},
    {BODY("{'name': 'a'}"),
     "scene.json:2:3: bodies[0]: expected exactly one of \"particles\" and \"surface\", "
     "found neither"},
    {BODY("{'name': 'a', 'particles': {}, 'surface': {}}"),
     "scene.json:2:3: bodies[0]: expected exactly one of \"particles\" and \"surface\", "
     "found both"},
    {BODY("{'partcles': {}}"),
     "scene.json:2:4: bodies[0]: unknown key \"partcles\"; did you mean \"particles\"?; "
     "known: name, particles, surface, constraints, velocity"},
    {BODY("{'particles': {'raduis': 0.1}}"),
     "scene.json:2:18: bodies[0].particles: unknown key \"raduis\"; did you mean "
     "\"radius\"?; known: fill, inlets, radius, rest_density, budget"},
    {BODY("{'particles': {'density': 1000}}"),
     "scene.json:2:18: bodies[0].particles: unknown key \"density\"; did you mean "
     "\"rest_density\"?; known: fill, inlets, radius, rest_density, budget"},
    {BODY("{'particles': {'fill': []}}"),
     "scene.json:2:17: bodies[0].particles.radius: missing, expected a number from 1e-06 "
     "to 1000 m"},
    {BODY("{'particles': {'radius': 0.1}}"),
     "scene.json:2:17: bodies[0].particles.fill: missing, expected at least one volume "
     "to fill, or \"inlets\""},
    {BODY("{'particles': {'radius': 0.1, 'fill': []}}"),
     "scene.json:2:41: bodies[0].particles.fill: expected at least one volume to fill, or "
     "\"inlets\", found "
     "an array of 0"},
    {BODY("{'particles': {'radius': 0, 'fill': []}}"),
     "scene.json:2:28: bodies[0].particles.radius: expected a number from 1e-06 to 1000 "
     "m, found 0"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'spher': 1}]}}"),
     "scene.json:2:43: bodies[0].particles.fill[0]: unknown key \"spher\"; did you mean "
     "\"sphere\"?; known: box, sphere, mesh, file, scale, rotate, translate, velocity"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{}]}}"),
     "scene.json:2:42: bodies[0].particles.fill[0]: expected exactly one of \"box\", "
     "\"sphere\", \"mesh\" and \"file\", found 0"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': 1, 'file': 2}]}}"),
     "scene.json:2:42: bodies[0].particles.fill[0]: expected exactly one of \"box\", "
     "\"sphere\", \"mesh\" and \"file\", found 2"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'sphere': 1}]}}"),
     "scene.json:2:53: bodies[0].particles.fill[0].sphere: expected an object, found 1"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': "
          "0.09}}]}}"),
     "scene.json:2:53: bodies[0].particles.fill[0].sphere: no particle of radius 0.1 m fits "
     "into it"},
    {BODY("{'particles': {'radius': 1e-6, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': "
          "1e6}}]}}"),
     "scene.json:2:54: bodies[0].particles.fill[0].sphere: more than 536870911 points: the "
     "particle radius is too small for the size of the scene"},
    {BODY("{'particles': {'radius': 1, 'fill': [{'sphere': {'center': [-1e6, 0, 0], 'radius': "
          "3}}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].sphere: expected particles at most 1e+06 m "
     "from the origin, found x = -1000002 m"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX ", 'scale': 2}]}}"),
     "scene.json:2:96: bodies[0].particles.fill[0]: \"scale\" needs a \"mesh\" or a \"file\""},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX ", 'velocity': 2}]}}"),
     "scene.json:2:108: bodies[0].particles.fill[0].velocity: expected an array of 3 numbers "
     "(m/s), found 2"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'mesh': 3}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].mesh: expected the name of a mesh file, .obj "
     "or .ply, found 3"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'file': 3}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].file: expected the name of a file of "
     "particles, .ply or .vtk, found 3"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'file': 'a.obj'}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].file: a.obj: expected a file of particles "
     "ending with .ply or .vtk"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': {'minimum': [0, 0, 0]}}]}}"),
     "scene.json:2:50: bodies[0].particles.fill[0].box.maximum: missing, expected an "
     "array of 3 numbers (m)"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': {'minimum': [0, 0, 0],\n"
          "   'maximum': [1, 0, 1]}}]}}"),
     "scene.json:3:19: bodies[0].particles.fill[0].box.maximum[1]: expected a number "
     "above the minimum, 0 m, found 0 m"},
    {BODY("{'particles': {'radius': 0.6, 'fill': [\n   {'box': " BOX "}]}}"),
     "scene.json:3:12: bodies[0].particles.fill[0].box: expected edges of at least 1.2 m "
     "(twice the radius), found 1 m along x"},
    {BODY("{'particles': {'radius': 0.0005, 'fill': [\n   {'box': " BOX "}]}}"),
     "scene.json:3:12: bodies[0].particles.fill[0].box: expected at most 134217728 "
     "particles in the scene, found 1000000000 so far"},
    {BODY("{'particles': {'radius': 0.004, 'fill': [{'box': " BOX "}]}},\n"
          "  {'particles': {'radius': 0.00098, 'fill': [{'box': " BOX "}]}}"),
     "scene.json:3:54: bodies[1].particles.fill[0].box: expected at most 134217728 "
     "particles in the scene, found 134604125 so far"},
    {BODY(WATER ",\n  {'velocity': [1], 'particles': {}}"),
     "scene.json:3:16: bodies[1].velocity: expected an array of 3 numbers (m/s), found an "
     "array of 1"},
    /* names */
    {BODY("{'name': 'a b', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"a b\""},
    {BODY("{'name': '', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"\""},
    {BODY("{'name': 'w\xc3\xa4sser', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"w\xc3"
     "\xa4"
     "sser\""},
    {BODY("{'name': '" LETTERS_65 "', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"abcdefghijklm*"},
    {BODY("{'name': null, 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found null"},
    {BODY("{'name': 'boundary', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: the name \"boundary\" is reserved for the files of "
     "the solids"},
    {BODY("{'name': 'body1', 'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}},\n  " WATER),
     "scene.json:3:3: bodies[1].name: the name \"body1\" is already taken by another body "
     "or solid"},
    {TOP("'solids': [{'name': 'body0', 'box': " BOX "}]"),
     "scene.json:2:22: solids[0].name: the name \"body0\" is already taken by another "
     "body or solid"},
    /* surfaces */
    {BODY("{'surface': {'area_density': 1}}"),
     "scene.json:2:15: bodies[0].surface: expected exactly one of \"grid\" and \"mesh\", "
     "found neither"},
    {BODY("{'surface': {'grid': {}, 'mesh': 'a.obj'}}"),
     "scene.json:2:15: bodies[0].surface: expected exactly one of \"grid\" and \"mesh\", "
     "found both"},
    {BODY("{'surface': {'mesh': 'a.stl', 'area_density': 1}}"),
     "scene.json:2:24: bodies[0].surface.mesh: a.stl: expected a mesh file ending with "
     ".obj or .ply"},
    {BODY("{'surface': {'grid': {}}}"),
     "scene.json:2:15: bodies[0].surface.area_density: missing, expected a number from "
     "1e-06 to 1000000 kg/m^2"},
    {BODY("{'surface': {'grid': {}, 'area_density': 1}}"),
     "scene.json:2:24: bodies[0].surface.grid.size: missing, expected an array of 2 "
     "numbers (m)"},
    {BODY("{'surface': {'grid': {'size': [1, 0], 'vertices': [3, 3]}, 'area_density': 1}}"),
     "scene.json:2:37: bodies[0].surface.grid.size[1]: expected a number from 1e-06 to "
     "1000000 m, found 0"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3], 'sag': [1]}, "
          "'area_density': 1}}"),
     "scene.json:2:68: bodies[0].surface.grid.sag: expected a number from -1000000 to 1000000 m, "
     "found an array of 1"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3]}, 'area_density': 1}}"),
     "scene.json:2:53: bodies[0].surface.grid.vertices: expected an array of 2 whole "
     "numbers, found an array of 1"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 1]}, 'area_density': 1}}"),
     "scene.json:2:57: bodies[0].surface.grid.vertices[1]: expected a whole number from 2 "
     "to 134217728, found 1"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [90000, 90000]}, 'area_density': 1}}"),
     "scene.json:2:53: bodies[0].surface.grid.vertices: expected at most 134217728 "
     "particles in the scene, found 8100000000 so far"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [8193, 16384]}, 'area_density': 1}}"),
     "scene.json:2:53: bodies[0].surface.grid.vertices: expected at most 134217728 "
     "particles in the scene, found 134234112 so far"},
    {BODY(SHEET(", 'scale': 0")),
     "scene.json:2:90: bodies[0].surface.scale: expected a number from 1e-06 to 1000000, "
     "found 0"},
    {BODY(SHEET(", 'scale': [1, -1, 1]")),
     "scene.json:2:94: bodies[0].surface.scale[1]: expected a number from 1e-06 to "
     "1000000, found -1"},
    {BODY(SHEET(", 'scale': [1, 1]")),
     "scene.json:2:90: bodies[0].surface.scale: expected an array of 3 numbers, found an "
     "array of 2"},
    {BODY(SHEET(", 'scale': [1e6, 1, 1e-6]")),
     "scene.json:2:24: bodies[0].surface.grid: as placed: triangle 0 (vertices 0, 3, 4) "
     "has no area"},
    {BODY(SHEET(", 'rotate': 90")),
     "scene.json:2:91: bodies[0].surface.rotate: expected an array of 3 numbers "
     "(degrees), found 90"},
    {BODY(SHEET(", 'translate': [0, 0, 1e7]")),
     "scene.json:2:101: bodies[0].surface.translate[2]: expected a number from -1000000 "
     "to 1000000 m, found 10000000.0"},
    /* constraints */
    {CLOTH("7"), "scene.json:3:18: bodies[0].constraints[0]: expected an object, found 7"},
    {CLOTH("{}"), "scene.json:3:18: bodies[0].constraints[0].type: missing, expected the name of a "
                  "constraint"},
    {CLOTH("{'type': 'sprnig'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: unknown constraint \"sprnig\"; did "
     "you mean \"spring\"?; known: bending, *"},
    {CLOTH("{'type': 'spring'}"),
     "scene.json:3:18: bodies[0].constraints[0].stretching_stiffness: missing, expected a "
     "number from 0 to 1e+12 N/m"},
    {CLOTH("{'type': 'spring', 'stiffness': 1}"),
     "scene.json:3:37: bodies[0].constraints[0]: unknown key \"stiffness\"; did you mean "
     "\"stretching_stiffness\"?; known: type, stretching_stiffness"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': -1}"),
     "scene.json:3:61: bodies[0].constraints[0].stretching_stiffness: expected a number "
     "from 0 to 1e+12 N/m, found -1"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': 1},\n  {'type': 'spring'}"),
     "scene.json:4:12: bodies[0].constraints[1].type: a second \"spring\" constraint on "
     "body \"body0\""},
    {CLOTH("{'type': 'fluid'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"fluid\" works on a body of "
     "particles, found a surface"},
    {FLUID("{'type': 'bending'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"bending\" works on a surface, "
     "found a body of particles"},
    {FLUID("{'type': 'fluid', 'viscosity': true}"),
     "scene.json:3:49: bodies[0].constraints[0].viscosity: expected a number from 0 to 1, "
     "found true"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX
          "}]}, 'constraints': [{'type': 'fluid'}]},\n"
          "  {'particles': {'radius': 0.1, 'fill': [{'box': " BOX
          "}]}, 'constraints': [{'type': 'fluid'}]}"),
     "scene.json:3:124: bodies[1].constraints[0].type: only one body may have a \"fluid\" "
     "constraint; put all volumes into its \"fill\""},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}, 'constraints': {}}"),
     "scene.json:2:114: bodies[0].constraints: expected an array of constraints, found an "
     "object"},
    /* chosen vertices and paths */
    {CLOTH("{'type': 'pin'}"),
     "scene.json:3:18: bodies[0].constraints[0].vertices: missing, expected an object "
     "that chooses vertices, or an array of such objects"},
    {PIN("'all'"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: expected an object that chooses "
     "vertices, or an array of such objects, found \"all\""},
    {PIN("[]"), "scene.json:3:46: bodies[0].constraints[0].vertices: selects no vertex of 9"},
    {PIN("{}"), "scene.json:3:46: bodies[0].constraints[0].vertices: expected exactly one of "
                "\"all\", \"vertices\", \"box\", \"sphere\", \"border\", found 0 keys"},
    {PIN("{'all': false}"),
     "scene.json:3:54: bodies[0].constraints[0].vertices.all: expected true, found false"},
    {PIN("{'all': true, 'border': true}"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: expected exactly one of "
     "\"all\", \"vertices\", \"box\", \"sphere\", \"border\", found 2 keys"},
    {PIN("{'everything': true}"),
     "scene.json:3:47: bodies[0].constraints[0].vertices: unknown key \"everything\"; "
     "known: all, vertices, box, sphere, border"},
    {PIN("{'vertices': 4}"),
     "scene.json:3:59: bodies[0].constraints[0].vertices.vertices: expected an array of "
     "vertex numbers, found 4"},
    {PIN("{'vertices': [0, 9]}"),
     "scene.json:3:63: bodies[0].constraints[0].vertices.vertices[1]: expected a whole "
     "number from 0 to 8, found 9"},
    {PIN("{'vertices': [0, -1]}"),
     "scene.json:3:63: bodies[0].constraints[0].vertices.vertices[1]: expected a whole "
     "number from 0 to 8, found -1"},
    {PIN("{'vertices': [0.5]}"),
     "scene.json:3:60: bodies[0].constraints[0].vertices.vertices[0]: expected a whole "
     "number from 0 to 8, found 0.5"},
    {PIN("{'box': {'minimum': [5, 5, 5], 'maximum': [6, 6, 6]}}"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: selects no vertex of 9"},
    {PIN("{'sphere': {'center': [0, 0, 0], 'radius': -1}}"),
     "scene.json:3:89: bodies[0].constraints[0].vertices.sphere.radius: expected a number "
     "from 0 to 1000000 m, found -1"},
    {PIN("[{'all': true}, {'sphere': {'centre': [0, 0, 0]}}]"),
     "scene.json:3:74: bodies[0].constraints[0].vertices[1].sphere: unknown key "
     "\"centre\"; did you mean \"center\"?; known: center, radius"},
    {PIN("{'all': true}, 'path': []"),
     "scene.json:3:69: bodies[0].constraints[0].path: expected an array of at least one "
     "[time, dx, dy, dz] (s, m, m, m), found an array of 0"},
    {PIN("{'all': true}, 'path': [[0, 0, 0]]"),
     "scene.json:3:70: bodies[0].constraints[0].path[0]: expected an array of 4 numbers "
     "(s, m, m, m), found an array of 3"},
    {PIN("{'all': true}, 'path': [[0, 0, 0, 0],\n  [1, 0, 0, 0], [1, 0, 1, 0]]"),
     "scene.json:4:17: bodies[0].constraints[0].path[2]: expected a time after 1 s, found "
     "1 s"},
    /* solids */
    {TOP("'solids': {}"), "scene.json:2:12: solids: expected an array of solids, found an object"},
    {TOP("'solids': [{}]"),
     "scene.json:2:13: solids[0]: expected exactly one of \"box\" and \"mesh\", found "
     "neither"},
    {TOP("'solids': [{'box': " BOX ", 'mesh': 'a.obj'}]"),
     "scene.json:2:13: solids[0]: expected exactly one of \"box\" and \"mesh\", found both"},
    {TOP("'solids': [{'box': " BOX ", 'open': ['y']}]"),
     "scene.json:2:76: solids[0].open[0]: unknown side \"y\"; did you mean \"-y\"?; "
     "known: -x, +x, -y, +y, -z, +z"},
    {TOP("'solids': [{'box': " BOX ", 'open': '+y'}]"),
     "scene.json:2:75: solids[0].open: expected an array of sides like \"+y\", found "
     "\"+y\""},
    {TOP("'solids': [{'box': " BOX ", 'open': ['+y', '+y']}]"),
     "scene.json:2:82: solids[0].open[1]: the side \"+y\" stands here twice"},
    {TOP("'solids': [{'box': " BOX ", 'open': ['-x', '+x', '-y', '+y', '-z', '+z']}]"),
     "scene.json:2:75: solids[0].open: all six sides are open: no wall is left"},
    {TOP("'solids': [{'box': " BOX ", 'scale': 2}]"),
     "scene.json:2:67: solids[0]: \"scale\" needs a \"mesh\""},
    {TOP("'solids': [{'mesh': 'a.obj', 'open': []}]"),
     "scene.json:2:31: solids[0]: \"open\" needs a \"box\""},
    {TOP("'solids': [{'mesh': 'a.obj', 'scale': [1, 0, 1]}]"),
     "scene.json:2:40: solids[0].scale: expected a scale that is not 0, found an array of "
     "3"},
    {TOP("'solids': [{'mesh': 7}]"),
     "scene.json:2:22: solids[0].mesh: expected the name of a mesh file, .obj or .ply, "
     "found 7"},
    /* inlets */
    {INLETS("'fill': [{'box': " BOX "}], 'inlets': 1"),
     "scene.json:3:76: bodies[0].particles.inlets: expected an array of inlets, found 1"},
    {INLETS("'inlets': []"),
     "scene.json:2:17: bodies[0].particles.fill: missing, expected at least one "
     "volume to fill, or \"inlets\""},
    {INLETS("'inlets': [{" DISC "'direction': [0, 0, 0], 'speed': 1}]"),
     "scene.json:3:70: bodies[0].particles.inlets[0].direction: expected a direction that is not "
     "0, found an array of 3"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 0}]"),
     "scene.json:3:90: bodies[0].particles.inlets[0].speed: expected a number from 1e-06 to "
     "1000000 m/s, found 0"},
    {INLETS("'inlets': [{'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:12: bodies[0].particles.inlets[0]: expected exactly one of \"rectangle\" and "
     "\"disc\", found neither"},
    {INLETS("'inlets': [{" DISC RECTANGLE("1, 1") "'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:12: bodies[0].particles.inlets[0]: expected exactly one of \"rectangle\" and "
     "\"disc\", found both"},
    {INLETS("'inlets': [{" RECTANGLE("1, 0.1") "'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:56: bodies[0].particles.inlets[0].rectangle.size: expected edges of at least "
     "0.2 m (twice the radius), found 0.1 m"},
    {INLETS("'inlets': [{" RECTANGLE("1e6, 1e6") "'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:26: bodies[0].particles.inlets[0].rectangle: expected at most 134217728 "
     "particles in a layer, found about 2.5e+13"},
    {INLETS("'inlets': [{" DISC "'direction': [0, 2, 0], 'up': [0, -1, 0], 'speed': 1}]"),
     "scene.json:3:87: bodies[0].particles.inlets[0].up: expected a direction that is not 0 and "
     "not that of the stream, found an array of 3"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1, 'stop': 1}]"),
     "scene.json:3:93: bodies[0].particles.inlets[0]: unknown key \"stop\"*"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1e6, 'start': 0.5}]"),
     "scene.json:3:11: bodies[0].particles.inlets: expected at most 134217728 particles in the "
     "scene, found 202500000 so far"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1}], 'budget': 0"),
     "scene.json:3:105: bodies[0].particles.budget: expected a whole number from 1 to 134217728, "
     "found 0"},
    {INLETS("'fill': [{'box': " BOX "}], 'budget': 5"),
     "scene.json:3:66: bodies[0].particles: \"budget\" needs \"inlets\""},
    /* outlets */
    {TOP("'outlets': {}"),
     "scene.json:2:13: outlets: expected an array of outlets, found an object"},
    {TOP("'outlets': [{'outside': true}]"),
     "scene.json:2:14: outlets[0].box: missing, expected an object"},
    {TOP("'outlets': [{'box': " BOX ", 'outside': 1}]"),
     "scene.json:2:79: outlets[0].outside: expected true or false, found 1"},
    {TOP("'solids': [{'box': " BOX ", 'pivot': [0, 0, 0]}]"),
     "scene.json:2:67: solids[0]: \"pivot\" needs a \"motion\""},
    {TOP("'solids': [{'box': " BOX ", 'motion': {}}]"),
     "scene.json:2:77: solids[0].motion: expected an array of keys, found an object"},
    {TOP("'solids': [{'box': " BOX ", 'motion': []}]"),
     "scene.json:2:77: solids[0].motion: expected at least one key, found an array of 0"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'translate': [0, 0, 0]}]}]"),
     "scene.json:2:78: solids[0].motion[0].time: missing, expected a number from -1000000 to "
     "1000000 s"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 0, 'rotation': [0, 0, 0]}]}]"),
     "scene.json:2:90: solids[0].motion[0]: unknown key \"rotation\"; did you mean \"rotate\"?; "
     "known: time, translate, rotate"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 1},\n {'time': 1}]}]"),
     "scene.json:3:11: solids[0].motion[1].time: expected a time after 1 s, found 1 s"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 1}], 'pivot': [0, 0]}]"),
     "scene.json:2:101: solids[0].pivot: expected an array of 3 numbers (m), found an array of 2"},
};

static void test_bad_scenes(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(bad_scenes); k++) {
        struct scene scene;
        pdyn_status status =
            scene_read(context, "scene.json", quoted(bad_scenes[k].text), NULL, 0, &scene);
        assert_failure(status, &scene, bad_scenes[k].error);
    }
}

/* Nesting that would exhaust the stack of a careless reader. */
static void test_deep_nesting(void **state) {
    (void)state;
    struct scene scene;
    char text[5001];
    memset(text, '[', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_failure(scene_read(context, "scene.json", text, NULL, 0, &scene), &scene,
                   "scene.json:1:2049: no valid JSON: *");
}

/* ---- overrides ------------------------------------------------------------------------------ */

#define BOTH                                                                                       \
    "{'duration': 1, 'bodies': [\n"                                                                \
    "  {'name': 'water', 'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}},\n"             \
    "  {'name': 'sheet', 'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, "               \
    "'area_density': 1},\n"                                                                        \
    "   'constraints': [{'type': 'spring', 'stretching_stiffness': 1000}]}]}"

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
     "--set duration.seconds=1: \"seconds\" leads into a value that is no object and no "
     "array"},
    {"solver.typ=cg",
     "--set solver.typ=cg: solver: unknown key \"typ\"; did you mean \"type\"?; known: "
     "type, step, tolerance, outer_iterations, linear_tolerance, linear_iterations"},
    {"solvr.type=cg",
     "--set solvr.type=cg: unknown key \"solvr\"; did you mean \"solver\"?; known: "
     "$schema, name, gravity, time_step, solver, bodies, solids, outlets, duration, "
     "frame_interval"},
    {"solver.type=gc",
     "--set solver.type=gc: solver.type: unknown solver \"gc\"; did you mean \"cg\"?; "
     "known: auto, *"},
    {"solver={\"type\": \"cg\", \"step\": 2}",
     "--set solver={\"type\": \"cg\", \"step\": 2}: solver.step: expected the name of a "
     "step, found 2"},
    {"bodies.shet.velocity=[0, 0, 1]",
     "--set bodies.shet.velocity=[0, 0, 1]: no element \"shet\"; did you mean \"sheet\"?; "
     "there are 0 (water), 1 (sheet)"},
    {"bodies.7.velocity=[0, 0, 1]",
     "--set bodies.7.velocity=[0, 0, 1]: no element \"7\"; there are 0 (water), 1 (sheet)"},
    {"bodies.sheet.constraints.pin.stiffness=1",
     "--set bodies.sheet.constraints.pin.stiffness=1: no element \"pin\"; there are 0 "
     "(spring)"},
    {"bodies.sheet.constraints.spring.stretching_stiffness=\"2\"",
     "--set bodies.sheet.constraints.spring.stretching_stiffness=\"2\": "
     "bodies[1].constraints[0].stretching_stiffness: expected a number from 0 to 1e+12 "
     "N/m, found \"2\""},
    {"bodies.0.particles.radius=true",
     "--set bodies.0.particles.radius=true: bodies[0].particles.radius: expected a number "
     "from 1e-06 to 1000 m, found true"},
    {"bodies.water.particles.fill.1.box=1",
     "--set bodies.water.particles.fill.1.box=1: no element \"1\"; there are 0"},
    {"bodies.water.particles.fill.0.box.maximum.1=-1",
     "--set bodies.water.particles.fill.0.box.maximum.1=-1: "
     "bodies[0].particles.fill[0].box.maximum[1]: expected a number above the minimum, 0 "
     "m, found -1 m"},
    {"bodies.0=null", "--set bodies.0=null: bodies[0]: expected an object, found null"},
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
        pdyn_status status = scene_read(context, "scene.json", quoted(BOTH), set, 2, &scene);
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
    pdyn_status status = scene_read(context, "scene.json", quoted(text), set, 2, &scene);
    assert_failure(
        status, &scene,
        "scene.json:4:40: bodies[0].constraints[1].vertices.all: expected true, found 3");
}

static double stiffness_of(const struct scene *scene, int body) {
    return *(const double *)scene->body[body].constraint[0].params;
}

static void test_good_overrides(void **state) {
    (void)state;
    struct scene scene;
    static const char *const set[] = {
        "bodies.sheet.constraints.spring.stretching_stiffness=2000",
        "bodies.1.velocity=[0, 0, 1]",
        "solver.type=cholesky",
        "solver.step=projective",
        "time_step={\"fixed\": 0.25}",
        "bodies.water.particles.fill.0.box.maximum.1=3",
        "name=a=b",
        "duration=5",
        "duration=6",
        "gravity.1=-1",
    };
    const char *text = BOTH;
    char with_gravity[4096];
    snprintf(with_gravity, sizeof with_gravity, "{'gravity': [0, 0, 0], %s", text + 1);
    read_good(with_gravity, set, COUNT(set), &scene);
    assert_true(stiffness_of(&scene, 1) == 2000.0);
    assert_true(scene.body[1].velocity[2] == 1.0);
    assert_string_equal(scene.settings.solver_type, "cholesky");
    assert_false(scene.settings.newton);
    assert_true(scene.settings.h_fixed == 0.25);
    assert_int_equal(scene.body[0].start.count, 5 * 15 * 5);
    assert_string_equal(scene.name, "a=b");
    assert_true(scene.settings.duration == 6.0);
    assert_true(scene.settings.gravity[1] == -1.0);
    free_good(&scene);
}

/* ---- good scenes ---------------------------------------------------------------------------- */

static void test_defaults(void **state) {
    (void)state;
    struct scene scene;
    read_good("{'$schema': 'x', 'duration': 2, 'bodies': [" WATER ", " SHEET("") "], 'solids': []}",
              NULL, 0, &scene);
    const struct scene_settings *s = &scene.settings;
    assert_string_equal(scene.file, "scene.json");
    assert_string_equal(scene.name, "");
    assert_true(s->gravity[0] == 0.0 && s->gravity[1] == -9.81 && s->gravity[2] == 0.0);
    assert_true(s->duration == 2.0 && s->frame_interval == 1.0 / 30.0);
    assert_true(s->h_fixed == 0.0 && s->h_min == 1e-5 && s->h_max == 0.005 && s->cfl == 1.0);
    assert_true(s->tolerance == 0.1 && s->linear_tolerance == 0.01 && s->newton);
    assert_int_equal(s->outer_iterations, 20);
    assert_int_equal(s->linear_iterations, 500);
    assert_string_equal(s->solver_type, "auto");
    assert_int_equal(scene.bodies, 2);
    assert_int_equal(scene.solids, 0);
    assert_string_equal(scene.body[0].name, "body0");
    assert_string_equal(scene.body[1].name, "body1");
    assert_false(scene.body[0].is_surface);
    assert_true(scene.body[0].rest_density == 1000.0 && scene.body[0].radius == 0.1);
    assert_int_equal(scene.body[0].constraints, 0);
    assert_true(scene.body[1].is_surface && scene.body[1].area_density == 1.0);
    assert_int_equal(scene.body[1].mesh.vertices, 9);
    assert_int_equal(scene.body[1].start.count, 0);
    free_good(&scene);
}

static const char full[] =
    "{\n"
    "'name': 'Water on a cloth', 'gravity': [1, -2, 3], 'duration': 3.0, 'frame_interval': 0.04,\n"
    "'time_step': {'maximum': 0.004, 'minimum': 2e-5, 'cfl': 0.5},\n"
    "'solver': {'type': 'cg', 'step': 'projective', 'tolerance': 0.2, 'outer_iterations': 7,\n"
    "           'linear_tolerance': 0.03, 'linear_iterations': 90},\n"
    "'bodies': [\n"
    "  {'name': 'water', 'particles': {'radius': 0.01, 'rest_density': 900, 'fill': [\n"
    "     {'box': {'minimum': [0, 0.5, 0], 'maximum': [1, 1.5, 1]}},\n"
    "     {'box': {'minimum': [2, 0, 0], 'maximum': [2.02, 0.02, 0.02]}}]},\n"
    "   'velocity': [0, -1, 0], 'constraints': [{'type': 'fluid', 'viscosity': 0.5}]},\n"
    "  {'name': 'sheet', 'surface': {'grid': {'size': [2, 4], 'vertices': [3, 5]}, 'translate': "
    "[0, 9, 0],\n"
    "     'area_density': 0.3},\n"
    "   'constraints': [{'type': 'spring', 'stretching_stiffness': 1000},\n"
    "     {'type': 'bending', 'bending_rigidity': 0.001},\n"
    "     {'type': 'pin', 'vertices': [{'vertices': [14, 0, 0]}, {'sphere': {'center': [0, 9, 0], "
    "'radius': 0.5}}],\n"
    "      'stiffness': 5, 'path': [[0, 0, 0, 0], [1, 0, 2, 0]]}]}],\n"
    "'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [1, 2, 1]}, 'open': "
    "['+y', '-z'],\n"
    "   'motion': [{'time': 0}, {'time': 2, 'translate': [1, 0, 0], 'rotate': [0, 720, 0]}]},\n"
    "  {'mesh': 'wall.obj', 'scale': [1, -2, 1], 'translate': [0, 0, 5], 'motion': [{'time': 0}]},"
    "\n  {'mesh': 'wall.obj', 'motion': [{'time': 0}], 'pivot': [4, 5, 6]}]}";

static const char wall[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

static void check_full(const struct scene *scene) {
    const struct scene_settings *s = &scene->settings;
    assert_string_equal(scene->name, "Water on a cloth");
    assert_true(s->gravity[0] == 1.0 && s->gravity[1] == -2.0 && s->gravity[2] == 3.0);
    assert_true(s->duration == 3.0 && s->frame_interval == 0.04);
    assert_true(s->h_fixed == 0.0 && s->h_max == 0.004 && s->h_min == 2e-5 && s->cfl == 0.5);
    assert_true(s->tolerance == 0.2 && s->linear_tolerance == 0.03 && !s->newton);
    assert_int_equal(s->outer_iterations, 7);
    assert_int_equal(s->linear_iterations, 90);
    assert_string_equal(s->solver_type, "cg");
    const struct scene_body *water = &scene->body[0], *sheet = &scene->body[1];
    assert_string_equal(water->name, "water");
    assert_int_equal(water->start.count, 50 * 50 * 50 + 1);
    assert_close(water->start.x[1], 0.51);
    assert_close(water->start.x[3 * 125000], 2.01);
    assert_true(water->radius == 0.01 && water->rest_density == 900.0 &&
                water->velocity[1] == -1.0);
    assert_ptr_equal(water->constraint[0].type, registry_constraint("fluid"));
    assert_true(sheet->is_surface && sheet->area_density == 0.3);
    assert_int_equal(sheet->mesh.vertices, 15);
    assert_int_equal(sheet->constraints, 3);
    assert_ptr_equal(sheet->constraint[2].type, registry_constraint("pin"));
    assert_true(stiffness_of(scene, 1) == 1000.0);
    assert_int_equal(scene->solids, 3);
    assert_true(scene->solid[0].is_box && scene->solid[0].box.max[1] == 2.0);
    assert_int_equal(scene->solid[0].open, 1 << 3 | 1 << 4);
    assert_string_equal(scene->solid[1].name, "solid1");
    assert_int_equal(scene->solid[1].mesh.triangles, 1);
    assert_true(scene->solid[1].mesh.vertex[7] == -2.0);
    const struct scene_key *key = scene->solid[0].key;
    assert_int_equal(scene->solid[0].keys, 2);
    assert_true(key[1].time == 2.0 && key[1].translate[0] == 1.0 && key[1].rotate[1] == 720.0);
    assert_true(key[0].translate[0] == 0.0 && key[0].rotate[1] == 0.0);
    assert_true(scene->solid[0].pivot[0] == 0.5 && scene->solid[0].pivot[1] == 1.0);
    assert_true(scene->solid[1].pivot[2] == 5.0 && scene->solid[2].pivot[2] == 6.0);
}

/* The parameter at `name` in the struct of a constraint. */
static const void *parameter(const struct scene_constraint *constraint, const char *name) {
    for (const pdyn_param *p = constraint->type->params; p->name; p++)
        if (!strcmp(p->name, name)) return (const char *)constraint->params + p->offset;
    fail_msg("%s has no parameter %s", constraint->type->name, name);
    return NULL;
}

static void test_full_scene(void **state) {
    (void)state;
    struct scene scene;
    write_file("wall.obj", wall);
    read_good(full, NULL, 0, &scene);
    check_full(&scene);
    const struct scene_constraint *pin = &scene.body[1].constraint[2];
    const pdyn_vertices *vertices = parameter(pin, "vertices");
    const pdyn_path *path = parameter(pin, "path");
    assert_int_equal(vertices->count, 3);
    assert_memory_equal(vertices->index, ((int[]){0, 7, 14}), 3 * sizeof(int));
    assert_int_equal(path->count, 2);
    assert_memory_equal(path->key, ((double[]){0, 0, 0, 0, 1, 0, 2, 0}), 8 * sizeof(double));
    assert_true(*(const double *)parameter(pin, "stiffness") == 5.0);
    assert_true(*(const double *)parameter(&scene.body[0].constraint[0], "viscosity") == 0.5);
    free_good(&scene);
    assert_int_equal(unlink("wall.obj"), 0);
}

static void check_choice(const char *choice, int count, const int *index) {
    char text[1024];
    struct scene scene;
    snprintf(text, sizeof text, PIN("%s"), choice);
    read_good(text, NULL, 0, &scene);
    const struct scene_constraint *pin = &scene.body[0].constraint[0];
    const pdyn_vertices *vertices = parameter(pin, "vertices");
    assert_int_equal(vertices->count, count);
    assert_memory_equal(vertices->index, index, (size_t)count * sizeof *index);
    assert_int_equal(((const pdyn_path *)parameter(pin, "path"))->count, 0);
    free_good(&scene);
}

static void test_choices(void **state) {
    (void)state;
    check_choice("{'all': true}", 9, (int[]){0, 1, 2, 3, 4, 5, 6, 7, 8});
    check_choice("{'border': true}", 8, (int[]){0, 1, 2, 3, 5, 6, 7, 8});
    check_choice("{'vertices': [8, 2, 8]}", 2, (int[]){2, 8});
    check_choice("{'box': {'minimum': [-1, -1, -1], 'maximum': [0, 0, 0]}}", 4,
                 (int[]){0, 1, 3, 4});
    check_choice("{'sphere': {'center': [0, 0, 0], 'radius': 0.5}}", 5, (int[]){1, 3, 4, 5, 7});
    check_choice("[{'vertices': [8]}, {'vertices': []}, {'vertices': [4]}]", 2, (int[]){4, 8});
}

/* (1, 0, 0) scaled by 2, turned by 90 degrees about x, y and z: x -> x -> -z -> -z */
static void test_transform(void **state) {
    (void)state;
    struct scene scene;
    write_file("wall.obj", wall);
    read_good(BODY("{'surface': {'mesh': 'wall.obj', 'area_density': 1, 'scale': [2, 3, 1],\n"
                   " 'rotate': [90, 90, 90], 'translate': [10, 20, 30]}}"),
              NULL, 0, &scene);
    const double *x = scene.body[0].mesh.vertex;
    const double expected[] = {10, 20, 30, 10, 20, 28, 10, 23, 30};
    /* (0, 1, 0) scaled by 3: y -> z -> x -> y */
    for (int k = 0; k < 9; k++) assert_close(x[k], expected[k]);
    free_good(&scene);
    read_good(BODY("{'surface': {'mesh': 'wall.obj', 'area_density': 1, 'scale': 2, 'rotate': [0, "
                   "0, 90]}}"),
              NULL, 0, &scene);
    assert_close(scene.body[0].mesh.vertex[4], 2.0);
    assert_close(scene.body[0].mesh.vertex[6], -2.0);
    free_good(&scene);
    assert_int_equal(unlink("wall.obj"), 0);
}

/* ---- files ---------------------------------------------------------------------------------- */

static void test_files(void **state) {
    (void)state;
    struct scene scene;
    char absolute[1024];
    assert_int_equal(mkdir("folder", 0700), 0);
    write_file("folder/wall.obj", wall);
    write_file("folder/scene.json", quoted(TOP("'solids': [{'mesh': 'wall.obj'}]")));
    assert_int_equal(scene_read(context, "folder/scene.json", NULL, NULL, 0, &scene), PDYN_OK);
    assert_string_equal(scene.file, "folder/scene.json");
    assert_int_equal(scene.solid[0].mesh.vertices, 3);
    free_good(&scene);
    snprintf(absolute, sizeof absolute, "solids.0.mesh=%s/folder/wall.obj", directory);
    const char *const set[] = {absolute};
    assert_int_equal(scene_read(context, "folder/scene.json", NULL, set, 1, &scene), PDYN_OK);
    free_good(&scene);
    /* a text has no folder, whatever its name */
    pdyn_status status =
        scene_read(context, "folder/scene.json", quoted(TOP("'solids': [{'mesh': 'wall.obj'}]")),
                   NULL, 0, &scene);
    assert_int_equal(status, PDYN_IO_FAILED);
    assert_message("folder/scene.json:2:22: solids[0].mesh: wall.obj: cannot open the file: "
                   "No such file or directory");
    assert_int_equal(scene_read(context, "folder", NULL, NULL, 0, &scene), PDYN_IO_FAILED);
    assert_message("folder: expected a regular file");
    assert_int_equal(scene_read(context, "none.json", NULL, NULL, 0, &scene), PDYN_IO_FAILED);
    assert_message("none.json: cannot open the file: No such file or directory");
    write_file("folder/scene.json", "{\n  \"duration\": 1,\n  \"bodies\": [\n");
    assert_failure(scene_read(context, "folder/scene.json", NULL, NULL, 0, &scene), &scene,
                   "folder/scene.json:4:1: no valid JSON: *");
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    assert_int_equal(unlink("folder/scene.json") | unlink("folder/wall.obj") | rmdir("folder"), 0);
}

static void test_shipped_scenes(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob(scenes, 0, NULL, &found), 0);
    for (size_t k = 0; k < found.gl_pathc; k++) {
        struct scene scene;
        pdyn_status status = scene_read(context, found.gl_pathv[k], NULL, NULL, 0, &scene);
        if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
        assert_true(scene.bodies > 0 && *scene.name);
        free_good(&scene);
    }
    globfree(&found);
}

static void test_bad_meshes(void **state) {
    (void)state;
    static const struct {
        const char *mesh, *error;
    } bad[] = {
        {"v 0 0 0\nv 1 0\n",
         "scene.json:2:24: bodies[0].surface.mesh: bad.obj:2: expected 3 coordinates after "
         "'v', found the end of the line"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n",
         "scene.json:2:24: bodies[0].surface.mesh: as placed: vertex 3 is used by no triangle"},
        {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
         "scene.json:2:24: bodies[0].surface.mesh: as placed: triangle 0 (vertices 0, 1, 2) "
         "has no area"},
        {"v 0 0 0\nv 1e12 0 0\nv 0 1e12 0\nf 1 2 3\n",
         "scene.json:2:24: bodies[0].surface.mesh: as placed: vertex 1: expected a finite x "
         "of at most 1e+12 m, found 1e+13"},
    };
    for (int k = 0; k < COUNT(bad); k++) {
        struct scene scene;
        write_file("bad.obj", bad[k].mesh);
        pdyn_status status = scene_read(
            context, "scene.json",
            quoted(BODY("{'surface': {'mesh': 'bad.obj', 'scale': 10, 'area_density': 1}}")), NULL,
            0, &scene);
        assert_failure(status, &scene, bad[k].error);
    }
    assert_int_equal(unlink("bad.obj"), 0);
}

static void test_out_of_memory(void **state) {
    (void)state;
    static const char *const set[] = {"duration=4", "bodies.sheet.surface.scale=2"};
    struct scene scene;
    pdyn_status status = PDYN_NO_MEMORY;
    int left = 0;
    write_file("wall.obj", wall);
    for (; status != PDYN_OK && left < 1000; left++) {
        allocations_left = left;
        status = scene_read(context, "scene.json", quoted(full), set, 2, &scene);
        allocations_left = -1;
        if (status == PDYN_OK) break;
        assert_int_equal(status, PDYN_NO_MEMORY);
        assert_int_equal(pdyn_bytes_in_use(context), 0);
        assert_true(!strncmp(pdyn_last_error(context), "out of memory", 13));
    }
    assert_int_equal(status, PDYN_OK);
    assert_true(left > 25);
    free_good(&scene);
    assert_int_equal(unlink("wall.obj"), 0);
}

static void test_locale(void **state) {
    (void)state;
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    int k = 0;
    while (k < COUNT(commas) && !setlocale(LC_ALL, commas[k])) k++;
    if (k == COUNT(commas)) skip();
    struct scene scene;
    read_good(TOP("'frame_interval': 0.25"), NULL, 0, &scene);
    assert_true(scene.settings.frame_interval == 0.25);
    free_good(&scene);
    pdyn_status status = scene_read(context, "scene.json",
                                    quoted(TOP("'solver': {'tolerance': -0.5}")), NULL, 0, &scene);
    setlocale(LC_ALL, "C");
    assert_failure(
        status, &scene,
        "scene.json:2:26: solver.tolerance: expected a number from 0 to 1000, found -0.5");
}

/* ---- words ---------------------------------------------------------------------------------- */

static void test_near_miss(void **state) {
    (void)state;
    static const char *const names[] = {"radius", "rest_density", "fill", "stretching_stiffness"};
    static const struct {
        const char *word, *nearest;
    } cases[] = {
        {"raduis", "radius"},
        {"Radius", "radius"},
        {"rest-density", "rest_density"},
        {"density", "rest_density"},
        {"stiffness", "stretching_stiffness"},
        {"fil", "fill"},
        {"xyz", NULL},
        {"", NULL},
        {"temperature", NULL},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        const char *found = registry_near_miss(cases[k].word, names, COUNT(names));
        if (!cases[k].nearest) assert_null(found);
        else assert_string_equal(found ? found : "", cases[k].nearest);
    }
    char long_word[200];
    memset(long_word, 'r', sizeof long_word - 1);
    long_word[sizeof long_word - 1] = '\0';
    assert_null(registry_near_miss(long_word, names, COUNT(names)));
    char clipped[8];
    text_clip(clipped, sizeof clipped, "abc\xc3\xa4\n123456");
    assert_string_equal(clipped, "abc...");
    text_clip(clipped, sizeof clipped, "a\tb");
    assert_string_equal(clipped, "a?b");
}

struct text {
    char data[16384];
    size_t length;
};
static void collect(void *user, const char *piece) {
    struct text *text = user;
    size_t length = strlen(piece);
    assert_true(text->length + length < sizeof text->data);
    memcpy(text->data + text->length, piece, length + 1);
    text->length += length;
}

static const char *described(const char *name) {
    static struct text text;
    text = (struct text){.data = ""};
    assert_int_equal(pdyn_describe(context, name, collect, &text), PDYN_OK);
    return text.data;
}

static void test_describe(void **state) {
    (void)state;
    const char *all = described(NULL);
    for (const pdyn_constraint_type *const *t = registry_constraints(); *t; t++)
        assert_non_null(strstr(all, (*t)->summary));
    assert_non_null(strstr(all, "cholesky"));
    const char *fluid = described("fluid");
    for (const pdyn_param *p = registry_constraint("fluid")->params; p->name; p++) {
        assert_non_null(strstr(fluid, p->name));
        assert_non_null(strstr(fluid, p->doc));
    }
    assert_non_null(strstr(described("spring"),
                           "stretching_stiffness   N/m    required   number from 0 to 1e+12"));
    assert_non_null(strstr(described("pin"), "choice of vertices"));
    assert_non_null(strstr(
        described("cg"), "outer_iterations              20         whole number from 1 to 100000"));
    assert_int_equal(pdyn_describe(context, "fluit", collect, NULL), PDYN_BAD_INPUT);
    assert_message(
        "no constraint and no solver \"fluit\"; did you mean \"fluid\"?; known: bending, *");
    assert_int_equal(pdyn_describe(NULL, NULL, collect, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_describe(context, NULL, NULL, NULL), PDYN_BAD_CALL);
}

/* ---- the schema ----------------------------------------------------------------------------- */

static const json_t *definition(const char *name) {
    const json_t *found = json_object_get(json_object_get(schema, "$defs"), name);
    if (!found) fail_msg("the schema has no $defs/%s", name);
    return found;
}

static void assert_number(const json_t *entry, const char *key, const char *name, double expected,
                          bool wanted) {
    const json_t *value = json_object_get(entry, key);
    if (!value != !wanted)
        fail_msg("schema: %s %s its %s", name, wanted ? "lacks" : "should not have", key);
    if (wanted && json_number_value(value) != expected)
        fail_msg("schema: %s of %s is %.17g, in the table %.17g", key, name,
                 json_number_value(value), expected);
}

static bool is_listed(const json_t *array, const char *word) {
    for (size_t k = 0; k < json_array_size(array); k++)
        if (!strcmp(json_string_value(json_array_get(array, k)), word)) return true;
    return false;
}

static void check_parameter(const json_t *object, const pdyn_param *p) {
    static const char *const types[] = {
        [PDYN_REAL] = "number", [PDYN_INT] = "integer", [PDYN_BOOL] = "boolean"};
    const json_t *entry = json_object_get(json_object_get(object, "properties"), p->name);
    if (!entry) fail_msg("the schema lacks %s", p->name);
    if (is_listed(json_object_get(object, "required"), p->name) != p->required)
        fail_msg("schema: %s is required in one of schema and table only", p->name);
    if (p->kind > PDYN_BOOL) {
        assert_non_null(json_object_get(entry, "$ref"));
        return;
    }
    bool has_default = !p->required && p->def >= p->min && p->def <= p->max;
    assert_string_equal(json_string_value(json_object_get(entry, "type")), types[p->kind]);
    assert_number(entry, "default", p->name, p->def, has_default);
    assert_number(entry, "minimum", p->name, p->min, isfinite(p->min));
    assert_number(entry, "maximum", p->name, p->max, isfinite(p->max));
    assert_non_null(json_object_get(entry, "description"));
}

/* As many keys as the table has, and `others` besides. */
static void check_table(const json_t *object, const pdyn_param *table, size_t others) {
    size_t count = others;
    for (const pdyn_param *p = table; p->name; p++, count++) check_parameter(object, p);
    assert_true(json_is_false(json_object_get(object, "additionalProperties")));
    assert_int_equal(json_object_size(json_object_get(object, "properties")), count);
}

static void test_schema(void **state) {
    (void)state;
    check_table(schema, settings_general_params, 8);
    check_table(definition("time_step"), settings_time_step_params, 0);
    check_table(definition("solver"), settings_solver_params, 2);
    check_table(definition("motion_key"), scene_key_params, 0);
    for (const pdyn_constraint_type *const *t = registry_constraints(); *t; t++) {
        char name[64];
        snprintf(name, sizeof name, "constraint_%s", (*t)->name);
        check_table(definition(name), (*t)->params, 1);
    }
    check_table(definition("inlet_rectangle"), inlet_params, 2);
    check_table(definition("inlet_disc"), inlet_params, 2);
    check_table(definition("outlet"), outlet_params, 1);
    static const char *const fills[] = {"fill_box", "fill_sphere", "fill_mesh", "fill_file"};
    for (int k = 0; k < COUNT(fills); k++) {
        const json_t *fill = definition(fills[k]);
        assert_true(json_is_false(json_object_get(fill, "additionalProperties")));
        assert_true(is_listed(json_object_get(fill, "required"), fills[k] + strlen("fill_")));
        assert_int_equal(json_object_size(json_object_get(fill, "properties")), k < 2 ? 2 : 5);
    }
    const json_t *solver = json_object_get(definition("solver"), "properties");
    const json_t *types = json_object_get(json_object_get(solver, "type"), "enum");
    size_t count = 1;
    assert_true(is_listed(types, "auto"));
    for (const struct solver_type *const *t = registry_solvers(); *t; t++, count++)
        if (!is_listed(types, (*t)->name)) fail_msg("the schema lacks the solver %s", (*t)->name);
    assert_int_equal(json_array_size(types), count);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_scenes),     cmocka_unit_test(test_deep_nesting),
        cmocka_unit_test(test_bad_overrides),  cmocka_unit_test(test_place_beside_overrides),
        cmocka_unit_test(test_good_overrides), cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_full_scene),     cmocka_unit_test(test_choices),
        cmocka_unit_test(test_transform),      cmocka_unit_test(test_files),
        cmocka_unit_test(test_shipped_scenes), cmocka_unit_test(test_bad_meshes),
        cmocka_unit_test(test_out_of_memory),  cmocka_unit_test(test_locale),
        cmocka_unit_test(test_near_miss),      cmocka_unit_test(test_describe),
        cmocka_unit_test(test_schema),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
