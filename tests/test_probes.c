/* The fluid at points (pdyn_fluid_at) and the probes of a scene: hydrostatics, exactness for linear
 * fields, loads, means over time, probes.csv, errors. */
#include "geometry/grid.h"
#include "scene_support.h"
#include "scene_text.h"

#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <string.h>

#define G     9.81
#define HEAD  "'duration': 10, 'frame_interval': 0.1"
#define WALLS "'maximum': [0.3, 0.5, 0.3]}, 'open': ['+y']}"
#define TANK  "{'name': 'tank', 'box': {'minimum': [0, 0, 0], " WALLS
/* Water at rest, 12 x 12 x 12 particles, 0.3 m deep. */
#define DEPTH 0.3
#define POOL(head, probes)                                                                         \
    SCENE(head,                                                                                    \
          FLUID_BOX("'name': 'water', ", "0.0125", "0, 0, 0", "0.3, 0.3, 0.3",                     \
                    ", 'compression': 0.001, 'viscosity': 0.3"),                                   \
          ", 'solids': [" TANK "], 'probes': [" probes "]")

/* ---- water at rest --------------------------------------------------------------------------- */

#define RESTING                                                                                    \
    "{'name': 'floor', 'point': [0.15, 0, 0.15]}, {'name': 'floor_wall', 'wall': [0.15, 0, "       \
    "0.15]}, {'name': 'side', 'wall': [0, 0.06, 0.15]}, {'name': 'higher', 'wall': [0.15, 0.15, "  \
    "0.3]}, {'name': 'inside', 'line': {'from': [0.15, 0.05, 0.15], 'to': [0.15, 0.15, 0.15], "    \
    "'count': 2}}, {'name': 'beside', 'point': [0, 0.15, 0.15]}, {'name': 'gauge', 'height': "     \
    "[0.15, 0, 0.15]}, {'name': 'half', 'box': {'minimum': [0, 0, 0], 'maximum': [0.15, 1, 0.3]}}"

static void assert_pressure(const char *what, double found, double depth, double tolerance) {
    double due = 1000.0 * G * depth;
    print_message("%s: %.0f Pa, rho g depth %.0f Pa, off by %.1f %%\n", what, found, due,
                  100.0 * (found / due - 1.0));
    assert_true(fabs(found / due - 1.0) < tolerance);
}

enum { ROW = 8 }; /* numbers of a probe */

/* Means over time of the values of each probe, ROW apart. */
static void find_means(pdyn_sim *sim, double from, double to, double *mean) {
    int steps = 0;
    while (pdyn_time(sim) < to) {
        pdyn_probe_info probe;
        test_step(sim);
        if (pdyn_time(sim) < from) continue;
        steps++;
        for (int k = 0; (probe = pdyn_get_probe(sim, k)).name; k++)
            for (int m = 0; m < probe.values; m++)
                mean[ROW * k + m] += (probe.value[m] - mean[ROW * k + m]) / steps;
    }
}

/* The particles beside a side wall have up to 15 % more pressure than the water further in; a probe
 * of the wall takes the force instead. */
static void test_rest_long(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(POOL(HEAD, RESTING)));
    double mean[8 * ROW] = {0}, height, volume;
    find_means(sim, 0.6, 1.2, mean);
    assert_pressure("point on the floor", mean[0], DEPTH, 0.04);
    assert_pressure("wall on the floor", mean[ROW], DEPTH, 0.02);
    assert_pressure("side wall", mean[2 * ROW], DEPTH - 0.06, 0.02);
    assert_pressure("side wall, higher", mean[3 * ROW], DEPTH - 0.15, 0.02);
    assert_pressure("inside", mean[4 * ROW], DEPTH - 0.05, 0.02);
    assert_pressure("inside, higher", mean[4 * ROW + 4], DEPTH - 0.15, 0.02);
    assert_pressure("point at a side wall", mean[5 * ROW], DEPTH - 0.15, 0.2);
    height = mean[6 * ROW], volume = mean[7 * ROW];
    print_message("height %.4f m, half of the volume %.5f m^3\n", height, volume);
    assert_true(fabs(height - DEPTH) < 0.0125);
    assert_true(fabs(volume - 0.0135) < 1e-12);
    for (int m = 1; m < 4; m++) assert_true(fabs(mean[7 * ROW + m]) < 1e-3);
    pdyn_free(sim);
}

/* A plate of 20 mm below water, spacing 25 mm, has boundary points on its lower face, too, in air.
 * The second one has its thickness along z in the scene and is turned by its motion. */
#define ABOVE(plate)                                                                               \
    SCENE(HEAD,                                                                                    \
          FLUID_BOX("'name': 'water', ", "0.0125", "0, 0, 0", "0.2, 0.2, 0.2",                     \
                    ", 'compression': 0.001, 'viscosity': 0.3"),                                   \
          ", 'solids': [{'name': 'tank', 'box': {'minimum': [0, -0.5, 0], 'maximum': [0.2, 0.5, "  \
          "0.2]}, 'open': ['+y']}, {" plate "}], 'probes': [{'wall': [0.1, 0, 0.1]}]")

static void test_thin_wall(void **state) {
    (void)state;
    static const char *const plates[] = {
        ABOVE("'box': {'minimum': [0, -0.02, 0], 'maximum': [0.2, 0, 0.2]}"),
        ABOVE("'box': {'minimum': [0, -0.2, -0.02], 'maximum': [0.2, 0, 0]}, 'pivot': [0, 0, 0], "
              "'motion': [{'time': 0, 'rotate': [-90, 0, 0]}]")};
    for (int k = 0; k < COUNT(plates); k++) {
        pdyn_sim *sim = test_load(context, quoted(plates[k]));
        double mean[ROW] = {0};
        find_means(sim, 0.3, 0.6, mean);
        assert_pressure(k ? "turned plate" : "plate", mean[0], 0.2, 0.05);
        pdyn_free(sim);
    }
}

/* ---- the fit --------------------------------------------------------------------------------- */

#define BLOCK(probes)                                                                              \
    SCENE(HEAD ", 'time_step': {'fixed': 1e-3}",                                                   \
          FLUID_BOX("'name': 'water', ", "0.0125", "0, 0, 0", "0.1, 0.1, 0.1", ""),                \
          ", 'solids': [" TANK "], 'probes': [" probes "]")

static double plane(const double *x, double slope) {
    return 100.0 + slope * (x[0] - 2.0 * x[1] + 0.5 * x[2]);
}

/* Pressure and velocity are linear: the fit finds them inside, at walls, edges and corners. */
static void test_linear(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(BLOCK("")));
    test_step(sim);
    for (int i = 0; i < sim->objective.particles; i++) {
        sim->pressure[i] = plane(sim->x + 3 * i, 300.0);
        for (int a = 0; a < 3; a++) sim->v[3 * i + a] = plane(sim->x + 3 * i, 10.0 * a);
    }
    uint64_t seed = 5;
    double worst = 0.0;
    for (int n = 0; n < 200; n++) {
        double x[3], pressure, v[3];
        for (int a = 0; a < 3; a++) x[a] = 0.05 * (1.0 + test_random(&seed));
        if (n < 8) x[0] = 0.1 * (n & 1), x[1] = 0.05 * (n & 2), x[2] = 0.025 * (n & 4);
        assert_int_equal(pdyn_fluid_at(sim, 1, x, &pressure, v), PDYN_OK);
        worst = fmax(worst, fabs(pressure - plane(x, 300.0)) / (300.0 * 0.025));
        for (int a = 0; a < 3; a++)
            worst = fmax(worst, fabs(v[a] - plane(x, 10.0 * a)) / (20.0 * 0.025));
    }
    print_message("a linear field is missed by %.2g of its change over a spacing\n", worst);
    assert_true(worst < 0.02);
    pdyn_free(sim);
}

/* A few particles that lie along a line or in a plane give finite values; none gives 0. */
static void test_few(void **state) {
    (void)state;
    static const char *const sizes[] = {"0.03, 0.03, 0.03", "0.1, 0.03, 0.03", "0.1, 0.03, 0.1"};
    for (int s = 0; s < COUNT(sizes); s++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "{" HEAD ", 'gravity': [0, 0, 0], 'bodies': [{'particles': {'radius': 0.0125, "
                 "'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [%s]}}]}, 'constraints': "
                 "[{'type': 'fluid'}]}]}",
                 sizes[s]);
        pdyn_sim *sim = test_load(context, quoted(text));
        const double x[] = {0.0125, 0.04, 0.02, 0.0125, 0.07, 0.02, 1e300, 0, 0, 0, -1e9, 0};
        double pressure[4], v[12];
        test_step(sim);
        for (int i = 0; i < sim->objective.particles; i++)
            sim->pressure[i] = 7.0, sim->v[3 * i] = 3.0;
        assert_int_equal(pdyn_fluid_at(sim, 4, x, pressure, v), PDYN_OK);
        assert_true(fabs(pressure[0] - 7.0) < 1e-9 && fabs(v[0] - 3.0) < 1e-9);
        for (int k = 1; k < 4; k++) assert_true(pressure[k] == 0.0 && v[3 * k] == 0.0);
        pdyn_free(sim);
    }
}

static void test_calls(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(BLOCK("")));
    double x[3] = {0.05, 0.05, 0.05}, pressure = 1.0;
    assert_int_equal(pdyn_fluid_at(sim, 1, x, &pressure, NULL), PDYN_OK);
    assert_true(pressure == 0.0); /* before the first step */
    assert_int_equal(pdyn_fluid_at(NULL, 1, x, &pressure, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_fluid_at(sim, -1, x, &pressure, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_fluid_at(sim, 1, NULL, &pressure, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_fluid_at(sim, 0, NULL, NULL, NULL), PDYN_OK);
    x[1] = NAN;
    assert_int_equal(pdyn_fluid_at(sim, 1, x, &pressure, NULL), PDYN_BAD_INPUT);
    assert_message("pdyn_fluid_at: expected finite coordinates of point 0, found nan");
    assert_null(pdyn_get_probe(sim, 0).name);
    assert_null(pdyn_get_probe(sim, -1).name);
    pdyn_free(sim);
}

/* ---- the search ------------------------------------------------------------------------------ */

enum { POINTS = 500 };

static void count_visit(void *user, int id) { ((int *)user)[id]++; }

/* A visit of a grid meets every point within the radius, and none twice. width: of the region with
 * points, in cells; the wide one has too many cells for a table. */
static void assert_visits(double width) {
    struct grid grid;
    double x[3 * POINTS];
    uint64_t seed = 3;
    for (int k = 0; k < 3 * POINTS; k++) x[k] = width * test_random(&seed);
    assert_int_equal(grid_create(context, POINTS, 1.0, &grid), PDYN_OK);
    assert_int_equal(grid_sort(&grid, POINTS, NULL, x), PDYN_OK);
    assert_true(grid.tabled == (width < 10.0));
    for (int n = 0; n < 200; n++) {
        int met[POINTS] = {0};
        double at[3], radius = 2.0 + 2.0 * test_random(&seed);
        for (int a = 0; a < 3; a++) at[a] = 1.2 * width * test_random(&seed);
        if (n % 2) memcpy(at, x + 3 * n, sizeof at);
        grid_visit(&grid, at, radius, count_visit, met);
        for (int k = 0; k < POINTS; k++) {
            assert_true(met[k] <= 1);
            assert_true(met[k] == 1 || vec3_distance(x + 3 * k, at) >= radius);
        }
    }
    grid_free(context, &grid);
}

static void test_visits(void **state) {
    (void)state;
    assert_visits(3.0);
    assert_visits(100.0);
}

/* ---- probes ---------------------------------------------------------------------------------- */

#define EVERYTHING                                                                                 \
    "{'name': 'p', 'point': [0, 0.02, 0]}, {'name': 'mean', 'point': [0, 0.02, 0], 'time': 0.01, " \
    "'radius': 0.04}, {'name': 'raw', 'point': [0, 0.02, 0], 'radius': 0.04}, {'line': {'from': "  \
    "[0, 0, 0], 'to': [0.1, 0, 0], 'count': 3}}, {'name': 'w', 'wall': [0.05, 0, 0.05]}, "         \
    "{'name': 'h', 'height': [0.05, 0, 0.05]}, {'name': 'b', 'box': {'minimum': [0, 0, 0], "       \
    "'maximum': [1, 0.05, 1]}}, {'name': 's', 'solid': 'tank'}, {'name': 'hold', 'pins': "         \
    "'sheet'}, "                                                                                   \
    "{'name': 'border', 'body': 'sheet', 'constraint': 'pin'}"
static const char everything[] =
    SCENE(HEAD ", 'time_step': {'fixed': 2e-3}, 'contact': {'thickness': 0.01}",
          PAIR(FLUID_BOX("'name': 'water', ", "0.0125", "0, 0, 0", "0.1, 0.1, 0.1", ""),
               GRID_SHEET("'name': 'sheet', ", "0.1, 0.1", "5, 5",
                          "'translate': [0.2, 0.2, 0.2], 'area_density': 0.3",
                          PAIR(SPRINGS("500"), PINS("'border': true")))),
          ", 'solids': [" TANK "], 'probes': [" EVERYTHING "]");
enum { MEAN = 1, RAW = 2, SOLID = 7, HOLD = 8, BORDER = 9, PROBES = 10 };

static void test_columns(void **state) {
    (void)state;
    static const char *const first[PROBES] = {
        "p.pressure_Pa",  "mean.pressure_Pa", "raw.pressure_Pa", "probe3.pressure_0_Pa",
        "w.pressure_Pa",  "h.height_m",       "b.volume_m3",     "s.force_x_N",
        "hold.force_x_N", "border.force_x_N"};
    static const char *const last[PROBES] = {
        "p.velocity_z_m_s", "mean.velocity_z_m_s", "raw.velocity_z_m_s", "probe3.velocity_z_2_m_s",
        "w.pressure_Pa",    "h.height_m",          "b.velocity_z_m_s",   "s.moment_z_Nm",
        "hold.moment_z_Nm", "border.moment_z_Nm"};
    pdyn_sim *sim = test_load(context, quoted(everything));
    for (int k = 0; k < PROBES; k++) {
        pdyn_probe_info probe = pdyn_get_probe(sim, k);
        assert_string_equal(probe.column[0], first[k]);
        assert_string_equal(probe.column[probe.values - 1], last[k]);
        for (int m = 0; m < probe.values; m++) assert_true(probe.value[m] == 0.0);
    }
    assert_null(pdyn_get_probe(sim, PROBES).name);
    pdyn_free(sim);
}

/* Loads are those of the functions; a mean over time is exponential. */
static void test_values(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(everything));
    double mean[4] = {0}, force[3], moment[3];
    const double *raw = pdyn_get_probe(sim, RAW).value, *found = pdyn_get_probe(sim, MEAN).value;
    pdyn_probe_info solid = pdyn_get_probe(sim, SOLID), pins = pdyn_get_probe(sim, HOLD);
    pdyn_probe_info border = pdyn_get_probe(sim, BORDER);
    for (int n = 0; n < 20; n++) {
        test_step(sim);
        for (int m = 0; m < 4; m++) { /* the pressure, and the velocity, which is not 0 at first */
            mean[m] += (n ? 1.0 - exp(-2e-3 / 0.01) : 1.0) * (raw[m] - mean[m]);
            assert_true(fabs(mean[m] - found[m]) <= 1e-9 * fabs(mean[m]));
        }
        assert_true(raw[2] != 0.0);
        assert_int_equal(pdyn_solid_load(sim, 0, force, moment), PDYN_OK);
        assert_memory_equal(force, solid.value, sizeof force);
        assert_memory_equal(moment, solid.value + 3, sizeof moment);
        assert_int_equal(pdyn_constraint_load(sim, 2, force, moment), PDYN_OK);
        assert_memory_equal(force, pins.value, sizeof force);
        assert_memory_equal(moment, pins.value + 3, sizeof moment);
        assert_memory_equal(border.value, pins.value, 6 * sizeof *pins.value);
    }
    assert_true(raw[0] > 0.0 && solid.value[1] < 0.0 && pins.value[1] > 0.0);
    pdyn_free(sim);
}

/* A sheet that hangs by two pins; probes of all of its pins, of the left one, and of pin `number`,
 * by both forms. */
#define HUNG(number)                                                                               \
    SCENE(                                                                                         \
        "'duration': 1, 'time_step': {'fixed': 5e-3}",                                             \
        GRID_SHEET("'name': 'sheet', ", "1, 1", "5, 5", "'area_density': 0.3",                     \
                   PAIR(SPRINGS("500"), PAIR(PINS("'vertices': [0]"), PINS("'vertices': [4]")))),  \
        ", 'probes': [{'name': 'all', 'pins': 'sheet'}, {'name': 'left', 'pins': 'sheet', "        \
        "'pin': 0}, {'name': 'right', 'pins': 'sheet', 'pin': " number "}, "                       \
        "{'name': 'other', 'body': 'sheet', 'constraint': 'pin', 'number': 1}]")

static void test_single_pins(void **state) {
    (void)state;
    pdyn_sim *sim = test_load(context, quoted(HUNG("1")));
    for (int n = 0; n < 5; n++) test_step(sim);
    const double *all = pdyn_get_probe(sim, 0).value;
    for (int pin = 0; pin < 2; pin++) {
        double force[3], moment[3];
        assert_int_equal(pdyn_constraint_load(sim, 1 + pin, force, moment), PDYN_OK);
        assert_memory_equal(force, pdyn_get_probe(sim, 1 + pin).value, sizeof force);
        assert_true(force[1] > 0.0 && force[1] < 0.9 * all[1]);
    }
    const double *left = pdyn_get_probe(sim, 1).value, *right = pdyn_get_probe(sim, 2).value;
    for (int a = 0; a < 6; a++) assert_true(fabs(left[a] + right[a] - all[a]) < 1e-12);
    assert_memory_equal(pdyn_get_probe(sim, 3).value, right, 6 * sizeof *right);
    pdyn_free(sim);
}

/* Probes change no bit of a step, have the same bits for any number of threads, and allocate
 * nothing in a step. */
static void test_threads(void **state) {
    (void)state;
    uint64_t hash[3], values[3];
    for (int t = 0; t < 3; t++) {
        static const char *const none[] = {"probes=[]"};
        struct counter calls;
        pdyn_context *c = test_counting_context(1 + t, &calls);
        pdyn_sim *sim = test_load_with(c, everything, none, t == 0);
        for (int n = 0; n < 10; n++) test_step(sim);
        test_allow(&calls, 0);
        test_step(sim);
        test_allow(&calls, -1);
        hash[t] = pdyn_state_hash(sim), values[t] = HASH_BEGIN;
        pdyn_probe_info probe;
        for (int k = 0; (probe = pdyn_get_probe(sim, k)).name; k++)
            values[t] =
                hash_bytes(values[t], probe.value, (size_t)probe.values * sizeof *probe.value);
        test_close(sim);
    }
    assert_true(hash[0] == hash[1] && hash[1] == hash[2]);
    assert_true(values[0] == HASH_BEGIN && values[1] != HASH_BEGIN && values[1] == values[2]);
}

static void test_memory(void **state) {
    (void)state;
    test_failing_scene(quoted(everything));
}

/* ---- probes.csv ------------------------------------------------------------------------------ */

static void write_steps(pdyn_sim *sim, pdyn_writer *writer, int steps) {
    for (int n = 0; n < steps; n++) {
        pdyn_step_info info = test_step(sim);
        assert_int_equal(pdyn_writer_step(writer, &info), PDYN_OK);
    }
}

static char *file_text(const char *name) {
    FILE *in = fopen(name, "rb");
    char *text = calloc(1, 65536);
    assert_non_null(in);
    assert_true(fread(text, 1, 65535, in) > 0);
    fclose(in);
    return text;
}

static void remove_run(const char *name) {
    char command[64];
    snprintf(command, sizeof command, "rm -r %s", name);
    assert_int_equal(system(command), 0);
}

/* The last row of a file has the time and the values of all probes. */
static void check_last_row(pdyn_sim *sim, const char *text) {
    const char *row = text + strlen(text) - 1;
    char *at, wanted[32];
    int columns = 0;
    while (row[-1] != '\n') row--;
    assert_true(fabs(strtod(row, &at) - pdyn_time(sim)) < 1e-9);
    pdyn_probe_info probe;
    for (int k = 0; (probe = pdyn_get_probe(sim, k)).name; k++)
        for (int m = 0; m < probe.values; m++, columns++, at += strlen(wanted)) {
            snprintf(wanted, sizeof wanted, isfinite(probe.value[m]) ? ",%.9g" : ",",
                     probe.value[m]);
            assert_memory_equal(at, wanted, strlen(wanted));
        }
    assert_true(columns > 10 && !strcmp(at, "\n"));
}

/* A run that is saved, goes on, and is resumed from there writes the same file. */
static void test_resume(void **state) {
    (void)state;
    pdyn_writer *writer;
    pdyn_sim *sim = test_load(context, quoted(everything));
    assert_int_equal(pdyn_writer_open(sim, "whole", false, &writer), PDYN_OK);
    write_steps(sim, writer, 10);
    char *whole = file_text("whole/probes.csv");
    check_last_row(sim, whole);
    pdyn_writer_close(writer);
    pdyn_free(sim);
    sim = test_load(context, quoted(everything));
    assert_int_equal(pdyn_writer_open(sim, "parts", false, &writer), PDYN_OK);
    write_steps(sim, writer, 6);
    assert_int_equal(pdyn_writer_save(writer), PDYN_OK);
    write_steps(sim, writer, 2);
    pdyn_writer_close(writer);
    pdyn_free(sim);
    sim = test_load(context, quoted(everything));
    assert_int_equal(pdyn_writer_resume(sim, "parts", &writer), PDYN_OK);
    write_steps(sim, writer, 4);
    pdyn_writer_close(writer);
    pdyn_free(sim);
    char *parts = file_text("parts/probes.csv");
    assert_string_equal(whole, parts);
    assert_memory_equal(whole, "time_s,p.pressure_Pa,p.velocity_x_m_s,", 38);
    int rows = 0;
    for (const char *c = whole; *c; c++) rows += *c == '\n';
    assert_int_equal(rows, 11);
    free(whole), free(parts);
    sim = test_load(context, quoted(BLOCK("")));
    assert_int_equal(pdyn_writer_open(sim, "parts", false, &writer), PDYN_OK);
    pdyn_writer_close(writer);
    pdyn_free(sim);
    FILE *old = fopen("parts/probes.csv", "r"); /* that of the run before is removed */
    assert_null(old);
    remove_run("whole"), remove_run("parts");
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void assert_refused(const char *text, const char *message) {
    pdyn_sim *sim;
    assert_int_equal(pdyn_load_text(context, quoted(text), "test", NULL, 0, &sim), PDYN_BAD_INPUT);
    assert_error(message);
}

static void test_errors(void **state) {
    (void)state;
    static const struct {
        const char *probe, *message;
    } cases[] = {
        {"{'name': 'p'}",
         "probes[0]: expected exactly one of \"point\", \"line\", \"wall\", "
         "\"height\", \"box\", \"solid\", \"pins\", \"inside\" and \"body\", found none"},
        {"{'point': [0, 0, 0], 'solid': 'tank'}", "found more"},
        {"{'point': [0, 0]}", "probes[0].point: expected"},
        {"{'point': [0, 0, 0], 'radius': 0}", "probes[0].radius: expected"},
        {"{'point': [0, 0, 0], 'time': -1}", "probes[0].time: expected"},
        {"{'solid': 'tank', 'radius': 1}", "\"radius\" needs a \"point\", \"line\" or \"wall\""},
        {"{'point': [0, 0, 0], 'source': 'fluid'}",
         "probes[0]: \"source\" needs a \"solid\" or \"body\""},
        {"{'solid': 'tank', 'source': 'fluids'}",
         "probes[0].source: unknown source \"fluids\"; did you mean \"fluid\"?"},
        {"{'solid': 'tank', 'pin': 0}", "\"pin\" needs \"pins\""},
        {"{'solid': 'tnak'}", "unknown solid \"tnak\"; did you mean \"tank\"?"},
        {"{'solid': 'water'}", "probes[0].solid: \"water\" is a body, expected the key \"body\""},
        {"{'body': 'tank'}", "probes[0].body: \"tank\" is a solid, expected the key \"solid\""},
        {"{'body': 'water', 'tension': 'attachment'}", "did you mean \"constraint\"?"},
        {"{'solid': 'tank', 'constraint': 'pin'}", "\"constraint\" needs a \"body\""},
        {"{'body': 'water', 'number': 0}", "\"number\" needs a \"constraint\""},
        {"{'body': 'water', 'source': 'fluid', 'constraint': 'pin'}",
         "probes[0]: \"constraint\" and \"source\": expected one of them"},
        {"{'body': 'water', 'constraint': 'atachment'}",
         "probes[0].constraint: unknown constraint \"atachment\"; did you mean \"attachment\"?"},
        {"{'body': 'water', 'constraint': 'attachment'}",
         "probes[0].constraint: \"water\" has no constraint \"attachment\"; expected the body "
         "whose"},
        {"{'body': 'water', 'constraint': 'fluid'}",
         "probes[0].constraint: expected a type that holds or pushes \"water\" from outside, such "
         "as \"pin\" or \"attachment\", found \"fluid\""},
        {"{'body': 'water', 'constraint': 3}", "expected the name of a constraint, found 3"},
        {"{'pins': 'water'}", "probes[0].pins: expected a body with a \"pin\""},
        {"{'line': {'from': [0, 0, 0], 'to': [1, 1, 1], 'count': 1}}", "probes[0].line.count"},
        {"{'line': {'from': [0, 0, 0], 'count': 3}}", "probes[0].line.to: missing"},
        {"{'box': {'minimum': [0, 0, 0], 'maximum': [0, 1, 1]}}", "probes[0].box.maximum[0]"},
        {"{'name': 'tank', 'point': [0, 0, 0]}", "already taken"},
        {"{'name': 'a', 'point': [0, 0, 0]}, {'name': 'a', 'solid': 'tank'}", "already taken"},
        {"{'wall': [0.05, 1.5, 0.05]}",
         "test:1:340: probes[0].wall: probe \"probe0\": expected a wall of a solid within 0.05 m"},
        {"{'pont': [0, 0, 0]}", "did you mean \"point\"?"},
        {"3", "probes[0]: expected"},
    };
    for (int k = 0; k < COUNT(cases); k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 SCENE(HEAD,
                       FLUID_BOX("'name': 'water', ", "0.0125", "0, 0, 0", "0.05, 0.05, 0.05", ""),
                       ", 'solids': [" TANK "], 'probes': [%s]"),
                 cases[k].probe);
        assert_refused(text, cases[k].message);
    }
    assert_refused(HUNG("2"), "probes[2].pin: expected");
    assert_refused(HUNG("1, 'number': 1"), "probes[2]: \"number\" needs a \"constraint\"");
    assert_refused(SCENE(HEAD, GRID_SHEET("", "1, 1", "3, 3", "'area_density': 1", SPRINGS("1")),
                         ", 'probes': [{'point': [0, 0, 0]}]"),
                   "\"point\" needs a body with the constraint \"fluid\"");
    assert_refused(SCENE(HEAD ", 'gravity': [0, 0, 0]",
                         FLUID_BOX("", "0.1", "0, 0, 0", "1, 1, 1", ""),
                         ", 'probes': [{'height': [0, 0, 0]}]"),
                   "\"height\" needs gravity");
    assert_refused(SCENE(HEAD, FLUID_BOX("", "0.1", "0, 0, 0", "1, 1, 1", ""),
                         ", 'probes': [{'wall': [0, 0, 0]}]"),
                   "\"wall\" needs a scene with solids");
    assert_refused(SCENE(HEAD, FLUID_BOX("", "0.1", "0, 0, 0", "1, 1, 1", ""),
                         ", 'probes': [{'solid': 'tank'}]"),
                   "\"solid\" needs a scene with solids");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest_long),   cmocka_unit_test(test_thin_wall),
        cmocka_unit_test(test_linear),      cmocka_unit_test(test_few),
        cmocka_unit_test(test_visits),      cmocka_unit_test(test_calls),
        cmocka_unit_test(test_columns),     cmocka_unit_test(test_values),
        cmocka_unit_test(test_single_pins), cmocka_unit_test(test_threads),
        cmocka_unit_test(test_memory),      cmocka_unit_test(test_resume),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests_name("probes", tests, scene_set_up, scene_tear_down);
}
