/* Warnings about bodies beside water: light ones, and those without room for particles. */
#include "warning_support.h"

#include <string.h>

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

#define LAYERS(overlap, body)                                                                      \
    PAIR("{'name': 'water', 'particles': {'radius': 0.01, " overlap "'fill': [{'box': "            \
         "{'minimum': [-0.06, -0.06, -0.06], 'maximum': [0.06, 0.06, 0.06]}}]}, "                  \
         "'constraints': [{'type': 'fluid'}]}",                                                    \
         body)
#define WET_SHEET                                                                                  \
    GRID_SHEET("'name': 'sheet', ", "0.16, 0.16", "9, 9",                                          \
               "'area_density': 0.2, 'permeability': 1e-5", SPRINGS("100"))
#define SOFT_CUBE                                                                                  \
    "{'name': 'cube', 'volume': {'grid': {'size': [0.12, 0.12, 0.12], 'cells': [4, 4, 4]}, "       \
    "'translate': [0, 0.12, 0], 'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': "    \
    "1e4}]}"
/* A rigid box between two corners, "x, y, z" in m */
#define RIGID_BOX(minimum, maximum, density)                                                       \
    "{'name': 'cube', 'rigid': {'box': {'minimum': [" minimum "], 'maximum': [" maximum            \
    "]}, 'density': " density "}}"
#define CUBE_OF(density) RIGID_BOX("-0.06, 0.06, -0.06", "0.06, 0.18, 0.06", density)
#define ROD_OF(density)  RIGID_BOX("-0.06, 0.1, -0.01", "0.06, 0.12, 0.01", density)
#define SHOT_OF(density) RIGID_BOX("-0.005, 0.1, -0.005", "0.005, 0.11, 0.005", density)

static bool lacks_room(const char *scene) { return warns(scene, "too-close", "water"); }

/* A sheet between two layers of water, half a spacing from each: too close for the thickness of
 * 0.3 spacings. Not for one of 0.2, without contact, for points that know no thickness, and for
 * particles that are to be kept, even a third of the thickness from the sheet. */
static void test_room(void **state) {
    (void)state;
    assert_true(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")), CONTACT("0.006"))));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")), CONTACT("0.004"))));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")), "")));
    assert_false(lacks_room(SCENE(STEPS, LAYERS("", SHEET_AT("sheet", "0")),
                                  ", 'boundary': 'points'" CONTACT("0.006"))));
    assert_false(lacks_room(
        SCENE(STEPS, LAYERS("'overlap': 'keep', ", SHEET_AT("sheet", "0")), CONTACT("0.006"))));
    assert_false(lacks_room(
        SCENE(STEPS, LAYERS("'overlap': 'keep', ", SHEET_AT("sheet", "0.008")), CONTACT("0.006"))));
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
    assert_true(lacks_room(SCENE(STEPS, LAYERS("", CUBE_OF("500")), CONTACT("0.006"))));
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

/* A rod as thick as a spacing exceeds its water by 0.7 and 1.2 of a layer: water carries it like a
 * cube, not like a plate. */
static void test_heavy_rod(void **state) {
    (void)state;
    assert_true(is_too_light(SCENE(STEPS, LAYERS("", ROD_OF("1700")), "")));
    assert_false(is_too_light(SCENE(STEPS, LAYERS("", ROD_OF("2200")), "")));
}

/* A string that is taut at the start carries the cube; one that is longer lets it onto the water.
 */
static void test_heavy_on_string(void **state) {
    (void)state;
#define ON_STRING(length)                                                                          \
    LAYERS("",                                                                                     \
           "{'name': 'beam', 'rigid': {'box': {'minimum': [-0.06, 0.4, -0.06], 'maximum': [0.06, " \
           "0.42, 0.06]}, 'density': 500}, 'constraints': [{'type': 'pin', 'vertices': {'all': "   \
           "true}}]}, {'name': 'cube', 'rigid': {'box': {'minimum': [-0.06, 0.06, -0.06], "        \
           "'maximum': [0.06, 0.18, 0.06]}, 'density': 1150}, 'constraints': [{'type': "           \
           "'attachment', 'to': 'beam', 'vertices': {'all': true}, 'stiffness': 1e4, "             \
           "'tension_only': true, 'length': " length "}]}")
    assert_false(is_too_light(SCENE(STEPS, ON_STRING("1"), "")));
    assert_true(is_too_light(SCENE(STEPS, ON_STRING("1.5"), "")));
}

/* A cube half as long as a spacing exceeds its water by an eighth of the density times a layer: one
 * of steel by less than a layer, one of gold by more. */
static void test_heavy_shot(void **state) {
    (void)state;
    assert_true(is_too_light(SCENE(STEPS, LAYERS("", SHOT_OF("7800")), "")));
    assert_false(is_too_light(SCENE(STEPS, LAYERS("", SHOT_OF("19300")), "")));
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

/* Particles that start too close to a ball are no row of a lattice along its surface: the water
 * moves away from them, and nothing warns. */
static void test_room_around_ball(void **state) {
    (void)state;
    assert_false(lacks_room(
        SCENE(STEPS,
              PAIR(FLUID_BOX("'name': 'water', ", "0.01", "-0.1, -0.1, -0.1", "0.1, 0.1, 0.1", ""),
                   "{'name': 'ball', 'rigid': {'sphere': {'center': [0.003, 0.007, 0.002], "
                   "'radius': 0.06}, 'density': 500}}"),
              CONTACT("0.012"))));
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weightless),
        cmocka_unit_test(test_drawn),
        cmocka_unit_test(test_room),
        cmocka_unit_test(test_room_above),
        cmocka_unit_test(test_room_by_kind),
        cmocka_unit_test(test_heavy),
        cmocka_unit_test(test_heavy_on_string),
        cmocka_unit_test(test_heavy_rod),
        cmocka_unit_test(test_heavy_shot),
        cmocka_unit_test(test_neutral),
        cmocka_unit_test(test_room_around_ball),
        cmocka_unit_test(test_gaps_long),
    };
    return cmocka_run_group_tests_name("room", tests, NULL, NULL);
}
