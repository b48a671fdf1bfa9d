/* Rigid bodies: conservation in free flight, Euler's equations, a pendulum, water, what a program
 * sets, saved states, and errors. Contact: test_rigid_contact.c. */
#include "free_top.h"
#include "rigid_support.h"

#include "projdyn/control.h"

/* ---- mass ------------------------------------------------------------------------------------ */

static const char corners[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"; /* of a tetrahedron */

/* A mesh whose triangles face inwards is the same body as the one whose triangles face outwards. */
static void test_inward(void **state) {
    (void)state;
    static const char *const faces[] = {"f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n",
                                        "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"};
    pdyn_sim *sim[2];
    pdyn_context *context = test_context(1);
    for (int k = 0; k < 2; k++) {
        char text[256];
        snprintf(text, sizeof text, "%s%s", corners, faces[k]);
        test_write_text("facing.obj", text);
        sim[k] = test_load(context, "{'duration': 1, 'bodies': [{'rigid': {'mesh': 'facing.obj', "
                                    "'density': 1000}}]}");
    }
    const struct scene_body *body[] = {&sim[0]->scene.body[0], &sim[1]->scene.body[0]};
    assert_memory_equal(body[0]->mesh.triangle, body[1]->mesh.triangle, 12 * sizeof(int));
    assert_true(body[1]->mass > 0.0 && body[1]->mass == body[0]->mass);
    assert_true(test_distance(body[0]->point[0], body[1]->point[0], 3 * RIGID_POINTS) < 1e-12);
    test_remove_file("facing.obj");
    pdyn_free(sim[0]), pdyn_free(sim[1]);
    pdyn_destroy(context);
}

/* Adds the tetrahedron of `corners` in another size and place; 1 + `vertices` is its first vertex.
 * inwards: bit f turns face f inwards. */
enum { ALL_FACES = 15 };
static int add_tetrahedron(char *text, size_t room, int vertices, double size, double at,
                           int inwards) {
    static const int face[4][3] = {{1, 3, 2}, {1, 2, 4}, {2, 3, 4}, {1, 4, 3}};
    size_t used = strlen(text);
    for (int v = 0; v < 4; v++)
        used += (size_t)snprintf(text + used, room - used, "v %g %g %g\n", at + (v == 1) * size,
                                 at + (v == 2) * size, at + (v == 3) * size);
    for (int f = 0; f < 4; f++)
        used += (size_t)snprintf(text + used, room - used, "f %d %d %d\n", vertices + face[f][0],
                                 vertices + face[f][inwards >> f & 1 ? 2 : 1],
                                 vertices + face[f][inwards >> f & 1 ? 1 : 2]);
    return vertices + 4;
}

/* The mass, in that of the tetrahedron, of a rigid body of two: the second of this size and place.
 * flips: bit k turns tetrahedron k inwards. warnings: expected. */
static double mass_of_two(double size, double at, int flips, int warnings) {
    char text[1024] = "";
    struct warnings counter = {"counts twice", 0};
    int first = add_tetrahedron(text, sizeof text, 0, 1, 0, flips & 1 ? ALL_FACES : 0);
    add_tetrahedron(text, sizeof text, first, size, at, flips & 2 ? ALL_FACES : 0);
    test_write_text("pieces.obj", text);
    pdyn_context *context = test_warned_context(1, &counter);
    pdyn_sim *sim = test_load(context, "{'duration': 1, 'bodies': [{'rigid': {'mesh': "
                                       "'pieces.obj', 'density': 6}}]}");
    double mass = sim->scene.body[0].mass;
    assert_int_equal(counter.count, warnings);
    test_remove_file("pieces.obj");
    test_close(sim);
    return mass;
}

/* A mesh has the same mass whichever way its triangles face. */
static void test_mixed(void **state) {
    (void)state;
    for (int inwards = 0; inwards <= ALL_FACES; inwards++) {
        char text[256] = "";
        add_tetrahedron(text, sizeof text, 0, 1, 0, inwards);
        test_write_text("mixed.obj", text);
        pdyn_sim *sim = test_open("{'duration': 1, 'bodies': [{'rigid': {'mesh': "
                                  "'mixed.obj', 'density': 6}}]}");
        assert_true(fabs(sim->scene.body[0].mass - 1.0) < 1e-12);
        test_close(sim);
    }
    test_remove_file("mixed.obj");
}

/* Pieces of a mesh have the same mass whichever way they face; a piece inside another is a hollow.
 */
static void test_pieces(void **state) {
    (void)state;
    for (int flips = 0; flips < 4; flips++) {
        assert_true(fabs(mass_of_two(1, 2, flips, 0) - 2.0) < 1e-12);       /* beside it */
        assert_true(fabs(mass_of_two(0.5, 2, flips, 0) - 1.125) < 1e-12);   /* smaller */
        assert_true(fabs(mass_of_two(0.5, 0.1, flips, 0) - 0.875) < 1e-12); /* in it */
        assert_true(fabs(mass_of_two(-1, 0, flips, 0) - 2.0) < 1e-12);      /* touches a corner */
        assert_true(fabs(mass_of_two(1, 0.1, flips, 1) - 2.0) < 1e-12);     /* partly in it */
    }
}

/* ---- free flight ----------------------------------------------------------------------------- */

/* Sides of the box of BOX: its tensor of inertia is m/12 diag(sum of the squares of two sides). */
static const double side[3] = {0.2, 0.4, 0.6};

static void test_mass(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.01", "[0, 0, 0]", "",
        BOX(", 'translate': [3, 4, 5], 'rotate': [0, 90, 0], 'angular_velocity': [0, 0, 2]", "")));
    double m = 700.0 * side[0] * side[1] * side[2], c[3];
    const struct momenta p = momenta_of(sim);
    mean_of(sim, 0, sim->x, c);
    assert_true(fabs(c[0] - 3.0) < 1e-12 && fabs(c[1] - 4.0) < 1e-12 && fabs(c[2] - 5.0) < 1e-12);
    /* turned by 90 degrees about y, the axis z of the world is the axis x of the box */
    double I = m / 12.0 * (side[1] * side[1] + side[2] * side[2]);
    assert_true(fabs(p.angular[2] - 2.0 * I) < 1e-12 * I);
    assert_true(vec3_length(p.linear) < 1e-12 * m);
    test_close(sim);
}

/* Block Jacobi solves for rigid bodies exactly: one iteration is enough. */
static void test_linear_solve(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(RIGID_SCENE("0.01", "[0, 0, 0]", ", 'solver': {'type': 'cg'}",
                              BOX(", 'rotate': [10, 20, 30], 'angular_velocity': [0, 1, 2]",
                                  ", 'constraints': [{'type': 'pin', 'stiffness': 1e5, 'vertices': "
                                  "{'vertices': [0, 3]}}]")));
    const pdyn_stop stop = {.rel_tol = 1e-9, .max_iterations = 100, .first_of_step = true};
    uint64_t seed = 1;
    int iterations, n = 3 * sim->objective.particles;
    double *b = test_vector(n), *y = test_vector(n);
    steps(sim, 3);
    for (int k = 0; k < n; k++) b[k] = test_random(&seed);
    assert_int_equal(solver_view_linearise(&sim->model, 0.0), PDYN_OK);
    objective_pull(&sim->objective, b);
    assert_int_equal(sim->solver->solve(sim->solver_state, b, y, &stop, &iterations), PDYN_OK);
    assert_int_equal(iterations, 1);
    free(b), free(y);
    test_close(sim);
}

/* Centre of mass of the only body. */
static void centre_of_mass(const pdyn_sim *sim, double c[3]) {
    c[0] = c[1] = c[2] = 0.0;
    for (int k = 0; k < RIGID_POINTS; k++) {
        int i = sim->body[0].first + sim->body[0].count + k;
        vec3_add(c, 1.0 / RIGID_POINTS, sim->x + 3 * i);
    }
}

/* A box with ballast spins about its centre of mass, which stays, and its middle moves around that.
 */
static void test_ballast(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(RIGID_SCENE("0.01", "[0, 0, 0]", "",
                              BOX(", 'translate': [3, 4, 5], 'rotate': [0, 90, 0], "
                                  "'center_of_mass': [0.05, 0.1, 0], 'angular_velocity': [0, 0, 2]",
                                  "")));
    double c[3], middle[3], swung;
    centre_of_mass(sim, c);
    assert_true(fabs(c[0] - 3.0) < 1e-12 && fabs(c[1] - 4.1) < 1e-12 && fabs(c[2] - 4.95) < 1e-12);
    assert_true(vec3_length(momenta_of(sim).linear) < 1e-9);
    while (pdyn_time(sim) < acos(-1.0) / 2.0 - 0.005) test_step(sim); /* half a turn */
    centre_of_mass(sim, c);
    mean_of(sim, 0, sim->x, middle);
    swung = middle[1] - 4.1; /* -0.1 before */
    assert_true(fabs(c[0] - 3.0) < 1e-9 && fabs(c[1] - 4.1) < 1e-9 && fabs(c[2] - 4.95) < 1e-9);
    assert_true(fabs(swung - 0.1) < 2e-3);
    test_close(sim);
}

/* The box spins about its middle axis and turns over after 1.34 s (Dzhanibekov effect). Its momenta
 * stay, its rotation is that of Euler's equations, and its shape stays: also in steps in which it
 * turns by 0.4 rad. */
static void test_flight(void **state) {
    (void)state;
    static const char *const integrators[] = {"bdf2", "euler"};
    static const double h[] = {0.005, 0.04};
    double I[3];
    top_inertia(side, I);
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(
            text, sizeof text,
            "{'duration': 1000, 'frame_interval': 1000, 'gravity': [0, 0, 0], 'time_step': "
            "{'fixed': %g, 'integrator': '%s'}, 'bodies': [" BOX(
                ", 'angular_velocity': [0.02, 10, 0.03]", ", 'velocity': [0.3, -0.2, 0.1]") "]}",
            h[k], integrators[k]);
        pdyn_sim *sim = test_open(text);
        struct momenta start = momenta_of(sim);
        struct top top = {{0.02, 10.0, 0.03}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        steps(sim, (int)(2.0 / h[k] + 0.5));
        for (int n = 0; n < 40000; n++) top_step(&top, I, 5e-5);
        struct momenta end = momenta_of(sim);
        assert_true(vec3_distance(start.linear, end.linear) < 1e-12 * vec3_length(start.linear));
        assert_true(vec3_distance(start.angular, end.angular) < 1e-12 * vec3_length(start.angular));
        for (int a = 0; a < 3; a++) { /* vertex 2^a is beyond vertex 0 along axis a */
            double axis[3];
            for (int i = 0; i < 3; i++) axis[i] = (sim->x[(3 << a) + i] - sim->x[i]) / side[a];
            assert_true(vec3_distance(axis, top.axes + 3 * a) < 1e-5);
        }
        test_close(sim);
    }
}

/* ---- moments --------------------------------------------------------------------------------- */

/* A box on a pin at the middle of its upper side, if that is a vertex: here the corner (0.1, 0.2,
 * 0.3) hangs above the centre. Period of small swings: 2 pi sqrt(I / (m g l)). The error falls with
 * the square of the step. */
static double period(double h) {
    char text[1024];
    snprintf(text, sizeof text,
             "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': %g}, 'gravity': "
             "[0, -9.81, 0], 'solver': {'tolerance': 1e-7, 'outer_iterations': 50}, 'bodies': "
             "[{'rigid': {'box': {'minimum': [-0.1, -0.1, -0.1], 'maximum': [0.1, 0.1, 0.1]}, "
             "'rotate': [0, 45, 54.73561], 'mass': 3, 'angular_velocity': [0, 0, 0.05]}, "
             "'constraints': [{'type': 'pin', 'vertices': {'vertices': [7]}, 'stiffness': 1e7}]}]}",
             h);
    pdyn_sim *sim = test_open(text);
    double last = 0.0, first_pass = 0.0, time = 0.0;
    int passes = 0;
    for (double pin[3], c[3]; passes < 3 && time < 10.0; time = pdyn_time(sim)) {
        test_step(sim);
        mean_of(sim, 0, sim->x, c);
        memcpy(pin, sim->x + 21, sizeof pin);
        double along = c[0] - pin[0];
        if (along * last < 0.0) {
            double pass = pdyn_time(sim) - h * along / (along - last);
            if (!passes++) first_pass = pass;
            else if (passes == 3) time = pass - first_pass;
        }
        if (passes == 3) break;
        last = along;
    }
    test_close(sim);
    return time;
}

static void test_pendulum(void **state) {
    (void)state;
    double edge = 0.2, l = 0.5 * edge * sqrt(3.0), I = edge * edge / 6.0 + l * l;
    double theory = 2.0 * pi * sqrt(I / (9.81 * l));
    double coarse = fabs(period(0.02) - theory), fine = fabs(period(0.01) - theory);
    assert_true(coarse < 0.02 * theory && fine < 0.3 * coarse);
}

/* Forces of a program turn and move a free box as Newton's and Euler's laws say. */
static void test_forces(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE("0.01", "[0, 0, 0]", "", BOX("", "")));
    double m = 700.0 * side[0] * side[1] * side[2], force[24] = {0};
    force[1] = 2.0, force[4] = -2.0; /* at (-0.1, -0.2, -0.3) and (0.1, -0.2, -0.3): -0.4 N m */
    force[8] = 3.0;
    assert_int_equal(pdyn_set_forces(sim, 0, 8, force), PDYN_OK);
    test_step(sim);
    const struct momenta p = momenta_of(sim);
    /* 3 N along z at (-0.1, 0.2, -0.3): 0.6 and 0.3 N m about x and y */
    const double linear[3] = {0.0, 0.0, 0.03}, angular[3] = {0.006, 0.003, -0.004};
    assert_true(vec3_distance(p.linear, linear) < 1e-13);
    assert_true(vec3_distance(p.angular, angular) < 1e-5);
    assert_true(m > 0.0);
    test_close(sim);
}

/* ---- water ----------------------------------------------------------------------------------- */

static const char hit[] = RIGID_SCENE(
    "0.002", "[0, 0, 0]", ", 'contact': {'thickness': 0.004}",
    "{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': [-0.1, 0.03, "
    "-0.1], 'maximum': [0.1, 0.15, 0.1]}, 'velocity': [0, -2, 0]}]}, 'constraints': [{'type': "
    "'fluid'}]},{'name': 'box', 'rigid': {'box': {'minimum': [-0.05, -0.06, -0.1], 'maximum': "
    "[0.15, 0, 0.1]}, 'density': 500, 'fluid_friction': 10}}");

/* Water falls on two boxes of which one lies on the other: A of `dual` is a matrix of bodies. */
static const char pair[] = RIGID_SCENE(
    "0.002", "[0, 0, 0]", ", 'contact': {'thickness': 0.004, 'stiffness': 1e4}",
    "{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': [-0.1, 0.03, "
    "-0.1], 'maximum': [0.1, 0.11, 0.1]}, 'velocity': [0, -2, 0]}]}, 'constraints': [{'type': "
    "'fluid'}]},{'name': 'upper', 'rigid': {'box': {'minimum': [-0.05, -0.06, -0.1], 'maximum': "
    "[0.15, 0, 0.1]}, 'density': 500}},{'name': 'lower', 'rigid': {'box': {'minimum': [-0.1, "
    "-0.12, -0.1], 'maximum': [0.1, -0.063, 0.1]}, 'density': 2000}}");

static void test_pair(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(pair);
    struct momenta start = momenta_of(sim);
    int pairs = 0;
    for (int n = 0; n < 40; n++) {
        pdyn_step_info info = test_step(sim);
        assert_true(info.step_residual <= 0.1);
        pairs += sim->objective.rigid_matrix->pairs;
    }
    struct momenta end = momenta_of(sim);
    assert_true(pairs > 0 && sim->model.remainder->model.bodies_alone);
    assert_true(vec3_distance(start.linear, end.linear) < 1e-12 * vec3_length(start.linear));
    test_close(sim);
}

/* A cube on two strings of a block that flies away. */
static pdyn_sim *load_cube(int degrees) {
    char text[1024];
    snprintf(
        text, sizeof text,
        RIGID_SCENE("0.005", "[0, 0, 0]", ", 'solver': {'tolerance': 1e-9}",
                    PAIR("{'name': 'cube', 'velocity': [-0.1, -1.8, 0.7], 'rigid': {'box': "
                         "{'minimum': [-0.1, -0.1, -0.1], 'maximum': [0.1, 0.1, 0.1]}, 'mass': 1, "
                         "'rotate': [%d, 20, 30], 'translate': [0, -0.6, 0]}}",
                         "{'velocity': [-0.3, 1, -1.6], 'rigid': {'box': {'minimum': [-0.1, "
                         "-0.05, -0.1], 'maximum': [0.1, 0.05, 0.1]}, 'mass': 5}, 'constraints': "
                         "[{'type': 'attachment', 'to': 'cube', 'vertices': {'vertices': [5, 7]}, "
                         "'stiffness': 1e6, 'tension_only': true}]}")),
        degrees);
    return test_open(text);
}

/* A cube that is turned by 90 degrees is the same body on other points: impacts move it alike. */
static void test_turned_cube(void **state) {
    (void)state;
    double v[2][3];
    int impacts = 0;
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = load_cube(90 * k);
        for (int n = 0; n < 20; n++) impacts += test_step(sim).impacts;
        mean_of(sim, 0, sim->v, v[k]);
        test_close(sim);
    }
    print_message("%g\n", vec3_distance(v[0], v[1]));
    assert_true(impacts > 0);
    assert_true(vec3_distance(v[0], v[1]) < 1e-6);
}

/* Water hits a box off its centre: momentum is conserved, the box moves along and turns. */
static void test_water_long(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(hit);
    struct momenta start = momenta_of(sim);
    steps(sim, 40);
    struct momenta end = momenta_of(sim);
    double v[3];
    mean_of(sim, 1, sim->v, v);
    assert_true(vec3_distance(start.linear, end.linear) < 1e-12 * vec3_length(start.linear));
    assert_true(v[1] < -0.2 && sim->v[3 * (sim->body[1].first + 1) + 1] > v[1]);
    assert_int_equal(test_step(sim).leaked, 0);
    test_close(sim);
}

/* Accelerations by a force on a vertex along n, by those of the four points. */
static void test_mobility(void **state) {
    (void)state;
    static const double n[3] = {0.48, -0.6, 0.64};
    pdyn_sim *sim = test_open(RIGID_SCENE("0.01", "[0, 0, 0]", "",
                                          BOX(", 'center_of_mass': [0.05, 0.1, 0], 'rotate': [30, "
                                              "40, 50], 'translate': [1, 2, 3]",
                                              "")));
    const struct rigid_map *map = sim->objective.rigid;
    for (int j = 0; j < 8; j++) {
        double a[36] = {0};
        vec3_add(a + 3 * j, 4.0 / map->body[0].mass, n);
        rigid_map_pull(map, a);
        rigid_map_extend(map, a);
        for (int i = 0; i < 8; i++) {
            double due = vec3_dot(n, a + 3 * i);
            assert_true(fabs(rigid_body_mobility(&map->body[0], i, j, n) - due) < 1e-14);
        }
    }
    test_close(sim);
}

/* ---- a program ------------------------------------------------------------------------------- */

static void test_poses(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        RIGID_SCENE("0.01", "[0, 0, 0]", "", BOX(", 'center_of_mass': [0.05, 0.1, 0]", "")));
    double x[24], v[24], R[9], turned[3];
    vec3_rotation(R, (const double[3]){30, 40, 50});
    for (int i = 0; i < 8; i++) {
        vec3_multiply(x + 3 * i, R, sim->rest + 3 * i);
        vec3_cross(v + 3 * i, (const double[3]){1, 2, 3}, x + 3 * i);
        x[3 * i] += 5.0, v[3 * i + 1] += 7.0;
    }
    assert_int_equal(pdyn_set_positions(sim, 0, 8, x), PDYN_OK);
    assert_int_equal(pdyn_set_velocities(sim, 0, 8, v), PDYN_OK);
    assert_true(test_distance(sim->x, x, 24) < 1e-12 && test_distance(sim->v, v, 24) < 1e-12);
    for (int a = 8; a < 12; a++) {
        vec3_multiply(turned, R, sim->rest + 3 * a);
        turned[0] += 5.0;
        assert_true(vec3_distance(turned, sim->x + 3 * a) < 1e-12);
    }
    assert_int_equal(pdyn_set_positions(sim, 0, 7, x), PDYN_BAD_INPUT);
    assert_int_equal(pdyn_set_velocities(sim, 1, 1, v), PDYN_BAD_INPUT);
    assert_int_equal(pdyn_hold(sim, 9, 100.0, x), PDYN_BAD_INPUT);
    assert_int_equal(pdyn_hold(sim, 3, 100.0, x), PDYN_OK);
    test_step(sim);
    test_close(sim);
}

/* The same bits for any number of threads, and after a saved state. */
static void test_threads(void **state) {
    (void)state;
    static const char *const scenes[] = {COLLISION(""), hit, pair};
    for (int k = 0; k < 3; k++) {
        pdyn_context *one = test_context(1), *four = test_context(4);
        pdyn_sim *first = test_load(one, scenes[k]), *second = test_load(four, scenes[k]);
        steps(first, 20), steps(second, 25);
        assert_int_equal(pdyn_save(first, "state"), PDYN_OK);
        pdyn_free(first);
        first = test_load(one, scenes[k]);
        assert_int_equal(pdyn_restore(first, "state"), PDYN_OK);
        steps(first, 5);
        assert_true(pdyn_state_hash(first) == pdyn_state_hash(second));
        test_remove_file("state");
        pdyn_free(first), pdyn_free(second);
        pdyn_destroy(one), pdyn_destroy(four);
    }
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void refuse(pdyn_context *context, const char *rigid, const char *expected) {
    char text[1024];
    pdyn_sim *sim = NULL;
    snprintf(text, sizeof text, "{'duration': 1, 'bodies': [{'rigid': {%s}}]}", rigid);
    assert_int_equal(pdyn_load_text(context, quoted(text), "test", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_error(expected);
}

static void test_errors(void **state) {
    (void)state;
    char text[256];
    pdyn_context *context = test_context(1);
    snprintf(text, sizeof text, "%sf 1 3 2\nf 1 2 4\nf 2 3 4\n", corners);
    test_write_text("open.obj", text);
    test_write_text("one_sided.obj", /* the projective plane */
                    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 2\nv 2 1 1\nf 1 2 3\nf 1 3 4\nf 1 4 "
                    "5\nf 1 5 6\nf 1 6 2\nf 2 3 5\nf 3 4 6\nf 4 5 2\nf 5 6 3\nf 6 2 4\n");
    test_write_text("flat.obj",
                    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 "
                    "3\n");
    refuse(context, "'mesh': 'flat.obj', 'density': 1000", "encloses no volume");
    refuse(context, "'mesh': 'open.obj', 'density': 1000", "not closed");
    refuse(context, "'mesh': 'one_sided.obj', 'density': 1000", "face opposite sides");
    refuse(context, "'sphere': {'center': [0, 0, 0], 'radius': 1}", "density");
    refuse(context, "'sphere': {'center': [0, 0, 0], 'radius': 1}, 'density': 1, 'mass': 1",
           "mass");
    refuse(context, "'density': 1000", "mesh");
    refuse(context, "'box': {'minimum': [0, 0, 0], 'maximum': [1, 1e-6, 1]}, 'density': 1000",
           "too flat");
    test_remove_file("open.obj"), test_remove_file("flat.obj"), test_remove_file("one_sided.obj");
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_inward),       cmocka_unit_test(test_mixed),
        cmocka_unit_test(test_pieces),       cmocka_unit_test(test_mass),
        cmocka_unit_test(test_linear_solve), cmocka_unit_test(test_ballast),
        cmocka_unit_test(test_flight),       cmocka_unit_test(test_pendulum),
        cmocka_unit_test(test_forces),       cmocka_unit_test(test_water_long),
        cmocka_unit_test(test_poses),        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_pair),         cmocka_unit_test(test_errors),
        cmocka_unit_test(test_mobility),     cmocka_unit_test(test_turned_cube),
    };
    return cmocka_run_group_tests_name("rigid", tests, test_enter_directory, test_leave_directory);
}
