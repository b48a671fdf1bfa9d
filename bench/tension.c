/* Surface tension: pressure in a drop, period of its oscillation, a cube that becomes a sphere, and
 * contact angles. Rows of tables for docs/results/materials.md. Usage: tension
 * [pressure | period | cube | angle | all [KERNEL]] */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846, density = 1000.0, d = 1e-3; /* kg/m^3, m */
static const char *kernel = "cubic_spline";
enum { TEXT = 2048 };

struct drop {
    const char *fill; /* JSON of an entry of "fill" */
    double tension;   /* N/m */
    double step;      /* s */
    double viscosity; /* XSPH */
    double angle;     /* degrees */
    const char *solids;
};

static pdyn_sim *load(pdyn_context *context, const struct drop *drop) {
    return load_text(context,
                     "{'gravity': [0, 0, 0], 'duration': 100, 'kernel': '%s', 'time_step': "
                     "{'maximum': %g}, "
                     "'solver': {'linear_tolerance': 0.1}, 'bodies': [{'particles': {'radius': %g, "
                     "'fill': [%s]}, 'constraints': [{'type': 'fluid', 'sound_speed': 5, "
                     "'viscosity': %g}, {'type': 'surface_tension', 'tension': %g, "
                     "'contact_angle': %g}]}], 'solids': [%s]}",
                     kernel, drop->step, 0.5 * d, drop->fill, drop->viscosity, drop->tension,
                     drop->angle, drop->solids);
}

struct shape {
    double middle[3];  /* m */
    double moments[3]; /* m^2, mean squares of the distances from the middle along the axes */
    double radius;     /* m, of a sphere of these moments */
    double kinetic;    /* J */
};

static struct shape shape_of(const pdyn_sim *sim) {
    struct shape s = {0};
    pdyn_state state = pdyn_get_state(sim);
    int n = pdyn_get_body(sim, 0).count;
    for (int k = 0; k < 3 * n; k++) s.middle[k % 3] += state.x[k] / n;
    for (int k = 0; k < 3 * n; k++) {
        s.moments[k % 3] += pow(state.x[k] - s.middle[k % 3], 2) / n;
        s.kinetic += 0.5 * density * d * d * d * pow(state.v[k], 2);
    }
    s.radius = sqrt(5.0 / 3.0 * (s.moments[0] + s.moments[1] + s.moments[2]));
    return s;
}

/* Radius of a sphere of the particles' volume, m. */
static double rest_radius(const pdyn_sim *sim) {
    return d * cbrt(3.0 * pdyn_get_body(sim, 0).count / (4.0 * pi));
}

static void settle(pdyn_sim *sim, double time) {
    while (pdyn_time(sim) < time) take_step(sim);
}

/* ---- Laplace: 2 tension / R ------------------------------------------------------------------ */

/* The mean pressure three spacings and more below the surface. */
static double inner_pressure(const pdyn_sim *sim) {
    pdyn_state state = pdyn_get_state(sim);
    struct shape s = shape_of(sim);
    double sum = 0.0, reach = rest_radius(sim) - 3.0 * d;
    int count = 0;
    for (int i = 0; i < pdyn_get_body(sim, 0).count; i++) {
        double squared = 0.0;
        for (int a = 0; a < 3; a++) squared += pow(state.x[3 * i + a] - s.middle[a], 2);
        if (squared < reach * reach) sum += state.pressure[i], count++;
    }
    return sum / count;
}

static void laplace(pdyn_context *context, double cells, double tension) {
    char fill[TEXT];
    snprintf(fill, sizeof fill, "{\"sphere\": {\"center\": [0, 0, 0], \"radius\": %g}}",
             0.5 * cells * d);
    double time = sqrt(density * pow(0.5 * cells * d, 3) / tension), sum = 0.0;
    struct drop drop = {fill, tension, time / 100.0, 0.2, 90.0, ""};
    pdyn_sim *sim = load(context, &drop);
    settle(sim, 2.0 * time);
    int steps = 0;
    for (; pdyn_time(sim) < 4.0 * time; steps++) take_step(sim), sum += inner_pressure(sim);
    double expected = 2.0 * tension / rest_radius(sim), found = sum / steps;
    printf("| %.1f | %g | %.2f | %.2f | %+.0f %% | %+.1f %% |\n", rest_radius(sim) / d, tension,
           expected, found, 100.0 * (found / expected - 1.0),
           100.0 * (pow(shape_of(sim).radius / rest_radius(sim), 3) - 1.0));
    fflush(stdout);
    pdyn_free(sim);
}

/* ---- Rayleigh: omega^2 = 8 tension / (density R^3) ------------------------------------------- */

/* Particles of a lattice in an ellipsoid of the volume of a sphere, of this ratio of axes. */
static void write_ellipsoid(const char *path, double radius, double ratio) {
    enum { HALF = 24 };
    double axis[3] = {radius * pow(ratio, 2.0 / 3.0), radius / cbrt(ratio), radius / cbrt(ratio)};
    static double x[8 * HALF * HALF * HALF][3];
    int n = 0;
    for (int k = 0; k < 8 * HALF * HALF * HALF; k++) {
        int at[3] = {k % (2 * HALF), k / (2 * HALF) % (2 * HALF), k / (4 * HALF * HALF)};
        double sum = 0.0;
        for (int a = 0; a < 3; a++) {
            x[n][a] = (at[a] - HALF + 0.5) * d;
            sum += pow(x[n][a] / axis[a], 2);
        }
        n += sum < 1.0;
    }
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    fprintf(file,
            "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double "
            "y\nproperty double z\nend_header\n",
            n);
    for (int i = 0; i < n; i++) fprintf(file, "%.9g %.9g %.9g\n", x[i][0], x[i][1], x[i][2]);
    fclose(file);
}

static void period(pdyn_context *context, double cells, double tension) {
    char fill[TEXT], path[] = "/tmp/projdyn_drop_XXXXXX.ply";
    int file = mkstemps(path, 4);
    if (file < 0) die("no temporary file");
    write_ellipsoid(path, 0.5 * cells * d, 1.25);
    snprintf(fill, sizeof fill, "{\"file\": \"%s\"}", path);
    double expected = 2.0 * pi * sqrt(density * pow(0.5 * cells * d, 3) / (8.0 * tension));
    double crossing[3], before = 1.0, at = 0.0;
    int crossings = 0;
    struct drop drop = {fill, tension, expected / 200.0, 0.2, 90.0, ""};
    pdyn_sim *sim = load(context, &drop);
    expected = 2.0 * pi * sqrt(density * pow(rest_radius(sim), 3) / (8.0 * tension));
    while (crossings < 3 && pdyn_time(sim) < 3.0 * expected) {
        take_step(sim);
        struct shape s = shape_of(sim);
        double now = s.moments[0] - 0.5 * (s.moments[1] + s.moments[2]), time = pdyn_time(sim);
        if ((now > 0.0) != (before > 0.0))
            crossing[crossings++] = at + (time - at) * before / (before - now);
        before = now, at = time;
    }
    double found = crossings == 3 ? crossing[2] - crossing[0] : NAN;
    printf("| %.1f | %g | %.4f | %.4f | %+.0f %% |\n", rest_radius(sim) / d, tension, expected,
           found, 100.0 * (found / expected - 1.0));
    fflush(stdout);
    pdyn_free(sim);
    remove(path);
}

/* ---- a cube ---------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Least and greatest distance of two opposite tangent planes, over their mean. */
static void widths(const pdyn_sim *sim, double *least, double *greatest) {
    enum { DIRECTIONS = 200 };
    pdyn_state state = pdyn_get_state(sim);
    double width[DIRECTIONS], mean = 0.0;
    for (int k = 0; k < DIRECTIONS; k++) {
        double z = (k + 0.5) / DIRECTIONS, turn = 2.39996 * k, low = HUGE_VAL, high = -HUGE_VAL;
        double n[3] = {sqrt(1.0 - z * z) * cos(turn), sqrt(1.0 - z * z) * sin(turn), z};
        for (int i = 0; i < pdyn_get_body(sim, 0).count; i++) {
            double at = 0.0;
            for (int a = 0; a < 3; a++) at += n[a] * state.x[3 * i + a];
            low = fmin(low, at), high = fmax(high, at);
        }
        width[k] = high - low + d, mean += width[k] / DIRECTIONS;
    }
    qsort(width, DIRECTIONS, sizeof *width, ascending);
    *least = width[0] / mean, *greatest = width[DIRECTIONS - 1] / mean;
}

static void cube(pdyn_context *context, double cells) {
    char fill[TEXT];
    double h = 0.5 * cells * d, tension = 0.072, least, greatest;
    snprintf(fill, sizeof fill, "{\"box\": {\"minimum\": [%g, %g, %g], \"maximum\": [%g, %g, %g]}}",
             -h, -h, -h, h, h, h);
    double time = sqrt(density * h * h * h / tension), ms = 0.0;
    struct drop drop = {fill, tension, time / 100.0, 0.4, 90.0, ""};
    pdyn_sim *sim = load(context, &drop);
    int steps = 0;
    for (; pdyn_time(sim) < 12.0 * time; steps++) ms += take_step(sim).ms_cpu;
    struct shape s = shape_of(sim);
    double area = 4.0 * pi * pow(rest_radius(sim), 2);
    widths(sim, &least, &greatest);
    printf("| %d | %.3f, %.3f | %+.1f %% | %+.1f, %+.1f %% | %.1f %% | %.1f |\n",
           pdyn_get_body(sim, 0).count, least, greatest,
           100.0 * (pow(s.radius / rest_radius(sim), 3) - 1.0),
           50.0 * (s.moments[1] / s.moments[0] - 1.0), 50.0 * (s.moments[2] / s.moments[0] - 1.0),
           100.0 * s.kinetic / (tension * area), ms / steps);
    fflush(stdout);
    pdyn_free(sim);
}

/* ---- contact angle --------------------------------------------------------------------------- */

/* The angle of the spherical cap of this volume and mean height. */
static double cap_angle(double volume, double height) {
    double low = 1.0, high = 179.0;
    for (int k = 0; k < 50; k++) {
        double middle = 0.5 * (low + high), c = cos(middle * pi / 180.0);
        double radius = cbrt(3.0 * volume / (pi * (1.0 - c) * (1.0 - c) * (2.0 + c)));
        double top = radius * (1.0 - c);
        double mean = 0.75 * pow(2.0 * radius - top, 2) / (3.0 * radius - top) - radius * c;
        if (mean < height) low = middle;
        else high = middle;
    }
    return low;
}

/* Of the cap that the particles below a height would be: single ones jump off as a box contracts.
 */
static double angle_of_drop(const pdyn_sim *sim, double top) {
    pdyn_state state = pdyn_get_state(sim);
    double height = 0.0;
    int n = 0;
    for (int i = 0; i < pdyn_get_body(sim, 0).count; i++)
        if (state.x[3 * i + 1] < top) height += state.x[3 * i + 1], n++;
    return cap_angle(n * d * d * d, height / n);
}

static void contact_angle(pdyn_context *context, double angle, double cells) {
    char fill[TEXT];
    double h = 0.5 * cells * d, tension = 0.072;
    snprintf(fill, sizeof fill, "{\"box\": {\"minimum\": [%g, 0, %g], \"maximum\": [%g, %g, %g]}}",
             -h, -h, h, 1.4 * h, h);
    double time = sqrt(density * h * h * h / tension);
    struct drop drop = {fill,
                        tension,
                        time / 100.0,
                        0.3,
                        angle,
                        "{\"box\": {\"minimum\": [-0.03, 0, -0.03], \"maximum\": [0.03, 0.06, "
                        "0.03]}, \"open\": [\"+y\"]}"};
    pdyn_sim *sim = load(context, &drop);
    printf("| %g | %d |", angle, pdyn_get_body(sim, 0).count);
    for (double units = 10.0; units <= 40.0; units *= 2.0) {
        settle(sim, units * time);
        printf(" %.0f |", angle_of_drop(sim, 2.0 * h));
        fflush(stdout);
    }
    printf("\n");
    pdyn_free(sim);
}

static void all_pressures(pdyn_context *context) {
    printf("| R/d | tension, N/m | 2 tension / R, Pa | pressure, Pa | error | volume |\n"
           "|---|---|---|---|---|---|\n");
    laplace(context, 14.0, 0.072), laplace(context, 18.0, 0.072), laplace(context, 22.0, 0.072);
    laplace(context, 18.0, 0.72);
}

static void all_periods(pdyn_context *context) {
    printf("| R/d | tension, N/m | period, s | found, s | error |\n|---|---|---|---|---|\n");
    period(context, 14.0, 0.072), period(context, 18.0, 0.072), period(context, 22.0, 0.072);
    period(context, 18.0, 0.72);
}

static void all_cubes(pdyn_context *context) {
    printf("| particles | widths | volume | radii | kinetic | ms a step |\n"
           "|---|---|---|---|---|---|\n");
    cube(context, 12.0), cube(context, 16.0);
}

static void all_angles(pdyn_context *context) {
    printf("| angle | particles | after 10 | 20 | 40 units |\n|---|---|---|---|---|\n");
    for (double angle = 60.0; angle <= 120.0; angle += 30.0) contact_angle(context, angle, 14.0);
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(pdyn_context *context);
    } parts[] = {{"pressure", all_pressures},
                 {"period", all_periods},
                 {"cube", all_cubes},
                 {"angle", all_angles}};
    pdyn_context *context = make_context(1);
    if (argc > 2) kernel = argv[2];
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        if (argc < 2 || !strcmp(argv[1], "all") || !strcmp(argv[1], parts[k].name))
            parts[k].run(context), printf("\n");
    pdyn_destroy(context);
    return 0;
}
