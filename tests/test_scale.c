/* The same scene at scale s = 1/1000 and 1000, and far from the origin. With lengths times s and
 * the same gravity, times scale with sqrt(s), masses with s^3, stiffnesses (force per length) with
 * s^2, bending rigidities with s^4. For s a power of 4 no digit changes: the results must agree to
 * rounding. */
#include "support.h"

struct variant {
    double s;      /* scale s */
    double offset; /* offset along x after scaling, m */
};

enum { STEPS = 25, TEXT = 4096, MOST = 2000 };

/* Writes lengths and coordinates of a scene. */
static char text[TEXT];
static size_t used;
static void put(const char *format, ...) PDYN_PRINTF(1, 2);
static void put(const char *format, ...) {
    va_list args;
    va_start(args, format);
    used += (size_t)vsnprintf(text + used, sizeof text - used, format, args);
    va_end(args);
    assert_true(used < sizeof text);
}

static void put_point(const struct variant *v, double x, double y, double z) {
    put("[%.17g, %.17g, %.17g]", v->s * x + v->offset, v->s * y, v->s * z);
}

static void put_box(const struct variant *v, const double low[3], const double high[3]) {
    put("{\"minimum\": ");
    put_point(v, low[0], low[1], low[2]);
    put(", \"maximum\": ");
    put_point(v, high[0], high[1], high[2]);
    put("}");
}

static void put_water(const struct variant *v, double height) {
    const double low[3] = {-0.2, height, -0.2}, high[3] = {0.21, height + 0.31, 0.21};
    put("{\"particles\": {\"radius\": %.17g, \"fill\": [{\"box\": ", 0.025 * v->s);
    put_box(v, low, high);
    put("}]}, \"constraints\": [{\"type\": \"fluid\", \"stiffness\": %.17g}]}", 1e5 * v->s * v->s);
}

static void put_sheet(const struct variant *v, const char *vertices) {
    double s = v->s;
    put("{\"surface\": {\"grid\": {\"size\": [%.17g, %.17g], \"vertices\": [9, 9]}, "
        "\"translate\": ",
        s, s);
    put_point(v, 0.0, 0.0, 0.0);
    put(", \"area_density\": %.17g}, \"constraints\": [{\"type\": \"spring\", "
        "\"stretching_stiffness\": %.17g}, {\"type\": \"bending\", \"bending_rigidity\": %.17g}, "
        "{\"type\": \"pin\", \"vertices\": %s, \"stiffness\": %.17g}]}",
        0.2 * s, 1000.0 * s * s, 1e-3 * pow(s, 4.0), vertices, 1e7 * s * s);
}

/* Solved so accurately that the end of a solve does not matter: the smallest change of a position
 * changes the rounding of floats. */
static void begin(const struct variant *v) {
    double t = sqrt(v->s);
    used = 0;
    put("{\"duration\": 1e5, \"frame_interval\": %.17g, \"time_step\": {\"maximum\": %.17g, "
        "\"minimum\": %.17g}, \"solver\": {\"tolerance\": 1e-4}, \"bodies\": [",
        30.0 * t, 0.005 * t, 1e-5 * t);
}

typedef void write_fn(const struct variant *v);

static void write_fluid(const struct variant *v) {
    const double low[3] = {-0.2, 0.0, -0.2}, high[3] = {0.6, 0.8, 0.2};
    begin(v);
    put_water(v, 0.0);
    put("], \"solids\": [{\"open\": [\"+y\"], \"box\": ");
    put_box(v, low, high);
    put("}]}");
}

static void write_cloth(const struct variant *v) {
    begin(v);
    put_sheet(v, "{\"vertices\": [0, 8]}");
    put("]}");
}

static void write_both(const struct variant *v) {
    begin(v);
    put_water(v, 0.05);
    put(", ");
    put_sheet(v, "{\"border\": true}");
    put("]}");
}

/* x: positions after some steps, without scale and offset; returns the number of points. */
static int simulate(pdyn_context *context, write_fn *write, const struct variant *v,
                    double x[3 * MOST]) {
    pdyn_sim *sim;
    write(v);
    if (pdyn_load_text(context, text, "scale", NULL, 0, &sim) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(context));
    for (int k = 0; k < STEPS; k++) test_step(sim);
    pdyn_state state = pdyn_get_state(sim);
    assert_true(state.particles <= MOST);
    for (int k = 0; k < 3 * state.particles; k++)
        x[k] = (state.x[k] - (k % 3 ? 0.0 : v->offset)) / v->s;
    int count = state.particles;
    pdyn_free(sim);
    return count;
}

/* Largest difference of a coordinate, m at scale 1. */
static double difference(write_fn *write, struct variant v) {
    static double x[3 * MOST], y[3 * MOST];
    const struct variant plain = {1.0, 0.0};
    pdyn_context *context = test_context(1);
    int count = simulate(context, write, &plain, x);
    assert_int_equal(simulate(context, write, &v, y), count);
    double most = 0.0;
    for (int k = 0; k < 3 * count; k++) most = fmax(most, fabs(x[k] - y[k]));
    pdyn_destroy(context);
    print_message("scale %g, offset %g m: %.2g m\n", v.s, v.offset, most);
    return most;
}

static void test_small(void **state) {
    (void)state;
    const struct variant millimetre = {0x1p-10, 0.0};
    assert_true(difference(write_fluid, millimetre) < 1e-12);
    assert_true(difference(write_cloth, millimetre) < 1e-12);
    assert_true(difference(write_both, millimetre) < 1e-12);
}

static void test_large(void **state) {
    (void)state;
    const struct variant kilometre = {0x1p10, 0.0};
    assert_true(difference(write_fluid, kilometre) < 1e-12);
    assert_true(difference(write_cloth, kilometre) < 1e-12);
    assert_true(difference(write_both, kilometre) < 1e-12);
}

/* There positions have a resolution of 1.2e-10 m. */
static void test_far(void **state) {
    (void)state;
    const struct variant far = {1.0, 999990.0};
    assert_true(difference(write_fluid, far) < 1e-6);
    assert_true(difference(write_cloth, far) < 1e-6);
    assert_true(difference(write_both, far) < 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_small), cmocka_unit_test(test_large),
                                       cmocka_unit_test(test_far)};
    return cmocka_run_group_tests_name("scale", tests, NULL, NULL);
}
