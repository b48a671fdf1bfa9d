#include "study.h"
#include "result.h"
#include "scene_json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The same settings for the scene and for what is run. */
static int make_plans(struct study *s) {
    json_t *scene = NULL, *runs = NULL;
    int code = scene_text(s->extent.user, &scene);
    if (code == EXIT_GOOD) code = scene_text(&s->extent.runs, &runs);
    const char *solver = s->extent.window.solver;
    if (code == EXIT_GOOD && (!plan_make(&s->plan, scene, solver, s->extent.coarser) ||
                              !plan_make(&s->tried, runs, solver, 1.0)))
        code = report_no_memory();
    json_decref(scene);
    json_decref(runs);
    return code;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Overrides of the user, the twin, the window and of a setting; all texts belong to others. */
static bool make_run(const struct study *s, const struct setting *setting, struct farm_run *run) {
    const struct extent *e = &s->extent;
    const char *const window[] = {e->window.sets[0], e->window.sets[1]};
    run->frames = true;
    return farm_add(run, e->runs.set, e->runs.sets) && farm_add(run, window, 2) &&
           farm_add(run, (const char *const *)setting->set, setting->sets);
}

static int run_some(struct study *s, struct farm_run *run, long count) {
    s->farm.run = run, s->farm.count = count;
    int code = farm_survey(&s->farm);
    return code == EXIT_GOOD ? farm_work(&s->farm) : code;
}

/* Half the length of the steps, and again, as long as the next is not too dear: twice as dear as
 * the one before. */
static int count_references(struct study *s) {
    char path[FARM_PATH];
    int count = 2;
    if (!farm_path(path, &s->farm, &s->reference[1], "")) return count;
    json_t *result = result_read(path);
    double next = 2.0 * json_number_value(json_object_get(result, "cpu_s"));
    for (; result && count < PLAN_REFERENCES && next <= 10.0 * s->share; next *= 2.0) count++;
    json_decref(result);
    return count;
}

/* The two coarsest references, which tell how many there can be, then all the rest. */
static int run_all(struct study *s) {
    int count = s->plan.count;
    s->reference = calloc((size_t)(PLAN_REFERENCES + count), sizeof *s->reference);
    if (!s->reference) return report_no_memory();
    for (int k = 0; k < PLAN_REFERENCES; k++)
        if (!make_run(s, &s->tried.reference[k], &s->reference[k])) return report_no_memory();
    int code = run_some(s, s->reference, 2);
    if (code != EXIT_GOOD) return code;
    s->references = count_references(s);
    for (int k = s->references; k < PLAN_REFERENCES; k++) {
        free(s->reference[k].set);
        s->reference[k] = (struct farm_run){0};
    }
    s->run = s->reference + s->references;
    for (int k = 0; k < count; k++) {
        if (!make_run(s, &s->tried.setting[k], &s->run[k])) return report_no_memory();
        s->run[k].limit_s = fmax(5.0, 10.0 * s->share);
    }
    return run_some(s, s->reference + 2, s->references - 2 + count);
}

/* Those of the front once more, without frames and one at a time: the shorter time counts. */
static int run_again(struct study *s) {
    struct farm again = s->farm;
    again.jobs = 1, again.count = 0;
    again.run = calloc((size_t)s->trade.count, sizeof *again.run);
    if (!again.run) return report_no_memory();
    for (int k = 0; k < s->trade.count; k++) {
        if (!s->trade.tried[k].front || s->trade.tried[k].checked) continue;
        again.run[again.count] = s->run[k];
        again.run[again.count++].frames = false;
    }
    int code = farm_survey(&again);
    if (code == EXIT_GOOD && again.count) code = farm_work(&again);
    for (long k = 0, r = 0; k < s->trade.count && code == EXIT_GOOD; k++) {
        struct tried *t = &s->trade.tried[k];
        char path[FARM_PATH];
        if (!t->front || t->checked) continue;
        if (!farm_path(path, &again, &again.run[r++], "")) return EXIT_FAILED;
        json_t *result = result_read(path);
        double ms = result_ms_per_second(result);
        if (ms > 0.0) t->ms = fmin(t->ms, ms / s->trade.per_second);
        t->checked = true;
        json_decref(result);
    }
    free(again.run);
    return code;
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void set_worst(double error[TRACK_MEASURES + 1]) {
    error[TRADE_WORST] = 0.0;
    for (int m = 0; m < TRACK_MEASURES; m++)
        error[TRADE_WORST] = fmax(error[TRADE_WORST], error[m]);
}

static bool ended_well(const struct farm *farm, const struct farm_run *run, char path[FARM_PATH]) {
    if (!farm_path(path, farm, run, "")) return false;
    json_t *result = result_read(path);
    bool good = result_is(result, "good");
    json_decref(result);
    return good;
}

static int read_run(const struct farm *farm, const struct farm_run *run, struct track *track) {
    char path[FARM_PATH];
    if (ended_well(farm, run, path)) return track_read(path, track);
    fprintf(stderr, "projdyn: trade: the reference did not end well: %s/result.json\n", path);
    return EXIT_FAILED;
}

static int judge(struct study *s, const struct track *reference) {
    struct trade *trade = &s->trade;
    for (int k = 0; k < trade->count; k++) {
        struct tried *t = &trade->tried[k];
        struct track track;
        char path[FARM_PATH];
        t->setting = &s->plan.setting[k];
        if (!ended_well(&s->farm, &s->run[k], path)) continue;
        int code = track_read(path, &track);
        if (code != EXIT_GOOD) return code;
        track_compare(&track, reference, t->error);
        set_worst(t->error);
        t->good = isfinite(t->error[TRADE_WORST]) && track.frames == reference->frames;
        t->ms = track.ms_per_second / trade->per_second;
        t->residual = track.residual;
        track_free(&track);
    }
    return EXIT_GOOD;
}

static int judge_all(struct study *s) {
    struct track reference = {0}, coarse = {0};
    s->trade.count = s->plan.count;
    s->trade.reference = s->plan.reference[s->references - 1].name;
    s->trade.tried = calloc((size_t)s->plan.count, sizeof *s->trade.tried);
    if (!s->trade.tried) return report_no_memory();
    int code = read_run(&s->farm, &s->reference[s->references - 1], &reference);
    if (code == EXIT_GOOD) code = read_run(&s->farm, &s->reference[s->references - 2], &coarse);
    if (code == EXIT_GOOD) {
        track_compare(&coarse, &reference, s->trade.unsure);
        s->trade.unsure[TRACK_DENSITY] = reference.density;
        set_worst(s->trade.unsure);
        code = judge(s, &reference);
    }
    track_free(&reference);
    track_free(&coarse);
    return code;
}

static bool is_same(const struct tried *a, const struct tried *b) {
    return a->good && b->good && a->residual == b->residual &&
           !memcmp(a->error, b->error, sizeof a->error);
}

/* Settings that make no difference make one run: the shorter time counts for both. */
static void join_times(struct trade *trade) {
    for (int k = 0; k < trade->count; k++)
        for (int j = 0; j < trade->count; j++)
            if (is_same(&trade->tried[k], &trade->tried[j]))
                trade->tried[k].ms = fmin(trade->tried[k].ms, trade->tried[j].ms);
}

/* A time that is measured again may change the front: until it does not. */
static int find_front(struct study *s) {
    int code = EXIT_GOOD;
    for (bool open = true; open && code == EXIT_GOOD;) {
        join_times(&s->trade);
        front_find(&s->trade);
        open = false;
        for (int k = 0; k < s->trade.count; k++)
            open |= s->trade.tried[k].front && !s->trade.tried[k].checked;
        if (open) code = run_again(s);
    }
    return code;
}

/* ---- all of it ------------------------------------------------------------------------------- */

int study_do(struct study *s) {
    int code = extent_find(&s->extent, &s->farm, s->length, s->share);
    if (code == EXIT_GOOD && !s->farm.quiet) extent_tell(&s->extent);
    if (code == EXIT_GOOD) code = make_plans(s);
    s->trade.per_second = 1.0 / s->extent.window.own_interval;
    if (code == EXIT_GOOD) code = run_all(s);
    if (code == EXIT_GOOD) code = judge_all(s);
    return code == EXIT_GOOD ? find_front(s) : code;
}

void study_free(struct study *s) {
    int runs = s->run ? s->references + s->plan.count : PLAN_REFERENCES;
    for (int k = 0; s->reference && k < runs; k++) free(s->reference[k].set);
    free(s->reference);
    free(s->trade.tried);
    plan_free(&s->plan);
    plan_free(&s->tried);
    extent_free(&s->extent);
}
