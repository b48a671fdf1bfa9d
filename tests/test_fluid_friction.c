/* Friction of surfaces with a fluid. */
#include "support.h"

#include "base/registry.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

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

/* Friction with a fluid is a load by the fluid, not by contact. */
static void assert_load_of_fluid(const pdyn_sim *sim) {
    double all[3], fluid[3], contact[3], moment[3];
    assert_int_equal(pdyn_body_load_by(sim, 1, PDYN_LOAD_ALL, all, moment), PDYN_OK);
    assert_int_equal(pdyn_body_load_by(sim, 1, PDYN_LOAD_FLUID, fluid, moment), PDYN_OK);
    assert_int_equal(pdyn_body_load_by(sim, 1, PDYN_LOAD_CONTACT, contact, moment), PDYN_OK);
    assert_true(vec3_length(all) > 0.0 && vec3_length(contact) == 0.0);
    assert_true(vec3_distance(all, fluid) < 1e-9 * vec3_length(all));
}

/* Runs the scene; returns the sheet's mean velocity along the stream after `steps`. */
static double carried(const char *text, int threads, int steps, double *x) {
    pdyn_context *context = test_context(threads);
    pdyn_sim *sim = test_load(context, text);
    const pdyn_body *sheet = &sim->body[1];
    double along = 0.0, across = 0.0, mass = 0.0;
    for (int step = 0; step < steps; step++) test_step(sim);
    for (int i = sheet->first; i < sheet->first + sheet->count; i++) {
        const double *v = sim->v + 3 * i;
        along += sim->objective.mass[i] * (0.8 * v[0] + 0.6 * v[2]);
        across += sim->objective.mass[i] * (0.6 * v[0] - 0.8 * v[2]);
        mass += sim->objective.mass[i];
    }
    assert_true(fabs(across / mass) < 1e-3);
    assert_load_of_fluid(sim);
    if (x) memcpy(x, sim->x, 3 * (size_t)sim->objective.particles * sizeof *x);
    test_close(sim);
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

/* Friction coefficient times wet area, both sides together, after a step, N s/m. */
static double friction_rate(pdyn_sim *sim) {
    double sum = 0.0;
    test_step(sim);
    const pdyn_wet_sides *wet = &sim->objective.wet_sides->view;
    for (int e = 0; e < wet->count; e++) sum += wet->side[e].along;
    return sum;
}

/* The area is that of the stretched sheet. */
static void test_stretched(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(STREAM("euler", UPPER ", " LOWER));
    const pdyn_body *sheet = &sim->body[1];
    double rest = friction_rate(sim);
    for (int i = sheet->first; i < sheet->first + sheet->count; i++) sim->x[3 * i] *= 1.5;
    double stretched = friction_rate(sim);
    print_message("%g N s/m at rest, %g stretched by a half\n", rest, stretched);
    assert_true(fabs(rest / (2.0 * 2.0 * 0.04) - 1.0) < 0.01);
    assert_true(fabs(stretched / rest / 1.5 - 1.0) < 0.01);
    test_close(sim);
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
    for (int step = 0; step < 5; step++) test_step(sim);
    struct batch *friction = slip_of(sim);
    int n = 3 * sim->objective.particles;
    double *x = test_vector(n), *g = test_vector(n), *other = test_vector(n), *u = test_vector(n),
           sum[3] = {0}, size = 0.0;
    uint64_t seed = 3;
    for (int k = 0; k < n; k++) x[k] = sim->x[k] + 1e-3 * test_random(&seed);
    assert_int_equal(batch_local(friction, x, g), PDYN_OK);
    for (int i = 0; i < n / 3; i++) {
        vec3_add(sum, 1.0, g + 3 * i);
        size += vec3_length(g + 3 * i);
    }
    assert_true(size > 0.1 && vec3_length(sum) < 1e-13 * size);
    double energy = friction->energy, change = 0.0; /* E is quadratic: the mean gradient is exact */
    for (int k = 0; k < n; k++) u[k] = 1e-3 * test_random(&seed), x[k] += u[k];
    assert_int_equal(batch_local(friction, x, other), PDYN_OK);
    for (int k = 0; k < n; k++) change += 0.5 * u[k] * (g[k] + other[k]);
    assert_true(fabs(friction->energy - energy - change) < 1e-12 * energy);
    for (int k = 1; k < n; k += 3) x[k] += 1e-3 * test_random(&seed); /* normal to the sheet */
    energy = friction->energy;
    assert_int_equal(batch_local(friction, x, other), PDYN_OK);
    assert_true(fabs(friction->energy / energy - 1.0) < 1e-9);
    free(x), free(g), free(other), free(u);
    test_close(sim);
}

/* Every solver gives the same result; a failing allocator gives an error at each call. */
static void test_friction_solvers_long(void **state) {
    (void)state;
    static const char *const solver[4] = {"solver.type=cg", "solver.type=hybrid",
                                          "solver.type=cholesky", "solver.step=projective"};
    double along[4];
    for (int k = 0; k < 4; k++) {
        if (test_lacks_solver(solver[k])) continue;
        const char *const set[] = {solver[k], "solver.outer_iterations=200",
                                   "bodies.water.constraints.fluid.stiffness=0.01"};
        pdyn_sim *sim = test_open_with(STREAM("bdf2", UPPER), set, 3);
        for (int step = 0; step < 3; step++) test_step(sim);
        along[k] = sim->v[3 * sim->body[1].first];
        assert_true(fabs(along[k] / along[0] - 1.0) < 1e-4);
        test_close(sim);
    }
    test_failing_scene(STREAM("bdf2", UPPER));
}

/* The same bits for any number of threads; without friction no data is allocated. */
static void test_friction_threads(void **state) {
    (void)state;
    double *one = test_vector(6000), *three = test_vector(6000);
    carried(STREAM("bdf2", UPPER ", " LOWER), 1, 10, one);
    carried(STREAM("bdf2", UPPER ", " LOWER), 3, 10, three);
    assert_memory_equal(one, three, 6000 * sizeof *one);
    free(one), free(three);
    pdyn_sim *sim = test_open(DROP_AND_SHEET);
    assert_null(sim->objective.wet_sides);
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_carried),
        cmocka_unit_test(test_stretched),
        cmocka_unit_test(test_friction),
        cmocka_unit_test(test_friction_threads),
        cmocka_unit_test(test_friction_solvers_long),
    };
    return cmocka_run_group_tests_name("fluid_friction", tests, NULL, NULL);
}
