/* Water at rest in a sheet pinned along its four edges. The pins' reaction, from the gradient at
 * the pinned points, has to equal the weight of both, and the water's surface has to be level. */
#include "coupling.h"

#include <math.h>
#include <stdlib.h>

static const double side = 0.4, area_density = 0.3; /* m, kg/m^2 */

static const char scene[] =
    "{'duration': 1000, 'frame_interval': 0.1, 'time_step': {'integrator': 'euler', 'maximum': "
    "%.17g}, 'solver': {"
    "'tolerance': 0.02, 'outer_iterations': 60}, 'contact': {'thickness': 0.002}, 'bodies': ["
    "{'name': 'water', 'particles': {'radius': %.17g, 'fill': [{'box': {'minimum': [-0.08, -0.08,"
    " -0.08], 'maximum': [0.08, -0.02, 0.08]}}]}, 'constraints': [{'type': 'fluid', 'stiffness': "
    "%.17g}]}, {'name': 'sheet', 'surface': {'grid': {'size': [%g, %g], 'vertices': [%d, %d],"
    " 'sag': 0.12}, 'area_density': %g}, 'constraints': [{'type': 'triangle', "
    "'stretching_stiffness': 1e4}, {'type': 'bending', 'bending_rigidity': 1e-4}, {'type': 'pin', "
    "'vertices': {'border': true}}]}]}";

/* Largest difference of the surface's height, m, over wet columns two spacings wide; the height of
 * a column is that of its highest particle. */
static double unevenness(const pdyn_sim *sim) {
    enum { CELLS = 64 };
    static double top[CELLS][CELLS];
    static int count[CELLS][CELLS];
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info water = pdyn_get_body(sim, 0);
    double cell = 4.0 * water.radius, low = INFINITY, high = -INFINITY;
    int cells = (int)floor(side / cell);
    for (int a = 0; a < cells; a++)
        for (int b = 0; b < cells; b++) top[a][b] = -INFINITY, count[a][b] = 0;
    for (int i = 0; i < water.count; i++) {
        int a = (int)((s.x[3 * i] + 0.5 * side) / cell),
            b = (int)((s.x[3 * i + 2] + 0.5 * side) / cell);
        if (a < 0 || b < 0 || a >= cells || b >= cells) continue;
        top[a][b] = fmax(top[a][b], s.x[3 * i + 1]), count[a][b]++;
    }
    for (int a = 0; a < cells; a++)
        for (int b = 0; b < cells; b++)
            if (count[a][b] >= 8) low = fmin(low, top[a][b]), high = fmax(high, top[a][b]);
    return high - low;
}

static double weight_of(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    double sum = 0.0;
    for (int i = 0; i < s.particles; i++) sum += g * s.mass[i];
    return sum;
}

static void run(pdyn_context *context, FILE *csv, double spacing, int vertices, double h,
                double seconds) {
    double pressure = density * g * 0.08;
    pdyn_sim *sim = load_text(context, scene, h, 0.5 * spacing, 0.45 * pressure * spacing / 1e-3,
                              side, side, vertices, vertices, area_density);
    double weight = weight_of(sim), peak = 0.0, kinetic = 0.0, reaction = 0.0, mean = 0.0,
           worst = 0.0;
    int steps = 0;
    while (pdyn_time(sim) < seconds) {
        pdyn_step_info info = take_step(sim);
        peak = fmax(peak, info.kinetic_energy), kinetic = info.kinetic_energy;
        reaction = fabs(info.pin_reaction[1]) / weight;
        if (info.frame)
            fprintf(csv, "%g,%d,%g,%g,%.9g,%.9g,%.9g\n", spacing, vertices, h, info.time, reaction,
                    kinetic, info.step_residual);
        if (pdyn_time(sim) < 0.5 * seconds) continue;
        mean += reaction, worst = fmax(worst, fabs(reaction - 1.0)), steps++;
    }
    printf("| %g | %d | %d | %g | %.4f | %.3f %% | %.2f | %.1e |\n", 1e3 * spacing,
           pdyn_get_body(sim, 0).count, vertices, 1e3 * h, mean / steps, 100.0 * worst,
           unevenness(sim) / spacing, kinetic / peak);
    fflush(stdout);
    pdyn_free(sim);
}

void basin(pdyn_context *context, const char *directory, double seconds, int count,
           char **spacings) {
    FILE *csv = open_csv(directory, "basin");
    fprintf(csv, "spacing,vertices,h,time,reaction_over_weight,kinetic,residual\n");
    printf("| spacing, mm | particles | vertices a side | h, ms | pins over weight | worst in the "
           "last half | "
           "unevenness, spacings | kinetic energy over its peak "
           "|\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < count; k++) {
        double spacing = 1e-3 * atof(spacings[k]);
        run(context, csv, spacing, 1 + (int)(side / spacing), 0.01, seconds);
    }
    fclose(csv);
}
