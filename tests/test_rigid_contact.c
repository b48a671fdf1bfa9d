/* Contact of rigid bodies: friction on a slope, a stack, a light body under a heavy one, the matrix
 * of bodies in contact, a collision, the order of the bodies. */
#include "contact/contact_parts.h"
#include "rigid_support.h"

#include "projdyn/control.h"

static double slide(double degrees) {
    char text[1024];
    snprintf(text, sizeof text,
             "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': 0.005}, 'gravity': "
             "[%.17g, %.17g, 0], 'contact': {'thickness': 0.002, 'stiffness': 1e5, 'friction': "
             "0.5}, 'solver': {'tolerance': 1e-5}, 'solids': [{'plane': {'center': [0, 0, 0], "
             "'normal': [0, 1, 0], 'size': 40}}], 'bodies': [{'rigid': {'box': {'minimum': [-0.1, "
             "0.002, -0.1], 'maximum': [0.1, 0.102, 0.1]}, 'density': 1000}}]}",
             9.81 * sin(degrees * pi / 180.0), -9.81 * cos(degrees * pi / 180.0));
    pdyn_sim *sim = test_open(text);
    double before[3], after[3];
    steps(sim, 100);
    mean_of(sim, 0, sim->v, before);
    steps(sim, 100);
    mean_of(sim, 0, sim->v, after);
    test_close(sim);
    return (after[0] - before[0]) / 0.5;
}

/* Coulomb's law: tan 26.57 degrees = 0.5 */
static void test_slope(void **state) {
    (void)state;
    double angle = 30.0 * pi / 180.0;
    double theory = 9.81 * (sin(angle) - 0.5 * cos(angle));
    assert_true(fabs(slide(26.1)) < 1e-3);
    assert_true(slide(27.1) > 0.0);
    assert_true(fabs(slide(30.0) - theory) < 0.01 * theory);
}

/* Five boxes of the same size on each other, edge over edge. */
static pdyn_sim *load_stack(void) {
    char text[2048] =
        RIGID_HEAD("0.005", "[0, -9.81, 0]",
                   ", 'contact': {'thickness': 0.002, 'stiffness': 1e5}, 'solids': [{'plane': "
                   "{'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 4}}]");
    for (int k = 0; k < 5; k++) {
        double low = 0.0018 + 0.1018 * k;
        size_t used = strlen(text);
        snprintf(
            text + used, sizeof text - used,
            "%s{'rigid': {'box': {'minimum': [-0.05, %g, -0.05], 'maximum': [0.05, %g, 0.05]}, "
            "'density': 1000}}",
            k ? ", " : "", low, low + 0.1);
    }
    strcat(text, "]}");
    return test_open(text);
}

/* They come to rest: every step is solved, although the closest points of parallel edges are not
 * unique. */
static void test_stack(void **state) {
    (void)state;
    pdyn_sim *sim = load_stack();
    double start[3], end[3];
    steps(sim, 60);
    mean_of(sim, 4, sim->x, start);
    for (int n = 0; n < 100; n++) assert_true(test_step(sim).step_residual <= 0.1);
    mean_of(sim, 4, sim->x, end);
    assert_true(vec3_distance(start, end) < 5e-4);
    test_close(sim);
}

#define CUBE(low, density)                                                                         \
    "{'rigid': {'box': {'minimum': [-0.05, 0, -0.05], 'maximum': [0.05, 0.1, 0.05]}, "             \
    "'translate': [0, " low ", 0], 'density': " density "}}"

/* Cubes of 1 g and `density` / 1000 kg: the largest kinetic energy while the heavy one presses on
 * the light one, `low` m above the floor. */
static double press(const char *low, const char *density) {
    double highest = 0.0;
    char text[2048];
    snprintf(text, sizeof text,
             RIGID_SCENE("0.005", "[0, -9.81, 0]",
                         ", 'contact': {'thickness': 0.004}, 'solids': [{'plane': {'center': [0, "
                         "0, 0], 'normal': [0, 1, 0], 'size': 1}}]",
                         CUBE("0.0038", "1") ", " CUBE("%s", "%s")),
             low, density);
    pdyn_sim *sim = test_open(text);
    for (int n = 0; n < 50; n++) highest = fmax(highest, test_step(sim).kinetic_energy);
    test_close(sim);
    return highest;
}

/* The light cube is not thrown by the impulses that go through it: neither where 10 kg fall on it
 * by 8 mm, which are 0.8 J, nor where the first step, one of Euler, presses 1000 kg on it. */
static void test_light_under_heavy(void **state) {
    (void)state;
    assert_true(press("0.112", "10000") < 1.0);
    assert_true(press("0.1076", "1e6") < 10.0);
}

/* A cube of 100 kg falls by 2 mm onto one of 0.1 kg, corner over corner: their upright edges are
 * parallel and carry no force of their own, wherever the corners were when the edges were listed.
 */
static void test_edge_over_edge(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(RIGID_SCENE("0.005", "[0, -9.81, 0]",
                              ", 'contact': {'thickness': 0.004, 'friction': 0.4}, 'solids': "
                              "[{'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 1}}]",
                              CUBE("0.003", "100") ", " CUBE("0.106", "1e5")));
    for (int n = 0; n < 40; n++) assert_true(test_step(sim).step_residual <= 0.1);
    test_close(sim);
}

/* A ball of 8 kg hits a floor with 20 m/s. The step in which it stops is solved: it ends where
 * contact has the force that stops the ball, closer than bodies may be placed. Meanwhile another
 * body can be placed. */
static void test_hard_impact(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        RIGID_SCENE("0.001", "[0, -9.81, 0]",
                    ", 'contact': {'thickness': 0.003, 'stiffness': 20000}, 'solids': [{'plane': "
                    "{'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 4}}]",
                    "{'velocity': [0, -20, 0], 'rigid': {'sphere': {'center': [0, 0.15, 0], "
                    "'radius': 0.1}, 'density': 2000}}, {'surface': {'grid': {'size': [1, 1], "
                    "'vertices': [2, 2]}, 'translate': [0, 3, 0], 'area_density': 1}}"));
    const pdyn_body *sheet = &sim->body[1];
    const pdyn_contacts *contacts = contact_current(sim->objective.contact);
    double least = 1.0;
    for (int n = 0; n < 20; n++) {
        pdyn_step_info info = test_step(sim);
        if (!sim->solved) fail_msg("step %d: %d iterations", n, info.outer_iterations);
        for (int e = 0; e < contacts->count; e++)
            least = fmin(least, contacts->contact[e].distance / contacts->contact[e].thickness);
        if (least < CONTACT_GAP)
            assert_int_equal(pdyn_set_positions(sim, sheet->first, sheet->count, sheet->rest),
                             PDYN_OK);
    }
    assert_true(least > CONTACT_LEAST && least < CONTACT_GAP);
    test_close(sim);
}

/* Five nails of 10 cm fall onto a floor and each other, and turn fast: where a path stops within a
 * turn, the rigid pose beside it is no closer than a path may lead. */
static void test_turning_nails_long(void **state) {
    (void)state;
    char text[4096] = RIGID_HEAD("0.005", "[0, -9.81, 0]",
                                 ", 'contact': {'thickness': 0.0005}, 'solids': [{'plane': "
                                 "{'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 4}}]");
    for (int k = 0; k < 5; k++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used,
                 "%s{'rigid': {'capsule': {'from': [-0.05, 0, 0], 'to': [0.05, 0, 0], 'radius': "
                 "0.0015}, "
                 "'translate': [%g, %g, 0], 'rotate': [%d, %d, %d], 'density': 7800}}",
                 k ? ", " : "", 0.01 * k, 0.35 + 0.06 * k, 10 * k, 25 * k, 30 + 20 * k);
    }
    strcat(text, "]}");
    pdyn_sim *sim = test_open(text);
    const pdyn_contacts *contacts = contact_current(sim->objective.contact);
    double least = 1.0;
    for (int n = 0; n < 80; n++) {
        test_step(sim);
        for (int e = 0; e < contacts->count; e++)
            least = fmin(least, contacts->contact[e].distance / contacts->contact[e].thickness);
    }
    print_message("least distance: %g thicknesses\n", least);
    assert_true(least > 0.999 * CONTACT_LEAST);
    test_close(sim);
}

/* A number from -size / 2 to size / 2. */
static int scattered(int k, int factor, int size) { return factor * k % size - size / 2; }

/* Bars of 0.3 m that turn by up to a radian in a step and hit each other do not intersect. seed: of
 * their directions and motions; scene: up to the list of its bodies. */
static void turn_bars(const char *scene, int count, int seed, double low) {
    char text[8192];
    snprintf(text, sizeof text, "%s", scene);
    for (int n = 0; n < count; n++) {
        size_t used = strlen(text);
        int k = n + seed;
        snprintf(text + used, sizeof text - used,
                 "%s{'rigid': {'box': {'minimum': [-0.15, -0.002, -0.01], 'maximum': [0.15, 0.002, "
                 "0.01]}, 'translate': [%g, %g, %g], 'rotate': [%d, 0, %d], 'density': 2000, "
                 "'angular_velocity': [%d, %d, %d]}, 'velocity': [0, %g, 0]}",
                 n ? ", " : "", 0.2 * (n % 3), low + 0.13 * (n / 3), 0.03 * (n % 3),
                 scattered(k, 37, 41), scattered(k, 53, 41), scattered(k, 29, 101),
                 scattered(k, 47, 101), scattered(k, 61, 101), low > 0.0 ? -4.0 : 0.0);
    }
    strcat(text, "]}");
    pdyn_sim *sim = test_open(text);
    for (int n = 0; n < 10; n++) {
        test_step(sim);
        assert_int_equal(contact_check(sim->objective.contact, 0, 0), PDYN_OK); /* intersections */
    }
    test_close(sim);
}

/* Where the path of a bar stops again and again, the bar does not move. */
static void test_turning_bars(void **state) {
    (void)state;
    turn_bars(
        RIGID_HEAD("0.02", "[0, -9.81, 0]", ", 'contact': {'thickness': 0.001, 'friction': 0.3}"),
        9, 29, 0.0);
}

/* Beside water, whose particles limit displacements: a turn may stop there, too. */
static void test_turning_bars_in_water_long(void **state) {
    (void)state;
    turn_bars(RIGID_HEAD("0.01", "[0, -9.81, 0]",
                         ", 'contact': {'thickness': 0.001, 'friction': 0.3}, 'solids': [{'box': "
                         "{'minimum': [-0.2, 0, -0.12], 'maximum': [0.6, 1.5, 0.12]}, 'open': "
                         "['+y']}]") "{'particles': {'radius': 0.015, 'rest_density': 1000, "
                                     "'fill': [{'box': {'minimum': [-0.2, 0, -0.12], 'maximum': "
                                     "[0.6, 0.12, 0.12]}}]}, 'constraints': [{'type': 'fluid'}]}, ",
              6, 6, 0.25);
}

/* A needle of 0.6 m x 1 mm falls on a floor, whose friction turns it fast about its axis: its
 * energy does not grow. */
static void test_needle(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.005", "[0, -9.81, 0]",
        ", 'contact': {'thickness': 0.002}, 'solids': [{'plane': {'center': [0, 0, 0], 'normal': "
        "[0, 1, 0], 'size': 4}}]",
        "{'rigid': {'box': {'minimum': [-0.3, -0.0005, -0.0005], 'maximum': [0.3, 0.0005, "
        "0.0005]}, 'rotate': [0, 20, 80], 'translate': [0, 0.4, 0], 'density': 7800}}"));
    double start = test_step(sim).potential_energy, highest = start;
    for (int n = 0; n < 200; n++) {
        pdyn_step_info info = test_step(sim);
        highest = fmax(highest, info.kinetic_energy + info.potential_energy);
    }
    print_message("energy up to %g of that at the start\n", highest / start);
    assert_true(highest < 1.02 * start);
    test_close(sim);
}

/* The matrix of bodies in contact is H: its solve gives the motion back that a product begins with.
 */
static void test_matrix(void **state) {
    (void)state;
    pdyn_sim *sim = load_stack();
    steps(sim, 60);
    struct objective *o = &sim->objective;
    int n = 3 * o->particles;
    double u[1024] = {0}, y[1024], z[1024] = {0}, blocks[2048], largest = 0.0;
    assert_true(n < 1024);
    for (int k = 0; k < n; k++) u[k] = sin(k * k);
    rigid_map_extend(o->rigid, u);
    assert_int_equal(objective_linearise(o, 0.0), PDYN_OK);
    objective_diagonal(o, PDYN_WHOLE, blocks);
    objective_apply(o, u, y);
    rigid_matrix_solve(o->rigid_matrix, y, z);
    assert_true(o->rigid_matrix->closed && o->rigid_matrix->pairs == 4);
    for (int k = 0; k < n; k++) largest = fmax(largest, fabs(z[k] - u[k]));
    assert_true(largest < 1e-8);
    test_close(sim);
}

/* A box, a ball and a cloth hit each other: the linear momentum stays, and nothing passes. Without
 * damping the cloth gets more speed; returns its place, m. */
static double collide(const char *scene) {
    pdyn_sim *sim = test_open(scene);
    struct momenta start = momenta_of(sim);
    steps(sim, 150);
    struct momenta end = momenta_of(sim);
    double box[3], ball[3], cloth[3];
    mean_of(sim, 0, sim->x, box), mean_of(sim, 1, sim->x, ball), mean_of(sim, 2, sim->x, cloth);
    assert_true(vec3_distance(start.linear, end.linear) < 1e-12 * vec3_length(start.linear));
    assert_true(vec3_distance(start.angular, end.angular) < 0.02 * vec3_length(start.angular));
    assert_true(box[0] < ball[0] && ball[0] < cloth[0]);
    test_close(sim);
    return cloth[0];
}

static void test_collision_long(void **state) {
    (void)state;
    assert_true(collide(COLLISION("")) > 0.582);
    assert_true(collide(COLLISION(", 'damping_ratio': 0")) > 0.585);
}

/* A floor of 15 x 15 cells of two triangles, 1 m wide. */
static void write_floor(const char *name) {
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    for (int i = 0; i < 16; i++)
        for (int j = 0; j < 16; j++)
            fprintf(file, "v %.6f 0 %.6f\n", i / 15.0 - 0.5, j / 15.0 - 0.5);
    for (int i = 0; i < 15; i++)
        for (int j = 0; j < 15; j++) {
            int a = 16 * i + j + 1;
            fprintf(file, "f %d %d %d\nf %d %d %d\n", a, a + 1, a + 17, a, a + 17, a + 16);
        }
    assert_int_equal(fclose(file), 0);
}

/* A ball slides over the edges of the floor as over a plane: it keeps its speed, its height and its
 * course, and does not spin. */
static void test_floor_of_triangles(void **state) {
    (void)state;
    write_floor("floor.obj");
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.004", "[0, -9.81, 0]",
        ", 'contact': {'thickness': 0.004, 'friction': 0}, 'solids': [{'mesh': 'floor.obj'}]",
        "{'velocity': [1, 0, 0.3], 'rigid': {'sphere': {'center': [-0.4, 0.1029, -0.1], 'radius': "
        "0.1}, 'density': 1000}}"));
    steps(sim, 20);
    double start[3], end[3], v[3];
    mean_of(sim, 0, sim->x, start);
    steps(sim, 150);
    mean_of(sim, 0, sim->x, end), mean_of(sim, 0, sim->v, v);
    assert_true(fabs(v[0] - 1.0) < 1e-3 && fabs(v[1]) < 1e-2 && fabs(v[2] - 0.3) < 1e-3);
    assert_true(fabs(end[1] - start[1]) < 2e-4);
    for (int i = 0; i < sim->body[0].count; i++)
        assert_true(vec3_distance(sim->v + 3 * i, v) < 2e-3);
    test_close(sim);
    test_remove_file("floor.obj");
}

/* A ball that slides while it spins backwards is slowed by mu g. The skin of the ball turns away
 * from the floor at its contacts, which damping must not take for a change of the normal force. */
static void test_spinning_ball_slides(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        RIGID_SCENE("0.002", "[0, -9.81, 0]",
                    ", 'contact': {'thickness': 0.004, 'friction': 0.2, 'damping_ratio': 1}, "
                    "'solids': [{'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 6}}]",
                    "{'velocity': [1, 0, 0], 'rigid': {'sphere': {'center': [0, 0.1035, 0], "
                    "'radius': 0.1}, 'mass': 4, 'angular_velocity': [0, 0, 10]}}"));
    double v[3];
    steps(sim, 50);
    mean_of(sim, 0, sim->v, v);
    assert_true(fabs((1.0 - v[0]) / (0.2 * 9.81 * 0.1) - 1.0) < 0.03);
    test_close(sim);
}

/* A cart hits another one through a light bumper, on a floor without friction: the momentum along
 * the floor stays, although the limit of an impulse takes some off the bumper's. */
static void test_bumper(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.005", "[0, -9.81, 0]",
        ", 'contact': {'thickness': 0.002, 'friction': 0}, 'solids': [{'box': {'minimum': [-9, -1, "
        "-9], 'maximum': [9.3, 0, 8]}}]",
        "{'velocity': [2, 0, 0], 'rigid': {'box': {'minimum': [-0.4, 0.0018, -0.05], 'maximum': "
        "[-0.2, 0.1, 0.05]}, 'mass': 1}}, {'rigid': {'box': {'minimum': [-0.0215, 0.0018, -0.05], "
        "'maximum': [-0.002, 0.1, 0.05]}, 'mass': 0.05}}, {'rigid': {'box': {'minimum': [0, "
        "0.0018, -0.05], 'maximum': [0.2, 0.1, 0.05]}, 'mass': 1}}"));
    pdyn_step_info info = {0};
    for (int n = 0; n < 80; n++) info = test_step(sim);
    assert_true(fabs(info.momentum[0] - 2.0) < 0.01);
    test_close(sim);
}

/* A corner of a cloth is drawn against a post that hinges on a vertex. The limit of an impulse
 * takes most of it off the light corner, which must not get it back: it would fly off with 26 J. */
static void test_corner_at_a_hinged_post(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.005", "[0, -9.81, 0]", ", 'contact': {'thickness': 0.01}",
        "{'name': 'post', 'rigid': {'box': {'minimum': [-0.53, 0.012, -0.53], 'maximum': [-0.47, "
        "0.6, -0.47]}, 'density': 500}, 'constraints': [{'type': 'pin', 'vertices': {'vertices': "
        "[0]}}]}, {'surface': {'grid': {'size': [0.3, 0.3], 'vertices': [11, 11]}, 'translate': "
        "[-0.3, 0.6, -0.3], 'area_density': 0.3}, 'constraints': [{'type': 'spring', "
        "'stretching_stiffness': 1000}, {'type': 'attachment', 'to': 'post', 'vertices': "
        "{'vertices': [0]}, 'stiffness': 1e4, 'length': 0}]}"));
    pdyn_step_info info = {0};
    for (int n = 0; n < 12; n++) info = test_step(sim);
    assert_true(info.kinetic_energy < 0.2);
    test_close(sim);
}

#define CART(motion, minimum, maximum)                                                             \
    "{'velocity': " motion ", 'rigid': {'box': {'minimum': " minimum ", 'maximum': " maximum       \
    "}, 'mass': 1}}, "
#define BUMPER(place)                                                                              \
    "{'volume': {'grid': {'size': [0.1, 0.1, 0.1], 'cells': [2, 2, 2]}, 'translate': " place       \
    ", 'density': 50}, 'constraints': [{'type': 'tet', 'stiffness': 1e5}]}"

/* Two pairs of carts 100 m apart meet through light soft bumpers, one pair along x, one along z:
 * the momentum that the limit of an impulse takes off a bumper, and that of a solve that ended
 * early, stay with their pair. */
static void test_two_bumpers(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.005", "[0, 0, 0]", ", 'contact': {'thickness': 0.005}, 'solver': {'tolerance': 0.5}",
        CART("[2, 0, 0]", "[-0.2, -0.05, -0.05]", "[-0.1, 0.05, 0.05]")
            CART("[0, 0, 0]", "[0.06, -0.05, -0.05]", "[0.16, 0.05, 0.05]")
                CART("[0, 0, 2]", "[99.95, -0.05, -0.2]", "[100.05, 0.05, -0.1]")
                    CART("[0, 0, 0]", "[99.95, -0.05, 0.06]", "[100.05, 0.05, 0.16]")
                        BUMPER("[0, 0, 0]") ", " BUMPER("[100, 0, 0]")));
    double along_z = 0.0;
    for (int n = 0; n < 30; n++) test_step(sim);
    for (int b = 0; b < 2; b++) {
        double v[3];
        mean_of(sim, b, sim->v, v);
        along_z += v[2];
    }
    const struct objective_body *bumper = &sim->objective.body[4];
    for (int i = bumper->first; i < bumper->first + bumper->count; i++)
        along_z += sim->objective.mass[i] * sim->v[3 * (size_t)i + 2];
    print_message("%g\n", along_z);
    assert_true(fabs(along_z) < 1e-12);
    test_close(sim);
}

/* A cart pushes a light bumper and a second cart against a pinned post. What the limit takes off
 * the impulses of the bumper, the carts and the pins get: the momentum is that of the pins' forces.
 */
static void test_bumper_at_a_pinned_post(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.005", "[0, 0, 0]", ", 'contact': {'thickness': 0.005}, 'solver': {'tolerance': 1e-5}",
        CART("[2, 0, 0]", "[-0.2, -0.05, -0.05]", "[-0.1, 0.05, 0.05]")
            CART("[0, 0, 0]", "[0.06, -0.05, -0.05]", "[0.16, 0.05, 0.05]")
                BUMPER("[0, 0, 0]") ", {'volume': {'grid': {'size': [0.1, 0.1, 0.1], 'cells': [2, "
                                    "2, 2]}, 'translate': "
                                    "[0.214, 0, 0], 'density': 500}, 'constraints': [{'type': "
                                    "'tet', 'stiffness': 1e5}, "
                                    "{'type': 'pin', 'vertices': {'box': {'minimum': [0.26, -1, "
                                    "-1], 'maximum': [0.27, "
                                    "1, 1]}}}]}"));
    pdyn_step_info info = {0};
    double by_pins = 0.0;
    for (int n = 0; n < 60; n++) info = test_step(sim), by_pins += info.h * info.pin_reaction[0];
    assert_true(by_pins < -3.0);
    assert_true(fabs(info.momentum[0] - 2.0 - by_pins) < 0.02);
    test_close(sim);
}

/* A box turns about its middle on the diagonal of a floor of two triangles, which is no bump: mu g
 * m on four corners stops it. */
static void test_turning_on_a_diagonal(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        RIGID_SCENE("0.005", "[0, -9.81, 0]",
                    ", 'contact': {'thickness': 0.004, 'friction': 0.3}, 'solids': [{'box': "
                    "{'minimum': [-2, -0.2, -2], 'maximum': [2, 0, 2]}}]",
                    "{'rigid': {'box': {'minimum': [-0.1, 0.0032, -0.1], 'maximum': [0.1, 0.0532, "
                    "0.1]}, 'density': 500, 'angular_velocity': [0, 20, 0]}}"));
    double start[3], end[3], corner = sqrt(0.02);
    steps(sim, 10);
    vec3_cross(start, sim->x, sim->v);
    steps(sim, 40);
    vec3_cross(end, sim->x, sim->v);
    double turn = (start[1] - end[1]) / (corner * corner) / 0.2;
    assert_true(fabs(turn / (6.0 * 0.3 * 9.81 / (sqrt(2.0) * 0.2)) - 1.0) < 0.01);
    test_close(sim);
}

/* How far, rad, a box at rest on a table that turns with 6 rad/s is behind the table. */
static double lag_of(const pdyn_sim *sim) {
    double middle[3], turn = 6.0 * pdyn_time(sim);
    mean_of(sim, 0, sim->x, middle);
    return atan2(sin(turn + atan2(middle[2], middle[0])), cos(turn + atan2(middle[2], middle[0])));
}

/* What friction remembers turns with the table: the box does not creep. */
static void test_turntable(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        RIGID_SCENE("0.005", "[0, -9.81, 0]",
                    ", 'contact': {'thickness': 0.004, 'friction': 0.5}, 'solids': [{'box': "
                    "{'minimum': [-1, -0.2, -1], 'maximum': [1, 0, 1]}, 'motion': [{'time': 0}, "
                    "{'time': 1000, 'rotate': [0, 343774.677, 0]}]}]",
                    "{'velocity': [0, 0, -0.6], 'rigid': {'box': {'minimum': [-0.05, 0.0036, "
                    "-0.05], 'maximum': [0.05, 0.0536, 0.05]}, 'translate': [0.1, 0, 0], "
                    "'density': 500, 'angular_velocity': [0, 6, 0]}}"));
    steps(sim, 200);
    double lag = lag_of(sim);
    steps(sim, 400);
    assert_true(fabs(lag) < 0.01 && fabs(lag_of(sim) - lag) < 1e-5);
    test_close(sim);
}

/* A box falls on a pinned plate: in the mean, the pins hold what gravity and the fall give. */
static void test_pinned_plate(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(RIGID_SCENE(
        "0.005", "[0, -9.81, 0]", ", 'contact': {'thickness': 0.003, 'friction': 0.3}",
        "{'rigid': {'box': {'minimum': [-0.06, 0.3, -0.06], 'maximum': [0.06, 0.42, 0.06]}, "
        "'mass': 2}}, {'rigid': {'box': {'minimum': [-0.3, -0.04, -0.3], 'maximum': [0.3, 0, "
        "0.3]}, 'mass': 1}, 'constraints': [{'type': 'pin', 'vertices': {'all': true}}]}"));
    double impulse = 0.0, v[3];
    for (int n = 0; n < 200; n++) {
        pdyn_step_info info = test_step(sim);
        impulse += info.h * info.pin_reaction[1];
    }
    mean_of(sim, 0, sim->v, v);
    double fall = 2.0 * sqrt(2.0 * 9.81 * 0.3), due = 3.0 * 9.81 * pdyn_time(sim) + 2.0 * v[1];
    assert_true(fabs(impulse - due) < 0.03 * fall);
    test_close(sim);
}

/* Forces on the vertices of a body, which have hardly any mass, do not make the regions of contact
 * larger. */
static void test_forces_on_vertices(void **state) {
    (void)state;
    pdyn_sim *sim = load_stack();
    double force[24];
    for (int k = 0; k < 24; k++) force[k] = 1.0;
    assert_int_equal(pdyn_set_forces(sim, 0, 8, force), PDYN_OK);
    steps(sim, 2);
    const struct contact *c = sim->objective.contact;
    for (int i = 0; i < c->points; i++) assert_true(c->broad.reach[i] < 0.1);
    test_close(sim);
}

#define TILTED_BOX(name, mass, place, velocity)                                                    \
    "{'name': '" name "', 'rigid': {'box': {'minimum': [-0.1, -0.05, -0.08], 'maximum': [0.1, "    \
    "0.05, 0.08]}, 'mass': " mass ", " place "}, 'velocity': [" velocity ", 0, 0]}"
#define LEFT TILTED_BOX("left", "1", "'rotate': [-6, 7, 51]", "2")
#define RIGHT                                                                                      \
    TILTED_BOX("right", "2", "'rotate': [-4, 1, 10], 'translate': [0.3, 0.03, 0.02]", "-1")
#define TWO_BOXES(friction, first, second)                                                         \
    RIGID_SCENE("0.002", "[0, 0, 0]",                                                              \
                ", 'contact': {'thickness': 0.006, 'damping_ratio': 1, 'friction': " friction      \
                "}, 'solver': {'tolerance': 1e-9}",                                                \
                PAIR(first, second))

/* Two boxes hit each other alike, whichever is the first in the scene. */
static void check_order(const char *const scene[2]) {
    double v[2][3];
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(scene[k]);
        steps(sim, 75);
        mean_of(sim, k, sim->v, v[k]);
        test_close(sim);
    }
    print_message("%g %g\n", v[0][0], vec3_distance(v[0], v[1]));
    assert_true(v[0][0] < 0.5);
    assert_true(vec3_distance(v[0], v[1]) < 1e-7);
}

static void test_order(void **state) {
    (void)state;
    check_order((const char *[]){TWO_BOXES("0", LEFT, RIGHT), TWO_BOXES("0", RIGHT, LEFT)});
    check_order((const char *[]){TWO_BOXES("0.5", LEFT, RIGHT), TWO_BOXES("0.5", RIGHT, LEFT)});
}

#define CROSSED(place, motion)                                                                     \
    "{'rigid': {'box': {'minimum': [-0.1, -0.1, -0.1], 'maximum': [0.1, 0.1, 0.1]}, 'density': "   \
    "700, " place "}, 'velocity': " motion "}"
/* Two cubes that meet edge to edge; z: the sign of all that the mirror turns. */
#define CROSSED_CUBES(z)                                                                           \
    RIGID_SCENE("0.002", "[0, 0, 0]",                                                              \
                ", 'contact': {'thickness': 0.004, 'friction': 0}, 'solver': {'tolerance': 1e-9}", \
                PAIR(CROSSED("'rotate': [" z "8, 0, 45], 'translate': [0, 0.145, 0]",              \
                             "[0.5, -1, " z "0.3]"),                                               \
                     CROSSED("'rotate': [" z "45, 0, 0], 'angular_velocity': [0, " z               \
                             "1, 0], 'translate': [0.01, -0.145, " z "0.01]",                      \
                             "[-0.4, 1, 0]")))

/* A collision and its image in a mirror at z = 0. */
static void check_mirror(const char *scene, const char *image) {
    double v[2][3];
    for (int k = 0; k < 2; k++) {
        pdyn_sim *sim = test_open(k ? image : scene);
        steps(sim, 20);
        mean_of(sim, 0, sim->v, v[k]);
        test_close(sim);
    }
    v[1][2] *= -1.0;
    print_message("%g %g\n", v[0][0], vec3_distance(v[0], v[1]));
    assert_true(vec3_distance(v[0], v[1]) < 1e-9);
}

/* An impact depends neither on the four points that stand for a rigid body, which have no mirror
 * image, nor on the diagonals of its faces. */
static void test_mirror(void **state) {
    (void)state;
    check_mirror(CROSSED_CUBES(""), CROSSED_CUBES("-"));
    check_mirror(
        TWO_BOXES("0", LEFT, RIGHT),
        TWO_BOXES("0", TILTED_BOX("left", "1", "'rotate': [6, -7, 51]", "2"),
                  TILTED_BOX("right", "2", "'rotate': [4, -1, 10], 'translate': [0.3, 0.03, -0.02]",
                             "-1")));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forces_on_vertices),
        cmocka_unit_test(test_slope),
        cmocka_unit_test(test_stack),
        cmocka_unit_test(test_light_under_heavy),
        cmocka_unit_test(test_edge_over_edge),
        cmocka_unit_test(test_hard_impact),
        cmocka_unit_test(test_turning_nails_long),
        cmocka_unit_test(test_turning_bars),
        cmocka_unit_test(test_turning_bars_in_water_long),
        cmocka_unit_test(test_needle),
        cmocka_unit_test(test_floor_of_triangles),
        cmocka_unit_test(test_spinning_ball_slides),
        cmocka_unit_test(test_bumper),
        cmocka_unit_test(test_two_bumpers),
        cmocka_unit_test(test_corner_at_a_hinged_post),
        cmocka_unit_test(test_bumper_at_a_pinned_post),
        cmocka_unit_test(test_turning_on_a_diagonal),
        cmocka_unit_test(test_turntable),
        cmocka_unit_test(test_pinned_plate),
        cmocka_unit_test(test_matrix),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_collision_long),
    };
    return cmocka_run_group_tests_name("rigid contact", tests, test_enter_directory,
                                       test_leave_directory);
}
