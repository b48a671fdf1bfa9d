/* Modulus of a sheet on any mesh: a strip hung by its first row is extended by w L^2 / (2 Y) under
 * its weight. At half its length it is narrower by Poisson's ratio times the strain there. */
#include "strip.h"
#include "validation.h"

#include <stdlib.h>
#include <string.h>

static const double length = 1.0, area_density = 0.2, stiffness = 100.0; /* m, kg/m^2, N/m */

/* Width of the middle row, m. */
static double width(const pdyn_sim *sim, const struct strip *strip) {
    const pdyn_state state = pdyn_get_state(sim);
    int first = strip_vertex(strip, strip->along / 2, 0);
    return state.x[3 * (first + strip->across) + 2] - state.x[3 * first + 2];
}

static void stretch_one(pdyn_context *context, const char *directory, int segments,
                        const char *type, bool irregular) {
    char constraints[512];
    double end[3], middle = area_density * g * 0.5 * length / stiffness;
    snprintf(constraints, sizeof constraints,
             "{\"type\": \"%s\", \"stretching_stiffness\": %g}, {\"type\": \"pin\", "
             "\"stiffness\": 1e7, \"vertices\": {\"box\": {\"minimum\": [-1, -1, -1], \"maximum\": "
             "[1e-6, 1, 1]}}}",
             type, stiffness);
    struct strip strip = {.name = "stretch",
                          .along = segments,
                          .across = segments / 5,
                          .segment = length / segments,
                          .growth = 1.0,
                          .random = irregular ? 0.2 : 0.0,
                          .area_density = area_density,
                          .constraints = constraints,
                          .h = 1.0,
                          .gravity = {g, 0.0, 0.0},
                          .tolerance = 1e-6};
    pdyn_sim *sim = strip_load(context, directory, &strip);
    double before = width(sim, &strip);
    strip_settle(sim, &strip, 1e-6);
    strip_row(sim, &strip, segments, end);
    double modulus = 0.5 * area_density * g * length * length / (end[0] - length);
    double ratio = (1.0 - width(sim, &strip) / before) / (middle * stiffness / modulus);
    printf("| %s | %s | %d | %.3f | %.3f |\n", type, irregular ? "irregular" : "regular", segments,
           modulus / stiffness, ratio);
    pdyn_free(sim);
}

void stretch(pdyn_context *context, const char *directory, int count, char **segments) {
    printf("| constraint | mesh | segments | modulus / Y | Poisson's ratio "
           "|\n|---|---|---|---|---|\n");
    for (int k = 0; k < 4 * count; k++)
        stretch_one(context, directory, atoi(segments[k / 4]), k / 2 % 2 ? "triangle" : "spring",
                    k % 2);
}
