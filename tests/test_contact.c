/* Contact: its energies, that nothing passes through anything, momentum, friction by exact
 * solutions, memory and threads. */
#include "contact/contact_parts.h"
#include "intersect.h"
#include "scene_support.h"

#include "projdyn/vec3.h"

#include <string.h>

/* A scene of sheets and solids; `more` is the rest of the contact entry. */
static const char *scene(const char *more, const char *gravity, const char *bodies,
                         const char *solids) {
    static char text[8192];
    snprintf(text, sizeof text,
             "{'duration': 10, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'gravity': "
             "%s,\n 'solver': {'tolerance': 1e-3, 'linear_tolerance': 0.1, 'outer_iterations': "
             "60},\n 'contact': {'thickness': 0.004%s},\n 'bodies': [%s],\n 'solids': [%s]}",
             gravity, more, bodies, solids);
    return quoted(text);
}

#define DOWN           "[0, -9.81, 0]"
#define GRID(n)        "'grid': {'size': [0.5, 0.5], 'vertices': [" #n ", " #n "]}"
#define HELD           "'constraints': [{'type': 'spring', 'stretching_stiffness': 500}]"
#define AT(y)          "'translate': [0.01, " #y ", 0.02], 'area_density': 0.2"
#define CLOTH_AT(n, y) "{'surface': {" GRID(n) ", " AT(y) "}, " HELD "}"
#define BALL           "{'name': 'ball', 'sphere': {'center': [0, 0, 0], 'radius': 0.15}}"
#define FLOOR                                                                                      \
    "{'name': 'floor', 'plane': {'center': [0.2, -0.2, 0.1], 'normal': [0, 1, 0], 'size': 4}}"

/* Two soft cubes of 0.2 m that move towards each other at 1 m/s, 0.06 m apart across. */
#define SOFT(x, y, v)                                                                              \
    "{'volume': {'grid': {'size': [0.2, 0.2, 0.2], 'cells': [4, 4, 4]}, 'density': 1000, "         \
    "'translate': [" #x ", " #y ", 0]}, 'velocity': [" #v ", 0, 0], 'constraints': [{'type': "     \
    "'tet', 'stiffness': 1e5}]}"

static void assert_apart(const pdyn_sim *sim) {
    struct soup soup = soup_of(sim);
    int a = 0, b = 0, found = soup_intersections(&soup, &a, &b);
    if (found) fail_msg("%d pairs at %g s, first %d and %d", found, pdyn_time(sim), a, b);
    soup_free(&soup);
}

static void run_apart(const char *text, int steps) {
    pdyn_sim *sim = test_open(text);
    for (int k = 0; k < steps; k++) test_step(sim), assert_apart(sim);
    test_close(sim);
}

/* ---- the test's own test --------------------------------------------------------------------- */

/* Two triangles, one moved through the other in small steps. */
static void test_intersect(void **state) {
    (void)state;
    double x[18] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    int triangle[6] = {0, 1, 2, 3, 4, 5}, a, b, crossed = 0;
    struct soup soup = {6, 2, 1, x, triangle};
    for (double y = -0.5; y < 0.5; y += 0.0501) {
        const double moved[9] = {0.2, y, 0.2, 0.3, y + 0.2, 0.2, 0.25, y + 0.1, 0.3};
        memcpy(x + 9, moved, sizeof moved);
        int found = soup_intersections(&soup, &a, &b);
        assert_int_equal(found, y < 0.0 && y + 0.2 > 0.0);
        crossed += found;
    }
    assert_true(crossed > 2);
    const double beside[9] = {1.1, 0, 1, 1, 0, 1, 0.6, 0, 0.6}; /* in the same plane */
    memcpy(x + 9, beside, sizeof beside);
    assert_int_equal(soup_intersections(&soup, &a, &b), 0);
}

/* ---- energies -------------------------------------------------------------------------------- */

struct trial { /* sheets in contact at a random state */
    pdyn_context *context;
    pdyn_sim *sim;
    int n;
    double *x, *gradient, *u, *y, *z;
};

static struct trial start(const char *solver) {
    static const char bodies[] = CLOTH_AT(6, 0.152) ", " CLOTH_AT(7, 0.154) ", " CLOTH_AT(4, 0.156);
    struct trial t = {.context = test_context(1)};
    uint64_t seed = 3;
    const char *set[] = {solver, "solver.linear_tolerance=1e-12", "solver.tolerance=1e-6"};
    t.sim = test_load_with(t.context, scene("", DOWN, bodies, BALL), set, 3);
    assert_int_equal(contact_begin(t.sim->objective.contact, t.sim->x, 1.0), PDYN_OK);
    for (int e = 0; e < t.sim->objective.contact->start.view.count; e++)
        t.sim->objective.contact->start.contact[e].force = 0.01; /* no step has set them */
    t.n = 3 * t.sim->objective.particles;
    t.x = test_vector(t.n), t.gradient = test_vector(t.n), t.u = test_vector(t.n),
    t.y = test_vector(t.n), t.z = test_vector(t.n);
    for (int k = 0; k < t.n; k++) {
        t.x[k] = t.sim->x[k] + 2e-5 * test_random(&seed);
        t.u[k] = test_random(&seed);
    }
    double energy;
    t.sim->objective.h = t.sim->objective.length = 0.01;
    const double *x = t.sim->x, *v = t.sim->v;
    assert_int_equal(objective_begin(&t.sim->objective, &(struct step_start){x, v, NULL, x, v}),
                     PDYN_OK);
    assert_int_equal(objective_local(&t.sim->objective, t.x, &energy, t.gradient), PDYN_OK);
    assert_true(t.sim->objective.contact->current.view.count > 20);
    assert_true(t.sim->objective.contact->start.view.count > 20);
    return t;
}

static void finish(struct trial *t) {
    free(t->x), free(t->gradient), free(t->u), free(t->y), free(t->z);
    test_close(t->sim);
}

static double dot(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

static double norm(const double *a, int n) { return sqrt(dot(a, a, n)); }

/* By central differences; the slope of each batch by itself, too. */
static void test_gradient(void **state) {
    (void)state;
    struct trial t = start("solver.type=cg");
    struct batch *batch[] = {t.sim->objective.barrier, t.sim->objective.friction};
    double h = 1e-9, slope[2] = {0}, expected[2], energy;
    for (int k = 0; k < 2; k++) {
        memset(t.y, 0, (size_t)t.n * sizeof *t.y);
        assert_int_equal(batch_local(batch[k], t.x, t.y), PDYN_OK);
        expected[k] = dot(t.y, t.u, t.n);
        assert_true(norm(t.y, t.n) > 1e-3);
    }
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < t.n; k++) t.z[k] = t.x[k] + sign * h * t.u[k];
        assert_int_equal(objective_local(&t.sim->objective, t.z, &energy, t.y), PDYN_OK);
        for (int k = 0; k < 2; k++) slope[k] += sign * batch[k]->energy / (2.0 * h);
    }
    for (int k = 0; k < 2; k++)
        if (fabs(slope[k] - expected[k]) > 1e-3 * fabs(expected[k]))
            fail_msg("batch %d: slope %g, by the gradient %g", k, slope[k], expected[k]);
    finish(&t);
}

/* H is symmetric, above the inertia, grows with the damping, and its block diagonal is its own. */
static void test_hessian(void **state) {
    (void)state;
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    struct trial t = start("solver.type=cg");
    struct objective *objective = &t.sim->objective;
    double *hz = test_vector(t.n), *blocks = test_vector(2 * t.n), last = 0.0;
    uint64_t seed = 5;
    for (int k = 0; k < t.n; k++) t.z[k] = test_random(&seed);
    for (int k = 0; k <= 2; k++) {
        assert_int_equal(objective_linearise(objective, 0.5 * k), PDYN_OK);
        objective_apply(objective, t.u, t.y), objective_apply(objective, t.z, hz);
        assert_true(fabs(dot(t.z, t.y, t.n) - dot(t.u, hz, t.n)) <=
                    1e-10 * norm(t.y, t.n) * norm(t.z, t.n));
        double quadratic = dot(t.u, t.y, t.n);
        assert_true(quadratic > last);
        last = quadratic;
    }
    assert_int_equal(objective_linearise(objective, 0.2), PDYN_OK);
    objective_diagonal(objective, PDYN_WHOLE, blocks);
    for (int i = 0; i < t.n; i++) {
        memset(t.z, 0, (size_t)t.n * sizeof *t.z);
        t.z[i] = 1.0;
        objective_apply(objective, t.z, t.y);
        for (int b = 0; b < 6; b++)
            if (column[b] == i % 3)
                assert_true(fabs(t.y[i / 3 * 3 + row[b]] - blocks[i / 3 * 6 + b]) <=
                            1e-10 * fabs(t.y[i]));
    }
    free(hz), free(blocks);
    finish(&t);
}

/* The product of H with what each solver finds is what it was given. */
static void test_solvers(void **state) {
    (void)state;
    static const char *const solvers[] = {"solver.type=cg", "solver.type=cholesky",
                                          "solver.type=hybrid"};
    const pdyn_stop stop = {.rel_tol = 1e-13, .max_iterations = 100000};
    for (int k = 0; k < 6; k++) {
        if (test_lacks_solver(solvers[k % 3])) continue;
        struct trial t = start(solvers[k % 3]);
        int iterations;
        assert_int_equal(solver_view_linearise(&t.sim->model, k / 3), PDYN_OK);
        memset(t.y, 0, (size_t)t.n * sizeof *t.y);
        memcpy(t.z, t.u, (size_t)t.n * sizeof *t.z);
        assert_int_equal(t.sim->solver->solve(t.sim->solver_state, t.z, t.y, &stop, &iterations),
                         PDYN_OK);
        objective_apply(&t.sim->objective, t.y, t.z);
        if (!(test_distance(t.z, t.u, t.n) <= 1e-8 * norm(t.u, t.n)))
            fail_msg("%s: residual %g", solvers[k % 3], test_distance(t.z, t.u, t.n));
        finish(&t);
    }
}

/* Steps that are solved are the same with a factor and without, though contacts come and go. */
static void test_steps(void **state) {
    (void)state;
    static const char *const solvers[] = {"solver.type=cg", "solver.type=cholesky"};
    double x[2][3 * 25];
    if (test_lacks_solver("cholesky")) skip();
    for (int k = 0; k < 2; k++) {
        const char *set[] = {solvers[k], "solver.tolerance=1e-7", "solver.linear_tolerance=1e-9"};
        pdyn_sim *sim = test_open_with(scene("", DOWN, CLOTH_AT(5, 0.156), BALL), set, 3);
        for (int s = 0; s < 10; s++) assert_true(test_step(sim).step_residual <= 1e-7);
        assert_true(sim->objective.contact->current.view.count > 0);
        memcpy(x[k], sim->x, sizeof x[k]);
        test_close(sim);
    }
    assert_true(test_distance(x[0], x[1], 75) < 1e-6);
}

/* ---- nothing passes -------------------------------------------------------------------------- */

static void test_sphere_long(void **state) {
    (void)state;
    run_apart(scene("", DOWN, CLOTH_AT(17, 0.2), BALL ", " FLOOR), 60);
}

/* Steps of 0.2 s would take the sheet 0.39 m down, a hundred times the thickness: it gets over the
 * ball to rest, and does not hang in the air. */
static void test_long_steps(void **state) {
    (void)state;
    const char *set[] = {"time_step={\"fixed\": 0.2, \"integrator\": \"euler\"}",
                         "frame_interval=0.2", "solver.tolerance=0.1"};
    pdyn_sim *sim = test_open_with(scene("", DOWN, CLOTH_AT(13, 0.18), BALL ", " FLOOR), set, 3);
    pdyn_step_info info = {0};
    for (int k = 0; k < 8; k++) info = test_step(sim), assert_apart(sim);
    assert_true(info.step_residual <= 0.1);
    assert_true(sim->x[1] < -0.07); /* a corner */
    test_close(sim);
}

/* Falls on its edge, and on itself. */
static void test_fold_long(void **state) {
    (void)state;
    run_apart(scene("", DOWN,
                    "{'surface': {" GRID(13) ", 'rotate': [85, 0, 20], " AT(0.15) "}, " HELD "}",
                    FLOOR),
              100);
}

static void test_stack(void **state) {
    (void)state;
    run_apart(
        scene("", DOWN, CLOTH_AT(8, -0.19) ", " CLOTH_AT(9, -0.18) ", " CLOTH_AT(10, -0.17), FLOOR),
        60);
}

/* 50 m/s: half a metre in a step, on a ball and a floor: nothing gets below it. */
static void test_impact_long(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(scene(
        "", DOWN, "{'surface': {" GRID(11) ", " AT(0.3) "}, 'velocity': [0, -50, 0], " HELD "}",
        BALL ", " FLOOR));
    for (int k = 0; k < 8; k++) {
        test_step(sim), assert_apart(sim);
        for (int i = 0; i < sim->objective.particles; i++) assert_true(sim->x[3 * i + 1] > -0.2);
    }
    test_close(sim);
}

/* Two sheets at 100 m/s stop each other. In steps of 10 ms, half a metre, they would have the time
 * to go around each other's borders: there E is least. */
static void test_head_on(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        scene("", "[0, 0, 0]",
              "{'surface': {" GRID(9) ", " AT(0.3) "}, 'velocity': [0, -50, 0], " HELD "},"
                                                   "{'surface': {" GRID(7) ", " AT(
                                                       -0.3) "}, 'velocity': [3, 50, 0], " HELD "}",
              ""));
    sim->scene.settings.h_fixed = 0.002;
    for (int k = 0; k < 20; k++) test_step(sim), assert_apart(sim);
    double speed = 0.0;
    for (int i = 0; i < 81; i++) speed += sim->v[3 * i + 1] / 81.0;
    assert_true(fabs(speed) < 20.0);
    test_close(sim);
}

/* Two soft cubes meet at 2 m/s. The result does not depend on a velocity that both have: 20 m/s
 * move them by half of their size in a step. */
static void test_common_motion(void **state) {
    (void)state;
    double kinetic[2];
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim =
            test_open(scene("", "[0, 0, 0]", SOFT(-0.11, -0.03, 1) ", " SOFT(0.11, 0.03, -1), ""));
        double common = k ? 20.0 : 0.0;
        for (int i = 0; i < sim->objective.particles; i++) sim->v[3 * i + 2] += common;
        for (int n = 0; n < 30; n++) {
            assert_true(test_step(sim).step_residual < 1e-3);
            assert_apart(sim);
        }
        kinetic[k] = 0.0;
        for (int i = 0; i < sim->objective.particles; i++) {
            double v[3];
            memcpy(v, sim->v + 3 * i, sizeof v);
            v[2] -= common;
            kinetic[k] += 0.5 * sim->objective.mass[i] * vec3_dot(v, v);
        }
        test_close(sim);
    }
    assert_true(fabs(kinetic[1] - kinetic[0]) < 0.02 * kinetic[0]);
}

/* A light sheet falls at 3 m/s on another one and a ball. Steps are solved to a part of the force
 * of the impact, a hundred times the weight: to one of the weight the first 20 take 11.3 iterations
 * each. */
static void test_impact_iterations(void **state) {
    (void)state;
    int outer = 0;
    pdyn_sim *sim = test_open(
        scene("", DOWN,
              "{'surface': {" GRID(17) ", " AT(
                  0.2) "}, 'velocity': [0, -3, 0], " HELD "},"
                       "{'surface': {" GRID(17) ", 'rotate': [0, 30, 0], " AT(0.17) "}, " HELD "}",
              BALL));
    sim->scene.settings.h_fixed = 0.005, sim->scene.settings.tolerance = 0.1;
    sim->scene.settings.linear_tolerance = 0.01;
    for (int k = 0; k < 20; k++) outer += test_step(sim).outer_iterations;
    assert_in_range(outer, 1, 9 * 20);
    test_close(sim);
}

/* A ball comes up under a sheet that its border holds, and turns. */
static void test_moving(void **state) {
    (void)state;
    run_apart(scene("", DOWN,
                    "{'surface': {" GRID(13) ", " AT(0.2) "}, 'constraints': [{'type': 'spring', "
                                                          "'stretching_stiffness': 500}, {'type': "
                                                          "'pin', 'vertices': {'border': true}}]}",
                    "{'sphere': {'center': [0, 0, 0], 'radius': 0.1}, 'motion': [{'time': 0}, "
                    "{'time': 0.2, 'translate': [0, 0.2, 0], 'rotate': [0, 90, 0]}]}"),
              25);
}

/* A soft block falls on a plane along whose diagonal its own diagonals lie: parallel edges. */
static void test_parallel(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        quoted("{'duration': 1, 'contact': {'thickness': 0.005}, 'bodies': [{'volume': {'grid': "
               "{'size': [0.3, 0.2, 0.2], 'cells': [6, 4, 4]}, 'translate': [0, 0.12, 0], "
               "'density': 1000}, 'constraints': [{'type': 'tet', 'stiffness': 15e3, "
               "'volume_stiffness': 35e3}]}], 'solids': [{'plane': {'center': [0, 0, 0], "
               "'normal': [0, 1, 0], 'size': 4}}]}"));
    for (int k = 0; k < 60; k++) assert_true(test_step(sim).step_residual <= 0.1);
    test_close(sim);
}

/* A press that closes: the cloth stays in between, the press waits. */
static void test_press(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        scene("", DOWN, CLOTH_AT(6, -0.19),
              FLOOR ", {'name': 'lid', 'plane': {'center': [0.1, -0.1, 0.2], 'normal': [0, 1, "
                    "0], 'size': 2}, 'motion': [{'time': 0}, {'time': 0.1, 'translate': [0, "
                    "-0.2, 0]}]}"));
    for (int k = 0; k < 15; k++) test_step(sim), assert_apart(sim);
    const struct contact *contact = sim->objective.contact;
    double lid = contact->at[3 * contact->solid[1].first + 1];
    assert_true(lid > -0.2 && lid < -0.199);
    test_close(sim);
}

/* Two sheets between plates that close: they rest, and so do their velocities. */
static void test_squeeze(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        scene("", DOWN, CLOTH_AT(6, -0.195) ", " CLOTH_AT(7, -0.19),
              FLOOR ", {'name': 'lid', 'plane': {'center': [0.1, -0.18, 0.2], 'normal': [0, 1, "
                    "0], 'size': 2}, 'motion': [{'time': 0}, {'time': 0.2, 'translate': [0, "
                    "-0.016, 0]}]}"));
    for (int k = 0; k < 40; k++) assert_true(test_step(sim).kinetic_energy < 0.1);
    test_close(sim);
}

/* ---- conservation, bits, memory -------------------------------------------------------------- */

static const char *collision(void) {
    return scene("", "[0, 0, 0]",
                 "{'surface': {" GRID(9) ", 'rotate': [10, 0, 20], " AT(0.2) "}, 'velocity': [0.2, "
                                                                             "-2, 0.1], " HELD
                                                                             "}, " CLOTH_AT(8, 0),
                 "");
}

static void test_momentum(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(collision());
    pdyn_step_info info = test_step(sim);
    double before[3], lost = 0.0;
    memcpy(before, info.momentum, sizeof before);
    for (int k = 0; k < 20; k++) {
        info = test_step(sim);
        for (int a = 0; a < 3; a++) lost = fmax(lost, fabs(info.momentum[a] - before[a]));
    }
    assert_true(sim->v[3 * 81 + 1] < -0.5); /* the one at rest was hit */
    assert_true(lost < 1e-13);
    test_close(sim);
}

static void test_threads(void **state) {
    (void)state;
    static const int threads[] = {1, 2, 3, 8};
    uint64_t hash[4];
    for (int n = 0; n < 4; n++) {
        pdyn_context *c = test_context(threads[n]);
        pdyn_sim *sim =
            test_load(c, scene("", DOWN, CLOTH_AT(21, 0.16) ", " CLOTH_AT(20, 0.17), BALL));
        for (int k = 0; k < 8; k++) test_step(sim);
        hash[n] = pdyn_state_hash(sim);
        assert_true(hash[n] == hash[0]);
        test_close(sim);
    }
}

/* A sheet that has come to rest on a floor steps without allocating. */
static void test_allocations(void **state) {
    (void)state;
    struct counter counted;
    pdyn_context *c = test_counting_context(1, &counted);
    pdyn_sim *sim = test_load(c, scene("", DOWN, CLOTH_AT(9, -0.195), FLOOR));
    for (int k = 0; k < 30; k++) test_step(sim);
    test_allow(&counted, 0);
    for (int k = 0; k < 5; k++) test_step(sim);
    test_allow(&counted, -1);
    test_close(sim);
    test_failing_scene(scene("", DOWN, CLOTH_AT(4, 0.16) ", " CLOTH_AT(3, 0.163), BALL));
}

/* ---- friction -------------------------------------------------------------------------------- */

/* The acceleration of a sheet on a plane, gravity at an angle to it. */
static double slide(double angle, double friction, int steps) {
    char more[64], gravity[128];
    snprintf(more, sizeof more, ", 'friction': %.17g", friction);
    snprintf(gravity, sizeof gravity, "[%.17g, %.17g, 0]", 9.81 * sin(angle), -9.81 * cos(angle));
    pdyn_sim *sim = test_open(scene(
        more, gravity,
        "{'surface': {" GRID(4) ", 'rotate': [0, 25, 0], " AT(-0.19601) "}, " HELD "}", FLOOR));
    double speed[2];
    for (int k = 1; k <= steps; k++) {
        pdyn_step_info info = test_step(sim);
        if (k == steps - 30 || k == steps) speed[k == steps] = info.momentum[0] / 0.05;
        assert_true(info.step_residual < 1e-3);
    }
    test_close(sim);
    return (speed[1] - speed[0]) / 0.3;
}

static void test_incline(void **state) {
    (void)state;
    double angle = 0.5, steep = tan(angle);
    for (double mu = 0.0; mu < 0.5; mu += 0.2) {
        double exact = 9.81 * (sin(angle) - mu * cos(angle));
        assert_true(fabs(slide(angle, mu, 60) - exact) < 0.01 * exact);
    }
    assert_true(fabs(slide(angle, 1.01 * steep, 200)) < 1e-4);
    assert_true(slide(angle, 0.99 * steep, 60) > 0.9 * 0.01 * 9.81 * sin(angle));
}

/* A body on its way to a floor, 4 m/s along it and 2 m/s down. Returns the change of its
 * momentum along the floor over the impulse of the floor. */
static double land(const char *body, double mu, const char *integrator) {
    char text[2048];
    snprintf(text, sizeof text,
             "{'duration': 10, 'frame_interval': 10, 'time_step': {'fixed': 0.005, 'integrator': "
             "'%s'}, 'solver': {'tolerance': 1e-3}, 'contact': {'thickness': 0.004, 'friction': "
             "%g}, 'solids': [" FLOOR "], 'bodies': [{%s, 'velocity': [4, -2, 0]}]}",
             integrator, mu, body);
    pdyn_sim *sim = test_open(text);
    double mass = 0.0, momentum[2];
    for (int i = 0; i < sim->objective.particles; i++) mass += sim->objective.mass[i];
    for (int k = 0; k < 60; k++) {
        pdyn_step_info info = test_step(sim);
        assert_true(info.step_residual < 1e-3);
        momentum[0] = info.momentum[0], momentum[1] = info.momentum[1];
    }
    double time = pdyn_time(sim);
    test_close(sim);
    return (4.0 * mass - momentum[0]) / (momentum[1] + mass * (2.0 + 9.81 * time));
}

/* Friction in an impact: Coulomb's law for the impulses, at any restitution. */
static void test_landing(void **state) {
    (void)state;
    static const struct {
        const char *body;
        double mu;   /* the ball does not begin to roll */
        double most; /* with bdf2, over mu: dashpots that pull lessen the impulse of the floor */
    } landing[] = {
        {"'rigid': {'box': {'minimum': [-0.2, -0.1, -0.2], 'maximum': [0.2, -0.08, 0.2]}, "
         "'density': 1000}",
         0.3, 1.15},
        {"'rigid': {'sphere': {'center': [0, -0.05, 0], 'radius': 0.1}, 'density': 500}", 0.1,
         1.25},
        {"'surface': {'grid': {'size': [0.4, 0.4], 'vertices': [9, 9]}, 'area_density': 0.2, "
         "'translate': [0, -0.1, 0]}, 'constraints': [{'type': 'triangle', "
         "'stretching_stiffness': 1e3}, {'type': 'bending', 'bending_rigidity': 1e-3}]",
         0.3, 1.03},
        {"'volume': {'grid': {'size': [0.4, 0.1, 0.4], 'cells': [4, 2, 4]}, 'density': 500, "
         "'translate': [0, -0.05, 0]}, 'constraints': [{'type': 'tet', 'stiffness': 1e5, "
         "'damping': 0.003}]",
         0.3, 1.03}};
    for (size_t k = 0; k < sizeof landing / sizeof *landing; k++) {
        double mu = landing[k].mu;
        double euler = land(landing[k].body, mu, "euler") / mu;
        double bdf2 = land(landing[k].body, mu, "bdf2") / mu;
        printf("friction over mu times the normal impulse: euler %.3f, bdf2 %.3f\n", euler, bdf2);
        assert_true(euler > 0.9 && euler < 1.03);
        assert_true(bdf2 > 0.9 && bdf2 < landing[k].most);
    }
}

/* A sheet that slides on a floor with 2 m/s from the first step on, pressed into it by several
 * times its weight at the start: it stops after v^2 / (2 mu g). */
static void test_first_step(void **state) {
    (void)state;
    for (double h = 0.005; h < 0.03; h += 0.015) {
        char text[1024];
        snprintf(text, sizeof text,
                 "{'duration': 10, 'frame_interval': 10, 'time_step': {'fixed': %g}, 'contact': "
                 "{'thickness': 0.004, 'friction': 0.3}, 'solids': [" FLOOR "], 'bodies': "
                 "[{'surface': {" GRID(5) ", 'translate': [0, -0.1963, 0], 'area_density': 0.2}, "
                                          "'velocity': [2, 0, 0], " HELD "}]}",
                 h);
        pdyn_sim *sim = test_open(text);
        double from = sim->x[0], exact = 4.0 / (2.0 * 0.3 * 9.81);
        while (pdyn_time(sim) < 1.0) test_step(sim);
        printf("%g s: slides %.3f m of %.3f m\n", h, sim->x[0] - from, exact);
        assert_true(fabs(sim->x[0] - from - exact) < 0.05 * exact);
        test_close(sim);
    }
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static void assert_refused(const char *text, const char *expected) {
    pdyn_sim *sim = NULL;
    assert_int_equal(pdyn_load_text(context, text, "test", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_message(expected);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

static void test_refused(void **state) {
    (void)state;
    assert_refused(
        scene("", DOWN, CLOTH_AT(6, 0.1), BALL),
        "test:3:13: contact: triangle 12 of \"body0\" and triangle 2896 of \"ball\" "
        "intersect, near (-0.0836, 0.1, -0.0736) m; the meshes are 0.5 m and 0.3 m long: "
        "leave a gap between them");
    assert_refused(
        scene("", DOWN, CLOTH_AT(3, 0.15),
              "{'name': 'tower', 'box': {'minimum': [0.05, 0, 0.15], "
              "'maximum': [0.06, 0.8, 0.16]}}"),
        "test:3:13: contact: triangle 1 of \"tower\" and triangle 6 of \"body0\" "
        "intersect, near (0.05, 0.15, 0.15) m; the meshes are 0.8 m and 0.5 m long: leave a "
        "gap between them");
    assert_refused(
        scene("", DOWN, CLOTH_AT(6, 0.1) ", " CLOTH_AT(6, 0.100001), ""),
        "test:3:13: contact: \"body0\" and \"body1\" are 1e-06 m apart at (-0.24, 0.1, "
        "-0.23), expected at least a sixteenth of the thickness, 0.00025 m: leave a gap between "
        "them");
    assert_refused(
        scene("", DOWN,
              CLOTH_AT(6, 0.1) ", {'surface': {" GRID(5) ", 'rotate': [90, 7, 0], " AT(0.12) "}}",
              ""),
        "test:3:13: contact: triangle *");
}

/* Two boxes of 0.1 m, the second moved by this, m. Edges of boxes that overlap may cross diagonals
 * of faces, or lie on edges. */
static pdyn_status load_boxes(double x, double y, double z) {
    pdyn_sim *sim = NULL;
    char text[512];
    snprintf(text, sizeof text,
             "{'duration': 1, 'contact': {'thickness': 0.005}, 'bodies': ["
             "{'rigid': {'box': {'minimum': [0, 0, 0], 'maximum': [0.1, 0.1, 0.1]}, 'density': 1}},"
             "{'rigid': {'box': {'minimum': [%g, %g, %g], 'maximum': [%g, %g, %g]}, 'density': 1}}]"
             "}",
             x, y, z, x + 0.1, y + 0.1, z + 0.1);
    pdyn_status status = pdyn_load_text(context, quoted(text), "test", NULL, 0, &sim);
    pdyn_free(sim);
    return status;
}

static void test_boxes_that_overlap(void **state) {
    (void)state;
    static const double half[] = {-0.05, 0.0, 0.05}, apart[] = {-0.105, 0.0, 0.105};
    for (int k = 0; k < 27; k++) {
        const int a = k % 3, b = k / 3 % 3, c = k / 9;
        assert_int_equal(load_boxes(half[a], half[b], half[c]), PDYN_BAD_INPUT);
        if (k != 13) assert_int_equal(load_boxes(apart[a], apart[b], apart[c]), PDYN_OK);
        assert_int_equal(load_boxes(0.105, half[b], half[c]), PDYN_OK);
    }
    assert_int_equal(load_boxes(0.05, 0.03, 0.07), PDYN_BAD_INPUT);
    assert_int_equal(load_boxes(0.1, 0.0, 0.0), PDYN_BAD_INPUT); /* no gap at all */
}

/* Without contact with itself, a sheet may pass itself and nothing else. */
static void test_not_self(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(scene(", 'self': false", DOWN, CLOTH_AT(9, -0.1), FLOOR));
    for (int k = 0; k < 40; k++) test_step(sim);
    const struct contact *contact = sim->objective.contact;
    assert_true(contact->current.view.count >= 81);
    for (int k = 0; k < contact->pairs.count; k++)
        assert_true(contact->group[contact->pairs.pair[k].point[3]] == 1 ||
                    contact->group[contact->pairs.pair[k].point[0]] == 1);
    test_close(sim);
}

/* ---- failed steps ---------------------------------------------------------------------------- */

/* A step that fails while a ball comes up under a sheet: ball and sheet are where they were. */
static void test_failed_step(void **state) {
    (void)state;
    static const double speeds[2] = {NAN, 1e20}; /* m/s */
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(
            scene("", DOWN, CLOTH_AT(9, 0.11),
                  "{'sphere': {'center': [0, 0, 0], 'radius': 0.1}, 'motion': [{'time': 0}, "
                  "{'time': 1, 'translate': [0, 5, 0]}]}"));
        sim->scene.settings.retries = 0;
        test_step(sim);
        const double *ball = contact_solid_at(sim->objective.contact, 0);
        double before[3], velocity = sim->v[1];
        memcpy(before, ball, sizeof before);
        sim->v[1] = speeds[k];
        assert_int_equal(pdyn_step(sim, NULL), PDYN_DIVERGED);
        assert_true(vec3_distance(before, ball) == 0.0);
        sim->v[1] = velocity;
        assert_apart(sim);
        test_close(sim);
    }
}

/* ---- a fast solid ---------------------------------------------------------------------------- */

/* A ball that sets out at 10 m/s half a metre in front of a sheet: long steps until it is there,
 * then steps of at most twice the thickness; all are solved, and the ball is on time. */
static void test_fast_solid(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        "{'duration': 1, 'frame_interval': 1, 'contact': {'thickness': 0.01}, 'gravity': [0, 0, "
        "0], 'bodies': [{'surface': {'grid': {'size': [0.6, 0.6], 'vertices': [16, 16]}, "
        "'area_density': 0.3}, 'constraints': [{'type': 'triangle', 'stretching_stiffness': "
        "1000}]}], 'solids': [{'sphere': {'center': [0, -0.6, 0], 'radius': 0.1}, 'motion': "
        "[{'time': 0}, {'time': 1, 'translate': [0, 10, 0]}]}]}");
    double longest = 0.0, shortest = 1.0, due = 0.0;
    while (pdyn_time(sim) < 0.08) {
        pdyn_step_info info = test_step(sim);
        longest = fmax(longest, info.h), shortest = fmin(shortest, info.h);
        assert_true(info.step_residual <= 0.1);
        assert_false(sim->objective.contact->lagging);
    }
    for (int i = 0; i < sim->body[0].count; i++) due = fmax(due, sim->x[3 * i + 1]);
    print_message("steps of %.2g to %.2g s, the sheet is %.2f m high\n", shortest, longest, due);
    assert_true(longest > 0.004 && shortest < 0.0021);
    assert_true(due > 10.0 * 0.08 - 0.6 + 0.1);
    test_close(sim);
}

/* ---- the default stiffness ------------------------------------------------------------------- */

#define CUBE                                                                                       \
    "{'name': 'cube', 'rigid': {'box': {'minimum': [1, -0.19, 0], 'maximum': [1.1, -0.09, 0.1]}, " \
    "'mass': 50}}"
#define COLUMN                                                                                     \
    "{'particles': {'radius': 0.05, 'fill': [{'box': {'minimum': [2, 0, 0], 'maximum': [2.2, 20, " \
    "0.2]}}]}, 'constraints': [{'type': 'fluid'}]}"

/* Light cloth has 1000 N/m; then the weight of a rigid body counts, and the pressure of a column of
 * water from the lowest point, that of the floor, on the area of a vertex. */
static void test_default(void **state) {
    (void)state;
    static const double g = 9.81, thickness = 0.004;
    const struct {
        const char *more, *gravity, *bodies;
        double expected;
    } cases[] = {
        {"", DOWN, CLOTH_AT(9, 0), 1000},
        {", 'stiffness': 5", DOWN, CLOTH_AT(9, 0) ", " CUBE, 5},
        {"", DOWN, CLOTH_AT(9, 0) ", " CUBE, 50 * g / thickness},
        {"", "[0, 0, 0]", CLOTH_AT(9, 0) ", " CUBE, 1000},
        {"", DOWN, CLOTH_AT(9, 0) ", " COLUMN, 1000 * g * 20.2 * 0.25 / 81 / thickness},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        pdyn_sim *sim = test_open(scene(cases[k].more, cases[k].gravity, cases[k].bodies, FLOOR));
        double found = pdyn_contact_stiffness(sim);
        if (!(fabs(found / cases[k].expected - 1.0) < 1e-6))
            fail_msg("case %d: %.9g N/m, expected %.9g", k, found, cases[k].expected);
        test_close(sim);
    }
}

/* The contact force of a disc of 16 triangles around its centre on a small pinned sheet above it. A
 * corner of the sheet is this far from the centre of the disc, m. */
static double force_above_disc(double x, double z) {
    char text[640];
    snprintf(text, sizeof text,
             "{'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.001}, 'contact': "
             "{'thickness': 0.005, 'stiffness': 1000, 'self': false}, 'bodies': [{'surface': "
             "{'grid': {'size': [0.01, 0.01], 'vertices': [2, 2]}, 'translate': [%.17g, 0.0035, "
             "%.17g], 'area_density': 1}, 'constraints': [{'type': 'pin', 'vertices': {'all': "
             "true}}]}], 'solids': [{'mesh': 'disc.obj'}]}",
             x + 0.005, z + 0.005);
    pdyn_sim *sim = test_open(text);
    double force[3], moment[3];
    test_step(sim);
    assert_int_equal(pdyn_solid_load(sim, 0, force, moment), PDYN_OK);
    test_close(sim);
    return -force[1];
}

/* A flat disc pushes with the same force everywhere, also beside the point where its triangles
 * meet. */
static void test_flat_disc(void **state) {
    (void)state;
    char text[2048] = "v 0 0 0\n";
    int n = (int)strlen(text);
    for (int k = 0; k < 16; k++)
        n += snprintf(text + n, sizeof text - (size_t)n, "v %.17g 0 %.17g\n",
                      0.1 * cos(k * M_PI / 8), 0.1 * sin(k * M_PI / 8));
    for (int k = 0; k < 16; k++)
        n += snprintf(text + n, sizeof text - (size_t)n, "f 1 %d %d\n", k + 2, (k + 1) % 16 + 2);
    test_write_text("disc.obj", text);
    double force = force_above_disc(0.02, 0.03);
    assert_true(force > 1.0);
    for (int k = 0; k < 7; k++) {
        double x = 5e-4 * cos(k), z = 5e-4 * sin(k);
        assert_true(fabs(force_above_disc(x, z) / force - 1.0) < 1e-6);
        assert_true(fabs(force_above_disc(1e-4 * x, 1e-4 * z) / force - 1.0) < 1e-6);
    }
    test_remove_file("disc.obj");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_intersect),
        cmocka_unit_test(test_gradient),
        cmocka_unit_test(test_hessian),
        cmocka_unit_test(test_solvers),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_sphere_long),
        cmocka_unit_test(test_long_steps),
        cmocka_unit_test(test_fold_long),
        cmocka_unit_test(test_stack),
        cmocka_unit_test(test_impact_long),
        cmocka_unit_test(test_head_on),
        cmocka_unit_test(test_common_motion),
        cmocka_unit_test(test_moving),
        cmocka_unit_test(test_press),
        cmocka_unit_test(test_parallel),
        cmocka_unit_test(test_squeeze),
        cmocka_unit_test(test_flat_disc),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_allocations),
        cmocka_unit_test(test_incline),
        cmocka_unit_test(test_landing),
        cmocka_unit_test(test_first_step),
        cmocka_unit_test(test_boxes_that_overlap),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_not_self),
        cmocka_unit_test(test_impact_iterations),
        cmocka_unit_test(test_failed_step),
        cmocka_unit_test(test_fast_solid),
        cmocka_unit_test(test_default),
    };
    return cmocka_run_group_tests_name("contact", tests, scene_set_up, scene_tear_down);
}
