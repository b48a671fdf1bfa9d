/* Collapse of a water column, twice as high as its base a, on a dry floor: the front against Martin
 * & Moyce (1952), with T = t sqrt(2 g / a) and Z = front / a.
 *
 * The column is free at t = 0; in the experiment a current released a paper diaphragm. Walls have
 * no friction, so a channel of eight particles (four support radii) is wide enough. The front is
 * the position with four particles ahead (half a row across the channel) plus half a spacing: it
 * does not follow single spilled particles. */
#include "validation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 8, EXPERIMENTS = 2, MOST_RUNS = 8 };

static const double base = 0.05715;    /* m: 2.25 in */
static const double farthest = 4.2;    /* compared up to this Z */
static const double steady_from = 1.8; /* Z from which the front's speed is fitted */

struct curve { /* T and Z ascending */
    int count, capacity;
    double (*point)[2];
};

struct experiment {
    const char *name, *path;
    struct curve curve;
};

static void add_point(struct curve *curve, double T, double Z) {
    if (curve->count == curve->capacity) {
        curve->capacity = 2 * curve->capacity + 64;
        curve->point = realloc(curve->point, (size_t)curve->capacity * sizeof *curve->point);
        if (!curve->point) die("out of memory");
    }
    curve->point[curve->count][0] = T, curve->point[curve->count++][1] = Z;
}

static struct curve read_curve(const char *path) {
    struct curve curve = {0};
    char line[256];
    double T, Z;
    FILE *file = fopen(path, "r");
    if (!file) die("%s: cannot be read", path);
    while (fgets(line, sizeof line, file))
        if (sscanf(line, "%lf,%lf", &T, &Z) == 2 && Z <= farthest) add_point(&curve, T, Z);
    fclose(file);
    return curve;
}

/* T at which the curve first reaches Z. */
static double time_at(const struct curve *curve, double Z) {
    for (int k = 1; k < curve->count; k++) {
        const double *a = curve->point[k - 1], *b = curve->point[k];
        if (b[1] >= Z) return a[0] + (b[0] - a[0]) * (Z - a[1]) / (b[1] - a[1]);
    }
    die("the front does not reach %g", Z);
    return 0.0;
}

static double front(const pdyn_state *s, double spacing, double *scratch) {
    for (int i = 0; i < s->particles; i++) scratch[i] = s->x[3 * i];
    sort(scratch, s->particles);
    return scratch[s->particles - 1 - WIDTH / 2] + 0.5 * spacing;
}

/* run: CELLS or CELLS:INTEGRATOR */
static struct curve collapse(pdyn_context *context, const char *directory, const char *run) {
    int cells = atoi(run);
    const char *colon = strchr(run, ':');
    double d = base / cells, unit = sqrt(base / (2.0 * g));
    struct water water = {.spacing = d,
                          .cells = {cells, 2 * cells, WIDTH},
                          .tank = {7.0 * base, 3.0 * base, WIDTH * d},
                          .viscosity = 0.02,
                          .step = 0.32 / cells * unit,
                          .adaptive = true,
                          .duration = 10.0 * unit,
                          .integrator = colon ? colon + 1 : NULL};
    char name[64];
    snprintf(name, sizeof name, "martin_moyce_%d", cells);
    FILE *csv = open_csv(directory, name);
    pdyn_sim *sim = water_load(context, &water);
    const pdyn_state state = pdyn_get_state(sim);
    double *scratch = allocate((size_t)state.particles, sizeof *scratch), Z = 1.0;
    struct curve curve = {0};
    fprintf(csv, "T,Z\n");
    while (Z <= farthest && pdyn_time(sim) < water.duration) {
        Z = front(&state, d, scratch) / base;
        add_point(&curve, pdyn_time(sim) / unit, Z);
        fprintf(csv, "%.6g,%.6g\n", pdyn_time(sim) / unit, Z);
        take_step(sim);
    }
    free(scratch);
    pdyn_free(sim);
    fclose(csv);
    return curve;
}

static void print_times(const struct experiment *e, const struct curve *run, int runs) {
    for (int k = 0; k < e->curve.count; k++) {
        double T = e->curve.point[k][0], Z = e->curve.point[k][1];
        printf("| %s | %.3f | %.3f |", e->name, Z, T);
        for (int r = 0; r < runs; r++) {
            double ours = time_at(&run[r], Z);
            printf(" %.3f (%+.1f %%) |", ours, 100.0 * (ours / T - 1.0));
        }
        printf("\n");
    }
}

/* Mean difference of T (`of` minus `from`) at the Z of the experiment. */
static double mean_delay(const struct experiment *e, const struct curve *of,
                         const struct curve *from) {
    double sum = 0.0;
    for (int k = 0; k < e->curve.count; k++) {
        double Z = e->curve.point[k][1];
        sum += (of ? time_at(of, Z) : e->curve.point[k][0]) - time_at(from, Z);
    }
    return sum / e->curve.count;
}

/* Largest deviation from the measured T, with the run's start shifted by its lead. */
static double deviation(const struct experiment *e, const struct curve *run) {
    double worst = 0.0, lead = mean_delay(e, NULL, run);
    for (int k = 0; k < e->curve.count; k++) {
        double T = e->curve.point[k][0], Z = e->curve.point[k][1];
        worst = fmax(worst, fabs((time_at(run, Z) + lead) / T - 1.0));
    }
    return worst;
}

/* Slope of Z over T by least squares, at the Z of the experiment. */
static double speed(const struct experiment *e, const struct curve *run) {
    struct fit fit = {0};
    for (int k = 0; k < e->curve.count; k++) {
        double Z = e->curve.point[k][1], T = run ? time_at(run, Z) : e->curve.point[k][0];
        if (Z >= steady_from) fit_add(&fit, T, Z);
    }
    return fit_slope(&fit);
}

static void print_measures(const struct experiment *e, const struct curve *run, int runs) {
    printf("| %s | lead in T | |", e->name);
    for (int r = 0; r < runs; r++) printf(" %.3f |", mean_delay(e, NULL, &run[r]));
    printf("\n| %s | largest deviation of T + lead | |", e->name);
    for (int r = 0; r < runs; r++) printf(" %.1f %% |", 100.0 * deviation(e, &run[r]));
    printf("\n| %s | speed dZ/dT | %.3f |", e->name, speed(e, NULL));
    for (int r = 0; r < runs; r++) printf(" %.3f |", speed(e, &run[r]));
    printf("\n| %s | change of T from the resolution before | | |", e->name);
    for (int r = 1; r < runs; r++) printf(" %+.3f |", -mean_delay(e, &run[r - 1], &run[r]));
    printf("\n");
}

static void print_head(int count, char **cells) {
    printf("| a | Z | T measured |");
    for (int r = 0; r < count; r++) printf(" a/d = %s |", cells[r]);
    printf("\n|---|---|---|");
    for (int r = 0; r < count; r++) printf("---|");
    printf("\n");
}

void martin_moyce(pdyn_context *context, const char *directory, int count, char **cells) {
    struct experiment experiment[EXPERIMENTS] = {
        {"1.125 in", "bench/martin_moyce_1.125in.csv", {0}},
        {"2.25 in", "bench/martin_moyce_2.25in.csv", {0}}};
    struct curve run[MOST_RUNS];
    if (count > MOST_RUNS) die("at most %d resolutions", MOST_RUNS);
    for (int k = 0; k < EXPERIMENTS; k++) experiment[k].curve = read_curve(experiment[k].path);
    for (int r = 0; r < count; r++) run[r] = collapse(context, directory, cells[r]);
    print_head(count, cells);
    for (int k = 0; k < EXPERIMENTS; k++) print_times(&experiment[k], run, count);
    for (int k = 0; k < EXPERIMENTS; k++) print_measures(&experiment[k], run, count);
    for (int k = 0; k < EXPERIMENTS; k++) free(experiment[k].curve.point);
    for (int r = 0; r < count; r++) free(run[r].point);
}
