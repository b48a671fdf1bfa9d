/* Heavy elastica: a horizontally clamped strip bends under its weight. Gamma = w L^3 / B, w: weight
 * per area. With the angle theta below the horizontal and the arc length s, B theta'' = -w (L - s)
 * cos(theta), theta(0) = 0, theta'(L) = 0 (Wang 1986). Compared: drop over reach of the tip, H / W.
 */
#include "strip.h"
#include "validation.h"

#include <math.h>

/* ---- the solution ---------------------------------------------------------------------------- */

static const double level = 1.57079632679489662; /* gap (pi/2 - angle) of a horizontal strip */

struct tip { /* of the tip of a strip of length 1 */
    double drop, reach;
};

struct point { /* d gap / dr = bend */
    double gap, bend, drop, reach;
};

static struct point slope_of(double gamma, double r, struct point p) {
    return (struct point){p.bend, gamma * r * sin(p.gap), cos(p.gap), sin(p.gap)};
}

static struct point plus(struct point p, double h, struct point d) {
    return (struct point){p.gap + h * d.gap, p.bend + h * d.bend, p.drop + h * d.drop,
                          p.reach + h * d.reach};
}

/* Integrates from the tip to the clamp, or to a horizontal tangent before it, by Runge-Kutta. */
static struct point integrate(double gamma, double gap) {
    enum { STEPS = 20000 };
    double h = 1.0 / STEPS;
    struct point p = {.gap = gap};
    for (int n = 0; n < STEPS && p.gap < level; n++) {
        double r = n * h;
        struct point a = slope_of(gamma, r, p);
        struct point b = slope_of(gamma, r + 0.5 * h, plus(p, 0.5 * h, a));
        struct point c = slope_of(gamma, r + 0.5 * h, plus(p, 0.5 * h, b));
        struct point d = slope_of(gamma, r + h, plus(p, h, c));
        p = plus(plus(plus(plus(p, h / 6.0, a), h / 3.0, b), h / 3.0, c), h / 6.0, d);
    }
    return p;
}

/* Shooting: bisects the logarithm of the gap at the tip until the strip is horizontal at the clamp.
 */
static struct tip exact(double gamma) {
    double low = -300.0, high = log(level);
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        if (integrate(gamma, exp(middle)).gap < level) low = middle;
        else high = middle;
    }
    struct point p = integrate(gamma, exp(low));
    return (struct tip){p.drop, p.reach};
}

/* ---- the strip ------------------------------------------------------------------------------- */

static const double length = 1.0, area_density = 0.2, stiffness = 2e4; /* m, kg/m^2, N/m */

/* The clamp lies in the middle between the first two rows, which are pinned. last: length of the
 * last segment over that of the first. */
static struct tip measure(pdyn_context *context, const char *directory, double gamma, int segments,
                          double last, bool irregular) {
    char constraints[512];
    double mean[3], rigidity = area_density * g * length * length * length / gamma;
    struct strip strip = {.name = "elastica",
                          .along = segments,
                          .across = 2,
                          .segment = 1.0,
                          .growth = pow(last, 1.0 / (segments - 1)),
                          .random = irregular ? 0.2 : 0.0,
                          .area_density = area_density,
                          .constraints = constraints,
                          .h = 1.0,
                          .gravity = {0.0, -g, 0.0},
                          .tolerance = 1e-6};
    strip.segment = length / (strip_length(&strip, segments) - 0.5);
    strip.first = -0.5 * strip.segment;
    snprintf(constraints, sizeof constraints,
             "{\"type\": \"%s\", \"stretching_stiffness\": %g}, {\"type\": \"bending\", "
             "\"bending_rigidity\": %.17g}, {\"type\": \"pin\", \"stiffness\": 1e8, \"vertices\": "
             "{\"box\": "
             "{\"minimum\": [-1, -1, -1], \"maximum\": [%.17g, 1, 1]}}}",
             irregular ? "triangle" : "spring", stiffness, rigidity, 0.6 * strip.segment);
    pdyn_sim *sim = strip_load(context, directory, &strip);
    strip_settle(sim, &strip, 1e-4);
    strip_row(sim, &strip, segments, mean);
    pdyn_free(sim);
    return (struct tip){-mean[1], mean[0]};
}

static void print_head(int count, char **meshes) {
    printf("| Gamma | H / W |");
    for (int k = 0; k < count; k++) printf(" %s, regular | irregular |", meshes[k]);
    printf("\n|---|---|");
    for (int k = 0; k < count; k++) printf("---|---|");
    printf("\n");
}

void elastica(pdyn_context *context, const char *directory, int count, char **meshes) {
    static const double gammas[] = {0.1, 1, 10, 100, 1000, 10000};
    FILE *csv = open_csv(directory, "elastica");
    fprintf(csv, "gamma,exact,segments,last,irregular,measured\n");
    print_head(count, meshes);
    for (size_t i = 0; i < sizeof gammas / sizeof *gammas; i++) {
        struct tip right = exact(gammas[i]);
        double expected = right.drop / right.reach;
        printf("| %g | %.6f |", gammas[i], expected);
        for (int k = 0; k < 2 * count; k++) {
            int segments;
            double last = 1.0;
            if (sscanf(meshes[k / 2], "%dx%lf", &segments, &last) < 1 || segments < 3)
                die("expected SEGMENTS or SEGMENTSxLAST, found %s", meshes[k / 2]);
            struct tip tip = measure(context, directory, gammas[i], segments, last, k % 2);
            double ratio = tip.drop / tip.reach;
            printf(" %+.2f %% |", 100.0 * (ratio / expected - 1.0));
            fprintf(csv, "%g,%.9g,%d,%g,%d,%.9g\n", gammas[i], expected, segments, last, k % 2,
                    ratio);
            fflush(stdout);
        }
        printf("\n");
    }
    fclose(csv);
}
