/* Forces of constraints and contact (probe.h): balance of momentum, Newton's third law, values of
 * elements, the same bits for any number of threads, steps that reading does not change. */
#include "small_scenes.h"
#include "support.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

#define G 9.81
#define SOLVED                                                                                     \
    "'duration': 1, 'frame_interval': 0.1, 'solver': {'tolerance': 1e-7, "                         \
    "'linear_tolerance': 1e-3, 'outer_iterations': 100, 'linear_iterations': 2000}, "              \
    "'time_step': {'fixed': 0.004, 'integrator': 'euler'}"
#define TOUCHING SOLVED ", 'contact': {'thickness': 0.01, 'friction': 0.4}"
#define TANK                                                                                       \
    "{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.24, 0.4, 0.2]}, 'open': ['+y']}"
#define WATER(low, high) FLUID_BOX("'name': 'water', ", "0.02", low, high, ", 'compression': 1e-3")

/* A sheet in the wind, held at two sides, damped. */
static const char flag_scene[] = SCENE(
    SOLVED,
    GRID_SHEET(
        "", "0.4, 0.4", "9, 9", "'area_density': 0.3",
        "{'type': 'spring', 'stretching_stiffness': 500, 'damping': 0.01}, " BENDING(
            "1e-3") ", {'type': 'wind', 'velocity': [1, 8, 0]}, " PINS("'box': {'minimum': [-1, "
                                                                       "-1, -1], 'maximum': [1, 1, "
                                                                       "-0.19]}")),
    "");
/* A sheet that falls on a ball. */
static const char drape_scene[] =
    SCENE(TOUCHING,
          GRID_SHEET("", "0.4, 0.4", "9, 9", "'translate': [0.01, 0.109, 0], 'area_density': 0.3",
                     STRAIN("500")),
          ", 'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 0.1}}]");
static const char tank_scene[] =
    SCENE(SOLVED, WATER("0, 0, 0", "0.12, 0.16, 0.2"), ", 'solids': [" TANK "]");
/* Water on a sheet that pins hold and that has friction with it. */
static const char hammock_scene[] = SCENE(
    TOUCHING,
    PAIR(WATER("0.04, 0.095, 0.04", "0.16, 0.175, 0.16"),
         GRID_SHEET("", "0.16, 0.16", "9, 9",
                    "'translate': [0.1, 0.09, 0.1], 'area_density': 0.3, 'fluid_friction': 50",
                    PAIR(SPRINGS("2000"), PINS("'border': true")))),
    ", 'solids': [" TANK "]");
static const char block_scene[] =
    SCENE(TOUCHING,
          "{'volume': {'grid': {'size': [0.1, 0.1, 0.1], 'cells': [2, 2, 2]}, 'translate': [0, "
          "0.059, 0], 'density': 500}, 'velocity': [0.3, 0, 0], 'constraints': [{'type': 'tet', "
          "'stiffness': 1e5, 'damping': 0.01}]}",
          ", 'solids': [{'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 4}}]");

/* ---- balance of momentum --------------------------------------------------------------------- */

struct total {
    double force[3], moment[3];
};

static struct total load_of(const pdyn_sim *sim, int constraint) {
    struct total load;
    assert_int_equal(pdyn_constraint_load(sim, constraint, load.force, load.moment), PDYN_OK);
    return load;
}

/* The forces from outside, without gravity: minus the loads on solids, pins, wind. */
static void sum_external(const pdyn_sim *sim, double sum[3]) {
    struct total load;
    sum[0] = sum[1] = sum[2] = 0.0;
    for (int s = 0; pdyn_solid_name(sim, s); s++) {
        assert_int_equal(pdyn_solid_load(sim, s, load.force, load.moment), PDYN_OK);
        vec3_add(sum, -1.0, load.force);
    }
    for (int k = 0; k < pdyn_get_state(sim).constraints; k++) {
        const char *type = pdyn_get_constraint(sim, k).type;
        if (!strcmp(type, "pin") || !strcmp(type, "wind"))
            vec3_add(sum, 1.0, load_of(sim, k).force);
    }
}

/* sum += the forces of contact and of all constraints; force: scratch. Both: particles x 3. */
static void add_all_forces(const pdyn_sim *sim, double *force, double *sum) {
    const pdyn_state state = pdyn_get_state(sim);
    for (int k = -1; k < state.constraints; k++) {
        assert_int_equal(k < 0 ? pdyn_contact_forces(sim, force)
                               : pdyn_constraint_forces(sim, k, force),
                         PDYN_OK);
        for (int i = 0; i < 3 * state.particles; i++) sum[i] += force[i];
    }
}

/* The largest part of the weight by which M (x - s) / h^2 misses force + residual at a particle. */
static double miss_of_particles(const pdyn_sim *sim, double weight) {
    const struct objective *objective = &sim->objective;
    size_t count = 3 * (size_t)objective->particles;
    double *force = calloc(2 * count, sizeof *force), *sum = force + count, worst = 0.0;
    add_all_forces(sim, force, sum);
    for (int k = 0; k < 3 * objective->particles; k++) {
        double due =
            objective_inertia(objective, k / 3) * (sim->x[k] - objective->s[k]) - sim->gradient[k];
        /* without fmax, with which GCC 12 for arm64 ends with an internal error */
        double missed = fabs(sum[k] - due) / weight;
        if (missed > worst) worst = missed;
    }
    free(force);
    return worst;
}

static double weight_of(const pdyn_sim *sim) {
    double sum = 0.0;
    for (int i = 0; i < sim->objective.particles; i++) sum += G * sim->objective.mass[i];
    return sum;
}

/* Gravity + external forces + residual - change of momentum over h, over the weight. */
static double miss_of_momentum(const pdyn_sim *sim, const pdyn_step_info *info,
                               const double before[3], const double external[3], double weight) {
    double sum[3] = {external[0], external[1] - weight, external[2]};
    for (int a = 0; a < 3; a++) sum[a] -= (info->momentum[a] - before[a]) / info->h;
    for (int i = 0; i < sim->objective.particles; i++)
        vec3_add(sum, 1.0, sim->gradient + 3 * (size_t)i);
    return vec3_length(sum) / weight;
}

static void assert_balance(const char *text, int steps) {
    pdyn_context *c = test_context(2);
    pdyn_sim *sim = test_load(c, quoted(text));
    double before[3] = {0}, weight = weight_of(sim), external[3], momentum = 0.0, each = 0.0,
           most = 0.0, residual = 0.0;
    for (int i = 0; i < sim->objective.particles; i++)
        vec3_add(before, sim->objective.mass[i], sim->v + 3 * (size_t)i);
    for (int n = 0; n < steps; n++) {
        pdyn_step_info info = test_step(sim);
        sum_external(sim, external);
        momentum = fmax(momentum, miss_of_momentum(sim, &info, before, external, weight));
        each = fmax(each, miss_of_particles(sim, weight));
        most = fmax(most, vec3_length(external) / weight);
        residual = fmax(residual, info.step_residual);
        memcpy(before, info.momentum, sizeof before);
    }
    print_message("external force up to %.2f of the weight; missing: %.1g, of a particle %.1g; "
                  "residual %.1g\n",
                  most, momentum, each, residual);
    assert_true(most > 0.2 && momentum < 1e-9 && each < 1e-9);
    test_close(sim);
}

static void test_balance(void **state) {
    (void)state;
    assert_balance(flag_scene, 20);
    assert_balance(drape_scene, 30);
    assert_balance(tank_scene, 20);
    assert_balance(hammock_scene, 15);
    assert_balance(block_scene, 20);
}

/* ---- Newton's third law ---------------------------------------------------------------------- */

/* The forces of a constraint that is not anchored, and their moments, sum to 0. */
static void assert_internal(const pdyn_sim *sim, int k) {
    int particles = sim->objective.particles;
    double *force = calloc(3 * (size_t)particles, sizeof *force), size = 0.0;
    struct total load = load_of(sim, k);
    assert_int_equal(pdyn_constraint_forces(sim, k, force), PDYN_OK);
    for (int i = 0; i < particles; i++) size += vec3_length(force + 3 * (size_t)i);
    free(force);
    if (!(size > 0.0 && vec3_length(load.force) < 1e-12 * size &&
          vec3_length(load.moment) < 1e-7 * size))
        fail_msg("%s: forces of %g N sum to %g N, %g N m", pdyn_get_constraint(sim, k).type, size,
                 vec3_length(load.force), vec3_length(load.moment));
}

/* Water hits a pinned sheet from below. Pins leave out of their force what they pass on of impacts:
 * nothing where they pull as the impacts push, and no larger part than impacts do. */
static void test_pins_in_impacts(void **state) {
    (void)state;
    int none = 0, all = 0;
    pdyn_sim *sim =
        test_open(SCENE("'duration': 1, 'frame_interval': 0.1, 'time_step': {'fixed': 0.01}",
                        PAIR(FLUID_BOX("'velocity': [0, 4, 0], ", "0.03", "-0.15, -0.4, -0.15",
                                       "0.15, -0.25, 0.15", ", 'stiffness': 1e5"),
                             GRID_SHEET("", "0.6, 0.6", "11, 11", "'area_density': 0.2",
                                        PAIR(SPRINGS("1500"), PINS("'border': true")))),
                        ""));
    const struct batch *pins = sim->objective.batch[sim->constraints - 1];
    assert_true(batch_pins(pins, &sim->body[1]));
    while (pdyn_time(sim) < 0.5) {
        test_step(sim);
        assert_true(pins->left_out >= 0.0 && pins->left_out <= sim->impacts.left_out);
        if (!(vec3_length(sim->impacts.passed_on + 3) > 0.0)) continue;
        none += pins->left_out == 0.0, all += pins->left_out == sim->impacts.left_out;
    }
    assert_true(none > 0 && all > 0);
    test_close(sim);
}

/* Water that a sheet drops into; nothing is held. */
static const char free_scene[] = SCENE(
    "'duration': 1, 'frame_interval': 0.1, 'time_step': {'fixed': "
    "0.004}, 'contact': {'thickness': 0.01}",
    PAIR(WATER("0, 0, 0", "0.12, 0.16, 0.12"),
         GRID_SHEET("'velocity': [0, -2, 0], ", "0.2, 0.2", "9, 9",
                    "'translate': [0.06, 0.18, 0.06], 'area_density': 0.3",
                    "{'type': 'spring', 'stretching_stiffness': 500, 'damping': 0.01}, " STRAIN(
                        "500") ", " BENDING("1e-3"))),
    "");

static void test_third_law(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(quoted(free_scene));
    for (int n = 0; n < 6; n++) test_step(sim);
    assert_int_equal(pdyn_get_state(sim).constraints, 4);
    for (int k = 0; k < 4; k++) assert_internal(sim, k);
    test_close(sim);
}

/* ---- elements -------------------------------------------------------------------------------- */

/* The energies of the elements sum to that of the constraint. */
static void assert_energies(const char *text) {
    pdyn_sim *sim = test_open(quoted(text));
    for (int n = 0; n < 8; n++) test_step(sim);
    for (int k = 0; k < pdyn_get_state(sim).constraints; k++) {
        pdyn_constraint_info info = pdyn_get_constraint(sim, k);
        double *energy = calloc((size_t)info.elements, sizeof *energy), sum = 0.0;
        assert_int_equal(pdyn_element_values(sim, k, energy, NULL), PDYN_OK);
        for (int e = 0; e < info.elements; e++) sum += energy[e];
        free(energy);
        if (!(fabs(sum - info.energy) <= 1e-9 * info.energy))
            fail_msg("%s: elements have %g J of %g J", info.type, sum, info.energy);
    }
    test_close(sim);
}

static void test_energies(void **state) {
    (void)state;
    assert_energies(flag_scene);
    assert_energies(hammock_scene);
    assert_energies(block_scene);
    assert_energies(free_scene);
}

/* The distance of a spring is the change of its length. */
static void test_springs(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(quoted(flag_scene));
    for (int n = 0; n < 8; n++) test_step(sim);
    pdyn_body_info body = pdyn_get_body(sim, 0);
    double *distance = calloc((size_t)body.edges, sizeof *distance), most = 0.0;
    assert_int_equal(pdyn_element_values(sim, 0, NULL, distance), PDYN_OK);
    for (int e = 0; e < body.edges; e++) {
        const int *edge = body.edge + 2 * e;
        const double *x = pdyn_get_state(sim).x, *rest = body.rest;
        double now = vec3_distance(x + 3 * edge[0], x + 3 * edge[1]);
        double change = fabs(now - vec3_distance(rest + 3 * edge[0], rest + 3 * edge[1]));
        assert_true(fabs(change - distance[e]) < 1e-15);
        most = fmax(most, change);
    }
    assert_true(most > 1e-5);
    free(distance);
    test_close(sim);
}

/* ---- calls ----------------------------------------------------------------------------------- */

/* Reads everything. */
static void read_all(const pdyn_sim *sim, double *force) {
    const pdyn_state state = pdyn_get_state(sim);
    double pressure, velocity[3];
    assert_int_equal(pdyn_contact_forces(sim, force), PDYN_OK);
    for (int k = 0; k < state.constraints; k++) {
        assert_int_equal(pdyn_constraint_forces(sim, k, force), PDYN_OK);
        assert_int_equal(pdyn_element_values(sim, k, NULL, NULL), PDYN_OK);
        load_of(sim, k);
    }
    assert_int_equal(pdyn_fluid_at(sim, 1, state.x, &pressure, velocity), PDYN_OK);
}

/* Reading does not change later steps, which have the same bits for any number of threads. */
static void test_untouched(void **state) {
    (void)state;
    for (int s = 0; s < SMALL_SCENES; s++) {
        if (test_lacks_solver(small_scenes[s])) continue;
        uint64_t hash[2];
        for (int reads = 0; reads < 2; reads++) {
            pdyn_context *c = test_context(1 + reads);
            pdyn_sim *sim = test_load(c, quoted(small_scenes[s]));
            double *force = calloc(3 * (size_t)sim->objective.particles, sizeof *force);
            for (int n = 0; n < 15; n++) {
                if (reads) read_all(sim, force);
                test_step(sim);
                if (reads) read_all(sim, force);
            }
            hash[reads] = pdyn_state_hash(sim);
            free(force);
            test_close(sim);
        }
        if (hash[0] != hash[1]) fail_msg("scene %d", s);
    }
}

/* Forces have the same bits for any number of threads. */
static void test_threads(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int t = 0; t < 2; t++) {
        pdyn_context *c = test_context(1 + 2 * t);
        pdyn_sim *sim = test_load(c, quoted(hammock_scene));
        size_t count = 3 * (size_t)sim->objective.particles;
        double *force = calloc(2 * count, sizeof *force);
        for (int n = 0; n < 8; n++) test_step(sim);
        add_all_forces(sim, force, force + count);
        hash[t] = hash_bytes(HASH_BEGIN, force + count, count * sizeof *force);
        free(force);
        test_close(sim);
    }
    assert_true(hash[0] == hash[1]);
}

static void assert_zero(const pdyn_sim *sim) {
    struct total load = load_of(sim, 2);
    double distance[64];
    assert_true(vec3_length(load.force) == 0.0 && vec3_length(load.moment) == 0.0);
    assert_true(pdyn_get_constraint(sim, 2).elements <= 64);
    distance[0] = 1.0;
    assert_int_equal(pdyn_element_values(sim, 2, NULL, distance), PDYN_OK);
    assert_true(distance[0] == 0.0);
}

static void test_calls(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(quoted(hammock_scene));
    double v[3], w[3];
    assert_zero(sim);
    for (int n = 0; n < 4; n++) test_step(sim);
    assert_true(vec3_length(load_of(sim, 2).force) > 0.0);
    assert_int_equal(pdyn_constraint_load(sim, 3, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_constraint_load(sim, -1, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_constraint_load(sim, 0, NULL, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_constraint_load(sim, 0, v, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_constraint_forces(sim, 3, v), PDYN_BAD_CALL);
    assert_int_equal(pdyn_element_values(sim, 3, v, w), PDYN_BAD_CALL);
    assert_int_equal(pdyn_save(sim, "state.pdyn"), PDYN_OK);
    assert_true(vec3_length(load_of(sim, 2).force) > 0.0);
    assert_int_equal(pdyn_restore(sim, "state.pdyn"), PDYN_OK);
    assert_zero(sim);
    test_remove_file("state.pdyn");
    test_close(sim);
}

/* ---- loads ----------------------------------------------------------------------------------- */

/* Water on a sheet that pins hold, without contact. */
static const char pool_scene[] = SCENE(
    SOLVED,
    PAIR(WATER("0.04, 0.095, 0.04", "0.16, 0.175, 0.16"),
         GRID_SHEET("", "0.16, 0.16", "9, 9", "'translate': [0.1, 0.09, 0.1], 'area_density': 0.3",
                    PAIR(SPRINGS("2000"), PINS("'border': true")))),
    "");

/* The scale of the residual is weight plus load: that of the sheet contains the norm of the forces
 * of the water, which is more than its weight; that of the water has no load. */
static void test_loads(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(pool_scene);
    for (int step = 0; step < 20; step++) test_step(sim);
    const struct objective_body *water = &sim->objective.body[0], *sheet = water + 1;
    int n = sim->objective.particles;
    double *force = calloc(3 * (size_t)n, sizeof *force), squares = 0.0;
    assert_int_equal(pdyn_constraint_forces(sim, 0, force), PDYN_OK);
    for (int k = 3 * sheet->first; k < 3 * n; k++) squares += force[k] * force[k];
    assert_true(sheet->weight > 0.0 && sheet->load > 2.0 * sheet->weight);
    assert_true(fabs(sheet->load - sqrt(squares)) < 1e-9 * sheet->load);
    assert_true(water->load == 0.0);
    assert_true(pdyn_get_body(sim, 1).residual <= 1e-7);
    free(force);
    test_close(sim);
    sim = test_open(tank_scene);
    assert_null(sim->objective.without_load); /* no scratch where there are no loads */
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_loads),     cmocka_unit_test(test_balance),
        cmocka_unit_test(test_third_law), cmocka_unit_test(test_pins_in_impacts),
        cmocka_unit_test(test_energies),  cmocka_unit_test(test_springs),
        cmocka_unit_test(test_untouched), cmocka_unit_test(test_threads),
        cmocka_unit_test(test_calls),
    };
    return cmocka_run_group_tests_name("forces", tests, test_enter_directory, test_leave_directory);
}
