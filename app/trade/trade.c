/* projdyn trade: runs a scene with many settings, measures processor time and error against a
 * converged reference, prints the Pareto front and recommends a setting for a limit of error or
 * time. */
#include "pareto.h"
#include "recommendation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: projdyn trade SCENE [OPTIONS]\n"
    "\n"
    "Runs a scene with many solver and time-step settings and measures for each its processor\n"
    "time and its error against a reference run (steps of 1/8 of the scene's length or less,\n"
    "solved to a small residual). Prints the Pareto front, writes all settings to DIR/trade.csv\n"
    "and plots them. Finished runs are not repeated.\n"
    "\n"
    "      --error E         recommends the fastest setting with an error up to E, e.g. 0.001 or\n"
    "                        0.1%\n"
    "      --budget T        recommends the most accurate setting that takes up to T of processor\n"
    "                        time per frame, e.g. 33ms or 0.1s\n"
    "      --by NAME         error to use: density, cloth, front, profile, energy, gained, or "
    "all,\n"
    "                        the maximum of them (default)\n"
    "      --write SCENE2    writes the scene with the recommended setting\n"
    "      --minutes M       approximate total time (default 25); if the scene takes longer, a\n"
    "                        coarse replica of it or its first seconds are run instead\n"
    "      --window S        runs the first S seconds of the scene\n"
    "      --twin F          runs a replica with F times the spacing of particles and vertices;\n"
    "                        1: no replica\n"
    "      --set PATH=VALUE  overrides a value of the scene\n"
    "  -o, --output DIR      output directory (default out/trade-NAME for NAME.json)\n"
    "      --jobs N          number of parallel runs (default: one per core), one thread each\n"
    "      --plugin FILE     loads a plug-in before the scene\n"
    "      --allow-plugins   loads the plug-ins that the scene names\n"
    "      --quiet           prints no progress\n"
    "  -h, --help            prints this text\n";

struct options {
    struct scene_options scene; /* the scene with the user's overrides */
    struct study study;
    struct target target;
    double minutes;
    char *output; /* owned output path if --output is absent */
};

/* ---- arguments ------------------------------------------------------------------------------- */

/* A unit of a quantity and its factor to the base unit; a list ends with a NULL name. */
struct unit {
    const char *name; /* "": no unit */
    double factor;
};

static const struct unit fractions[] = {{"", 1}, {"%", 0.01}, {0}};
static const struct unit times[] = {{"ms", 1}, {"s", 1000}, {0}};
static const struct unit no_unit[] = {{"", 1}, {0}};

/* Parses a positive number with one of the units; false with a message otherwise. expected: text
 * for the message. */
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

/* Parses the argument of --error; false with a message if it is no error that a setting may have.
 */
static bool parse_error(struct options *o, const char *text) {
    const char *expected = "a fraction below 1 (100%) like 0.001 or 0.1%";
    double error;
    if (!parse_quantity("--error", text, fractions, expected, &error)) return false;
    if (error < 1.0) return o->target.max_error = error, true;
    fprintf(
        stderr,
        "projdyn: --error: found \"%s\", expected %s: a larger error has nothing in common with "
        "the reference\n",
        text, expected);
    return false;
}

/* Parses the argument of --by; false with a message if it is no name of an error. */
static bool parse_metric(struct options *o, const char *text) {
    for (o->study.table.metric = 0; o->study.table.metric < RUN_METRICS_COUNT;
         o->study.table.metric++)
        if (!strcmp(text, run_metric_names[o->study.table.metric])) return true;
    if (!strcmp(text, "all")) return true; /* the loop has ended at TRIAL_MAX_ERROR */
    fprintf(stderr,
            "projdyn: --by: found \"%s\", expected density, cloth, front, profile, energy, "
            "gained or all\n",
            text);
    return false;
}

static bool accept_option(void *self, int option) {
    struct options *o = self;
    double processes;
    switch (option) {
    case 'e':
        return parse_error(o, optarg);
    case 'b':
        return parse_quantity("--budget", optarg, times, "a time like 33ms or 0.1s",
                              &o->target.max_ms);
    case 'm':
        return parse_quantity("--minutes", optarg, no_unit, "minutes above 0", &o->minutes);
    case 'W':
        return parse_quantity("--window", optarg, no_unit, "seconds above 0", &o->study.length);
    case 't':
        return parse_quantity("--twin", optarg, no_unit, "a factor above 0",
                              &o->study.scope.coarsening);
    case 'j':
        if (!parse_quantity("--jobs", optarg, no_unit, "a number of runs", &processes))
            return false;
        return o->study.jobs.processes = (int)fmin(1024.0, fmax(1.0, processes)), true;
    case 'y':
        return parse_metric(o, optarg);
    case 'w':
        return o->target.write = optarg, true;
    case 'o':
        return o->study.jobs.output = optarg, true;
    case 'q':
        return o->study.jobs.quiet = true;
    default:
        return scene_accept_option(&o->scene, option);
    }
}

/* Parses the command line. Returns -1 if the study can start, otherwise the exit code. */
static int parse(struct options *o, int argc, char **argv) {
    static const struct option long_options[] = {{"error", required_argument, NULL, 'e'},
                                                 {"budget", required_argument, NULL, 'b'},
                                                 {"by", required_argument, NULL, 'y'},
                                                 {"write", required_argument, NULL, 'w'},
                                                 {"minutes", required_argument, NULL, 'm'},
                                                 {"window", required_argument, NULL, 'W'},
                                                 {"twin", required_argument, NULL, 't'},
                                                 {"set", required_argument, NULL, 's'},
                                                 {"output", required_argument, NULL, 'o'},
                                                 {"jobs", required_argument, NULL, 'j'},
                                                 {"allow-plugins", no_argument, NULL, 'A'},
                                                 {"plugin", required_argument, NULL, 'P'},
                                                 {"quiet", no_argument, NULL, 'q'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    int code = parse_options(argc, argv, "o:h", long_options, usage, accept_option, o);
    if (code >= 0) return code;
    if (argc - optind != 1) return report_usage(argv, "one scene file", usage);
    if (o->target.write && !isfinite(o->target.max_error) && !isfinite(o->target.max_ms)) {
        fprintf(stderr, "projdyn: --write: expected --error or --budget as well\n");
        return EXIT_BAD_INPUT;
    }
    o->scene.scene = argv[optind];
    o->study.jobs.scene = o->scene;
    if (!o->study.jobs.output)
        o->study.jobs.output = o->output = default_output("trade-", argv[optind]);
    return o->study.jobs.output ? -1 : EXIT_FAILED;
}

/* ---- the command ----------------------------------------------------------------------------- */

static int trade(struct study *study, const struct target *target) {
    int code = study_run(study);
    if (code != EXIT_GOOD) return code;
    pareto_print(&study->table, stdout);
    code = pareto_write(&study->table, study->jobs.output);
    bool has_target = isfinite(target->max_error) || isfinite(target->max_ms);
    return code == EXIT_GOOD && has_target ? recommend(study, target) : code;
}

int trade_main(int argc, char **argv) {
    struct options o = {.target = {.max_error = INFINITY, .max_ms = INFINITY},
                        .minutes = 25.0,
                        .study = {.table.metric = TRIAL_MAX_ERROR,
                                  .jobs = {.threads = 1, .processes = usable_cores()}}};
    int code = parse(&o, argc, argv);
    /* Total time in units of one run: 80 for all settings and references, in parallel; 10 for the
     * second runs of the Pareto front and 8 for runs on the scene itself, one after the other. */
    o.study.run_budget_s = 60.0 * o.minutes * o.study.jobs.processes / 100.0;
    o.study.scope.user = &o.scene;
    if (code < 0) code = trade(&o.study, &o.target);
    study_free(&o.study);
    scene_options_free(&o.scene);
    free(o.output);
    return code;
}
