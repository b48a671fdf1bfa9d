/* projdyn trade: many settings of a scene against a converged reference of it; which are worth
 * their time, and which hold an error or fit into a time. */
#include "trade.h"
#include "app.h"
#include "farm.h"
#include "result.h"
#include "window.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn trade SCENE [OPTIONS]\n"
    "\n"
    "Runs a scene with many settings and says what their time buys: errors against a reference\n"
    "with steps of an eighth of the length or less, solved. Prints those that nothing beats, "
    "writes all "
    "to\n"
    "DIR/trade.csv and draws them. Runs that have ended are kept.\n"
    "\n"
    "      --error E         recommends the cheapest with an error up to E, 0.001 or 0.1%\n"
    "      --budget T        recommends the most accurate that takes up to T a frame, 33ms or "
    "0.1s\n"
    "      --by NAME         the error that counts: density, cloth, front, profile, energy, or "
    "all,\n"
    "                        the largest of them (default)\n"
    "      --write SCENE2    writes the scene with the recommended settings\n"
    "      --minutes M       about as long may it take (default 25): simulates a shorter window\n"
    "      --window S        simulates S seconds from the start\n"
    "      --set PATH=VALUE  overrides a value of the scene\n"
    "  -o, --output DIR      where to write (default out/trade-NAME of the scene)\n"
    "      --jobs N          runs at a time (default: cores), each with one thread\n"
    "      --plugin FILE     loads a plug-in before the scene\n"
    "      --quiet           no progress\n"
    "  -h, --help            this text\n";

struct options {
    struct scene_options scene;
    struct farm farm;
    double error, ms, minutes,
        length; /* INFINITY, INFINITY: not asked for; length 0: to be found */
    const char *write;
    char *output;
    int by;
};

struct work {
    json_t *scene; /* with its overrides */
    struct window window;
    struct plan plan;
    struct trade trade;
    struct farm_run reference[PLAN_REFERENCES];
    int references;       /* that were run: the last is the reference, the others coarser */
    struct farm_run *run; /* of the plan */
};

/* ---- arguments ------------------------------------------------------------------------------- */

struct unit {
    const char *name;
    double factor;
};

/* A number above 0 with one of the units, which end with a name of NULL; a name of "" is none. */
static bool parse_quantity(const char *option, const char *text, const struct unit *units,
                           const char *expected, double *out) {
    char *end;
    double value = strtod(text, &end);
    for (; end != text && units->name; units++)
        if (!strcmp(end, units->name) && isfinite(value) && value > 0.0) {
            *out = value * units->factor;
            return true;
        }
    fprintf(stderr, "projdyn: %s: found \"%s\", expected %s\n", option, text, expected);
    return false;
}

static bool parse_measure(struct options *o, const char *text) {
    for (o->by = 0; o->by < TRACK_MEASURES; o->by++)
        if (!strcmp(text, track_names[o->by])) return true;
    if (!strcmp(text, "all")) return true; /* by is TRADE_WORST now */
    fprintf(stderr,
            "projdyn: --by: found \"%s\", expected density, cloth, front, profile, energy "
            "or all\n",
            text);
    return false;
}

static const struct unit parts[] = {{"", 1}, {"%", 0.01}, {0}};
static const struct unit times[] = {{"ms", 1}, {"s", 1000}, {0}};
static const struct unit plain[] = {{"", 1}, {0}};

static bool accept_option(struct options *o, int option) {
    double jobs;
    switch (option) {
    case 'e':
        return parse_quantity("--error", optarg, parts, "a part like 0.001 or 0.1%", &o->error);
    case 'b':
        return parse_quantity("--budget", optarg, times, "a time like 33ms or 0.1s", &o->ms);
    case 'm':
        return parse_quantity("--minutes", optarg, plain, "minutes above 0", &o->minutes);
    case 'W':
        return parse_quantity("--window", optarg, plain, "seconds above 0", &o->length);
    case 'j':
        if (!parse_quantity("--jobs", optarg, plain, "a number of runs", &jobs)) return false;
        return o->farm.jobs = (int)fmin(1024.0, fmax(1.0, jobs)), true;
    case 'y':
        return parse_measure(o, optarg);
    case 'w':
        return o->write = optarg, true;
    case 'o':
        return o->farm.output = optarg, true;
    case 's':
        return scene_set(&o->scene, optarg);
    case 'P':
        return scene_plugin(&o->scene, optarg) && scene_plugin(&o->farm.scene, optarg);
    case 'q':
        return o->farm.quiet = true;
    default:
        return false;
    }
}

/* -1: go on; otherwise the exit code. */
static int parse(struct options *o, int argc, char **argv) {
    static const struct option long_options[] = {{"error", required_argument, NULL, 'e'},
                                                 {"budget", required_argument, NULL, 'b'},
                                                 {"by", required_argument, NULL, 'y'},
                                                 {"write", required_argument, NULL, 'w'},
                                                 {"minutes", required_argument, NULL, 'm'},
                                                 {"window", required_argument, NULL, 'W'},
                                                 {"set", required_argument, NULL, 's'},
                                                 {"output", required_argument, NULL, 'o'},
                                                 {"jobs", required_argument, NULL, 'j'},
                                                 {"plugin", required_argument, NULL, 'P'},
                                                 {"quiet", no_argument, NULL, 'q'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    int option;
    while ((option = getopt_long(argc, argv, "o:h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (!accept_option(o, option)) return EXIT_BAD_INPUT;
    }
    if (argc - optind != 1) {
        fprintf(stderr, "projdyn: trade: expected one scene file\n\n%s", usage);
        return EXIT_BAD_INPUT;
    }
    if (o->write && !isfinite(o->error) && !isfinite(o->ms)) {
        fprintf(stderr, "projdyn: --write: expected --error or --budget, too\n");
        return EXIT_BAD_INPUT;
    }
    o->scene.scene = o->farm.scene.scene = argv[optind];
    if (!o->farm.output) o->farm.output = o->output = default_output("trade-", argv[optind]);
    return o->farm.output ? -1 : EXIT_FAILED;
}

/* ---- the scene ------------------------------------------------------------------------------- */

static void take_text(void *user, const char *text) {
    *(json_t **)user = json_loads(text, 0, NULL);
}

static int read_scene(const struct options *o, char solver[64], struct work *w) {
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    struct scene_options scene = o->scene;
    scene.threads = 1;
    int code = scene_load(&scene, &context, &sim);
    if (code == EXIT_GOOD) {
        pdyn_status status =
            pdyn_scene_text(context, scene.scene, scene.set, scene.sets, take_text, &w->scene);
        if (status != PDYN_OK) code = report_status(context, status);
        snprintf(solver, 64, "%s", pdyn_solver_type(sim));
        w->trade.per_second = 1.0 / pdyn_frame_interval(sim);
        if (o->length > 0.0) window_set(&w->window, sim, fmin(o->length, pdyn_duration(sim)));
    }
    pdyn_free(sim);
    pdyn_destroy(context);
    return code;
}

/* What a run of the scene as it is may cost, so that all of them fit: some 80 times that. */
static double share(const struct options *o) { return 60.0 * o->minutes * o->farm.jobs / 80.0; }

static int choose_window(const struct options *o, struct work *w) {
    int code = EXIT_GOOD;
    if (o->length == 0.0) code = window_find(&o->scene, share(o), &w->window);
    if (code != EXIT_GOOD || o->farm.quiet) return code;
    printf("%s: %s, %g s of it with a frame every %g s\n", o->scene.scene,
           w->window.whole ? "all of the scene" : "the beginning of the scene alone",
           w->window.length, w->window.interval);
    if (o->length == 0.0 && !w->window.whole)
        printf("(--window %g takes the same again; --minutes says how long all may take)\n",
               w->window.length);
    fflush(stdout);
    return code;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Overrides of the user, of the window and of a setting; all texts belong to others. */
static bool make_run(const struct options *o, const struct work *w, const struct setting *setting,
                     struct farm_run *run) {
    int n = o->scene.sets;
    run->sets = n + 2 + setting->sets;
    run->set = calloc((size_t)run->sets, sizeof *run->set);
    if (!run->set) return false;
    for (int k = 0; k < n; k++) run->set[k] = (char *)o->scene.set[k];
    for (int k = 0; k < 2; k++) run->set[n + k] = (char *)w->window.sets[k];
    for (int k = 0; k < setting->sets; k++) run->set[n + 2 + k] = setting->set[k];
    run->frames = true;
    return true;
}

static int run_some(struct options *o, struct farm_run *run, long count) {
    o->farm.run = run, o->farm.count = count;
    int code = farm_survey(&o->farm);
    return code == EXIT_GOOD ? farm_work(&o->farm) : code;
}

/* Half the length of the steps, and again, as long as the next is not too dear. */
static int run_references(struct options *o, struct work *w) {
    for (int k = 0; k < PLAN_REFERENCES; k++)
        if (!make_run(o, w, &w->plan.reference[k], &w->reference[k])) return report_no_memory();
    int code = run_some(o, w->reference, w->references = 2);
    while (code == EXIT_GOOD && w->references < PLAN_REFERENCES) {
        char path[FARM_PATH];
        if (!farm_path(path, &o->farm, &w->reference[w->references - 1], "")) return EXIT_FAILED;
        json_t *result = result_read(path);
        double last = json_number_value(json_object_get(result, "cpu_s"));
        json_decref(result);
        if (!result || 2.0 * last > 10.0 * share(o)) break;
        code = run_some(o, w->reference, ++w->references);
    }
    return code;
}

static int run_all(struct options *o, struct work *w) {
    w->run = calloc((size_t)w->plan.count, sizeof *w->run);
    if (!w->run) return report_no_memory();
    for (int k = 0; k < w->plan.count; k++) {
        if (!make_run(o, w, &w->plan.setting[k], &w->run[k])) return report_no_memory();
        w->run[k].limit_s = fmax(5.0, 5.0 * share(o));
    }
    return run_some(o, w->run, w->plan.count);
}

/* Those of the front once more, without frames and one at a time: the shorter time counts. */
static int run_again(struct options *o, struct work *w) {
    struct farm again = o->farm;
    again.jobs = 1, again.count = 0;
    again.run = calloc((size_t)w->trade.count, sizeof *again.run);
    if (!again.run) return report_no_memory();
    for (int k = 0; k < w->trade.count; k++) {
        if (!w->trade.tried[k].front || w->trade.tried[k].checked) continue;
        again.run[again.count] = w->run[k];
        again.run[again.count++].frames = false;
    }
    int code = farm_survey(&again);
    if (code == EXIT_GOOD && again.count) code = farm_work(&again);
    for (long k = 0, r = 0; k < w->trade.count && code == EXIT_GOOD; k++) {
        struct tried *t = &w->trade.tried[k];
        char path[FARM_PATH];
        if (!t->front || t->checked) continue;
        if (!farm_path(path, &again, &again.run[r++], "")) return EXIT_FAILED;
        json_t *result = result_read(path);
        double ms = result_ms_per_second(result);
        if (ms > 0.0) t->ms = fmin(t->ms, ms / w->trade.per_second);
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
    const char *status = json_string_value(json_object_get(result, "status"));
    bool good = status && !strcmp(status, "good");
    json_decref(result);
    return good;
}

static int read_run(const struct farm *farm, const struct farm_run *run, struct track *track) {
    char path[FARM_PATH];
    if (ended_well(farm, run, path)) return track_read(path, track);
    fprintf(stderr, "projdyn: trade: the reference did not end well: %s/result.json\n", path);
    return EXIT_FAILED;
}

static int judge(const struct options *o, struct work *w, const struct track *reference) {
    struct trade *trade = &w->trade;
    for (int k = 0; k < trade->count; k++) {
        struct tried *t = &trade->tried[k];
        struct track track;
        char path[FARM_PATH];
        t->setting = &w->plan.setting[k];
        if (!ended_well(&o->farm, &w->run[k], path)) continue;
        int code = track_read(path, &track);
        if (code != EXIT_GOOD) return code;
        track_compare(&track, reference, t->error);
        set_worst(t->error);
        t->good = isfinite(t->error[TRADE_WORST]) && track.frames == reference->frames;
        t->ms = track.ms_per_second / trade->per_second;
        t->gained = track.gained / fmax(reference->scale, 1e-300), t->residual = track.residual;
        track_free(&track);
    }
    return EXIT_GOOD;
}

static int judge_all(struct options *o, struct work *w) {
    struct track reference = {0}, coarse = {0};
    w->trade.count = w->plan.count, w->trade.by = o->by;
    w->trade.tried = calloc((size_t)w->plan.count, sizeof *w->trade.tried);
    if (!w->trade.tried) return report_no_memory();
    int code = read_run(&o->farm, &w->reference[w->references - 1], &reference);
    if (code == EXIT_GOOD) code = read_run(&o->farm, &w->reference[w->references - 2], &coarse);
    if (code == EXIT_GOOD) {
        track_compare(&coarse, &reference, w->trade.unsure);
        w->trade.unsure[TRACK_DENSITY] = reference.density;
        set_worst(w->trade.unsure);
        code = judge(o, w, &reference);
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
static int find_front(struct options *o, struct work *w) {
    int code = EXIT_GOOD;
    for (bool open = true; open && code == EXIT_GOOD;) {
        join_times(&w->trade);
        front_find(&w->trade);
        open = false;
        for (int k = 0; k < w->trade.count; k++)
            open |= w->trade.tried[k].front && !w->trade.tried[k].checked;
        if (open) code = run_again(o, w);
    }
    return code;
}

/* ---- the recommendation ---------------------------------------------------------------------- */

/* The scene with the setting, not with the window. */
static int write_scene(const struct options *o, const struct setting *setting) {
    struct scene_options scene = {.scene = o->scene.scene, .threads = 1, .silent = true};
    pdyn_context *context = NULL;
    json_t *root = NULL;
    bool good = true;
    for (int k = 0; k < o->scene.sets; k++) good &= scene_set(&scene, o->scene.set[k]);
    for (int k = 0; k < setting->sets; k++) good &= scene_set(&scene, setting->set[k]);
    int code = good ? scene_context(&scene, &context) : EXIT_FAILED;
    if (code == EXIT_GOOD) {
        pdyn_status status =
            pdyn_scene_text(context, scene.scene, scene.set, scene.sets, take_text, &root);
        if (status != PDYN_OK) code = report_status(context, status);
        else if (json_dump_file(root, o->write, JSON_INDENT(2) | JSON_REAL_PRECISION(15))) {
            perror(o->write);
            code = EXIT_FAILED;
        } else printf("Written to %s\n", o->write);
    }
    json_decref(root);
    pdyn_destroy(context);
    scene_options_free(&scene);
    return code;
}

static int recommend(const struct options *o, const struct work *w) {
    if (!isfinite(o->error) && !isfinite(o->ms)) return EXIT_GOOD;
    const struct tried *best = front_choose(&w->trade, o->error, o->ms, !isfinite(o->error));
    fflush(stdout);
    if (!best) {
        fprintf(stderr, "projdyn: trade: nothing that was tried holds that\n");
        return EXIT_FAILED;
    }
    printf("\nRecommended: %s\n  %.4g ms a frame (%.4g s per simulated second), error %.4f %%\n ",
           best->setting->name, best->ms, 1e-3 * best->ms * w->trade.per_second,
           100.0 * best->error[o->by]);
    for (int k = 0; k < best->setting->sets; k++) printf(" --set %s", best->setting->set[k]);
    putchar('\n');
    return o->write ? write_scene(o, best->setting) : EXIT_GOOD;
}

static int trade(struct options *o, struct work *w) {
    char solver[64];
    int code = read_scene(o, solver, w);
    if (code == EXIT_GOOD) code = choose_window(o, w);
    if (code == EXIT_GOOD && !plan_make(&w->plan, w->scene, solver)) code = report_no_memory();
    if (code == EXIT_GOOD) code = run_references(o, w);
    if (code == EXIT_GOOD) code = run_all(o, w);
    if (code == EXIT_GOOD) code = judge_all(o, w);
    if (code == EXIT_GOOD) code = find_front(o, w);
    if (code != EXIT_GOOD) return code;
    front_print(&w->trade, stdout);
    code = front_write(&w->trade, o->farm.output);
    return code == EXIT_GOOD ? recommend(o, w) : code;
}

int trade_main(int argc, char **argv) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    struct options o = {.error = INFINITY,
                        .ms = INFINITY,
                        .minutes = 25.0,
                        .by = TRADE_WORST,
                        .farm = {.threads = 1, .jobs = cores > 1 ? (int)cores : 1}};
    struct work w = {0};
    int code = parse(&o, argc, argv);
    if (code < 0) code = trade(&o, &w);
    for (int k = 0; w.run && k < w.plan.count; k++) free(w.run[k].set);
    for (int k = 0; k < PLAN_REFERENCES; k++) free(w.reference[k].set);
    free(w.run);
    free(w.trade.tried);
    plan_free(&w.plan);
    json_decref(w.scene);
    scene_options_free(&o.scene);
    scene_options_free(&o.farm.scene);
    free(o.output);
    return code;
}
