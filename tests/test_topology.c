/* Grids, and the topology of meshes: edges, areas, borders. */
#include "mesh_support.h"
#include "support.h"

#include "projdyn/vec3.h"

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static pdyn_context *context;

static int set_up(void **state) {
    (void)state;
    context = test_context(1);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    pdyn_destroy(context);
    return 0;
}

/* ---- grids ----------------------------------------------------------------------------------- */

static double triangle_area(const struct mesh *mesh, int t, double normal[3]) {
    const double *p[3];
    for (int k = 0; k < 3; k++) p[k] = mesh->vertex + 3 * mesh->triangle[3 * t + k];
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        normal[k] = 0.5 * ((p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) -
                           (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]));
    }
    return vec3_length(normal);
}

static void test_grid(void **state) {
    (void)state;
    struct mesh mesh;
    size_t before = pdyn_bytes_in_use(context);
    assert_int_equal(mesh_grid(context, (double[]){3, 2}, (int[]){7, 4}, 0.0, &mesh), PDYN_OK);
    assert_int_equal(mesh.vertices, 28);
    assert_int_equal(mesh.triangles, 36);
    assert_int_equal(mesh_check(&mesh, "grid"), PDYN_OK);
    assert_int_equal(mesh_check_cloth(context, &mesh, "grid"), PDYN_OK);
    static const double corners[4][3] = {{-1.5, 0, -1}, {1.5, 0, -1}, {-1.5, 0, 1}, {1.5, 0, 1}};
    for (int k = 0; k < 4; k++)
        assert_memory_equal(mesh.vertex + 3 * (k / 2 * 21 + k % 2 * 6), corners[k],
                            sizeof corners[k]);
    for (int t = 0; t < mesh.triangles; t++) {
        double normal[3], area = triangle_area(&mesh, t, normal);
        assert_near(area, 6.0 / 36, 1e-14);
        assert_near(normal[1], area, 1e-14); /* the normal points up */
    }
    /* diagonals alternate: every second inner vertex has four of them */
    int at[2] = {0};
    for (int i = 0; i < 3 * mesh.triangles; i++)
        at[0] += mesh.triangle[i] == 8, at[1] += mesh.triangle[i] == 9;
    assert_int_equal(at[0], 8);
    assert_int_equal(at[1], 4);
    mesh_free(context, &mesh);
    /* a sheet that sags: its border stays, its middle and quarter lie on parabolas */
    assert_int_equal(mesh_grid(context, (double[]){2, 2}, (int[]){5, 5}, 0.4, &mesh), PDYN_OK);
    for (int i = 0; i < mesh.vertices; i++) {
        const double *x = mesh.vertex + 3 * i;
        assert_near(x[1], -0.4 * (1 - x[0] * x[0]) * (1 - x[2] * x[2]), 1e-15);
    }
    mesh_free(context, &mesh);
    assert_int_equal(pdyn_bytes_in_use(context), before);
}

static void expect_bad_grid(double width, double height, int columns, int rows,
                            const char *message) {
    struct mesh mesh;
    assert_int_equal(
        mesh_grid(context, (double[]){width, height}, (int[]){columns, rows}, 0.0, &mesh),
        PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), message);
}

static void test_bad_grid(void **state) {
    (void)state;
    const char *size = "grid: expected sizes above 0 and of at most 1e+12 m, found ";
    char message[200];
    snprintf(message, sizeof message, "%s0", size);
    expect_bad_grid(1, 0, 3, 3, message);
    snprintf(message, sizeof message, "%sinf", size);
    expect_bad_grid((double)INFINITY, 1, 3, 3, message);
    expect_bad_grid(1, 1, 3, 1, "grid: expected at least 2 vertices along each side, found 1");
    expect_bad_grid(1, 1, 100000, 100000,
                    "grid: expected at most 134217727 vertices, found 100000 x 100000");
}

/* ---- topology -------------------------------------------------------------------------------- */

static void test_topology_grid(void **state) {
    (void)state;
    enum { COLUMNS = 9, ROWS = 7, VERTICES = COLUMNS * ROWS };
    const double width = 4.0, height = 1.5, cell = width / (COLUMNS - 1) * (height / (ROWS - 1));
    struct mesh mesh;
    struct topology t;
    size_t before = pdyn_bytes_in_use(context);
    assert_int_equal(
        mesh_grid(context, (double[]){width, height}, (int[]){COLUMNS, ROWS}, 0.0, &mesh), PDYN_OK);
    assert_int_equal(topology_build(context, &mesh, &t), PDYN_OK);
    assert_int_equal(t.vertices - t.edges + mesh.triangles, 1); /* Euler characteristic of a disc */
    assert_near(check_structure(&mesh, &t), width * height, 1e-12);
    double a = width / (COLUMNS - 1), b = height / (ROWS - 1), sum = 0.0;
    for (int e = 0; e < t.edges; e++) sum += t.edge_share[e];
    assert_near(sum, 3 * mesh.triangles * 0.5 * cell / (2 * (a * a + b * b)), 1e-12);
    for (int v = 0; v < VERTICES; v++) {
        int i = v % COLUMNS, j = v / COLUMNS;
        bool border = !i || !j || i == COLUMNS - 1 || j == ROWS - 1;
        assert_int_equal(t.on_border[v], border);
    }
    topology_free(context, &t);
    assert_null(t.edge);
    mesh_free(context, &mesh);
    assert_int_equal(pdyn_bytes_in_use(context), before);
}

static void test_topology_tetrahedron(void **state) {
    (void)state;
    static double vertex[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
    static int triangle[12] = {3, 1, 2, 0, 3, 2, 0, 1, 3, 0, 2, 1};
    static const int edges[12] = {0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3};
    struct mesh mesh = {4, vertex, 4, triangle};
    struct topology t;
    assert_int_equal(mesh_check_cloth(context, &mesh, "tetrahedron"), PDYN_OK);
    assert_int_equal(topology_build(context, &mesh, &t), PDYN_OK);
    assert_int_equal(t.edges, 6);
    assert_memory_equal(t.edge, edges, sizeof edges);
    double face = sqrt(3.0) / 4 * 8; /* edges of length sqrt(8) */
    assert_near(check_structure(&mesh, &t), 4 * face, 1e-12);
    for (int v = 0; v < 4; v++) {
        assert_false(t.on_border[v]);
        assert_near(t.vertex_area[v], face, 1e-12);
    }
    for (int e = 0; e < 6; e++) {
        assert_near(t.edge_share[e], 2 * face / (3 * 8), 1e-12);
    }
    topology_free(context, &t);
}

/* One triangle has three border sides. */
static void test_topology_triangle(void **state) {
    (void)state;
    static double vertex[9] = {0, 0, 0, 4, 0, 0, 1, 1, 0};
    static int triangle[3] = {0, 1, 2};
    struct mesh mesh = {3, vertex, 1, triangle};
    struct topology t;
    assert_int_equal(topology_build(context, &mesh, &t), PDYN_OK);
    assert_near(check_structure(&mesh, &t), 2, 1e-14);
    for (int e = 0; e < 3; e++) {
        assert_near(t.edge_share[e], 2.0 / (16 + 2 + 10), 1e-14);
        assert_true(t.on_border[e]);
    }
    topology_free(context, &t);
}

/* Two triangles of a square: joined, and with vertices of their own along the seam. A third
 * triangle on the diagonal leaves it inside. */
static void test_find_border(void **state) {
    (void)state;
    double vertex[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1};
    int joined[] = {0, 1, 2, 0, 2, 3}, split[] = {0, 1, 2, 4, 5, 3},
        three[] = {0, 1, 2, 0, 2, 3, 0, 2, 6};
    static const int around[9] = {-1, 0, -1, -1, -1, 0, -1, -1, 0};
    const struct mesh mesh[] = {
        {7, vertex, 2, joined}, {7, vertex, 2, split}, {7, vertex, 3, three}};
    for (int m = 0; m < 3; m++) {
        int across[9];
        assert_int_equal(mesh_find_border(context, &mesh[m], across), PDYN_OK);
        assert_memory_equal(across, around, sizeof(int) * 3 * (size_t)mesh[m].triangles);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),
        cmocka_unit_test(test_bad_grid),
        cmocka_unit_test(test_topology_grid),
        cmocka_unit_test(test_topology_tetrahedron),
        cmocka_unit_test(test_topology_triangle),
        cmocka_unit_test(test_find_border),
    };
    return cmocka_run_group_tests_name("topology", tests, set_up, tear_down);
}
