/* Times of a twin are not those of the scene. So what seems to hold the wish is run on the scene
 * itself, as much of it as time allows; what the twin spent until then and after that tells how
 * much the rest will take. */
#include "advice.h"
#include "metrics.h"
#include "result.h"
#include "scene_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- the scene itself ------------------------------------------------------------------------ */

struct cost {
    double ms;     /* for a frame, of all that the study simulated */
    double length; /* s of the scene that were run; 0: its time is not known */
    double ratio;  /* of its time to that of the twin */
};

/* Processor time in ms that a run had spent when so much was simulated. */
static double spent_until(const struct metrics *m, double time) {
    int at = metrics_column(m, "time_s"), ms = metrics_column(m, "ms_cpu");
    double sum = 0.0;
    for (long r = 0; r < m->rows && at >= 0 && ms >= 0; r++)
        if (m->value[r * m->columns + at] <= time * (1.0 + 1e-9))
            sum += m->value[r * m->columns + ms];
    return sum;
}

static double end_of(const struct metrics *m) {
    int at = metrics_column(m, "time_s");
    return m->rows && at >= 0 ? m->value[(m->rows - 1) * m->columns + at] : 0.0;
}

/* A run that came to its limit is good as far as it came. */
static bool failed(const char *directory) {
    json_t *result = result_read(directory);
    bool bad = !result_is(result, "good") && !result_is(result, "killed");
    json_decref(result);
    return bad;
}

/* Runs the scene with setting k for so many seconds of processor time. An exit code. */
static int run_scene(const struct study *s, int k, double seconds, char path[FARM_PATH]) {
    const struct scene_options *user = s->extent.user;
    const struct setting *setting = &s->plan.setting[k];
    struct farm farm = s->farm;
    struct farm_run run = {.limit_s = seconds};
    char text[64];
    const char *const duration[] = {text};
    snprintf(text, sizeof text, "duration=%.12g", s->extent.window.length);
    if (!farm_add(&run, user->set, user->sets) || !farm_add(&run, duration, 1) ||
        !farm_add(&run, (const char *const *)setting->set, setting->sets))
        return free(run.set), report_no_memory();
    farm.jobs = 1, farm.run = &run, farm.count = 1;
    int code = farm_survey(&farm);
    if (code == EXIT_GOOD) code = farm_work(&farm);
    if (code == EXIT_GOOD && !farm_path(path, &farm, &run, "")) code = EXIT_FAILED;
    free(run.set);
    if (code != EXIT_GOOD || !failed(path)) return code;
    fprintf(stderr, "projdyn: trade: %s: did not end well on the scene itself\n", setting->name);
    return EXIT_FAILED;
}

/* What is left has the ratio to the twin that the last half had: an impact is over then. */
static struct cost foresee(const struct metrics *scene, const struct metrics *twin) {
    double end = end_of(scene), half = spent_until(scene, end) - spent_until(scene, 0.5 * end);
    double before = spent_until(twin, end), twin_half = before - spent_until(twin, 0.5 * end);
    double all = spent_until(twin, INFINITY), left = all - before;
    if (!(half > 0.0 && twin_half > 0.0)) return (struct cost){0};
    double ms = spent_until(scene, end) + half / twin_half * left;
    return (struct cost){.ms = ms, .length = end, .ratio = ms / all};
}

static int find_cost(const struct study *s, int k, double seconds, struct cost *cost) {
    char scene_path[FARM_PATH], twin_path[FARM_PATH];
    struct metrics scene, twin;
    int code = run_scene(s, k, seconds, scene_path);
    if (code == EXIT_GOOD && !farm_path(twin_path, &s->farm, &s->run[k], "")) code = EXIT_FAILED;
    if (code == EXIT_GOOD) code = metrics_read(scene_path, &scene);
    if (code != EXIT_GOOD) return code;
    code = metrics_read(twin_path, &twin);
    if (code == EXIT_GOOD) {
        *cost = foresee(&scene, &twin);
        cost->ms /= s->extent.window.length * s->trade.per_second;
        metrics_free(&twin);
    }
    metrics_free(&scene);
    return code;
}

/* ---- choosing -------------------------------------------------------------------------------- */

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

/* What steps leave that are cut short is another thing on a finer scene, so a twin can only speak
 * of solved ones. Where the scene turns out to be dearer than was thought, what the twin does in
 * less. */
static int choose(const struct study *s, const struct wish *wish, const struct tried **best,
                  struct cost *cost) {
    const struct trade *trade = &s->trade;
    double ratio = pow(s->extent.coarser, 3.0);
    bool twin = s->extent.twin.sets > 0;
    *cost = (struct cost){0};
    for (int code = EXIT_GOOD;;) {
        *best = front_choose(trade, wish->error, wish->ms / ratio, !isfinite(wish->error), twin);
        if (!*best || !twin) return code;
        code = find_cost(s, (int)(*best - trade->tried), 8.0 * s->share / s->farm.jobs, cost);
        if (code != EXIT_GOOD || cost->ms <= wish->ms) return code;
        ratio = fmax(cost->ratio, 1.01 * wish->ms / (*best)->ms);
    }
}

static void tell(const struct study *s, const struct tried *best, const struct cost *cost) {
    double per_second = s->trade.per_second, ms = cost->length > 0.0 ? cost->ms : best->ms;
    printf("\nRecommended: %s\n  %.4g ms a frame (%.4g s per simulated second), error %.4f %%\n ",
           best->setting->name, ms, 1e-3 * ms * per_second, 100.0 * best->error[s->trade.by]);
    for (int k = 0; k < best->setting->sets; k++) printf(" --set %s", best->setting->set[k]);
    putchar('\n');
    if (cost->length > 0.0)
        printf("  (the time from the first %.4g s of the scene itself, %.3g times that of its "
               "twin; the error is that of the twin)\n",
               cost->length, cost->ratio);
    else if (s->extent.twin.sets) puts("  (both of the twin: the scene itself was too slow)");
}

int advise(const struct study *s, const struct wish *wish) {
    const struct tried *best;
    struct cost cost;
    fflush(stdout);
    int code = choose(s, wish, &best, &cost);
    if (code != EXIT_GOOD) return code;
    if (!best) {
        fprintf(stderr, "projdyn: trade: nothing that was tried holds that\n");
        return EXIT_FAILED;
    }
    tell(s, best, &cost);
    return wish->write ? write_scene(s, best->setting, wish->write) : EXIT_GOOD;
}
