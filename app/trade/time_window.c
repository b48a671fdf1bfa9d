/* Finds the first seconds of a scene that a run reaches within a budget of processor time. */
#include "time_window.h"
#include "calibration.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MIN_FRAMES = 6, SHORT_FRAMES = 10 }; /* frames of a window, see set_window() */

/* The window holds whole frame intervals of the scene. If fewer than MIN_FRAMES fit, it has at
 * least SHORT_FRAMES shorter ones, which divide that of the scene: a fixed step that divides them
 * divides it, too. */
static void set_window(struct time_window *window, const pdyn_sim *sim, double length) {
    double interval = pdyn_frame_interval(sim), frames = floor(length / interval * (1.0 + 1e-9));
    window->scene_duration = pdyn_duration(sim), window->scene_interval = interval;
    window->whole = length >= window->scene_duration * (1.0 - 1e-9);
    if (frames < MIN_FRAMES) {
        interval /= ceil(SHORT_FRAMES * interval / length * (1.0 - 1e-9));
        frames = floor(length / interval * (1.0 + 1e-9));
    }
    window->frame_interval = interval;
    window->length = window->whole ? fmax(length, frames * interval) : frames * interval;
    snprintf(window->sets[0], sizeof window->sets[0], "duration=%.12g", window->length);
    snprintf(window->sets[1], sizeof window->sets[1], "frame_interval=%.12g", interval);
    snprintf(window->solver, sizeof window->solver, "%s", pdyn_solver_type(sim));
}

/* Simulated time, s, that a run of the scene reaches within the budget of processor time. */
static int reachable_length(const struct jobs *jobs, const struct scene_options *scene,
                            double run_budget_s, double *length) {
    struct job job = {.limit_s = run_budget_s};
    struct metrics_csv steps;
    bool good = job_add_overrides(&job, scene->set, scene->sets);
    int code = good ? calibration_run(jobs, &job, &steps) : report_no_memory();
    free(job.set);
    if (code != EXIT_GOOD) return code;
    *length = simulated_seconds(&steps);
    metrics_csv_free(&steps);
    return EXIT_GOOD;
}

int time_window_find(const struct jobs *jobs, const struct scene_options *scene, double length,
                     double run_budget_s, struct time_window *window) {
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    int code = scene_load(scene, &context, &sim);
    if (code == EXIT_GOOD && length == 0.0)
        code = reachable_length(jobs, scene, run_budget_s, &length);
    if (code == EXIT_GOOD) set_window(window, sim, fmin(length, pdyn_duration(sim)));
    pdyn_free(sim);
    pdyn_destroy(context);
    return code;
}
