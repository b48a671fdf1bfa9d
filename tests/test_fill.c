/* Filling a body with particles: volumes against formulas, closed and open meshes, files of
 * particles, also damaged ones. */
#include "output/output.h"
#include "scene_support.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- helpers -------------------------------------------------------------------------------- */

static pdyn_status read_fill(double radius, const char *fill, struct scene *scene) {
    char text[4096];
    snprintf(text, sizeof text,
             "{'duration': 1, 'bodies': [{'velocity': [1, 2, 3],\n"
             "'particles': {'radius': %.17g, 'fill': [%s]}}]}",
             radius, fill);
    return read_text(text, NULL, 0, scene);
}

static const struct scene_body *read_good_fill(double radius, const char *fill,
                                               struct scene *scene) {
    if (read_fill(radius, fill, scene) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    assert_int_equal(scene->body[0].start.count, scene->body[0].start_v.count);
    return &scene->body[0];
}

static void expect_bad(double radius, const char *fill, const char *message) {
    struct scene scene;
    assert_int_not_equal(read_fill(radius, fill, &scene), PDYN_OK);
    assert_string_equal(pdyn_last_error(context), message);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

static void assert_volume(const struct scene_body *body, double volume, double tolerance) {
    double spacing = 2.0 * body->radius, found = body->start.count * pow(spacing, 3.0);
    if (!(fabs(found / volume - 1.0) <= tolerance))
        fail_msg("expected a volume of %g m^3, found %g", volume, found);
}

static void assert_velocity(const struct scene_body *body, int first, int count, double x, double y,
                            double z) {
    const double v[3] = {x, y, z};
    for (int i = first; i < first + count; i++)
        if (!(test_distance(body->start_v.x + 3 * i, v, 3) < 1e-12))
            fail_msg("particle %d has an unexpected velocity", i);
}

/* ---- spheres -------------------------------------------------------------------------------- */

static void test_sphere(void **state) {
    (void)state;
    struct scene scene;
    const double center[3] = {1, -2, 3};
    const struct scene_body *body =
        read_good_fill(0.01, "{'sphere': {'center': [1, -2, 3], 'radius': 1}}", &scene);
    assert_volume(body, 4.0 / 3.0 * pi, 0.035);
    assert_volume(body, 4.0 / 3.0 * pi * pow(0.99, 3.0), 0.005);
    double nearest = HUGE_VAL;
    for (int i = 0; i < body->start.count; i++) {
        double distance = test_distance(body->start.x + 3 * i, center, 3);
        assert_true(distance + 0.01 <= 1.0 + 1e-9);
        nearest = fmin(nearest, distance);
    }
    assert_true(nearest < 1e-12);
    assert_velocity(body, 0, body->start.count, 1, 2, 3);
    free_good(&scene);
    body = read_good_fill(0.5, "{'sphere': {'center': [0, 0, 0], 'radius': 0.5}}", &scene);
    assert_int_equal(body->start.count, 1);
    free_good(&scene);
}

static void test_velocities(void **state) {
    (void)state;
    struct scene scene;
    const struct scene_body *body = read_good_fill(
        0.5,
        "{'box': {'minimum': [0, 0, 0], 'maximum': [2, 1, 1]}, 'velocity': [-4, 0, 0]},"
        "{'sphere': {'center': [9, 0, 0], 'radius': 1.5}},"
        "{'box': {'minimum': [0, 5, 0], 'maximum': [1, 6, 1]}, 'velocity': [0, 5, 0]}",
        &scene);
    assert_int_equal(body->start.count, 2 + 7 + 1);
    assert_velocity(body, 0, 2, -4, 0, 0);
    assert_velocity(body, 2, 7, 1, 2, 3);
    assert_velocity(body, 9, 1, 0, 5, 0);
    free_good(&scene);
}

/* Particles start at the positions and velocities of the scene. */
static void test_simulation(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(
        context, "{\"duration\": 1, \"bodies\": [{\"particles\": {\"radius\": 0.5, \"fill\": ["
                 "{\"sphere\": {\"center\": [3, 0, 0], \"radius\": 0.5}, \"velocity\": [7, 0, 0]},"
                 "{\"sphere\": {\"center\": [0, 4, 0], \"radius\": 0.5}}]}}]}");
    pdyn_state now = pdyn_get_state(sim);
    const double x[] = {3, 0, 0, 0, 4, 0}, v[] = {7, 0, 0, 0, 0, 0};
    assert_true(test_distance(now.x, x, 6) == 0.0 && test_distance(now.v, v, 6) == 0.0);
    pdyn_free(sim);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

/* ---- meshes --------------------------------------------------------------------------------- */

enum { AROUND = 160, TUBE = 80 };
static const double ring = 1.0, tube = 0.4;

/* A torus about the y axis. missing: without its last triangle. */
static void write_torus(bool missing) {
    FILE *file = fopen("torus.obj", "w");
    assert_non_null(file);
    for (int i = 0; i < AROUND; i++)
        for (int j = 0; j < TUBE; j++) {
            double a = 2.0 * pi * i / AROUND, b = 2.0 * pi * j / TUBE;
            double out = ring + tube * cos(b);
            fprintf(file, "v %.17g %.17g %.17g\n", out * cos(a), tube * sin(b), out * sin(a));
        }
    for (int i = 0; i < AROUND; i++)
        for (int j = 0; j < TUBE; j++) {
            int p = i * TUBE + j + 1, q = i * TUBE + (j + 1) % TUBE + 1;
            int r = (i + 1) % AROUND * TUBE + j + 1,
                s = (i + 1) % AROUND * TUBE + (j + 1) % TUBE + 1;
            fprintf(file, "f %d %d %d\n", p, q, s);
            if (!missing || i + 1 < AROUND || j + 1 < TUBE) fprintf(file, "f %d %d %d\n", p, s, r);
        }
    assert_int_equal(fclose(file), 0);
}

static void test_torus(void **state) {
    (void)state;
    struct scene scene;
    const double radius = 0.01, facets = 1e-3; /* distance of the chords from the arcs, m */
    write_torus(false);
    const struct scene_body *body = read_good_fill(radius, "{'mesh': 'torus.obj'}", &scene);
    assert_volume(body, 2.0 * pi * pi * ring * tube * tube, 0.06);
    assert_volume(body, 2.0 * pi * pi * ring * pow(tube - radius, 2.0), 0.01);
    for (int i = 0; i < body->start.count; i++) {
        const double *x = body->start.x + 3 * i;
        double distance = hypot(hypot(x[0], x[2]) - ring, x[1]);
        assert_true(distance + radius <= tube + facets);
    }
    free_good(&scene);
    body = read_good_fill(2.0 * radius,
                          "{'mesh': 'torus.obj', 'scale': [2, -2, 2], 'rotate': [31, 0, 17], "
                          "'translate': [5, 6, 7], 'velocity': [0, 0, 9]}",
                          &scene);
    assert_volume(body, 16.0 * pi * pi * ring * pow(tube - radius, 2.0), 0.01);
    assert_velocity(body, 0, body->start.count, 0, 0, 9);
    double middle[3] = {0};
    for (int i = 0; i < body->start.count; i++)
        for (int a = 0; a < 3; a++) middle[a] += body->start.x[3 * i + a] / body->start.count;
    assert_true(test_distance(middle, (const double[]){5, 6, 7}, 3) < 0.01);
    free_good(&scene);
    test_remove_file("torus.obj");
}

static void test_open_mesh(void **state) {
    (void)state;
    write_torus(true);
    expect_bad(0.02, "{'mesh': 'torus.obj'}",
               "scene.json:2:49: bodies[0].particles.fill[0].mesh: torus.obj: the mesh is not "
               "closed: the edge between vertices 0 and 79 has 1 triangle, expected 2");
    write_torus(false);
    expect_bad(0.5, "{'mesh': 'torus.obj'}",
               "scene.json:2:48: bodies[0].particles.fill[0].mesh: no particle of radius 0.5 m "
               "fits into the shape");
    expect_bad(0x1p-10, "{'mesh': 'torus.obj'}",
               "scene.json:2:57: bodies[0].particles.fill[0].mesh: more than 536870911 points: "
               "the particle radius is too small for the size of the scene");
    test_remove_file("torus.obj");
}

#define CUBE_FACES "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
static const char cube[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\n"
                           "v 1 1 1\n" CUBE_FACES;

/* Rows of particles lie on faces, edges and diagonals of the mesh; the outermost particles touch
 * it. */
static void test_cube(void **state) {
    (void)state;
    struct scene scene, boxes;
    test_write_text("cube.obj", cube);
    for (double n = 1.0; n <= 20.0; n++) {
        const struct scene_body *body = read_good_fill(0.5 / n, "{'mesh': 'cube.obj'}", &scene);
        const struct scene_body *box = read_good_fill(
            0.5 / n, "{'box': {'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}}", &boxes);
        assert_int_equal(body->start.count, box->start.count);
        assert_true(test_distance(body->start.x, box->start.x, 3 * body->start.count) < 1e-12);
        scene_free(context, &boxes);
        free_good(&scene);
    }
    test_remove_file("cube.obj");
}

/* A split edge of the cube; degenerate triangles close the gap. */
static void test_thin_triangles(void **state) {
    (void)state;
    static const char data[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\n"
                               "v 1 1 1\nv 0.5 1e-17 1e-18\n"
                               "f 1 3 4 2 9\nf 5 6 8 7\nf 1 9 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n"
                               "f 2 4 8 6\n";
    struct scene scene;
    test_write_text("thin.obj", data);
    assert_int_equal(read_good_fill(0.05, "{'mesh': 'thin.obj'}", &scene)->start.count, 1000);
    free_good(&scene);
    test_remove_file("thin.obj");
}

/* All corners and edges of the octahedron lie on rows of particles. */
static void test_octahedron(void **state) {
    (void)state;
    static const char data[] = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
                               "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\n"
                               "f 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    struct scene scene;
    test_write_text("octahedron.obj", data);
    for (int half = 2; half <= 20; half++) {
        double radius = 1.0 / (2 * half + 1);
        const struct scene_body *body =
            read_good_fill(radius, "{'mesh': 'octahedron.obj'}", &scene);
        int expected = 0;
        for (int k = -half; k <= half; k++)
            for (int j = -half; j <= half; j++)
                for (int i = -half; i <= half; i++)
                    expected += 1.0 - 2.0 * radius * (abs(i) + abs(j) + abs(k)) >=
                                radius * sqrt(3.0) * (1.0 - 1e-6);
        assert_int_equal(body->start.count, expected);
        free_good(&scene);
    }
    test_remove_file("octahedron.obj");
}

/* Two cubes that share an edge (of four triangles), and a hollow cube. */
static void test_several_parts(void **state) {
    (void)state;
    static const char shared[] = "v 1 1 0\nv 2 1 0\nv 1 2 0\nv 2 2 0\nv 1 1 1\nv 2 1 1\n"
                                 "v 1 2 1\nv 2 2 1\n"
                                 "f 4 11 12 10\nf 8 14 16 15\nf 4 10 14 8\nf 11 15 16 12\n"
                                 "f 4 8 15 11\nf 10 12 16 14\n";
    static const char inner[] = "v .3 .3 .3\nv .7 .3 .3\nv .3 .7 .3\nv .7 .7 .3\nv .3 .3 .7\n"
                                "v .7 .3 .7\nv .3 .7 .7\nv .7 .7 .7\n"
                                "f 9 10 12 11\nf 13 15 16 14\nf 9 13 14 10\nf 11 12 16 15\n"
                                "f 9 11 15 13\nf 10 14 16 12\n";
    char data[2048];
    struct scene scene;
    snprintf(data, sizeof data, "%s%s", cube, shared);
    test_write_text("parts.obj", data);
    assert_int_equal(read_good_fill(0.05, "{'mesh': 'parts.obj'}", &scene)->start.count, 2000);
    free_good(&scene);
    snprintf(data, sizeof data, "%s%s", cube, inner);
    test_write_text("parts.obj", data);
    assert_int_equal(read_good_fill(0.05, "{'mesh': 'parts.obj'}", &scene)->start.count, 1000 - 64);
    free_good(&scene);
    test_remove_file("parts.obj");
}

/* ---- files ---------------------------------------------------------------------------------- */

#define PLY         "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
#define PLY_V       "property float vx\nproperty float vy\nproperty float vz\n"
#define VTK(format) "# vtk DataFile Version 3.0\na title\n" format "\n"
#define BYTES_1     "\x3f\x80\0\0"
#define BYTES_2     "\x40\0\0\0"
#define ZERO        "\0\0\0\0"

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
    {"a.vtk", "# vtk DataFile Version 5.1\nt\nASCII\n",
     "a.vtk:1: expected a version before 5, found '5.1'"},
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
        expect_bad(0.5, fill, message);
        test_remove_file(bad_files[k].name);
    }
    expect_bad(0.5, "{'file': 'none.vtk'}",
               "scene.json:2:48: bodies[0].particles.fill[0].file: none.vtk: cannot open the file: "
               "No such file or directory");
    assert_true(pdyn_peak_bytes(context) <
                300000000); /* a count in the file's header is not trusted */
}

/* Truncated and corrupted files are read or refused, without leaks. */
static void expect_sane(const struct sample *sample, const char *data, size_t size) {
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
    static const char replacement[] = {'\0', '\n', ' ', '-', '9', '/', '\x7f', '\xff'};
    uint32_t random = 1;
    for (int k = 0; k < COUNT(samples); k++) {
        char data[1024];
        assert_true(samples[k].size < sizeof data);
        for (size_t size = 0; size < samples[k].size; size++)
            expect_sane(&samples[k], samples[k].data, size);
        for (size_t at = 0; at < samples[k].size; at++) {
            memcpy(data, samples[k].data, samples[k].size);
            random = random * 1664525u + 1013904223u;
            data[at] = replacement[random >> 29];
            expect_sane(&samples[k], data, samples[k].size);
        }
        test_remove_file(samples[k].name);
    }
}

static pdyn_status fill_in_three_ways(const void *fill) {
    struct scene scene;
    pdyn_status status = read_fill(0.05, fill, &scene);
    scene_free(context, &scene);
    return status;
}

/* ---- overlap -------------------------------------------------------------------------------- */

/* A box of water, 10 x 10 x 10 particles of radius 0.05 m, with these keys of its particles, a
 * solid and bodies beside it. Returns the number of particles; -1: it is refused. */
static int fill_beside(const char *keys, const char *bodies, const char *solid) {
    char text[2048];
    struct scene scene;
    snprintf(
        text, sizeof text,
        "{'duration': 1, 'bodies': [{'name': 'water', 'particles': {'radius': 0.05, %s 'fill': "
        "[{'box': {'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}}]}}%s], 'solids': [%s]}",
        keys, bodies, solid);
    if (read_text(text, NULL, 0, &scene) != PDYN_OK) return -1;
    int count = scene.body[0].start.count;
    assert_int_equal(count, scene.body[0].start_v.count);
    scene_free(context, &scene);
    return count;
}

/* Lattice points farther than 0.25 + 0.05 m from the middle of the box. */
static int outside_of_ball(void) {
    int count = 0;
    for (int k = 0; k < 1000; k++) {
        double x = 0.1 * (k % 10) - 0.45, y = 0.1 * (k / 10 % 10) - 0.45,
               z = 0.1 * (k / 100) - 0.45;
        count += x * x + y * y + z * z > 0.3 * 0.3;
    }
    return count;
}

/* Particles in and close to a solid or a sheet are left out; kept ones are an error. */
static void test_overlap(void **state) {
    (void)state;
    static const char ball[] = "{'name': 'ball', 'sphere': {'center': [0.5, 0.5, 0.5], 'radius': "
                               "0.25}}";
    assert_int_equal(fill_beside("", "", ball), outside_of_ball());
    assert_int_equal(fill_beside("'overlap': 'keep',", "", ball), -1);
    assert_non_null(strstr(pdyn_last_error(context), "particles overlap solid \"ball\""));
    /* a moving solid, at time 0 out of the water */
    assert_int_equal(
        fill_beside(
            "", "",
            "{'sphere': {'center': [0.5, 0.5, 0.5], 'radius': 0.25}, 'motion': [{'time': 0, "
            "'translate': [5, 0, 0]}, {'time': 1}]}"),
        1000);
    /* walls that touch the lattice, and one through it: particles behind it are left out, too */
    assert_int_equal(fill_beside("", "", "{'box': {'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}}"),
                     1000);
    assert_int_equal(
        fill_beside("", "", "{'box': {'minimum': [-1, -1, -1], 'maximum': [2, 0.65, 2]}}"), 700);
    /* a vessel: most particles are inside, those close to it are left out */
    assert_int_equal(fill_beside("", "", "{'sphere': {'center': [0.5, 0.5, 0.5], 'radius': 5}}"),
                     1000);
    /* a sheet in a layer of particles; kept, it may be meant to be stretched */
    static const char sheet[] = ", {'surface': {'grid': {'size': [3, 3], 'vertices': [4, 4]}, "
                                "'translate': [0, 0.45, 0], 'area_density': 1}}";
    assert_int_equal(fill_beside("", sheet, ""), 900);
    assert_int_equal(fill_beside("'overlap': 'keep',", sheet, ""), 1000);
}

static void test_no_memory(void **state) {
    (void)state;
    const char *fill = "{'mesh': 'cube.obj'}, {'file': 'a.VTK'}, "
                       "{'sphere': {'center': [0, 0, 0], 'radius': 1}}";
    test_write_text("cube.obj", cube);
    test_write_file(samples[4].name, samples[4].data, samples[4].size);
    long needed = test_failing_allocations(context, &counter, fill_in_three_ways, fill);
    assert_true(needed > 20 && needed < 1000);
    test_remove_file("cube.obj");
    test_remove_file(samples[4].name);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),         cmocka_unit_test(test_velocities),
        cmocka_unit_test(test_simulation),     cmocka_unit_test(test_torus),
        cmocka_unit_test(test_open_mesh),      cmocka_unit_test(test_cube),
        cmocka_unit_test(test_thin_triangles), cmocka_unit_test(test_octahedron),
        cmocka_unit_test(test_several_parts),  cmocka_unit_test(test_files),
        cmocka_unit_test(test_placed_file),    cmocka_unit_test(test_own_files),
        cmocka_unit_test(test_bad_files),      cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_overlap),        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests_name("fill", tests, scene_set_up, scene_tear_down);
}
