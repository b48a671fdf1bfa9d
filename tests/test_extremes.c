/* Scenes with extreme parameters: every step ends with finite numbers and the total energy rises by
 * at most a fraction of the energy that changes its form, or the scene is refused with a message.
 * With PROJDYN_EXTREMES set, prints the table of docs/results/stability.md. */
#include "scene_support.h"
#include "sim/measure.h"

#include <string.h>

enum { SETS = 4 };

struct extreme {
    const char *name, *scene;
    int steps;
    double rise;       /* bound of the energy's rise over the energy that changes form */
    const char *error; /* expected message where loading fails */
    const char *set[SETS];
};

#define TANK                                                                                       \
    "{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.6, 0.8, 0.2]}, 'open': ['+y']}"
#define HEAD "{'duration': 1e6, 'frame_interval': 1000, "
#define FLUID_OF(fill)                                                                             \
    "{'name': 'water', 'particles': {'radius': 0.025, 'fill': [{" fill "}]},"                      \
    " 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}"
#define BLOCK "'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.3, 0.2]}"
#define ABOVE "'box': {'minimum': [-0.2, 1.06, -0.2], 'maximum': [0.2, 1.26, 0.2]}"
#define SHEET_OF(surface, vertices)                                                                \
    "{'name': 'sheet', 'surface': {" surface ", 'area_density': 0.2}, 'constraints': [{'type': "   \
    "'spring', 'stretching_stiffness': 1000}, {'type': 'bending', 'bending_rigidity': "            \
    "1e-3}" vertices "]}"
#define PINNED(vertices) ", {'type': 'pin', 'vertices': " vertices "}"
#define GRID             "'grid': {'size': [1, 1], 'vertices': [9, 9]}, 'translate': [0, 1, 0]"
#define CORNERS          PINNED("{'vertices': [0, 8]}")

#define FLUID_FROM(fill) HEAD "'bodies': [" FLUID_OF(fill) "], 'solids': [" TANK "]}"
#define CLOTH_FROM(surface, vertices)                                                              \
    HEAD "'time_step': {'fixed': 0.01}, 'bodies': [" SHEET_OF(surface, vertices) "]}"
#define NEEDLES(width) CLOTH_FROM("'mesh': 'needle.obj', 'scale': [1, 1, " width "]", CORNERS)
#define POURED         FLUID_FROM(BLOCK)
#define HUNG           CLOTH_FROM(GRID, CORNERS)
#define BOTH_OF                                                                                    \
    HEAD "'bodies': [" FLUID_OF(ABOVE) ", " SHEET_OF(GRID, PINNED("{'border': true}")) "]}"

#define W       "bodies.water.constraints.fluid.stiffness="
#define K       "bodies.sheet.constraints.spring.stretching_stiffness="
#define B       "bodies.sheet.constraints.bending.bending_rigidity="
#define DENSITY "bodies.sheet.surface.area_density="
#define H       "time_step={\"fixed\": "

static const struct extreme extremes[] = {
    {"w = 1e-3", POURED, 40, 0.05, NULL, {W "1e-3"}},
    {"w = 1", POURED, 40, 0.05, NULL, {W "1"}},
    {"w = 1e3", POURED, 40, 0.05, NULL, {W "1e3"}},
    {"w = 1e6", POURED, 40, 0.05, NULL, {W "1e6"}},
    {"w = 1e9", POURED, 40, 0.05, NULL, {W "1e9"}},
    {"w = 1e12", POURED, 40, 0.05, NULL, {W "1e12"}},
    {"K = 1e-3", HUNG, 40, 0.05, NULL, {K "1e-3"}},
    {"K = 1", HUNG, 40, 0.05, NULL, {K "1"}},
    {"K = 1e6", HUNG, 40, 0.05, NULL, {K "1e6"}},
    {"K = 1e9", HUNG, 40, 0.05, NULL, {K "1e9"}},
    {"K = 2e9", HUNG, 40, 0.05, NULL, {K "2e9"}},
    {"K = 1e12", HUNG, 40, 0.05, NULL, {K "1e12"}},
    {"B = 1e-9", HUNG, 40, 0.05, NULL, {B "1e-9"}},
    {"B = 1", HUNG, 40, 0.05, NULL, {B "1"}},
    {"B = 1e6", HUNG, 40, 0.05, NULL, {B "1e6"}},
    {"B = 1e12", HUNG, 40, 0.05, NULL, {B "1e12"}},
    {"fluid, h = 1e-6 s", POURED, 20, 0.05, NULL, {H "1e-6}"}},
    {"fluid, h = 1e-4 s", POURED, 20, 0.05, NULL, {H "1e-4}"}},
    {"fluid, h = 0.01 s", POURED, 20, 0.05, NULL, {H "0.01}"}},
    {"fluid, h = 0.1 s", POURED, 20, 0.05, NULL, {H "0.1}"}},
    {"fluid, h = 1 s", POURED, 20, 0.05, NULL, {H "1}"}},
    {"cloth, h = 1e-6 s", HUNG, 20, 0.05, NULL, {H "1e-6}"}},
    {"cloth, h = 1e-4 s", HUNG, 20, 0.05, NULL, {H "1e-4}"}},
    {"cloth, h = 0.1 s", HUNG, 20, 0.05, NULL, {H "0.1}"}},
    {"cloth, h = 1 s", HUNG, 20, 0.05, NULL, {H "1}"}},
    {"coupled, h = 1e-6 s", BOTH_OF, 10, 0.05, NULL, {H "1e-6}"}},
    {"coupled, h = 1e-4 s", BOTH_OF, 10, 0.05, NULL, {H "1e-4}"}},
    {"coupled, h = 0.01 s", BOTH_OF, 10, 0.05, NULL, {H "0.01}"}},
    {"coupled, h = 0.1 s", BOTH_OF, 4, 0.05, NULL, {H "0.1}"}},
    {"coupled, h = 1 s", BOTH_OF, 2, 0.05, NULL, {H "1}"}},
    {"water 1e8 times as heavy as a vertex",
     BOTH_OF,
     20,
     0.05,
     NULL,
     {DENSITY "1e-6", "bodies.water.particles.rest_density=1.25e4"}},
    {"water 5e5 times as heavy as a vertex", BOTH_OF, 20, 0.05, NULL, {DENSITY "1.6e-5"}},
    {"water 500 times as heavy as a vertex", BOTH_OF, 20, 0.05, NULL, {DENSITY "0.016"}},
    {"water as heavy as a vertex", BOTH_OF, 20, 0.05, NULL, {DENSITY "8"}},
    {"a vertex 1e8 times as heavy as water",
     BOTH_OF,
     20,
     0.05,
     NULL,
     {DENSITY "1e6", "bodies.water.particles.rest_density=1"}},
    {"one particle", FLUID_FROM("'file': 'one.ply'"), 60, 0.05, NULL, {NULL}},
    {"two particles at one place", FLUID_FROM("'file': 'two.ply'"), 60, 0.05, NULL, {NULL}},
    {"1,000 particles at one place", FLUID_FROM("'file': 'thousand.ply'"), 20, 0.05, NULL, {NULL}},
    {"a particle by itself", FLUID_FROM("'file': 'apart.ply'"), 40, 0.05, NULL, {NULL}},
    {"particles outside of the tank", FLUID_FROM("'file': 'outside.ply'"), 40, 0.05, NULL, {NULL}},
    {"twice the rest density", FLUID_FROM("'file': 'dense.ply'"), 40, 0.05, NULL, {NULL}},
    {"cloth folded flat onto itself",
     CLOTH_FROM("'mesh': 'folded.obj'", CORNERS),
     40,
     0.05,
     NULL,
     {NULL}},
    {"springs of length 0", CLOTH_FROM("'mesh': 'point.obj'", ""), 40, 0.05, "area", {NULL}},
    {"needles, 1 to 1e6, cholesky",
     NEEDLES("1e-6"),
     40,
     0.05,
     "could not factor",
     {"solver.type=cholesky"}},
    {"needles, 1 to 1e6, cg", NEEDLES("1e-6"), 40, 0.05, NULL, {"solver.type=cg"}},
    {"needles, 1 to 1e6", NEEDLES("1e-6"), 40, 0.05, NULL, {NULL}},
    {"needles, 1 to 1e3", NEEDLES("1e-3"), 40, 0.05, NULL, {NULL}},
    {"needles, 1 to 1e6, no bending", NEEDLES("1e-6"), 40, 0.05, NULL, {B "0"}},
    {"all vertices pinned", CLOTH_FROM(GRID, PINNED("{'all': true}")), 40, 0.05, NULL, {NULL}},
    {"none pinned", CLOTH_FROM(GRID, ""), 40, 0.05, NULL, {NULL}},
    {"fluid without gravity", POURED, 40, 0.05, NULL, {"gravity=[0, 0, 0]"}},
    {"cloth without gravity", HUNG, 40, 0.05, NULL, {"gravity=[0, 0, 0]"}},
    {"fluid, gravity 1e4 m/s^2", POURED, 40, 0.05, NULL, {"gravity=[0, -1e4, 0]"}},
    {"cloth, gravity 1e4 m/s^2", HUNG, 40, 0.05, NULL, {"gravity=[0, -1e4, 0]"}},
    {"fluid at 1e4 m/s", POURED, 40, 0.05, NULL, {"bodies.water.velocity=[1e4, 0, 0]"}},
    {"cloth at 1e4 m/s", HUNG, 40, 0.05, NULL, {"bodies.sheet.velocity=[0, -1e4, 0]"}},
    /* no step is solved to its tolerance; of 17.7 J, as nothing is compressed at the start */
    {"fluid, projective, w = 1e12", POURED, 40, 0.2, NULL, {W "1e12", "solver.step=projective"}},
    {"fluid, projective, h = 1 s", POURED, 20, 0.05, NULL, {H "1}", "solver.step=projective"}},
    {"cloth, projective, K = 1e12, cholesky",
     HUNG,
     40,
     0.05,
     NULL,
     {K "1e12", "solver.step=projective", "solver.type=cholesky"}},
    {"cloth, projective, h = 1 s", HUNG, 20, 0.05, NULL, {H "1}", "solver.step=projective"}},
    {"coupled, projective, h = 1 s", BOTH_OF, 10, 0.05, NULL, {H "1}", "solver.step=projective"}},
};

/* ---- files ----------------------------------------------------------------------------------- */

typedef void place_fn(int k, double x[3]);

static void write_points(const char *name, int count, place_fn *place) {
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fprintf(file,
            "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
            "property double z\nend_header\n",
            count);
    for (int k = 0; k < count; k++) {
        double x[3] = {0.3, 0.3, 0.1};
        place(k, x);
        fprintf(file, "%.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    fclose(file);
}

static void stay(int k, double x[3]) { (void)k, (void)x; }
static void apart(int k, double x[3]) {
    x[0] = k ? 0.025 + 0.05 * k : 0.3, x[1] = k ? 0.025 : 50.0;
}
static void outside(int k, double x[3]) { x[0] = -1.0 + 0.05 * k, x[1] = -1.0; }
static void dense(int k, double x[3]) {
    const int at[3] = {k % 5, k / 5 % 5, k / 25};
    for (int a = 0; a < 3; a++) x[a] = 0.025 + 0.05 * cbrt(0.5) * at[a];
}

typedef void bend_fn(double u, double v, double x[3]);

static void write_sheet(const char *name, bend_fn *bend) {
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    for (int k = 0; k < 81; k++) {
        double x[3];
        bend(k % 9 / 8.0, k / 9 / 8.0, x);
        fprintf(file, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    for (int k = 0; k < 72; k++)
        if (k % 9 < 8)
            fprintf(file, "f %d %d %d\nf %d %d %d\n", k + 1, k + 2, k + 10, k + 2, k + 11, k + 10);
    fclose(file);
}

static void fold(double u, double v, double x[3]) { x[0] = fabs(u - 0.5), x[1] = 1.0, x[2] = v; }
static void needle(double u, double v, double x[3]) { x[0] = u, x[1] = 1.0, x[2] = v; }
static void point(double u, double v, double x[3]) { (void)u, (void)v, x[0] = x[1] = x[2] = 0.5; }

static int write_files(void **state) {
    int failed = scene_set_up(state);
    write_points("one.ply", 1, stay);
    write_points("two.ply", 2, stay);
    write_points("thousand.ply", 1000, stay);
    write_points("apart.ply", 10, apart);
    write_points("outside.ply", 30, outside);
    write_points("dense.ply", 125, dense);
    write_sheet("folded.obj", fold);
    write_sheet("needle.obj", needle);
    write_sheet("point.obj", point);
    return failed;
}

static int remove_files(void **state) {
    const char *const names[] = {"one.ply",    "two.ply",     "thousand.ply",
                                 "apart.ply",  "outside.ply", "dense.ply",
                                 "folded.obj", "needle.obj",  "point.obj"};
    for (int k = 0; k < COUNT(names); k++) test_remove_file(names[k]);
    return scene_tear_down(state);
}

/* ---- runs ------------------------------------------------------------------------------------ */

struct course {
    double start, all, moving; /* J: at the start; largest total; largest without constraints */
    double kinetic, low, high; /* J */
    double residual;
    int steps, retries, linear;
};

static double moving(const pdyn_step_info *info) {
    return info->kinetic_energy + info->potential_energy;
}

/* Initial energy, constraints included. */
static void look_at_start(pdyn_sim *sim, struct course *course) {
    pdyn_step_info info = {0};
    double energy;
    sim->objective.h = 1.0;
    memcpy(sim->objective.s, sim->x, objective_bytes(&sim->objective));
    assert_int_equal(objective_local(&sim->objective, sim->x, &energy, sim->gradient), PDYN_OK);
    measure_step(sim, &info);
    course->start = moving(&info) + info.constraint_energy;
    course->all = course->start, course->moving = moving(&info);
    course->low = course->high = info.potential_energy;
    course->kinetic = info.kinetic_energy;
}

static void follow(struct course *course, const pdyn_step_info *info) {
    course->all = fmax(course->all, moving(info) + info->constraint_energy);
    course->moving = fmax(course->moving, moving(info));
    course->low = fmin(course->low, info->potential_energy);
    course->high = fmax(course->high, info->potential_energy);
    course->kinetic = fmax(course->kinetic, info->kinetic_energy);
    course->residual = fmax(course->residual, info->step_residual);
    course->retries += info->retries, course->linear += info->linear_iterations;
    course->steps++;
}

static bool is_finite(const pdyn_sim *sim) {
    pdyn_state state = pdyn_get_state(sim);
    for (int k = 0; k < 3 * state.particles; k++)
        if (!isfinite(state.x[k]) || !isfinite(state.v[k])) return false;
    return true;
}

/* Rise of the total energy above the start, over the energy that changes its form. */
static double rise(const struct course *c, double energy) {
    double scale = fmax(c->kinetic, c->high - c->low);
    return scale > 0.0 ? fmax(0.0, energy - c->start) / scale : 0.0;
}

static void say(const struct extreme *e, const struct course *c) {
    if (getenv("PROJDYN_EXTREMES"))
        printf("| %s | %d | %.3g | %.3g | %.2g | %.2g | %.2g | %d | %d |\n", e->name, c->steps,
               c->start, c->kinetic, rise(c, c->moving), rise(c, c->all), c->residual,
               c->steps ? c->linear / c->steps : 0, c->retries);
}

static void check_message(const struct extreme *e) {
    const char *found = pdyn_last_error(context);
    if (!e->error || !strstr(found, e->error))
        fail_msg("%s: \"%s\", expected \"%s\"", e->name, found, e->error ? e->error : "no error");
}

static void run_extreme(const struct extreme *e, const char *integrator) {
    struct course course = {0};
    pdyn_sim *sim = NULL;
    const char *set[SETS + 1];
    int sets = 0;
    for (; sets < SETS && e->set[sets]; sets++) set[sets] = e->set[sets];
    set[sets++] = integrator;
    pdyn_status status = pdyn_load_text(context, quoted(e->scene), e->name, set, sets, &sim);
    if (status == PDYN_OK) look_at_start(sim, &course);
    while (status == PDYN_OK && course.steps < e->steps) {
        pdyn_step_info info;
        status = pdyn_step(sim, &info);
        if (status == PDYN_OK) follow(&course, &info);
    }
    say(e, &course);
    if (status != PDYN_OK || e->error) check_message(e);
    if (sim) assert_true(is_finite(sim));
    if (!(rise(&course, course.moving) <= e->rise))
        fail_msg("%s, %s: the energy rose by %g, at most %g expected", e->name, integrator,
                 rise(&course, course.moving), e->rise);
    pdyn_free(sim);
}

static void test_extremes(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(extremes); k++) {
        if (test_lacks_solver(extremes[k].name)) continue;
        run_extreme(&extremes[k], "time_step.integrator=euler");
        run_extreme(&extremes[k], "time_step.integrator=bdf2");
    }
}

/* Steps of a sheet that is too stiff for two iterations end unsolved. A sheet that falls beside it
 * falls all the same: what such a step takes out of the velocities is the energy that it has
 * gained, no more. */
static void test_unsolved_steps_keep_the_motion(void **state) {
    (void)state;
    static const char scene[] = HEAD
        "'time_step': {'fixed': 0.01}, 'solver': {'outer_iterations': 2}, 'bodies': [" SHEET_OF(
            GRID, CORNERS) ", {'name': 'free', 'surface': {" GRID
                           ", 'area_density': 0.2}, 'constraints': [{'type': 'spring', "
                           "'stretching_stiffness': 1000}]}]}";
    const char *set[] = {K "1e9", "time_step.integrator=euler"};
    pdyn_step_info info = {0};
    pdyn_sim *sim = test_load_with(context, scene, set, 2);
    for (int k = 0; k < 40; k++) info = test_step(sim);
    pdyn_free(sim);
    double fall = 0.5 * 0.2 * pow(9.81 * info.time, 2.0);
    if (!(info.kinetic_energy > 0.8 * fall))
        fail_msg("kinetic energy of %g J, that of the free fall is %g J", info.kinetic_energy,
                 fall);
}

/* Kinetic energy, J, of the water on the sheet after 0.5 s, with so many iterations a step. */
static double bounce(const char *iterations) {
    const char *set[] = {"time_step={\"fixed\": 0.005}", iterations};
    pdyn_step_info info = {0};
    pdyn_sim *sim = test_load_with(context, BOTH_OF, set, 2);
    for (int k = 0; k < 100; k++) info = test_step(sim);
    pdyn_free(sim);
    return info.kinetic_energy;
}

/* `auto` does not stay with `dual` where its steps end far from solved: the water would stop. */
static void test_few_iterations_do_not_stop_water(void **state) {
    (void)state;
    double few = bounce("solver.outer_iterations=2"), all = bounce("solver.outer_iterations=50");
    if (!(few > 0.6 * all)) fail_msg("%g J with two iterations, %g J if solved", few, all);
}

/* Scenes that run but may surprise: a warning says why. */
static void warns(const char *scene, const char *set, const char *text) {
    struct warnings warnings = {.text = text};
    pdyn_context *warned = test_warned_context(1, &warnings);
    pdyn_sim *sim = test_load_with(warned, scene, &set, 1);
    for (int k = 0; k < 3; k++) test_step(sim);
    assert_int_equal(warnings.count, 1);
    test_close(sim);
}

static void test_warnings(void **state) {
    (void)state;
    warns(FLUID_FROM("'file': 'thousand.ply'"), "duration=1", "1000 particles lie at the place");
    warns(FLUID_FROM("'file': 'two.ply'"), "duration=1", "2 particles lie at the place");
    warns(POURED, "bodies.water.velocity=[1e4, 0, 0]", "walls may not hold it");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_extremes), cmocka_unit_test(test_unsolved_steps_keep_the_motion),
        cmocka_unit_test(test_few_iterations_do_not_stop_water), cmocka_unit_test(test_warnings)};
    return cmocka_run_group_tests_name("extremes", tests, write_files, remove_files);
}
