/* Stability and error over ratios: water falls 2 cm into a sheet pinned along its edges, for light
 * and heavy sheets, soft and stiff fluids, short and long steps. The kinetic energy is given over
 * the work of gravity so far: a value above 1 means created energy. */
#include "coupling.h"

#include <math.h>

static const char scene[] =
    "{'duration': 1000, 'time_step': {'integrator': 'euler', 'fixed': %g}, 'contact': "
    "{'thickness': 0.002}, 'bodies': ["
    "{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': [-0.06, -0.06, "
    "-0.06], 'maximum': [0.06, 0.02, 0.06]}}]}, 'constraints': [{'type': 'fluid', 'stiffness': "
    "%g}]}, {'name': 'sheet', 'surface': {'grid': {'size': [0.3, 0.3], 'vertices': [16, 16], "
    "'sag': 0.1}, 'area_density': %g}, 'constraints': [{'type': 'triangle', "
    "'stretching_stiffness': 5e3}, {'type': 'bending', 'bending_rigidity': 1e-4}, {'type': 'pin', "
    "'vertices': {'border': true}}]}]}";

struct result {
    double energy, density, residual; /* largest; of the last half, mean; geometric mean */
    bool diverged;
};

static struct result run(pdyn_context *context, double h, double stiffness, double mass,
                         double seconds) {
    struct result r = {0};
    pdyn_sim *sim = load(context, scene, h, stiffness, mass);
    pdyn_step_info info;
    double start = NAN, later = 0.0, steps = 0.0;
    while (pdyn_time(sim) < seconds - 1e-9 && !r.diverged) {
        if (pdyn_step(sim, &info) != PDYN_OK) r.diverged = true;
        if (r.diverged) break;
        if (isnan(start)) start = info.potential_energy + info.kinetic_energy;
        double done = start - info.potential_energy;
        if (done > 0.0) r.energy = fmax(r.energy, info.kinetic_energy / done);
        r.residual += log(info.step_residual), steps++;
        if (pdyn_time(sim) < 0.5 * seconds) continue;
        r.density += info.density_error_mean, later++;
    }
    r.density /= later, r.residual = exp(r.residual / steps);
    pdyn_free(sim);
    return r;
}

void ratios(pdyn_context *context, const char *directory, double seconds) {
    static const double steps[] = {0.0005, 0.005, 0.02}, masses[] = {0.01, 0.3, 10};
    static const double weights[] = {1e3, 1e5, 1e8};
    FILE *csv = open_csv(directory, "ratios");
    fprintf(csv, "h,area_density,stiffness,diverged,energy,density_error,residual\n");
    printf(
        "| kg/m^2 | w, N/m | h, ms | stable | kinetic energy over gravity's work | density error, "
        "mean | step residual |\n|---|---|---|---|---|---|---|\n");
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int c = 2; c >= 0; c--) {
                struct result r = run(context, steps[c], weights[b], masses[a], seconds);
                printf("| %g | %.0e | %g | %s | %.2f | %.2g %% | %.2g |\n", masses[a], weights[b],
                       1e3 * steps[c], r.diverged ? "no" : "yes", r.energy, 100.0 * r.density,
                       r.residual);
                fprintf(csv, "%g,%g,%g,%d,%g,%g,%g\n", steps[c], masses[a], weights[b], r.diverged,
                        r.energy, r.density, r.residual);
                fflush(stdout);
            }
    fclose(csv);
}
