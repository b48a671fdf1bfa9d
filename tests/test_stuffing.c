/* Tetrahedra that fill a closed mesh: volume, shape and outside, thin parts, refusals. */
#include "support.h"

#include "geometry/mesh_query.h"
#include "geometry/tets.h"
#include "projdyn/vec3.h"

#include <string.h>

/* The mesh of scenes/meshes, turned and scaled. */
static struct mesh read_turned(pdyn_context *context, const char *name, double degrees) {
    char path[1024];
    struct mesh mesh;
    double c = cos(degrees * 0.017453292519943295), s = sin(degrees * 0.017453292519943295);
    snprintf(path, sizeof path, "%s/scenes/meshes/%s", getenv("PROJDYN_SOURCE_ROOT"), name);
    assert_int_equal(mesh_read(context, path, &mesh), PDYN_OK);
    for (int i = 0; i < mesh.vertices; i++) {
        double *x = mesh.vertex + 3 * (size_t)i, turned[3];
        turned[0] = c * x[0] - s * x[1], turned[1] = s * x[0] + c * x[1], turned[2] = x[2];
        memcpy(x, turned, sizeof turned);
    }
    return mesh;
}

/* The longest side of the bounding box, m. */
static double extent(const struct mesh *mesh) {
    struct box box = box_around(mesh->vertex, mesh->vertices);
    return box_extent(&box);
}

/* The smallest dihedral angle, degrees: between the normals of the faces ab c and ab d. */
static double smallest_angle(const struct mesh *mesh, const struct tets *tets) {
    static const int edges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                    {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
    double largest = -1.0;
    for (int t = 0; t < tets->count; t++)
        for (int e = 0; e < 6; e++) {
            const double *x[4];
            double n[2][3];
            for (int k = 0; k < 4; k++) x[k] = mesh->vertex + 3 * tets->corner[4 * t + edges[e][k]];
            vec3_normal(n[0], x[0], x[1], x[2]);
            vec3_normal(n[1], x[0], x[1], x[3]);
            largest = fmax(largest, vec3_dot(n[0], n[1]) / vec3_length(n[0]) / vec3_length(n[1]));
        }
    return acos(largest) / 0.017453292519943295;
}

/* Fills the mesh, checks that the outside is closed, oriented and close to the mesh, and returns
 * the volume of the tetrahedra over that of the mesh. */
static double fill(pdyn_context *context, const struct mesh *surface, double cell, double angle) {
    struct mesh mesh = {0};
    struct tets tets = {0};
    struct mesh_query query;
    double sum = 0.0;
    assert_int_equal(tets_fill(context, surface, cell, &mesh, &tets), PDYN_OK);
    if (tets_finish(context, "filled", &mesh, &tets) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(context));
    assert_int_equal(mesh_check_closed(context, &mesh, "filled"), PDYN_OK);
    assert_int_equal(mesh_check_oriented(context, &mesh, "filled"), PDYN_OK);
    assert_true(smallest_angle(&mesh, &tets) > angle);
    for (int t = 0; t < tets.count; t++) sum += tets.volume[t];
    assert_true(fabs(mesh_volume(mesh.triangles, mesh.triangle, mesh.vertex) / sum - 1) < 1e-9);
    assert_int_equal(mesh_query_create(context, surface, &query), PDYN_OK);
    for (int k = 0; k < 3 * mesh.triangles; k++)
        assert_true(mesh_query_is_close(&query, mesh.vertex + 3 * mesh.triangle[k], 0.3 * cell));
    mesh_query_free(context, &query);
    mesh_free(context, &mesh);
    tets_free(context, &tets);
    return sum / fabs(mesh_volume(surface->triangles, surface->triangle, surface->vertex));
}

/* What is missing at a round surface falls with the square of the cell. */
static void test_ball(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh ball = read_turned(context, "ball.obj", 17);
    double missing[3], size = extent(&ball);
    for (int k = 0; k < 3; k++) missing[k] = 1.0 - fill(context, &ball, size / (5 << k), 15.0);
    print_message("missing: %.4f %.4f %.4f\n", missing[0], missing[1], missing[2]);
    assert_true(missing[0] < 0.06 && missing[2] < 0.004);
    assert_true(missing[1] < 0.35 * missing[0]);
    mesh_free(context, &ball);
    pdyn_destroy(context);
}

/* Tubes of one to three cells across: parts that touch along an edge are separated. */
static void test_thin_parts(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    for (int turn = 0; turn < 12; turn++) {
        struct mesh knot = read_turned(context, "knot.obj", 7.0 * turn);
        for (int cells = 8; cells <= 16; cells += 2)
            assert_true(fill(context, &knot, extent(&knot) / cells, 2.0) < 1.02);
        mesh_free(context, &knot);
    }
    pdyn_destroy(context);
}

static void test_refusals(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh ball = read_turned(context, "ball.obj", 0), mesh;
    struct tets tets;
    assert_int_equal(tets_fill(context, &ball, 1e-4 * extent(&ball), &mesh, &tets), PDYN_BAD_INPUT);
    assert_error("too small");
    assert_int_equal(tets_fill(context, &ball, 10.0 * extent(&ball), &mesh, &tets), PDYN_BAD_INPUT);
    assert_error("too large");
    mesh_free(context, &ball);
    pdyn_destroy(context);
}

/* Pieces of 1/6, 1/48 and 1/6000 m^3: the largest never counts as small. */
static void test_small_pieces(void **state) {
    (void)state;
    static const double size[3] = {0.5, 1.0, 0.1}, volume[3] = {0.01, 0.1, 1.0};
    double x[36] = {0}, volumes[3];
    int corner[12], count;
    pdyn_context *context = test_context(1);
    for (int k = 0; k < 12; k++) corner[k] = k;
    for (int t = 0; t < 3; t++) {
        for (int v = 1; v < 4; v++) x[12 * t + 4 * v - 1] = size[t];
        volumes[t] = size[t] * size[t] * size[t] / 6.0;
    }
    const struct mesh mesh = {.vertices = 12, .vertex = x};
    const struct tets tets = {.count = 3, .corner = corner, .volume = volumes};
    for (int k = 0; k < 3; k++) {
        assert_int_equal(tets_count_small(context, &mesh, &tets, volume[k], &count), PDYN_OK);
        assert_int_equal(count, k ? 2 : 1);
    }
    pdyn_destroy(context);
}

/* Two tetrahedra of 1/6 m^3 that share an edge, which has four triangles. */
static const char touching[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\n"
                               "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
                               "f 1 6 5\nf 1 5 4\nf 1 4 6\nf 5 6 4\n";

/* A rigid body refuses them, and takes the surface of the tetrahedra that fill them. */
static void test_rigid(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim;
    test_write_file("touching.obj", touching, strlen(touching));
    const char *text = quoted("{'duration': 1, 'bodies': [{'rigid': {'mesh': 'touching.obj', "
                              "'density': 600}}]}");
    test_write_file("scene.json", text, strlen(text));
    assert_int_equal(pdyn_load(context, "scene.json", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_error("\"cell\" makes a surface");
    const char *const cell = "bodies.0.rigid.cell=0.05";
    assert_int_equal(pdyn_load(context, "scene.json", &cell, 1, &sim), PDYN_OK);
    double mass = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) mass += sim->objective.mass[i];
    assert_true(mass > 0.95 * 200 && mass < 1.001 * 200);
    assert_int_equal(sim->body[0].tets, 0);
    test_remove_file("touching.obj");
    test_remove_file("scene.json");
    test_close(sim);
}

/* Every allocation fails once: nothing is left behind. */
static void test_memory(void **state) {
    (void)state;
    test_write_file("touching.obj", touching, strlen(touching));
    test_failing_scene("{'duration': 1, 'solver': {'type': 'cg'}, 'bodies': [{'volume': {'mesh': "
                       "'touching.obj', 'cell': 0.3, 'density': 500}, 'constraints': [{'type': "
                       "'tet', 'stiffness': 2e4}]}]}");
    test_failing_scene("{'duration': 1, 'solver': {'type': 'cg'}, 'bodies': [{'rigid': {'mesh': "
                       "'touching.obj', 'cell': 0.3, 'density': 500}}]}");
    test_remove_file("touching.obj");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball),         cmocka_unit_test(test_thin_parts),
        cmocka_unit_test(test_small_pieces), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_rigid),        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests_name("stuffing", tests, test_enter_directory,
                                       test_leave_directory);
}
