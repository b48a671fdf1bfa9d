/* Lintearia (Bernoulli 1692): a sheet between two horizontal bars holds water. Its tension T is
 * constant and its curvature is rho g depth / T: an elastica below the water level, straight above.
 * From the lowest point, with arc length s and angle a, a' = rho g max(0, H - y) / T; H and T
 * follow from the length of the sheet and the area of the water. Simulated in a slice a few
 * particles wide, between walls without friction, which keep the sheet in the slice. */
#include "coupling.h"

#include <math.h>
#include <stdlib.h>

static const double span = 0.4, length = 0.6, stiffness = 5e4; /* m, m, N/m */
static const double area_density = 0.2, h = 0.01;              /* kg/m^2, s */

/* ---- the solution ---------------------------------------------------------------------------- */

enum { STEPS = 2000 };

struct curve {                   /* half of the sheet, from the lowest point at the origin */
    double depth, tension, area; /* m, N/m, m^2 of the water, both halves */
    double x[STEPS + 1], y[STEPS + 1];
};

struct point {
    double x, y, angle;
};

static struct point slope_of(const struct curve *c, const struct point *p) {
    double head = fmax(0.0, c->depth - p->y);
    return (struct point){cos(p->angle), sin(p->angle), density * g * head / c->tension};
}

static struct point plus(const struct point *p, double ds, const struct point *d) {
    return (struct point){p->x + ds * d->x, p->y + ds * d->y, p->angle + ds * d->angle};
}

/* Integrates by Runge-Kutta; under tension the sheet is longer by the strain T / stiffness. */
static void integrate(struct curve *c) {
    double ds = 0.5 * length * (1.0 + c->tension / stiffness) / STEPS;
    struct point p = {0};
    c->area = c->x[0] = c->y[0] = 0.0;
    for (int n = 0; n < STEPS; n++) {
        struct point k1 = slope_of(c, &p), p2 = plus(&p, 0.5 * ds, &k1);
        struct point k2 = slope_of(c, &p2), p3 = plus(&p, 0.5 * ds, &k2);
        struct point k3 = slope_of(c, &p3), p4 = plus(&p, ds, &k3), k4 = slope_of(c, &p4);
        p = plus(&p, ds / 6.0, &k1), p = plus(&p, ds / 3.0, &k2);
        p = plus(&p, ds / 3.0, &k3), p = plus(&p, ds / 6.0, &k4);
        c->x[n + 1] = p.x, c->y[n + 1] = p.y;
        double rise = fmin(p.y, c->depth) - fmin(c->y[n], c->depth);
        c->area += (p.x + c->x[n]) * rise;
    }
}

/* Tension at which the sheet reaches from bar to bar, for this depth, N/m. */
static void reach(struct curve *c, double depth) {
    double low = log(1e-3), high = log(1e6);
    c->depth = depth;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        c->tension = exp(middle);
        integrate(c);
        if (c->x[STEPS] < 0.5 * span) low = middle;
        else high = middle;
    }
}

static void solve(struct curve *c, double area) {
    double low = 0.001, high = 0.5 * length;
    for (int k = 0; k < 50; k++) {
        double middle = 0.5 * (low + high);
        reach(c, middle);
        if (c->area < area) low = middle;
        else high = middle;
    }
}

/* ---- the sheet ------------------------------------------------------------------------------- */

/* Initial shape: an arc of a circle between the bars, which are at height 0. */
static double arc_angle(void) { /* half the angle of the arc */
    double low = 0.1, high = 3.0;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (sin(middle) / middle > span / length) low = middle;
        else high = middle;
    }
    return low;
}

static void arc_point(double s, double xy[2]) { /* s: from the middle, m */
    double half = arc_angle(), radius = 0.5 * length / half;
    xy[0] = radius * sin(s / radius), xy[1] = radius * (cos(half) - cos(s / radius));
}

static const double gap = 0.002, thickness = 0.001; /* m, from the sheet to a wall; of contact */

struct slice {
    double spacing, width; /* m, between the walls */
    int along, across;     /* segments of the sheet */
};

static double row_arc(const struct slice *slice, int row) {
    return length * ((double)row / slice->along - 0.5);
}

static void write_sheet(const struct slice *slice, const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    int n = slice->across + 1;
    for (int i = 0; i <= slice->along; i++)
        for (int j = 0; j < n; j++) {
            double xy[2], z = gap + (slice->width - 2.0 * gap) * j / slice->across;
            arc_point(row_arc(slice, i), xy);
            fprintf(file, "v %.17g %.17g %.17g\n", xy[0], xy[1], z);
        }
    write_triangles(file, slice->along, slice->across);
    fclose(file);
}

/* Columns of water on the arc, one particle wide, up to the level of the given area. */
static void fill(const struct slice *slice, double area, char *text, size_t size) {
    double d = slice->spacing, radius = 0.5 * length / arc_angle();
    double middle = radius * cos(arc_angle()); /* height of the centre above the bars */
    int cells = (int)round(area / (d * d)), columns = (int)(span / d), used = 0, placed = 0;
    enum { MOST = 512 };
    int floor_of[MOST], top[MOST];
    for (int k = 0; k < columns && k < MOST; k++) { /* rows count from the lowest point */
        double x = (k + 0.5 - 0.5 * columns) * d, edge = radius - d;
        double low = fabs(x) < edge ? middle - sqrt(edge * edge - x * x) : 0.0;
        floor_of[k] = top[k] = (int)ceil((low + radius - middle) / d);
    }
    for (int row = 0; placed < cells && row < MOST; row++)
        for (int k = 0; k < columns && placed < cells; k++)
            if (top[k] == row) top[k]++, placed++;
    for (int k = 0; k < columns && k < MOST; k++) {
        double x = (k - 0.5 * columns) * d, bottom = middle - radius - 0.5 * d;
        if (top[k] == floor_of[k]) continue;
        used += snprintf(text + used, size - (size_t)used,
                         "%s{'box': {'minimum': [%.9g, %.9g, 0], 'maximum': [%.9g, %.9g, %.9g]}}",
                         used ? ", " : "", x, bottom + floor_of[k] * d, x + d, bottom + top[k] * d,
                         slice->width);
    }
}

static pdyn_sim *load_slice(pdyn_context *context, const char *directory, const struct slice *slice,
                            double area) {
    char path[4096], boxes[65536];
    double d = slice->spacing, pressure = density * g * 0.2;
    snprintf(path, sizeof path, "%s/lintearia.obj", directory);
    write_sheet(slice, path);
    fill(slice, area, boxes, sizeof boxes);
    return load_text(
        context,
        "{'duration': 1000, 'frame_interval': 0.1, 'time_step': {'integrator': 'euler', 'maximum': "
        "%g}, 'solver': "
        "{'tolerance': 0.05, 'outer_iterations': 60}, 'bodies': [{'name': 'water', 'particles': "
        "{'radius': %.17g, 'fill': [%s]}, 'constraints': [{'type': 'fluid', 'viscosity': 0.1, "
        "'stiffness': %.17g}]}, {'name': 'sheet', 'surface': {'mesh': '%s', 'area_density': %g}, "
        "'constraints': [{'type': 'triangle', 'stretching_stiffness': %g}, {'type': 'bending', "
        "'bending_rigidity': 1e-5}, {'type': 'pin', 'vertices': [{'box': {'minimum': [-1, -0.001, "
        "-1], 'maximum': [1, 1, 1]}}]}]}], 'solids': [{'box': {'minimum': [-0.25, -0.35, 0], "
        "'maximum': [0.25, 0.05, %.17g]}, 'open': ['-x', '+x', '-y', '+y']}], 'contact': "
        "{'thickness': %g, 'friction': 0}}",
        h, 0.5 * d, boxes, 0.45 * pressure * d / 1e-3, path, area_density, stiffness, slice->width,
        thickness);
}

/* Mean position of a row, m. */
static void row_at(const pdyn_sim *sim, const struct slice *slice, int row, double xy[2]) {
    const pdyn_state s = pdyn_get_state(sim);
    int n = slice->across + 1, first = pdyn_get_body(sim, 1).first + row * n;
    xy[0] = xy[1] = 0.0;
    for (int j = 0; j < n; j++)
        for (int a = 0; a < 2; a++) xy[a] += s.x[3 * (first + j) + a] / n;
}

/* RMS distance of the rows from the exact curve over the span. csv: output of the rows, or NULL. */
static double deviation(const pdyn_sim *sim, const struct slice *slice, const struct curve *c,
                        FILE *csv) {
    double sum = 0.0, bars = c->y[STEPS];
    for (int i = 0; i <= slice->along; i++) {
        double xy[2], s = row_arc(slice, i), at = fabs(s) / (0.5 * length) * STEPS;
        int n = at < STEPS ? (int)at : STEPS - 1;
        double x = c->x[n] + (at - n) * (c->x[n + 1] - c->x[n]);
        double y = c->y[n] + (at - n) * (c->y[n + 1] - c->y[n]) - bars;
        row_at(sim, slice, i, xy);
        if (s < 0.0) x = -x;
        sum += (xy[0] - x) * (xy[0] - x) + (xy[1] - y) * (xy[1] - y);
        if (csv)
            fprintf(csv, "%g,%g,%.6g,%.6g,%.6g,%.6g\n", slice->spacing, c->area, x, y, xy[0],
                    xy[1]);
    }
    return sqrt(sum / (slice->along + 1)) / span;
}

static void run(pdyn_context *context, const char *directory, FILE *csv, double area,
                double spacing, double seconds, const struct curve *exact) {
    struct slice slice = {spacing, 4.0 * spacing, 2 * (int)(0.5 * length / spacing + 0.5), 6};
    pdyn_sim *sim = load_slice(context, directory, &slice, area);
    double peak = 0.0, kinetic = 0.0, start = deviation(sim, &slice, exact, NULL), middle[2];
    while (pdyn_time(sim) < seconds) {
        kinetic = take_step(sim).kinetic_energy;
        peak = fmax(peak, kinetic);
    }
    row_at(sim, &slice, slice.along / 2, middle);
    printf("| %.4f | %.4f | %.1f | %g | %d | %.4f | %.2f %% | %.2f %% | %.0e |\n", area,
           exact->depth, exact->tension, 1e3 * spacing, pdyn_get_body(sim, 0).count,
           -middle[1] / exact->y[STEPS], 100.0 * start, 100.0 * deviation(sim, &slice, exact, csv),
           kinetic / peak);
    fflush(stdout);
    pdyn_free(sim);
}

void lintearia(pdyn_context *context, const char *directory, double seconds, int count,
               char **spacings) {
    static const double areas[] = {0.015, 0.03, 0.045};
    static struct curve exact;
    FILE *csv = open_csv(directory, "lintearia");
    fprintf(csv, "spacing,area,exact_x,exact_y,x,y\n");
    printf("| water, m^2 | depth, m | T, N/m | spacing, mm | particles | sag over the exact one | "
           "RMS at the start, of the span | RMS at the end | kinetic energy over its peak "
           "|\n|---|---|---|---|---|---|---|---|---|\n");
    for (size_t a = 0; a < sizeof areas / sizeof *areas; a++) {
        solve(&exact, areas[a]);
        for (int k = 0; k < count; k++)
            run(context, directory, csv, areas[a], 1e-3 * atof(spacings[k]), seconds, &exact);
    }
    fclose(csv);
}
