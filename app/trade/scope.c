/* Chooses replica and time window of a scene so that a run fits a budget of processor time. */
#include "scope.h"
#include "replica.h"
#include "scene_json.h"

#include <math.h>
#include <stdio.h>

/* Sets scope->runs and scope->replica for a coarsening factor; no replica for 1. */
static int set_coarsening(struct scope *s, double coarsening) {
    json_t *scene = NULL;
    int code = coarsening == 1.0 ? EXIT_GOOD : scene_json(s->user, &scene);
    setting_free(&s->replica);
    scene_options_free(&s->runs);
    s->coarsening = coarsening;
    if (scene) replica_make(scene, coarsening, &s->replica);
    bool good = setting_scene(&s->replica, s->user, &s->runs);
    json_decref(scene);
    return code != EXIT_GOOD || (good && !s->replica.failed) ? code : report_no_memory();
}

/* Whether the scene loads. A replica may not: a box can be too small for coarser particles. */
static bool is_loadable(const struct scene_options *scene) {
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    bool good = scene_context(scene, &context) == EXIT_GOOD &&
                pdyn_load(context, scene->scene, scene->set, scene->sets, &sim) == PDYN_OK;
    pdyn_free(sim);
    pdyn_destroy(context);
    return good;
}

/* Finds the finest replica that runs to its end within the budget, with a factor of at most 3;
 * if even that one does not, its time window is shortened. The first factor follows from the
 * window of the scene and REPLICA_COST_EXPONENT. Without a loadable replica the scene with its
 * shortened window stays. */
static int find_replica(struct scope *s, const struct jobs *jobs, double run_budget_s) {
    static const double max_coarsening = 3.0;
    const struct time_window scene = s->window;
    double slowdown = scene.scene_duration / scene.length;
    double coarsening = ceil(4.0 * pow(slowdown, 1.0 / REPLICA_COST_EXPONENT)) / 4.0;
    for (coarsening = fmin(coarsening, max_coarsening);;
         coarsening = fmin(coarsening + 0.5, max_coarsening)) {
        int code = set_coarsening(s, coarsening);
        if (code != EXIT_GOOD) return code;
        if (!s->replica.sets || !is_loadable(&s->runs)) {
            s->window = scene;
            return set_coarsening(s, 1.0);
        }
        code = time_window_find(jobs, &s->runs, 0.0, run_budget_s, &s->window);
        if (code != EXIT_GOOD || s->window.whole || coarsening == max_coarsening) return code;
    }
}

int scope_find(struct scope *s, const struct jobs *jobs, double length, double run_budget_s) {
    bool automatic = s->coarsening == 0.0 && length == 0.0;
    int code = set_coarsening(s, s->coarsening == 0.0 ? 1.0 : s->coarsening);
    if (code == EXIT_GOOD && s->coarsening != 1.0 && !s->replica.sets) {
        fprintf(stderr, "projdyn: trade: --twin: nothing in the scene can be made coarser\n");
        return EXIT_BAD_INPUT;
    }
    s->runs.silent = false; /* says once what loading the scene says */
    if (code == EXIT_GOOD)
        code = time_window_find(jobs, &s->runs, length, run_budget_s, &s->window);
    return code == EXIT_GOOD && automatic && !s->window.whole ? find_replica(s, jobs, run_budget_s)
                                                              : code;
}

void scope_print(const struct scope *s) {
    const struct time_window *w = &s->window;
    printf("%s: %s %s, %g s with a frame every %g s\n", s->user->scene,
           w->whole ? "whole" : "beginning of the",
           s->replica.sets ? "coarse replica of the scene" : "scene", w->length, w->frame_interval);
    for (int k = 0; k < s->replica.sets; k++)
        printf("  --set %s\n", shell_word(s->replica.set[k]).text);
    if (!w->whole || s->replica.sets)
        printf(
            "(to simulate the same again: --twin %g --window %g; more --minutes simulate more)\n",
            s->coarsening, w->length);
    fflush(stdout);
}

void scope_free(struct scope *s) {
    setting_free(&s->replica);
    scene_options_free(&s->runs);
}
