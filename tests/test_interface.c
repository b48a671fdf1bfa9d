/* The interface of water with solids and sheets: surface kernel, areas of points, rest at walls,
 * water displaced by a sheet. */
#include "support.h"

#include "geometry/sampling.h"
#include "projdyn/kernel.h"
#include "scene/choices.h"
#include "sph/boundary.h"

#include "projdyn/vec3.h"

#include <string.h>
#include <time.h>

static const double d = 0.1; /* particle spacing, m */

static const struct kernel_model *model_at(int k) { return choices_entry(&kernel_choices, k); }

/* lambda(z) = A (1 - q/s)^4, q^2 = z^2 + (s/10)^2. */
static double plane_of(const struct kernel_model *model, double z) {
    double s = model->reach * d;
    return model->surface * pow(1.0 - sqrt(z * z + 0.01 * s * s) / s, 4.0);
}

/* A plane's sum is lambda(z), its slope the derivative, and surface_kernel_distance is its inverse.
 */
static void check_kernel(const struct kernel_model *model) {
    struct surface_kernel kernel = surface_kernel_make(model, d);
    double s = model->reach * d;
    for (double z = 0.01 * d; z < 0.99 * s; z += 0.049 * d) {
        double sum = 0.0, dr = 1e-4 * d;
        for (double r = 0.5 * dr; r < s; r += dr) /* number of rings; areas times d */
            sum += surface_kernel_value(&kernel, z * z + r * r) * 2.0 * acos(-1.0) * r * dr * d;
        assert_true(fabs(sum - plane_of(model, z)) < 1e-4 * plane_of(model, 0.0));
        double up = surface_kernel_value(&kernel, (z + 1e-6) * (z + 1e-6));
        double down = surface_kernel_value(&kernel, (z - 1e-6) * (z - 1e-6));
        double slope = surface_kernel_slope(&kernel, z * z) * z;
        assert_true(fabs((up - down) / 2e-6 / slope - 1.0) < 1e-5);
        assert_true(fabs(surface_kernel_distance(&kernel, plane_of(model, z)) - z) < 1e-9 * d);
    }
    assert_true(surface_kernel_value(&kernel, s * s) == 0.0);
    double by = 0.1, near = plane_of(model, 0.5 * d), far = plane_of(model, 0.6 * d);
    assert_true(fabs(pow(surface_kernel_farther(model, by), 2.0) * far / near - 1.0) < 1e-12);
    assert_true(fabs(near / model->half_areas - 1.0) < 0.01);
}

static void test_kernel(void **state) {
    (void)state;
    for (int k = 0; k < kernel_choices.count; k++) check_kernel(model_at(k));
}

struct plane_sum { /* what sample points add at places at one height, relative to lambda */
    double mean, spread, least; /* spread: standard deviation */
};

/* The points x with areas lie on a square of 2 m. */
static struct plane_sum sum_over(const struct kernel_model *model, int count, const double *x,
                                 const double *area, double height) {
    struct surface_kernel kernel = surface_kernel_make(model, d);
    struct plane_sum s = {.least = INFINITY};
    double squares = 0.0;
    uint64_t seed = 11;
    enum { PLACES = 2000 };
    for (int n = 0; n < PLACES; n++) {
        double at[3] = {1.0 + 0.7 * test_random(&seed), height, 1.0 + 0.7 * test_random(&seed)};
        double all = 0.0;
        for (int k = 0; k < count; k++) {
            double r = vec3_distance(at, x + 3 * k);
            all += area[k] * d * surface_kernel_value(&kernel, r * r) / plane_of(model, height);
        }
        s.mean += all / PLACES, squares += all * all / PLACES, s.least = fmin(s.least, all);
    }
    s.spread = sqrt(squares - s.mean * s.mean);
    return s;
}

/* Nowhere above the plane does the sum bound its distance by more than the distance. */
static void check_distance(const struct kernel_model *model, int count, const double *x,
                           const double *area) {
    struct surface_kernel kernel = surface_kernel_make(model, d);
    double largest = 0.0;
    for (double z = 0.02 * d; z < 0.6 * d; z += 0.04 * d) {
        double least = sum_over(model, count, x, area, z).least * plane_of(model, z);
        largest = fmax(largest, surface_kernel_least_distance(&kernel, least, d) / z);
    }
    print_message("%s: least distance at most %.3f of the distance\n", model->name, largest);
    assert_true(largest <= 1.0);
}

/* With either kernel, a plane's sum over points with areas is nearly constant. On the surface it
 * exceeds 1 - W(0), at which a particle alone is compressed, at every place: there is no hole to
 * pass through. */
static void check_sums(const struct kernel_model *model, int count, const double *x,
                       const double *area) {
    struct plane_sum at_rest = sum_over(model, count, x, area, 0.5 * d),
                     touching = sum_over(model, count, x, area, 0.0);
    double alone = 1.0 - kernel_make(model, model->support).value,
           least = touching.least * plane_of(model, 0.0);
    print_message("%s: a plane's sum over points is %.4f of lambda, +- %.4f; on the surface at "
                  "least %.2f, a particle alone is compressed by %.2f\n",
                  model->name, at_rest.mean, at_rest.spread, least, alone);
    assert_true(fabs(at_rest.mean - 1.0) < 0.01 && at_rest.spread < 0.03);
    assert_true(least > fmax(0.85, alone + 0.1));
    check_distance(model, count, x, area);
}

/* The areas of the points of a square of 2 m x 2 m sum to its area. Memory is spent on points, not
 * on places to choose from. */
static void check_areas(const struct mesh *mesh) {
    pdyn_context *context = test_context(1);
    struct surface_points points = {0};
    const struct boundary_model *model = choices_entry(&boundary_choices, 0);
    assert_int_equal(sample_triangles(context, "sheet", mesh, model->mesh_spacing * d, &points),
                     PDYN_OK);
    assert_in_range(pdyn_peak_bytes(context) / (size_t)points.count, 0, 512);
    double *x = malloc(3 * (size_t)points.count * sizeof *x),
           *area = malloc((size_t)points.count * sizeof *area);
    double all = 0.0;
    assert_true(x && area);
    for (int k = 0; k < points.count; k++) {
        surface_point_position(&points.point[k], mesh, x + 3 * k);
        all += area[k] = points.point[k].area;
    }
    assert_true(fabs(all - 4.0) < 1e-9);
    for (int k = 0; k < kernel_choices.count; k++) check_sums(model_at(k), points.count, x, area);
    free(x), free(area);
    surface_points_free(context, &points);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* Strips of two triangles each. */
static void check_strips(int strips) {
    enum { STRIPS = 40 };
    double vertex[6 * (STRIPS + 1)];
    int triangle[6 * STRIPS];
    for (int k = 0; k < 2 * (strips + 1); k++) {
        const double at[3] = {k % 2 ? 2.0 : 0.0, 0.0, k / 2 * 2.0 / strips};
        memcpy(vertex + 3 * k, at, sizeof at);
    }
    for (int k = 0; k < strips; k++) {
        const int corner[6] = {2 * k, 2 * k + 1, 2 * k + 3, 2 * k, 2 * k + 3, 2 * k + 2};
        memcpy(triangle + 6 * k, corner, sizeof corner);
    }
    check_areas(&(struct mesh){2 * (strips + 1), vertex, 2 * strips, triangle});
}

static void test_areas(void **state) {
    (void)state;
    check_strips(1);
    check_strips(40); /* long triangles */
}

/* The end of a cylinder of a drawing program: all triangles meet in the middle. */
static void test_fan(void **state) {
    (void)state;
    enum { SIDE = 30, RIM = 4 * SIDE };
    double vertex[3 * (RIM + 1)] = {1.0, 0.0, 1.0};
    int triangle[3 * RIM];
    for (int k = 0; k < RIM; k++) {
        double along = 2.0 * (k % SIDE) / SIDE;
        const double side[4][3] = {
            {along, 0, 0}, {2, 0, along}, {2 - along, 0, 2}, {0, 0, 2 - along}};
        const int corner[3] = {0, 1 + k, 1 + (k + 1) % RIM};
        memcpy(vertex + 3 * (k + 1), side[k / SIDE], sizeof side[0]);
        memcpy(triangle + 3 * k, corner, sizeof corner);
    }
    check_areas(&(struct mesh){RIM + 1, vertex, RIM, triangle});
}

static pdyn_status sample_sliver(const double vertex[9], double spacing) {
    int triangle[] = {0, 1, 2};
    const struct mesh mesh = {3, (double *)vertex, 1, triangle};
    pdyn_context *context = test_context(1);
    struct surface_points points = {0};
    pdyn_status status = sample_triangles(context, "sliver", &mesh, spacing, &points);
    surface_points_free(context, &points);
    pdyn_destroy(context);
    return status;
}

/* A triangle of 1000 km x 1 mm, and one where the middle of a side is rounded to its end: refused,
 * at once. */
static void test_huge_slivers(void **state) {
    (void)state;
    const double far = 1e12, near = 1e12 + 0x1p-13; /* the next number */
    clock_t start = clock();
    assert_int_equal(sample_sliver((const double[]){0, 0, 0, 1e6, 0, 0, 1e6, 0, 1e-3}, 0.01),
                     PDYN_BAD_INPUT);
    assert_int_not_equal(sample_sliver((const double[]){far, 0, 0, near, 0, 0, far, 1e-6, 0}, 1e-5),
                         PDYN_OK);
    assert_true((double)(clock() - start) < 10.0 * CLOCKS_PER_SEC);
}

/* The cost of a ribbon is that of its area and sides, and its points cover it. */
static void test_ribbon(void **state) {
    (void)state;
    const double spacing = 0.01, length = 40.0, width = 0.02;
    double vertex[] = {0, 0, 0, length, 0, 0, length, 0, width, 0, 0, width};
    int triangle[] = {1, 2, 0, 3, 0, 2};
    const struct mesh mesh = {4, vertex, 2, triangle};
    pdyn_context *context = test_context(1);
    struct surface_points points = {0};
    assert_int_equal(sample_triangles(context, "ribbon", &mesh, spacing, &points), PDYN_OK);
    assert_in_range(pdyn_peak_bytes(context), 0, 64 << 20);
    double *x = malloc(3 * (size_t)points.count * sizeof *x), all = 0.0, least = INFINITY;
    assert_non_null(x);
    for (int k = 0; k < points.count; k++) {
        surface_point_position(&points.point[k], &mesh, x + 3 * k);
        all += points.point[k].area;
        for (int m = 0; m < k; m++) least = fmin(least, vec3_distance(x + 3 * k, x + 3 * m));
    }
    assert_true(fabs(all - length * width) < 1e-9);
    assert_true(least > 0.75 * spacing * (1.0 - 1e-12));
    uint64_t seed = 5;
    for (int n = 0; n < 1000; n++) {
        const double at[3] = {0.5 * length * (1.0 + test_random(&seed)), 0.0,
                              0.5 * width * (1.0 + test_random(&seed))};
        double nearest = INFINITY;
        for (int k = 0; k < points.count; k++)
            nearest = fmin(nearest, vec3_distance(at, x + 3 * k));
        assert_true(nearest < 1.1 * spacing);
    }
    free(x);
    surface_points_free(context, &points);
    pdyn_destroy(context);
}

/* A surface that is too large is refused before memory is spent. */
static void test_large_surface(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    const char *scene =
        SCENE("'duration': 1", FLUID_BOX("", "0.001", "0, 0, 0", "0.01, 0.01, 0.01", ""),
              ", 'solids': [{'name': 'sea', 'plane': {'center': [0, 0, 0], "
              "'normal': [0, 1, 0], 'size': 10}}]");
    assert_int_equal(pdyn_load_text(context, quoted(scene), "test", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_error("a side of \"sea\" has ");
    assert_in_range(pdyn_peak_bytes(context), 0, 1 << 20);
    pdyn_destroy(context);
}

/* The energy of compressed water is the sum over its particles, in several parallel blocks. */
static void assert_energy(pdyn_sim *sim) {
    struct batch *fluid = sim->objective.batch[0];
    double energy, sum = 0.0;
    for (int k = 0; k < 3 * sim->objective.particles; k++) sim->x_next[k] = 0.98 * sim->x[k];
    assert_int_equal(objective_local(&sim->objective, sim->x_next, &energy, sim->gradient),
                     PDYN_OK);
    pdyn_one_sided at = fluid->type->matrix_free->one_sided(fluid->op);
    for (int i = 0; i < at.count; i++)
        sum += 0.5 * at.stiffness[i] * fmax(0.0, at.value[i]) * fmax(0.0, at.value[i]);
    assert_true(sum > 0.0 && fabs(fluid->energy / sum - 1.0) < 1e-12);
}

/* A lattice of particles that touches the walls of a box is at rest. */
static void check_lattice(const char *kernel) {
    const char *scene =
        SCENE("'duration': 1", FLUID_BOX("", "0.05", "0, 0, 0", "0.8, 0.8, 0.8", ""),
              ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.8, 0.8, 0.8]}}]");
    double energy;
    pdyn_sim *sim = test_open_with(scene, &kernel, 1);
    sim->objective.h = 0.01;
    assert_int_equal(objective_local(&sim->objective, sim->x, &energy, sim->gradient), PDYN_OK);
    sim->objective.batch[0]->type->matrix_free->density(sim->objective.batch[0]->op, sim->density);
    for (int i = 0; i < sim->objective.particles; i++)
        assert_true(sim->density[i] > 990.0 && sim->density[i] < 1001.0);
    assert_energy(sim);
    test_close(sim);
}

static void test_lattice(void **state) {
    (void)state;
    check_lattice("kernel=\"cubic_spline\"");
    check_lattice("kernel=\"wendland\"");
}

static const char held[] = SCENE(
    "'duration': 10, 'time_step': {'maximum': 0.005}, 'solver': {'outer_iterations': 40}%s",
    PAIR(FLUID_BOX("", "0.01", "0, 0, 0", "0.24, 0.2, 0.24",
                   ", 'compression': 0.002, 'viscosity': 0.3"),
         GRID_SHEET("", "0.16, 0.16", "9, 9", "'translate': [0.12, 0.1, 0.12], 'area_density': 0.2",
                    PAIR(SPRINGS("1000"), PINS("'sphere': {'center': [0, 0, 0], 'radius': 10}")))),
    ", 'solids': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.24, 0.3, 0.24]}}]");

/* Thickness of the water layer that a submerged sheet displaces, in spacings, from the part of its
 * weight that the pins do not carry; *deviation: its standard deviation in time. */
static double displaced(const char *set, double *deviation) {
    char text[2048];
    snprintf(text, sizeof text, held, set);
    pdyn_sim *sim = test_open(text);
    double weight = 9.81 * 0.2 * 0.16 * 0.16, layer = 9.81 * 1000.0 * 0.16 * 0.16 * 0.02;
    double sum = 0.0, squares = 0.0, time = 0.0;
    while (pdyn_time(sim) < 0.9) {
        pdyn_step_info info = test_step(sim);
        double now = (weight - info.pin_reaction[1]) / layer;
        if (info.time < 0.4) continue;
        sum += info.h * now, squares += info.h * now * now, time += info.h;
    }
    *deviation = sqrt(squares / time - sum / time * sum / time);
    test_close(sim);
    return sum / time;
}

/* With "contact" a sheet displaces its area times the thickness, up to 0.6 spacings, more. */
static void assert_thickness(double thin) {
    double other, thick = displaced(", 'contact': {'thickness': 0.006}", &other);
    print_message("with a thickness of 0.3 spacings %.3f layers more\n", thick - thin);
    assert_true(fabs(thick - thin - 0.3) < 0.1);
}

/* Less than 0.4 of a layer, displaced around its border of 32 spacings; with the published boundary
 * handling more than one layer. The force is steady, because pairs that come into sight around the
 * border are not close to each other. */
static void test_displaced(void **state) {
    (void)state;
    double steady, other;
    double exact = displaced("", &steady), published = displaced(", 'boundary': 'points'", &other),
           wendland = displaced(", 'kernel': 'wendland'", &other);
    print_message("a sheet displaces %.3f layers of water, +- %.3f, with wendland %.3f, +- %.3f, "
                  "published %.3f\n",
                  exact, steady, wendland, other, published);
    assert_true(steady < 0.08);
    assert_true(fabs(exact) < 0.4 && fabs(wendland) < 0.4);
    assert_true(published > 1.0);
    assert_thickness(exact);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kernel),  cmocka_unit_test(test_areas),
        cmocka_unit_test(test_fan),     cmocka_unit_test(test_huge_slivers),
        cmocka_unit_test(test_ribbon),  cmocka_unit_test(test_large_surface),
        cmocka_unit_test(test_lattice), cmocka_unit_test(test_displaced),
    };
    return cmocka_run_group_tests_name("interface", tests, NULL, NULL);
}
