/* projdyn compare: times the same steps with several solvers and prints which one is fastest, by
 * which factor, and after how many steps. */
#include "solver_benchmark.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: projdyn compare SCENE --solver NAME,NAME,... [OPTIONS]\n"
    "\n"
    "Runs the same steps from the same initial state with each solver, alternating in one "
    "process,\n"
    "and prints which solver is fastest, by which factor, and after how many steps it has made up\n"
    "for a longer preparation. The time of a step is its minimum over all rounds.\n"
    "\n"
    "      --solver A,B,...  solvers (see 'projdyn list')\n"
    "      --set PATH=VALUE  overrides a value of the scene\n"
    "      --plugin FILE     loads a plug-in before the scene\n"
    "      --allow-plugins   loads the plug-ins that the scene names\n"
    "      --steps N         number of steps (default 20)\n"
    "      --rounds N        number of repetitions (default 4)\n"
    "      --threads N       worker threads (default 1); times are processor times with one\n"
    "                        thread, wall times with more\n"
    "      --csv             prints one CSV row per solver instead of the table\n"
    "  -h, --help            prints this text\n";

struct compare {
    struct solver_benchmark benchmark;
    char *solvers; /* argument of --solver, cut into names */
    bool csv;
};

/* ---- arguments ------------------------------------------------------------------------------- */

/* Parses a list A,B,... of solver names; false if memory ran out. */
static bool parse_solvers(struct compare *c, const char *text) {
    int count = 1;
    for (const char *at = text; *at; at++) count += *at == ',';
    free(c->solvers), free(c->benchmark.solver);
    c->solvers = strdup(text);
    c->benchmark.solver = calloc((size_t)count, sizeof *c->benchmark.solver);
    c->benchmark.solvers = 0;
    if (!c->solvers || !c->benchmark.solver) return false;
    char *rest = c->solvers;
    for (char *name; (name = strsep(&rest, ","));)
        c->benchmark.solver[c->benchmark.solvers++].solver = name;
    return true;
}

static bool accept_option(void *self, int option) {
    struct compare *c = self;
    switch (option) {
    case 'o':
        return parse_solvers(c, optarg);
    case 'n':
        return parse_integer("--steps", optarg, 1, 1000000, &c->benchmark.steps);
    case 'r':
        return parse_integer("--rounds", optarg, 1, 1000000, &c->benchmark.rounds);
    case 'c':
        return c->csv = true;
    default:
        return scene_accept_option(&c->benchmark.scene, option);
    }
}

/* Parses the command line. Returns -1 if the benchmark can start, otherwise the exit code. */
static int parse(struct compare *c, int argc, char **argv) {
    static const struct option long_options[] = {{"solver", required_argument, NULL, 'o'},
                                                 {"steps", required_argument, NULL, 'n'},
                                                 {"rounds", required_argument, NULL, 'r'},
                                                 {"csv", no_argument, NULL, 'c'},
                                                 SCENE_OPTIONS,
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    int code = parse_options(argc, argv, "h", long_options, usage, accept_option, c);
    if (code >= 0) return code;
    if (argc - optind != 1 || c->benchmark.solvers < 2)
        return report_usage(argv, "one scene file and two solvers or more", usage);
    c->benchmark.scene.scene = argv[optind];
    return -1;
}

/* ---- output ---------------------------------------------------------------------------------- */

/* Prints a row per solver; row: the printf format of the columns of --csv, or of the first ones. */
static void print_rows(const struct solver_benchmark *benchmark, const char *header,
                       const char *row) {
    const struct solver_timing *first = benchmark->solver;
    printf("%s", header);
    for (int k = 0; k < benchmark->solvers; k++) {
        const struct solver_timing *timing = &first[k];
        const struct step_cost mean = benchmark_iterations(benchmark, timing);
        printf(row, timing->solver, benchmark_prepare_ms(benchmark, timing),
               benchmark_step_ms(benchmark, timing), mean.outer, mean.linear,
               timing->residual / benchmark->steps, 1e-6 * timing->bytes,
               benchmark_difference(timing, first), benchmark_break_even(benchmark, timing, first),
               timing->unsolved);
    }
}

static bool all_are_unsolved(const struct solver_benchmark *benchmark) {
    for (int k = 0; k < benchmark->solvers; k++)
        if (benchmark->solver[k].unsolved < benchmark->steps) return false;
    return true;
}

/* Times of steps that did not reach the tolerance compare unequal work, or the same number of outer
 * iterations. */
static void print_unsolved(const struct solver_benchmark *benchmark) {
    if (all_are_unsolved(benchmark)) {
        puts("every step takes all of its `outer_iterations`: compare residuals, too");
        return;
    }
    for (int k = 0; k < benchmark->solvers; k++) {
        const struct solver_timing *timing = &benchmark->solver[k];
        if (timing->unsolved)
            printf("%ld of %d steps with %s are unsolved: compare residuals, too, or give "
                   "`outer_iterations` or a tolerance that it reaches\n",
                   timing->unsolved, benchmark->steps, timing->solver);
    }
}

static const struct solver_timing *find_fastest(const struct solver_benchmark *benchmark) {
    const struct solver_timing *best = benchmark->solver;
    for (int k = 1; k < benchmark->solvers; k++)
        if (benchmark_step_ms(benchmark, &benchmark->solver[k]) <
            benchmark_step_ms(benchmark, best))
            best = &benchmark->solver[k];
    return best;
}

/* Compares the fastest solver (mean step time) with every other one. */
static void print_ranking(const struct solver_benchmark *benchmark) {
    const struct solver_timing *best = find_fastest(benchmark);
    for (int k = 0; k < benchmark->solvers; k++) {
        const struct solver_timing *other = &benchmark->solver[k];
        if (other == best) continue;
        double ratio = benchmark_step_ms(benchmark, other) / benchmark_step_ms(benchmark, best);
        double after = benchmark_break_even(benchmark, best, other);
        printf("a step with %s is %.2f times as fast as with %s", best->solver, ratio,
               other->solver);
        if (after < 1.0) printf("; break-even at the first step\n");
        else if (isfinite(after)) printf("; break-even after %.0f steps\n", after);
        else printf("; no break-even: %s takes longer to prepare\n", best->solver);
    }
}

/* Which solver "auto" is; beside cloth, steps may change to another one. */
static void print_chosen(const struct solver_benchmark *benchmark) {
    for (int k = 0; k < benchmark->solvers; k++) {
        const struct solver_timing *timing = &benchmark->solver[k];
        if (strcmp(timing->solver, timing->chosen))
            printf("%s begins with %s\n", timing->solver, timing->chosen);
    }
}

static void print_table(const struct solver_benchmark *benchmark) {
    printf("%s: %d step%s with integrator %s, %d round%s, %s\n\n", benchmark->scene.scene,
           benchmark->steps, benchmark->steps == 1 ? "" : "s", benchmark->solver->integrator,
           benchmark->rounds, benchmark->rounds == 1 ? "" : "s",
           benchmark->scene.threads == 1 ? "one thread, processor time in ms" : "wall time in ms");
    print_rows(
        benchmark,
        "solver        prepare     ms/step  outer  linear   residual   memory MB  difference\n",
        "%-10s %10.2f  %10.3f %6.1f %7.1f   %8.2e  %10.1f    %8.2e\n");
    putchar('\n');
    print_chosen(benchmark);
    print_unsolved(benchmark);
    print_ranking(benchmark);
}

int compare_main(int argc, char **argv) {
    struct compare c = {.benchmark = {.steps = 20, .rounds = 4, .scene.threads = 1}};
    int code = parse(&c, argc, argv);
    if (code < 0) {
        code = benchmark_run(&c.benchmark);
        if (code == EXIT_GOOD && c.csv)
            print_rows(&c.benchmark,
                       "solver,prepare_ms,ms_per_step,outer_iterations,linear_iterations,"
                       "step_residual,memory_mb,difference,catches_up,unsolved_steps\n",
                       "%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%ld\n");
        else if (code == EXIT_GOOD) print_table(&c.benchmark);
    }
    benchmark_free(&c.benchmark);
    scene_options_free(&c.benchmark.scene);
    free(c.solvers);
    return code;
}
