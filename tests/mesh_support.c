#include "mesh_support.h"
#include "support.h"

/* across is symmetric: beyond each side lies the same side of another triangle, or the border. */
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
        assert_true(t->edge_share[e] > 0);
    }
    for (int v = 0; v < t->vertices; v++) sum += t->vertex_area[v];
    check_across(mesh, t);
    return sum;
}
