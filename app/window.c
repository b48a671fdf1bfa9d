#include "window.h"
#include "alone.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LEAST = 6, SOUGHT = 10 }; /* frames of a window */

/* Whole frames of the scene, or, where they are few, ten of its own. */
static void set_window(struct window *window, const pdyn_sim *sim, double length) {
    double interval = pdyn_frame_interval(sim), frames = floor(length / interval * (1.0 + 1e-9));
    window->duration = pdyn_duration(sim), window->own_interval = interval;
    window->whole = length >= window->duration * (1.0 - 1e-9);
    if (frames < LEAST) interval = length / SOUGHT, frames = SOUGHT;
    window->interval = interval;
    window->length = window->whole ? fmax(length, frames * interval) : frames * interval;
    snprintf(window->sets[0], sizeof window->sets[0], "duration=%.12g", window->length);
    snprintf(window->sets[1], sizeof window->sets[1], "frame_interval=%.12g", interval);
    snprintf(window->solver, sizeof window->solver, "%s", pdyn_solver_type(sim));
}

/* How far it comes, s. */
static int run_until(const struct farm *farm, const struct scene_options *scene, double share,
                     double *reached) {
    struct farm_run run = {.limit_s = share};
    struct metrics steps;
    bool good = farm_add(&run, scene->set, scene->sets);
    int code = good ? alone_run(farm, &run, &steps) : report_no_memory();
    free(run.set);
    if (code != EXIT_GOOD) return code;
    *reached = alone_end(&steps);
    metrics_free(&steps);
    return EXIT_GOOD;
}

int window_find(const struct farm *farm, const struct scene_options *scene, double length,
                double share, struct window *window) {
    struct scene_options one = *scene;
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    one.threads = 1, one.silent = true;
    int code = scene_load(&one, &context, &sim);
    if (code == EXIT_GOOD && length == 0.0) code = run_until(farm, scene, share, &length);
    if (code == EXIT_GOOD) set_window(window, sim, fmin(length, pdyn_duration(sim)));
    pdyn_free(sim);
    pdyn_destroy(context);
    return code;
}
