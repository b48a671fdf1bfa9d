/* Primitive solids: closed, outward oriented, of the right size, and tight for water. */
#include "geometry/sampling.h"
#include "scene/primitive_mesh.h"
#include "support.h"

#include "projdyn/vec3.h"

/* Volume by the divergence theorem; positive for triangles counterclockwise from outside. */
static double volume(const struct mesh *mesh) {
    double sum = 0.0, cross[3];
    for (int t = 0; t < mesh->triangles; t++) {
        const double *c[3];
        for (int k = 0; k < 3; k++) c[k] = mesh->vertex + 3 * mesh->triangle[3 * t + k];
        vec3_cross(cross, c[1], c[2]);
        sum += vec3_dot(c[0], cross) / 6.0;
    }
    return sum;
}

static double distance_to_segment(const double *x, const double *a, const double *b) {
    double ab[3], ax[3], t;
    for (int k = 0; k < 3; k++) ab[k] = b[k] - a[k], ax[k] = x[k] - a[k];
    t = vec3_dot(ab, ab) > 0.0 ? fmin(1.0, fmax(0.0, vec3_dot(ab, ax) / vec3_dot(ab, ab))) : 0.0;
    vec3_add(ax, -t, ab);
    return vec3_length(ax);
}

/* part: least volume of the mesh over the exact one. Returns the number of triangles. */
static int check_capsule(const double from[3], const double to[3], double radius, double bump,
                         double part) {
    pdyn_context *context = test_context(1);
    struct mesh mesh;
    double pi = acos(-1.0), length = vec3_distance(from, to);
    double exact = pi * radius * radius * (4.0 / 3.0 * radius + length);
    assert_int_equal(primitive_capsule(context, from, to, radius, bump, &mesh), PDYN_OK);
    assert_int_equal(mesh_check(&mesh, "capsule"), PDYN_OK);
    assert_int_equal(mesh_check_cloth(context, &mesh, "capsule"), PDYN_OK);
    assert_int_equal(mesh_check_closed(context, &mesh, "capsule"), PDYN_OK);
    assert_true(volume(&mesh) < exact && volume(&mesh) > part * exact);
    int triangles = mesh.triangles;
    for (int i = 0; i < mesh.vertices; i++)
        assert_true(fabs(distance_to_segment(mesh.vertex + 3 * i, from, to) - radius) <
                    1e-12 * (radius + length));
    mesh_free(context, &mesh);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    return triangles;
}

static void test_capsules(void **state) {
    (void)state;
    const double at[3] = {1, 2, 3};
    check_capsule((double[]){0, 0, 0}, (double[]){0, -2, 0}, 0.5, 0.0, 0.99);
    check_capsule((double[]){0.1, 0, 0}, (double[]){1, 2, -3}, 0.01, 0.0, 0.99);
    assert_int_equal(check_capsule(at, at, 0.5, 0.0, 0.99), 3968);
    assert_int_equal(check_capsule(at, at, 0.5, 0.5 * 0.0097, 0.98), 960); /* 32 around */
    assert_int_equal(check_capsule(at, at, 0.5, 0.1, 0.96), 528);          /* 24 */
}

static void test_box(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct box box = {{-1, 0, 2}, {1, 3, 6}};
    struct mesh mesh;
    assert_int_equal(primitive_box(context, &box, 0, &mesh), PDYN_OK);
    assert_int_equal(mesh_check_closed(context, &mesh, "box"), PDYN_OK);
    assert_true(fabs(volume(&mesh) - 24.0) < 1e-12);
    mesh_free(context, &mesh);
    assert_int_equal(primitive_box(context, &box, 1u << 3, &mesh), PDYN_OK); /* without the top */
    assert_int_equal(mesh.triangles, 10);
    for (int t = 0; t < mesh.triangles; t++) {
        double low = 3.0;
        for (int k = 0; k < 3; k++) low = fmin(low, mesh.vertex[3 * mesh.triangle[3 * t + k] + 1]);
        assert_true(low == 0.0);
    }
    mesh_free(context, &mesh);
    pdyn_destroy(context);
}

/* The boundary points of a box cover its closed faces, and go past an edge where two of these meet.
 */
static void test_box_points(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    const struct box box = {{-1, 0, 2}, {1, 3, 6}};
    for (int open = 0; open < 6; open++) {
        const struct face_grid grid = {1u << open, 0.3, 0.02, 0.05};
        struct boundary_points points = {0};
        double area = 0.0, wanted = 0.0, length[3], across = 0.0;
        assert_int_equal(sample_box_surface(context, "b", &box, &grid, &points), PDYN_OK);
        for (int a = 0; a < 3; a++)
            length[a] = box.max[a] - box.min[a] + (a == open / 2 ? 0.05 : 0.1);
        for (int side = 0; side < 6; side++)
            wanted += side == open ? 0.0 : length[(side / 2 + 1) % 3] * length[(side / 2 + 2) % 3];
        for (int i = 0; i < points.at.count; i++) {
            double x = points.at.x[3 * i + open / 2];
            area += points.point[i].area;
            across = fmax(across, open % 2 ? x - box.max[open / 2] : box.min[open / 2] - x);
        }
        assert_true(fabs(area - wanted) < 1e-9 && fabs(across) < 1e-12);
        boundary_points_free(context, &points);
    }
    pdyn_destroy(context);
}

static void test_plane(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh mesh;
    double center[3] = {1, 2, 3}, normal[3] = {0, 2, 1};
    assert_int_equal(primitive_plane(context, center, normal, 4.0, &mesh), PDYN_OK);
    for (int i = 0; i < 4; i++) {
        double d[3] = {mesh.vertex[3 * i] - 1, mesh.vertex[3 * i + 1] - 2,
                       mesh.vertex[3 * i + 2] - 3};
        assert_true(fabs(vec3_dot(d, normal)) < 1e-12);
        assert_true(fabs(vec3_length(d) - sqrt(8.0)) < 1e-12);
    }
    mesh_free(context, &mesh);
    pdyn_destroy(context);
}

/* Water that falls on a solid does not get through, as with the floor of a box. */
static void test_water(void **state) {
    (void)state;
    static const char *const solids[] = {
        "{'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 1}}",
        "{'sphere': {'center': [0, -0.5, 0], 'radius': 0.5}}",
        "{'capsule': {'from': [-0.3, -0.2, 0], 'to': [0.3, -0.2, 0], 'radius': 0.2}}"};
    for (int k = 0; k < 3; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 SCENE("'duration': 0.1",
                       FLUID_BOX("", "0.02", "-0.1, 0.04, -0.1", "0.1, 0.2, 0.1", ""),
                       ", 'solids': [%s]"),
                 solids[k]);
        pdyn_sim *sim = test_open(text);
        while (pdyn_time(sim) < pdyn_duration(sim)) test_step(sim);
        pdyn_state s = pdyn_get_state(sim);
        assert_true(s.boundary > 100);
        for (int i = 0; i < s.particles; i++) {
            const double *x = s.x + 3 * i;
            double axis[3] = {k == 2 ? fmax(-0.3, fmin(0.3, x[0])) : 0.0, k == 1 ? -0.5 : -0.2, 0};
            double above = k == 0 ? x[1] : vec3_distance(x, axis) - (k == 1 ? 0.5 : 0.2);
            assert_true(above > 0.0);
        }
        test_close(sim);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_capsules),   cmocka_unit_test(test_box),
        cmocka_unit_test(test_box_points), cmocka_unit_test(test_plane),
        cmocka_unit_test(test_water),
    };
    return cmocka_run_group_tests_name("shape", tests, NULL, NULL);
}
