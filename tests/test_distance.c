/* Distances of point-triangle and edge-edge pairs and their collision-free paths, against brute
 * force. */
#include "geometry/distance.h"
#include "support.h"

#include "projdyn/vec3.h"

static const struct pair_kind *const kinds[] = {&pair_vertex_face, &pair_edge_edge};

struct four {
    double x[4][3], d[4][3];
};

static void points_of(double (*a)[3], const double *out[4]) {
    for (int k = 0; k < 4; k++) out[k] = a[k];
}

static double distance_of(const struct pair_kind *kind, double (*x)[3], double c[4]) {
    const double *points[4];
    points_of(x, points);
    return sqrt(kind->closest(points, c));
}

/* Smallest distance over a lattice of weights. */
static double sampled_distance(const struct pair_kind *kind, double (*x)[3], int cuts) {
    double best = INFINITY;
    for (int i = 0; i <= cuts; i++)
        for (int j = 0; j <= cuts; j++) {
            double s = (double)i / cuts, t = (double)j / cuts, u[3] = {0};
            double face[4] = {1.0, -1.0 + s + t * (1.0 - s), -s, -t * (1.0 - s)};
            double edges[4] = {1.0 - s, s, t - 1.0, -t};
            for (int k = 0; k < 4; k++) vec3_add(u, kind->first == 1 ? face[k] : edges[k], x[k]);
            /* without fmin, with which GCC 12 for arm64 ends with an internal error */
            double distance = vec3_length(u);
            if (distance < best) best = distance;
        }
    return best;
}

/* Random pairs, some parallel, flat or degenerate. */
static struct four random_pair(uint64_t *seed, int sort) {
    struct four p;
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++) {
            p.x[k][a] = test_random(seed);
            p.d[k][a] = 2.0 * test_random(seed);
        }
    for (int k = 0; k < 4 && sort == 1; k++) p.x[k][1] = 0.0;
    for (int a = 0; a < 3; a++) {
        if (sort == 2) p.x[3][a] = p.x[2][a] + 1.5 * (p.x[1][a] - p.x[0][a]);
        if (sort == 3) p.x[3][a] = p.x[2][a];
        if (sort == 4) p.x[1][a] = p.x[2][a] = p.x[3][a];
        if (sort == 5) p.x[3][a] = 0.5 * (p.x[1][a] + p.x[2][a]);
        if (sort == 6) p.x[3][a] = p.x[2][a] - 0.7 * (p.x[1][a] - p.x[0][a]) + 2e-5 * p.d[0][a];
    }
    return p;
}

/* Smallest distance of an end of either edge from the other edge. */
static double distance_of_ends(double (*x)[3]) {
    double best = INFINITY;
    for (int end = 0; end < 4; end++) {
        const double *a = x[end < 2 ? 2 : 0], *b = x[end < 2 ? 3 : 1];
        double along[3], from[3];
        vec3_subtract(along, b, a), vec3_subtract(from, x[end], a);
        double square = vec3_dot(along, along),
               t = square > 0.0 ? vec3_dot(from, along) / square : 0.0;
        vec3_add(from, -fmin(1.0, fmax(0.0, t)), along);
        best = fmin(best, vec3_length(from));
    }
    return best;
}

static void test_distances(void **state) {
    (void)state;
    uint64_t seed = 3;
    for (int n = 0; n < 3500; n++) {
        struct four p = random_pair(&seed, n % 7);
        const struct pair_kind *kind = kinds[n / 7 % 2];
        double c[4], u[3] = {0}, first = 0.0, sum = 0.0, d = distance_of(kind, p.x, c);
        double sampled = sampled_distance(kind, p.x, 60);
        for (int k = 0; k < 4; k++) {
            vec3_add(u, c[k], p.x[k]);
            sum += c[k];
            if (k < kind->first) first += c[k];
            assert_true(k < kind->first ? c[k] >= -1e-12 : c[k] <= 1e-12);
        }
        assert_true(fabs(first - 1.0) < 1e-12 && fabs(sum) < 1e-12);
        assert_true(fabs(vec3_length(u) - d) < 1e-12);
        assert_true(d <= sampled + 1e-9 && d >= sampled - 0.06);
        if (kind == &pair_edge_edge) assert_true(d <= distance_of_ends(p.x) + 1e-12);
    }
}

/* The squared distance changes by 2 u . sum c_k dx_k under a small change dx_k of the points. */
static void test_weights(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (int n = 0; n < 200; n++) {
        struct four p = random_pair(&seed, 0), q = p;
        const struct pair_kind *kind = kinds[n % 2];
        double c[4], unused[4], u[3] = {0}, du[3] = {0}, e = 1e-6;
        double d = distance_of(kind, p.x, c);
        for (int k = 0; k < 4; k++) {
            vec3_add(u, c[k], p.x[k]);
            vec3_add(du, c[k], p.d[k]);
            vec3_add(q.x[k], e, p.d[k]);
        }
        double after = distance_of(kind, q.x, unused);
        assert_true(fabs((after * after - d * d) / e - 2.0 * vec3_dot(u, du)) < 1e-3);
    }
}

/* On the collision-free path the distance stays above 0 and is at least `keep` at the end; where
 * the path is shortened, the rest of the motion comes as close as `keep`. */
static void test_free_paths(void **state) {
    (void)state;
    uint64_t seed = 7;
    int cut = 0;
    for (int n = 0; n < 2000; n++) {
        struct four p = random_pair(&seed, n % 3), at;
        const struct pair_kind *kind = kinds[n / 3 % 2];
        const double *x[4], *d[4];
        double c[4], start = distance_of(kind, p.x, c), keep = 0.2 * start, nearest = INFINITY;
        points_of(p.x, x), points_of(p.d, d);
        if (start < 1e-3) continue;
        double t = pair_free_path(kind, x, d, keep), end = 0.0;
        assert_true(t >= 0.0 && t <= 1.0);
        for (int s = 0; s <= 200; s++) {
            at = p;
            for (int k = 0; k < 4; k++) vec3_add(at.x[k], t * s / 200.0, p.d[k]);
            end = distance_of(kind, at.x, c);
            assert_true(end > 0.0);
        }
        assert_true(end >= keep * (1.0 - 1e-9));
        if (t == 1.0) continue;
        cut++;
        for (int s = 0; s <= 2000; s++) { /* distance on the rest of the path */
            at = p;
            for (int k = 0; k < 4; k++) vec3_add(at.x[k], t + (1.0 - t) * s / 2000.0, p.d[k]);
            nearest = fmin(nearest, distance_of(kind, at.x, c));
        }
        assert_true(nearest < keep * 1.01);
    }
    assert_true(cut > 100);
}

/* A point through a triangle and an edge through an edge, at any speed. */
static void test_fast(void **state) {
    (void)state;
    for (double speed = 1e-3; speed < 1e6; speed *= 10.0)
        for (int n = 0; n < 2; n++) {
            struct four p = {{{0.3, 0.01, 0.3}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, -speed, 0}}};
            if (n) {
                const struct four edges = {{{0.3, 0.01, -1}, {0.3, 0.01, 1}, {0, 0, 0}, {1, 0, 0}},
                                           {{0, -speed, 0}, {0, -speed, 0}}};
                p = edges;
            }
            const double *x[4], *d[4];
            points_of(p.x, x), points_of(p.d, d);
            double t = pair_free_path(kinds[n], x, d, 0.001), ideal = 0.009 / speed;
            assert_true(t <= fmin(1.0, ideal) * (1.0 + 1e-9) && t >= 0.99 * fmin(1.0, ideal));
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_distances),
        cmocka_unit_test(test_weights),
        cmocka_unit_test(test_free_paths),
        cmocka_unit_test(test_fast),
    };
    return cmocka_run_group_tests_name("closest", tests, NULL, NULL);
}
