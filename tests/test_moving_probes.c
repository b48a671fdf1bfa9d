/* Probes that a solid or a rigid body carries ("on"): their places, and what they measure. */
#include "scene_support.h"
#include "scene_text.h"
#include "sim/probe_place.h"
#include "sim/probes.h"

#include "projdyn/control.h"
#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#define G    9.81
#define HEAD "'duration': 10, 'frame_interval': 0.1"

/* ---- water in a tank that moves -------------------------------------------------------------- */

/* Water at rest relative to its tank, 8 x 8 x 8 particles, 0.2 m deep. */
#define POOL(probes)                                                                               \
    SCENE(HEAD,                                                                                    \
          "{'name': 'water', 'velocity': [0.5, 0, 0], 'particles': {'radius': 0.0125, 'fill': "    \
          "[{'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.2, 0.2]}}]}, 'constraints': "        \
          "[{'type': 'fluid', 'compression': 0.001, 'viscosity': 0.3}]}",                          \
          ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.5, "     \
          "0.2]}, 'open': ['+y'], 'motion': [{'time': 0}, {'time': 10, 'translate': [5, 0, 0]}]}"  \
          "], 'probes': [" probes "]")
#define CARRIED                                                                                    \
    "{'name': 'floor', 'wall': [0.1, 0, 0.1], 'on': 'tank'}, {'name': 'inside', 'point': [0.1, "   \
    "0.05, 0.1], 'on': 'tank'}, {'name': 'gauge', 'height': [0.1, 0, 0.1], 'on': 'tank'}, "        \
    "{'name': 'half', 'box': {'minimum': [0, 0, 0], 'maximum': [0.1, 1, 0.2]}, 'on': 'tank'}, "    \
    "{'name': 'left_behind', 'point': [0.1, 0.05, 0.1]}"
enum { FLOOR, INSIDE, GAUGE, HALF, LEFT_BEHIND, PROBES };

static void assert_near(const char *what, double found, double due, double tolerance) {
    print_message("%s: %.4g, expected %.4g\n", what, found, due);
    assert_true(fabs(found - due) <= tolerance * fabs(due));
}

/* Means over time of the first value of each probe. */
static void find_means(pdyn_sim *sim, double from, double to, double *mean) {
    for (int steps = 0; pdyn_time(sim) < to;) {
        test_step(sim);
        if (pdyn_time(sim) < from) continue;
        steps++;
        for (int k = 0; pdyn_get_probe(sim, k).name; k++)
            mean[k] += (*pdyn_get_probe(sim, k).value - mean[k]) / steps;
    }
}

static void test_tank(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(POOL(CARRIED)));
    double mean[PROBES] = {0};
    find_means(sim, 0.5, 0.9, mean);
    assert_near("wall on the floor, Pa", mean[FLOOR], 1000.0 * G * 0.2, 0.03);
    assert_near("point, Pa", mean[INSIDE], 1000.0 * G * 0.15, 0.04);
    assert_near("height, m", mean[GAUGE], 0.2, 0.1);
    assert_near("half of the volume, m^3", mean[HALF], 0.004, 1e-9);
    assert_near("velocity of the water, m/s", pdyn_get_probe(sim, INSIDE).value[1], 0.5, 0.05);
    assert_true(mean[LEFT_BEHIND] == 0.0);
    pdyn_free(sim);
}

/* ---- places ---------------------------------------------------------------------------------- */

/* A cross of points on a solid that turns as it moves, and at the start, too; a crate spins without
 * gravity, with probes at its corners. */
#define TURNING                                                                                    \
    SCENE(HEAD ", 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.01}",                             \
          PAIR(FLUID_BOX("'name': 'water', ", "0.05", "4, 4, 4", "4.2, 4.2, 4.2", ""),             \
               "{'name': 'crate', 'velocity': [1, 0, 0], 'rigid': {'box': {'minimum': [0, 0, 0], " \
               "'maximum': [0.1, 0.2, 0.3]}, 'density': 500, 'angular_velocity': [1, 2, 3]}}"),    \
          ", 'solids': [{'name': 'gate', 'box': {'minimum': [1, 0, 0], 'maximum': [1.1, 1, 1]}, "  \
          "'pivot': [1, 0, 0], 'motion': [{'time': 0, 'rotate': [0, 0, 90]}, {'time': 1, "         \
          "'rotate': [0, 90, 90], 'translate': [0, 1, 0]}]}], 'probes': [{'line': {'from': [0, "   \
          "0, 0], 'to': [0.1, 0.2, 0.3], 'count': 2}, 'on': 'crate'}, {'point': [1, 0, 1], 'on': " \
          "'gate'}]")

static void assert_place(const double *found, const double *due) {
    if (vec3_distance(found, due) > 1e-9)
        fail_msg("(%g, %g, %g), expected (%g, %g, %g)", found[0], found[1], found[2], due[0],
                 due[1], due[2]);
}

static void test_places(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(TURNING));
    const double *corner = sim->x + 3 * (size_t)sim->body[1].first;
    for (int n = 0; n < 100; n++) {
        const struct probe_place *place = sim->probes->place;
        test_step(sim);
        assert_place(place[0].x, corner);
        assert_place(place[0].x + 3, corner + 3 * 7);
        double angle = 0.5 * acos(-1.0) * sim->time;
        assert_place(place[1].x, (const double[]){1.0, sim->time + sin(angle), cos(angle)});
        double back[3];
        probe_place_return(&place[1], place[1].x, back);
        assert_place(back, (const double[]){1, 0, 1});
    }
    pdyn_free(sim);
}

/* A move by a program, and a pose that it sets, carry the probes along; so does a restored state.
 */
static void test_control(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(TURNING)), *other;
    double corners[8 * 3];
    for (int k = 0; k < COUNT(corners); k++) corners[k] = sim->body[1].rest[k] + 3.0;
    test_step(sim);
    assert_int_equal(
        pdyn_move_solid(sim, 0, 0.02, (const double[]){0, 0, 2}, (const double[]){0, 0, 90}),
        PDYN_OK);
    assert_int_equal(pdyn_set_positions(sim, sim->body[1].first, 8, corners), PDYN_OK);
    assert_int_equal(pdyn_save(sim, "moved.state"), PDYN_OK);
    other = test_load(context, quoted(TURNING));
    assert_int_equal(pdyn_restore(other, "moved.state"), PDYN_OK);
    remove("moved.state");
    for (int n = 0; n < 2; n++) {
        pdyn_sim *s = n ? other : sim;
        test_step(s);
        assert_place(s->probes->place[0].x, s->x + 3 * (size_t)s->body[1].first);
        assert_place(s->probes->place[1].x, (const double[]){1, 0, 3});
    }
    assert_memory_equal(sim->probes->x, other->probes->x, 9 * sizeof(double));
    pdyn_free(sim), pdyn_free(other);
}

/* ---- the wall of a rigid body ---------------------------------------------------------------- */

/* A rigid plate is the bottom of a tank; pins move it and the tank along. */
#define PLATE(motion, path)                                                                        \
    SCENE(HEAD,                                                                                    \
          PAIR("{'name': 'water', 'velocity': [" motion ", 0, 0], 'particles': {'radius': "        \
               "0.0125, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [0.2, 0.2, 0.2]}}]}, "  \
               "'constraints': [{'type': 'fluid', 'compression': 0.001, 'viscosity': 0.3}]}",      \
               "{'name': 'plate', 'velocity': [" motion ", 0, 0], 'rigid': {'box': {'minimum': "   \
               "[-0.02, -0.03, -0.02], 'maximum': [0.22, 0, 0.22]}, 'density': 3000}, "            \
               "'constraints': [{'type': 'pin', 'vertices': {'all': true}, 'path': [[0, 0, 0, 0]"  \
               ", [10, " path ", 0, 0]]}]}"),                                                      \
          ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, -0.5, 0], 'maximum': [0.2, 0.5, "  \
          "0.2]}, 'open': ['+y', '-y'], 'motion': [{'time': 0}, {'time': 10, 'translate': [" path  \
          ", 0, 0]}]}], 'probes': [{'wall': [0.1, 0, 0.1], 'on': 'plate'}]")

static void test_plate_long(void **state) {
    (void)state;
    static const char *const scenes[] = {PLATE("0", "0"), PLATE("0.5", "5")};
    for (int k = 0; k < COUNT(scenes); k++) {
        pdyn_sim *sim = test_load(context, quoted(scenes[k]));
        double mean = 0.0;
        find_means(sim, 0.4, 0.8, &mean);
        assert_near(k ? "plate that moves, Pa" : "plate, Pa", mean, 1000.0 * G * 0.2, 0.05);
        pdyn_free(sim);
    }
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void test_memory(void **state) {
    (void)state;
    test_failing_scene(quoted(PLATE("0.5", "5")));
}

static void test_errors(void **state) {
    (void)state;
    static const struct {
        const char *probe, *message;
    } cases[] = {
        {"{'point': [0, 0, 0], 'on': 'tnak'}",
         "unknown solid or rigid body \"tnak\"; did you mean \"tank\"?"},
        {"{'point': [0, 0, 0], 'on': 'water'}", "unknown solid or rigid body \"water\""},
        {"{'point': [0, 0, 0], 'on': 1}",
         "probes[0].on: expected the name of a solid or rigid body"},
        {"{'solid': 'tank', 'on': 'tank'}",
         "\"on\" needs a \"point\", \"line\", \"wall\", \"height\" or \"box\""},
        {"{'wall': [0.1, 0, 0.1], 'on': 'plate', 'radius': 1e-4}",
         "probe \"probe0\": expected a wall of \"plate\" within 0.0001 m"},
        {"{'wall': [0.1, 0, 0.1], 'on': 'tank', 'radius': 0.02}",
         "probe \"probe0\": expected a wall of \"tank\" within 0.02 m"},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        pdyn_sim *sim;
        char set[256];
        snprintf(set, sizeof set, "probes=[%s]", quoted(cases[k].probe));
        const char *const sets[] = {set};
        assert_int_equal(pdyn_load_text(context, quoted(PLATE("0", "0")), "test", sets, 1, &sim),
                         PDYN_BAD_INPUT);
        assert_error(cases[k].message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tank),    cmocka_unit_test(test_places),
        cmocka_unit_test(test_control), cmocka_unit_test(test_plate_long),
        cmocka_unit_test(test_memory),  cmocka_unit_test(test_errors)};
    return cmocka_run_group_tests_name("moving probes", tests, scene_set_up, scene_tear_down);
}
