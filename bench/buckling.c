/* Self-buckling (Greenhill 1881): a strip clamped at its foot stands upright for Gamma = w L^3 / B
 * below 7.8373. A small sideways load makes it lean by about 1 / (1 - Gamma / 7.8373), so 1 / lean
 * falls linearly to zero (Southwell 1932). Higher buckling modes contribute, too: the zero of that
 * line is 0.2 % low. */
#include "strip.h"
#include "validation.h"

#include <stdlib.h>

static const double length = 1.0, area_density = 0.2, critical = 7.83734744; /* m, kg/m^2 */

/* Sideways displacement of the tip, m. */
static double lean(pdyn_context *context, const char *directory, double gamma, int segments,
                   bool irregular) {
    char constraints[512];
    double tip[3], segment = length / (segments - 0.5);
    snprintf(constraints, sizeof constraints,
             "{\"type\": \"triangle\", \"stretching_stiffness\": 2e4}, {\"type\": \"bending\", "
             "\"bending_rigidity\": %.17g}, {\"type\": \"pin\", \"stiffness\": 1e7, \"vertices\": "
             "{\"box\": {\"minimum\": [-1, -1, -1], \"maximum\": [%.17g, 1, 1]}}}",
             area_density * g * length * length * length / gamma, 0.6 * segment);
    struct strip strip = {.name = "buckling",
                          .along = segments,
                          .across = 4,
                          .segment = segment,
                          .growth = 1.0,
                          .random = irregular ? 0.2 : 0.0,
                          .first = -0.5 * segment,
                          .area_density = area_density,
                          .constraints = constraints,
                          .h = 0.3,
                          .gravity = {-g, -1e-4 * g, 0.0},
                          .tolerance = 1e-8};
    pdyn_sim *sim = strip_load(context, directory, &strip);
    strip_settle(sim, &strip, 1e-5);
    strip_row(sim, &strip, segments, tip);
    pdyn_free(sim);
    return -tip[1];
}

void buckling(pdyn_context *context, const char *directory, int count, char **segments) {
    printf("| segments | mesh | lean / L at 0.97 Gamma | at 1.03 Gamma | critical Gamma | |\n"
           "|---|---|---|---|---|---|\n");
    for (int k = 0; k < 2 * count; k++) {
        int n = atoi(segments[k / 2]);
        double at[2] = {0.94, 0.97}, off[2];
        for (int i = 0; i < 2; i++) off[i] = lean(context, directory, at[i] * critical, n, k % 2);
        double over = lean(context, directory, 1.03 * critical, n, k % 2);
        double slope = (1.0 / off[1] - 1.0 / off[0]) / (at[1] - at[0]);
        double found = at[1] - 1.0 / off[1] / slope;
        printf("| %d | %s | %.2g | %.2g | %.4f | %+.2f %% |\n", n, k % 2 ? "irregular" : "regular",
               off[1], over, found * critical, 100.0 * (found - 1.0));
    }
}
