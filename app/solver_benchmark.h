/* Times the same steps of a scene with several solvers, alternating in one process. */
#ifndef SOLVER_BENCHMARK_H
#define SOLVER_BENCHMARK_H

#include "scene_options.h"

struct step_cost {
    double ms, outer, linear; /* time, outer and linear iterations */
};

/* Measurements of one solver. Times are minima over all rounds, in ms (clock:
 * solver_benchmark.c). */
struct solver_timing {
    const char *solver;     /* name, as in solver.type */
    char chosen[64];        /* name of the solver itself, where that is "auto" */
    double load_ms;         /* loading the scene */
    struct step_cost *step; /* steps: each time step */
    double residual;        /* step residual, summed over the steps */
    long unsolved;          /* number of unsolved steps, of the body that has most */
    char integrator[16];    /* integrator of the scene */
    double bytes;           /* memory allocated after the last step */
    int particles;
    double *x;   /* particles x 3: positions after the last step, m */
    double size; /* diagonal of the bounding box of all particles at the start, m */
};

struct solver_benchmark {
    struct scene_options scene;
    int steps, rounds;
    int solvers;
    struct solver_timing *solver; /* solvers */
};

/* Runs all rounds; odd rounds run the solvers in reverse order. Returns an exit code. */
int benchmark_run(struct solver_benchmark *benchmark);
void benchmark_free(struct solver_benchmark *benchmark);

/* Mean time of a step, ms, over all steps but the first two. */
double benchmark_step_ms(const struct solver_benchmark *benchmark,
                         const struct solver_timing *timing);
/* Preparation, ms: loading the scene, and the time of the first two steps beyond that of the mean
 * step with as many iterations. */
double benchmark_prepare_ms(const struct solver_benchmark *benchmark,
                            const struct solver_timing *timing);

/* Outer and linear iterations of a step, mean over all steps. */
struct step_cost benchmark_iterations(const struct solver_benchmark *benchmark,
                                      const struct solver_timing *timing);

/* Root mean square distance of the final positions of a and b, relative to a->size. */
double benchmark_difference(const struct solver_timing *a, const struct solver_timing *b);

/* Break-even: number of steps after which the total time of a, preparation included, is at most
 * that of b. 0: from the start; INFINITY: never. Beyond the measured steps, mean step times
 * extrapolate. */
double benchmark_break_even(const struct solver_benchmark *benchmark, const struct solver_timing *a,
                            const struct solver_timing *b);

#endif
