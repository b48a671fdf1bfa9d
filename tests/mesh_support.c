#include "mesh_support.h"
#include "support.h"

/* Beyond a side lies the same side of another triangle, or the border. */
static void check_across(const struct mesh *mesh, const struct topology *t) {
    int borders = 0, inside = 0;
    for (int c = 0; c < 3 * mesh->triangles; c++) {
        int other = t->across[c], sum = 0;
        borders += other < 0, inside += other >= 0;
        if (other < 0) continue;
        assert_int_equal(t->across[other], c);
        for (int k = 1; k < 3; k++)
            sum += mesh->triangle[c / 3 * 3 + (c + k) % 3] -
                   mesh->triangle[other / 3 * 3 + (other + k) % 3];
        assert_int_equal(sum, 0);
    }
    assert_int_equal(borders + inside / 2, t->edges);
}

double check_structure(const struct mesh *mesh, const struct topology *t) {
    double sum = 0.0;
    assert_int_equal(t->vertices, mesh->vertices);
    for (int e = 0; e < t->edges; e++) {
        const int *a = t->edge + 2 * e, *b = a - 2;
        assert_true(a[0] < a[1]);
        if (e) assert_true(b[0] < a[0] || (b[0] == a[0] && b[1] < a[1]));
        assert_true(t->edge_area[e] > 0);
        assert_true(isfinite(t->edge_cotan[e]));
    }
    assert_int_equal(t->ring_start[0], 0);
    assert_int_equal(t->ring_start[t->vertices], 2 * t->edges);
    for (int v = 0; v < t->vertices; v++) {
        sum += t->vertex_area[v];
        assert_true(t->ring_start[v] < t->ring_start[v + 1]);
        for (int r = t->ring_start[v]; r < t->ring_start[v + 1]; r++) {
            const int *edge = t->edge + 2 * t->ring_edge[r];
            assert_true(edge[0] == v || edge[1] == v);
            if (r > t->ring_start[v]) assert_true(t->ring_edge[r - 1] < t->ring_edge[r]);
        }
    }
    check_across(mesh, t);
    return sum;
}
