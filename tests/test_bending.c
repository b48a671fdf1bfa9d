/* Bending: second derivatives on irregular meshes, plate energy, curved rest shapes. */
#include "support.h"

#include "../src/constraints/frame.h"
#include "../src/constraints/plate.h"
#include "geometry/mesh.h"

#include "projdyn/vec3.h"

#include <string.h>

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

enum { N = 9, VERTICES = N * N, TRIANGLES = 2 * (N - 1) * (N - 1) };

struct sheet { /* grid of cells of edge 1 in the x-y plane */
    struct mesh mesh;
    struct topology topology;
    pdyn_body body;
    double vertex[3 * VERTICES], turned[3 * VERTICES];
    int triangle[3 * TRIANGLES];
};

/* A grid with vertices moved off their lattice by up to `off` and random diagonals, rotated in
 * space. */
static void make_sheet(pdyn_context *context, struct sheet *s, double off) {
    uint64_t seed = 3;
    int *t = s->triangle;
    static const double axes[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6};
    for (int v = 0; v < VERTICES; v++) {
        double *x = s->vertex + 3 * v;
        x[0] = v % N + off * test_random(&seed), x[1] = v / N + off * test_random(&seed), x[2] = 0;
        vec3_multiply(s->turned + 3 * v, axes, x);
    }
    for (int c = 0; c < (N - 1) * (N - 1); c++, t += 6) {
        int a = c / (N - 1) * N + c % (N - 1), b = a + 1, d = a + N, e = d + 1;
        if (test_random(&seed) < 0.0) memcpy(t, (int[]){a, b, d, e, d, b}, 6 * sizeof *t);
        else memcpy(t, (int[]){a, b, e, a, e, d}, 6 * sizeof *t);
    }
    s->mesh = (struct mesh){VERTICES, s->turned, TRIANGLES, s->triangle};
    assert_int_equal(topology_build(context, &s->mesh, &s->topology), PDYN_OK);
    s->body = (pdyn_body){.count = VERTICES,
                          .rest = s->turned,
                          .triangles = TRIANGLES,
                          .triangle = s->triangle,
                          .across = s->topology.across,
                          .triangle_area = s->topology.triangle_area};
}

/* Value of the row for a function of the vertices. */
static double value(const struct plate *plate, int row, const double *f) {
    double sum = 0.0;
    for (int i = 0; i < plate->nodes; i++) sum += plate->coefficient[row][i] * f[plate->node[i]];
    return sum;
}

/* True for a triangle that is not at the border, nor its neighbours: there slopes are less exact.
 */
static bool is_inside(const struct sheet *s, int t) {
    for (int c = 3 * t; c < 3 * t + 3; c++) {
        int beyond = s->body.across[c];
        if (beyond < 0) return false;
        for (int k = 1; k < 3; k++)
            if (s->body.across[beyond / 3 * 3 + (beyond + k) % 3] < 0) return false;
    }
    return true;
}

/* The second derivatives of a quadratic are exact on every mesh; those of a linear function are 0,
 * also at borders. */
static void test_quadratics(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct sheet s;
    int inside = 0;
    make_sheet(context, &s, 0.2);
    for (int which = 0; which < 4; which++) {
        static const double hessian[4][3] = {{2, 0, 0}, {0, 1, 0}, {0, 0, 2}, {0, 0, 0}};
        double f[VERTICES];
        for (int v = 0; v < VERTICES; v++) {
            double x = s.vertex[3 * v], y = s.vertex[3 * v + 1];
            f[v] = (double[]){x * x, x * y, y * y, 3 * x - y + 5}[which];
        }
        const double *h = hessian[which];
        for (int t = 0; t < TRIANGLES; t++) {
            struct plate plate;
            if (which < 3 && !is_inside(&s, t)) continue;
            plate_hessian(&s.body, t, &plate);
            double row[3], area = s.body.triangle_area[t];
            for (int r = 0; r < 3; r++) row[r] = value(&plate, r, f) / area;
            assert_near(row[0] + row[2], h[0] + h[2], 1e-7);
            assert_near(vec3_dot(row, row), h[0] * h[0] + 2 * h[1] * h[1] + h[2] * h[2], 1e-6);
            assert_true(plate.curvature == 0.0);
            inside++;
        }
    }
    assert_true(inside > TRIANGLES);
    topology_free(context, &s.topology);
    pdyn_destroy(context);
}

/* A triangle at a border has no curvature across the border, whatever the function is: the slope
 * there is the one that minimises the Hessian. */
static void test_borders(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct sheet s;
    uint64_t seed = 7;
    double f[VERTICES], size = 0.0;
    int borders = 0;
    make_sheet(context, &s, 0.2);
    for (int v = 0; v < VERTICES; v++) f[v] = test_random(&seed);
    for (int c = 0; c < 3 * TRIANGLES; c++) {
        struct frame frame = frame_of(&s.body, c / 3);
        struct plate plate;
        double *n = frame.outward[c % 3], row[3];
        if (s.body.across[c] >= 0) continue;
        plate_hessian(&s.body, c / 3, &plate);
        for (int r = 0; r < 3; r++) row[r] = value(&plate, r, f);
        double across =
            n[0] * n[0] * row[0] + sqrt(2.0) * n[0] * n[1] * row[1] + n[1] * n[1] * row[2];
        assert_near(across, 0.0, 1e-9);
        size = fmax(size, vec3_length(row)), borders++;
    }
    assert_true(borders == 4 * (N - 1) && size > 0.1);
    topology_free(context, &s.topology);
    pdyn_destroy(context);
}

/* The mean of the second derivatives of any function that vanishes near the border is 0: no pattern
 * of the mesh softens a smooth bend. */
static void test_mean(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    struct sheet s;
    uint64_t seed = 5;
    double f[VERTICES] = {0}, sum = 0.0, scale = 0.0;
    make_sheet(context, &s, 0.2);
    for (int v = 0; v < VERTICES; v++)
        if (v % N > 2 && v % N < N - 3 && v / N > 2 && v / N < N - 3) f[v] = test_random(&seed);
    for (int t = 0; t < TRIANGLES; t++) {
        struct plate plate;
        plate_hessian(&s.body, t, &plate);
        sum += value(&plate, 0, f) + value(&plate, 2, f);
        scale += fabs(value(&plate, 0, f));
    }
    assert_true(scale > 1.0);
    assert_near(sum, 0.0, 1e-8 * scale);
    topology_free(context, &s.topology);
    pdyn_destroy(context);
}

/* ---- curved rest shapes ---------------------------------------------------------------------- */

enum { AROUND = 16, ALONG = 6 };

/* A third of a cylinder of radius 1 m with bending rigidity 3 N m. */
static pdyn_sim *load_cylinder(void) {
    FILE *file = fopen("cylinder.obj", "w");
    double turn = 2.0 * acos(-1.0) / 3.0 / AROUND;
    for (int i = 0; i <= AROUND; i++)
        for (int j = 0; j <= ALONG; j++)
            fprintf(file, "v %.17g %.17g %.17g\n", cos(i * turn), sin(i * turn), j * turn);
    for (int i = 0; i < AROUND; i++)
        for (int j = 0; j < ALONG; j++) {
            int a = i * (ALONG + 1) + j + 1, b = a + ALONG + 1;
            if ((i + j) % 2) fprintf(file, "f %d %d %d %d\n", a, b, b + 1, a + 1);
            else fprintf(file, "f %d %d %d %d\n", b, b + 1, a + 1, a);
        }
    assert_int_equal(fclose(file), 0);
    pdyn_sim *sim =
        test_open("{'duration': 1, 'bodies': [{'surface': {'mesh': 'cylinder.obj', 'area_density': "
                  "1}, 'constraints': [{'type': 'bending', 'bending_rigidity': 3}]}]}");
    test_remove_file("cylinder.obj");
    return sim;
}

static double bending_energy(pdyn_sim *sim, const double *x) {
    double energy, gradient[3 * (AROUND + 1) * (ALONG + 1) + 1] = {0};
    assert_int_equal(objective_local(&sim->objective, x, &energy, gradient), PDYN_OK);
    return sim->objective.batch[0]->energy;
}

/* The rest shape has energy 0 at any place and orientation; unrolled it has the energy of its
 * curvature, and curled to twice the curvature the same. */
static void test_curved_rest(void **state) {
    (void)state;
    pdyn_sim *sim = load_cylinder();
    static const double axes[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6};
    double moved[3 * (AROUND + 1) * (ALONG + 1) + 1], turn = 2.0 * acos(-1.0) / 3.0 / AROUND;
    double area = AROUND * ALONG * turn * turn, expected = 1.5 * area;
    for (int v = 0; v < sim->objective.particles; v++)
        vec3_multiply(moved + 3 * v, axes, sim->x + 3 * v);
    sim->objective.h = 1.0;
    assert_true(bending_energy(sim, sim->x) < 1e-14 * expected);
    assert_true(bending_energy(sim, moved) < 1e-14 * expected);
    for (int v = 0; v < sim->objective.particles; v++) {
        double arc = v / (ALONG + 1) * turn;
        memcpy(moved + 3 * v, (double[]){arc, 0.0, sim->x[3 * v + 2]}, 3 * sizeof *moved);
    }
    assert_near(bending_energy(sim, moved) / expected, 1.0, 0.15);
    for (int v = 0; v < sim->objective.particles; v++) {
        double arc = v / (ALONG + 1) * turn;
        memcpy(moved + 3 * v,
               (double[]){0.5 * cos(2.0 * arc), 0.5 * sin(2.0 * arc), sim->x[3 * v + 2]},
               3 * sizeof *moved);
    }
    assert_near(bending_energy(sim, moved) / expected, 1.0, 0.15);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quadratics),
        cmocka_unit_test(test_borders),
        cmocka_unit_test(test_mean),
        cmocka_unit_test(test_curved_rest),
    };
    return cmocka_run_group_tests_name("bending", tests, test_enter_directory,
                                       test_leave_directory);
}
