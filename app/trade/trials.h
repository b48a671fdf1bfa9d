/* Trials: settings that `projdyn trade` has run, with their processor time and their errors
 * against the reference run. */
#ifndef TRIALS_H
#define TRIALS_H

#include "run_metrics.h"
#include "setting.h"

enum { TRIAL_MAX_ERROR = RUN_METRICS_COUNT }; /* index of the largest of the errors */

struct trial {
    const struct setting *setting;
    bool good;       /* the run succeeded; otherwise all numbers below are undefined */
    bool pareto;     /* on the Pareto front: no other trial is both faster and more accurate */
    bool remeasured; /* its time was measured a second time */
    double ms;       /* processor time, ms per frame */
    double error[RUN_METRICS_COUNT + 1]; /* by enum run_metric, then their maximum */
    double residual;                     /* mean step residual */
};

struct trial_table {
    int count;
    struct trial *trial;   /* count */
    int metric;            /* index into error[] that the Pareto front is built on */
    const char *reference; /* name of the reference's setting */
    double reference_error[RUN_METRICS_COUNT + 1]; /* estimate of the reference's own error */
    double frames_per_second;                      /* frames per simulated second */
};

/* Whether the trial succeeded with an error below 100 %; a larger error means that its motion
 * has nothing in common with the reference. */
static inline bool trial_is_usable(const struct trial *trial, int metric) {
    return trial->good && trial->error[metric] < 1.0;
}

#endif
