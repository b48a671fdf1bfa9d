/* Speed and error of the fluid alone: a cube of water of 1 m collapses in a closed box.
 *
 *     fluid CELLS THREADS SETTING SECONDS
 *
 * Prints one row of CSV (without arguments: the header). CELLS^3 particles. The step is 2.5 ms at
 * 29 cells and proportional to the spacing: the displacement per step over the particle size stays
 * the same. So is the stiffness: the density error at rest stays the same. Times are means over all
 * steps; errors are means over the steps of the particles' mean and largest error. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct setting {
    const char *name, *time_step, *solver;
    double stiffness; /* N/m, for 29 cells */
} settings[] = {
    {"fast", "fixed", "\"outer_iterations\": 1, \"linear_iterations\": 8, \"linear_tolerance\": 0",
     4e5},
    {"fast_solved", "fixed", "\"tolerance\": 0.003, \"outer_iterations\": 100", 4e5},
    {"accurate", "fixed",
     "\"outer_iterations\": 2, \"linear_iterations\": 13, \"linear_tolerance\": 0", 1.6e6},
    {"accurate_solved", "fixed", "\"tolerance\": 0.003, \"outer_iterations\": 100", 1.6e6},
    {"cfl", "maximum", "\"outer_iterations\": 1, \"linear_iterations\": 4, \"linear_tolerance\": 0",
     8e4},
    {"cfl_solved", "maximum", "\"tolerance\": 0.003, \"outer_iterations\": 100", 8e4},
};

struct totals {
    double steps, mean, max, residual, worst_residual, outer, linear, ms[3];
};

static pdyn_sim *load(pdyn_context *context, const struct setting *s, int cells, double seconds) {
    double d = 1.0 / (cells + 1), scale = 30.0 * d;
    double step = (strcmp(s->time_step, "fixed") ? 5e-3 : 2.5e-3) * scale;
    return load_text(context,
                     "{'duration': %g, 'frame_interval': %g, 'time_step': {'integrator': "
                     "'euler', '%s': %.17g}, "
                     "'solver': {%s}, 'bodies': [{'name': 'water', 'particles': {'radius': "
                     "%.17g, 'fill': [{'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, "
                     "%.17g]}}]}, 'constraints': [{'type': 'fluid', 'stiffness': %g, "
                     "'viscosity': 0.01}]}], 'solids': [{'box': {'minimum': [0, 0, 0], "
                     "'maximum': [4, 3, 1.5]}}]}",
                     seconds, seconds, s->time_step, step, s->solver, 0.5 * d, cells * d, cells * d,
                     cells * d, s->stiffness * scale);
}

static void add(struct totals *t, const pdyn_step_info *info) {
    t->steps++;
    t->mean += info->density_error_mean, t->max += info->density_error_max;
    t->residual += info->step_residual;
    t->worst_residual = fmax(t->worst_residual, info->step_residual);
    t->outer += info->outer_iterations, t->linear += info->linear_iterations;
    t->ms[0] += info->ms_neighbours, t->ms[1] += info->ms_local, t->ms[2] += info->ms_global;
}

static double front(const pdyn_sim *sim) {
    pdyn_state s = pdyn_get_state(sim);
    double far = 0.0;
    for (int i = 0; i < s.particles; i++) far = fmax(far, s.x[3 * i]);
    return far;
}

static const struct setting *find(const char *name) {
    for (size_t k = 0; k < sizeof settings / sizeof *settings; k++)
        if (!strcmp(settings[k].name, name)) return &settings[k];
    return NULL;
}

static void run(int cells, int threads, const struct setting *s, double seconds) {
    pdyn_context *context = make_context(threads);
    pdyn_sim *sim = load(context, s, cells, seconds);
    pdyn_step_info info = {0};
    struct totals t = {0};
    while (pdyn_time(sim) < pdyn_duration(sim) - 1e-12) {
        info = take_step(sim);
        add(&t, &info);
    }
    double ms = (t.ms[0] + t.ms[1] + t.ms[2]) / t.steps, n = pdyn_get_state(sim).particles;
    printf("%s,%.0f,%d,%.0f,%.4g,%.2f,%.2f,%.2f,%.2f,%.3f,%.2f,%.2f,%.5f,%.4f,%.3f,%.3f,%.2f,%.4f,"
           "%.0f\n",
           s->name, n, pdyn_thread_count(context), t.steps, 1e3 * pdyn_time(sim) / t.steps, ms,
           t.ms[0] / t.steps, t.ms[1] / t.steps, t.ms[2] / t.steps, 1e3 * ms / n, t.outer / t.steps,
           t.linear / t.steps, 1e2 * t.mean / t.steps, 1e2 * t.max / t.steps, t.residual / t.steps,
           t.worst_residual, info.kinetic_energy, front(sim), (double)pdyn_peak_bytes(context) / n);
    pdyn_free(sim);
    pdyn_destroy(context);
}

int main(int argc, char **argv) {
    if (argc == 1) {
        puts("setting,particles,threads,steps,h_ms,step_ms,neighbours_ms,local_ms,global_ms,"
             "us_per_particle,outer,linear,error_mean_percent,error_max_percent,residual,"
             "residual_worst,kinetic_J,front_m,bytes_per_particle");
        return 0;
    }
    const struct setting *s = argc == 5 ? find(argv[3]) : NULL;
    if (!s) die("expected CELLS THREADS SETTING SECONDS, see bench/fluid.c");
    run(atoi(argv[1]), atoi(argv[2]), s, atof(argv[4]));
    return 0;
}
