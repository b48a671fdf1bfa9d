/* Soft solids: singular values, tetrahedra from files and grids, strain and volume by exact
 * solutions, water on a ball. */
#include "support.h"

#include "base/registry.h"
#include "geometry/tets.h"
#include "projdyn/conformance.h"
#include "projdyn/svd3.h"

#include <string.h>

/* ---- singular values ------------------------------------------------------------------------- */

static double determinant(const double *F) {
    double n[3];
    vec3_cross(n, F, F + 3);
    return vec3_dot(n, F + 6);
}

static void check_svd(const double *F) {
    svd3 d = svd3_of(F);
    double again[9], size = 1e-300;
    for (int k = 0; k < 9; k++) size = fmax(size, fabs(F[k]));
    svd3_compose(&d, d.s, again);
    assert_true(test_distance(again, F, 9) <= 1e-13 * size);
    assert_true(d.s[0] >= d.s[1] - 1e-14 * size && d.s[1] >= fabs(d.s[2]) - 1e-14 * size);
    assert_true(fabs(d.s[0] * d.s[1] * d.s[2] - determinant(F)) <= 1e-12 * size * size * size);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(vec3_dot(d.left[i], d.left[j]) - (i == j)) <= 1e-12);
            assert_true(fabs(vec3_dot(d.right[i], d.right[j]) - (i == j)) <= 1e-12);
        }
    assert_true(determinant(&d.left[0][0]) > 0.5 && determinant(&d.right[0][0]) > 0.5);
}

WIDE static void decompose_side_by_side(const double *const F[SVD3_LANES], svd3 d[SVD3_LANES]) {
    svd3_of_lanes(F, d, 3, SVD3_LANES);
}

/* Matrices side by side have the same bits as one by one, whatever their neighbours are. */
static void check_lanes(const double F[][9], int count) {
    for (int k = 0; k + SVD3_LANES <= count; k++) {
        const double *lane[SVD3_LANES];
        svd3 d[SVD3_LANES];
        for (int l = 0; l < SVD3_LANES; l++) lane[l] = F[k + l];
        decompose_side_by_side(lane, d);
        for (int l = 0; l < SVD3_LANES; l++) {
            svd3 one = svd3_of(lane[l]);
            assert_memory_equal(&d[l], &one, sizeof one);
        }
    }
}

static void test_svd(void **state) {
    (void)state;
    static const double odd[][9] = {{0},
                                    {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                    {1, 0, 0, 0, 1, 0, 0, 0, -1},
                                    {1, 2, 3},
                                    {0, 0, 0, 0, 0, 0, 1, 1, 1},
                                    {1, 1, 1, 1, 1, 1, 1, 1, 1},
                                    {2, 0, 0, 0, 2},
                                    {1e-9, 0, 0, 0, 1, 0, 0, 0, 1e9}};
    uint64_t seed = 5;
    for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) check_svd(odd[k]);
    double F[1000][9];
    for (int k = 0; k < 1000; k++) {
        for (int i = 0; i < 9; i++) F[k][i] = k % 7 ? test_random(&seed) : odd[k % 8][i];
        check_svd(F[k]);
    }
    check_lanes((const double(*)[9])F, 1000);
}

/* ---- the contract, with a volume ------------------------------------------------------------- */

static void tell(void *user, const char *text) {
    (void)user;
    print_error("%s\n", text);
}

/* Conformance uses defaults: here with a volume stiffness, ranges and damping. */
static void test_conformance(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double value;
    } others[] = {
        {"volume_stiffness", 3e3}, {"longest", 1.01}, {"smallest", 0.99}, {"damping", 0.01}};
    pdyn_context *context = test_context(1);
    pdyn_constraint_type type = *registry_constraint(context, "tet");
    pdyn_param params[16];
    int faults = -1;
    for (int k = 0; k == 0 || type.params[k - 1].name; k++) {
        params[k] = type.params[k];
        for (size_t m = 0; params[k].name && m < sizeof others / sizeof *others; m++)
            if (!strcmp(params[k].name, others[m].name)) params[k].def = others[m].value;
    }
    type.name = "tet_with_volume", type.params = params;
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    assert_int_equal(pdyn_conformance(context, type.name, tell, NULL, &faults), PDYN_OK);
    assert_int_equal(faults, 0);
    pdyn_destroy(context);
}

/* ---- exact solutions ------------------------------------------------------------------------- */

/* E at the positions sim->x, from which nothing has moved, J. */
static double elastic_energy(pdyn_sim *sim) {
    double energy;
    sim->objective.h = 0.01;
    memcpy(sim->objective.s, sim->x, 3 * (size_t)sim->objective.particles * sizeof(double));
    assert_int_equal(objective_local(&sim->objective, sim->x, &energy, sim->gradient), PDYN_OK);
    return energy;
}

/* Number of the vertex that is the mirror image of vertex i of a block of 4 x 2 x 2 cells. */
static int mirror(int i, int axis) {
    const int n[3] = {5, 3, 3};
    int at[3] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
    at[axis] = n[axis] - 1 - at[axis];
    return at[0] + n[0] * (at[1] + n[1] * at[2]);
}

/* The corners of a tetrahedron as a set of vertices below 64. */
static uint64_t corners(const int *corner, int axis) {
    uint64_t set = 0;
    for (int k = 0; k < 4; k++)
        set |= (uint64_t)1 << (axis < 0 ? corner[k] : mirror(corner[k], axis));
    return set;
}

/* A block with an even number of cells along each axis is its own mirror image. */
static void test_grid(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh mesh = {0};
    struct tets tets = {0};
    assert_int_equal(
        tets_grid(context, (const double[]){4, 2, 2}, (const int[]){4, 2, 2}, &mesh, &tets),
        PDYN_OK);
    for (int t = 0; t < tets.count; t++)
        for (int axis = 0; axis < 3; axis++) {
            int found = 0;
            for (int other = 0; other < tets.count; other++)
                found += corners(tets.corner + 4 * other, -1) == corners(tets.corner + 4 * t, axis);
            assert_int_equal(found, 1);
        }
    tets_free(context, &tets);
    mesh_free(context, &mesh);
    pdyn_destroy(context);
}

/* A block stretched along its axes has the energy E/2 V sum (s - 1)^2 + K/2 V |s - p|^2, p the
 * closest stretches of product 1. */
static void test_stretch(void **state) {
    (void)state;
    const double s[3] = {1.2, 0.9, 1.1}, V = 0.4 * 0.2 * 0.3;
    pdyn_sim *sim =
        test_open("{'duration': 1, 'bodies': [{'volume': {'grid': {'size': [0.4, 0.2, "
                  "0.3], 'cells': [3, 2, 2]}, 'density': 500}, 'constraints': [{'type': "
                  "'tet', 'stiffness': 2e4, 'volume_stiffness': 1e5}]}]}");
    double mass = 0.0, p[3] = {1.15, 0.85, 1.05}, expected = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) {
        mass += sim->objective.mass[i];
        for (int a = 0; a < 3; a++) sim->x[3 * i + a] *= s[a];
    }
    assert_true(fabs(mass - 500 * V) < 1e-9);
    /* damped substitution for p = s - l (p2 p3, p1 p3, p1 p2) with p1 p2 p3 = 1 */
    double l = 0.0;
    for (int k = 0; k < 2000; k++) {
        for (int a = 0; a < 3; a++)
            p[a] = 0.5 * p[a] + 0.5 * (s[a] - l * p[(a + 1) % 3] * p[(a + 2) % 3]);
        l += 0.1 * (p[0] * p[1] * p[2] - 1.0);
    }
    for (int a = 0; a < 3; a++)
        expected += 0.5 * V * (2e4 * (s[a] - 1) * (s[a] - 1) + 1e5 * (s[a] - p[a]) * (s[a] - p[a]));
    assert_true(fabs(elastic_energy(sim) - expected) <= 1e-9 * expected);
    test_close(sim);
}

/* Small strains have the energy of Hooke's law: mu sum e^2 + lambda/2 (sum e)^2 per volume. */
static void test_hooke(void **state) {
    (void)state;
    const double e[3] = {2e-4, -1e-4, 5e-5}, V = 0.4 * 0.2 * 0.3, E = 1e6, nu = 0.45;
    const double mu = E / (2.0 * (1.0 + nu)), lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    char text[512];
    snprintf(text, sizeof text,
             "{'duration': 1, 'bodies': [{'volume': {'grid': {'size': [0.4, 0.2, 0.3], 'cells': "
             "[3, 2, 2]}, 'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': %.17g, "
             "'volume_stiffness': %.17g}]}]}",
             2.0 * mu, 3.0 * lambda);
    pdyn_sim *sim = test_open(text);
    for (int k = 0; k < 3 * sim->objective.particles; k++) sim->x[k] *= 1.0 + e[k % 3];
    double sum = e[0] + e[1] + e[2];
    double expected =
        V * (mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + 0.5 * lambda * sum * sum);
    assert_true(fabs(elastic_energy(sim) - expected) <= 1e-3 * expected);
    test_close(sim);
}

/* A hanging rod is extended by rho g L^2 / 2 E, without Poisson's effect. */
static void test_rod(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open("{'duration': 100, 'time_step': {'fixed': 1}, 'frame_interval': 1, 'solver': "
                  "{'tolerance': 1e-8, 'outer_iterations': 100}, 'bodies': [{'volume': {'grid': "
                  "{'size': [0.1, 1, 0.1], 'cells': [1, 10, 1]}, 'density': 1000}, 'constraints': "
                  "[{'type': 'tet', 'stiffness': 1e6}, {'type': 'pin', 'stiffness': 1e10, "
                  "'vertices': {'box': {'minimum': [-1, 0.49, -1], 'maximum': [1, 1, 1]}}}]}]}");
    for (int k = 0; k < 60; k++) test_step(sim);
    double end = 0.0; /* mean of its four points */
    for (int i = 0; i < sim->objective.particles; i++)
        if (sim->rest[3 * i + 1] < -0.49) end += 0.25 * sim->x[3 * i + 1];
    double longer = -0.5 - end, expected = 1000 * 9.81 / (2.0 * 1e6);
    if (!(fabs(longer - expected) < 0.001 * expected))
        fail_msg("the rod is %g m longer, expected %g", longer, expected);
    test_close(sim);
}

/* ---- water hits a ball ----------------------------------------------------------------------- */

static double volume_of(const pdyn_sim *sim, const pdyn_body *body) {
    double volume = 0.0;
    for (int t = 0; t < body->tets; t++) {
        const int *c = body->tet + 4 * t;
        double side[3][3], normal[3];
        for (int k = 0; k < 9; k++)
            side[k / 3][k % 3] = sim->x[3 * (body->first + c[1 + k / 3]) + k % 3] -
                                 sim->x[3 * (body->first + c[0]) + k % 3];
        vec3_cross(normal, side[0], side[1]);
        volume += vec3_dot(normal, side[2]) / 6.0;
    }
    return volume;
}

/* Momentum lost by the water is gained by the ball, and the ball keeps its volume. */
static void test_splash_long(void **state) {
    (void)state;
    char scene[2048];
    snprintf(scene, sizeof scene,
             "{'duration': 1, 'gravity': [0, 0, 0], 'bodies': [{'name': 'water', 'particles': "
             "{'radius': 0.02, 'fill': [{'box': {'minimum': [-0.4, -0.1, -0.1], 'maximum': [-0.2, "
             "0.1, 0.1]}}]}, 'velocity': [2, 0, 0], 'constraints': [{'type': 'fluid'}]}, {'name': "
             "'ball', 'volume': {'mesh': '%s/scenes/meshes/ball.ele', 'scale': 0.15, 'density': "
             "500}, 'constraints': [{'type': 'tet', 'stiffness': 2e4, 'volume_stiffness': 5e5}]}]}",
             getenv("PROJDYN_SOURCE_ROOT"));
    pdyn_sim *sim = test_open(scene);
    const pdyn_body *ball = &sim->body[1];
    double volume = volume_of(sim, ball), mass = 0.0, momentum = 0.0, first, worst = 0.0;
    pdyn_step_info info = test_step(sim);
    first = info.momentum[0];
    while (info.time < 0.15) {
        info = test_step(sim);
        worst = fmax(worst, fabs(volume_of(sim, ball) / volume - 1.0));
    }
    for (int i = 0; i < ball->count; i++) {
        mass += ball->mass[i];
        momentum += ball->mass[i] * sim->v[3 * (ball->first + i)];
    }
    assert_true(fabs(info.momentum[0] - first) <= 1e-9 * first);
    assert_true(momentum > 0.1 * first);
    assert_true(worst < 0.01);
    assert_true(mass > 0.9 * 500 * 4.0 / 3.0 * acos(-1.0) * pow(0.15, 3) * 0.8);
    test_close(sim);
}

/* ---- files ----------------------------------------------------------------------------------- */

#define NODE "# two tetrahedra\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n"
#define ELE  "2 4 0\n1 1 2 3 4\n2 2 4 3 5\n"
#define MSH2                                                                                       \
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n"    \
    "50 1 1 1\n$EndNodes\n$Elements\n3\n1 15 2 0 1 10\n2 4 2 0 1 10 20 30 40\n3 4 2 0 1 20 40 30 " \
    "50\n$EndElements\n"
#define MSH4                                                                                       \
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 5 10 50\n0 1 0 1\n10\n0 0 0\n3 1 0 "          \
    "4\n20\n30\n"                                                                                  \
    "40\n50\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n2 3 1 3\n0 1 15 1\n1 10\n3 1 4 2\n" \
    "2 10 20 30 40\n3 20 40 30 50\n$EndElements\n"

static void check_two(const char *path) {
    pdyn_context *context = test_context(1);
    struct mesh mesh;
    struct tets tets;
    if (tets_read(context, path, &mesh, &tets) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    assert_int_equal(mesh.vertices, 5);
    assert_int_equal(tets.count, 2);
    assert_int_equal(tets_finish(context, "m", &mesh, &tets), PDYN_OK);
    assert_true(fabs(tets.volume[0] - 1.0 / 6.0) < 1e-15 &&
                fabs(tets.volume[1] - 1.0 / 3.0) < 1e-15);
    assert_int_equal(mesh.triangles, 6);
    assert_int_equal(mesh_check_closed(context, &mesh, "m"), PDYN_OK);
    tets_free(context, &tets), mesh_free(context, &mesh);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_files(void **state) {
    (void)state;
    test_write_text("two.node", NODE), test_write_text("two.ele", ELE);
    check_two("two.node"), check_two("two.ele");
    test_write_text("two.msh", MSH2), check_two("two.msh");
    test_write_text("two.msh", MSH4), check_two("two.msh");
    test_remove_file("two.node"), test_remove_file("two.ele"), test_remove_file("two.msh");
}

static void refuse(const char *path, const char *expected) {
    pdyn_context *context = test_context(1);
    struct mesh mesh;
    struct tets tets;
    pdyn_status status = tets_read(context, path, &mesh, &tets);
    if (status == PDYN_OK) status = tets_finish(context, path, &mesh, &tets);
    assert_int_not_equal(status, PDYN_OK);
    assert_error(expected);
    tets_free(context, &tets), mesh_free(context, &mesh);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    assert_true(pdyn_peak_bytes(context) < 100000);
    pdyn_destroy(context);
}

static void refuse_pair(const char *node, const char *ele, const char *expected) {
    test_write_text("bad.node", node), test_write_text("bad.ele", ele);
    refuse("bad.node", expected);
    test_remove_file("bad.node"), test_remove_file("bad.ele");
}

static void test_bad_files(void **state) {
    (void)state;
    refuse("nowhere.node", "nowhere.node: cannot open");
    refuse("mesh.obj", "ending with .node, .ele or .msh");
    refuse_pair("1000000000 3 0 0\n1 0 0 0\n", ELE, "expected a number of points");
    refuse_pair("200000000 3 0 0\n1 0 0 0\n", ELE, "cannot be in a file of 24 bytes");
    refuse_pair("5 2 0 0\n", ELE, "cannot be in a file");
    refuse_pair("# flat\n3 2 0 0\n1 0 0\n2 0 0\n3 1 1\n", ELE, "expected dimension 3");
    refuse_pair("2 3 0 0\n1 0 0 0\n7 1 0 0\n", ELE,
                "bad.node:3: expected points numbered from 0 or 1");
    refuse_pair("2 3 0 0\n1 0 0 0\n2 1 0\n", ELE, "bad.node:3: expected 3 coordinates");
    refuse_pair("1 3 0 0\n1 0 0 nan\n", ELE, "expected a finite z");
    refuse_pair(NODE, "1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n", "expected 4 corners");
    refuse_pair(NODE, "1 4 0\n1 1 2 3 6\n", "bad.ele:2: there is no vertex 6");
    refuse_pair(NODE, "1 4 0\n1 1 2 3 3\n", "uses vertex 3 twice");
    refuse_pair(NODE, "0 4 0\n", "the mesh has no tetrahedra");
    refuse_pair(NODE, "1 4 0\n1 1 2 3 4\n", "vertex 4 is used by no tetrahedron");
    refuse_pair(NODE, "3 4 0\n1 1 2 3 4\n2 1 2 3 5\n3 1 2 3 4\n", "has 3 tetrahedra");
    refuse_pair("4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n", "1 4 0\n1 1 2 3 4\n",
                "tetrahedron 0 (vertices 0, 1, 2, 3) has no volume");
    test_write_text("bad.msh", "$MeshFormat\n3 0 8\n");
    refuse("bad.msh", "bad.msh:2: expected version 2.2 or 4.1, found '3'");
    test_write_text("bad.msh", "$MeshFormat\n4.1 0 8\n$Nodes\n1 1 1 1\n3 1 0 99999999\n1\n");
    refuse("bad.msh", "cannot be in a file");
    test_write_text("bad.msh", "$MeshFormat\n4.1 1 8\n");
    refuse("bad.msh", "it is a binary file of Gmsh, expected an ASCII one: gmsh FILE.msh -save");
    test_remove_file("bad.msh");
}

/* A failing allocator gives errors without leaks, for a grid and for files. */
static void test_memory(void **state) {
    (void)state;
    char scene[1024];
    static const char form[] = "{'duration': 1, 'solver': {'type': 'cg'}, 'bodies': [{'volume': "
                               "{%s, 'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': "
                               "2e4, 'volume_stiffness': 1e5, 'damping': 0.01}]}]}";
    static const char *const shapes[] = {"'grid': {'size': [1, 1, 1], 'cells': [1, 1, 1]}",
                                         "'mesh': 'two.node'", "'mesh': 'two.msh'"};
    test_write_text("two.node", NODE), test_write_text("two.ele", ELE);
    test_write_text("two.msh", MSH4);
    for (int k = 0; k < 3; k++) {
        snprintf(scene, sizeof scene, form, shapes[k]);
        test_failing_scene(scene);
    }
    test_remove_file("two.node"), test_remove_file("two.ele"), test_remove_file("two.msh");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_svd),     cmocka_unit_test(test_conformance),
        cmocka_unit_test(test_stretch), cmocka_unit_test(test_hooke),
        cmocka_unit_test(test_rod),     cmocka_unit_test(test_splash_long),
        cmocka_unit_test(test_files),   cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_memory),  cmocka_unit_test(test_grid),
    };
    return cmocka_run_group_tests_name("tet", tests, test_enter_directory, test_leave_directory);
}
