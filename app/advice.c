/* Times of a twin are not those of the scene. So what seems to hold the wish is run on the scene
 * itself, as much of it as time allows; what the twin spent until then and after that tells how
 * much the rest will take. */
#include "advice.h"
#include "alone.h"
#include "scene_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Candidates that are run on the scene itself, at most. */
enum { TRIES = 3 };

/* Time ~ coarser^-4: particles, and iterations, for a push travels one spacing with each. */
static const double growth = 4.0;

/* ---- the scene itself ------------------------------------------------------------------------ */

struct cost {
    double ms;     /* for a frame, of all that the study simulated */
    double length; /* s of the scene that were run; 0: its time is not known */
};

/* Of setting k, for so many seconds of processor time. */
static int run_scene(const struct study *s, int k, double seconds, struct metrics *steps) {
    const struct scene_options *user = s->extent.user;
    const struct setting *setting = &s->plan.setting[k];
    struct farm_run run = {.limit_s = seconds};
    char text[64];
    const char *const duration[] = {text};
    snprintf(text, sizeof text, "duration=%.12g", s->extent.window.length);
    bool good = farm_add(&run, user->set, user->sets) && farm_add(&run, duration, 1) &&
                farm_add(&run, (const char *const *)setting->set, setting->sets);
    int code = good ? alone_run(&s->farm, &run, steps) : report_no_memory();
    free(run.set);
    return code;
}

/* What is left has the ratio to the twin that the last half had: an impact is over then. ms of all
 * of it; NAN: that cannot be told. */
static double foresee(const struct metrics *scene, const struct metrics *twin) {
    double end = alone_end(scene), half = alone_spent(scene, end) - alone_spent(scene, 0.5 * end);
    double before = alone_spent(twin, end), twin_half = before - alone_spent(twin, 0.5 * end);
    double left = alone_spent(twin, INFINITY) - before;
    return half > 0.0 && twin_half > 0.0 ? alone_spent(scene, end) + half / twin_half * left : NAN;
}

static int find_cost(const struct study *s, int k, double seconds, struct cost *cost) {
    char path[FARM_PATH];
    struct metrics scene, twin;
    if (!farm_path(path, &s->farm, &s->run[k], "")) return EXIT_FAILED;
    int code = run_scene(s, k, seconds, &scene);
    if (code != EXIT_GOOD) return code;
    code = metrics_read(path, &twin);
    if (code == EXIT_GOOD) {
        double ms = foresee(&scene, &twin);
        if (isfinite(ms)) cost->length = alone_end(&scene);
        cost->ms = ms / (s->extent.window.length * s->trade.per_second);
        metrics_free(&twin);
    }
    metrics_free(&scene);
    return code;
}

/* ---- choosing -------------------------------------------------------------------------------- */

/* The cheapest that holds a wished error, otherwise the most accurate, of what holds the wish. What
 * steps leave that are cut short is another thing on a finer scene, so a twin can only speak of
 * solved ones. NULL: none. ratio: of the scene's time to the twin's where it is not known. */
static const struct tried *pick(const struct study *s, const struct wish *wish,
                                const struct cost *cost, double ratio) {
    const struct trade *trade = &s->trade;
    const struct tried *best = NULL;
    bool cheapest = isfinite(wish->error);
    double least = INFINITY;
    for (int k = 0; k < trade->count; k++) {
        const struct tried *t = &trade->tried[k];
        double ms = cost[k].length > 0.0 ? cost[k].ms : ratio * t->ms, error = t->error[trade->by];
        if (!tried_counts(t, trade->by) || (s->extent.twin.sets && t->setting->cut)) continue;
        if (!(error <= wish->error && ms <= wish->ms && (cheapest ? ms : error) < least)) continue;
        best = t, least = cheapest ? ms : error;
    }
    return best;
}

/* What is picked is run on the scene itself, which tells its time and about those of others; until
 * it is picked with its own time. NULL: nothing holds the wish. */
static int choose(const struct study *s, const struct wish *wish, struct cost *cost, double *ratio,
                  const struct tried **best) {
    bool twin = s->extent.twin.sets > 0;
    int code = EXIT_GOOD;
    for (int tries = 0; code == EXIT_GOOD; tries++) {
        *best = pick(s, wish, cost, tries < TRIES ? *ratio : INFINITY);
        if (!*best || !twin) return code;
        int k = (int)(*best - s->trade.tried);
        if (cost[k].length > 0.0) return code;
        code = find_cost(s, k, 8.0 * s->share / s->farm.jobs, &cost[k]);
        if (cost[k].length == 0.0) return code;
        *ratio = cost[k].ms / (*best)->ms;
    }
    return code;
}

/* The scene with the setting, not with the window. */
static int write_scene(const struct study *s, const struct setting *setting, const char *path) {
    const struct scene_options *user = s->extent.user;
    struct scene_options scene = {.scene = user->scene, .threads = 1, .silent = true};
    json_t *root = NULL;
    bool good = true;
    for (int k = 0; k < user->sets; k++) good &= scene_set(&scene, user->set[k]);
    for (int k = 0; k < setting->sets; k++) good &= scene_set(&scene, setting->set[k]);
    int code = good ? scene_text(&scene, &root) : EXIT_FAILED;
    if (code == EXIT_GOOD && json_dump_file(root, path, JSON_INDENT(2) | JSON_REAL_PRECISION(15)))
        code = report_unwritten(path);
    if (code == EXIT_GOOD) printf("Written to %s\n", path);
    json_decref(root);
    scene_options_free(&scene);
    return code;
}

/* ---- saying it ------------------------------------------------------------------------------- */

static void tell(const struct study *s, const struct tried *best, const struct cost *cost) {
    double per_second = s->trade.per_second, ms = cost->length > 0.0 ? cost->ms : best->ms;
    printf("\nRecommended: %s\n  %.4g ms a frame (%.4g s per simulated second), error %.4f %%\n ",
           best->setting->name, ms, 1e-3 * ms * per_second, 100.0 * best->error[s->trade.by]);
    for (int k = 0; k < best->setting->sets; k++) printf(" --set %s", best->setting->set[k]);
    putchar('\n');
    if (cost->length > 0.0)
        printf("  (the time from the first %.4g s of the scene itself, %.3g times that of its "
               "twin; the error is that of the twin)\n",
               cost->length, cost->ms / best->ms);
    else if (s->extent.twin.sets) puts("  (both of the twin: the scene itself was too slow)");
}

static int refuse(const struct study *s, double ratio) {
    fprintf(stderr, "projdyn: trade: nothing that was tried holds that");
    if (s->extent.twin.sets)
        fprintf(stderr, "; the scene itself takes about %.3g times as long as its twin", ratio);
    fputc('\n', stderr);
    return EXIT_FAILED;
}

int advise(const struct study *s, const struct wish *wish) {
    const struct tried *best = NULL;
    double ratio = s->extent.twin.sets ? pow(s->extent.coarser, growth) : 1.0;
    struct cost *cost = calloc((size_t)s->trade.count, sizeof *cost);
    fflush(stdout);
    int code = cost ? choose(s, wish, cost, &ratio, &best) : report_no_memory();
    if (code == EXIT_GOOD && !best) code = refuse(s, ratio);
    else if (code == EXIT_GOOD) {
        tell(s, best, &cost[best - s->trade.tried]);
        if (wish->write) code = write_scene(s, best->setting, wish->write);
    }
    free(cost);
    return code;
}
