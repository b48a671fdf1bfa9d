/* Measurements of `projdyn compare`: the same steps with several solvers in alternation. */
#include "solver_benchmark.h"
#include "projdyn/box.h"
#include "projdyn/vec3.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Processor time with one thread, because other programs on the machine disturb it less than
 * wall time; wall time with several threads. */
static double clock_ms(const struct solver_benchmark *benchmark) {
    return 1e3 * (benchmark->scene.threads == 1 ? processor_seconds() : wall_seconds());
}

/* Bytes that malloc has handed out in the whole process, libraries included. */
static double allocated_bytes(void) {
    struct mallinfo2 info = mallinfo2();
    return (double)info.uordblks + (double)info.hblkhd;
}

/* Stores final positions, memory, solver and integrator. All rounds give the same positions, so the
 * last round overwrites the others. false if memory ran out. */
static bool store_result(struct solver_timing *timing, const pdyn_sim *sim, double bytes) {
    pdyn_state state = pdyn_get_state(sim);
    size_t size = 3 * (size_t)state.particles * sizeof(double);
    if (!timing->x) timing->x = malloc(size + 1);
    if (!timing->x) return false;
    memcpy(timing->x, state.x, size);
    timing->particles = state.particles, timing->bytes = bytes;
    snprintf(timing->chosen, sizeof timing->chosen, "%s", pdyn_solver_type(sim));
    snprintf(timing->integrator, sizeof timing->integrator, "%s", pdyn_integrator(sim));
    return true;
}

/* Unsolved steps of the body that has most. */
static long count_unsolved(const pdyn_sim *sim) {
    long most = 0;
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++)
        if (!strcmp(w.code, "unsolved") && w.count > most) most = w.count;
    return most;
}

/* Runs the steps; lowers each step time to the minimum over the rounds and sums the iterations. */
static int run_steps(const struct solver_benchmark *benchmark, struct solver_timing *timing,
                     pdyn_context *context, pdyn_sim *sim) {
    timing->residual = 0.0;
    pdyn_state state = pdyn_get_state(sim);
    struct box box = box_around(state.x, state.particles);
    timing->size = vec3_distance(box.min, box.max);
    for (int k = 0; k < benchmark->steps; k++) {
        pdyn_step_info info;
        struct step_cost *step = &timing->step[k];
        double start = clock_ms(benchmark);
        pdyn_status status = pdyn_step(sim, &info);
        step->ms = fmin(step->ms, clock_ms(benchmark) - start);
        if (status != PDYN_OK) return report_status(context, status);
        step->outer = info.outer_iterations, step->linear = info.linear_iterations;
        timing->residual += info.step_residual;
    }
    timing->unsolved = count_unsolved(sim);
    return EXIT_GOOD;
}

/* One round of one solver: loads the scene, runs the steps. Warnings about the scene are printed in
 * the first round; print_unsolved of compare.c says what became of the steps. */
static int run_round(const struct solver_benchmark *benchmark, struct solver_timing *timing,
                     bool first) {
    char solver[64];
    struct scene_options scene = benchmark->scene;
    const char **set = calloc((size_t)scene.sets + 1, sizeof *set);
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    if (!set) return report_no_memory();
    if (scene.sets) memcpy(set, scene.set, (size_t)scene.sets * sizeof *set);
    snprintf(solver, sizeof solver, "solver.type=%.40s", timing->solver);
    set[scene.sets++] = solver, scene.set = set, scene.silent = !first;
    double before = allocated_bytes(), start = clock_ms(benchmark);
    int code = scene_load(&scene, &context, &sim);
    timing->load_ms = fmin(timing->load_ms, clock_ms(benchmark) - start);
    scene.silent = true;
    if (code == EXIT_GOOD) code = run_steps(benchmark, timing, context, sim);
    if (code == EXIT_GOOD && !store_result(timing, sim, allocated_bytes() - before))
        code = report_no_memory();
    pdyn_free(sim);
    pdyn_destroy(context);
    free(set);
    return code;
}

int benchmark_run(struct solver_benchmark *benchmark) {
    int code = EXIT_GOOD, n = benchmark->solvers;
    for (int k = 0; k < n; k++) {
        struct solver_timing *timing = &benchmark->solver[k];
        timing->load_ms = INFINITY;
        timing->step = malloc((size_t)benchmark->steps * sizeof *timing->step);
        if (!timing->step) return report_no_memory();
        for (int s = 0; s < benchmark->steps; s++) timing->step[s].ms = INFINITY;
    }
    for (int r = 0; r < benchmark->rounds; r++)
        for (int k = 0; k < n && code == EXIT_GOOD; k++)
            code = run_round(benchmark, &benchmark->solver[r % 2 ? n - 1 - k : k], r == 0);
    return code;
}

void benchmark_free(struct solver_benchmark *benchmark) {
    for (int k = 0; k < benchmark->solvers; k++) {
        free(benchmark->solver[k].step);
        free(benchmark->solver[k].x);
    }
    free(benchmark->solver);
}

/* ---- evaluation ------------------------------------------------------------------------------ */

/* Steps that prepare: BDF2 has another matrix than the implicit Euler step before it. */
static int preparing_steps(const struct solver_benchmark *benchmark) {
    return benchmark->steps > 2 ? 2 : benchmark->steps - 1;
}

/* The mean of the steps from `first` on. */
static struct step_cost mean_from(const struct solver_benchmark *benchmark,
                                  const struct solver_timing *timing, int first) {
    struct step_cost mean = {0.0, 0.0, 0.0};
    double n = benchmark->steps - first;
    for (int k = first; k < benchmark->steps; k++) {
        const struct step_cost *step = &timing->step[k];
        mean.ms += step->ms, mean.outer += step->outer, mean.linear += step->linear;
    }
    mean.ms /= n, mean.outer /= n, mean.linear /= n;
    return mean;
}

struct step_cost benchmark_iterations(const struct solver_benchmark *benchmark,
                                      const struct solver_timing *timing) {
    return mean_from(benchmark, timing, 0);
}

double benchmark_step_ms(const struct solver_benchmark *benchmark,
                         const struct solver_timing *timing) {
    return mean_from(benchmark, timing, preparing_steps(benchmark)).ms;
}

static double ratio(double a, double b) { return b > 0.0 ? a / b : 1.0; }

double benchmark_prepare_ms(const struct solver_benchmark *benchmark,
                            const struct solver_timing *timing) {
    int preparing = preparing_steps(benchmark);
    double sum = timing->load_ms;
    const struct step_cost mean = mean_from(benchmark, timing, preparing);
    for (int k = 0; k < preparing; k++) {
        const struct step_cost *step = &timing->step[k];
        double work = fmax(ratio(step->outer, mean.outer), ratio(step->linear, mean.linear));
        sum += fmax(0.0, step->ms - work * mean.ms);
    }
    return sum;
}

double benchmark_difference(const struct solver_timing *a, const struct solver_timing *b) {
    double sum = 0.0;
    for (int k = 0; k < 3 * a->particles; k++) sum += (a->x[k] - b->x[k]) * (a->x[k] - b->x[k]);
    return sqrt(sum / fmax(1.0, a->particles)) / a->size;
}

double benchmark_break_even(const struct solver_benchmark *benchmark, const struct solver_timing *a,
                            const struct solver_timing *b) {
    double lag_ms = a->load_ms - b->load_ms; /* total time of a minus that of b */
    int last = 0;
    for (int k = 0; k < benchmark->steps; k++) {
        lag_ms += a->step[k].ms - b->step[k].ms;
        if (lag_ms > 0.0) last = k + 1;
    }
    double gain = benchmark_step_ms(benchmark, b) - benchmark_step_ms(benchmark, a);
    if (lag_ms <= 0.0) return last;
    return gain > 0.0 ? benchmark->steps + ceil(lag_ms / gain) : INFINITY;
}
