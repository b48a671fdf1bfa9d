/* Good scenes with all that comes of them: defaults, overrides, choices, files; and allocation
 * failure. */
#include "base/registry.h"
#include "base/text.h"
#include "scene_support.h"

#include <glob.h>
#include <locale.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define assert_close(a, b) assert_true(fabs((a) - (b)) <= 1e-12)

static char shipped[1024]; /* the pattern of the scenes that come with projdyn */

static int set_up(void **state) {
    const char *root = getenv("PROJDYN_SOURCE_ROOT");
    char *absolute = realpath(root ? root : ".", NULL);
    if (!absolute) return -1;
    snprintf(shipped, sizeof shipped, "%s/scenes/*.json", absolute);
    free(absolute);
    return scene_set_up(state);
}

/* ---- what is read ---------------------------------------------------------------------------- */

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
    assert_int_equal(s->outer_iterations, 100);
    assert_int_equal(s->linear_iterations, 500);
    assert_string_equal(s->solver_type, "auto");
    assert_int_equal(scene.bodies, 2);
    assert_int_equal(scene.solids, 0);
    assert_string_equal(scene.body[0].name, "body0");
    assert_string_equal(scene.body[1].name, "body1");
    assert_false(scene.body[0].has_mesh);
    assert_true(scene.body[0].rest_density == 1000.0 && scene.body[0].radius == 0.1);
    assert_int_equal(scene.body[0].constraints, 0);
    assert_true(scene.body[1].has_mesh && scene.body[1].area_density == 1.0);
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

static double stiffness_of(const struct scene *scene, int body) {
    return *(const double *)scene->body[body].constraint[0].params;
}

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
    assert_ptr_equal(water->constraint[0].type, registry_constraint(context, "fluid"));
    assert_true(sheet->has_mesh && sheet->area_density == 0.3);
    assert_int_equal(sheet->mesh.vertices, 15);
    assert_int_equal(sheet->constraints, 3);
    assert_ptr_equal(sheet->constraint[2].type, registry_constraint(context, "pin"));
    assert_true(stiffness_of(scene, 1) == 1000.0);
    assert_int_equal(scene->solids, 3);
    assert_true(scene->solid[0].kind == SOLID_BOX && scene->solid[0].box.max[1] == 2.0);
    assert_int_equal(scene->solid[0].open, 1 << 3 | 1 << 4);
    assert_string_equal(scene->solid[1].name, "solid1");
    assert_int_equal(scene->solid[1].mesh.triangles, 1);
    assert_true(scene->solid[1].mesh.vertex[7] == -2.0);
    const struct scene_key *key = scene->solid[0].motion.key;
    assert_int_equal(scene->solid[0].motion.keys, 2);
    assert_true(key[1].time == 2.0 && key[1].translate[0] == 1.0 && key[1].rotate[1] == 720.0);
    assert_true(key[0].translate[0] == 0.0 && key[0].rotate[1] == 0.0);
    assert_true(scene->solid[0].motion.pivot[0] == 0.5 && scene->solid[0].motion.pivot[1] == 1.0);
    assert_true(scene->solid[1].motion.pivot[2] == 5.0 && scene->solid[2].motion.pivot[2] == 6.0);
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
    test_write_text("wall.obj", wall);
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
    test_remove_file("wall.obj");
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
    test_write_text("wall.obj", wall);
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
    test_remove_file("wall.obj");
}

/* ---- overrides ------------------------------------------------------------------------------- */

static void test_good_overrides(void **state) {
    (void)state;
    struct scene scene;
    static const char *const set[] = {
        "bodies.sheet.constraints.spring.stretching_stiffness=2000",
        "bodies[1].velocity=[0, 0, 1]",
        "solver.type=hybrid",
        "solver.step=projective",
        "time_step={\"fixed\": 0.25}",
        "bodies.water.particles.fill.0.box.maximum[1]=3",
        "name=a=b",
        "duration=5",
        "duration=6",
        "gravity.1=-1",
        "contact={\"thickness\": 0.1}",
        "contact=null",
    };
    const char *text = BOTH;
    char with_gravity[4096];
    snprintf(with_gravity, sizeof with_gravity, "{'gravity': [0, 0, 0], %s", text + 1);
    read_good(with_gravity, set, COUNT(set), &scene);
    assert_true(stiffness_of(&scene, 1) == 2000.0);
    assert_true(scene.body[1].velocity[2] == 1.0);
    assert_string_equal(scene.settings.solver_type, "hybrid");
    assert_false(scene.settings.newton);
    assert_true(scene.settings.h_fixed == 0.25);
    assert_int_equal(scene.body[0].start.count, 5 * 15 * 5);
    assert_string_equal(scene.name, "a=b");
    assert_true(scene.settings.duration == 6.0);
    assert_true(scene.settings.gravity[1] == -1.0);
    assert_false(scene.has_contact);
    free_good(&scene);
}

/* ---- files ----------------------------------------------------------------------------------- */

static void test_files(void **state) {
    (void)state;
    struct scene scene;
    char folder[512], absolute[1024];
    assert_int_equal(mkdir("folder", 0700), 0);
    test_write_text("folder/wall.obj", wall);
    test_write_text("folder/scene.json", quoted(TOP("'solids': [{'mesh': 'wall.obj'}]")));
    assert_int_equal(read_scene("folder/scene.json", NULL, NULL, 0, &scene), PDYN_OK);
    assert_string_equal(scene.file, "folder/scene.json");
    assert_int_equal(scene.solid[0].mesh.vertices, 3);
    free_good(&scene);
    snprintf(absolute, sizeof absolute, "solids.0.mesh=%s/folder/wall.obj",
             getcwd(folder, sizeof folder));
    const char *const set[] = {absolute};
    assert_int_equal(read_scene("folder/scene.json", NULL, set, 1, &scene), PDYN_OK);
    free_good(&scene);
    /* a text has no folder, whatever its name */
    pdyn_status status = read_scene(
        "folder/scene.json", quoted(TOP("'solids': [{'mesh': 'wall.obj'}]")), NULL, 0, &scene);
    assert_int_equal(status, PDYN_IO_FAILED);
    assert_message("folder/scene.json:2:22: solids[0].mesh: wall.obj: cannot open the file: "
                   "No such file or directory");
    assert_int_equal(read_scene("folder", NULL, NULL, 0, &scene), PDYN_IO_FAILED);
    assert_message("folder: expected a regular file, found a folder");
    assert_int_equal(read_scene("none.json", NULL, NULL, 0, &scene), PDYN_IO_FAILED);
    assert_message("none.json: cannot open the file: No such file or directory");
    test_write_text("folder/scene.json", "{\n  \"duration\": 1,\n  \"bodies\": [\n");
    assert_failure(read_scene("folder/scene.json", NULL, NULL, 0, &scene), &scene,
                   "folder/scene.json:4:1: not valid JSON: *");
    test_write_text("folder/wall.OBJ", "v 0 0 0\n");
    assert_failure(read_scene("folder/wall.OBJ", NULL, NULL, 0, &scene), &scene,
                   "folder/wall.OBJ:1:1: not valid JSON: '[' or '{' expected near 'v'; a scene is "
                   "JSON and names mesh files by "
                   "the key \"mesh\"");
    test_remove_file("folder/wall.OBJ");
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    test_remove_file("folder/scene.json");
    test_remove_file("folder/wall.obj");
    assert_int_equal(rmdir("folder"), 0);
}

static void test_shipped_scenes(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob(shipped, 0, NULL, &found), 0);
    for (size_t k = 0; k < found.gl_pathc; k++) {
        struct scene scene;
        pdyn_status status = read_scene(found.gl_pathv[k], NULL, NULL, 0, &scene);
        if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
        assert_true(scene.bodies > 0 && *scene.name);
        free_good(&scene);
    }
    globfree(&found);
}

/* ---- surroundings ---------------------------------------------------------------------------- */

static pdyn_status read_full(const void *set) {
    struct scene scene;
    pdyn_status status = read_text(full, set, 2, &scene);
    scene_free(context, &scene);
    return status;
}

static void test_out_of_memory(void **state) {
    (void)state;
    static const char *const set[] = {"duration=4", "bodies.sheet.surface.scale=2"};
    test_write_text("wall.obj", wall);
    long needed = test_failing_allocations(context, &counter, read_full, set);
    assert_true(needed > 25 && needed < 1000);
    test_remove_file("wall.obj");
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
    pdyn_status status = read_text(TOP("'solver': {'tolerance': -0.5}"), NULL, 0, &scene);
    assert_failure(
        status, &scene,
        "scene.json:2:26: solver.tolerance: expected a number from 0 to 1000, found -0.5");
    set_error(PDYN_BAD_INPUT, "found %g s", 0.5); /* as in a step */
    char appended[16] = "";
    text_append(appended, sizeof appended, "%g s", 0.5);
    setlocale(LC_ALL, "C");
    assert_string_equal(pdyn_last_error(context), "found 0.5 s");
    assert_string_equal(appended, "0.5 s");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),       cmocka_unit_test(test_full_scene),
        cmocka_unit_test(test_choices),        cmocka_unit_test(test_transform),
        cmocka_unit_test(test_good_overrides), cmocka_unit_test(test_files),
        cmocka_unit_test(test_shipped_scenes), cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_locale),
    };
    return cmocka_run_group_tests_name("scene", tests, set_up, scene_tear_down);
}
