/* projdyn trade: many settings of a scene against a converged reference of it; which are worth
 * their time, and which hold an error or fit into a time. */
#include "advice.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn trade SCENE [OPTIONS]\n"
    "\n"
    "Runs a scene with many settings and says what their time buys: errors against a reference\n"
    "with steps of an eighth of the length or less, solved. Prints those that nothing beats,\n"
    "writes all to DIR/trade.csv and draws them. Runs that have ended are kept.\n"
    "\n"
    "      --error E         recommends the cheapest with an error up to E, 0.001 or 0.1%\n"
    "      --budget T        recommends the most accurate that takes up to T a frame, 33ms, 0.1s\n"
    "      --by NAME         the error that counts: density, cloth, front, profile, energy, or\n"
    "                        all, the largest of them (default)\n"
    "      --write SCENE2    writes the scene with the recommended settings\n"
    "      --minutes M       about as long may it take (default 25): a scene that takes longer is\n"
    "                        tried on a coarser twin, or on its beginning\n"
    "      --window S        tries S seconds from the start\n"
    "      --twin F          tries a twin F times as coarse; 1: none\n"
    "      --set PATH=VALUE  overrides a value of the scene\n"
    "  -o, --output DIR      where to write (default out/trade-NAME of the scene)\n"
    "      --jobs N          runs at a time (default: cores), each with one thread\n"
    "      --plugin FILE     loads a plug-in before the scene\n"
    "      --quiet           no progress\n"
    "  -h, --help            this text\n";

struct options {
    struct scene_options scene; /* with its overrides */
    struct study study;
    struct wish wish;
    double minutes;
    char *output; /* where none was given */
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
    for (o->study.trade.by = 0; o->study.trade.by < TRACK_MEASURES; o->study.trade.by++)
        if (!strcmp(text, track_names[o->study.trade.by])) return true;
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
        return parse_quantity("--error", optarg, parts, "a part like 0.001 or 0.1%",
                              &o->wish.error);
    case 'b':
        return parse_quantity("--budget", optarg, times, "a time like 33ms or 0.1s", &o->wish.ms);
    case 'm':
        return parse_quantity("--minutes", optarg, plain, "minutes above 0", &o->minutes);
    case 'W':
        return parse_quantity("--window", optarg, plain, "seconds above 0", &o->study.length);
    case 't':
        return parse_quantity("--twin", optarg, plain, "a factor above 0",
                              &o->study.extent.coarser);
    case 'j':
        if (!parse_quantity("--jobs", optarg, plain, "a number of runs", &jobs)) return false;
        return o->study.farm.jobs = (int)fmin(1024.0, fmax(1.0, jobs)), true;
    case 'y':
        return parse_measure(o, optarg);
    case 'w':
        return o->wish.write = optarg, true;
    case 'o':
        return o->study.farm.output = optarg, true;
    case 's':
        return scene_set(&o->scene, optarg);
    case 'P':
        return scene_plugin(&o->scene, optarg) && scene_plugin(&o->study.farm.scene, optarg);
    case 'q':
        return o->study.farm.quiet = true;
    default:
        return false;
    }
}

/* -1: go on; otherwise the exit code. */
static int parse(struct options *o, int argc, char **argv) {
    static const struct option long_options[] = {
        {"error", required_argument, NULL, 'e'},   {"budget", required_argument, NULL, 'b'},
        {"by", required_argument, NULL, 'y'},      {"write", required_argument, NULL, 'w'},
        {"minutes", required_argument, NULL, 'm'}, {"window", required_argument, NULL, 'W'},
        {"twin", required_argument, NULL, 't'},    {"set", required_argument, NULL, 's'},
        {"output", required_argument, NULL, 'o'},  {"jobs", required_argument, NULL, 'j'},
        {"plugin", required_argument, NULL, 'P'},  {"quiet", no_argument, NULL, 'q'},
        {"help", no_argument, NULL, 'h'},          {0}};
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
    if (o->wish.write && !isfinite(o->wish.error) && !isfinite(o->wish.ms)) {
        fprintf(stderr, "projdyn: --write: expected --error or --budget, too\n");
        return EXIT_BAD_INPUT;
    }
    o->scene.scene = o->study.farm.scene.scene = argv[optind];
    if (!o->study.farm.output)
        o->study.farm.output = o->output = default_output("trade-", argv[optind]);
    return o->study.farm.output ? -1 : EXIT_FAILED;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static int trade(struct study *study, const struct wish *wish) {
    int code = study_do(study);
    if (code != EXIT_GOOD) return code;
    front_print(&study->trade, stdout);
    code = front_write(&study->trade, study->farm.output);
    bool wished = isfinite(wish->error) || isfinite(wish->ms);
    return code == EXIT_GOOD && wished ? advise(study, wish) : code;
}

int trade_main(int argc, char **argv) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    struct options o = {.wish = {.error = INFINITY, .ms = INFINITY},
                        .minutes = 25.0,
                        .study = {.trade.by = TRADE_WORST,
                                  .farm = {.threads = 1, .jobs = cores > 1 ? (int)cores : 1}}};
    int code = parse(&o, argc, argv);
    /* All settings and references take about as long as eighty runs; one run after the other, those
     * of the front as ten, one of the scene itself as eight. */
    o.study.share = 60.0 * o.minutes * o.study.farm.jobs / 100.0;
    o.study.extent.user = &o.scene;
    if (code < 0) code = trade(&o.study, &o.wish);
    study_free(&o.study);
    scene_options_free(&o.scene);
    scene_options_free(&o.study.farm.scene);
    free(o.output);
    return code;
}
