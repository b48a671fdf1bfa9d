/* Samples on surfaces, through which these act on a fluid. */
#include "support.h"

#include "sph/neighbours.h"
#include "sph/surface_samples.h"

#include "projdyn/vec3.h"

#include <string.h>

static const char drop[] = DROP_AND_SHEET;

/* Samples lie at their weights' points, keep their distance, and cover the sheet. */
static void test_places(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    const struct surface_samples *s = sim->objective.samples;
    const pdyn_body *sheet = &sim->body[1];
    int n = sim->objective.particles;
    double spacing = 0.43 * 0.02, *x = test_vector(3 * (n + s->count)), area = 0.0;
    samples_interpolate(s, sim->x, x);
    for (int k = 0; k < s->count; k++) {
        const double *w = s->weight + 3 * k, *at = x + 3 * (n + k);
        assert_true(fabs(w[0] + w[1] + w[2] - 1.0) < 1e-12);
        for (int a = 0; a < 3; a++) {
            double sum = 0.0;
            for (int m = 0; m < 3; m++) sum += w[m] * sim->x[3 * s->vertex[3 * k + m] + a];
            assert_true(w[a] >= -1e-12 && fabs(sum - at[a]) < 1e-15);
        }
        for (int m = 0; m < k; m++)
            assert_true(vec3_distance(at, x + 3 * (n + m)) > 0.74 * spacing);
    }
    for (int t = 0; t < sheet->triangles; t++)
        for (int k = 0; k < 66; k++) { /* a lattice of 11 points per side */
            double b = (k % 11) / 10.0, c = (k / 11) / 10.0, at[3], nearest = 1.0;
            const int *v = sheet->triangle + 3 * t;
            if (b + c > 1.0) continue;
            for (int a = 0; a < 3; a++)
                at[a] = (1.0 - b - c) * sheet->rest[3 * v[0] + a] + b * sheet->rest[3 * v[1] + a] +
                        c * sheet->rest[3 * v[2] + a];
            for (int m = 0; m < s->count; m++)
                nearest = fmin(nearest, vec3_distance(at, x + 3 * (n + m)));
            assert_true(nearest < 1.1 * spacing);
        }
    for (int t = 0; t < sheet->count; t++) area += sheet->vertex_area[t];
    assert_true(fabs(area - 0.09) < 1e-12);
    assert_true(s->count > area / (spacing * spacing) && s->count < 3 * area / (spacing * spacing));
    free(x);
    test_close(sim);
}

/* Adds to `area` the areas of small parts of triangle t, each to the sample nearest to it. */
static void add_areas(const pdyn_body *sheet, int t, int samples, const double *at, double *area) {
    enum { SIDE = 40 };
    const int *v = sheet->triangle + 3 * t;
    for (int k = 0; k < SIDE * SIDE; k++) { /* row by row, 2 row + 1 triangles in each */
        int row = (int)sqrt(k), upside = (k - row * row) % 2, best = 0;
        double up = (row + (upside ? 1.0 : 2.0) / 3.0) / SIDE, x[3];
        double along = ((k - row * row) / 2 + (upside ? 2.0 : 1.0) / 3.0) / SIDE;
        for (int a = 0; a < 3; a++)
            x[a] = (1.0 - up) * sheet->rest[3 * v[0] + a] +
                   (up - along) * sheet->rest[3 * v[1] + a] + along * sheet->rest[3 * v[2] + a];
        double nearest = INFINITY;
        for (int m = 0; m < samples; m++) {
            double distance = vec3_distance(x, at + 3 * m);
            if (distance < nearest) nearest = distance, best = m;
        }
        area[best] += sheet->triangle_area[t] / (SIDE * SIDE);
    }
}

/* The area of a sample is that of the surface which is nearer to it than to any other. */
static void test_areas(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    const struct surface_samples *s = sim->objective.samples;
    const pdyn_body *sheet = &sim->body[1];
    int n = sim->objective.particles;
    double *x = test_vector(3 * (n + s->count)), *area = test_vector(s->count), sum = 0.0;
    samples_interpolate(s, sim->x, x);
    for (int t = 0; t < sheet->triangles; t++)
        add_areas(sheet, t, s->count, x + 3 * (size_t)n, area);
    for (int k = 0; k < s->count; k++) {
        sum += s->rest_area[k];
        assert_true(fabs(s->rest_area[k] - area[k]) < 0.25 * 0.09 / s->count);
    }
    assert_true(fabs(sum - 0.09) < 1e-12);
    free(x), free(area);
    test_close(sim);
}

/* Puts every `many`-th sample into a neighbour list. */
static void reach_every(struct surface_samples *s, int many) {
    int points = s->particles + s->count;
    int *start = calloc((size_t)points, sizeof *start), *end = calloc((size_t)points, sizeof *end);
    int *near = calloc((size_t)s->count, sizeof *near);
    assert_true(start && end && near);
    for (int k = 0; k < s->count; k++) end[s->particles + k] = k % many == 0;
    for (int k = 0; k < s->count; k++) near[k] = s->particles + k;
    samples_update_active(s, &(pdyn_neighbours){.start = start, .end = end}, near, s->count);
    assert_int_equal(s->active_count, (s->count + many - 1) / many);
    free(start), free(end), free(near);
}

/* S' is the transpose of S: (y, S' z) = (S y, z), also with samples in no list; lumped blocks are
 * at least S' D S. */
static void check_gather(pdyn_sim *sim, int many) {
    struct surface_samples *s = sim->objective.samples;
    int n = 3 * sim->objective.particles, all = n + 3 * s->count;
    double *x = test_vector(n), *y = test_vector(n), *up = test_vector(all), *z = test_vector(all);
    double *D = s->blocks, *blocks = test_vector(2 * n), left = 0.0, right = 0.0, held = 0.0;
    uint64_t seed = 5;
    for (int k = 0; k < n; k++) x[k] = test_random(&seed);
    reach_every(s, many);
    for (int k = 0; k < n; k++) z[k] = test_random(&seed);
    for (int k = 0; k < s->active_count; k++)
        for (int a = 0; a < 3; a++) z[n + 3 * s->active[k] + a] = test_random(&seed);
    samples_interpolate(s, x, up), samples_interpolate_active(s, x);
    for (int k = 0; k < all; k++) assert_true(z[k] == 0.0 || s->input[k] == up[k]);
    memcpy(s->output, z, (size_t)all * sizeof *z);
    samples_scatter(s, y);
    for (int k = 0; k < n; k++) left += y[k] * x[k];
    for (int k = 0; k < all; k++) right += z[k] * up[k];
    assert_true(fabs(left - right) < 1e-12 * fabs(left));
    memset(D, 0, 2 * (size_t)all * sizeof *D);
    for (int k = 0; k < all / 3; k++) D[6 * k] = D[6 * k + 3] = D[6 * k + 5] = 1.0 + z[3 * k];
    samples_scatter_blocks(s, blocks);
    for (int k = 0; k < n / 3; k++) held += blocks[6 * k] * vec3_dot(x + 3 * k, x + 3 * k);
    right = 0.0;
    for (int k = 0; k < all / 3; k++)
        if (k < n / 3 || D[6 * k] != 1.0) right += D[6 * k] * vec3_dot(up + 3 * k, up + 3 * k);
    assert_true(held >= right);
    samples_scatter(s, s->output);
    for (int k = 0; k < n; k++) assert_true(s->output[k] == y[k]);
    free(x), free(y), free(up), free(z), free(blocks);
}

static void test_gather(void **state) {
    (void)state;
    pdyn_context *context = test_context(3);
    pdyn_sim *sim = test_load(context, drop);
    check_gather(sim, 1), check_gather(sim, 3), check_gather(sim, 50);
    test_close(sim);
}

/* Along the gradient's direction some constraints change sides: the model's slope at the end of the
 * way is 0. */
static void test_line(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    struct objective *objective = &sim->objective;
    int n = 3 * objective->particles, changed = 0;
    double *u = test_vector(n), *g = test_vector(n), *y = test_vector(n), energy;
    for (int k = 0; k < 8; k++) test_step(sim);
    for (double eps = 0.0; eps < 0.5; eps += 0.4) {
        memcpy(u, sim->x, objective_bytes(objective));
        for (int i = 0; i < n; i += 3) u[i] *= 0.99; /* compresses the fluid */
        assert_int_equal(objective_local(objective, u, &energy, g), PDYN_OK);
        assert_int_equal(objective_linearise(objective, eps), PDYN_OK);
        for (int k = 0; k < n; k++) u[k] = -g[k];
        objective_apply(objective, u, y), objective_set_direction(objective, u);
        double descent = -objective_dot(objective, g, u);
        double t = objective_line_minimum(objective, descent, objective_dot(objective, u, y));
        for (int k = 0; k < n; k++) u[k] *= t, y[k] *= t;
        objective_set_direction(objective, u);
        changed += objective_count_side_changes(objective);
        objective_step_along(objective, 1.0, y);
        descent *= t;
        assert_true(t > 0.0 && fabs(objective_dot(objective, y, u) - descent) <= 0.02 * descent);
    }
    assert_true(changed > 0);
    free(u), free(g), free(y);
    test_close(sim);
}

/* Sample volumes follow the area of the sheet. */
static void test_stretch(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    const pdyn_body *sheet = &sim->body[1];
    for (int i = sheet->first; i < sheet->first + sheet->count; i++)
        for (int a = 0; a < 3; a++) sim->x[3 * i + a] *= 1.1;
    const struct surface_samples *s = sim->objective.samples;
    samples_update_volumes(sim->objective.samples, sim->x);
    assert_true(s->near_count > 0);
    for (int n = 0; n < s->near_count; n++) {
        int k = s->near[n];
        assert_true(fabs(s->volume[k] - 1.21 * s->rest_volume[k]) <= 1e-12 * s->rest_volume[k]);
    }
    test_close(sim);
}

/* x = that of sim, with a sheet that is stretched by the factor. */
static void stretch(const pdyn_sim *sim, double factor, double *x) {
    const pdyn_body *sheet = &sim->body[1];
    memcpy(x, sim->x, objective_bytes(&sim->objective));
    for (int k = 3 * sheet->first; k < 3 * (sheet->first + sheet->count); k++) x[k] *= factor;
}

/* value = C_i of the fluid at x. */
static void find_values(pdyn_sim *sim, const double *x, double *gradient, double *value) {
    const struct batch *b = sim->objective.batch[0];
    double energy;
    assert_int_equal(objective_local(&sim->objective, x, &energy, gradient), PDYN_OK);
    for (int i = 0; i < b->one_sided.at.count; i++) value[i] = b->one_sided.at.value[i];
}

/* The density is a function of positions, whatever the state was at the beginning of the step: it
 * does not jump when the next step begins. Rates and forces are its derivatives, also along a
 * stretch of the sheet. */
static void test_density(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    struct batch *b = sim->objective.batch[0];
    int n = 3 * sim->objective.particles, count = sim->body[0].count;
    double *x = test_vector(n), *u = test_vector(n), *g = test_vector(n),
           *rate = test_vector(count), *low = test_vector(count), *high = test_vector(count),
           *ones = test_vector(count), *within = test_vector(count);
    bool *all = calloc((size_t)count, sizeof *all);
    const double step = 1e-6;
    double largest = 0.0, sum = 0.0, force = 0.0;
    for (int k = 0; k < 9; k++) test_step(sim);
    assert_true(all && b->op);
    stretch(sim, 1.1 - step, x), find_values(sim, x, g, low);
    stretch(sim, 1.1 + step, x), find_values(sim, x, g, high);
    memcpy(u, x, (size_t)n * sizeof *u);
    stretch(sim, 1.1, x);
    for (int k = 0; k < n; k++) u[k] = (u[k] - x[k]) / step;
    find_values(sim, x, g, within);
    for (int i = 0; i < count; i++) all[i] = true, ones[i] = 1.0;
    batch_rate(b, all, u, rate);
    for (int i = 0; i < count; i++) {
        double expected = (high[i] - low[i]) / (2.0 * step);
        assert_true(fabs(rate[i] - expected) < 1e-5);
        largest = fmax(largest, fabs(expected)), sum += rate[i];
    }
    assert_true(largest > 0.1);
    memset(g, 0, (size_t)n * sizeof *g);
    batch_force(b, ones, g);
    for (int k = 0; k < n; k++) force += g[k] * u[k];
    assert_true(fabs(force - sum) < 1e-9 * fabs(sum));
    samples_update_volumes(sim->objective.samples, x);
    neighbours_set_sample_volumes(sim->objective.neighbours, sim->objective.samples);
    find_values(sim, x, g, high);
    for (int i = 0; i < count; i++) assert_true(fabs(high[i] - within[i]) < 1e-12);
    free(within), free(x), free(u), free(g), free(rate), free(low), free(high), free(ones),
        free(all);
    test_close(sim);
}

static const char two_sheets[] =
    "{'duration': 1, 'bodies': [{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': "
    "{'minimum': [-0.05, 0, -0.05], 'maximum': [0.05, 0.1, 0.05]}}]}, 'constraints': [{'type': "
    "'fluid'}]}, {'name': 'near', 'surface': {'grid': {'size': [0.1, 0.1], 'vertices': [6, 6]}, "
    "'area_density': 0.3}}, {'name': 'far', 'surface': {'grid': {'size': [0.1, 0.1], 'vertices': "
    "[6, 6]}, 'translate': [0.4, 0, 0], 'area_density': 0.3}}]}";

/* Number of samples in reach of a particle of fluid, each of which must be in its list. */
static int check_reach(const pdyn_sim *sim, const double *x, double *all) {
    const struct surface_samples *s = sim->objective.samples;
    const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
    int reached = 0;
    samples_interpolate(s, x, all);
    for (int i = 0; i < sim->body[0].count; i++)
        for (int j = s->particles; j < s->particles + s->count; j++) {
            int found = 0;
            for (int k = l->surface_start[i]; k < l->boundary_start[i]; k++)
                found += l->index[k] == j;
            if (vec3_distance(all + 3 * i, all + 3 * j) >= l->surface_support) continue;
            assert_int_equal(found, 1);
            reached++;
        }
    return reached;
}

/* Samples far from the fluid are not near, and come into the lists when they move there. */
static void test_far(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(two_sheets);
    const struct surface_samples *s = sim->objective.samples;
    const pdyn_body *far = &sim->body[2];
    const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
    double *x = test_vector(3 * s->particles), *up = test_vector(3 * (s->particles + s->count));
    const double *all;
    memcpy(x, sim->x, objective_bytes(&sim->objective));
    assert_in_range(s->near_count, 1, s->count / 2);
    int before = check_reach(sim, x, up);
    unsigned revision = l->revision;
    for (int move = 0; move < 80; move++) {
        for (int i = far->first; i < far->first + far->count; i++) x[3 * i] -= 0.005;
        assert_int_equal(objective_ensure_lists(&sim->objective, x, &all), PDYN_OK);
        int reached = check_reach(sim, x, up);
        assert_true(move < 79 || reached > before);
    }
    assert_int_equal(s->near_count, s->count);
    assert_in_range(l->revision - revision, 1, 60); /* some moves leave the lists valid */
    free(x), free(up);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places),  cmocka_unit_test(test_areas),
        cmocka_unit_test(test_gather),  cmocka_unit_test(test_line),
        cmocka_unit_test(test_stretch), cmocka_unit_test(test_density),
        cmocka_unit_test(test_far),
    };
    return cmocka_run_group_tests_name("samples", tests, NULL, NULL);
}
