#include "extent.h"
#include "scene_json.h"
#include "twin.h"

#include <math.h>
#include <stdio.h>

/* The overrides of the user, and those of a twin that is so much coarser; none for 1. */
static int begin_runs(struct extent *e, double coarser) {
    json_t *text = NULL;
    bool good = true;
    int code = coarser == 1.0 ? EXIT_GOOD : scene_text(e->user, &text);
    setting_free(&e->twin);
    scene_options_free(&e->runs);
    e->coarser = coarser;
    e->runs = (struct scene_options){.scene = e->user->scene, .threads = 1, .silent = true};
    if (text) twin_make(text, coarser, &e->twin);
    for (int k = 0; k < e->user->sets; k++) good &= scene_set(&e->runs, e->user->set[k]);
    for (int k = 0; k < e->user->plugins; k++) good &= scene_plugin(&e->runs, e->user->plugin[k]);
    for (int k = 0; k < e->twin.sets; k++) good &= scene_set(&e->runs, e->twin.set[k]);
    json_decref(text);
    return code != EXIT_GOOD || (good && !e->twin.failed) ? code : report_no_memory();
}

/* Some things are too small to be made coarser. */
static bool can_run(const struct scene_options *scene) {
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    bool good = scene_context(scene, &context) == EXIT_GOOD &&
                pdyn_load(context, scene->scene, scene->set, scene->sets, &sim) == PDYN_OK;
    pdyn_free(sim);
    pdyn_destroy(context);
    return good;
}

/* The least coarse of those that can be run to the end, or that which is three times as coarse. */
static int find_twin(struct extent *e, const struct farm *farm, double share) {
    static const double most = 3.0, cost = 3.5; /* time ~ coarser^-cost, seen in fluids */
    const struct window alone = e->window;
    double coarser = ceil(4.0 * pow(alone.duration / alone.length, 1.0 / cost)) / 4.0;
    for (coarser = fmin(coarser, most);; coarser = fmin(coarser + 0.5, most)) {
        int code = begin_runs(e, coarser);
        if (code != EXIT_GOOD) return code;
        if (!e->twin.sets || !can_run(&e->runs)) {
            e->window = alone;
            return begin_runs(e, 1.0);
        }
        code = window_find(farm, &e->runs, 0.0, share, &e->window);
        if (code != EXIT_GOOD || e->window.whole || coarser == most) return code;
    }
}

int extent_find(struct extent *e, const struct farm *farm, double length, double share) {
    bool open = e->coarser == 0.0 && length == 0.0;
    int code = begin_runs(e, e->coarser == 0.0 ? 1.0 : e->coarser);
    if (code == EXIT_GOOD && e->coarser != 1.0 && !e->twin.sets) {
        fprintf(stderr, "projdyn: trade: --twin: nothing in the scene can be made coarser\n");
        return EXIT_BAD_INPUT;
    }
    if (code == EXIT_GOOD) code = window_find(farm, &e->runs, length, share, &e->window);
    return code == EXIT_GOOD && open && !e->window.whole ? find_twin(e, farm, share) : code;
}

void extent_tell(const struct extent *e) {
    const struct window *w = &e->window;
    printf("%s: %s of %s, %g s with a frame every %g s\n", e->user->scene,
           w->whole ? "all" : "the beginning",
           e->twin.sets ? "a coarser twin of the scene" : "the scene", w->length, w->interval);
    for (int k = 0; k < e->twin.sets; k++) printf("  --set %s\n", e->twin.set[k]);
    if (!w->whole || e->twin.sets)
        printf(
            "(--twin %g --window %g takes the same again; --minutes says how long all may take)\n",
            e->coarser, w->length);
    fflush(stdout);
}

void extent_free(struct extent *e) {
    setting_free(&e->twin);
    scene_options_free(&e->runs);
}
