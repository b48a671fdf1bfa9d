/* Runs one job alone until a limit of processor time, to measure how long steps take. */
#include "calibration.h"
#include "job_result.h"

#include <stdio.h>

double simulated_seconds(const struct metrics_csv *m) {
    int column = metrics_csv_column(m, "time_s");
    return m->rows && column >= 0 ? m->value[(m->rows - 1) * m->columns + column] : 0.0;
}

double cpu_ms_until(const struct metrics_csv *m, double time) {
    int end = metrics_csv_column(m, "time_s"), ms = metrics_csv_column(m, "ms_cpu");
    double sum = 0.0;
    for (long r = 0; r < m->rows && end >= 0 && ms >= 0; r++)
        if (m->value[r * m->columns + end] <= time * (1.0 + 1e-9))
            sum += m->value[r * m->columns + ms];
    return sum;
}

/* Reads the steps of a finished job. A job that was killed at its limit counts as good: its
 * steps up to the limit are valid. */
static int read_steps(const char *path, double limit_s, struct metrics_csv *steps) {
    json_t *result = job_result_read(path);
    bool good = job_result_has_status(result, "good") || job_result_has_status(result, "killed");
    const char *error = json_string_value(json_object_get(result, "error"));
    if (!good)
        fprintf(stderr, "projdyn: trade: a run failed: %s (%s/log.txt)\n", error ? error : "",
                path);
    json_decref(result);
    int code = good ? metrics_csv_read(path, "metrics.csv", steps) : EXIT_FAILED;
    if (code != EXIT_GOOD || simulated_seconds(steps) > 0.0) return code;
    fprintf(stderr,
            "projdyn: trade: %s: one step takes more than %.3g s of processor time; increase "
            "--minutes\n",
            path, limit_s);
    metrics_csv_free(steps);
    return EXIT_FAILED;
}

int calibration_run(const struct jobs *jobs, struct job *job, struct metrics_csv *steps) {
    char path[JOB_PATH];
    struct jobs single = *jobs;
    single.processes = 1, single.job = job, single.count = 1;
    int code = jobs_find_finished(&single);
    if (code == EXIT_GOOD) code = jobs_run(&single);
    if (code == EXIT_GOOD && !job_path(path, &single, job, "")) code = EXIT_FAILED;
    return code == EXIT_GOOD ? read_steps(path, job->limit_s, steps) : code;
}
