/* Hanging chain: an inextensible strip held at its top oscillates in one mode, y = J_0(2 omega
 * sqrt(r / g)), r from the free end; omega sqrt(L / g) is half a zero of J_0. Per step of h,
 * implicit Euler advances the phase by atan(omega h) and reduces the amplitude by 1 / sqrt(1 +
 * (omega h)^2). */
#include "strip.h"
#include "validation.h"

#include <math.h>
#include <stdlib.h>

static const double length = 1.0; /* m */

enum { SWINGS = 5 };

/* Initial shape: the mode of frequency shape sqrt(g / L), with an amplitude of L / 1000 at the end.
 */
static void in_mode(const struct strip *s, double arc, double xy[2]) {
    xy[0] = arc, xy[1] = 1e-3 * length * j0(2.0 * s->shape * sqrt(fabs(1.0 - arc / length)));
}

/* Amplitude of the mode in the current shape. */
static double amplitude(const pdyn_sim *sim, const struct strip *strip) {
    const pdyn_state state = pdyn_get_state(sim);
    double sum = 0.0, at[3];
    for (int i = 0; i <= strip->along; i++) {
        double mode[2], end = i == 0 || i == strip->along ? 0.5 : 1.0;
        in_mode(strip, strip_length(strip, i), mode);
        strip_row(sim, strip, i, at);
        sum += end * mode[1] * at[1];
    }
    return state.particles ? sum : 0.0;
}

/* Frequency from the zero crossings of the amplitude, decay from its maxima in between. */
static void swing(pdyn_context *context, const char *directory, const struct strip *strip,
                  double *omega, double *decay) {
    struct fit passages = {0}, sizes = {0};
    pdyn_sim *sim = strip_load(context, directory, strip);
    double before = amplitude(sim, strip), largest = 0.0;
    for (int k = 0; k < SWINGS;) {
        pdyn_step_info info = take_step(sim);
        double now = amplitude(sim, strip);
        if (now * before < 0.0) {
            double time = info.time - info.h * now / (now - before);
            fit_add(&passages, k, time);
            if (k) fit_add(&sizes, time, log(largest));
            k++, largest = 0.0;
        }
        largest = fmax(largest, fabs(now)), before = now;
    }
    pdyn_free(sim);
    *omega = acos(-1.0) / fit_slope(&passages), *decay = -fit_slope(&sizes);
}

void chain(pdyn_context *context, const char *directory, int segments, int count, char **steps) {
    static const double zeros[] = {2.404825557695773, 5.520078110286311, 8.653727912911012};
    printf("| mode | h, ms | omega sqrt(L / g) | of the chain | of the chain and implicit Euler "
           "| decay, 1/s | of implicit Euler |\n|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < 3 * count; k++) {
        double h = 1e-3 * atof(steps[k % count]), unit = sqrt(g / length), omega, decay;
        double theory = 0.5 * zeros[k / count] * unit;
        struct strip strip = {
            .name = "chain",
            .along = segments,
            .across = 2,
            .segment = length / segments,
            .growth = 1.0,
            .place = in_mode,
            .shape = 0.5 * zeros[k / count],
            .area_density = 0.2,
            .constraints = "{\"type\": \"triangle\", \"stretching_stiffness\": 1e4}, {\"type\": "
                           "\"pin\", \"stiffness\": 1e7, \"vertices\": {\"box\": {\"minimum\": "
                           "[-1, -1, -1], \"maximum\": [1e-6, 1, 1]}}}",
            .h = h,
            .gravity = {g, 0.0, 0.0},
            .tolerance = 1e-6};
        swing(context, directory, &strip, &omega, &decay);
        printf("| %d | %g | %.5f | %.5f (%+.2f %%) | %.5f (%+.2f %%) | %.4f | %.4f |\n",
               k / count + 1, 1e3 * h, omega / unit, theory / unit, 100.0 * (omega / theory - 1.0),
               atan(theory * h) / h / unit, 100.0 * (omega * h / atan(theory * h) - 1.0), decay,
               0.5 * log1p(theory * h * theory * h) / h);
    }
}
