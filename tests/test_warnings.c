/* Warnings: the list, saved states, and those that no other test is about. */
#include "warning_support.h"

#include "projdyn/module.h"

#include <string.h>

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

/* A cube of 2000 kg falls on a sheet: with far too small a stiffness, and with the default, for its
 * weight. */
static void test_pressed(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.005}, 'contact': {'thickness': 0.005%s}, "
        "'bodies': [{'name': 'sheet', 'surface': {'grid': {'size': [0.4, 0.4], "
        "'vertices': [9, 9]}, 'area_density': 0.5}, 'constraints': [{'type': 'spring', "
        "'stretching_stiffness': 5000}, {'type': 'pin', 'vertices': {'border': true}}]}, {'name': "
        "'cube', 'velocity': [0, -3, 0], 'rigid': {'box': {'minimum': [-0.05, 0.01, -0.05], "
        "'maximum': [0.05, 0.11, 0.05]}, 'mass': 2000}}]}";
    static const char *const stiffness[] = {", 'stiffness': 1", ""};
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text, scene, stiffness[k]);
        pdyn_sim *sim = test_open(text);
        for (int n = 0; n < 60; n++) test_step(sim);
        assert_int_equal(find_warning(sim, "contact-stiffness", "").count > 0, !k);
        test_close(sim);
    }
}

/* Pins drag a crate towards the wall of a tank: beyond the wall, and to its inside. */
static void test_unreachable(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.005}, 'contact': {'thickness': 0.006}, "
        "'bodies': [{'name': 'crate', 'rigid': {'box': {'minimum': [-0.05, 0.1, -0.05], 'maximum': "
        "[0.05, 0.2, 0.05]}, 'density': 500}, 'constraints': [{'type': 'pin', 'vertices': {'all': "
        "true}, 'path': [[0, 0, 0, 0], [0.1, %s, 0, 0]]}]}], 'solids': [{'name': 'tank', 'box': "
        "{'minimum': [-0.2, 0, -0.2], 'maximum': [0.2, 0.5, 0.2]}, 'open': ['+y']}]}";
    static const char *const way[] = {"0.6", "0.149"};
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text, scene, way[k]);
        pdyn_sim *sim = test_open(text);
        for (int n = 0; n < 25; n++) test_step(sim);
        pdyn_warning w = find_warning(sim, "unreachable", "crate");
        assert_int_equal(w.count > 0, !k);
        assert_true(k || strstr(w.text, "0.45 m beyond"));
        test_close(sim);
    }
}

/* Pins move a sheet far into a plane: the warning is about the pins. */
static void test_pinned_flat(void **state) {
    (void)state;
    static const char scene[] =
        "{'duration': 1, 'time_step': {'fixed': 0.005}, 'contact': {'thickness': 0.005}, "
        "'bodies': [{'name': 'sheet', 'surface': {'grid': {'size': [0.2, 0.2], 'vertices': [5, "
        "5]}, 'area_density': 0.2, 'translate': [0, 0.01, 0]}, 'constraints': [{'type': 'spring', "
        "'stretching_stiffness': 500}, {'type': 'pin', 'vertices': {'border': true}, 'path': [[0, "
        "0, 0, 0], [0.1, 0, -2, 0]]}]}], 'solids': [{'plane': {'center': [0, 0, 0], 'normal': "
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

#define TOUCHING ", 'contact': {'thickness': 0.005}"
#define JELLY                                                                                      \
    "{'name': 'jelly', 'volume': {'grid': {'size': [0.3, 0.3, 0.3], 'cells': [3, 3, 3]}, "         \
    "'density': 500}, 'constraints': [{'type': 'tet', 'stiffness': 1e4}]}"
#define BONE(x, constraints)                                                                       \
    "{'name': 'bone', 'rigid': {'sphere': {'center': [" x ", 0, 0], 'radius': 0.05}, 'density': "  \
    "500}, 'constraints': [" constraints "]}"

/* A ball in a soft cube: free, tied to the cube, without contact; and beside it. */
static void test_inside(void **state) {
    (void)state;
    static const char tied[] =
        SCENE(STEPS,
              PAIR(JELLY, BONE("0", "{'type': 'attachment', 'to': 'jelly', 'vertices': {'all': "
                                    "true}, 'stiffness': 100}")),
              TOUCHING);
    pdyn_sim *sim = test_open(SCENE(STEPS, PAIR(JELLY, BONE("0", "")), TOUCHING));
    pdyn_warning w = find_warning(sim, "overlap", "bone");
    assert_string_equal(w.text, "it starts inside of the volume \"jelly\"");
    test_close(sim);
    assert_false(warns(tied, "overlap", "bone"));
    assert_false(warns(SCENE(STEPS, PAIR(JELLY, BONE("0", "")), ""), "overlap", "bone"));
    assert_false(warns(SCENE(STEPS, PAIR(JELLY, BONE("0.3", "")), TOUCHING), "overlap", "bone"));
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

/* Of two tanks with a closed top, one is open at +y and one, a duct, at -y, too. */
static void test_closed_tops(void **state) {
    (void)state;
    static const char *const open[] = {"solids.0.open=[\"+y\"]", "solids.0.open=[\"-y\",\"+y\"]"};
    for (int duct = 0; duct < 2; duct++) {
        pdyn_sim *sim = test_open_with(
            SCENE("'duration': 1, 'gravity': [0, 0, -9.81]",
                  FLUID_BOX("'name': 'water', ", "0.02", "0.1, 0.1, 0", "0.2, 0.2, 0.1", ""),
                  ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.3, "
                  "0.3, 0.3]}}]"),
            &open[duct], 1);
        pdyn_warning w = find_warning(sim, "unusual", "tank");
        assert_true(duct ? !w.code : !!w.code && strstr(w.text, "its open side +y is a side wall"));
        test_close(sim);
    }
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

#define ABOVE_FLOOR(bottom)                                                                        \
    SCENE(STEPS,                                                                                   \
          "{'name': 'cube', 'rigid': {'box': {'minimum': [0, " bottom                              \
          ", 0], 'maximum': [0.1, 0.2, 0.1]}, 'density': 500}}",                                   \
          ", 'solids': [{'name': 'floor', 'plane': {'center': [0, 0, 0], 'normal': [0, 1, 0], "    \
          "'size': 1}}]" CONTACT("0.01"))

#define TWO_SHEETS(pins)                                                                           \
    SCENE(STEPS,                                                                                   \
          PAIR(SHEET(PINS("'box': {'minimum': [-1, -1, -1], 'maximum': [1, 1, 1]}")),              \
               GRID_SHEET("'name': 'upper', ", "0.16, 0.16", "9, 9",                               \
                          "'area_density': 0.2, 'translate': [0, 0.004, 0]",                       \
                          SPRINGS("100") ", " PINS(pins))),                                        \
          CONTACT("0.01"))

static bool are_too_close(const char *sheets) {
    return warns(sheets, "too-close", "sheet") || warns(sheets, "too-close", "upper");
}

/* A cube that starts above a floor, at less than half of the thickness and at more. Two sheets that
 * pins hold do not move, and a sheet that is free inside of its border does. */
static void test_gap(void **state) {
    (void)state;
    assert_true(warns(ABOVE_FLOOR("0.004"), "too-close", "cube"));
    assert_false(warns(ABOVE_FLOOR("0.006"), "too-close", "cube"));
    assert_false(are_too_close(TWO_SHEETS("'box': {'minimum': [-1, -1, -1], "
                                          "'maximum': [1, 1, 1]}")));
    assert_true(are_too_close(TWO_SHEETS("'border': true")));
}

/* A thickness above the edges is told before contact finds its pairs, which may take all memory:
 * the warning comes although the scene is refused, because its sheets intersect. */
static void test_thickness_first(void **state) {
    (void)state;
    struct warnings warnings = {"the contact thickness of 0.05 m is above its mean edge length", 0};
    pdyn_context *context = test_warned_context(1, &warnings);
    pdyn_sim *sim = NULL;
    const char *scene =
        SCENE(STEPS, PAIR(SHEET_AT("lower", "0"), SHEET_AT("upper", "0")), CONTACT("0.05"));
    assert_int_equal(pdyn_load_text(context, quoted(scene), "scene", NULL, 0, &sim),
                     PDYN_BAD_INPUT);
    assert_int_equal(warnings.count, 2);
    pdyn_destroy(context);
}

#define CUBE_FACES "f 1 2 3 4\nf 2 1 5 6\nf 3 2 6 7\nf 4 3 7 8\nf 1 4 8 5\n"
#define FILLED(cell)                                                                               \
    SCENE(STEPS,                                                                                   \
          "{'name': 'spire', 'volume': {'mesh': 'mesh.obj', 'cell': " cell ", 'density': 1000}, "  \
          "'constraints': [{'type': 'tet', 'stiffness': 1e5}]}",                                   \
          "")

/* A cube of 0.2 m below a spire of 0.8 m: cells of 0.05 m fill 98 % and miss its point. */
static void test_spire(void **state) {
    (void)state;
    static const char cube[] = "v 0 0 0\nv 0.2 0 0\nv 0.2 0 0.2\nv 0 0 0.2\n"
                               "v 0 0.2 0\nv 0.2 0.2 0\nv 0.2 0.2 0.2\nv 0 0.2 0.2\n";
    static const char *const top[] = {"v 0.1 1 0.1\n", "f 5 9 6\nf 6 9 7\nf 7 9 8\nf 8 9 5\n"};
    char text[512];
    snprintf(text, sizeof text, "%s%s" CUBE_FACES "%s", cube, top[0], top[1]);
    test_write_text("mesh.obj", text);
    assert_true(warns(FILLED("0.05"), "coarse", "spire"));
    assert_false(warns(FILLED("0.01"), "coarse", "spire"));
    snprintf(text, sizeof text, "%sv 0 5 0\n" CUBE_FACES "f 8 7 6 5\n", cube); /* no corner */
    test_write_text("mesh.obj", text);
    assert_false(warns(FILLED("0.05"), "coarse", "spire"));
    test_remove_file("mesh.obj");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spire),
        cmocka_unit_test(test_saved),
        cmocka_unit_test(test_long_name),
        cmocka_unit_test(test_fallen),
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_fast),
        cmocka_unit_test(test_press),
        cmocka_unit_test(test_pressed),
        cmocka_unit_test(test_unreachable),
        cmocka_unit_test(test_pinned_flat),
        cmocka_unit_test(test_without_elements),
        cmocka_unit_test(test_no_stiffness),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_inside),
        cmocka_unit_test(test_far),
        cmocka_unit_test(test_gap),
        cmocka_unit_test(test_thickness_first),
        cmocka_unit_test(test_closed_tops),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_momentum_of_bending),
        cmocka_unit_test(test_momentum_beside_fluid),
    };
    return cmocka_run_group_tests_name("warnings", tests, test_enter_directory,
                                       test_leave_directory);
}
