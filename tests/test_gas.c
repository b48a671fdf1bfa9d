/* Gas in a closed surface: pressures of every law, equilibrium with a membrane, motion as a whole,
 * the probe, and bad parameters and meshes. */
#include "support.h"

#include "geometry/mesh.h"
#include "projdyn/control.h"
#include "projdyn/probe.h"

#define CUBE                                                                                       \
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"                     \
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n"
#define OUT CUBE "f 2 4 8 6\n"
#define INWARDS                                                                                    \
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n" /* V = 1/6 */

/* A second piece that faces outwards: V = 1/3. */
#define OPPOSED INWARDS "v 2 0 0\nv 3 0 0\nv 2 1 0\nv 2 0 1\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n"

#define GAS(keys)    "{'type': 'gas'" keys "}"
#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

/* A body "ball" with this mesh; settings: keys before the bodies; rest: keys after them. Valid
 * until the next call. */
static const char *ball_scene(const char *settings, const char *mesh, const char *constraints,
                              const char *rest) {
    static char text[4096];
    snprintf(text, sizeof text,
             SCENE("'duration': 1000, 'frame_interval': 1000, %s",
                   "{'name': 'ball', 'surface': {'mesh': '%s', 'area_density': 0.3}, "
                   "'constraints': [%s]}",
                   "%s"),
             settings, mesh, constraints, rest);
    return text;
}

/* The shipped ball: 386 vertices, radius 0.1 m. */
static const char *ball_mesh(void) {
    static char path[1024];
    const char *root = getenv("PROJDYN_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/scenes/meshes/ball.obj", root ? root : ".");
    return path;
}

/* ---- the law --------------------------------------------------------------------------------- */

/* Overpressure of a body of volume V from its forces f = p grad V: sum of f . x = 3 p V. */
static double pressure_of(const pdyn_sim *sim, double volume) {
    double force[3 * 8], sum = 0.0;
    const pdyn_state s = pdyn_get_state(sim);
    assert_int_equal(pdyn_constraint_forces(sim, 0, force), PDYN_OK);
    for (int k = 0; k < 3 * s.particles; k++) sum += force[k] * s.x[k];
    return sum / (3.0 * volume);
}

/* A cube or a tetrahedron that is scaled, in a step too short to move it. The probe has the same
 * pressure and volume. */
static void test_laws(void **state) {
    (void)state;
    static const struct {
        const char *mesh, *keys;
        double rest, scale, expected; /* m^3, 1, Pa */
    } cases[] = {
        {OUT, "", 1.0, 1.0, 0.0},
        {OUT, "", 1.0, 0.9, 101325.0 * 0.556616},             /* 0.9^-4.2 - 1 */
        {OUT, ", 'gamma': 1", 1.0, 0.9, 101325.0 * 0.371742}, /* 0.9^-3 - 1 */
        {OUT, ", 'gamma': 0, 'overpressure': 500", 1.0, 1.2, 500.0},
        {OUT, ", 'overpressure': 2000, 'outside': 0, 'gamma': 2", 1.0, 2.0, 2000.0 / 64.0},
        {OUT, ", 'inflation': 8, 'overpressure': -1000", 1.0, 2.0, -1000.0},
        {OUT, ", 'bulk_modulus': 1e6", 1.0, 0.9, 1e6 * 0.271},
        {OUT, ", 'bulk_modulus': 1e6, 'inflation': 2, 'overpressure': 300", 1.0, 1.0, 500300.0},
        {OUT, ", 'outside': 1", 1.0, 0.01, 4.1 * 369.077}, /* finite below a hundredth */
        {INWARDS, ", 'overpressure': 500", 1.0 / 6.0, 1.0, 500.0},
        {INWARDS, ", 'gamma': 1", 1.0 / 6.0, 0.9, 101325.0 * 0.371742},
        {OPPOSED, ", 'gamma': 1", 1.0 / 3.0, 0.9, 101325.0 * 0.371742},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        char constraint[512];
        double x[3 * 8];
        test_write_text("cube.obj", cases[k].mesh);
        snprintf(constraint, sizeof constraint, GAS("%s"), cases[k].keys);
        pdyn_sim *sim =
            test_open(ball_scene("'gravity': [0, 0, 0], 'time_step': {'fixed': 1e-9}", "cube.obj",
                                 constraint, ", 'probes': [{'inside': 'ball'}]"));
        const pdyn_state s = pdyn_get_state(sim);
        for (int i = 0; i < 3 * s.particles; i++) x[i] = cases[k].scale * s.x[i];
        assert_int_equal(pdyn_set_positions(sim, 0, s.particles, x), PDYN_OK);
        test_step(sim);
        double volume = cases[k].rest * pow(cases[k].scale, 3.0), p = pressure_of(sim, volume);
        if (fabs(p - cases[k].expected) > 1e-5 * fabs(cases[k].expected) + 1e-6)
            fail_msg("case %d: %.8g Pa, expected %.8g", k, p, cases[k].expected);
        const double *value = pdyn_get_probe(sim, 0).value;
        assert_true(fabs(value[0] / volume - 1.0) < 1e-6);
        assert_true(fabs(value[1] - p) <= 1e-6 * fabs(p) + 1e-6);
        test_close(sim);
        test_remove_file("cube.obj");
    }
}

/* ---- with a membrane ------------------------------------------------------------------------- */

/* An elastic ball at rest has the overpressure 2 T / R, T = Y (l - 1) / l at the stretch l. With
 * all solvers and steps. */
static void test_tension(void **state) {
    (void)state;
    static const char *const solvers[] = {"'type': 'hybrid'", "'type': 'cg'",
                                          "'type': 'cholesky', 'step': 'projective'"};
    for (int k = 0; k < COUNT(solvers); k++) {
        char settings[512];
        if (test_lacks_solver(solvers[k])) continue;
        snprintf(settings, sizeof settings,
                 "'gravity': [0, 0, 0], 'time_step': {'fixed': 0.05, 'integrator': 'euler'}, "
                 "'solver': {%s, 'tolerance': 1e-3, 'outer_iterations': 300}",
                 solvers[k]);
        pdyn_sim *sim = test_open(ball_scene(
            settings, ball_mesh(), STRAIN("1000") ", " GAS(", 'overpressure': 1000, 'gamma': 0"),
            ", 'probes': [{'inside': 'ball'}]"));
        double start = mesh_volume(sim->body[0].triangles, sim->body[0].triangle, sim->x);
        for (int n = 0; n < 40; n++) test_step(sim);
        const double *value = pdyn_get_probe(sim, 0).value;
        double radius = cbrt(0.75 / acos(-1.0) * value[0]), rest = cbrt(0.75 / acos(-1.0) * start);
        double tension = 1000.0 * (1.0 - rest / radius);
        assert_true(fabs(value[1] - 1000.0) < 1e-3);
        if (fabs(2.0 * tension / radius / value[1] - 1.0) > 0.03)
            fail_msg("%s: 2 T / R = %g Pa, radius %g m", solvers[k], 2.0 * tension / radius,
                     radius);
        test_close(sim);
    }
}

/* A stiff gas does not resist translation, and its tangent leaves few iterations: a ball that is
 * out of shape falls freely. */
static void test_fall(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(ball_scene("'time_step': {'fixed': 0.01, 'integrator': 'euler'}, 'solver': "
                             "{'tolerance': 0.01, 'outer_iterations': 100}",
                             ball_mesh(), STRAIN("1000") ", " GAS(", 'overpressure': 1000"), ""));
    const pdyn_state s = pdyn_get_state(sim);
    double *x = calloc(3 * (size_t)s.particles, sizeof *x), middle = 0.0, mass = 0.0;
    int iterations = 0;
    assert_non_null(x);
    for (int k = 0; k < 3 * s.particles; k++) x[k] = (k % 3 ? 0.95 : 1.1) * s.x[k];
    assert_int_equal(pdyn_set_positions(sim, 0, s.particles, x), PDYN_OK);
    free(x);
    for (int n = 0; n < 10; n++) {
        pdyn_step_info info = test_step(sim);
        iterations += info.outer_iterations;
        assert_true(info.step_residual <= 0.01);
    }
    for (int i = 0; i < s.particles; i++) middle += s.mass[i] * s.x[3 * i + 1], mass += s.mass[i];
    assert_true(fabs(middle / mass + 9.81 * 0.0055) < 1e-9); /* g h^2 n (n + 1) / 2 */
    assert_in_range(iterations, 10, 120);
    test_close(sim);
}

/* H = M/h^2 + w G'(I - (1 - eps) J) G is linear in eps. */
static void test_linear(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        ball_scene("'solver': {'type': 'cg'}", ball_mesh(), GAS(", 'overpressure': 1000"), ""));
    struct objective *objective = &sim->objective;
    int n = 3 * objective->particles;
    double *y[3], energy, largest = 0.0, off = 0.0;
    test_step(sim);
    for (int k = 0; k < 3; k++) assert_non_null(y[k] = calloc((size_t)n + 1, sizeof **y));
    assert_int_equal(objective_local(objective, sim->x, &energy, y[0]), PDYN_OK);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(objective_linearise(objective, 0.5 * k), PDYN_OK);
        objective_apply(objective, sim->x, y[k]); /* x has a part along grad V */
    }
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, fabs(y[2][i] - y[0][i]));
        off = fmax(off, fabs(y[0][i] - 2.0 * y[1][i] + y[2][i]));
    }
    assert_true(largest > 1.0 && off < 1e-9 * largest);
    for (int k = 0; k < 3; k++) free(y[k]);
    test_close(sim);
}

/* Parameters change between steps: the ball is pumped up. */
static void test_pump(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(ball_scene("'gravity': [0, 0, 0], 'time_step': {'fixed': 0.05, 'integrator': "
                             "'euler'}, 'solver': {'outer_iterations': 300}",
                             ball_mesh(), STRAIN("10") ", " GAS(", 'overpressure': 0"),
                             ", 'probes': [{'inside': 'ball'}]"));
    test_step(sim);
    double before = pdyn_get_probe(sim, 0).value[0], two = 2.0;
    assert_int_equal(pdyn_set_parameter(sim, 1, "inflation", &two, 1), PDYN_OK);
    for (int n = 0; n < 20; n++) test_step(sim);
    assert_true(fabs(pdyn_get_probe(sim, 0).value[0] / before - 2.0) < 0.01);
    test_close(sim);
}

/* ---- bad parameters and meshes --------------------------------------------------------------- */

/* A gas that is switched off has no energy, also of its element. */
static void test_off(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(ball_scene("'gravity': [0, 0, 0]", ball_mesh(),
                                         GAS(", 'overpressure': 1000") ", " SPRINGS("1000"), ""));
    double energy = -1.0;
    for (int off = 0; off < 2; off++) {
        assert_int_equal(pdyn_enable(sim, 0, !off), PDYN_OK);
        test_step(sim);
        assert_int_equal(pdyn_element_values(sim, 0, &energy, NULL), PDYN_OK);
        assert_true(fabs(energy - pdyn_get_constraint(sim, 0).energy) <= 1e-9 * fabs(energy));
        assert_true((energy == 0.0) == off);
    }
    test_close(sim);
}

static void refuse(const char *settings, const char *mesh, const char *constraints,
                   const char *rest, const char *message) {
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    const char *text = quoted(ball_scene(settings, mesh, constraints, rest));
    assert_int_equal(pdyn_load_text(context, text, "test", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_error(quoted(message));
    pdyn_destroy(context);
}

static void refuse_mesh(const char *mesh, const char *message) {
    test_write_text("mesh.obj", mesh);
    refuse("'gravity': [0, 0, 0]", "mesh.obj", GAS(""), "", message);
    test_remove_file("mesh.obj");
}

static void test_refused(void **state) {
    (void)state;
    static const char plain[] = "'gravity': [0, 0, 0]";
    refuse_mesh(CUBE, "'gas': the mesh is not closed: the edge between vertices 1 and 3, at");
    refuse_mesh("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 2 4 3\nf 1 4 2\nf 1 3 4\n",
                "have the same vertices");
    refuse_mesh("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 2 3\nf 2 4 3\nf 1 4 2\nf 1 3 4\n",
                "the mesh is flat: it encloses no volume");
    refuse(plain, ball_mesh(), GAS(", 'gamma': 1, 'bulk_modulus': 1e6"), "",
           "'bulk_modulus' has no meaning beside 'gamma'");
    refuse(plain, ball_mesh(), GAS(", 'overpressure': -101325"), "",
           "overpressure: a gas has a pressure above 0");
    refuse(plain, ball_mesh(), GAS("") ", " GAS(""), "", "a second 'gas' constraint");
    refuse(plain, ball_mesh(), STRAIN("10"), ", 'probes': [{'inside': 'ball'}]",
           "probes[0].inside: expected a body with a 'gas'");
    if (!test_lacks_solver("cholesky"))
        refuse("'solver': {'type': 'cholesky'}", ball_mesh(), GAS(""), "",
               "solver 'cholesky': constraint 'gas' on body 'ball' couples 386 vertices");
}

#define SINKING                                                                                    \
    ", 'overpressure': [{'time': 0, 'overpressure': 0}, {'time': 1, 'overpressure': -2e5}]"

/* A change of a parameter follows the rule that the scene does, as do keys. */
static void test_refused_change(void **state) {
    (void)state;
    static const char message[] = "overpressure: a gas has a pressure above 0";
    double vacuum = -2e5;
    pdyn_sim *sim = test_open(ball_scene("'gravity': [0, 0, 0]", ball_mesh(), GAS(""), ""));
    assert_int_equal(pdyn_set_parameter(sim, 0, "overpressure", &vacuum, 1), PDYN_BAD_INPUT);
    assert_error(message);
    assert_true(pdyn_get_parameter(sim, 0, 0).value == 0.0);
    test_close(sim);
    refuse("'gravity': [0, 0, 0]", ball_mesh(), GAS(SINKING), "", message);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_laws),    cmocka_unit_test(test_tension),
        cmocka_unit_test(test_fall),    cmocka_unit_test(test_pump),
        cmocka_unit_test(test_linear),  cmocka_unit_test(test_off),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_refused_change)};
    return cmocka_run_group_tests_name("gas", tests, test_enter_directory, test_leave_directory);
}
