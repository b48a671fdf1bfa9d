/* Files of particles, also damaged ones. */
#include "output/output.h"
#include "scene_support.h"

#define PLY           "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
#define PLY_V         "property float vx\nproperty float vy\nproperty float vz\n"
#define VTK(format)   "# vtk DataFile Version 3.0\na title\n" format "\n"
#define VTK_5(format) "# vtk DataFile Version 5.1\na title\n" format "\n"
#define METADATA      "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 1 2\n\n"
#define BYTES_1       "\x3f\x80\0\0"
#define BYTES_2       "\x40\0\0\0"
#define ZERO          "\0\0\0\0"

/* Two particles at (1, 0, 0) and (0, 2, 0), with velocities (0, 0, 1) and (2, 0, 0) if fast. */
static const struct sample {
    const char *name, *data;
    size_t size;
    bool fast;
} samples[] = {
#define SAMPLE(name, text, fast)                                                                   \
    { name, text, sizeof(text) - 1, fast }
    SAMPLE("a.ply", PLY "property double z\nend_header\n1 0 0\n0 2 0\n", false),
    SAMPLE("a.ply", PLY "property float z\n" PLY_V "end_header\n1 0 0 0 0 1\n0 2 0 2 0 0\n", true),
    SAMPLE("a.ply",
           PLY "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
               "end_header\n1 0 0\n0 2 0\n3 7 8 9\n",
           false),
    SAMPLE("a.vtk",
           VTK("ASCII") "DATASET POLYDATA\nPOINTS 2 double\n1 0 0 0\n2 0\nVERTICES 2 4\n1 0\n1 1\n",
           false),
    SAMPLE("a.VTK",
           VTK("ASCII") "DATASET UNSTRUCTURED_GRID\nPOINTS 2 float\n1 0 0\n\n0 2 0\n"
                        "CELLS 2 4\n1 0\n1 1\nCELL_TYPES 2\n1\n1\nCELL_DATA 2\n"
                        "VECTORS velocity float\n9 9 9 9 9 9\nPOINT_DATA 2\n"
                        "SCALARS colour unsigned_char 3\nLOOKUP_TABLE default\n1 2 3 4 5 6\n"
                        "SCALARS density float\nLOOKUP_TABLE default\n1 2\n"
                        "NORMALS up float\n1 0 0 1 0 0\nVECTORS velocity double\n0 0 1 2 0 0\n",
           true),
    SAMPLE("a.vtk",
           VTK("ASCII") "DATASET POLYDATA\nPOINTS 2 float\n1 0 0 0 2 0\nPOINT_DATA 2\n"
                        "FIELD FieldData 2\nid 1 2 int\n5 6\nvelocity 3 2 float\n0 0 1 2 0 0",
           true),
    SAMPLE("a.vtk",
           VTK("BINARY") "DATASET POLYDATA\nPOINTS 2 float\n" BYTES_1 ZERO ZERO ZERO BYTES_2 ZERO
                         "\nVERTICES 1 3\n" ZERO ZERO ZERO "\nPOINT_DATA 2\n"
                         "SCALARS k char 1\nLOOKUP_TABLE default\n\n\n\nFIELD f 1\n"
                         "velocity 3 2 float\n" ZERO ZERO BYTES_1 BYTES_2 ZERO ZERO "\n",
           true),
    SAMPLE(
        "a.vtk",
        VTK_5("ASCII") "DATASET UNSTRUCTURED_GRID\nPOINTS 2 float\n1 0 0 0 2 0\n" METADATA
                       "CELLS 3 2\nOFFSETS vtktypeint64\n0 1 2\nCONNECTIVITY vtktypeint64\n0 1\n"
                       "CELL_TYPES 2\n1\n1\n\nPOINT_DATA 2\nFIELD FieldData 2\nk 1 2 double\n5 6\n"
                       "METADATA\nINFORMATION 0\n\nvelocity 3 2 double\n0 0 1 2 0 0\n"
                       "METADATA\nCOMPONENT_NAMES\nx\ny\nz\nINFORMATION 0\n\n",
        true),
    SAMPLE("a.vtk",
           VTK_5("BINARY") "DATASET POLYDATA\nPOINTS 2 float\n" BYTES_1 ZERO ZERO ZERO BYTES_2 ZERO
                           "\n" METADATA "VERTICES 2 2\nOFFSETS vtktypeint64\n" ZERO ZERO ZERO ZERO
                           "\nCONNECTIVITY vtktypeint64\n" ZERO ZERO ZERO ZERO "\nPOINT_DATA 2\n"
                           "VECTORS velocity float\n" ZERO ZERO BYTES_1 BYTES_2 ZERO ZERO
                           "\n" METADATA,
           true),
    SAMPLE("a.vtk",
           VTK("BINARY") "DATASET POLYDATA\nPOINTS 2 double\n\x3f\xf0\0\0" ZERO ZERO ZERO ZERO ZERO
               ZERO ZERO "\x40\0\0\0" ZERO ZERO ZERO,
           false),
};

static void test_files(void **state) {
    (void)state;
    const double x[] = {1, 0, 0, 0, 2, 0};
    struct scene scene;
    for (int k = 0; k < COUNT(samples); k++) {
        char fill[64];
        test_write_file(samples[k].name, samples[k].data, samples[k].size);
        snprintf(fill, sizeof fill, "{'file': '%s'}", samples[k].name);
        const struct scene_body *body = read_good_fill(0.1, fill, &scene);
        assert_int_equal(body->start.count, 2);
        assert_true(test_distance(body->start.x, x, 6) == 0.0);
        if (samples[k].fast) {
            assert_velocity(body, 0, 1, 0, 0, 1);
            assert_velocity(body, 1, 1, 2, 0, 0);
        } else assert_velocity(body, 0, 2, 1, 2, 3);
        free_good(&scene);
        test_remove_file(samples[k].name);
    }
}

/* scale, rotate and translate apply to positions, rotate alone to velocities. */
static void test_placed_file(void **state) {
    (void)state;
    struct scene scene;
    const double x[] = {10, 23, 30, 4, 20, 30};
    test_write_file(samples[1].name, samples[1].data, samples[1].size);
    const struct scene_body *body = read_good_fill(
        0.1, "{'file': 'a.ply', 'scale': 3, 'rotate': [0, 0, 90], 'translate': [10, 20, 30]}",
        &scene);
    assert_true(test_distance(body->start.x, x, 6) < 1e-12);
    assert_velocity(body, 0, 1, 0, 0, 1);
    assert_velocity(body, 1, 1, 0, 2, 0);
    free_good(&scene);
    body = read_good_fill(0.1, "{'file': 'a.ply', 'velocity': [5, 5, 5]}", &scene);
    assert_velocity(body, 0, 2, 5, 5, 5);
    free_good(&scene);
    test_remove_file("a.ply");
}

/* Particles of a file may be as close to a wall as water in motion comes, half a radius, but not
 * closer. */
static void test_close_to_wall(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'bodies': [{'particles': {'radius': 0.1, 'fill': [{'file': 'a.ply'}]}}], "
        "'solids': [{'plane': {'center': [0, %g, 0], 'normal': [0, 1, 0], 'size': 9}}]}";
    test_write_file(samples[1].name, samples[1].data, samples[1].size);
    for (int k = 0; k < 2; k++) {
        struct scene read;
        char text[512];
        snprintf(text, sizeof text, scene, k ? -0.04 : -0.06);
        pdyn_status status = read_text(text, NULL, 0, &read);
        assert_int_equal(status, k ? PDYN_BAD_INPUT : PDYN_OK);
        if (k) assert_error("1 of 2 particles overlap");
        if (!k) assert_int_equal(read.body[0].start.count, 2);
        if (!k) free_good(&read);
    }
    test_remove_file("a.ply");
}

/* An output file is a valid input. */
static void test_own_files(void **state) {
    (void)state;
    static const char *const names[] = {"own.vtk", "own.ply"};
    pdyn_sim *sim = test_load(
        context, "{\"duration\": 1, \"bodies\": [{\"velocity\": [0.25, 0, -2], \"particles\": "
                 "{\"radius\": 0.25, \"fill\": [{\"sphere\": {\"center\": [0, 1, 0], \"radius\": "
                 "2}}]}, \"constraints\": [{\"type\": \"fluid\"}]}]}");
    for (int k = 0; k < 2; k++) {
        struct particles read;
        pdyn_state now = pdyn_get_state(sim);
        pdyn_status status =
            k ? ply_write_body(sim, 0, names[k]) : vtk_write_body(sim, 0, names[k]);
        assert_int_equal(status, PDYN_OK);
        if (particles_read(context, names[k], &read) != PDYN_OK)
            fail_msg("%s", pdyn_last_error(context));
        assert_int_equal(read.count, now.particles);
        assert_true(test_distance(read.x, now.x, 3 * read.count) == 0.0);
        assert_true(test_distance(read.v, now.v, 3 * read.count) == 0.0);
        particles_free(context, &read);
        test_remove_file(names[k]);
    }
    pdyn_free(sim);
}

static const struct {
    const char *name, *data, *message;
} bad_files[] = {
    {"a.ply", PLY "end_header\n1 0\n0 2\n",
     "a.ply:7: expected property 'z' of element 'vertex' in the header"},
    {"a.ply", PLY "property float z\nproperty float vx\nend_header\n1 0 0 1\n0 2 0 1\n",
     "a.ply:9: expected all of 'vx', 'vy' and 'vz' or none of them"},
    {"a.ply", PLY "property float z\n" PLY_V "end_header\n1 0 0 0 nan 0\n0 2 0 1 1 1\n",
     "a.ply:11: velocity 0: expected a finite y of at most 1e+06 m/s, found nan"},
    {"a.ply",
     "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int y\nproperty int z\n"
     "end_header\n",
     "a.ply: the file has no particles"},
    {"a.vtk", "# vtk DataFile Version 6.0\nt\nASCII\n",
     "a.vtk:1: expected a version before 6, found '6.0'"},
    {"a.vtk", VTK_5("ASCII") "POINTS 1 float\n1 1 1\nVERTICES 2 1\n1 0\n",
     "a.vtk:7: expected OFFSETS, found '1'"},
    {"a.vtk", VTK_5("ASCII") "POINTS 1 float\n1 1 1\nVERTICES 2 1\nOFFSETS vtktypeint64\n0 1\n",
     "a.vtk:9: expected CONNECTIVITY, found the end of the file"},
    {"a.vtk", "solid\n", "a.vtk:1: expected '# vtk DataFile Version', found 'solid'"},
    {"a.vtk", VTK("TEXT"), "a.vtk:3: expected ASCII or BINARY, found 'TEXT'"},
    {"a.vtk", VTK("ASCII"), "a.vtk: the file has no particles"},
    {"a.vtk", VTK("ASCII") "DATASET STRUCTURED_POINTS\n",
     "a.vtk:4: expected POLYDATA or UNSTRUCTURED_GRID, found 'STRUCTURED_POINTS'"},
    {"a.vtk", VTK("ASCII") "METADATA\n",
     "a.vtk:4: expected POINTS, CELLS, POINT_DATA, VECTORS or another section, found 'METADATA'"},
    {"a.vtk", VTK("ASCII") "POINTS -1 float\n", "a.vtk:4: expected a number of points, found '-1'"},
    {"a.vtk", VTK("ASCII") "POINTS 1 int\n1 1 1\n", "a.vtk:4: expected float or double, found int"},
    {"a.vtk", VTK("ASCII") "POINTS 1 real\n1 1 1\n",
     "a.vtk:4: expected a type such as float or int, found 'real'"},
    {"a.vtk", VTK("ASCII") "POINTS 2 float\n1 1 1\n1 x 1", "a.vtk:6: expected a number, found 'x'"},
    {"a.vtk", VTK("ASCII") "POINTS 2 float\n1 1 1\n1 1\n",
     "a.vtk:7: expected a number, found the end of the file"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1 1 inf\n",
     "a.vtk:5: vertex 0: expected a finite z of at most 1e+12 m, found inf"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1 1 1\nPOINTS 1 float\n1 1 1\n",
     "a.vtk:6: POINTS are given twice"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1 1 1\nPOINT_DATA 2\n",
     "a.vtk:6: expected data of the 1 points above"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1 1 1\nPOINT_DATA 1\nSCALARS s float\n1\n",
     "a.vtk:8: expected LOOKUP_TABLE, found '1'"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1 1 1\nPOINT_DATA 1\nVECTORS velocity int\n1 1 1\n",
     "a.vtk:7: expected velocities of float or double, found int"},
    {"a.vtk",
     VTK("ASCII") "POINTS 1 float\n1 1 1\nPOINT_DATA 1\nVECTORS velocity float\n1 1 1\n"
                  "VECTORS velocity float\n1 1 1\n",
     "a.vtk:9: velocities are given twice"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1 1 1\nPOINT_DATA 1\nVECTORS velocity float\n1 1 1e7\n",
     "a.vtk:8: velocity 0: expected a finite z of at most 1e+06 m/s, found 1e+07"},
    {"a.vtk", VTK("BINARY") "POINTS 1 float\n12345678",
     "a.vtk: byte 65: expected float, found the end of the file"},
    {"a.vtk", VTK("ASCII") "POINTS 1 float\n1e7 1 1\n",
     "expected particles at most 1e+06 m from the origin, found x = 10000000 m"},
};

static void test_bad_files(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(bad_files); k++) {
        char fill[64], message[512];
        test_write_text(bad_files[k].name, bad_files[k].data);
        snprintf(fill, sizeof fill, "{'file': '%s'}", bad_files[k].name);
        snprintf(message, sizeof message, "scene.json:2:48: bodies[0].particles.fill[0].file: %s",
                 bad_files[k].message);
        expect_bad_fill(0.5, fill, message);
        test_remove_file(bad_files[k].name);
    }
    expect_bad_fill(
        0.5, "{'file': 'none.vtk'}",
        "scene.json:2:48: bodies[0].particles.fill[0].file: none.vtk: cannot open the file: "
        "No such file or directory");
    assert_true(pdyn_peak_bytes(context) <
                300000000); /* a count in the file's header is not trusted */
}

/* Truncated and corrupted files are read or refused, without leaks. */
static void expect_sane(const void *what, const char *data, size_t size) {
    const struct sample *sample = what;
    struct particles read;
    test_write_file(sample->name, data, size);
    pdyn_status status = particles_read(context, sample->name, &read);
    assert_true(status == PDYN_OK || status == PDYN_BAD_INPUT);
    for (int i = 0; i < 3 * read.count; i++) assert_true(fabs(read.x[i]) <= 1e12);
    for (int i = 0; read.v && i < 3 * read.count; i++) assert_true(fabs(read.v[i]) <= 1e6);
    particles_free(context, &read);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

static void test_damaged(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(samples); k++) {
        test_damaged_copies(samples[k].data, samples[k].size, expect_sane, &samples[k]);
        test_remove_file(samples[k].name);
    }
}

static pdyn_status fill_in_three_ways(const void *fill) {
    struct scene scene;
    pdyn_status status = read_fill(0.05, fill, &scene);
    scene_free(context, &scene);
    return status;
}

static void test_no_memory(void **state) {
    static const char tetrahedron[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    (void)state;
    const char *fill = "{'mesh': 'mesh.obj'}, {'file': 'a.VTK'}, "
                       "{'sphere': {'center': [0, 0, 0], 'radius': 1}}";
    test_write_text("mesh.obj", tetrahedron);
    test_write_file(samples[4].name, samples[4].data, samples[4].size);
    long needed = test_failing_allocations(context, &counter, fill_in_three_ways, fill);
    assert_true(needed > 20 && needed < 1000);
    test_remove_file("mesh.obj");
    test_remove_file(samples[4].name);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files),         cmocka_unit_test(test_placed_file),
        cmocka_unit_test(test_close_to_wall), cmocka_unit_test(test_own_files),
        cmocka_unit_test(test_bad_files),     cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests_name("particle_files", tests, scene_set_up, scene_tear_down);
}
