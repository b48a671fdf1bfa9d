/* Warnings: particles that pass surfaces, energy from nothing, saved states. */
#include "step/crossings.h"
#include "support.h"

#include "projdyn/control.h"
#include "projdyn/module.h"

#include <string.h>

/* A block of 6 x 6 x 6 particles without constraints; velocity: "x, y, z". */
#define DUST(velocity)                                                                             \
    "{'name': 'dust', 'velocity': [" velocity "], 'particles': {'radius': 0.01, 'fill': [{'box': " \
    "{'minimum': [-0.06, 0.02, -0.06], 'maximum': [0.06, 0.14, 0.06]}}]}, 'constraints': []}"
/* A sheet of 0.16 m at y = 0. */
#define SHEET(constraints)                                                                         \
    GRID_SHEET("'name': 'sheet', ", "0.16, 0.16", "9, 9", "'area_density': 0.2",                   \
               SPRINGS("100") ", " constraints)
#define SHEET_AT(name, height)                                                                     \
    GRID_SHEET("'name': '" name "', ", "0.16, 0.16", "9, 9",                                       \
               "'area_density': 0.2, 'translate': [0, " height ", 0]", SPRINGS("100"))
#define HELD_AT(name, place)                                                                       \
    GRID_SHEET("'name': '" name "', ", "0.16, 0.16", "9, 9",                                       \
               "'area_density': 0.2, 'translate': [" place "]", PINS("'all': true"))
#define HELD       SHEET(PINS("'all': true"))
#define BORDER     SHEET(PINS("'border': true"))
#define STEPS      "'time_step': {'fixed': 0.01}, 'frame_interval': 0.01, 'duration': 1"
#define WEIGHTLESS STEPS ", 'gravity': [0, 0, 0]"

enum { DUST_COUNT = 216, LAYER = 36 };

static pdyn_warning find_warning(const pdyn_sim *sim, const char *code, const char *subject) {
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++)
        if (!strcmp(w.code, code) && !strcmp(w.subject, subject)) return w;
    return (pdyn_warning){0};
}

/* Number of particles that passed `subject` after so many steps. */
static long leaks(const char *scene, const char *subject, int steps) {
    pdyn_context *context = test_context(2);
    pdyn_sim *sim = test_load(context, scene);
    pdyn_step_info info = {0};
    for (int n = 0; n < steps; n++) info = test_step(sim);
    pdyn_warning w = find_warning(sim, "leak", subject);
    assert_true(info.leaked >= w.count || !w.code);
    test_close(sim);
    return w.code ? w.count : 0;
}

/* All particles pass, through vertices and edges, too: the lattice lies on those of the mesh. */
static void test_sheet(void **state) {
    (void)state;
    const char *fast = SCENE(WEIGHTLESS, PAIR(DUST("0, -2, 0"), HELD), "");
    assert_int_equal(leaks(fast, "sheet", 1), 0);
    assert_int_equal(leaks(fast, "sheet", 2), LAYER);
    assert_int_equal(leaks(fast, "sheet", 8), DUST_COUNT);
    assert_int_equal(leaks(SCENE(STEPS, PAIR(DUST("0, -1, 0"), BORDER), ""), "sheet", 40),
                     DUST_COUNT);
    assert_int_equal(leaks(SCENE(WEIGHTLESS, PAIR(DUST("0, 2, 0"), HELD), ""), "sheet", 8), 0);
}

#define SHIFTED(z) SCENE(WEIGHTLESS, PAIR(DUST("0, -2, 0"), HELD_AT("sheet", "0.085, 0, " z)), "")

/* Half of the block is beside the sheet, and a sixth is closer to its border than a radius, also
 * where a triangle has a vertex on the border but no edge. */
static void test_border(void **state) {
    (void)state;
    assert_int_equal(leaks(SHIFTED("0"), "sheet", 8), DUST_COUNT / 3);
    assert_int_equal(leaks(SHIFTED("0.0075"), "sheet", 8), DUST_COUNT / 3);
    assert_int_equal(leaks(SHIFTED("0.0125"), "sheet", 8), DUST_COUNT / 3);
}

#define WALL                                                                                       \
    "{'name': 'wall', 'plane': {'center': [0.085, 0, 0], 'normal': [0, 1, 0], 'size': 0.16}}"

/* The same beside a solid, whose border lies at x = 0.005: a sixth of the dust is closer to it than
 * a radius. A plate below its border closes it, so that nothing goes around. */
static void test_rim(void **state) {
    (void)state;
#define BESIDE(more) SCENE(WEIGHTLESS, DUST("0, -2, 0"), ", 'solids': [" WALL more "]")
    assert_int_equal(leaks(BESIDE(""), "wall", 8), DUST_COUNT / 3);
    assert_int_equal(leaks(BESIDE(", {'name': 'plate', 'plane': {'center': [0, -0.08, 0], "
                                  "'normal': [1, 0, 0], 'size': 0.16}}"),
                           "wall", 8),
                     DUST_COUNT / 2);
}

/* Dust that is thrown up through the sheet and falls back is on its side again. */
static void test_return(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(STEPS, PAIR(DUST("0, 3, 0"), HELD_AT("sheet", "0, 0.3, 0")), ""));
    long most = 0, last = 0;
    for (int n = 0; n < 70; n++) {
        last = test_step(sim).leaked;
        most = last > most ? last : most;
    }
    assert_int_equal(most, DUST_COUNT);
    assert_int_equal(last, 0);
    test_close(sim);
}

/* Dust passes two sheets and comes back through both: it is counted once, and then not at all. The
 * warning keeps the largest number and the time at which it was reached. */
static void test_two_sheets(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        STEPS,
        PAIR(DUST("0, 3, 0"), PAIR(HELD_AT("low", "0, 0.3, 0"), HELD_AT("high", "0, 0.36, 0"))),
        ""));
    long most = 0, last = 0;
    char reached[32] = "";
    for (int n = 0; n < 70; n++) {
        last = test_step(sim).leaked;
        most = last > most ? last : most;
        if (!*reached && find_warning(sim, "leak", "high").count == DUST_COUNT)
            snprintf(reached, sizeof reached, "by %.3g s", pdyn_time(sim));
    }
    assert_int_equal(most, DUST_COUNT);
    assert_int_equal(last, 0);
    assert_int_equal(find_warning(sim, "leak", "high").count, DUST_COUNT);
    assert_string_equal(strstr(find_warning(sim, "leak", "high").text, "by "), reached);
    test_close(sim);
}

/* A box at rest, and a plane that rises through the dust. */
static void test_solids(void **state) {
    (void)state;
    const char *box = SCENE(STEPS, DUST("0, -1, 0"),
                            ", 'solids': [{'name': 'tank', 'box': {'minimum': [-0.07, 0, -0.07], "
                            "'maximum': [0.07, 0.2, 0.07]}}]");
    const char *rising =
        SCENE(WEIGHTLESS, DUST("0, 0, 0"),
              ", 'solids': [{'name': 'lift', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], "
              "'size': 0.3}, 'motion': [{'time': 0, 'translate': [0, 0, 0]}, {'time': 0.1, "
              "'translate': [0, 0.2, 0]}]}]");
    assert_int_equal(leaks(box, "tank", 30), DUST_COUNT);
    assert_int_equal(leaks(rising, "lift", 12), DUST_COUNT);
}

/* A hinge: the side x > 0 of a sheet swings from (1, 0) to `side`, x and y, while a particle goes
 * from `begin` to `end`, near the middle of the sheet in z. Returns how many particles passed. */
static long passed_hinge(const double side[2], const double begin[2], const double end[2]) {
    pdyn_sim *sim = test_open(
        SCENE(WEIGHTLESS,
              PAIR("{'name': 'dust', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': "
                   "[0, 0.5, 0.1], 'maximum': [0.02, 0.52, 0.12]}}]}, 'constraints': []}",
                   GRID_SHEET("'name': 'sheet', ", "2, 2", "3, 3", "'area_density': 0.2",
                              SPRINGS("100"))),
              ""));
    assert_int_equal(sim->body[0].count, 1);
    double *x = sim->x, *x_next = sim->x_next;
    for (int i = 0; i < 3 * sim->objective.particles; i++) x_next[i] = x[i];
    for (int a = 0; a < 2; a++) {
        x[a] = begin[a], x_next[a] = end[a];
        for (int i = 1; i < sim->objective.particles; i++)
            if (x[3 * i] > 0.5) x_next[3 * i + a] = side[a];
    }
    crossings_step(sim, 0.01);
    long passed = crossings_total(sim);
    test_close(sim);
    return passed;
}

/* The plane of a triangle turns within a step. The particle meets it at another time than the ratio
 * of the distances at both ends says: then beside the triangle, or in it. It may also meet the
 * plane twice, beside the triangle and in it. */
static void test_hinge(void **state) {
    (void)state;
    double side[3][2] = {{-0.9, -0.9}, {0, 0.9}, {1.4, -1.5}};
    double begin[3][2] = {{-0.6, -0.7}, {-0.7, 0.1}, {1.9, -0.1}};
    double end[3][2] = {{1.0, -1.0}, {0.3, 0.4}, {-1.5, -0.5}};
    for (int k = 0; k < 3; k++) assert_int_equal(passed_hinge(side[k], begin[k], end[k]), k > 0);
}

/* A sheet that falls through a plane passes it; one that is pinned in the plane and moves by a
 * thousandth of its edges does not. */
static void test_cloth(void **state) {
    (void)state;
#define FLOOR                                                                                      \
    ", 'solids': [{'name': 'floor', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': "  \
    "1}}]"
    const char *falls = SCENE(STEPS, SHEET_AT("sheet", "0.1"), FLOOR);
    const char *moves = SCENE(STEPS,
                              SHEET("{'type': 'pin', 'vertices': {'all': true}, 'path': [[0, 0, 0, "
                                    "0], [0.1, 0, 2e-5, 0], [0.2, 0, -2e-5, 0]]}"),
                              FLOOR);
    assert_int_equal(leaks(falls, "floor", 30), 81);
    assert_int_equal(leaks(moves, "floor", 30), 0);
#undef FLOOR
}

/* ---- energy ---------------------------------------------------------------------------------- */

/* Two lattices in each other: one of the first steps fails, and the state is that before it. The
 * message names the causes that the run has shown: the overlap, and particles that passed. */
static void test_overlap(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim =
        test_load(context, "{'time_step': {'fixed': 0.001}, 'duration': 1, 'bodies': [{'name': "
                           "'water', 'particles': {'radius': 0.01, 'fill': "
                           "[{'box': {'minimum': [0, 0, 0], 'maximum': [0.1, 0.1, 0.1]}}, {'box': "
                           "{'minimum': [0.01, 0.01, 0.01], 'maximum': [0.11, 0.11, 0.11]}}]}, "
                           "'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}]}");
    uint64_t hash = 0;
    pdyn_status status = PDYN_OK;
    warnings_count(&sim->warnings, WARNING_LEAK, "", 0.0, 1, 0.0);
    for (int n = 0; n < 5 && status == PDYN_OK; n++) {
        hash = pdyn_state_hash(sim);
        status = pdyn_step(sim, NULL);
    }
    assert_int_equal(status, PDYN_DIVERGED);
    const char *error = pdyn_last_error(context);
    assert_non_null(strstr(error, "the kinetic energy rises to"));
    assert_non_null(strstr(error, "J; particles overlap at the start"));
    assert_non_null(strstr(error, "through solids, and the scene has no \"contact\""));
    assert_null(strstr(error, "unsolved"));
    assert_true(pdyn_state_hash(sim) == hash);
    test_close(sim);
}

/* A stretched sheet releases the energy that the scene gives it. */
static void test_stretched(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(
        WEIGHTLESS ", 'solver': {'tolerance': 1e-4}",
        GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.2", SPRINGS("1e3")),
        ""));
    for (int k = 0; k < sim->objective.particles; k++) sim->x[3 * k] *= 2.0;
    double fastest = 0.0;
    for (int n = 0; n < 20; n++) fastest = fmax(fastest, test_step(sim).kinetic_energy);
    assert_true(fastest > 0.1);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* Two sheets that begin at a fifth of the contact thickness release the energy of contact. */
static void test_touching(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(WEIGHTLESS, PAIR(SHEET_AT("lower", "0"), SHEET_AT("upper", "0.002")),
                        ", 'contact': {'thickness': 0.01}"));
    double fastest = 0.0;
    for (int n = 0; n < 5; n++) fastest = fmax(fastest, test_step(sim).kinetic_energy);
    assert_true(fastest > 1e-4);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* A bat gives a sheet its speed; there is no fluid. */
static void test_bat(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(WEIGHTLESS, SHEET_AT("sheet", "0"),
                        ", 'contact': {'thickness': 0.01}, 'solids': [{'box': {'minimum': [-1, -1, "
                        "-1], 'maximum': [1, -0.02, 1]}, 'motion': [{'time': 0}, {'time': 1, "
                        "'translate': [0, 5, 0]}]}]"));
    double fastest = 0.0;
    for (int n = 0; n < 10; n++) fastest = fmax(fastest, test_step(sim).kinetic_energy);
    assert_true(fastest > 10.0 * sim->energy.mass);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* A sheet at rest without gravity has the energies of rounding. */
static void test_rounding(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(WEIGHTLESS ", 'solver': {'tolerance': 1e-13, 'outer_iterations': 2}",
                        GRID_SHEET("'name': 'sheet', ", "1, 1", "11, 11",
                                   "'area_density': 0.3, 'rotate': [10, 20, 30]",
                                   SPRINGS("1e6") ", {'type': 'bending', 'bending_rigidity': 0.1}"),
                        ""));
    for (int n = 0; n < 20; n++) test_step(sim);
    assert_null(find_warning(sim, "energy", "").code);
    test_close(sim);
}

/* Steps with this kinetic energy, J, as the energy budget sees them. */
static void give_energy(pdyn_sim *sim, int steps, double kinetic) {
    pdyn_step_info info = {.kinetic_energy = kinetic};
    for (int k = 0; k < steps; k++) energy_budget_step(sim, &info);
}

/* The total energy falls for some steps and comes back: no warning. It rises after it has been
 * lower for a window of steps: a warning, although it does not reach its start. */
static void test_gain_after_loss(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SCENE(WEIGHTLESS, SHEET_AT("sheet", "0"), ""));
    test_step(sim);
    sim->energy.total = 10.0;
    give_energy(sim, 25, 10.0), give_energy(sim, 15, 6.0), give_energy(sim, 25, 10.0);
    assert_null(find_warning(sim, "energy", "").code);
    give_energy(sim, 40, 6.0);
    assert_null(find_warning(sim, "energy", "").code);
    give_energy(sim, 1, 7.0);
    assert_int_equal(find_warning(sim, "energy", "").count, 1);
    test_close(sim);
}

/* Pins let a sheet go, which falls without a warning. A gain after that is warned about; after a
 * constraint that begins, no energy is known to be too much. */
static void test_gain_after_release(void **state) {
    (void)state;
    for (int begins = 0; begins < 2; begins++) {
        pdyn_sim *sim = test_open(
            SCENE(STEPS,
                  GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.2",
                             SPRINGS("1e3") ", {'type': 'pin', 'until': 0.02, "
                                            "'vertices': {'border': true}}"),
                  ""));
        for (int n = 0; n < 20; n++) test_step(sim);
        assert_false(pdyn_is_enabled(sim, 1));
        assert_null(find_warning(sim, "energy", "").code);
        if (begins) assert_int_equal(pdyn_enable(sim, 1, true), PDYN_OK);
        give_energy(sim, 1, 1e3);
        assert_int_equal(find_warning(sim, "energy", "").count, !begins);
        test_close(sim);
    }
}

/* A pin that moves and then lets a sheet go gives energy until then; a gain after that is warned
 * about, after a return to a state before it, too. */
static void test_gain_after_path(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(STEPS,
                        GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "9, 9", "'area_density': 0.2",
                                   SPRINGS("1e3") ", {'type': 'pin', 'until': 0.02, 'vertices': "
                                                  "{'border': true}, 'path': [[0, 0, 0, 0], "
                                                  "[0.02, 0, 0.1, 0]]}"),
                        ""));
    static char state_memory[1 << 20];
    size_t size;
    for (int round = 0; round < 2; round++) {
        test_step(sim);
        if (!round)
            assert_int_equal(pdyn_save_memory(sim, state_memory, sizeof state_memory, &size),
                             PDYN_OK);
        give_energy(sim, 1, 1e3);
        for (int n = 0; n < 30; n++) test_step(sim);
        assert_false(pdyn_is_enabled(sim, 1));
        assert_null(find_warning(sim, "energy", "").code);
        if (!round) assert_int_equal(pdyn_restore_memory(sim, state_memory, size), PDYN_OK);
    }
    give_energy(sim, 1, 1e3);
    assert_int_equal(find_warning(sim, "energy", "").count, 1);
    test_close(sim);
}

/* ---- the list -------------------------------------------------------------------------------- */

/* A restored simulation goes on counting; every step of this scene is unsolved. */
static void test_saved(void **state) {
    (void)state;
    const char *scene = SCENE(STEPS ", 'solver': {'outer_iterations': 1, 'linear_iterations': 1}",
                              PAIR(DUST("0, -1, 0"), BORDER), "");
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, scene), *other = test_load(context, scene);
    for (int n = 0; n < 6; n++) test_step(sim);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    assert_int_equal(pdyn_restore(other, "state"), PDYN_OK);
    for (int n = 0; n < 4; n++) test_step(other), test_step(sim);
    for (int k = 0; k < 10; k++) {
        pdyn_warning a = pdyn_get_warning(sim, k), b = pdyn_get_warning(other, k);
        if (!a.code) break;
        assert_string_equal(a.code, b.code);
        assert_string_equal(a.text, b.text);
        assert_int_equal(a.count, b.count);
    }
    assert_int_equal(find_warning(other, "unsolved", "sheet").count, 10);
    assert_int_equal(find_warning(other, "leak", "sheet").count,
                     find_warning(sim, "leak", "sheet").count);
    assert_true(find_warning(other, "leak", "sheet").count > 0);
    pdyn_free(other);
    pdyn_free(sim);
    pdyn_destroy(context);
    test_remove_file("state");
}

#define LONG_NAME "a123456789b123456789c123456789d123456789e123456789f123456789g123"

/* A name of 64 characters: one warning that counts all steps. */
static void test_long_name(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(
        SCENE("'duration': 1, 'solver': {'outer_iterations': 1, 'tolerance': 1e-9}",
              GRID_SHEET("'name': '" LONG_NAME "', ", "0.4, 0.4", "5, 5", "'area_density': 0.2",
                         PAIR(SPRINGS("1000"), PINS("'border': true"))),
              ""));
    for (int n = 0; n < 5; n++) test_step(sim);
    assert_int_equal(find_warning(sim, "unsolved", LONG_NAME).count, 5);
    test_close(sim);
}

#define FALLING(outlets) SCENE(STEPS, DUST("0, -5, 0"), outlets)

static bool warns_of_fall(const char *scene, const char *body) {
    pdyn_sim *sim = test_open(scene);
    for (int n = 0; n < 20; n++) test_step(sim);
    bool found = find_warning(sim, "fell-out", body).code;
    test_close(sim);
    return found;
}

/* A sheet that a pin at one of its corners lowers. */
static const char *lowered =
    SCENE(STEPS,
          SHEET("{'type': 'pin', 'vertices': {'vertices': [0]}, 'path': [[0, 0, 0, 0], [0.2, 0, "
                "-1, 0]]}"),
          "");

/* Dust that falls for ever, dust that an outlet around the scene will remove, and a held sheet. */
static void test_fallen(void **state) {
    (void)state;
    assert_true(warns_of_fall(FALLING(""), "dust"));
    assert_false(warns_of_fall(
        FALLING(", 'outlets': [{'box': {'minimum': [-1, -9, -1], 'maximum': [1, 1, 1]}, 'outside': "
                "true}]"),
        "dust"));
    assert_false(warns_of_fall(lowered, "sheet"));
}

/* The triangles of a ball, which nobody chooses, beside coarse water, in thicker contact. */
static void test_ball(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE(STEPS,
                        PAIR(DUST("0, 0, 0"), "{'name': 'ball', 'rigid': {'sphere': {'center': [0, "
                                              "-0.1, 0], 'radius': 0.05}, 'density': 500}}"),
                        ", 'contact': {'thickness': 0.01}"));
    assert_null(find_warning(sim, "edge-length", "ball").code);
    assert_null(find_warning(sim, "contact-thickness", "ball").code);
    test_close(sim);
}

/* A cube of 0.1 m that moves by 0.06 m in a step, and one that is half as fast. */
static void test_fast(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.002}, 'contact': {'thickness': 0.004}, "
        "'gravity': [0, 0, 0], 'bodies': [{'name': 'cube', 'velocity': [%s, 0, 0], 'rigid': "
        "{'box': {'minimum': [0, 0, 0], 'maximum': [0.1, 0.1, 0.1]}, 'density': 500}}]}";
    static const char *const speed[] = {"30", "15"};
    for (int k = 0; k < 2; k++) {
        char text[512];
        snprintf(text, sizeof text, scene, speed[k]);
        pdyn_sim *sim = test_open(text);
        test_step(sim), test_step(sim);
        assert_int_equal(find_warning(sim, "fast", "cube").count, k ? 0 : 2);
        test_close(sim);
    }
}

/* A press comes down by 0.05 m above a rigid cube, which stops it, and 1 m beside the cube. */
static void test_press(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.005}, 'contact': {'thickness': 0.004}, "
        "'bodies': [{'name': 'cube', 'rigid': {'box': {'minimum': [0, 0.004, 0], 'maximum': [0.1, "
        "0.1, 0.1]}, 'density': 500}}], 'solids': [{'plane': {'center': [0, 0, 0], 'normal': [0, "
        "1, 0], 'size': 4}}, {'name': 'press', 'plane': {'center': [%d, 0.11, 0], 'normal': [0, "
        "-1, 0], 'size': 0.5}, 'motion': [{'time': 0}, {'time': 0.1, 'translate': [0, -0.05, "
        "0]}]}]}";
    for (int beside = 0; beside < 2; beside++) {
        char text[1024];
        double x[12];
        snprintf(text, sizeof text, scene, beside);
        pdyn_sim *sim = test_open(text);
        for (int n = 0; n < 25; n++) test_step(sim);
        pdyn_warning w = find_warning(sim, "solid-waits", "press");
        assert_int_equal(pdyn_solid_vertices(sim, 1, x), 4);
        if (beside) assert_null(w.code);
        else assert_in_range(w.count, 5, 25);
        if (beside) assert_true(fabs(x[1] - 0.06) < 1e-12);
        else assert_true(x[1] > sim->x[3 * sim->body[0].first + 7 * 3 + 1]); /* top of the cube */
        test_close(sim);
    }
}

/* A cube of 2000 kg falls on a sheet: with the stiffness of light contact, and with the default,
 * for its weight. */
static void test_pressed(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.005}, 'contact': {'thickness': 0.005%s}, "
        "'bodies': [{'name': 'sheet', 'surface': {'grid': {'size': [0.4, 0.4], "
        "'vertices': [9, 9]}, 'area_density': 0.5}, 'constraints': [{'type': 'spring', "
        "'stretching_stiffness': 5000}, {'type': 'pin', 'vertices': {'border': true}}]}, {'name': "
        "'cube', 'velocity': [0, -3, 0], 'rigid': {'box': {'minimum': [-0.05, 0.01, -0.05], "
        "'maximum': [0.05, 0.11, 0.05]}, 'mass': 2000}}]}";
    static const char *const stiffness[] = {", 'stiffness': 1000", ""};
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text, scene, stiffness[k]);
        pdyn_sim *sim = test_open(text);
        for (int n = 0; n < 60; n++) test_step(sim);
        assert_int_equal(find_warning(sim, "contact-stiffness", "").count > 0, !k);
        test_close(sim);
    }
}

/* Pins move a sheet into a plane: the warning is about the pins. */
static void test_pinned_flat(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.005}, 'contact': {'thickness': 0.005}, "
        "'bodies': [{'name': 'sheet', 'surface': {'grid': {'size': [0.2, 0.2], 'vertices': [5, "
        "5]}, 'area_density': 0.2, 'translate': [0, 0.01, 0]}, 'constraints': [{'type': 'spring', "
        "'stretching_stiffness': 500}, {'type': 'pin', 'vertices': {'border': true}, 'path': [[0, "
        "0, 0, 0], [0.1, 0, -0.02, 0]]}]}], 'solids': [{'plane': {'center': [0, 0, 0], 'normal': "
        "[0, 1, 0], 'size': 1}}]}";
    pdyn_sim *sim = test_open(scene);
    for (int n = 0; n < 25; n++) test_step(sim);
    pdyn_warning w = find_warning(sim, "contact-stiffness", "sheet");
    assert_true(w.count > 0);
    assert_non_null(strstr(w.text, "pins"));
    assert_null(find_warning(sim, "contact-stiffness", "").code);
    test_close(sim);
}

/* ---- constraints without elements ------------------------------------------------------------ */

static int no_elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count > 9 ? 1 : 0;
}
static void fill(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first, b->weight[e] = 1.0;
}

/* ---- gaps without room for particles --------------------------------------------------------- */

/* A plate sinks by `way`, m, in 0.2 s to the floor of a tank of water. It is a solid, a rigid body
 * that pins move, or a heavy free one. */
#define PLATE_IN_WATER(plate, solid)                                                               \
    SCENE("'duration': 10, 'frame_interval': 0.1",                                                 \
          FLUID_BOX("'name': 'water', ", "0.0125", "0, 0, 0", "0.3, 0.15, 0.3",                    \
                    ", 'compression': 0.001, 'viscosity': 0.1") plate,                             \
          ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.3, 0.5, "     \
          "0.3]}, 'open': ['+y']}" solid "]")
#define PLATE_BOX(height)                                                                          \
    "'box': {'minimum': [0.075, " height ", 0.075], 'maximum': [0.225, 0.1, 0.225]}"
#define SOLID_PLATE(way)                                                                           \
    PLATE_IN_WATER("",                                                                             \
                   ", {'name': 'plate', " PLATE_BOX("0.05") ", 'motion': [{'time': 0}, "           \
                                                            "{'time': 0.2, 'translate': [0, " way  \
                                                            ", 0]}]}")
#define RIGID_PLATE(constraints)                                                                   \
    PLATE_IN_WATER(                                                                                \
        ", {'name': 'plate', 'rigid': {" PLATE_BOX("0.05") ", 'density': 8000}, "                  \
                                                           "'constraints': [" constraints "]}",    \
        "")
#define MOVED(way)                                                                                 \
    "{'type': 'pin', 'vertices': {'all': true}, 'path': [[0, 0, 0, 0], [0.2, 0, " way ", 0]]}"

static pdyn_warning squeezed(const char *scene) {
    static pdyn_warning w;
    pdyn_sim *sim = test_open(scene);
    while (pdyn_time(sim) < 0.3) test_step(sim);
    w = find_warning(sim, "squeezed", "plate");
    static char text[512];
    snprintf(text, sizeof text, "%s", w.text ? w.text : "");
    w.text = text;
    print_message("%ld steps: %s\n", w.count, text);
    test_close(sim);
    return w;
}

/* The gap is 0.6 particle spacings of 25 mm, or a whole one, which has room. A free body yields. */
static void test_gaps_long(void **state) {
    (void)state;
    static const char expected[] = "particles of \"water\" are squeezed between it and \"tank\"";
    pdyn_warning w = squeezed(SOLID_PLATE("-0.035"));
    assert_non_null(strstr(w.text, expected));
    assert_non_null(strstr(w.text, "a gap below 0.025 m"));
    assert_true(w.count > 20 && w.last > 0.29);
    assert_non_null(strstr(squeezed(RIGID_PLATE(MOVED("-0.035"))).text, expected));
    assert_int_equal(squeezed(SOLID_PLATE("-0.025")).count, 0);
    assert_int_equal(squeezed(RIGID_PLATE(MOVED("-0.025"))).count, 0);
    assert_int_equal(squeezed(RIGID_PLATE("")).count, 0);
}

static void test_without_elements(void **state) {
    (void)state;
    static const pdyn_param none[] = {{0}};
    static const pdyn_constraint_type type = {.name = "large",
                                              .summary = "acts on large bodies",
                                              .flags = PDYN_ANCHORED | PDYN_SEVERAL,
                                              .params = none,
                                              .elements = no_elements,
                                              .rows = 1,
                                              .width = 1,
                                              .select = fill,
                                              .weight = fill,
                                              .project = fill};
    static const pdyn_constraint_type *const types[] = {&type, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "large", types, NULL};
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim =
        test_load(context, SCENE(WEIGHTLESS,
                                 PAIR(GRID_SHEET("'name': 'small', ", "0.4, 0.4", "3, 3",
                                                 "'area_density': 0.5", "{'type': 'large'}"),
                                      GRID_SHEET("'name': 'large', ", "0.4, 0.4", "4, 4",
                                                 "'area_density': 0.5", "{'type': 'large'}")),
                                 ""));
    assert_non_null(find_warning(sim, "no-effect", "small").code);
    assert_null(find_warning(sim, "no-effect", "large").code);
    assert_non_null(find_warning(sim, "no-contact", "small").code); /* it holds no body */
    test_close(sim);
}

/* Loads a scene and returns whether it has a warning of a code about the sheet. */
static bool warns(const char *scene, const char *code, const char *subject) {
    pdyn_sim *sim = test_open(scene);
    bool found = find_warning(sim, code, subject).code;
    test_close(sim);
    return found;
}

/* A stiffness of 0 has no effect; one that rises from 0 has, and a sheet need not resist bending.
 */
static void test_no_stiffness(void **state) {
    (void)state;
    const char *rising =
        SCENE(STEPS,
              SHEET("{'type': 'pin', 'vertices': {'border': true}, 'stiffness': [{'time': 0, "
                    "'stiffness': 0}, {'time': 1, 'stiffness': 10}]}"),
              "");
    assert_true(warns(SCENE(STEPS,
                            SHEET("{'type': 'pin', 'vertices': {'border': true}, "
                                  "'stiffness': 0}"),
                            ""),
                      "no-effect", "sheet"));
    assert_false(warns(rising, "no-effect", "sheet"));
    assert_false(warns(SCENE(STEPS, SHEET(BENDING("0")), ""), "no-effect", "sheet"));
}

/* A light sheet floats on water, but not without gravity. */
static void test_weightless(void **state) {
    (void)state;
#define RAFT PAIR(FLUID_BOX("", "0.02", "0, -0.2, 0", "0.1, -0.1, 0.1", ""), SHEET(BENDING("0")))
    assert_true(warns(SCENE(STEPS, RAFT, ""), "too-light", "sheet"));
    assert_false(warns(SCENE(WEIGHTLESS, RAFT, ""), "too-light", "sheet"));
}

/* A dry sheet at y = 0 whose pins move it down by 0.15 m, above water or below it. */
static void test_drawn(void **state) {
    (void)state;
#define DRAWN(bottom, top)                                                                         \
    PAIR(FLUID_BOX("", "0.02", "0, " bottom ", 0", "0.1, " top ", 0.1", ""),                       \
         SHEET("{'type': 'pin', 'vertices': {'border': true}, 'path': [[0, 0, 0, 0], [0.5, 0, "    \
               "-0.15, 0]]}"))
    assert_true(warns(SCENE(STEPS, DRAWN("-0.2", "-0.1"), ""), "too-light", "sheet"));
    assert_false(warns(SCENE(STEPS, DRAWN("0.1", "0.2"), ""), "too-light", "sheet"));
}

/* ---- the path of a place, which is no path of points ----------------------------------------- */

static const pdyn_param place_params[] = {
    {"path", PDYN_PATH, 0, true, 0, 0, 0, "m", "places of a sphere that attracts"}, {0}};

static int count_points(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void select_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

static void place_weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 1.0;
}

static void place_project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    memset(b->p + 3 * (size_t)first, 0, 3 * (size_t)(last - first) * sizeof *b->p);
}

/* A plug-in's path of this name may have places: only that of held points has displacements. */
static void test_places(void **state) {
    (void)state;
    const pdyn_constraint_type type = {.name = "attract",
                                       .summary = "attracts points to a place",
                                       .flags = PDYN_ANCHORED,
                                       .params_size = sizeof(pdyn_path),
                                       .params = place_params,
                                       .elements = count_points,
                                       .rows = 1,
                                       .width = 1,
                                       .select = select_point,
                                       .weight = place_weight,
                                       .project = place_project};
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "attract", types, NULL};
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
    pdyn_sim *sim =
        test_load(context, SCENE(STEPS, SHEET("{'type': 'attract', 'path': [[0, 0, 5, 0]]}"), ""));
    test_step(sim);
    assert_null(find_warning(sim, "unusual", "sheet").code);
    test_close(sim);
}

#define WATER_AT(x0, x1) FLUID_BOX("'name': 'far', ", "0.01", x0 ", 0, 0", x1 ", 0.1, 0.1", "")
#define SHEET_FAR(x)                                                                               \
    GRID_SHEET("'name': 'far', ", "0.16, 0.16", "9, 9",                                            \
               "'area_density': 0.2, 'translate': [0, 0, " x "]", SPRINGS("100"))

/* Frames round coordinates to 2^-24 of their size: more than a hundredth of 20 mm from 3.4 km. */
static void test_far(void **state) {
    (void)state;
    assert_true(warns(SCENE(STEPS, WATER_AT("-4000.1", "-4000"), ""), "scale", "far"));
    assert_false(warns(SCENE(STEPS, WATER_AT("-3000.1", "-3000"), ""), "scale", "far"));
    assert_true(warns(SCENE(STEPS, SHEET_FAR("4000"), ""), "scale", "far"));
    assert_false(warns(SCENE(STEPS, SHEET_FAR("3000"), ""), "scale", "far"));
}

#define LAYERS(overlap, body)                                                                      \
    PAIR("{'name': 'water', 'particles': {'radius': 0.01, " overlap "'fill': [{'box': "            \
         "{'minimum': [-0.06, -0.06, -0.06], 'maximum': [0.06, 0.06, 0.06]}}]}, "                  \
         "'constraints': [{'type': 'fluid'}]}",                                                    \
         body)
#define CONTACT(thickness) ", 'contact': {'thickness': " thickness "}"
#define WET_SHEET                                                                                  \
    GRID_SHEET("'name': 'sheet', ", "0.16, 0.16", "9, 9",                                          \
               "'area_density': 0.2, 'permeability': 1e-5", SPRINGS("100"))
#define SOFT_CUBE                                                                                  \
    "{'name': 'cube', 'volume': {'grid': {'size': [0.12, 0.12, 0.12], 'cells': [4, 4, 4]}, "       \
    "'translate': [0, 0.12, 0], 'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': "    \
    "1e4}]}"
#define CUBE_OF(density)                                                                           \
    "{'name': 'cube', 'rigid': {'box': {'minimum': [-0.06, 0.06, -0.06], 'maximum': [0.06, 0.18, " \
    "0.06]}, 'density': " density "}}"
#define RIGID_CUBE CUBE_OF("500")

static bool lacks_room(const char *scene) { return warns(scene, "too-close", "water"); }

/* A sheet between two layers of water, half a spacing from each: too close for the thickness of
 * 0.3 spacings. Not for one of 0.2, without contact, for points that know no thickness, and for
 * particles that are to be kept. */
static void test_room(void **state) {
    (void)state;
    assert_true(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")), CONTACT("0.006"))));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")), CONTACT("0.004"))));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")), "")));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")),
                                  ", 'boundary': 'points'" CONTACT("0.006"))));
    assert_false(lacks_room(
        SCENE(STEPS, LAYERS("'overlap': 'keep', ", SHEET_AT("sheet", "0")), CONTACT("0.006"))));
}

/* Above the water: half a spacing from the particles, and farther by what water rests from it. */
static void test_room_above(void **state) {
    (void)state;
    assert_true(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0.06")), CONTACT("0.006"))));
    assert_false(
        lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0.063")), CONTACT("0.006"))));
}

/* A rigid body has the thickness of contact, a soft one and a sheet that water passes have none. */
static void test_room_by_kind(void **state) {
    (void)state;
    assert_true(lacks_room(SCENE(STEPS, LAYERS("", RIGID_CUBE), CONTACT("0.006"))));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SOFT_CUBE), CONTACT("0.006"))));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", WET_SHEET), CONTACT("0.006"))));
}

static bool is_too_light(const char *scene) { return warns(scene, "too-light", "cube"); }

/* A rigid cube exceeds its water by 18 or 30 kg/m^2, of 20 of a layer; a thickness of 4 mm takes
 * off 12 kg/m^2. One that is lighter than water floats as it shall. */
static void test_heavy(void **state) {
    (void)state;
    assert_true(is_too_light(SCENE(STEPS, LAYERS("", CUBE_OF("1150")), "")));
    assert_false(is_too_light(SCENE(STEPS, LAYERS("", CUBE_OF("1250")), "")));
    assert_false(is_too_light(SCENE(STEPS, LAYERS("", CUBE_OF("1250")), CONTACT("0.0001"))));
    assert_true(is_too_light(SCENE(STEPS, LAYERS("", CUBE_OF("1250")), CONTACT("0.004"))));
    assert_true(is_too_light(SCENE(STEPS, LAYERS("", CUBE_OF("1080")), CONTACT("0.004"))));
    assert_false(is_too_light(SCENE(STEPS, LAYERS("", CUBE_OF("950")), CONTACT("0.004"))));
}

#define ROD_OF(density)                                                                            \
    "{'name': 'cube', 'rigid': {'box': {'minimum': [-0.06, 0.1, -0.01], 'maximum': [0.06, 0.12, "  \
    "0.01]}, 'density': " density "}}"

/* A rod as thick as a spacing exceeds its water by 0.7 and 1.2 of a layer: water carries it like a
 * cube, not like a plate. */
static void test_heavy_rod(void **state) {
    (void)state;
    assert_true(is_too_light(SCENE(STEPS, LAYERS("", ROD_OF("1700")), "")));
    assert_false(is_too_light(SCENE(STEPS, LAYERS("", ROD_OF("2200")), "")));
}

/* The density of a rigid body is mass over volume: of this ball 1000 kg/m^3 and a rounding error.
 * It is as heavy as the water. */
static void test_neutral(void **state) {
    (void)state;
    assert_false(is_too_light(
        SCENE(STEPS,
              LAYERS("", "{'name': 'cube', 'rigid': {'sphere': {'center': [0.56, 0.13, 0], "
                         "'radius': 0.022}, 'density': 1000}}"),
              CONTACT("0.002"))));
}

/* The distances of particles from a ball are any: those that are too close have room elsewhere. */
static void test_room_around_ball(void **state) {
    (void)state;
    assert_false(lacks_room(
        SCENE(STEPS,
              PAIR(FLUID_BOX("'name': 'water', ", "0.01", "-0.1, -0.1, -0.1", "0.1, 0.1, 0.1", ""),
                   "{'name': 'ball', 'rigid': {'sphere': {'center': [0.003, 0.007, 0.002], "
                   "'radius': 0.06}, 'density': 500}}"),
              CONTACT("0.012"))));
}

/* Of two tanks with a closed top, one is open at +y and one, a duct, at -y, too. */
static void test_closed_tops(void **state) {
    (void)state;
    static const char *const open[] = {"solids.0.open=[\"+y\"]", "solids.0.open=[\"-y\",\"+y\"]"};
    pdyn_context *context = test_context(1);
    for (int duct = 0; duct < 2; duct++) {
        pdyn_sim *sim = test_load_with(
            context,
            SCENE("'duration': 1, 'gravity': [0, 0, -9.81]",
                  FLUID_BOX("'name': 'water', ", "0.02", "0.1, 0.1, 0", "0.2, 0.2, 0.1", ""),
                  ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.3, "
                  "0.3, 0.3]}}]"),
            &open[duct], 1);
        pdyn_warning w = find_warning(sim, "unusual", "tank");
        assert_true(duct ? !w.code : !!w.code && strstr(w.text, "its open side +y is a side wall"));
        pdyn_free(sim);
    }
    pdyn_destroy(context);
}

/* ---- a type that lacks PDYN_ANCHORED --------------------------------------------------------- */

static void weigh_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 1e3;
}

static void lift(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++)
        b->p[k] = k % 3 == 1 && b->u[k] < 0.0 ? 0.0 : b->u[k];
}

static const pdyn_constraint_type loose_floor = {.name = "loose",
                                                 .summary = "a floor without PDYN_ANCHORED",
                                                 .flags = PDYN_ON_SURFACE,
                                                 .params = (const pdyn_param[]){{0}},
                                                 .rows = 1,
                                                 .width = 1,
                                                 .elements = count_points,
                                                 .select = select_point,
                                                 .weight = weigh_point,
                                                 .project = lift};

/* Forces that the step takes away are told, unless pins make the type harmless. */
static void test_momentum(void **state) {
    (void)state;
    static const pdyn_constraint_type *const types[] = {&loose_floor, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "loose", types, NULL};
    static const char *const scenes[] = {
        SCENE(STEPS, SHEET("{'type': 'loose'}"), ""),
        SCENE(STEPS, SHEET("{'type': 'loose'}, " PINS("'vertices': [0]")), "")};
    for (int held = 0; held < 2; held++) {
        pdyn_context *context = test_context(1);
        assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
        pdyn_sim *sim = test_load(context, scenes[held]);
        for (int n = 0; n < 4; n++) test_step(sim);
        pdyn_warning w = find_warning(sim, "momentum", "sheet");
        assert_true(held ? !w.code : w.count == 4 && strstr(w.text, "forces of \"loose\""));
        test_close(sim);
    }
}

/* The sum that rounding leaves of the forces of a stiff light sheet, far from the origin, is told
 * of no type of the library. */
static void test_momentum_of_bending(void **state) {
    (void)state;
    pdyn_sim *sim =
        test_open(SCENE("'duration': 1, 'gravity': [0, 0, 0]",
                        GRID_SHEET("'name': 'sheet', 'velocity': [0, 1, 0], ", "0.4, 0.4", "9, 9",
                                   "'translate': [30, 30, 0], 'area_density': 0.01",
                                   PAIR(SPRINGS("1e4"), "{'type': 'bending', 'bending_rigidity': "
                                                        "100}")),
                        ""));
    for (int n = 0; n < 3; n++) test_step(sim);
    assert_null(find_warning(sim, "momentum", "sheet").code);
    test_close(sim);
}

/* What looks for the type changes no bit: with water beside the sheet, any number of threads gives
 * the same ones. */
static void test_momentum_beside_fluid(void **state) {
    (void)state;
    static const pdyn_constraint_type *const types[] = {&loose_floor, NULL};
    static const pdyn_plugin plugin = {PDYN_ABI, "loose", types, NULL};
    static const char scene[] = SCENE(
        STEPS,
        PAIR(FLUID_BOX("'name': 'water', ", "0.01", "-0.06, 0.02, -0.06", "0.06, 0.14, 0.06", ""),
             SHEET("{'type': 'loose'}")),
        CONTACT("0.002"));
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        pdyn_context *context = test_context(1 + k);
        assert_int_equal(pdyn_register(context, &plugin), PDYN_OK);
        pdyn_sim *sim = test_load(context, scene);
        for (int n = 0; n < 25; n++) test_step(sim);
        assert_non_null(find_warning(sim, "momentum", "sheet").code);
        hash[k] = pdyn_state_hash(sim);
        test_close(sim);
    }
    assert_true(hash[0] == hash[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sheet),
        cmocka_unit_test(test_border),
        cmocka_unit_test(test_rim),
        cmocka_unit_test(test_return),
        cmocka_unit_test(test_two_sheets),
        cmocka_unit_test(test_long_name),
        cmocka_unit_test(test_solids),
        cmocka_unit_test(test_hinge),
        cmocka_unit_test(test_cloth),
        cmocka_unit_test(test_overlap),
        cmocka_unit_test(test_stretched),
        cmocka_unit_test(test_touching),
        cmocka_unit_test(test_bat),
        cmocka_unit_test(test_fast),
        cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_gain_after_loss),
        cmocka_unit_test(test_gain_after_release),
        cmocka_unit_test(test_gain_after_path),
        cmocka_unit_test(test_saved),
        cmocka_unit_test(test_fallen),
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_press),
        cmocka_unit_test(test_pressed),
        cmocka_unit_test(test_pinned_flat),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_gaps_long),
        cmocka_unit_test(test_without_elements),
        cmocka_unit_test(test_no_stiffness),
        cmocka_unit_test(test_weightless),
        cmocka_unit_test(test_drawn),
        cmocka_unit_test(test_far),
        cmocka_unit_test(test_room),
        cmocka_unit_test(test_heavy),
        cmocka_unit_test(test_heavy_rod),
        cmocka_unit_test(test_neutral),
        cmocka_unit_test(test_room_above),
        cmocka_unit_test(test_room_by_kind),
        cmocka_unit_test(test_room_around_ball),
        cmocka_unit_test(test_closed_tops),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_momentum_of_bending),
        cmocka_unit_test(test_momentum_beside_fluid),
    };
    return cmocka_run_group_tests_name("warnings", tests, test_enter_directory,
                                       test_leave_directory);
}
