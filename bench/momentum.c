/* Conservation: a drop hits an inclined free sheet, without gravity. Linear momentum has to be
 * conserved for any accuracy of the solve, angular momentum up to the loss of implicit Euler: at
 * its exact minimum, a step changes it by h sum m dv x v. */
#include "coupling.h"

#include "projdyn/vec3.h"

#include <math.h>

static const char scene[] =
    "{'duration': 1000, 'gravity': [0, 0, 0], 'time_step': {'integrator': 'euler', 'fixed': "
    "%.17g}, 'solver': {%s},"
    " 'bodies': [{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box':"
    " {'minimum': [-0.05, 0.025, -0.05], 'maximum': [0.05, 0.105, 0.05]},"
    " 'velocity': [0.1, -1, 0.05]}]}, 'constraints': [{'type': 'fluid', 'stiffness': %g,"
    " 'viscosity': %g}]}, {'name': 'sheet', 'surface': {'grid': {'size': [0.3, 0.3], 'vertices':"
    " [21, 21]}, 'rotate': [0, 20, 10], 'area_density': 0.5}, 'constraints': [{'type': 'spring',"
    " 'stretching_stiffness': 1000}, {'type': 'bending', 'bending_rigidity': 0.001}]}]}";

static void linear(pdyn_context *context, FILE *csv, int steps) {
    static const struct {
        const char *name, *solver;
        double stiffness;
    } runs[] = {
        {"newton, 1 x 3 iterations", "'outer_iterations': 1, 'linear_iterations': 3", 1e5},
        {"newton, 1 x 10", "'outer_iterations': 1, 'linear_iterations': 10", 1e5},
        {"newton, 1 x 10, w = 1e7", "'outer_iterations': 1, 'linear_iterations': 10", 1e7},
        {"newton, 3 x 10", "'outer_iterations': 3, 'linear_iterations': 10", 1e5},
        {"newton, solved", "'outer_iterations': 30, 'tolerance': 1e-3", 1e5},
        {"newton, cholesky, 2", "'outer_iterations': 2, 'type': 'cholesky'", 1e5},
        {"projective, 1 x 3", "'outer_iterations': 1, 'linear_iterations': 3, 'step': 'projective'",
         1e5},
        {"projective, 10 x 10",
         "'outer_iterations': 10, 'linear_iterations': 10, 'step': 'projective'", 1e5},
    };
    printf("| solver | step residual, geometric mean | linear momentum |\n|---|---|---|\n");
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        pdyn_sim *sim = load_text(context, scene, 0.004, runs[k].solver, runs[k].stiffness, 0.02);
        struct momenta begin = momenta_of(sim);
        double residual = 0.0;
        for (int n = 0; n < steps; n++) residual += log(take_step(sim).step_residual);
        struct momenta end = momenta_of(sim);
        double drift = vec3_distance(end.linear, begin.linear) / begin.size;
        residual = exp(residual / steps);
        printf("| %s | %.2g | %.1e |\n", runs[k].name, residual, drift);
        fprintf(csv, "%s,%g,%g\n", runs[k].name, residual, drift);
        fflush(stdout);
        pdyn_free(sim);
    }
}

static double angular_drift(pdyn_context *context, double h, double viscosity, double seconds) {
    pdyn_sim *sim = load_text(context, scene, h, "'outer_iterations': 40, 'tolerance': 1e-3", 1e5,
                              viscosity * h / 0.004);
    struct momenta begin = momenta_of(sim);
    while (pdyn_time(sim) < seconds - 0.5 * h) take_step(sim);
    struct momenta end = momenta_of(sim);
    pdyn_free(sim);
    return vec3_distance(end.angular, begin.angular) / begin.moment;
}

static void angular(pdyn_context *context, FILE *csv, double seconds) {
    static const double viscosities[] = {0.0, 0.02, 0.2};
    printf("\n| h, ms | without viscosity | viscosity 0.02 | 0.2 |\n|---|---|---|---|\n");
    for (double h = 0.008; h > 0.0009; h *= 0.5) {
        printf("| %g |", 1e3 * h);
        for (int k = 0; k < 3; k++) {
            double drift = angular_drift(context, h, viscosities[k], seconds);
            printf(" %.2e |", drift);
            fprintf(csv, "%g,%g,%g\n", h, viscosities[k], drift);
            fflush(stdout);
        }
        printf("\n");
    }
}

void momentum(pdyn_context *context, const char *directory, int steps, double seconds) {
    FILE *csv = open_csv(directory, "momentum_linear");
    fprintf(csv, "solver,residual,drift\n");
    linear(context, csv, steps);
    fclose(csv);
    csv = open_csv(directory, "momentum_angular");
    fprintf(csv, "h,viscosity_at_4_ms,drift\n");
    angular(context, csv, seconds);
    fclose(csv);
}
