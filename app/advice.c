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
    double length; /* s of the scene that were run */
    double ratio;  /* of its time to that of the twin */
};

/* The part of its time that a run had spent when so much was simulated; 0: not known. */
static double spent_until(const struct study *s, int k, double length) {
    char path[FARM_PATH];
    struct metrics m;
    double sum = 0.0, all = 0.0;
    if (!farm_path(path, &s->farm, &s->run[k], "") || metrics_read(path, &m) != EXIT_GOOD)
        return 0.0;
    int time = metrics_column(&m, "time_s"), ms = metrics_column(&m, "ms_cpu");
    for (long r = 0; r < m.rows && time >= 0 && ms >= 0; r++) {
        const double *row = m.value + r * m.columns;
        all += row[ms];
        if (row[time] <= length * (1.0 + 1e-9)) sum += row[ms];
    }
    metrics_free(&m);
    return all > 0.0 ? sum / all : 0.0;
}

/* The first `length` seconds of the scene with setting k; *ms: their processor time, 0 where they
 * did not end well. An exit code. */
static int run_beginning(const struct study *s, int k, double length, double *ms) {
    const struct scene_options *user = s->extent.user;
    const struct setting *setting = &s->plan.setting[k];
    struct farm farm = s->farm;
    struct farm_run run = {0};
    char text[64], path[FARM_PATH];
    const char *const duration[] = {text};
    snprintf(text, sizeof text, "duration=%.12g", length);
    if (!farm_add(&run, user->set, user->sets) || !farm_add(&run, duration, 1) ||
        !farm_add(&run, (const char *const *)setting->set, setting->sets))
        return free(run.set), report_no_memory();
    farm.jobs = 1, farm.run = &run, farm.count = 1;
    int code = farm_survey(&farm);
    if (code == EXIT_GOOD) code = farm_work(&farm);
    if (code == EXIT_GOOD && !farm_path(path, &farm, &run, "")) code = EXIT_FAILED;
    json_t *result = code == EXIT_GOOD ? result_read(path) : NULL;
    *ms = result_ms_per_second(result) * length;
    json_decref(result);
    free(run.set);
    return code;
}

/* Twice as much of the scene, and again, as long as that takes no more than `seconds`. What is left
 * has the ratio to the twin that the last half of it had: an impact is over then. */
static int find_cost(const struct study *s, int k, double seconds, struct cost *cost) {
    double most = s->extent.window.length, ms = 0.0, ms_before = 0.0, part_before = 0.0;
    *cost = (struct cost){0};
    for (double length = most / 256.0; length <= most && 3e-3 * ms <= seconds; length *= 2.0) {
        int code = run_beginning(s, k, length, &ms);
        double part = spent_until(s, k, length);
        if (code != EXIT_GOOD) return code;
        if (ms == 0.0) {
            fprintf(stderr, "projdyn: trade: %s: did not end well on the scene itself\n",
                    s->plan.setting[k].name);
            return EXIT_FAILED;
        }
        if (!(part > part_before)) continue; /* not a single step of the twin */
        double all = ms + (ms - ms_before) / (part - part_before) * (1.0 - part);
        cost->ms = all / (most * s->trade.per_second);
        cost->length = length, cost->ratio = cost->ms / s->trade.tried[k].ms;
        ms_before = ms, part_before = part;
    }
    return EXIT_GOOD;
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
        code = find_cost(s, (int)(*best - trade->tried), 5.0 * s->share, cost);
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
