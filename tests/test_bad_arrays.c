/* Arrays and texts that a scene of a program refuses (projdyn/scene.h), each with its message. */
#include "scene_support.h"

#include "projdyn/scene.h"

static const double four[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const double infinite[12] = {0, 0, 0, 1, 0, 0, 0, (double)INFINITY, 0, 0, 0, 1};
static const double large[12] = {0, 0, 0, 1, 0, 0, 0, 0, -2e6, 0, 0, 1};

static const struct {
    int kind; /* corners of an element; 0: particles */
    const char *file;
    int points, elements;
    const double *x, *v;
    int corner[4];
    const char *error;
} bad_arrays[] = {
    {3,
     "a.msh",
     4,
     1,
     four,
     NULL,
     {0, 1, 2},
     "a.msh: expected a name without '/', of at most 255 "
     "bytes, that ends with .ply"},
    {4,
     "a.ply",
     4,
     1,
     four,
     NULL,
     {0, 1, 2, 3},
     "a.ply: expected a name without '/', of at most 255 bytes, that ends with .msh"},
    {0, "b/a.ply", 4, 0, four, NULL, {0}, "b/a.ply: expected a name without '/'*"},
    {0, ".ply", 4, 0, four, NULL, {0}, ".ply: expected a name without '/'*"},
    {0,
     "a.ply",
     0,
     0,
     four,
     NULL,
     {0},
     "a.ply: number of points: expected 1 to 268435455, found 0"},
    {0, "a.ply", -1, 0, four, NULL, {0}, "a.ply: number of points: expected 1 to *"},
    {0, "a.ply", INT32_MAX, 0, four, NULL, {0}, "a.ply: number of points: expected 1 to *"},
    {3, "a.ply", 4, 0, four, NULL, {0}, "a.ply: number of elements: expected 1 to *"},
    {3,
     "a.ply",
     4,
     1,
     infinite,
     NULL,
     {0, 1, 2},
     "a.ply: vertex 2: expected a finite y of at most 1e+12 m, found inf"},
    {0,
     "a.ply",
     4,
     0,
     four,
     large,
     {0},
     "a.ply: particle 2: expected a finite vz of at most 1e+06 m/s, found -2e+06"},
    {3, "a.ply", 4, 1, four, NULL, {0, 1, 4}, "a.ply: triangle 0 uses vertex 4, expected 0 to 3"},
    {4,
     "a.msh",
     4,
     1,
     four,
     NULL,
     {0, -1, 2, 3},
     "a.msh: tetrahedron 0 uses vertex -1, expected 0 to 3"},
    {4, "a.msh", 4, 1, four, NULL, {0, 1, 2, 0}, "a.msh: tetrahedron 0 uses vertex 0 twice"},
};

static void test_bad_arrays(void **state) {
    (void)state;
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_create(context, "memory", &scene), PDYN_OK);
    size_t bytes = pdyn_bytes_in_use(context);
    for (int k = 0; k < COUNT(bad_arrays); k++) {
        const char *file = bad_arrays[k].file;
        int points = bad_arrays[k].points, elements = bad_arrays[k].elements;
        const double *x = bad_arrays[k].x;
        pdyn_status status =
            bad_arrays[k].kind == 0 ? pdyn_scene_particles(scene, file, points, x, bad_arrays[k].v)
            : bad_arrays[k].kind == 3
                ? pdyn_scene_mesh(scene, file, points, x, elements, bad_arrays[k].corner)
                : pdyn_scene_tets(scene, file, points, x, elements, bad_arrays[k].corner);
        assert_int_equal(status, PDYN_BAD_INPUT);
        assert_message(bad_arrays[k].error);
        assert_int_equal(pdyn_bytes_in_use(context), bytes);
    }
    pdyn_scene_free(scene);
}

static void test_bad_texts(void **state) {
    (void)state;
    pdyn_scene *scene = NULL;
    assert_int_equal(pdyn_scene_parse(context, "[]", "text", &scene), PDYN_BAD_INPUT);
    assert_message("text:1:1: expected an object, found an array of 0");
    assert_int_equal(pdyn_scene_parse(context, "{,", "text", &scene), PDYN_BAD_INPUT);
    assert_message("text:1:2: not valid JSON: *");
    assert_int_equal(pdyn_scene_open(context, "none.json", &scene), PDYN_IO_FAILED);
    assert_message("none.json: cannot open the file: No such file or directory");
    assert_null(scene);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_arrays),
        cmocka_unit_test(test_bad_texts),
    };
    return cmocka_run_group_tests_name("bad_arrays", tests, scene_set_up, scene_tear_down);
}
