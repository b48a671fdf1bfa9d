/* Two-way coupling of fluid and surfaces: samples, forces, momentum, tightness of sheets. */
#include "support.h"

#include "base/registry.h"
#include "sph/surface_samples.h"

#include "projdyn/vec3.h"

#include <string.h>

/* A drop in front of a free sheet whose triangles are three spacings wide; no gravity. */
static const char drop[] =
    SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.004}, 'solver': "
          "{'tolerance': 1e-3, 'outer_iterations': 4}",
          PAIR("{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': "
               "[-0.05, 0.025, -0.05], 'maximum': [0.05, 0.105, 0.05]}, 'velocity': [0.1, -1, "
               "0.05]}]}, 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}",
               GRID_SHEET("'name': 'sheet', ", "0.3, 0.3", "6, 6",
                          "'rotate': [0, 20, 10], 'area_density': 0.5",
                          PAIR(SPRINGS("1000"), BENDING("0.001")))),
          "");

static double *array(int n) {
    double *a = calloc((size_t)n + 1, sizeof *a); /* vectors have room for one more number */
    assert_non_null(a);
    return a;
}

/* ---- samples --------------------------------------------------------------------------------- */

/* Samples lie at their weights' points, keep their distance, and cover the sheet. */
static void test_places(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, drop);
    const struct surface_samples *s = sim->samples;
    const pdyn_body *sheet = &sim->body[1];
    int n = sim->objective.particles;
    double spacing = 0.43 * 0.02, *x = array(3 * (n + s->count)), area = 0.0;
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
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* Puts every `many`-th sample into a neighbour list. */
static void reach_every(struct surface_samples *s, int many) {
    int points = s->particles + s->count;
    int *start = calloc((size_t)points, sizeof *start), *end = calloc((size_t)points, sizeof *end);
    assert_true(start && end);
    for (int k = 0; k < s->count; k++) end[s->particles + k] = k % many == 0;
    samples_update_active(s, &(pdyn_neighbours){.start = start, .end = end});
    assert_int_equal(s->active_count, (s->count + many - 1) / many);
    free(start), free(end);
}

/* S' is the transpose of S: (y, S' z) = (S y, z), also with samples in no list; lumped blocks are
 * at least S' D S. */
static void check_gather(pdyn_sim *sim, int many) {
    struct surface_samples *s = sim->samples;
    int n = 3 * sim->objective.particles, all = n + 3 * s->count;
    double *x = array(n), *y = array(n), *up = array(all), *z = array(all);
    double *D = array(2 * all), *blocks = array(2 * n), left = 0.0, right = 0.0, held = 0.0;
    uint64_t seed = 5;
    for (int k = 0; k < n; k++) x[k] = test_random(&seed);
    reach_every(s, many);
    for (int k = 0; k < n; k++) z[k] = test_random(&seed);
    for (int k = 0; k < s->active_count; k++)
        for (int a = 0; a < 3; a++) z[n + 3 * s->active[k] + a] = test_random(&seed);
    samples_interpolate(s, x, up), samples_interpolate_active(s, x);
    for (int k = 0; k < all; k++) assert_true(z[k] == 0.0 || s->input[k] == up[k]);
    samples_scatter(s, z, y);
    for (int k = 0; k < n; k++) left += y[k] * x[k];
    for (int k = 0; k < all; k++) right += z[k] * up[k];
    assert_true(fabs(left - right) < 1e-12 * fabs(left));
    for (int k = 0; k < all / 3; k++) D[6 * k] = D[6 * k + 3] = D[6 * k + 5] = 1.0 + z[3 * k];
    samples_scatter_blocks(s, D, blocks);
    for (int k = 0; k < n / 3; k++) held += blocks[6 * k] * vec3_dot(x + 3 * k, x + 3 * k);
    right = 0.0;
    for (int k = 0; k < all / 3; k++)
        if (k < n / 3 || D[6 * k] != 1.0) right += D[6 * k] * vec3_dot(up + 3 * k, up + 3 * k);
    assert_true(held >= right);
    samples_scatter(s, z, z);
    for (int k = 0; k < n; k++) assert_true(z[k] == y[k]);
    free(x), free(y), free(up), free(z), free(D), free(blocks);
}

static void test_gather(void **state) {
    (void)state;
    pdyn_context *context = test_context(3);
    pdyn_sim *sim = test_load(context, drop);
    check_gather(sim, 1), check_gather(sim, 3), check_gather(sim, 50);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* Along the gradient's direction some constraints change sides: the model's slope at the end of the
 * way is 0. */
static void test_line(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, drop);
    struct objective *sys = &sim->objective;
    int n = 3 * sys->particles, changed = 0;
    double *u = array(n), *g = array(n), *y = array(n), energy;
    for (int k = 0; k < 8; k++) test_step(context, sim);
    for (double eps = 0.0; eps < 0.5; eps += 0.4) {
        memcpy(u, sim->x, objective_bytes(sys));
        for (int i = 0; i < n; i += 3) u[i] *= 0.99; /* compresses the fluid */
        assert_int_equal(objective_local(sys, u, &energy, g), PDYN_OK);
        assert_int_equal(objective_linearise(sys, eps), PDYN_OK);
        for (int k = 0; k < n; k++) u[k] = -g[k];
        objective_apply(sys, u, y), objective_set_direction(sys, u);
        double descent = -objective_dot(sys, g, u);
        double t = objective_line_minimum(sys, descent, objective_dot(sys, u, y));
        int turns = objective_step_along(sys, t, y);
        assert_true(t > 0.0 && fabs(objective_dot(sys, y, u) - descent) <= 0.02 * descent);
        changed += turns;
    }
    assert_true(changed > 0);
    free(u), free(g), free(y);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* Sample volumes follow the area of the sheet. */
static void test_stretch(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, drop);
    const pdyn_body *sheet = &sim->body[1];
    for (int i = sheet->first; i < sheet->first + sheet->count; i++)
        for (int a = 0; a < 3; a++) sim->x[3 * i + a] *= 1.1;
    samples_update_volumes(sim->samples, sim->x);
    for (int k = 0; k < sim->samples->count; k++)
        assert_true(fabs(sim->samples->volume[k] / sim->samples->rest_volume[k] - 1.21) < 1e-12);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* ---- forces ---------------------------------------------------------------------------------- */

static double energy_at(pdyn_sim *sim, const double *x, double *gradient) {
    double energy;
    assert_int_equal(objective_local(&sim->objective, x, &energy, gradient), PDYN_OK);
    return energy;
}

/* In compression: the gradient is the derivative of the energy, operator and rows agree, and the
 * forces on sheet and water are opposite. */
static void test_forces(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, drop);
    struct objective *sys = &sim->objective;
    const struct batch *fluid = sys->batch[0];
    int n = 3 * sys->particles;
    double *x = array(n), *u = array(n), *moved = array(n), *g = array(n), *other = array(n);
    double h = 1e-7, slope = 0.0, sum[3] = {0}, moment[3] = {0}, size = 0.0;
    uint64_t seed = 9;
    for (int k = 0; k < n; k++) {
        x[k] = sim->x[k] + 0.001 * test_random(&seed), u[k] = test_random(&seed);
        if (k % 3 == 1 && k / 3 < sim->body[0].count) x[k] -= 0.008;
    }
    memcpy(sys->s, x, (size_t)n * sizeof *x); /* removes inertia from the gradient */
    sys->h = 0.01;
    energy_at(sim, x, g);
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < n; k++) moved[k] = x[k] + sign * h * u[k];
        slope += sign * energy_at(sim, moved, other) / (2.0 * h);
    }
    double expected = objective_dot(sys, g, u);
    assert_true(fabs(slope / expected - 1.0) < 1e-5);
    energy_at(sim, x, g);
    for (int i = 0; i < n / 3; i++) {
        double turn[3];
        vec3_cross(turn, x + 3 * i, g + 3 * i);
        vec3_add(sum, 1.0, g + 3 * i), vec3_add(moment, 1.0, turn);
        size += vec3_length(g + 3 * i);
    }
    assert_true(size > 10.0 && vec3_length(sum) < 1e-12 * size);
    assert_true(vec3_length(moment) < 1e-8 * size); /* pairs are stored in float */

    struct batch *rows;
    assert_int_equal(batch_create(context, fluid->type, fluid->params, fluid->view.body, NULL,
                                  neighbours_view(sim->neighbours), true, &rows),
                     PDYN_OK);
    memset(moved, 0, (size_t)n * sizeof *moved), memset(other, 0, (size_t)n * sizeof *other);
    assert_int_equal(batch_local(rows, x, 0.0, moved), PDYN_OK);
    assert_true(fabs(rows->energy / fluid->energy - 1.0) < 1e-9);
    for (int b = 1; b < sys->batches; b++) batch_local(sys->batch[b], x, 0.0, moved);
    assert_true(test_distance(moved, g, n) < 1e-7 * sqrt(objective_dot(sys, g, g)));
    batch_linearise(rows, 0.0), batch_linearise(sys->batch[0], 0.0);
    memset(moved, 0, (size_t)n * sizeof *moved), memset(other, 0, (size_t)n * sizeof *other);
    batch_apply(rows, u, moved), batch_apply(sys->batch[0], u, other);
    assert_true(test_distance(moved, other, n) < 1e-9 * sqrt(objective_dot(sys, moved, moved)));
    batch_free(rows);
    free(x), free(u), free(moved), free(g), free(other);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* cholesky and cg give the same result. */
static void test_solvers(void **state) {
    (void)state;
    double x[2][3];
    if (test_lacks_solver("cholesky")) skip();
    for (int k = 0; k < 2; k++) {
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = NULL;
        const char *const set[] = {k ? "solver.type=cholesky" : "solver.type=cg",
                                   "solver.tolerance=1e-8", "solver.outer_iterations=40",
                                   "solver.linear_tolerance=1e-4",
                                   "bodies.water.particles.radius=0.0125"};
        assert_int_equal(pdyn_load_text(context, quoted(drop), "drop", set, 5, &sim), PDYN_OK);
        for (int step = 0; step < 6; step++) test_step(context, sim);
        memcpy(x[k], sim->x + 3 * (sim->body[1].first + 14), sizeof x[k]);
        pdyn_free(sim);
        pdyn_destroy(context);
    }
    assert_true(vec3_distance(x[0], x[1]) < 1e-7);
}

/* A sheet of a hundredth of the mass of a water layer hits a block of water with 6 m/s, two
 * particle spacings per step. The prediction lies behind the water; the step must not end there. */
static void test_fast_sheet(void **state) {
    (void)state;
    const char *scene =
        SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'maximum': 0.005, 'cfl': 1}, "
              "'solver': {'tolerance': 0.5, 'linear_tolerance': 0.3, 'outer_iterations': 100}",
              PAIR(FLUID_BOX("'name': 'water', 'velocity': [0, -1, 0], ", "0.007",
                             "-0.1, 0.007, -0.1", "0.1, 0.05, 0.1", ", 'stiffness': 14000"),
                   GRID_SHEET("'name': 'sheet', 'velocity': [0, 6, 0], ", "0.3, 0.3", "31, 31",
                              "'area_density': 0.1", PAIR(SPRINGS("10000"), BENDING("1e-4")))),
              "");
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, scene);
    const pdyn_body *water = &sim->body[0], *sheet = &sim->body[1];
    for (int step = 0; step < 2; step++) test_step(context, sim);
    for (int i = 0; i < water->count; i++) {
        int nearest = sheet->first;
        double least = INFINITY;
        for (int j = sheet->first; j < sheet->first + sheet->count; j++) {
            double across =
                hypot(sim->x[3 * i] - sim->x[3 * j], sim->x[3 * i + 2] - sim->x[3 * j + 2]);
            if (across < least) least = across, nearest = j;
        }
        assert_true(sim->x[3 * i + 1] > sim->x[3 * nearest + 1]);
    }
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* ---- momentum -------------------------------------------------------------------------------- */

/* Linear momentum is conserved for any number of iterations. */
static void keeps_momentum(const char *outer, const char *linear) {
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    const char *const set[] = {outer, linear, "duration=100"};
    pdyn_step_info info;
    double begin[3] = {0}, size = 0.0;
    assert_int_equal(pdyn_load_text(context, quoted(drop), "drop", set, 3, &sim), PDYN_OK);
    for (int i = 0; i < sim->objective.particles; i++) {
        vec3_add(begin, sim->objective.mass[i], sim->v + 3 * i);
        size += sim->objective.mass[i] * vec3_length(sim->v + 3 * i);
    }
    for (int step = 0; step < 1000; step++) info = test_step(context, sim);
    assert_true(vec3_distance(info.momentum, begin) < 1e-12 * size);
    pdyn_free(sim);
    pdyn_destroy(context);
}

static void test_momentum(void **state) {
    (void)state;
    keeps_momentum("solver.outer_iterations=1", "solver.linear_iterations=3");
    keeps_momentum("solver.outer_iterations=4", "solver.linear_tolerance=0.01");
}

static void sum_up(const pdyn_sim *sim, double linear[3], double angular[3], double *energy) {
    double moment[3];
    *energy = linear[0] = linear[1] = linear[2] = angular[0] = angular[1] = angular[2] = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) {
        vec3_cross(moment, sim->x + 3 * i, sim->v + 3 * i);
        vec3_add(linear, sim->objective.mass[i], sim->v + 3 * i);
        vec3_add(angular, sim->objective.mass[i], moment);
        *energy += 0.5 * sim->objective.mass[i] * vec3_dot(sim->v + 3 * i, sim->v + 3 * i);
    }
}

/* Viscosity reduces energy, conserves momentum and angular momentum, and leaves a rotation
 * unchanged. */
static void test_viscosity(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, drop);
    int n = 3 * sim->objective.particles;
    double p[2][3], l[2][3], energy[2], *before = array(n), spin[3] = {1, 2, 3};
    uint64_t seed = 4;
    for (int k = 0; k < n; k++)
        sim->x[k] += 0.005 * test_random(&seed), sim->v[k] = test_random(&seed);
    energy_at(sim, sim->x, sim->gradient);
    sum_up(sim, p[0], l[0], &energy[0]);
    batch_velocity(sim->objective.batch[0], sim->v);
    sum_up(sim, p[1], l[1], &energy[1]);
    assert_true(vec3_distance(p[0], p[1]) < 1e-15);
    assert_true(vec3_distance(l[0], l[1]) < 1e-9 * vec3_length(l[0]));
    assert_true(energy[1] < 0.99 * energy[0]);
    for (int i = 0; i < n / 3; i++) vec3_cross(sim->v + 3 * i, spin, sim->x + 3 * i);
    memcpy(before, sim->v, (size_t)n * sizeof *before);
    batch_velocity(sim->objective.batch[0], sim->v);
    assert_true(test_distance(before, sim->v, n) < 1e-8);
    free(before);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* ---- sides ----------------------------------------------------------------------------------- */

#define ABOVE                                                                                      \
    "{'box': {'minimum': [-0.1, -0.005, -0.1], 'maximum': [0.1, 0.11, 0.1]}, 'velocity': [1, 0, "  \
    "0]}"
#define BELOW "{'box': {'minimum': [-0.11, -0.075, -0.11], 'maximum': [0.11, 0.005, 0.09]}}"
#define LAYERS(fill)                                                                               \
    SCENE("'duration': 1, 'gravity': [0, 0, 0]",                                                   \
          PAIR("{'name': 'water', 'particles': {'radius': 0.01, 'overlap': 'keep', 'fill': [" fill \
               "]}, 'constraints': [{'type': 'fluid'}]}",                                          \
               GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "6, 6", "'area_density': 0.2",          \
                          PINS("'all': true"))),                                                   \
          "")

/* Densities of water half a radius above, below, or on both sides of an uneven sheet; returns the
 * number of particles. */
static int densities(const char *text, int vertices, const char *solids, double *density) {
    char grid[64];
    const char *const set[] = {grid, solids};
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    snprintf(grid, sizeof grid, "bodies.sheet.surface.grid.vertices=[%d, %d]", vertices, vertices);
    assert_int_equal(pdyn_load_text(context, quoted(text), "layers", set, 2, &sim), PDYN_OK);
    int n = sim->body[0].count;
    for (int i = n; i < sim->objective.particles; i++)
        sim->x[3 * i + 1] = 0.002 * sin(60.0 * sim->x[3 * i] + 40.0 * sim->x[3 * i + 2]);
    energy_at(sim, sim->x, sim->gradient);
    assert_int_equal(objective_build_lists(&sim->objective, sim->x), PDYN_OK);
    energy_at(sim, sim->x, sim->gradient);
    sim->objective.batch[0]->type->matrix_free->density(sim->objective.batch[0]->op, density);
    pdyn_free(sim);
    pdyn_destroy(context);
    return n;
}

/* The density of water on one side of a sheet does not depend on water on the other side. */
static void test_layers(void **state) {
    (void)state;
    static const int vertices[] = {2, 6,
                                   50}; /* triangles much wider, and narrower, than particles */
    double *both = array(2000), *above = array(2000), *below = array(2000);
    for (int k = 0; k < 3; k++) {
        int n = densities(LAYERS(ABOVE), vertices[k], "solids=[]", above);
        int m = densities(LAYERS(BELOW), vertices[k], "solids=[]", below), pressed = 0;
        assert_int_equal(densities(LAYERS(ABOVE ", " BELOW), vertices[k], "solids=[]", both),
                         n + m);
        for (int i = 0; i < n + m; i++) {
            assert_true(fabs(both[i] - (i < n ? above[i] : below[i - n])) < 1e-9);
            pressed += both[i] > 1100.0;
        }
        assert_true(pressed > 50);
    }
    free(both), free(above), free(below);
}

/* Nor does it depend on a floor on the other side; it does on a floor on the same side. */
static void test_floor(void **state) {
    (void)state;
    static const char floor[] =
        "solids=[{\"plane\": {\"center\": [0, -0.01, 0], \"normal\": [0, 1, 0], "
        "\"size\": 0.4}}]";
    double *with = array(2000), *without = array(2000), most = 0.0;
    int n = densities(LAYERS(ABOVE), 6, "solids=[]", without);
    assert_int_equal(densities(LAYERS(ABOVE), 6, floor, with), n);
    for (int i = 0; i < n; i++) assert_true(fabs(with[i] - without[i]) < 1e-9);
    n = densities(LAYERS(BELOW), 6, "solids=[]", without);
    assert_int_equal(densities(LAYERS(BELOW), 6, floor, with), n);
    for (int i = 0; i < n; i++) most = fmax(most, with[i] - without[i]);
    assert_true(most > 100.0);
    free(with), free(without);
}

/* Around the border of a sheet, fluid interacts with fluid; occlusion is symmetric. */
static void test_hidden(void **state) {
    (void)state;
    pdyn_context *context = test_context(3);
    pdyn_sim *sim = NULL;
    const char *const set[] = {"bodies.sheet.surface.grid.size=[0.1, 0.1]"};
    assert_int_equal(
        pdyn_load_text(context, quoted(LAYERS(ABOVE ", " BELOW)), "layers", set, 1, &sim), PDYN_OK);
    const pdyn_neighbours *l = neighbours_view(sim->neighbours);
    int n = sim->body[0].count, across = 0, through = 0;
    for (int i = 0; i < n; i++)
        for (int s = l->start[i]; s < l->boundary_start[i]; s++) {
            int j = l->index[s], back = 0;
            if (j >= n) continue;
            for (int t = l->start[j]; t < l->boundary_start[j]; t++) back += l->index[t] == i;
            assert_int_equal(back, 1);
            const double *a = sim->x + 3 * i, *b = sim->x + 3 * j;
            if (!(a[1] > 0.0 && b[1] < 0.0)) continue;
            double at = a[1] / (a[1] - b[1]);
            across++;
            through +=
                fabs(a[0] + at * (b[0] - a[0])) < 0.05 && fabs(a[2] + at * (b[2] - a[2])) < 0.05;
        }
    assert_true(across > 500);
    assert_int_equal(through, 0);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* ---- friction -------------------------------------------------------------------------------- */

/* Layers of water that slide along a light sheet and extend beyond it. */
#define UPPER "{'box': {'minimum': [-0.2, 0, -0.2], 'maximum': [0.2, 0.02, 0.2]}}"
#define LOWER "{'box': {'minimum': [-0.2, -0.02, -0.2], 'maximum': [0.2, 0, 0.2]}}"
#define STREAM(integrator, fill)                                                                   \
    SCENE("'duration': 1, 'frame_interval': 0.005, 'gravity': [0, 0, 0], 'time_step': "            \
          "{'integrator': '" integrator                                                            \
          "', 'fixed': 0.005}, 'solver': {'tolerance': 1e-6, 'linear_tolerance': 1e-4}",           \
          PAIR("{'name': 'water', 'velocity': [0.4, 0, 0.3], 'particles': {'radius': 0.01, "       \
               "'fill': [" fill "]}, 'constraints': [{'type': 'fluid', 'viscosity': 0}]}",         \
               GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "6, 6",                                 \
                          "'area_density': 0.2, 'fluid_friction': 2", SPRINGS("100"))),            \
          "")

/* Runs the scene; returns the sheet's mean velocity along the stream after `steps`. */
static double carried(const char *text, int threads, int steps, double *x) {
    pdyn_context *context = test_context(threads);
    pdyn_sim *sim = test_load(context, text);
    const pdyn_body *sheet = &sim->body[1];
    double along = 0.0, across = 0.0, mass = 0.0;
    for (int step = 0; step < steps; step++) test_step(context, sim);
    for (int i = sheet->first; i < sheet->first + sheet->count; i++) {
        const double *v = sim->v + 3 * i;
        along += sim->objective.mass[i] * (0.8 * v[0] + 0.6 * v[2]);
        across += sim->objective.mass[i] * (0.6 * v[0] - 0.8 * v[2]);
        mass += sim->objective.mass[i];
    }
    assert_true(fabs(across / mass) < 1e-3);
    if (x) memcpy(x, sim->x, 3 * (size_t)sim->objective.particles * sizeof *x);
    pdyn_free(sim);
    pdyn_destroy(context);
    return along / mass;
}

/* A sheet of mass s per area and friction b in a stream of velocity v on one side moves with v (1 -
 * (1 + h b / s)^-n), on two sides with v (1 - (1 + 2 h b / s)^-n), by implicit Euler; with BDF2
 * with v (1 - exp(-b t / s)). The stream's loss of velocity is 0.3 %. */
static void test_carried(void **state) {
    (void)state;
    double one = 0.5 * (1.0 - pow(1.0 + 0.005 * 10.0, -20)), two = 0.5 * (1.0 - pow(1.1, -20));
    assert_true(fabs(carried(STREAM("euler", UPPER), 2, 20, NULL) / one - 1.0) < 0.005);
    assert_true(fabs(carried(STREAM("euler", LOWER), 2, 20, NULL) / one - 1.0) < 0.005);
    assert_true(fabs(carried(STREAM("euler", UPPER ", " LOWER), 2, 20, NULL) / two - 1.0) < 0.005);
    double exact = 0.5 * (1.0 - exp(-1.0));
    assert_true(fabs(carried(STREAM("bdf2", UPPER), 2, 20, NULL) / exact - 1.0) < 0.005);
}

static struct batch *slip_of(const pdyn_sim *sim) {
    int b = 0;
    while (sim->objective.batch[b]->type != &pdyn_constraint_slip) b++;
    return sim->objective.batch[b];
}

/* Friction transfers momentum between water and sheet, tangentially only, and dissipates energy;
 * its gradient is the derivative of its energy. */
static void test_friction(void **state) {
    (void)state;
    pdyn_context *context = test_context(3);
    pdyn_sim *sim = test_load(context, STREAM("bdf2", UPPER ", " LOWER));
    for (int step = 0; step < 5; step++) test_step(context, sim);
    struct batch *friction = slip_of(sim);
    int n = 3 * sim->objective.particles;
    double *x = array(n), *g = array(n), *other = array(n), *u = array(n), sum[3] = {0}, size = 0.0;
    uint64_t seed = 3;
    for (int k = 0; k < n; k++) x[k] = sim->x[k] + 1e-3 * test_random(&seed);
    assert_int_equal(batch_local(friction, x, 0.0, g), PDYN_OK);
    for (int i = 0; i < n / 3; i++) {
        vec3_add(sum, 1.0, g + 3 * i);
        size += vec3_length(g + 3 * i);
    }
    assert_true(size > 0.1 && vec3_length(sum) < 1e-13 * size);
    double energy = friction->energy, change = 0.0; /* E is quadratic: the mean gradient is exact */
    for (int k = 0; k < n; k++) u[k] = 1e-3 * test_random(&seed), x[k] += u[k];
    assert_int_equal(batch_local(friction, x, 0.0, other), PDYN_OK);
    for (int k = 0; k < n; k++) change += 0.5 * u[k] * (g[k] + other[k]);
    assert_true(fabs(friction->energy - energy - change) < 1e-12 * energy);
    for (int k = 1; k < n; k += 3) x[k] += 1e-3 * test_random(&seed); /* normal to the sheet */
    energy = friction->energy;
    assert_int_equal(batch_local(friction, x, 0.0, other), PDYN_OK);
    assert_true(fabs(friction->energy / energy - 1.0) < 1e-9);
    free(x), free(g), free(other), free(u);
    pdyn_free(sim);
    pdyn_destroy(context);
}

/* Every solver gives the same result; a failing allocator gives an error at each call. */
static void test_friction_solvers(void **state) {
    (void)state;
    static const char *const solver[4] = {"solver.type=cg", "solver.type=hybrid",
                                          "solver.type=cholesky", "solver.step=projective"};
    double along[4];
    for (int k = 0; k < 4; k++) {
        if (test_lacks_solver(solver[k])) continue;
        pdyn_context *context = test_context(1);
        pdyn_sim *sim = NULL;
        const char *const set[] = {solver[k], "solver.outer_iterations=200",
                                   "bodies.water.constraints.fluid.stiffness=0.01"};
        assert_int_equal(
            pdyn_load_text(context, quoted(STREAM("bdf2", UPPER)), "stream", set, 3, &sim),
            PDYN_OK);
        for (int step = 0; step < 3; step++) test_step(context, sim);
        along[k] = sim->v[3 * sim->body[1].first];
        assert_true(fabs(along[k] / along[0] - 1.0) < 1e-4);
        pdyn_free(sim);
        pdyn_destroy(context);
    }
    test_failing_scene(STREAM("bdf2", UPPER));
}

/* The same bits for any number of threads; without friction no data is allocated. */
static void test_friction_threads(void **state) {
    (void)state;
    double *one = array(6000), *three = array(6000);
    carried(STREAM("bdf2", UPPER ", " LOWER), 1, 10, one);
    carried(STREAM("bdf2", UPPER ", " LOWER), 3, 10, three);
    assert_memory_equal(one, three, 6000 * sizeof *one);
    free(one), free(three);
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, drop);
    assert_null(sim->objective.wet_sides);
    pdyn_free(sim);
    pdyn_destroy(context);
}

static const char impact[] =
    SCENE("'duration': 1, 'time_step': {'fixed': 0.01}, 'contact': {'thickness': 0.005}, 'solver': "
          "{'tolerance': 1, 'outer_iterations': 6, 'linear_iterations': 50}",
          PAIR("{'name': 'water', 'particles': {'radius': 0.02, 'fill': [{'box': {'minimum': "
               "[-0.08, 0.1, -0.08], 'maximum': [0.08, 0.26, 0.08]}, 'velocity': [0, -20, 0]}]}, "
               "'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}",
               GRID_SHEET("'name': 'sheet', ", "0.6, 0.6", "13, 13", "'area_density': 0.2",
                          PAIR(SPRINGS("4000"), PINS("'border': true")))),
          "");

/* Number of triangles of the sheet above a point. */
static int above(const pdyn_sim *sim, const double *p) {
    const pdyn_body *sheet = &sim->body[1];
    int count = 0;
    for (int t = 0; t < sheet->triangles; t++) {
        const double *x[3];
        double w[3], whole = 0.0, height = 0.0;
        for (int k = 0; k < 3; k++) x[k] = sim->x + 3 * (sheet->first + sheet->triangle[3 * t + k]);
        for (int k = 0; k < 3; k++) { /* areas projected to the horizontal plane */
            const double *a = x[(k + 1) % 3], *b = x[(k + 2) % 3];
            w[k] = (a[0] - p[0]) * (b[2] - p[2]) - (b[0] - p[0]) * (a[2] - p[2]);
            whole += w[k], height += w[k] * x[k][1];
        }
        bool inside = (w[0] > 0.0) == (w[1] > 0.0) && (w[1] > 0.0) == (w[2] > 0.0);
        count += inside && height / whole > p[1];
    }
    return count;
}

/* Water above a sheet stays above it at any speed, step and accuracy of the solve. */
static void test_impact(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, impact);
    double lowest = 0.0;
    for (int step = 0; step < 12; step++) {
        test_step(context, sim);
        for (int i = 0; i < sim->body[0].count; i++) {
            if (above(sim, sim->x + 3 * i) % 2) fail_msg("particle %d, step %d", i, step);
            lowest = fmin(lowest, sim->x[3 * i + 1]);
        }
    }
    assert_true(lowest < -0.02); /* the water has reached the sheet */
    pdyn_free(sim);
    pdyn_destroy(context);
}

struct start {
    const pdyn_sim *sim;
    double standing,
        energy; /* E at the beginning of the step and at the start of its minimisation, J */
};

static void note_start(void *user, const pdyn_iteration *iteration) {
    struct start *start = user;
    const struct objective *sys = &start->sim->objective;
    if (iteration->iteration > 0) return;
    start->energy = iteration->energy;
    for (int k = 0; k < 3 * sys->particles; k++)
        start->standing +=
            0.5 * objective_inertia(sys, k / 3) * pow(sys->s[k] - start->sim->x[k], 2.0);
}

/* Water that a sheet stops is not compressed by the water that follows. */
static void test_start(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, impact); /* at the start no constraint has energy */
    struct start start = {.sim = sim};
    pdyn_observe(sim, note_start, &start);
    test_step(context, sim);
    assert_true(start.energy < start.standing);
    pdyn_free(sim);
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_gather),
        cmocka_unit_test(test_line),
        cmocka_unit_test(test_stretch),
        cmocka_unit_test(test_forces),
        cmocka_unit_test(test_solvers),
        cmocka_unit_test(test_fast_sheet),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_viscosity),
        cmocka_unit_test(test_layers),
        cmocka_unit_test(test_floor),
        cmocka_unit_test(test_hidden),
        cmocka_unit_test(test_impact),
        cmocka_unit_test(test_carried),
        cmocka_unit_test(test_friction),
        cmocka_unit_test(test_friction_threads),
        cmocka_unit_test(test_friction_solvers),
        cmocka_unit_test(test_start),
    };
    return cmocka_run_group_tests_name("coupling", tests, NULL, NULL);
}
