/* Scenes made by a program (projdyn/scene.h): values, arrays, loading, writing, messages.
 * test_bad_arrays.c has arrays that are refused. */
#include "geometry/mesh.h"
#include "geometry/sampling.h"
#include "geometry/tets.h"
#include "scene/scene_file.h"
#include "scene_support.h"

#include <errno.h>
#include <jansson.h>
#include <locale.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { STEPS = 5 };

/* ---- a scene with a surface, a soft solid and particles -------------------------------------- */

#define SETTINGS                                                                                   \
    "'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005},"                      \
    " 'contact': {'thickness': 0.01},"                                                             \
    " 'solids': [{'name': 'tank', 'box': {'minimum': [-0.3, -0.3, -0.3],"                          \
    " 'maximum': [0.3, 0.5, 0.3]}}],"
static const char grids[] =
    "{" SETTINGS " 'bodies': ["
    "{'name': 'water', 'particles': {'radius': 0.02, 'fill': [{'box': {'minimum': "
    "[-0.08, 0.08, -0.08], 'maximum': [0.08, 0.16, 0.08]}, 'velocity': [0, -1, 0]}]},"
    " 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]},"
    "{'name': 'sheet', 'surface': {'grid': {'size': [0.4, 0.3], 'vertices': [9, 7], 'sag': 0.03},"
    " 'rotate': [0, 20, 0], 'translate': [0, 0.05, 0], 'area_density': 0.5},"
    " 'constraints': [{'type': 'spring', 'stretching_stiffness': 1000},"
    " {'type': 'pin', 'vertices': {'border': true}}]},"
    "{'name': 'block', 'volume': {'grid': {'size': [0.1, 0.1, 0.1], 'cells': [3, 2, 2]},"
    " 'translate': [0, -0.2, 0], 'density': 500},"
    " 'constraints': [{'type': 'tet', 'stiffness': 2e4}]}]}";

static void set(pdyn_scene *scene, const char *path, const char *value) {
    if (pdyn_scene_set(scene, path, "%s", quoted(value)) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(context));
}

static const double water_velocity[3] = {0.0, -1.0, 0.0};

/* Adds the arrays from which the keys "grid" and "box" of `grids` are made. */
static pdyn_status add_arrays(pdyn_scene *scene) {
    struct mesh sheet = {0}, block = {0};
    struct tets tets = {0};
    struct point_list water = {0};
    const struct box box = {{-0.08, 0.08, -0.08}, {0.08, 0.16, 0.08}};
    double v[3 * 64] = {0};
    pdyn_status status =
        mesh_grid(context, (const double[]){0.4, 0.3}, (const int[]){9, 7}, 0.03, &sheet);
    if (status == PDYN_OK)
        status = tets_grid(context, (const double[]){0.1, 0.1, 0.1}, (const int[]){3, 2, 2}, &block,
                           &tets);
    if (status == PDYN_OK) status = sample_box_volume(context, &box, 0.02, &water);
    assert_true(water.count <= COUNT(v) / 3);
    for (int i = 0; i < water.count; i++) memcpy(v + 3 * i, water_velocity, sizeof water_velocity);
    if (status == PDYN_OK)
        status = pdyn_scene_mesh(scene, "sheet.ply", sheet.vertices, sheet.vertex, sheet.triangles,
                                 sheet.triangle);
    if (status == PDYN_OK)
        status = pdyn_scene_tets(scene, "block.msh", block.vertices, block.vertex, tets.count,
                                 tets.corner);
    if (status == PDYN_OK)
        status = pdyn_scene_particles(scene, "water.ply", water.count, water.x, v);
    point_list_free(context, &water);
    tets_free(context, &tets);
    mesh_free(context, &block);
    mesh_free(context, &sheet);
    return status;
}

static const struct {
    const char *path, *value;
} values[] = {
    {"duration", "1"},
    {"frame_interval", "0.01"},
    {"time_step.maximum", "0.005"},
    {"contact.thickness", "0.01"},
    {"solids.tank.box", "{'minimum': [-0.3, -0.3, -0.3], 'maximum': [0.3, 0.5, 0.3]}"},
    {"bodies.water.particles.radius", "0.02"},
    {"bodies.water.particles.fill.0.file", "water.ply"},
    {"bodies.water.constraints.fluid.stiffness", "1e5"},
    {"bodies.sheet.surface.mesh", "sheet.ply"},
    {"bodies.sheet.surface.rotate", "[0, 20, 0]"},
    {"bodies.sheet.surface.translate", "[0, 0.05, 0]"},
    {"bodies.sheet.surface.area_density", "0.5"},
    {"bodies.sheet.constraints.spring.stretching_stiffness", "1000"},
    {"bodies.sheet.constraints.pin.vertices.border", "true"},
    {"bodies.block.volume.mesh", "block.msh"},
    {"bodies.block.volume.translate", "[0, -0.2, 0]"},
    {"bodies.block.volume.density", "500"},
    {"bodies.block.constraints.tet", "{'stiffness': 2e4}"},
};

/* The scene `grids`, from values and arrays. */
static pdyn_status make(pdyn_scene **out) {
    pdyn_status status = pdyn_scene_create(context, "memory", out);
    for (int k = 0; k < COUNT(values) && status == PDYN_OK; k++)
        status = pdyn_scene_set(*out, values[k].path, "%s", quoted(values[k].value));
    return status == PDYN_OK ? add_arrays(*out) : status;
}

static pdyn_scene *make_good(void) {
    pdyn_scene *scene = NULL;
    if (make(&scene) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    return scene;
}

static pdyn_sim *load_good(pdyn_scene *scene) {
    pdyn_sim *sim = NULL;
    if (pdyn_scene_load(scene, &sim) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    return sim;
}

/* Takes STEPS steps and frees the simulation. */
static uint64_t hash_of(pdyn_sim *sim) {
    for (int k = 0; k < STEPS; k++) test_step(sim);
    uint64_t hash = pdyn_state_hash(sim);
    pdyn_free(sim);
    return hash;
}

static pdyn_sim *load_file(const char *path) {
    pdyn_sim *sim = NULL;
    if (pdyn_load(context, path, NULL, 0, &sim) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(context));
    return sim;
}

static void remove_written(void) {
    static const char *const files[] = {"written/scene.json", "written/sheet.ply",
                                        "written/block.msh", "written/water.ply"};
    for (int k = 0; k < COUNT(files); k++) test_remove_file(files[k]);
    assert_int_equal(rmdir("written"), 0);
}

static void test_same_bits(void **state) {
    (void)state;
    pdyn_scene *scene = make_good();
    uint64_t expected = hash_of(test_load(context, grids));
    assert_true(hash_of(load_good(scene)) == expected);
    assert_true(hash_of(load_good(scene)) == expected);
    assert_int_equal(mkdir("written", 0700), 0);
    assert_int_equal(pdyn_scene_write(scene, "written/scene.json"), PDYN_OK);
    assert_true(hash_of(load_file("written/scene.json")) == expected);
    pdyn_scene_free(scene);
    remove_written();
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

/* Numbers without a short decimal form, and a saved state of the scene in memory. */
static void test_written_numbers(void **state) {
    (void)state;
    pdyn_scene *scene = make_good();
    double x[6] = {5e-324, 0.1 + 0.05, -1.0 / 30.0, 1.0 / 15.0, 0.17, 1e-3 / 7.0};
    assert_int_equal(pdyn_scene_particles(scene, "water.ply", 2, x, NULL), PDYN_OK);
    assert_int_equal(pdyn_scene_set(scene, "duration", "%.17g", 1.0 / 3.0), PDYN_OK);
    assert_int_equal(pdyn_scene_set(scene, "bodies.sheet.surface.area_density", "%.17g", 0.1 + 0.2),
                     PDYN_OK);
    assert_int_equal(mkdir("written", 0700), 0);
    assert_int_equal(pdyn_scene_write(scene, "written/scene.json"), PDYN_OK);
    pdyn_sim *first = load_good(scene), *second = load_file("written/scene.json");
    assert_true(pdyn_duration(second) == 1.0 / 3.0);
    assert_memory_equal(pdyn_get_body(second, 0).rest, x, sizeof x);
    test_step(first);
    assert_int_equal(pdyn_save(first, "saved"), PDYN_OK);
    assert_int_equal(pdyn_restore(second, "saved"), PDYN_OK);
    assert_true(hash_of(first) == hash_of(second));
    test_remove_file("saved");
    pdyn_scene_free(scene);
    remove_written();
}

/* A surface is a file of particles, too, as its PLY file is. */
static void test_particles_of_surface(void **state) {
    (void)state;
    static const double x[9] = {0, 0, 0, 0.1, 0, 0, 0, 0, 0.1};
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_parse(context,
                                      quoted(BODY("{'particles': {'radius': 0.02, 'fill': "
                                                  "[{'file': 'a.ply'}]}}")),
                                      "text", &scene),
                     PDYN_OK);
    assert_int_equal(pdyn_scene_mesh(scene, "a.ply", 3, x, 1, (const int[]){0, 1, 2}), PDYN_OK);
    pdyn_sim *sim = load_good(scene);
    assert_memory_equal(pdyn_get_state(sim).x, x, sizeof x);
    pdyn_free(sim);
    pdyn_scene_free(scene);
}

/* ---- values ---------------------------------------------------------------------------------- */

static void copy_text(void *user, const char *text) { strcpy(user, text); }

static void assert_values(pdyn_scene *scene, const char *expected) {
    char text[4096];
    assert_int_equal(pdyn_scene_text(scene, copy_text, text), PDYN_OK);
    json_t *found = json_loads(text, 0, NULL), *wanted = json_loads(quoted(expected), 0, NULL);
    if (!wanted || !json_equal(found, wanted)) fail_msg("%s, expected %s", text, expected);
    json_decref(found), json_decref(wanted);
}

static const struct {
    const char *path, *value, *all;
} set_values[] = {
    {"name", "x y", "{'name': 'x y'}"},
    {"name", "{broken", "{'name': '{broken'}"},
    {"name", "", "{'name': ''}"},
    {"time_step.fixed", "0.5", "{'time_step': {'fixed': 0.5}}"},
    {"bodies", "[]", "{'bodies': []}"},
    {"bodies.a.velocity.0", "1", "{'bodies': [{'name': 'a', 'velocity': [1]}]}"},
    {"bodies.a", "{'velocity': 1}", "{'bodies': [{'name': 'a', 'velocity': 1}]}"},
    {"bodies.a", "5", "{'bodies': [5]}"},
    {"bodies.0.velocity", "1", "{'bodies': [{'velocity': 1}]}"},
    {"bodies.a.constraints.pin.stiffness", "1",
     "{'bodies': [{'name': 'a', 'constraints': [{'type': 'pin', 'stiffness': 1}]}]}"},
    {"solids.0.motion.0.time", "0", "{'solids': [{'motion': [{'time': 0}]}]}"},
};

static void test_values(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(set_values); k++) {
        pdyn_scene *scene = NULL;
        assert_int_equal(pdyn_scene_create(context, "memory", &scene), PDYN_OK);
        set(scene, set_values[k].path, set_values[k].value);
        assert_values(scene, set_values[k].all);
        pdyn_scene_free(scene);
    }
}

/* Values of a scene that has some; each is set after those before it. */
static void test_later_values(void **state) {
    (void)state;
    pdyn_scene *scene = NULL;
    assert_int_equal(
        pdyn_scene_parse(context, quoted("{'bodies': [{'name': 'a'}]}"), "text", &scene), PDYN_OK);
    set(scene, "bodies.a.velocity", "[1, 2]");
    set(scene, "bodies.b.velocity.0", "3");
    set(scene, "bodies.a.velocity.2", "4");
    set(scene, "bodies.0.velocity.0", "5");
    set(scene, "bodies.2", "6");
    set(scene, "bodies.b", "{'name': 'c'}");
    assert_values(scene, "{'bodies': [{'name': 'a', 'velocity': [5, 2, 4]}, {'name': 'c'}, 6]}");
    pdyn_scene_free(scene);
}

static void test_digits(void **state) {
    (void)state;
    char text[256];
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_create(context, "memory", &scene), PDYN_OK);
    set(scene, "duration", "0.1");
    assert_int_equal(pdyn_scene_text(scene, copy_text, text), PDYN_OK);
    assert_string_equal(text, "{\n  \"duration\": 0.1\n}");
    assert_int_equal(pdyn_scene_set(scene, "duration", "%.17g", 0.1 + 0.2), PDYN_OK);
    assert_int_equal(pdyn_scene_set(scene, "gravity.0", "%.17g", 1.7976931348623157e308), PDYN_OK);
    assert_values(scene, "{'duration': 0.30000000000000004, 'gravity': [1.7976931348623157e308]}");
    pdyn_scene_free(scene);
}

static void test_locale(void **state) {
    (void)state;
    static const char *const commas[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE.utf8"};
    int k = 0;
    while (k < COUNT(commas) && !setlocale(LC_ALL, commas[k])) k++;
    if (k == COUNT(commas)) skip();
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_create(context, "memory", &scene), PDYN_OK);
    pdyn_status status = pdyn_scene_set(scene, "duration", "%g", 0.25);
    char text[64];
    assert_int_equal(pdyn_scene_text(scene, copy_text, text), PDYN_OK);
    setlocale(LC_ALL, "C");
    assert_int_equal(status, PDYN_OK);
    assert_string_equal(text, "{\n  \"duration\": 0.25\n}");
    pdyn_scene_free(scene);
}

/* ---- errors ---------------------------------------------------------------------------------- */

static const char base[] = "{'name': 'n', 'gravity': [0, 1], 'bodies': [{'name': 'sheet'}]}";

static const struct {
    const char *path, *error;
} bad_paths[] = {
    {"", "memory: : expected a path of keys, found an empty key"},
    {"solver..type", "memory: solver..type: expected a path of keys, found an empty key"},
    {"a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a",
     "memory: a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a: expected a path "
     "of "
     "keys, found more than 32 keys"},
    {"\xff", "memory: \xff: expected a path in UTF-8"},
    {"name.first",
     "memory: name.first: \"first\" is a key of a value that is neither an object nor "
     "an array"},
    {"bodies.sheet.name.0.x", "memory: bodies.sheet.name.0.x: \"0\" is a key of a value that is "
                              "neither an object nor an array"},
    {"gravity.3", "memory: gravity.3: no element \"3\"; known: 0, 1"},
    {"gravity.y", "memory: gravity.y: no element \"y\"; known: 0, 1"},
    {"bodies.2.name", "memory: bodies.2.name: no element \"2\"; known: 0 (sheet)"},
    {"bodies.sheet.constraints.1.type",
     "memory: bodies.sheet.constraints.1.type: no element \"1\"; "
     "the array is empty"},
};

static void test_bad_paths(void **state) {
    (void)state;
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_parse(context, quoted(base), "memory", &scene), PDYN_OK);
    for (int k = 0; k < COUNT(bad_paths); k++) {
        assert_int_equal(pdyn_scene_set(scene, bad_paths[k].path, "1"), PDYN_BAD_INPUT);
        assert_message(bad_paths[k].error);
        assert_values(scene, base);
    }
    assert_int_equal(pdyn_scene_set(scene, "bodies.sheet.nam", "null"), PDYN_BAD_INPUT);
    assert_message("memory: bodies.sheet.nam: no key \"nam\" to remove; did you mean \"name\"?*");
    assert_values(scene, base);
    assert_int_equal(pdyn_scene_set(scene, "name", "\xff"), PDYN_BAD_INPUT);
    assert_message("memory: name: expected a value in UTF-8");
    assert_values(scene, base);
    pdyn_scene_free(scene);
}

/* A name that does not exist makes an element in pdyn_scene_set only. */
static void test_override(void **state) {
    (void)state;
    static const char *const typo[] = {"bodies.shet.velocity=[0, 0, 1]"};
    static const char error[] = "--set bodies.shet.velocity=[0, 0, 1]: no element \"shet\"; did "
                                "you mean \"sheet\"?; known: 0 (sheet)";
    pdyn_scene *scene = NULL;
    pdyn_sim *sim = NULL;
    assert_int_equal(pdyn_scene_parse(context, quoted(base), "memory", &scene), PDYN_OK);
    assert_int_equal(pdyn_scene_override(scene, typo, 1), PDYN_BAD_INPUT);
    assert_message(error);
    assert_values(scene, base);
    pdyn_scene_free(scene);
    assert_int_equal(pdyn_load_text(context, quoted(base), "memory", typo, 1, &sim),
                     PDYN_BAD_INPUT);
    assert_message(error);
    assert_null(sim);
}

static void assert_not_loaded(pdyn_scene *scene, pdyn_status expected, const char *error) {
    pdyn_sim *sim = NULL;
    assert_int_equal(pdyn_scene_load(scene, &sim), expected);
    assert_null(sim);
    assert_message(error);
}

static const struct {
    const char *path, *value, *error;
} bad_values[] = {
    {"duration", "soon", "memory: duration: expected a number from 1e-06 to 1000000 s, found *"},
    {"duration", "-1", "memory: duration: expected a number from 1e-06 to 1000000 s, found -1"},
    {"bodies.sheet.surface.area_density", "0",
     "memory: bodies[1].surface.area_density: expected a number from 1e-06 to 1000000 kg/m^2, "
     "found "
     "0"},
    {"durration", "1", "memory: unknown key \"durration\"; did you mean \"duration\"?*"},
    {"bodies.shet.velocity", "[0, 0, 1]",
     "memory: bodies[3]: expected exactly one of \"particles\", \"surface\", \"volume\" and "
     "\"rigid\", found "
     "none"},
    {"bodies.sheet.surface.mesh", "other.ply",
     "memory: bodies[1].surface.mesh: other.ply: cannot open the file: No such file or directory"},
    {"bodies.sheet.surface.mesh", "water.ply",
     "memory: bodies[1].surface.mesh: water.ply: expected arrays of pdyn_scene_mesh, found those "
     "of "
     "pdyn_scene_particles"},
    {"bodies.block.volume.mesh", "sheet.ply",
     "memory: bodies[2].volume.mesh: sheet.ply: expected arrays of pdyn_scene_tets, found those of "
     "pdyn_scene_mesh"},
    {"bodies.water.particles.fill.0.file", "block.msh",
     "memory: bodies[0].particles.fill[0].file: block.msh: expected arrays of "
     "pdyn_scene_particles, found those of pdyn_scene_tets"},
};

static void test_bad_values(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(bad_values); k++) {
        pdyn_scene *scene = make_good();
        set(scene, bad_values[k].path, bad_values[k].value);
        bool missing = strstr(bad_values[k].error, "cannot open");
        assert_not_loaded(scene, missing ? PDYN_IO_FAILED : PDYN_BAD_INPUT, bad_values[k].error);
        pdyn_scene_free(scene);
    }
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

/* A message has line and column of a value of the text, the override, or neither. */
static void test_places(void **state) {
    (void)state;
    static const char *const override[] = {"duration=-2"};
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_parse(context, quoted("{'duration': -1,\n 'bodies': [" WATER "]}"),
                                      "text", &scene),
                     PDYN_OK);
#define DURATION "duration: expected a number from 1e-06 to 1000000 s, found "
    assert_not_loaded(scene, PDYN_BAD_INPUT, "text:1:14: " DURATION "-1");
    assert_int_equal(pdyn_scene_override(scene, override, 1), PDYN_OK);
    assert_not_loaded(scene, PDYN_BAD_INPUT, "--set duration=-2: " DURATION "-2");
    set(scene, "duration", "-3");
    assert_not_loaded(scene, PDYN_BAD_INPUT, "text: " DURATION "-3");
    set(scene, "duration", "1");
    set(scene, "bodies.sheet.velocity", "[0, 0, 1]");
    assert_not_loaded(scene, PDYN_BAD_INPUT, "text: bodies[1]: expected exactly one of *");
    set(scene, "bodies.1", WATER);
    set(scene, "bodies.0.particles.budget", "5");
    assert_not_loaded(scene, PDYN_BAD_INPUT, "text: bodies[0].particles: \"budget\" needs *");
    pdyn_scene_free(scene);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

static void test_bad_writes(void **state) {
    (void)state;
    pdyn_scene *scene = make_good();
    assert_int_equal(pdyn_scene_write(scene, "none/scene.json"), PDYN_IO_FAILED);
    assert_message("none/*");
    assert_int_equal(pdyn_scene_write(scene, "./sheet.ply"), PDYN_BAD_INPUT);
    assert_message("./sheet.ply: expected another name than that of the scene's arrays");
    pdyn_scene_free(scene);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static pdyn_status make_read_and_write(const void *what) {
    static const char *const duration[] = {"duration=0.5"};
    pdyn_scene *file = NULL;
    struct scene scene = {0};
    (void)what;
    pdyn_status status = make(&file);
    if (status == PDYN_OK) status = pdyn_scene_override(file, duration, 1);
    if (status == PDYN_OK) status = pdyn_scene_write(file, "written/scene.json");
    if (status == PDYN_OK) status = scene_read(&file->json, &scene);
    scene_free(context, &scene);
    pdyn_scene_free(file);
    return status;
}

static void test_out_of_memory(void **state) {
    (void)state;
    assert_int_equal(mkdir("written", 0700), 0);
    long needed = test_failing_allocations(context, &counter, make_read_and_write, NULL);
    assert_true(needed > 100);
    remove_written();
}

static long json_left; /* number of allocations of jansson before one that fails */

static void *json_allocate(size_t size) {
    if (json_left-- != 0) return malloc(size);
    errno = ENOMEM;
    return NULL;
}

static char text_before[4096];

/* A failed pdyn_scene_set has no effect. */
static void test_json_out_of_memory(void **state) {
    (void)state;
    static const char *const path[] = {"duration", "bodies.b.constraints.pin.stiffness",
                                       "bodies.a.velocity.3"};
    pdyn_scene *scene = NULL;
    char text[4096];
    for (int k = 0; k < COUNT(path); k++) {
        pdyn_status status = PDYN_NO_MEMORY;
        assert_int_equal(
            pdyn_scene_parse(context, quoted("{'bodies': [{'name': 'a', 'velocity': [1, 2, 3]}]}"),
                             "text", &scene),
            PDYN_OK);
        assert_int_equal(pdyn_scene_text(scene, copy_text, text_before), PDYN_OK);
        for (long left = 0; status != PDYN_OK; left++) {
            assert_int_equal(pdyn_scene_text(scene, copy_text, text), PDYN_OK);
            assert_string_equal(text, text_before);
            json_set_alloc_funcs(json_allocate, free);
            json_left = left;
            status = pdyn_scene_set(scene, path[k], "[1, 2]");
            assert_true((status != PDYN_OK) == (json_left < 0));
            if (status != PDYN_OK) assert_int_equal(status, PDYN_NO_MEMORY);
            json_set_alloc_funcs(malloc, free);
        }
        pdyn_scene_free(scene);
    }
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_written_numbers),
        cmocka_unit_test(test_particles_of_surface),
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_later_values),
        cmocka_unit_test(test_digits),
        cmocka_unit_test(test_locale),
        cmocka_unit_test(test_bad_paths),
        cmocka_unit_test(test_override),
        cmocka_unit_test(test_bad_values),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_bad_writes),
        cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_json_out_of_memory),
    };
    return cmocka_run_group_tests_name("scene_memory", tests, scene_set_up, scene_tear_down);
}
