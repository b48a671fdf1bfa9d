/* Points that follow tetrahedra: at rest they are where they were, and every affine motion of the
 * tetrahedra carries them, inside and outside. */
#include "support.h"

#include "geometry/embedding.h"
#include "projdyn/vec3.h"

#include <string.h>

/* The point i where the vertices at y carry it. */
static void carry(const struct embedding *e, int i, const double *y, double x[3]) {
    memset(x, 0, 3 * sizeof *x);
    for (int k = 0; k < 4; k++)
        vec3_add(x, e->weight[4 * i + k], y + 3 * (size_t)e->corner[4 * i + k]);
}

/* Stretches, shears, turns and moves. */
static void move(const double x[3], double y[3]) {
    static const double A[9] = {1.7, 0.3, -0.2, -0.6, 0.4, 0.9, 0.1, -1.1, 0.5};
    vec3_multiply(y, A, x);
    vec3_add(y, 1.0, (const double[3]){3.0, -2.0, 1.0});
}

static void assert_carried(const struct embedding *e, const struct mesh *skin,
                           const struct mesh *mesh) {
    double *moved = malloc(3 * (size_t)mesh->vertices * sizeof *moved), x[3], y[3];
    for (int i = 0; i < mesh->vertices; i++)
        move(mesh->vertex + 3 * (size_t)i, moved + 3 * (size_t)i);
    assert_int_equal(e->count, skin->vertices);
    for (int i = 0; i < e->count; i++) {
        const double *at = skin->vertex + 3 * (size_t)i;
        carry(e, i, mesh->vertex, x);
        assert_true(vec3_distance(x, at) < 1e-12);
        carry(e, i, moved, x);
        move(at, y);
        assert_true(vec3_distance(x, y) < 1e-11);
    }
    free(moved);
}

static double least_of(const double *weight) {
    return fmin(fmin(weight[0], weight[1]), fmin(weight[2], weight[3]));
}

/* A point follows the tetrahedron that it lies in, or the one in which its least coordinate is the
 * largest: compared with that of every single tetrahedron, for one point in `step`. */
static void assert_nearest(pdyn_context *context, const struct embedding *e,
                           const struct mesh *skin, const struct mesh *mesh,
                           const struct tets *tets, int step) {
    for (int i = 0; i < skin->vertices; i += step) {
        const struct mesh point = {.vertices = 1, .vertex = skin->vertex + 3 * (size_t)i};
        double best = -INFINITY;
        for (int t = 0; t < tets->count; t++) {
            const struct tets one = {.count = 1, .corner = tets->corner + 4 * (size_t)t};
            struct embedding alone;
            assert_int_equal(embedding_create(context, mesh->vertex, &one, &point, &alone),
                             PDYN_OK);
            best = fmax(best, least_of(alone.weight));
            embedding_free(context, &alone);
        }
        assert_true(least_of(e->weight + 4 * (size_t)i) > best - 1e-12);
    }
}

/* The knot, and the tetrahedra that fill it, with parts of the knot outside. */
static struct mesh read_knot(pdyn_context *context, struct mesh *mesh, struct tets *tets) {
    char path[1024];
    struct mesh skin;
    snprintf(path, sizeof path, "%s/scenes/meshes/knot.obj", getenv("PROJDYN_SOURCE_ROOT"));
    assert_int_equal(mesh_read(context, path, &skin), PDYN_OK);
    struct box box = box_around(skin.vertex, skin.vertices);
    assert_int_equal(tets_fill(context, &skin, box_extent(&box) / 24.0, mesh, tets), PDYN_OK);
    assert_int_equal(tets_finish(context, "filled", mesh, tets), PDYN_OK);
    return skin;
}

static void test_tetrahedra(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh mesh = {0};
    struct tets tets = {0};
    struct embedding e;
    struct mesh skin = read_knot(context, &mesh, &tets);
    struct box box = box_around(mesh.vertex, mesh.vertices);
    assert_int_equal(embedding_create(context, mesh.vertex, &tets, &skin, &e), PDYN_OK);
    assert_carried(&e, &skin, &mesh);
    assert_nearest(context, &e, &skin, &mesh, &tets, 50);
    for (int k = 0; k < 4 * e.count; k++) assert_true(fabs(e.weight[k]) < 4.0); /* close by */
    for (int i = 0; i < e.count; i++)
        for (int k = 0; k < 4; k++)
            assert_true(vec3_distance(skin.vertex + 3 * (size_t)i,
                                      mesh.vertex + 3 * (size_t)e.corner[4 * i + k]) <
                        box_extent(&box) / 8.0);
    embedding_free(context, &e);
    mesh_free(context, &skin), mesh_free(context, &mesh);
    tets_free(context, &tets);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* Two sheets as ears of a cube of 1 m with cells of 0.1 m, each 0.1 m wide, from its middle to 1 m
 * above it. */
static struct mesh make_ears(pdyn_context *context) {
    struct mesh ear, ears;
    assert_int_equal(
        mesh_grid(context, (const double[]){0.1, 1.5}, (const int[]){3, 31}, 0.0, &ear), PDYN_OK);
    assert_int_equal(mesh_allocate(context, 2 * ear.vertices, 2 * ear.triangles, &ears), PDYN_OK);
    for (int i = 0; i < ears.vertices; i++) {
        const double *at = ear.vertex + 3 * (i % ear.vertices);
        double *x = ears.vertex + 3 * i;
        x[0] = at[0] + (i < ear.vertices ? -0.3 : 0.3), x[1] = at[2] + 0.75;
    }
    for (int k = 0; k < 3 * ears.triangles; k++) {
        int second = k >= 3 * ear.triangles;
        ears.triangle[k] = ear.triangle[k - second * 3 * ear.triangles] + second * ear.vertices;
    }
    mesh_free(context, &ear);
    return ears;
}

/* Parts far from the tetrahedra: weights are bounded, and a part follows four vertices. */
static void test_far_parts(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh mesh, ears = make_ears(context);
    struct tets tets;
    struct embedding e;
    assert_int_equal(
        tets_grid(context, (const double[]){1, 1, 1}, (const int[]){10, 10, 10}, &mesh, &tets),
        PDYN_OK);
    assert_int_equal(embedding_create(context, mesh.vertex, &tets, &ears, &e), PDYN_OK);
    assert_carried(&e, &ears, &mesh);
    for (int i = 0; i < e.count; i++) {
        const double *w = e.weight + 4 * i;
        assert_true(fabs(w[0]) + fabs(w[1]) + fabs(w[2]) + fabs(w[3]) < 4.0);
    }
    int half = ears.vertices / 2, tip = half - 1, end = ears.vertices - 1;
    for (int i = 0; i < e.count; i++) {
        if (ears.vertex[3 * i + 1] < 0.65) continue;
        const int *of_part = e.corner + 4 * (i < half ? tip : end);
        assert_memory_equal(e.corner + 4 * i, of_part, 4 * sizeof *of_part);
    }
    assert_memory_not_equal(e.corner + 4 * tip, e.corner + 4 * end, 4 * sizeof *e.corner);
    embedding_free(context, &e);
    mesh_free(context, &ears), mesh_free(context, &mesh);
    tets_free(context, &tets);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_span(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct mesh mesh = {0};
    struct tets tets = {0};
    struct embedding e;
    int corner[4], mirrored[4];
    struct mesh skin = read_knot(context, &mesh, &tets);
    embedding_span(mesh.vertex, mesh.vertices, corner);
    const struct tets one = {.count = 1, .corner = corner};
    assert_int_equal(embedding_create(context, mesh.vertex, &one, &skin, &e), PDYN_OK);
    assert_carried(&e, &skin, &mesh);
    for (int k = 0; k < 4 * e.count; k++) assert_true(fabs(e.weight[k]) < 8.0);
    for (int i = 0; i < mesh.vertices; i++) mesh.vertex[3 * i] *= -1.0;
    embedding_span(mesh.vertex, mesh.vertices, mirrored);
    assert_memory_equal(mirrored, corner, sizeof corner);
    embedding_free(context, &e);
    mesh_free(context, &skin), mesh_free(context, &mesh);
    tets_free(context, &tets);
    pdyn_destroy(context);
}

struct made {
    pdyn_context *context;
    const struct mesh *skin, *mesh;
    const struct tets *tets;
};

static pdyn_status make(const void *what) {
    const struct made *m = what;
    struct embedding e;
    pdyn_status status = embedding_create(m->context, m->mesh->vertex, m->tets, m->skin, &e);
    if (status == PDYN_OK) embedding_free(m->context, &e);
    return status;
}

static void test_memory(void **state) {
    (void)state;
    struct counter counter;
    struct mesh mesh = {0};
    struct tets tets = {0};
    pdyn_context *context = test_counting_context(1, &counter);
    struct mesh skin = read_knot(context, &mesh, &tets);
    const struct made made = {context, &skin, &mesh, &tets};
    size_t before = pdyn_bytes_in_use(context);
    test_failing_allocations(context, &counter, make, &made);
    assert_true(pdyn_bytes_in_use(context) == before);
    mesh_free(context, &skin), mesh_free(context, &mesh);
    tets_free(context, &tets);
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_tetrahedra),
                                       cmocka_unit_test(test_far_parts),
                                       cmocka_unit_test(test_span), cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests_name("embedding", tests, NULL, NULL);
}
