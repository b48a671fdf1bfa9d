/* Chooses a setting for a target. Errors come from the study. Times of a replica are not those
 * of the scene, therefore a chosen setting is run on the scene itself until a limit of processor
 * time; its time for the whole window is extrapolated with the times of the same setting on the
 * replica. */
#include "recommendation.h"
#include "calibration.h"
#include "replica.h"
#include "scene_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SCENE_RUNS = 3 }; /* settings that are run on the scene itself */

/* ---- time on the scene itself ---------------------------------------------------------------- */

/* What is known of one setting on the scene. */
struct scene_time {
    double ms;        /* processor time per frame, extrapolated to the whole window */
    double simulated; /* s of the scene that were run; 0: the time is not known */
    bool warns;       /* the scene has warnings with it that it does not have without it */
    bool no_warnings; /* it has been looked for such warnings in vain */
};

/* Runs setting k on the scene, for limit_s seconds of processor time. */
static int run_scene(const struct study *s, int k, double limit_s, struct metrics_csv *steps) {
    const struct scene_options *user = s->scope.user;
    const struct setting *setting = &s->scene_plan.setting[k];
    struct job job = {.limit_s = limit_s};
    char text[64];
    const char *const duration[] = {text};
    snprintf(text, sizeof text, "duration=%.12g", s->scope.window.length);
    bool good = job_add_overrides(&job, user->set, user->sets) &&
                job_add_overrides(&job, duration, 1) &&
                job_add_overrides(&job, (const char *const *)setting->set, setting->sets);
    int code = good ? calibration_run(&s->jobs, &job, steps) : report_no_memory();
    free(job.set);
    return code;
}

/* Processor time, ms, of the whole window on the scene. With T the simulated time that the scene
 * run reached and c(a, b) processor times between simulated times a and b:
 *
 *     c_scene(0, T) + c_replica(T, end) c_scene(T/2, T) / c_replica(T/2, T)
 *
 * The second half of the run gives the ratio, because an impact at the start is over by then.
 * NAN if a half has no steps. */
static double extrapolate_ms(const struct metrics_csv *scene, const struct metrics_csv *replica) {
    double end = simulated_seconds(scene);
    double scene_ms = cpu_ms_until(scene, end), replica_ms = cpu_ms_until(replica, end);
    double scene_half = scene_ms - cpu_ms_until(scene, 0.5 * end);
    double replica_half = replica_ms - cpu_ms_until(replica, 0.5 * end);
    double rest = cpu_ms_until(replica, INFINITY) - replica_ms;
    if (!(scene_half > 0.0 && replica_half > 0.0)) return NAN;
    return scene_ms + scene_half / replica_half * rest;
}

/* Runs setting k on the scene and sets its time; time->simulated stays 0 if it is unknown. */
static int measure_scene_time(const struct study *s, int k, double limit_s,
                              struct scene_time *time) {
    char path[JOB_PATH];
    struct metrics_csv scene, replica;
    if (!job_path(path, &s->jobs, &s->setting_job[k], "")) return EXIT_FAILED;
    int code = run_scene(s, k, limit_s, &scene);
    if (code != EXIT_GOOD) return code;
    code = metrics_csv_read(path, "metrics.csv", &replica);
    if (code == EXIT_GOOD) {
        double ms = extrapolate_ms(&scene, &replica);
        if (isfinite(ms)) time->simulated = simulated_seconds(&scene);
        time->ms = ms / (s->scope.window.length * s->table.frames_per_second);
        metrics_csv_free(&replica);
    }
    metrics_csv_free(&scene);
    return code;
}

/* ---- warnings -------------------------------------------------------------------------------- */

/* Loads the scene with a setting. The caller frees *sim and *context in any case. */
static int load_scene(const struct study *s, const struct setting *setting, pdyn_context **context,
                      pdyn_sim **sim) {
    struct scene_options scene;
    *context = NULL, *sim = NULL;
    int code = setting_scene(setting, s->scope.user, &scene) ? scene_load(&scene, context, sim)
                                                             : EXIT_FAILED;
    scene_options_free(&scene);
    return code;
}

static bool has_warning(const pdyn_sim *sim, const char *code) {
    const char *other;
    for (int k = 0; (other = pdyn_get_warning(sim, k).code); k++)
        if (!strcmp(other, code)) return true;
    return false;
}

/* Sets *warns to whether the loaded scene has a warning with the setting that it does not have
 * without. */
static int find_warnings(const struct study *s, const struct setting *setting, bool *warns) {
    static const struct setting unchanged = {0};
    pdyn_context *context[2] = {0};
    pdyn_sim *sim[2] = {0};
    const char *found;
    int code = load_scene(s, setting, &context[0], &sim[0]);
    if (code == EXIT_GOOD && pdyn_get_warning(sim[0], 0).code)
        code = load_scene(s, &unchanged, &context[1], &sim[1]);
    *warns = false;
    for (int k = 0; code == EXIT_GOOD && (found = pdyn_get_warning(sim[0], k).code); k++)
        *warns |= !has_warning(sim[1], found);
    for (int k = 0; k < 2; k++) pdyn_free(sim[k]), pdyn_destroy(context[k]);
    return code;
}

/* ---- choice ---------------------------------------------------------------------------------- */

/* The fastest trial that reaches the target if the target limits the error, otherwise the most
 * accurate one; NULL if none reaches it. Trials with truncated iterations are left out on a
 * replica: the error that truncation leaves is larger on a finer scene. So are those that warn.
 * ratio: time of the scene over time of the replica, for settings whose scene time is not known. */
static const struct trial *find_fitting(const struct study *s, const struct target *target,
                                        const struct scene_time *time, double ratio) {
    const struct trial_table *table = &s->table;
    const struct trial *best = NULL;
    bool fastest = isfinite(target->max_error);
    double least = INFINITY;
    for (int k = 0; k < table->count; k++) {
        const struct trial *t = &table->trial[k];
        double ms = time[k].simulated > 0.0 ? time[k].ms : ratio * t->ms;
        double error = t->error[table->metric], objective = fastest ? ms : error;
        if (!trial_is_usable(t, table->metric)) continue;
        if (time[k].warns || (s->scope.replica.sets && t->setting->truncated)) continue;
        if (!(error <= target->max_error && ms <= target->max_ms && objective < least)) continue;
        best = t, least = objective;
    }
    return best;
}

/* The same, of the trials with which loading the scene gives no new warning. */
static int find_best(const struct study *s, const struct target *target, struct scene_time *time,
                     double ratio, const struct trial **best) {
    int code = EXIT_GOOD;
    while (code == EXIT_GOOD && (*best = find_fitting(s, target, time, ratio))) {
        struct scene_time *t = &time[*best - s->table.trial];
        if (t->no_warnings) return code;
        code = find_warnings(s, (*best)->setting, &t->warns);
        t->no_warnings = !t->warns;
    }
    return code;
}

/* Chooses a trial; with a replica, runs it on the scene, updates the ratio of times and chooses
 * again, until the chosen trial is one whose scene time is known. If nothing fits the budget by the
 * expected ratio, the fastest trial measures it. *best = NULL if nothing reaches the target. */
static int choose(const struct study *s, const struct target *target, struct scene_time *time,
                  double *ratio, const struct trial **best) {
    static const struct target fastest = {.max_error = 1.0, .max_ms = INFINITY};
    bool has_replica = s->scope.replica.sets > 0;
    int code = EXIT_GOOD;
    for (int runs = 0; code == EXIT_GOOD; runs++) {
        code = find_best(s, target, time, runs < MAX_SCENE_RUNS ? *ratio : INFINITY, best);
        bool fits = *best, measures = !fits && runs == 0 && has_replica && isfinite(target->max_ms);
        if (code == EXIT_GOOD && measures) code = find_best(s, &fastest, time, *ratio, best);
        if (code != EXIT_GOOD || !*best || !has_replica) return code;
        int k = (int)(*best - s->table.trial);
        if (time[k].simulated > 0.0) return code;
        code = measure_scene_time(s, k, 8.0 * s->run_budget_s / s->jobs.processes, &time[k]);
        if (time[k].simulated == 0.0) return *best = fits ? *best : NULL, code;
        *ratio = time[k].ms / (*best)->ms;
    }
    return code;
}

/* ---- output ---------------------------------------------------------------------------------- */

/* Writes the scene with the setting; the overrides of the time window are not part of it. */
static int write_scene(const struct study *s, const struct setting *setting, const char *path) {
    struct scene_options scene;
    json_t *root = NULL;
    int code =
        setting_scene(setting, s->scope.user, &scene) ? scene_json(&scene, &root) : EXIT_FAILED;
    if (code == EXIT_GOOD && json_dump_file(root, path, JSON_INDENT(2) | JSON_REAL_PRECISION(15)))
        code = report_write_error(path);
    if (code == EXIT_GOOD) printf("Written to %s\n", path);
    json_decref(root);
    scene_options_free(&scene);
    return code;
}

/* Says so where the reference does not resolve the error of a trial, or the error that is asked
 * for: its own error is half as large, or larger. */
static void print_resolution(const struct study *s, const struct target *target,
                             const struct trial *best) {
    double reference = s->table.reference_error[s->table.metric];
    double wanted = isfinite(target->max_error) ? target->max_error : best->error[s->table.metric];
    if (wanted >= 2.0 * reference) return;
    printf("  (the reference does not resolve an error of %.4g %%: its own is about %.4g %%; take "
           "more --minutes or --error %.2g%%)\n",
           100.0 * wanted, 100.0 * reference, 200.0 * reference);
}

static void print_recommendation(const struct study *s, const struct trial *best,
                                 const struct scene_time *time) {
    double ms = time->simulated > 0.0 ? time->ms : best->ms;
    printf("\nRecommended: %s\n  %.4g ms a frame (%.4g s per simulated second), error %.4f %%\n ",
           best->setting->name, ms, 1e-3 * ms * s->table.frames_per_second,
           100.0 * best->error[s->table.metric]);
    for (int k = 0; k < best->setting->sets; k++)
        printf(" --set %s", shell_word(best->setting->set[k]).text);
    putchar('\n');
    if (time->simulated > 0.0)
        printf(
            "  (time: extrapolated from the first %.4g s of the scene itself, %.3g times that of "
            "the replica; error: of the replica)\n",
            time->simulated, time->ms / best->ms);
    else if (s->scope.replica.sets)
        puts("  (time and error of the replica: the scene itself took too long)");
    if (best->setting->truncated)
        puts("  (it ends steps before they are solved: runs have the warning \"unsolved\")");
}

static int report_unreached(const struct study *s, double ratio) {
    fprintf(stderr, "projdyn: trade: no setting reaches the target");
    if (s->scope.replica.sets)
        fprintf(stderr, "; the scene itself takes about %.3g times as long as its replica", ratio);
    fputc('\n', stderr);
    return EXIT_FAILED;
}

int recommend(const struct study *s, const struct target *target) {
    const struct trial *best = NULL;
    double ratio = s->scope.replica.sets ? pow(s->scope.coarsening, REPLICA_COST_EXPONENT) : 1.0;
    struct scene_time *time = calloc((size_t)s->table.count, sizeof *time);
    fflush(stdout);
    int code = time ? choose(s, target, time, &ratio, &best) : report_no_memory();
    if (code == EXIT_GOOD && !best) code = report_unreached(s, ratio);
    else if (code == EXIT_GOOD) {
        print_recommendation(s, best, &time[best - s->table.trial]);
        print_resolution(s, target, best);
        if (target->write) code = write_scene(s, best->setting, target->write);
    }
    free(time);
    return code;
}
