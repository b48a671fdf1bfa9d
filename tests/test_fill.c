/* Filling a body with particles: volumes against formulas, closed and open meshes, overlap with
 * other bodies. test_particle_files.c tests files of particles. */
#include "scene_support.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static void assert_volume(const struct scene_body *body, double volume, double tolerance) {
    double spacing = 2.0 * body->radius, found = body->start.count * pow(spacing, 3.0);
    if (!(fabs(found / volume - 1.0) <= tolerance))
        fail_msg("expected a volume of %g m^3, found %g", volume, found);
}

/* ---- spheres --------------------------------------------------------------------------------- */

static void test_sphere(void **state) {
    (void)state;
    struct scene scene;
    const double center[3] = {1, -2, 3};
    const struct scene_body *body =
        read_good_fill(0.01, "{'sphere': {'center': [1, -2, 3], 'radius': 1}}", &scene);
    assert_volume(body, 4.0 / 3.0 * pi * body->fill[0].part, 1e-12);
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

/* ---- meshes ---------------------------------------------------------------------------------- */

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
    assert_volume(body, 2.0 * pi * pi * ring * tube * tube * body->fill[0].part, 0.002);
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
    expect_bad_fill(0.02, "{'mesh': 'torus.obj'}",
                    "scene.json:2:49: bodies[0].particles.fill[0].mesh: torus.obj: the mesh is not "
                    "closed: the edge between vertices 0 and 79, at (1.4, 0, 0) m, has 1 triangle, "
                    "expected 2: a hole, or vertices that are not joined");
    write_torus(false);
    expect_bad_fill(
        0.5, "{'mesh': 'torus.obj'}",
        "scene.json:2:48: bodies[0].particles.fill[0].mesh: no particle of radius 0.5 m "
        "fits into the shape");
    expect_bad_fill(
        0x1p-10, "{'mesh': 'torus.obj'}",
        "scene.json:2:57: bodies[0].particles.fill[0].mesh: more than 536870911 points: "
        "the particle radius is too small for the size of the scene; \"scale\" changes the unit of "
        "a mesh");
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

/* Fills parts.obj, of which particles of radius 0.05 m take all of the volume. */
static int fill_parts(void) {
    struct scene scene;
    const struct scene_body *body = read_good_fill(0.05, "{'mesh': 'parts.obj'}", &scene);
    int count = body->start.count;
    assert_true(fabs(body->fill[0].part - 1.0) < 1e-12);
    free_good(&scene);
    return count;
}

/* Two cubes that share an edge (of four triangles), and a hollow cube, which faces outwards within,
 * too. */
static void test_several_parts(void **state) {
    (void)state;
    static const char shared[] = "v 1 1 0\nv 2 1 0\nv 1 2 0\nv 2 2 0\nv 1 1 1\nv 2 1 1\n"
                                 "v 1 2 1\nv 2 2 1\n"
                                 "f 4 11 12 10\nf 8 14 16 15\nf 4 10 14 8\nf 11 15 16 12\n"
                                 "f 4 8 15 11\nf 10 12 16 14\n";
    static const char inner[] = "v .3 .3 .3\nv .7 .3 .3\nv .3 .7 .3\nv .7 .7 .3\nv .3 .3 .7\n"
                                "v .7 .3 .7\nv .3 .7 .7\nv .7 .7 .7\n"
                                "f 9 11 12 10\nf 13 14 16 15\nf 9 10 14 13\nf 11 15 16 12\n"
                                "f 9 13 15 11\nf 10 12 16 14\n";
    char data[2048];
    snprintf(data, sizeof data, "%s%s", cube, shared);
    test_write_text("parts.obj", data);
    assert_int_equal(fill_parts(), 2000);
    snprintf(data, sizeof data, "%s%s", cube, inner);
    test_write_text("parts.obj", data);
    assert_int_equal(fill_parts(), 1000 - 64);
    test_remove_file("parts.obj");
}

/* ---- overlap --------------------------------------------------------------------------------- */

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

/* Lattice points farther than a radius + 0.05 m from the middle of the box. */
static int outside_of_ball(double radius) {
    int count = 0;
    for (int k = 0; k < 1000; k++) {
        double x = 0.1 * (k % 10) - 0.45, y = 0.1 * (k / 10 % 10) - 0.45,
               z = 0.1 * (k / 100) - 0.45;
        count += sqrt(x * x + y * y + z * z) > radius + 0.05;
    }
    return count;
}

/* Particles in and close to a solid or a sheet are left out; kept ones are an error. */
static void test_overlap(void **state) {
    (void)state;
    static const char ball[] = "{'name': 'ball', 'sphere': {'center': [0.5, 0.5, 0.5], 'radius': "
                               "0.25}}";
    assert_int_equal(fill_beside("", "", ball), outside_of_ball(0.25));
    assert_int_equal(
        fill_beside("", "", "{'sphere': {'center': [0.5, 0.5, 0.5], 'radius': 0.445}}"),
        outside_of_ball(0.445)); /* with almost half of the particles */
    assert_int_equal(fill_beside("'overlap': 'keep',", "", ball), -1);
    assert_error("particles overlap solid \"ball\"");
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
    static const char rigid[] = ", {'name': 'rock', 'rigid': {'sphere': {'center': [0.5, 0.5, 0.5],"
                                " 'radius': 0.25}, 'density': 1}}";
    assert_int_equal(fill_beside("", rigid, ""), outside_of_ball(0.25));
    assert_int_equal(fill_beside("'overlap': 'keep',", rigid, ""), -1);
    assert_error("particles overlap body \"rock\"");
    /* water passes a net */
    assert_int_equal(
        fill_beside("",
                    ", {'surface': {'grid': {'size': [3, 3], 'vertices': [4, 4]}, 'translate': "
                    "[0, 0.45, 0], 'area_density': 1, 'permeability': 0.1}}",
                    ""),
        1000);
}

/* Where an obstacle takes particles of the lower of two fills, the others keep their velocities,
 * and their fills. */
static void test_overlap_of_fills(void **state) {
    (void)state;
    struct scene scene;
    int below = 0;
    assert_int_equal(
        read_text("{'duration': 1, 'bodies': [{'particles': {'radius': 0.05, 'fill': [{'box': "
                  "{'minimum': [0, 0, 0], 'maximum': [1, 0.5, 1]}, 'velocity': [1, 0, 0]}, {'box': "
                  "{'minimum': [0, 0.5, 0], 'maximum': [1, 1, 1]}, 'velocity': [2, 0, 0]}]}}], "
                  "'solids': [{'sphere': {'center': [0.5, 0.3, 0.5], 'radius': 0.25}}]}",
                  NULL, 0, &scene),
        PDYN_OK);
    const struct scene_body *body = &scene.body[0];
    for (int i = 0; i < body->start.count; i++) {
        bool low = body->start.x[3 * i + 1] < 0.5;
        assert_true(body->start_v.x[3 * i] == (low ? 1.0 : 2.0));
        below += low;
    }
    assert_true(below < 500 && body->start.count < 1000);
    assert_int_equal(body->fill[0].end, below);
    assert_int_equal(body->fill[1].end, body->start.count);
    scene_free(context, &scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),           cmocka_unit_test(test_velocities),
        cmocka_unit_test(test_simulation),       cmocka_unit_test(test_torus),
        cmocka_unit_test(test_open_mesh),        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_thin_triangles),   cmocka_unit_test(test_octahedron),
        cmocka_unit_test(test_several_parts),    cmocka_unit_test(test_overlap),
        cmocka_unit_test(test_overlap_of_fills),
    };
    return cmocka_run_group_tests_name("fill", tests, scene_set_up, scene_tear_down);
}
