/* Catenary: an inextensible strip of length S between two supports at the same height, d apart.
 * With S / d = sinh(u) / u, its sag is d (cosh(u) - 1) / (2 u) and its largest tension w d cosh(u)
 * / (2 u), w: weight per length. */
#include "strip.h"
#include "validation.h"

#include <math.h>
#include <stdlib.h>

static const double distance = 1.0, area_density = 0.2, stiffness = 5e3; /* m, kg/m^2, N/m */

static double sinc(double a) { return sin(a) / a; }
static double sinhc(double a) { return sinh(a) / a; }

/* Solves f(x) = value for a monotonic f between two numbers, by bisection. */
static double solve(double (*f)(double), double value, double low, double high) {
    bool rises = f(high) > f(low);
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        if ((f(middle) < value) == rises) low = middle;
        else high = middle;
    }
    return low;
}

/* Initial shape: an arc of a circle between the supports; shape: half its angle. */
static void on_arc(const struct strip *s, double arc, double xy[2]) {
    double radius = 0.5 * distance / sin(s->shape), length = 2.0 * s->shape * radius;
    double angle = (arc / length - 0.5) * 2.0 * s->shape;
    xy[0] = radius * sin(angle), xy[1] = radius * (cos(s->shape) - cos(angle));
}

/* Tension in the middle of the first segment, from its strain, and at the support, N/m. */
static double tension(pdyn_sim *sim, const struct strip *strip) {
    double a[3], b[3], d = 0.0;
    strip_row(sim, strip, 0, a), strip_row(sim, strip, 1, b);
    for (int k = 0; k < 3; k++) d += (b[k] - a[k]) * (b[k] - a[k]);
    double angle = 2.0 * strip->shape / strip->along, radius = 0.5 * distance / sin(strip->shape);
    double rest = 2.0 * radius * sin(0.5 * angle);
    return stiffness * (sqrt(d) / rest - 1.0) + area_density * g * 0.5 * (a[1] - b[1]);
}

void catenary(pdyn_context *context, const char *directory, int count, char **segments) {
    static const double ratios[] = {1.5, 2.0};
    printf("| S / d | segments | sag / d | | T_max / (w d) | |\n|---|---|---|---|---|---|\n");
    for (int k = 0; k < 2 * count; k++) {
        double ratio = ratios[k / count], u = solve(sinhc, ratio, 1e-3, 10.0), low[3];
        struct strip strip = {
            .name = "catenary",
            .along = atoi(segments[k % count]),
            .across = 2,
            .segment = ratio * distance / atoi(segments[k % count]),
            .growth = 1.0,
            .place = on_arc,
            .shape = solve(sinc, 1.0 / ratio, 1e-3, acos(-1.0)),
            .area_density = area_density,
            .constraints = "{\"type\": \"triangle\", \"stretching_stiffness\": 5e3, \"shortest\": "
                           "0}, {\"type\": "
                           "\"pin\", \"stiffness\": 1e7, \"vertices\": {\"box\": {\"minimum\": "
                           "[-2, -1e-6, -1], \"maximum\": [2, 1, 1]}}}",
            .h = 0.1,
            .gravity = {0.0, -g, 0.0},
            .tolerance = 1e-7};
        pdyn_sim *sim = strip_load(context, directory, &strip);
        strip_settle(sim, &strip, 1e-5);
        strip_row(sim, &strip, strip.along / 2, low);
        double sag = (cosh(u) - 1.0) / (2.0 * u), most = cosh(u) / (2.0 * u);
        double found = tension(sim, &strip) / (area_density * g * distance);
        printf("| %g | %d | %.6f (%.6f) | %+.3f %% | %.6f (%.6f) | %+.3f %% |\n", ratio,
               strip.along, -low[1] / distance, sag, 100.0 * (-low[1] / distance / sag - 1.0),
               found, most, 100.0 * (found / most - 1.0));
        pdyn_free(sim);
    }
}
