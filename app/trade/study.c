/* Runs references and settings of a study, measures errors, and times on the Pareto front. */
#include "study.h"
#include "job_result.h"
#include "pareto.h"
#include "scene_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the scene ------------------------------------------------------------------------------- */

/* Whether the scene has a body of particles, or one of another kind. */
static bool has_body(const json_t *scene, bool of_particles) {
    const json_t *bodies = json_object_get(scene, "bodies");
    for (size_t b = 0; b < json_array_size(bodies); b++)
        if (of_particles == !!json_object_get(json_array_get(bodies, b), "particles")) return true;
    return false;
}

/* An error that no body of the scene can have is 0 for every setting, and would recommend any. */
static int check_metric(const struct study *s) {
    int metric = s->table.metric;
    bool cloth = metric == RUN_METRIC_CLOTH;
    if (!cloth && metric != RUN_METRIC_DENSITY && metric != RUN_METRIC_FRONT &&
        metric != RUN_METRIC_PROFILE)
        return EXIT_GOOD;
    json_t *scene = NULL;
    int code = scene_json(s->scope.user, &scene);
    if (code == EXIT_GOOD && !has_body(scene, !cloth)) {
        fprintf(stderr, "projdyn: --by: found \"%s\", expected %s, energy, gained or all: %s\n",
                run_metric_names[metric], cloth ? "density, front, profile" : "cloth",
                cloth ? "all bodies are of particles" : "no body is of particles");
        code = EXIT_BAD_INPUT;
    }
    json_decref(scene);
    return code;
}

/* Makes the plan in terms of the scene and the same plan in terms of the scope. */
static int make_plans(struct study *s) {
    json_t *scene = NULL, *runs = NULL;
    int code = scene_json(s->scope.user, &scene);
    if (code == EXIT_GOOD) code = scene_json(&s->scope.runs, &runs);
    const struct time_window *window = &s->scope.window;
    if (code == EXIT_GOOD && (!plan_make(&s->scene_plan, scene, window, s->scope.coarsening) ||
                              !plan_make(&s->run_plan, runs, window, 1.0)))
        code = report_no_memory();
    json_decref(scene);
    json_decref(runs);
    return code;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Overrides of user and replica, of the time window and of a setting. The job borrows all texts. */
static bool make_job(const struct study *s, const struct setting *setting, struct job *job) {
    const struct scope *scope = &s->scope;
    const char *const window[] = {scope->window.sets[0], scope->window.sets[1]};
    job->frames = true;
    return job_add_overrides(job, scope->runs.set, scope->runs.sets) &&
           job_add_overrides(job, window, 2) &&
           job_add_overrides(job, (const char *const *)setting->set, setting->sets);
}

static int run_jobs(struct study *s, struct job *job, long count) {
    s->jobs.job = job, s->jobs.count = count;
    int code = jobs_find_finished(&s->jobs);
    return code == EXIT_GOOD ? jobs_run(&s->jobs) : code;
}

/* Number of references that the budget allows. Each one has half the step length of the one
 * before and is estimated to take twice as long; the finest one may take 10 times the budget of
 * a run. */
static int count_references(struct study *s) {
    char path[JOB_PATH];
    int count = 2;
    if (!job_path(path, &s->jobs, &s->reference_job[1], "")) return count;
    json_t *result = job_result_read(path);
    double next_s = 2.0 * json_number_value(json_object_get(result, "cpu_s"));
    for (; result && count < PLAN_REFERENCES && next_s <= 10.0 * s->run_budget_s; next_s *= 2.0)
        count++;
    json_decref(result);
    return count;
}

/* Makes the jobs of all references, runs the two coarsest ones, whose times tell how many
 * references there can be, and drops the others. */
static int start_references(struct study *s) {
    for (int k = 0; k < PLAN_REFERENCES; k++)
        if (!make_job(s, &s->run_plan.reference[k], &s->reference_job[k]))
            return report_no_memory();
    int code = run_jobs(s, s->reference_job, 2);
    if (code != EXIT_GOOD) return code;
    s->references = count_references(s);
    for (int k = s->references; k < PLAN_REFERENCES; k++) {
        free(s->reference_job[k].set);
        s->reference_job[k] = (struct job){0};
    }
    s->setting_job = s->reference_job + s->references;
    return EXIT_GOOD;
}

/* Runs all references and settings. A setting is killed after 10 times the budget of a run (at
 * least 5 s of processor time). */
static int run_all(struct study *s) {
    int count = s->scene_plan.count;
    s->reference_job = calloc((size_t)(PLAN_REFERENCES + count), sizeof *s->reference_job);
    if (!s->reference_job) return report_no_memory();
    int code = start_references(s);
    if (code != EXIT_GOOD) return code;
    for (int k = 0; k < count; k++) {
        if (!make_job(s, &s->run_plan.setting[k], &s->setting_job[k])) return report_no_memory();
        s->setting_job[k].limit_s = fmax(5.0, 10.0 * s->run_budget_s);
    }
    return run_jobs(s, s->reference_job + 2, s->references - 2 + count);
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void set_max_error(double error[RUN_METRICS_COUNT + 1]) {
    error[TRIAL_MAX_ERROR] = 0.0;
    for (int m = 0; m < RUN_METRICS_COUNT; m++)
        error[TRIAL_MAX_ERROR] = fmax(error[TRIAL_MAX_ERROR], error[m]);
}

/* Whether the job succeeded; sets path to its directory. */
static bool is_good(const struct jobs *jobs, const struct job *job, char path[JOB_PATH]) {
    if (!job_path(path, jobs, job, "")) return false;
    json_t *result = job_result_read(path);
    bool good = job_result_has_status(result, "good");
    json_decref(result);
    return good;
}

static int read_reference(const struct jobs *jobs, const struct job *job,
                          struct run_metrics *metrics) {
    char path[JOB_PATH];
    if (is_good(jobs, job, path)) return run_metrics_read(path, metrics);
    fprintf(stderr, "projdyn: trade: the reference run failed: %s/result.json\n", path);
    return EXIT_FAILED;
}

/* Fills the trial of every setting whose job succeeded. */
static int evaluate_settings(struct study *s, const struct run_metrics *reference) {
    struct trial_table *table = &s->table;
    for (int k = 0; k < table->count; k++) {
        struct trial *t = &table->trial[k];
        struct run_metrics metrics;
        char path[JOB_PATH];
        t->setting = &s->scene_plan.setting[k];
        if (!is_good(&s->jobs, &s->setting_job[k], path)) continue;
        int code = run_metrics_read(path, &metrics);
        if (code != EXIT_GOOD) return code;
        run_metrics_compare(&metrics, reference, t->error);
        set_max_error(t->error);
        t->good = isfinite(t->error[TRIAL_MAX_ERROR]) && metrics.frames == reference->frames;
        t->ms = metrics.ms_per_second / table->frames_per_second;
        t->residual = metrics.residual;
        run_metrics_free(&metrics);
    }
    return EXIT_GOOD;
}

/* Evaluates all settings against the finest reference. The error of that reference is estimated
 * by its distance to the second finest one; its density error is its own, as for every run. */
static int evaluate(struct study *s) {
    struct run_metrics reference = {0}, coarser = {0};
    s->table.count = s->scene_plan.count;
    s->table.reference = s->scene_plan.reference[s->references - 1].name;
    s->table.trial = calloc((size_t)s->scene_plan.count, sizeof *s->table.trial);
    if (!s->table.trial) return report_no_memory();
    int code = read_reference(&s->jobs, &s->reference_job[s->references - 1], &reference);
    if (code == EXIT_GOOD)
        code = read_reference(&s->jobs, &s->reference_job[s->references - 2], &coarser);
    if (code == EXIT_GOOD) {
        run_metrics_compare(&coarser, &reference, s->table.reference_error);
        s->table.reference_error[RUN_METRIC_DENSITY] = reference.density;
        set_max_error(s->table.reference_error);
        code = evaluate_settings(s, &reference);
    }
    run_metrics_free(&reference);
    run_metrics_free(&coarser);
    return code;
}

/* ---- times ----------------------------------------------------------------------------------- */

static bool has_same_result(const struct trial *a, const struct trial *b) {
    return a->good && b->good && a->residual == b->residual &&
           !memcmp(a->error, b->error, sizeof a->error);
}

/* Settings that change nothing in a scene give identical runs: all of them get the shortest
 * time. */
static void share_times(struct trial_table *table) {
    for (int k = 0; k < table->count; k++)
        for (int j = 0; j < table->count; j++)
            if (has_same_result(&table->trial[k], &table->trial[j]))
                table->trial[k].ms = fmin(table->trial[k].ms, table->trial[j].ms);
}

static bool needs_remeasuring(const struct trial *t) { return t->pareto && !t->remeasured; }

/* Reads the second time of a trial: the shorter one of both counts. */
static int read_second_time(const struct jobs *jobs, const struct job *job,
                            double frames_per_second, struct trial *t) {
    char path[JOB_PATH];
    if (!job_path(path, jobs, job, "")) return EXIT_FAILED;
    json_t *result = job_result_read(path);
    double ms = job_result_ms_per_second(result);
    if (ms > 0.0) t->ms = fmin(t->ms, ms / frames_per_second);
    t->remeasured = true;
    json_decref(result);
    return EXIT_GOOD;
}

/* Runs the trials of the Pareto front a second time, one after the other and without writing
 * frames, for an undisturbed time. */
static int remeasure_front(struct study *s) {
    struct trial_table *table = &s->table;
    struct jobs again = s->jobs;
    again.processes = 1, again.count = 0;
    again.job = calloc((size_t)table->count, sizeof *again.job);
    if (!again.job) return report_no_memory();
    for (int k = 0; k < table->count; k++) {
        if (!needs_remeasuring(&table->trial[k])) continue;
        again.job[again.count] = s->setting_job[k];
        again.job[again.count++].frames = false;
    }
    int code = jobs_find_finished(&again);
    if (code == EXIT_GOOD && again.count) code = jobs_run(&again);
    for (long k = 0, job = 0; k < table->count && code == EXIT_GOOD; k++)
        if (needs_remeasuring(&table->trial[k]))
            code = read_second_time(&again, &again.job[job++], table->frames_per_second,
                                    &table->trial[k]);
    free(again.job);
    return code;
}

/* Marks the Pareto front and remeasures its times; repeats that until the front stays the same. */
static int find_pareto_front(struct study *s) {
    int code = EXIT_GOOD;
    for (bool changed = true; changed && code == EXIT_GOOD;) {
        share_times(&s->table);
        pareto_mark(&s->table);
        changed = false;
        for (int k = 0; k < s->table.count; k++) changed |= needs_remeasuring(&s->table.trial[k]);
        if (changed) code = remeasure_front(s);
    }
    return code;
}

/* ---- the study ------------------------------------------------------------------------------- */

int study_run(struct study *s) {
    int code = check_metric(s);
    if (code == EXIT_GOOD) code = scope_find(&s->scope, &s->jobs, s->length, s->run_budget_s);
    if (code == EXIT_GOOD && !s->jobs.quiet) scope_print(&s->scope);
    if (code == EXIT_GOOD) code = make_plans(s);
    s->table.frames_per_second = 1.0 / s->scope.window.scene_interval;
    if (code == EXIT_GOOD) code = run_all(s);
    if (code == EXIT_GOOD) code = evaluate(s);
    return code == EXIT_GOOD ? find_pareto_front(s) : code;
}

void study_free(struct study *s) {
    int jobs = s->setting_job ? s->references + s->scene_plan.count : PLAN_REFERENCES;
    for (int k = 0; s->reference_job && k < jobs; k++) free(s->reference_job[k].set);
    free(s->reference_job);
    free(s->table.trial);
    plan_free(&s->scene_plan);
    plan_free(&s->run_plan);
    scope_free(&s->scope);
}
