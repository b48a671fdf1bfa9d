/* projdyn compare: the same steps by several solvers; which is faster, by how much, from when on.
 */
#include "app.h"
#include "contest.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: projdyn compare SCENE --solver NAME,NAME,... [OPTIONS]\n"
    "\n"
    "Takes the same steps from the same start with each solver, in turn in one process, and says\n"
    "which is faster, by how much, and after how many steps it has paid for its preparation. "
    "Times\n"
    "are the least of all rounds, for each step.\n"
    "\n"
    "      --solver A,B,...  solvers ('projdyn list')\n"
    "      --set PATH=VALUE  overrides a value of the scene\n"
    "      --plugin FILE     loads a plug-in before the scene\n"
    "      --steps N         steps (default 20)\n"
    "      --rounds N        times that each takes them (default 4)\n"
    "      --threads N       worker threads (default 1: processor time is measured; else wall "
    "time)\n"
    "      --csv             prints a row of CSV for each instead\n"
    "  -h, --help            this text\n";

struct compare {
    struct contest contest;
    char *solvers;
    bool csv;
};

/* ---- arguments ------------------------------------------------------------------------------- */

static bool parse_count(const char *option, const char *text, int *out) {
    long number;
    if (!parse_whole(option, text, 1, 1000000, &number)) return false;
    *out = (int)number;
    return true;
}

static bool parse_solvers(struct compare *c, const char *text) {
    int count = 1;
    for (const char *at = text; *at; at++) count += *at == ',';
    free(c->solvers), free(c->contest.contender);
    c->solvers = strdup(text);
    c->contest.contender = calloc((size_t)count, sizeof *c->contest.contender);
    c->contest.contenders = 0;
    if (!c->solvers || !c->contest.contender) return false;
    char *rest = c->solvers;
    for (char *name; (name = strsep(&rest, ","));)
        c->contest.contender[c->contest.contenders++].solver = name;
    return true;
}

static bool accept_option(struct compare *c, int option) {
    switch (option) {
    case 'o':
        return parse_solvers(c, optarg);
    case 's':
        return scene_set(&c->contest.scene, optarg);
    case 'P':
        return scene_plugin(&c->contest.scene, optarg);
    case 'n':
        return parse_count("--steps", optarg, &c->contest.steps);
    case 'r':
        return parse_count("--rounds", optarg, &c->contest.rounds);
    case 't':
        return scene_threads(&c->contest.scene, optarg);
    case 'c':
        return c->csv = true;
    default:
        return false;
    }
}

/* -1: go on; otherwise the exit code. */
static int parse(struct compare *c, int argc, char **argv) {
    static const struct option long_options[] = {{"solver", required_argument, NULL, 'o'},
                                                 {"set", required_argument, NULL, 's'},
                                                 {"steps", required_argument, NULL, 'n'},
                                                 {"rounds", required_argument, NULL, 'r'},
                                                 {"threads", required_argument, NULL, 't'},
                                                 {"csv", no_argument, NULL, 'c'},
                                                 {"plugin", required_argument, NULL, 'P'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    int option;
    while ((option = getopt_long(argc, argv, "h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (!accept_option(c, option)) return EXIT_BAD_INPUT;
    }
    if (argc - optind != 1 || c->contest.contenders < 2) {
        fprintf(stderr, "projdyn: compare: expected one scene file and two solvers or more\n\n%s",
                usage);
        return EXIT_BAD_INPUT;
    }
    c->contest.scene.scene = argv[optind];
    return -1;
}

/* ---- what is printed ------------------------------------------------------------------------- */

static void print_rows(const struct contest *contest, const char *header, const char *row) {
    const struct contender *first = contest->contender;
    printf("%s", header);
    for (int k = 0; k < contest->contenders; k++) {
        const struct contender *c = &first[k];
        double n = contest->steps;
        printf(row, c->solver, contest_prepare_ms(contest, c), contest_step_ms(contest, c),
               c->outer / n, c->linear / n, c->residual / n, 1e-6 * c->bytes,
               contest_difference(c, first), contest_catches_up(contest, c, first));
    }
}

static const struct contender *find_fastest(const struct contest *contest) {
    const struct contender *best = contest->contender;
    for (int k = 1; k < contest->contenders; k++)
        if (contest_step_ms(contest, &contest->contender[k]) < contest_step_ms(contest, best))
            best = &contest->contender[k];
    return best;
}

static void print_verdict(const struct contest *contest) {
    const struct contender *best = find_fastest(contest);
    for (int k = 0; k < contest->contenders; k++) {
        const struct contender *other = &contest->contender[k];
        if (other == best) continue;
        double ratio = contest_step_ms(contest, other) / contest_step_ms(contest, best);
        double after = contest_catches_up(contest, best, other);
        printf("%s is %.2f times as fast a step as %s", best->solver, ratio, other->solver);
        if (after < 1.0) printf(", from the first step on\n");
        else if (isfinite(after)) printf("; it has paid for itself after %.0f steps\n", after);
        else printf("; it does not pay for its preparation in any number of steps\n");
    }
}

static void print_table(const struct contest *contest) {
    printf("%s: %d steps of %s, %d rounds in turn, %s\n\n", contest->scene.scene, contest->steps,
           contest->contender->integrator, contest->rounds,
           contest->scene.threads == 1 ? "one thread, ms of the processor" : "ms of the clock");
    print_rows(
        contest,
        "solver        prepare     ms/step  outer  linear   residual   memory MB  differs by\n",
        "%-10s %10.2f  %10.3f %6.1f %7.1f   %8.2e  %10.1f    %8.2e\n");
    putchar('\n');
    print_verdict(contest);
}

int compare_main(int argc, char **argv) {
    struct compare c = {.contest = {.steps = 20, .rounds = 4, .scene.threads = 1}};
    int code = parse(&c, argc, argv);
    if (code < 0) {
        code = contest_run(&c.contest);
        if (code == EXIT_GOOD && c.csv)
            print_rows(&c.contest,
                       "solver,prepare_ms,ms_per_step,outer_iterations,linear_iterations,"
                       "step_residual,memory_mb,difference,catches_up\n",
                       "%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n");
        else if (code == EXIT_GOOD) print_table(&c.contest);
    }
    contest_free(&c.contest);
    scene_options_free(&c.contest.scene);
    free(c.solvers);
    return code;
}
