/* Neighbour lists, densities and gradients against references over all pairs in double precision.
 */
#include "support.h"

#include "geometry/compress.h"
#include "projdyn/kernel.h"
#include "scene/choices.h"
#include "sph/point_volumes.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 400, B = 150 };

/* W of the cubic spline as in Monaghan 1992. */
static double spline(double r, double H) {
    double q = r / H, k = 8.0 / (acos(-1.0) * H * H * H);
    if (q <= 0.5) return k * (6.0 * (q * q * q - q * q) + 1.0);
    return q <= 1.0 ? k * 2.0 * pow(1.0 - q, 3.0) : 0.0;
}

/* phi_3,1 of Wendland 1995, normalised to an integral of 1. */
static double wendland(double r, double H) {
    double q = r / H, k = 21.0 / (2.0 * acos(-1.0) * H * H * H);
    return q < 1.0 ? k * pow(1.0 - q, 4.0) * (4.0 * q + 1.0) : 0.0;
}

/* sum of f(r) over a cubic lattice of spacing 1 around a particle of it */
static double lattice_sum(double (*f)(double, double), double H) {
    enum { SIDE = 7 };
    double sum = 0.0;
    for (int k = 0; k < SIDE * SIDE * SIDE; k++) {
        double x[3] = {k % SIDE - 3, k / SIDE % SIDE - 3, k / SIDE / SIDE - 3};
        sum += f(vec3_length(x), H);
    }
    return sum;
}

static const struct kernel_model *model_at(int k) { return choices_entry(&kernel_choices, k); }

/* Value and slope of kernel `which` are those of the reference, over its sum in a lattice. */
static void check_kernel(int which, double (*reference)(double, double), double lattice) {
    const struct kernel_model *model = model_at(which);
    struct kernel k = kernel_make(model, 0.4);
    double dr = 1e-4;
    assert_true(fabs(lattice_sum(reference, model->support) / lattice - 1.0) < 1e-4);
    for (double r = 0.5 * dr; r < 0.4; r += dr) {
        double value = reference(r, 0.4) / lattice;
        double slope = (reference(r + 1e-7, 0.4) - reference(r - 1e-7, 0.4)) / 2e-7 / lattice;
        assert_true(fabs(kernel_value(&k, r) - value) <= 1e-12 * k.value);
        assert_true(fabs(kernel_slope(&k, r) * r - slope) <= 1e-6 * k.slope * 0.4);
    }
    assert_true(kernel_value(&k, 0.4) == 0.0 && kernel_slope(&k, 0.5) == 0.0);
}

static void test_kernel(void **state) {
    (void)state;
    double integral = 0.0, dr = 1e-4;
    struct kernel k = kernel_make(model_at(0), 0.4);
    for (double r = 0.5 * dr; r < 0.4; r += dr)
        integral += 4.0 * acos(-1.0) * r * r * kernel_value(&k, r) * dr;
    assert_true(fabs(integral - 1.0) < 1e-6);
    check_kernel(0, spline, 1.0);
    check_kernel(1, wendland, lattice_sum(wendland, 2.5));
    assert_int_equal(kernel_choices.count, 2);
}

struct cloud {
    double x[3 * N], boundary[3 * B], volume[N + B];
    bool centre[N];
};

static void fill_cloud(struct cloud *c, uint64_t seed) {
    for (int k = 0; k < 3 * N; k++) c->x[k] = 0.5 * test_random(&seed);
    for (int k = 0; k < 3 * B; k++) c->boundary[k] = 0.6 * test_random(&seed);
    for (int i = 0; i < N + B; i++) c->volume[i] = i % 10 == 9 && i < N ? 0.0 : 0.001;
    for (int i = 0; i < N; i++) c->centre[i] = i % 3 != 0 && c->volume[i] > 0.0;
}

/* Every pair within the support is listed once, particles before boundary points. */
static void check_lists(const pdyn_neighbours *l, const struct cloud *c, const double *x) {
    for (int i = 0; i < N; i++) {
        int s = l->start[i], b = l->boundary_start[i];
        for (int k = s; k < l->end[i]; k++) assert_true((l->index[k] < N) == (k < b));
        for (int j = 0; j < N + B; j++) {
            const double *y = j < N ? x + 3 * j : c->boundary + 3 * (j - N);
            bool wanted = i != j && c->volume[i] > 0.0 && c->volume[j] > 0.0 &&
                          (c->centre[i] || (j < N && c->centre[j])) &&
                          vec3_distance(x + 3 * i, y) < l->support;
            int found = 0;
            for (int k = s; k < l->end[i]; k++) found += l->index[k] == j;
            assert_true(found <= 1);
            assert_true(!wanted || found == 1);
        }
    }
}

/* Random walk of the particles while the last `moving` boundary points drift, at times by less than
 * the skin, at times by more. away: distance of a few particles from all others, m. */
static void walk(pdyn_context *context, double stride, int moving, double away) {
    struct cloud *c = malloc(sizeof *c);
    uint64_t seed = 3;
    struct neighbours *n;
    assert_non_null(c);
    fill_cloud(c, 1);
    for (int k = 0; k < 3 * 20; k++) c->x[k] += k % 2 ? away : -away;
    double *carried = c->boundary + 3 * (B - moving);
    bool wall[B];
    for (int k = 0; k < B; k++) wall[k] = k % 2;
    struct neighbours_def def = {.particles = N,
                                 .centre = c->centre,
                                 .boundary = B,
                                 .boundary_x = c->boundary,
                                 .moving = moving,
                                 .volume = c->volume,
                                 .is_wall = wall,
                                 .support = 0.2,
                                 .surface_support = 0.2,
                                 .skin = 0.02};
    assert_int_equal(neighbours_create(context, &def, &n), PDYN_OK);
    for (int move = 0; move < 40; move++) {
        if (!neighbours_are_valid(n, c->x)) assert_int_equal(neighbours_build(n, c->x), PDYN_OK);
        check_lists(neighbours_view(n), c, c->x);
        for (int k = 0; k < 3 * N; k++) c->x[k] += stride * test_random(&seed);
        for (int k = 0; k < 3 * moving; k++) carried[k] += k % 2 ? 0.0015 : -0.0015;
        if (moving) neighbours_move_boundary(n, carried);
    }
    unsigned revision = neighbours_view(n)->revision;
    assert_true(revision > 1 && revision < 40); /* some lists stay valid, some are rebuilt */
    assert_int_equal(neighbours_view(n)->boundary_revision, moving ? 40 : 0);
    c->x[7] = NAN;
    assert_false(neighbours_are_valid(n, c->x));
    assert_int_equal(neighbours_build(n, c->x), PDYN_DIVERGED);
    neighbours_free(n);
    free(c);
}

static void test_neighbours(void **state) {
    (void)state;
    pdyn_context *context = test_context(2);
    walk(context, 0.002, 0, 0.0);
    walk(context, 0.002, 90, 0.0);
    walk(context, 0.002, 90, 40.0);
    walk(context, 0.0003, 90, 0.0); /* only boundary points invalidate the lists */
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_compact(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int count = 0; count < 200; count++) {
        double *squared = malloc((size_t)count * sizeof *squared + 1);
        int *id = malloc((size_t)count * sizeof *id + 1), expected[200], found = 0;
        int *list = malloc((size_t)count * sizeof *list +
                           1); /* exact allocation, for the address sanitizer */
        assert_true(squared && id && list);
        for (int k = 0; k < count; k++) {
            squared[k] = k % 7 ? test_random(&seed) : 0.5;
            id[k] = 3 * k + 1;
            if (squared[k] < 0.5 && id[k] != 22) expected[found++] = id[k];
        }
        assert_int_equal(compress_ids(squared, id, count, 0.5, 22, list), found);
        if (found) assert_memory_equal(list, expected, (size_t)found * sizeof *list);
        free(squared), free(id), free(list);
    }
}

static void test_surface_volumes(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    double x[3 * 60], volume[60];
    uint64_t seed = 5;
    for (int k = 0; k < 180; k++) x[k] = 0.1 * test_random(&seed);
    assert_int_equal(point_volumes(context, 60, x, model_at(0), 0.08, volume), PDYN_OK);
    for (int i = 0; i < 60; i++) {
        double sum = 0.0;
        for (int j = 0; j < 60; j++) sum += spline(vec3_distance(x + 3 * i, x + 3 * j), 0.08);
        assert_true(fabs(volume[i] * sum - 1.0) < 1e-12);
    }
    pdyn_destroy(context);
}

/* W of the lists, with the density 1 in a cubic lattice */
static double density_kernel(const pdyn_neighbours *l, double r) {
    if (!l->kernel->wendland) return spline(r, l->support);
    return wendland(r, l->support) / lattice_sum(wendland, l->kernel->support);
}

static const char *block =
    "{\"duration\": 1, \"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"w\", \"particles\": "
    "{\"radius\": 0.05,"
    " \"fill\": [{\"box\": {\"minimum\": [0, 0, 0], \"maximum\": [0.6, 0.5, 0.4]}}]},"
    " \"constraints\": [{\"type\": \"fluid\"}]}],"
    " \"solids\": [{\"box\": {\"minimum\": [0, 0, 0], \"maximum\": [0.6, 0.5, 0.4]}}]}";

/* C_i over all pairs, with particle k at p + 3 k. */
static double density_error(const pdyn_sim *sim, int i, const double *p) {
    const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
    double sum = -1.0;
    for (int j = 0; j < l->points; j++) {
        const double *y = j < l->particles ? p + 3 * j : l->boundary_x + 3 * (j - l->particles);
        sum += l->volume[j] * density_kernel(l, vec3_distance(p + 3 * i, y));
    }
    return sum;
}

/* grad C_i with respect to all particles at p, over all pairs, by central differences of W. */
static void density_gradient(const pdyn_sim *sim, int i, const double *p, double *g) {
    const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
    memset(g, 0, 3 * (size_t)l->particles * sizeof *g);
    for (int j = 0; j < l->points; j++) {
        const double *y = j < l->particles ? p + 3 * j : l->boundary_x + 3 * (j - l->particles);
        double r = vec3_distance(p + 3 * i, y), dr = 1e-6 * l->support;
        if (j == i || r >= l->support) continue;
        double slope = (density_kernel(l, r + dr) - density_kernel(l, r - dr)) / (2.0 * dr);
        for (int a = 0; a < 3; a++) {
            double part = l->volume[j] * slope * (p[3 * i + a] - y[a]) / r;
            g[3 * i + a] += part;
            if (j < l->particles) g[3 * j + a] -= part;
        }
    }
}

/* k_i by definition: w over |grad C|^2 clamped to 1 to 4 times its lattice value. */
static double energy_stiffness(const struct kernel_model *model, double w, const double *g, int n,
                               double d) {
    double squares = 0.0, inside = 0.0, r[3], h = 1e-6 * d;
    struct kernel kernel = kernel_make(model, model->support * d);
    for (int k = 0; k < 125; k++) {
        for (int a = 0; a < 3; a++) r[a] = d * (k / (a == 0 ? 1 : a == 1 ? 5 : 25) % 5 - 2);
        double at = vec3_length(r),
               slope = kernel_value(&kernel, at + h) - kernel_value(&kernel, at - h);
        if (k != 62) inside += pow(slope / (2.0 * h) * d * d * d, 2.0);
    }
    for (int k = 0; k < n; k++) squares += g[k] * g[k];
    return w / fmin(fmax(squares, inside), 4.0 * inside);
}

/* Every compressed constraint has the energy k/2 C^2 and the projection u - (k / w) C grad C; the
 * others have p = u. */
static void check_energy(const char *kernel) {
    pdyn_sim *sim = test_open_with(block, &kernel, 1);
    int n = sim->objective.particles, compressed = 0;
    size_t bytes = (3 * (size_t)n + 1) * sizeof(double);
    double *x = malloc(bytes), *p = malloc(bytes), *q = malloc(bytes), *g = malloc(bytes), energy;
    double w = 1e6, sum = 0.0;
    uint64_t seed = 11;
    assert_true(x && p && q && g);
    for (int k = 0; k < 3 * n; k++) x[k] = 0.99 * sim->x[k] + 0.004 * test_random(&seed);
    sim->objective.h = 0.01;
    assert_int_equal(objective_local(&sim->objective, x, &energy, sim->gradient), PDYN_OK);
    struct batch *rows, *fluid = sim->objective.batch[0];
    assert_int_equal(batch_create_rows(fluid, &rows), PDYN_OK);
    batch_local(rows, x, sim->gradient);
    double *density = sim->density;
    fluid->type->matrix_free->density(fluid->op, density);
    for (int i = 0; i < n; i++) {
        double c = density_error(sim, i, x);
        assert_true(fabs(density[i] / 1000.0 - 1.0 - c) < 1e-12);
        memcpy(p, x, 3 * (size_t)n * sizeof *p), memcpy(q, x, 3 * (size_t)n * sizeof *q);
        for (int r = rows->view.element_row[i]; r < rows->view.element_row[i + 1]; r++)
            memcpy(p + 3 * rows->view.column[r], rows->view.p + 3 * r, 3 * sizeof *p);
        density_gradient(sim, i, x, g);
        double k =
            energy_stiffness(neighbours_view(sim->objective.neighbours)->kernel, w, g, 3 * n, 0.1);
        for (int a = 0; a < 3 * n && c > 0.0; a++) q[a] -= k / w * c * g[a];
        assert_true(test_distance(p, q, 3 * n) <= 1e-6 * fmax(0.0, c) * 0.1);
        compressed += c > 0.0, sum += c > 0.0 ? 0.5 * k * c * c : 0.0;
    }
    assert_true(compressed > n / 4 && compressed < n);
    assert_true(fabs(fluid->energy / sum - 1.0) < 1e-6 && fabs(rows->energy / sum - 1.0) < 1e-6);
    batch_free(rows);
    free(x), free(p), free(q), free(g);
    test_close(sim);
}

static void test_energy(void **state) {
    (void)state;
    check_energy("kernel=\"cubic_spline\"");
    check_energy("kernel=\"wendland\"");
}

/* Densities use the current positions of moving boundary points. */
static void test_carried_density(void **state) {
    (void)state;
    const char *const set[] = {"solids.0.motion=[{\"time\": 0}, {\"time\": 1, \"translate\": "
                               "[0.02, 0.01, 0], \"rotate\": [0, 3, 5]}]"};
    pdyn_sim *sim = test_open_with(block, set, 1);
    const struct batch *fluid = sim->objective.batch[0];
    sim->objective.h = 0.01;
    for (int k = 0; k <= 10; k++) {
        double energy;
        kinematic_move(sim, 0.1 * k);
        assert_int_equal(objective_local(&sim->objective, sim->x, &energy, sim->gradient), PDYN_OK);
        fluid->type->matrix_free->density(fluid->op, sim->density);
        for (int i = 0; i < sim->objective.particles; i++)
            assert_true(fabs(sim->density[i] / 1000.0 - 1.0 - density_error(sim, i, sim->x)) <
                        1e-12);
    }
    assert_true(neighbours_view(sim->objective.neighbours)->revision > 1);
    test_close(sim);
}

/* Sum of the densities at x + t d, each times a pressure. */
static double pressed_density(struct pdyn_sim *sim, const double *x, double t, const double *d,
                              const double *pressure) {
    const struct batch *fluid = sim->objective.batch[0];
    double energy, sum = 0.0;
    memcpy(sim->trial, x, 3 * (size_t)sim->objective.particles * sizeof *x);
    objective_axpy(&sim->objective, t, d, sim->trial);
    assert_int_equal(objective_local(&sim->objective, sim->trial, &energy, sim->trial_gradient),
                     PDYN_OK);
    fluid->type->matrix_free->density(fluid->op, sim->density);
    for (int i = 0; i < sim->objective.particles; i++) sum += pressure[i] * sim->density[i];
    return sum;
}

/* Virtual work: sum of p_i V d(rho_i / rho_0) equals the constraints' gradient times d, for any
 * displacement d. */
static void test_pressure(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(block);
    int n = sim->objective.particles;
    const struct batch *fluid = sim->objective.batch[0];
    double *x = sim->x_next, *d = sim->direction, energy, t = 1e-7;
    uint64_t seed = 5;
    for (int k = 0; k < 3 * n; k++) x[k] = 0.99 * sim->x[k] + 0.004 * test_random(&seed);
    for (int k = 0; k < 3 * n; k++) d[k] = test_random(&seed);
    memcpy(sim->objective.s, x, 3 * (size_t)n * sizeof *x); /* removes inertia from the gradient */
    sim->objective.h = 0.01;
    assert_int_equal(objective_local(&sim->objective, x, &energy, sim->gradient), PDYN_OK);
    fluid->type->matrix_free->pressure(fluid->op, sim->pressure);
    double volume = sim->objective.mass[0] / 1000.0;
    double work = volume / 1000.0 *
                  (pressed_density(sim, x, t, d, sim->pressure) -
                   pressed_density(sim, x, -t, d, sim->pressure)) /
                  (2.0 * t);
    double expected = objective_dot(&sim->objective, sim->gradient, d);
    assert_true(fabs(work / expected - 1.0) < 1e-5);
    test_close(sim);
}

/* ---- the operator ---------------------------------------------------------------------------- */

static pdyn_sim *load_block(void) {
    pdyn_sim *sim = test_open(block);
    sim->objective.h = 0.01;
    return sim;
}

/* force is the transpose of rate. */
static void test_transpose(void **state) {
    (void)state;
    pdyn_sim *sim = load_block();
    const struct batch *fluid = sim->objective.batch[0];
    const pdyn_operator *op = fluid->type->matrix_free;
    double energy, *u = sim->direction, *y = sim->trial, left = 0.0;
    uint64_t seed = 17;
    for (int k = 0; k < 3 * sim->objective.particles; k++) {
        sim->x_next[k] = 1.02 * sim->x[k] + 0.004 * test_random(&seed);
        u[k] = test_random(&seed), y[k] = 0.0;
    }
    assert_int_equal(objective_local(&sim->objective, sim->x_next, &energy, sim->gradient),
                     PDYN_OK);
    int count = op->one_sided(fluid->op).count;
    double *multiplier = malloc((size_t)count * sizeof *multiplier),
           *rate = malloc((size_t)count * sizeof *rate);
    bool *all = malloc((size_t)count * sizeof *all);
    assert_true(count == sim->objective.particles && multiplier && rate && all);
    for (int i = 0; i < count; i++) multiplier[i] = test_random(&seed), all[i] = true;
    op->rate(fluid->op, all, u, rate);
    op->force(fluid->op, multiplier, y);
    for (int i = 0; i < count; i++) left += multiplier[i] * rate[i];
    assert_true(fabs(left / objective_dot(&sim->objective, y, u) - 1.0) < 1e-10);
    free(multiplier), free(rate), free(all);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kernel),          cmocka_unit_test(test_compact),
        cmocka_unit_test(test_neighbours),      cmocka_unit_test(test_surface_volumes),
        cmocka_unit_test(test_energy),          cmocka_unit_test(test_pressure),
        cmocka_unit_test(test_carried_density), cmocka_unit_test(test_transpose),
    };
    return cmocka_run_group_tests_name("kernels", tests, NULL, NULL);
}
