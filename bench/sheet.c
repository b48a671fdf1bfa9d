/* Convergence under refinement: the lowest point of a sheet hung by two corners. */
#include "strip.h"
#include "validation.h"

#include <math.h>
#include <stdlib.h>

/* m per step: below this displacement the sheet counts as at rest */
static const double still = 2e-5;

/* Vertices per side. Finer irregular meshes have wrinkles of the size of triangles, which take
 * hundreds of iterations per step. */
enum { MOST_IRREGULAR = 65 };

/* Height of the lowest point, m. */
static double lowest(pdyn_context *context, const char *directory, int vertices, bool irregular) {
    char constraints[512];
    snprintf(
        constraints, sizeof constraints,
        "{\"type\": \"triangle\", \"stretching_stiffness\": 1000}, {\"type\": \"bending\", "
        "\"bending_rigidity\": 1e-3}, {\"type\": \"pin\", \"vertices\": {\"vertices\": [0, %d]}}",
        vertices - 1);
    struct strip strip = {.name = "sheet",
                          .along = vertices - 1,
                          .across = vertices - 1,
                          .segment = 1.0 / (vertices - 1),
                          .growth = 1.0,
                          .random = irregular ? 0.2 : 0.0,
                          .area_density = 0.2,
                          .constraints = constraints,
                          .h = 0.3,
                          .gravity = {0.0, -g, 0.0},
                          .tolerance = 1e-5,
                          .solver = "auto"};
    pdyn_sim *sim = strip_load(context, directory, &strip);
    strip_settle(sim, &strip, still / strip.segment);
    const pdyn_state state = pdyn_get_state(sim);
    double low = 0.0;
    for (int i = 0; i < state.particles; i++) low = fmin(low, state.x[3 * i + 1]);
    pdyn_free(sim);
    return low;
}

void sheet(pdyn_context *context, const char *directory, int count, char **vertices) {
    printf("| vertices | regular: lowest, m | irregular |\n|---|---|---|\n");
    for (int k = 0; k < count; k++) {
        int n = atoi(vertices[k]);
        printf("| %d x %d | %.4f |", n, n, lowest(context, directory, n, false));
        if (n <= MOST_IRREGULAR) printf(" %.4f |\n", lowest(context, directory, n, true));
        else printf(" - |\n");
        fflush(stdout);
    }
}
