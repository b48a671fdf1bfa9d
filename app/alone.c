#include "alone.h"
#include "result.h"

#include <stdio.h>

double alone_end(const struct metrics *m) {
    int at = metrics_column(m, "time_s");
    return m->rows && at >= 0 ? m->value[(m->rows - 1) * m->columns + at] : 0.0;
}

double alone_spent(const struct metrics *m, double time) {
    int at = metrics_column(m, "time_s"), ms = metrics_column(m, "ms_cpu");
    double sum = 0.0;
    for (long r = 0; r < m->rows && at >= 0 && ms >= 0; r++)
        if (m->value[r * m->columns + at] <= time * (1.0 + 1e-9))
            sum += m->value[r * m->columns + ms];
    return sum;
}

/* A run that came to its limit is good as far as it came. */
static int read_steps(const char *path, double seconds, struct metrics *steps) {
    json_t *result = result_read(path);
    bool good = result_is(result, "good") || result_is(result, "killed");
    const char *error = json_string_value(json_object_get(result, "error"));
    if (!good)
        fprintf(stderr, "projdyn: trade: a run failed: %s (%s/log.txt)\n", error ? error : "",
                path);
    json_decref(result);
    int code = good ? metrics_read(path, steps) : EXIT_FAILED;
    if (code != EXIT_GOOD || alone_end(steps) > 0.0) return code;
    fprintf(stderr, "projdyn: trade: %s: a step takes longer than %.3g s: give it more --minutes\n",
            path, seconds);
    metrics_free(steps);
    return EXIT_FAILED;
}

int alone_run(const struct farm *farm, struct farm_run *run, struct metrics *steps) {
    char path[FARM_PATH];
    struct farm alone = *farm;
    alone.jobs = 1, alone.run = run, alone.count = 1;
    int code = farm_survey(&alone);
    if (code == EXIT_GOOD) code = farm_work(&alone);
    if (code == EXIT_GOOD && !farm_path(path, &alone, run, "")) code = EXIT_FAILED;
    return code == EXIT_GOOD ? read_steps(path, run->limit_s, steps) : code;
}
