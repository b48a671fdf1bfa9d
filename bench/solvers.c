/* Which solver for fluid and cloth: water in the middle of a sheet that is pinned along its border.
 * Each solver has a simulation of its own; they take their steps in turn, all of them to the same
 * residual. */
#include "coupling.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

enum { SOLVERS = 3, WARM = 8 }; /* steps before those that are measured */

static const char *const solver[SOLVERS] = {"cg", "hybrid", "cholesky"};

/* 1 m x 1 m, 0.3 kg/m^2; water 0.4 m x 0.4 m, 0.04 m deep, of particles 20 mm apart. */
static const char scene[] =
    "{'duration': 1000, 'frame_interval': 1000, 'time_step': {'fixed': 0.01}, 'solver': {%s,"
    " 'tolerance': 0.1, 'linear_tolerance': 0.1}, 'bodies': [{'name': 'water', 'particles':"
    " {'radius': 0.01, 'fill': [{'box': {'minimum': [-0.2, 0.012, -0.2], 'maximum': [0.2, 0.052,"
    " 0.2]}}]}, 'constraints': [{'type': 'fluid', 'stiffness': 3500, 'projection_tolerance':"
    " 1e-3}]}, {'name': 'sheet', 'surface': {'grid': {'size': [1, 1], 'vertices': [%d, %d]},"
    " 'area_density': 0.3}, 'constraints': [{'type': 'spring', 'stretching_stiffness': %g},"
    " {'type': 'bending', 'bending_rigidity': 1e-4}, {'type': 'pin', 'vertices': {'border':"
    " true}}]}]}";

struct contestant {
    pdyn_sim *sim;
    double ms, linear, outer, residual, bytes;
};

static double bytes_in_use(void) {
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

static pdyn_step_info note(pdyn_context *context, struct contestant *c, int steps) {
    pdyn_step_info info = take_step(context, c->sim);
    c->ms += (info.ms_neighbours + info.ms_local + info.ms_global + info.ms_contact) / steps;
    c->linear += (double)info.linear_iterations / steps;
    c->outer += (double)info.outer_iterations / steps;
    c->residual = info.step_residual > c->residual ? info.step_residual : c->residual;
    return info;
}

static struct contestant enter(pdyn_context *context, const char *name, int n, double stiffness) {
    char settings[128];
    struct contestant c = {0};
    double before = bytes_in_use();
    if (strcmp(name, "cholesky"))
        snprintf(settings, sizeof settings, "'type': '%s', 'outer_iterations': 100", name);
    else
        snprintf(settings, sizeof settings,
                 "'type': '%s', 'step': 'projective', 'outer_iterations': 20", name);
    c.sim = load(context, scene, settings, n, n, stiffness);
    take_step(context, c.sim);
    c.bytes = bytes_in_use() - before;
    return c;
}

static void compare(pdyn_context *context, FILE *csv, int n, double stiffness, int steps,
                    int count) {
    struct contestant c[SOLVERS];
    for (int k = 0; k < count; k++) c[k] = enter(context, solver[k], n, stiffness);
    for (int s = 1; s < WARM; s++)
        for (int k = 0; k < count; k++) take_step(context, c[k].sim);
    for (int s = 0; s < steps; s++)
        for (int k = 0; k < count; k++) note(context, &c[k], steps);
    int particles = pdyn_get_body(c[0].sim, 0).count;
    for (int k = 0; k < count; k++) {
        fprintf(csv, "%s,%d,%d,%g,%.3f,%.2f,%.2f,%.3g,%.1f\n", solver[k], n * n, particles,
                stiffness, c[k].ms, c[k].linear, c[k].outer, c[k].residual, 1e-6 * c[k].bytes);
        printf("| %d | %g | %s | %.1f | %.2f | %.1f | %.1f | %.2g | %.0f |\n", n * n, stiffness,
               solver[k], c[k].ms, c[k].ms / c[0].ms, c[k].linear, c[k].outer, c[k].residual,
               1e-6 * c[k].bytes);
        pdyn_free(c[k].sim);
    }
    fflush(stdout);
}

void solvers(pdyn_context *context, const char *directory, int count, char **runs) {
    FILE *csv = open_csv(directory, "solvers");
    fprintf(csv, "solver,vertices,particles,stiffness,ms,linear,outer,residual,megabytes\n");
    puts("| vertices | K, N/m | solver | ms a step | over cg's | linear iterations | outer | "
         "largest residual | MB |\n|---|---|---|---|---|---|---|---|---|");
    for (int k = 0; k < count; k++) {
        int n, steps, contestants;
        double stiffness;
        if (sscanf(runs[k], "%dx%lfx%dx%d", &n, &stiffness, &steps, &contestants) != 4 ||
            contestants < 1 || contestants > SOLVERS)
            die("%s: expected NxKxSTEPSxSOLVERS", runs[k]);
        compare(context, csv, n, stiffness, steps, contestants);
    }
    fclose(csv);
}
