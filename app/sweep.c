/* projdyn sweep: runs a scene at every point of a parameter grid, in parallel processes, and
 * collects the results in one table. */
#include "jobs.h"
#include "parameter_grid.h"
#include "sweep_table.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn sweep SCENE --set PATH=VALUE,VALUE,... [--set ...] [OPTIONS]\n"
    "\n"
    "Runs a scene with every combination of the values, several runs in parallel, and writes one\n"
    "table of the results, DIR/sweep.csv. Finished runs, successful or not, are not repeated: the\n"
    "same command continues an interrupted sweep. To repeat a run, remove its directory.\n"
    "\n"
    "      --set PATH=V,V,...  values of a parameter; a comma in [], {} or \"\" is part of a "
    "value\n"
    "      --time S            simulates S seconds instead of the duration of the scene\n"
    "  -o, --output DIR        output directory (default out/sweep-NAME for NAME.json)\n"
    "      --jobs N            number of parallel runs (default: cores / threads)\n"
    "      --threads N         worker threads of each run (default 1)\n"
    "      --plugin FILE       loads a plug-in before the scene\n"
    "      --allow-plugins     loads the plug-ins that the scene names\n"
    "      --frames            writes the frames of all runs\n"
    "      --print             prints one command for each run, for GNU parallel or a Slurm job\n"
    "                          array, instead of running it; afterwards use --collect\n"
    "      --point K           runs only grid point K, counted from 0, and writes no table\n"
    "      --collect           writes the table of the finished runs and runs nothing\n"
    "      --quiet             prints no progress\n"
    "  -h, --help              prints this text\n";

struct sweep {
    struct jobs jobs;
    struct parameter_grid grid;
    char *output; /* owned output path if --output is absent */
    int point;    /* grid point to run; -1: all */
    bool frames, print, collect;
};

/* ---- arguments ------------------------------------------------------------------------------- */

/* The time of all runs is an axis of the grid with one value, so that the table has it. */
static bool accept_time(struct sweep *s, const char *text) {
    double time;
    char number[32], axis[64];
    if (!parse_seconds("--time", text, LONGEST_DURATION, &time)) return false;
    print_shortest(number, time);
    snprintf(axis, sizeof axis, "duration=%s", number);
    return parameter_grid_add(&s->grid, axis);
}

static bool accept_option(void *self, int option) {
    struct sweep *s = self;
    switch (option) {
    case 's':
        return parameter_grid_add(&s->grid, optarg);
    case 'T':
        return accept_time(s, optarg);
    case 'o':
        return s->jobs.output = optarg, true;
    case 'j':
        return parse_integer("--jobs", optarg, 1, 1024, &s->jobs.processes);
    case 't':
        return parse_integer("--threads", optarg, 1, 1024, &s->jobs.threads);
    case 'k':
        return parse_integer("--point", optarg, 0, GRID_MAX_POINTS - 1, &s->point);
    case 'f':
        return s->frames = true;
    case 'p':
        return s->print = true;
    case 'c':
        return s->collect = true;
    case 'q':
        return s->jobs.quiet = true;
    default:
        return scene_accept_option(&s->jobs.scene, option);
    }
}

/* Checks the options against the grid and sets defaults. Returns -1, or an exit code on failure. */
static int complete_options(struct sweep *s) {
    int cores = usable_cores();
    long count = parameter_grid_count(&s->grid);
    if (count > GRID_MAX_POINTS) {
        fprintf(stderr, "projdyn: sweep: expected at most %d grid points\n", GRID_MAX_POINTS);
        return EXIT_BAD_INPUT;
    }
    if (s->point >= count) {
        fprintf(stderr, "projdyn: --point: found %d, expected at most %ld\n", s->point, count - 1);
        return EXIT_BAD_INPUT;
    }
    if (!s->jobs.processes)
        s->jobs.processes = cores > s->jobs.threads ? cores / s->jobs.threads : 1;
    if (!s->jobs.output) s->jobs.output = s->output = default_output("sweep-", s->jobs.scene.scene);
    return s->jobs.output ? -1 : EXIT_FAILED;
}

/* Parses the command line. Returns -1 if the sweep can start, otherwise the exit code. */
static int parse(struct sweep *s, int argc, char **argv) {
    static const struct option long_options[] = {
        {"set", required_argument, NULL, 's'},     {"time", required_argument, NULL, 'T'},
        {"output", required_argument, NULL, 'o'},  {"jobs", required_argument, NULL, 'j'},
        {"threads", required_argument, NULL, 't'}, {"point", required_argument, NULL, 'k'},
        {"frames", no_argument, NULL, 'f'},        {"print", no_argument, NULL, 'p'},
        {"collect", no_argument, NULL, 'c'},       {"quiet", no_argument, NULL, 'q'},
        {"allow-plugins", no_argument, NULL, 'A'}, {"plugin", required_argument, NULL, 'P'},
        {"help", no_argument, NULL, 'h'},          {0}};
    int code = parse_options(argc, argv, "o:h", long_options, usage, accept_option, s);
    if (code >= 0) return code;
    if (argc - optind != 1 || !s->grid.axes)
        return report_usage(argv, "one scene file and at least one --set", usage);
    s->jobs.scene.scene = argv[optind];
    return complete_options(s);
}

/* ---- --print --------------------------------------------------------------------------------- */

/* Prints a text in single quotes for a POSIX shell. */
static void print_quoted(const char *text) {
    putchar('\'');
    for (; *text; text++)
        if (*text == '\'') fputs("'\\''", stdout);
        else putchar(*text);
    putchar('\'');
}

static void print_argument(const char *option, const char *text) {
    printf(" %s ", option);
    print_quoted(text);
}

/* Prints the axes of a grid as --set options of a shell command. */
static void print_grid(const struct parameter_grid *grid) {
    for (int a = 0; a < grid->axes; a++) {
        printf(" --set ");
        print_quoted(grid->axis[a].path);
        putchar('=');
        for (int v = 0; v < grid->axis[a].count; v++) {
            if (v) putchar(',');
            print_quoted(grid->axis[a].value[v]);
        }
    }
}

/* Prints one `projdyn sweep ... --point K` for each grid point. */
static int print_commands(const struct sweep *s) {
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    for (long k = 0; k < s->jobs.count; k++) {
        print_quoted(length > 0 ? program : "projdyn");
        printf(" sweep");
        print_argument("", s->jobs.scene.scene);
        print_grid(&s->grid);
        for (int p = 0; p < s->jobs.scene.plugins; p++)
            print_argument("--plugin", s->jobs.scene.plugin[p]);
        if (scene_plugins_allowed()) printf(" --allow-plugins");
        print_argument("--output", s->jobs.output);
        printf("%s --threads %d --point %ld\n", s->frames ? " --frames" : "", s->jobs.threads, k);
    }
    return EXIT_GOOD;
}

/* ---- the sweep ------------------------------------------------------------------------------- */

/* Makes one job for each grid point to run. false if memory ran out. */
static bool make_jobs(struct sweep *s) {
    long first = s->point < 0 ? 0 : s->point;
    s->jobs.count = s->point < 0 ? parameter_grid_count(&s->grid) : 1;
    s->jobs.job = calloc((size_t)s->jobs.count, sizeof *s->jobs.job);
    for (long k = 0; s->jobs.job && k < s->jobs.count; k++) {
        struct job *job = &s->jobs.job[k];
        *job =
            (struct job){.set = parameter_grid_overrides(&s->grid, first + k), .frames = s->frames};
        if (!job->set) return false;
        job->sets = s->grid.axes;
    }
    return s->jobs.job;
}

/* The first job that is not finished; NULL if there is none. */
static const struct job *first_pending(const struct jobs *jobs) {
    for (long k = 0; k < jobs->count; k++)
        if (jobs->job[k].status == JOB_PENDING) return &jobs->job[k];
    return NULL;
}

/* Loads the scene with the values of a job, so that an error in it or in a path of the grid ends
 * the sweep before every job fails for this reason. Returns EXIT_GOOD, or another exit code after
 * the message of the loader. */
static int check_scene(const struct scene_options *scene, const struct job *job) {
    struct scene_options with_values = *scene;
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    with_values.silent = true;
    with_values.set = (const char **)job->set, with_values.sets = job->sets;
    int code = scene_load(&with_values, &context, &sim);
    pdyn_free(sim);
    pdyn_destroy(context);
    return code;
}

static int sweep(struct sweep *s) {
    if (!make_jobs(s)) return report_no_memory();
    int code = jobs_find_finished(&s->jobs);
    if (code != EXIT_GOOD || s->print) return code == EXIT_GOOD ? print_commands(s) : code;
    const struct job *pending = s->collect ? NULL : first_pending(&s->jobs);
    if (pending) code = check_scene(&s->jobs.scene, pending);
    if (pending && code == EXIT_GOOD) code = jobs_run(&s->jobs);
    return code == EXIT_GOOD && s->point < 0 ? sweep_table_write(&s->jobs, &s->grid) : code;
}

int sweep_main(int argc, char **argv) {
    struct sweep s = {.jobs.threads = 1, .point = -1};
    int code = parse(&s, argc, argv);
    if (code < 0) code = sweep(&s);
    for (long k = 0; s.jobs.job && k < s.jobs.count; k++)
        overrides_free(s.jobs.job[k].set, s.jobs.job[k].sets);
    free(s.jobs.job);
    scene_options_free(&s.jobs.scene);
    free(s.output);
    parameter_grid_free(&s.grid);
    return code;
}
