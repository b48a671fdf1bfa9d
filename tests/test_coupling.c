/* Two-way coupling of fluid and surfaces: forces, momentum, tightness of sheets. test_samples.c
 * tests the samples on surfaces, test_fluid_friction.c their friction. */
#include "support.h"

#include "projdyn/vec3.h"

#include <string.h>

static const char drop[] = DROP_AND_SHEET;

/* ---- forces ---------------------------------------------------------------------------------- */

static double energy_at(pdyn_sim *sim, const double *x, double *gradient) {
    double energy;
    assert_int_equal(objective_local(&sim->objective, x, &energy, gradient), PDYN_OK);
    return energy;
}

/* The rows of the fluid have the energy, gradient and products H u of its operator. g: gradient of
 * the objective at x, by the operator, which was evaluated there last. */
static void check_rows(struct objective *objective, const double *x, const double *u,
                       const double *g) {
    struct batch *fluid = objective->batch[0], *rows;
    int n = 3 * objective->particles;
    double *by_rows = test_vector(n), *by_operator = test_vector(n);
    assert_int_equal(batch_create_rows(fluid, &rows), PDYN_OK);
    assert_int_equal(batch_local(rows, x, by_rows), PDYN_OK);
    assert_true(fabs(rows->energy / fluid->energy - 1.0) < 1e-9);
    for (int b = 1; b < objective->batches; b++) batch_local(objective->batch[b], x, by_rows);
    assert_true(test_distance(by_rows, g, n) < 1e-7 * sqrt(objective_dot(objective, g, g)));
    batch_linearise(rows, 0.0), batch_linearise(fluid, 0.0);
    memset(by_rows, 0, (size_t)n * sizeof *by_rows);
    batch_apply(rows, u, by_rows), batch_apply(fluid, u, by_operator);
    assert_true(test_distance(by_rows, by_operator, n) <
                1e-9 * sqrt(objective_dot(objective, by_rows, by_rows)));
    batch_free(rows);
    free(by_rows), free(by_operator);
}

/* In compression: the gradient is the derivative of the energy, operator and rows agree, and the
 * forces on sheet and water are opposite. */
static void test_forces(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    struct objective *objective = &sim->objective;
    int n = 3 * objective->particles;
    double *x = test_vector(n), *u = test_vector(n), *moved = test_vector(n), *g = test_vector(n),
           *other = test_vector(n);
    double h = 1e-7, slope = 0.0, sum[3] = {0}, moment[3] = {0}, size = 0.0;
    uint64_t seed = 9;
    for (int k = 0; k < n; k++) {
        x[k] = sim->x[k] + 0.001 * test_random(&seed), u[k] = test_random(&seed);
        if (k % 3 == 1 && k / 3 < sim->body[0].count) x[k] -= 0.008;
    }
    memcpy(objective->s, x, (size_t)n * sizeof *x); /* removes inertia from the gradient */
    objective->h = 0.01;
    energy_at(sim, x, g);
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < n; k++) moved[k] = x[k] + sign * h * u[k];
        slope += sign * energy_at(sim, moved, other) / (2.0 * h);
    }
    double expected = objective_dot(objective, g, u);
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
    check_rows(objective, x, u, g);
    free(x), free(u), free(moved), free(g), free(other);
    test_close(sim);
}

/* cholesky and cg give the same result. */
static void test_solvers(void **state) {
    (void)state;
    double x[2][3];
    if (test_lacks_solver("cholesky")) skip();
    for (int k = 0; k < 2; k++) {
        const char *const set[] = {k ? "solver.type=cholesky" : "solver.type=cg",
                                   "solver.tolerance=1e-8", "solver.outer_iterations=40",
                                   "solver.linear_tolerance=1e-4",
                                   "bodies.water.particles.radius=0.0125"};
        pdyn_sim *sim = test_open_with(drop, set, 5);
        for (int step = 0; step < 6; step++) test_step(sim);
        memcpy(x[k], sim->x + 3 * (sim->body[1].first + 14), sizeof x[k]);
        test_close(sim);
    }
    assert_true(vec3_distance(x[0], x[1]) < 1e-7);
}

/* In an iteration a particle goes less than half of its distance to the sheet, and a corner of the
 * sheet no farther than the particles in front of it; a particle on the sheet can still move. */
static void assert_limits(pdyn_sim *sim) {
    const struct surface_samples *s = sim->objective.samples;
    double *limit = sim->max_step, *x = sim->x, spacing = 0.014;
    memcpy(x, x + 3 * (sim->body[1].first + 480), 3 * sizeof *x); /* the middle vertex */
    assert_int_equal(objective_limit(&sim->objective, x, limit), PDYN_OK);
    const pdyn_neighbours *l = objective_lists(&sim->objective);
    int pairs = 0;
    for (int k = 0; k < s->count; k++)
        for (int i = 0; i < sim->body[0].count; i++) {
            double at[3];
            samples_at(s, k, x, at);
            double distance = vec3_distance(at, x + 3 * i);
            if (distance >= l->surface_support) continue;
            assert_true(limit[i] <= fmax(0.5 * distance, 0.021 * spacing));
            for (int m = 3 * k; m < 3 * k + 3; m++, pairs++)
                assert_true(s->weight[m] == 0.0 || limit[s->vertex[m]] <= limit[i]);
        }
    assert_true(pairs > 100 && fabs(limit[0] - 0.02 * spacing) < 1e-9);
}

/* A sheet with 6 m/s, y above the lower side of a block of water less 7 mm. */
#define FAST_SHEET(y)                                                                              \
    SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'maximum': 0.005, 'cfl': 1}, "       \
          "'solver': {'tolerance': 0.5, 'linear_tolerance': 0.3, 'outer_iterations': 100}",        \
          PAIR(FLUID_BOX("'name': 'water', 'velocity': [0, -1, 0], ", "0.007",                     \
                         "-0.1, 0.007, -0.1", "0.1, 0.05, 0.1", ", 'stiffness': 14000"),           \
               GRID_SHEET("'name': 'sheet', 'velocity': [0, 6, 0], ", "0.3, 0.3", "31, 31",        \
                          "'translate': [0, " y ", 0], 'area_density': 0.1",                       \
                          PAIR(SPRINGS("10000"), BENDING("1e-4")))),                               \
          "")

static double first_step(const char *scene) {
    pdyn_sim *sim = test_open(scene);
    double h = test_step(sim).h;
    test_close(sim);
    return h;
}

/* A sheet that meets water in a step moves by a particle radius at most; one that does not may go
 * farther. */
static void test_step_length(void **state) {
    (void)state;
    double meets = 6.0 * first_step(FAST_SHEET("0")) / 0.007;
    assert_true(meets > 0.9 && meets <= 1.0);
    assert_true(6.0 * first_step(FAST_SHEET("-0.03")) / 0.007 > 4.0);
    assert_true(6.0 * first_step(FAST_SHEET("0.1")) / 0.007 > 4.0);
}

/* A sheet of a hundredth of the mass of a water layer hits a block of water with 6 m/s, two
 * particle spacings per step. The prediction lies behind the water; the step must not end there. */
static void test_fast_sheet(void **state) {
    (void)state;
    const char *const set[] = {"time_step.cfl=5"};
    pdyn_sim *sim = test_open_with(FAST_SHEET("0"), set, 1);
    const pdyn_body *water = &sim->body[0], *sheet = &sim->body[1];
    for (int step = 0; step < 2; step++) test_step(sim);
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
    assert_limits(sim);
    test_close(sim);
}

/* ---- momentum -------------------------------------------------------------------------------- */

/* Linear momentum is conserved for any number of iterations. */
static void keeps_momentum(const char *outer, const char *linear) {
    const char *const set[] = {outer, linear, "duration=100"};
    pdyn_step_info info;
    double begin[3] = {0}, size = 0.0;
    pdyn_sim *sim = test_open_with(drop, set, 3);
    for (int i = 0; i < sim->objective.particles; i++) {
        vec3_add(begin, sim->objective.mass[i], sim->v + 3 * i);
        size += sim->objective.mass[i] * vec3_length(sim->v + 3 * i);
    }
    for (int step = 0; step < 1000; step++) info = test_step(sim);
    assert_true(vec3_distance(info.momentum, begin) < 1e-12 * size);
    test_close(sim);
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
    pdyn_sim *sim = test_open(drop);
    int n = 3 * sim->objective.particles;
    double p[2][3], l[2][3], energy[2], *before = test_vector(n), spin[3] = {1, 2, 3};
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
    test_close(sim);
}

/* A granted density falls by a tenth with every step. */
static void test_grant_decays(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(drop);
    double *granted = (double *)objective_lists(&sim->objective)->granted;
    granted[0] = 0.1;
    for (int step = 0; step < 5; step++) test_step(sim);
    assert_true(fabs(granted[0] - 0.1 * pow(0.9, 5)) < 1e-12);
    test_close(sim);
}

/* ---- sides ----------------------------------------------------------------------------------- */

#define ABOVE                                                                                      \
    "{'box': {'minimum': [-0.1, -0.005, -0.1], 'maximum': [0.1, 0.11, 0.1]}, 'velocity': [1, 0, "  \
    "0]}"
#define BELOW "{'box': {'minimum': [-0.11, -0.075, -0.11], 'maximum': [0.11, 0.005, 0.09]}}"
#define LAYERED_WATER(fill)                                                                        \
    "{'name': 'water', 'particles': {'radius': 0.01, 'overlap': 'keep', 'fill': [" fill            \
    "]}, 'constraints': [{'type': 'fluid'}]}"
#define PINNED_SHEET(name, size, x)                                                                \
    GRID_SHEET("'name': " name ", ", size ", " size, "6, 6",                                       \
               "'translate': [" x ", 0, 0], 'area_density': 0.2", PINS("'all': true"))
#define LAYERS(fill)                                                                               \
    SCENE("'duration': 1, 'gravity': [0, 0, 0]",                                                   \
          PAIR(LAYERED_WATER(fill), PINNED_SHEET("'sheet'", "0.4", "0")), "")

/* Densities of water half a radius above, below, or on both sides of an uneven sheet; returns the
 * number of particles. */
static int densities(const char *text, int vertices, const char *solids, double *density) {
    char grid[64];
    const char *const set[] = {grid, solids};
    snprintf(grid, sizeof grid, "bodies.sheet.surface.grid.vertices=[%d, %d]", vertices, vertices);
    pdyn_sim *sim = test_open_with(text, set, 2);
    int n = sim->body[0].count;
    for (int i = n; i < sim->objective.particles; i++)
        sim->x[3 * i + 1] = 0.002 * sin(60.0 * sim->x[3 * i] + 40.0 * sim->x[3 * i + 2]);
    energy_at(sim, sim->x, sim->gradient);
    assert_int_equal(objective_build_lists(&sim->objective, sim->x), PDYN_OK);
    energy_at(sim, sim->x, sim->gradient);
    sim->objective.batch[0]->type->matrix_free->density(sim->objective.batch[0]->op, density);
    test_close(sim);
    return n;
}

/* The density of water on one side of a sheet does not depend on water on the other side. */
static void test_layers(void **state) {
    (void)state;
    static const int vertices[] = {2, 6,
                                   50}; /* triangles much wider, and narrower, than particles */
    double *both = test_vector(2000), *above = test_vector(2000), *below = test_vector(2000);
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
    double *with = test_vector(2000), *without = test_vector(2000), most = 0.0;
    int n = densities(LAYERS(ABOVE), 6, "solids=[]", without);
    assert_int_equal(densities(LAYERS(ABOVE), 6, floor, with), n);
    for (int i = 0; i < n; i++) assert_true(fabs(with[i] - without[i]) < 1e-9);
    n = densities(LAYERS(BELOW), 6, "solids=[]", without);
    assert_int_equal(densities(LAYERS(BELOW), 6, floor, with), n);
    for (int i = 0; i < n; i++) most = fmax(most, with[i] - without[i]);
    assert_true(most > 100.0);
    free(with), free(without);
}

struct seen { /* pairs of particles that see each other through a sheet of 0.1 x 0.1 m */
    int across;
    int through; /* more than half a spacing within its border */
    int east;    /* within its border at x = 0.05 m */
};

/* With another sheet as large, far away. change: "PATH=VALUE". */
static struct seen see_through_sheet(const char *change) {
    struct seen seen = {0};
    pdyn_context *context = test_context(3);
    static const char text[] =
        SCENE("'duration': 1, 'gravity': [0, 0, 0]",
              PAIR(PAIR(LAYERED_WATER(ABOVE ", " BELOW), PINNED_SHEET("'sheet'", "0.1", "0")),
                   PINNED_SHEET("'other'", "0.1", "5")),
              "");
    pdyn_sim *sim = test_load_with(context, text, &change, 1);
    const pdyn_neighbours *l = neighbours_view(sim->objective.neighbours);
    int n = sim->body[0].count;
    for (int i = 0; i < n; i++)
        for (int s = l->start[i]; s < l->boundary_start[i]; s++) {
            int j = l->index[s], back = 0;
            if (j >= n) continue;
            for (int t = l->start[j]; t < l->boundary_start[j]; t++) back += l->index[t] == i;
            assert_int_equal(back, 1);
            const double *a = sim->x + 3 * i, *b = sim->x + 3 * j;
            if (!(a[1] > 0.0 && b[1] < 0.0)) continue;
            double at = a[1] / (a[1] - b[1]), x = a[0] + at * (b[0] - a[0]);
            double z = fabs(a[2] + at * (b[2] - a[2]));
            seen.across++, seen.through += fmax(fabs(x), z) < 0.04 - 1e-9;
            seen.east += x > 0.0 && x < 0.05 && z < 0.04;
        }
    test_close(sim);
    return seen;
}

/* Around the border of a sheet and through a strip of half a spacing beside it, fluid interacts
 * with fluid, but not where a wall or another sheet closes the border; occlusion is symmetric. */
static void test_hidden(void **state) {
    (void)state;
    static const char *const closed[] = {
        "solids=[{\"plane\": {\"center\": [0.055, 0, 0], \"normal\": [-1, 0, 0], \"size\": 0.4}}]",
        "bodies.other.surface.translate=[0.101, 0, 0]"};
    struct seen open = see_through_sheet("solids=[]");
    struct seen stack = see_through_sheet("bodies.other.surface.translate=[0, -0.001, 0]");
    assert_true(open.across > 500 && open.east > 50 && stack.east > 50);
    assert_int_equal(open.through, 0);
    for (int k = 0; k < 2; k++) {
        struct seen seen = see_through_sheet(closed[k]);
        assert_true(seen.across > 500);
        assert_int_equal(seen.through, 0);
        assert_int_equal(seen.east, 0);
    }
}

/* ---- impacts --------------------------------------------------------------------------------- */

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
    pdyn_sim *sim = test_open(impact);
    double lowest = 0.0;
    for (int step = 0; step < 12; step++) {
        test_step(sim);
        for (int i = 0; i < sim->body[0].count; i++) {
            if (above(sim, sim->x + 3 * i) % 2) fail_msg("particle %d, step %d", i, step);
            lowest = fmin(lowest, sim->x[3 * i + 1]);
        }
    }
    assert_true(lowest < -0.02); /* the water has reached the sheet */
    test_close(sim);
}

struct start {
    const pdyn_sim *sim;
    double standing,
        energy; /* E at the beginning of the step and at the start of its minimisation, J */
};

static void note_start(void *user, const pdyn_iteration *iteration) {
    struct start *start = user;
    const struct objective *objective = &start->sim->objective;
    if (iteration->iteration > 0) return;
    start->energy = iteration->energy;
    for (int k = 0; k < 3 * objective->particles; k++)
        start->standing += 0.5 * objective_inertia(objective, k / 3) *
                           pow(objective->s[k] - start->sim->x[k], 2.0);
}

/* Water that a sheet stops is not compressed by the water that follows. */
static void test_start(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(impact); /* at the start no constraint has energy */
    struct start start = {.sim = sim};
    pdyn_observe(sim, note_start, &start);
    test_step(sim);
    assert_true(start.energy < start.standing);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forces),       cmocka_unit_test(test_solvers),
        cmocka_unit_test(test_step_length),  cmocka_unit_test(test_fast_sheet),
        cmocka_unit_test(test_momentum),     cmocka_unit_test(test_viscosity),
        cmocka_unit_test(test_layers),       cmocka_unit_test(test_floor),
        cmocka_unit_test(test_grant_decays), cmocka_unit_test(test_hidden),
        cmocka_unit_test(test_impact),       cmocka_unit_test(test_start),
    };
    return cmocka_run_group_tests_name("coupling", tests, NULL, NULL);
}
