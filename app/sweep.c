/* projdyn sweep: a scene with every choice of some settings, in parallel processes; one table. */
#include "app.h"
#include "choices.h"
#include "farm.h"
#include "table.h"

#include <getopt.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn sweep SCENE --set PATH=VALUE,VALUE,... [--set ...] [OPTIONS]\n"
    "\n"
    "Runs a scene with every choice of the values, several at a time, and gathers them in one\n"
    "table, DIR/sweep.csv. Runs that have ended, well or not, are kept: the same command goes on\n"
    "where it was stopped. To have one again, remove its directory.\n"
    "\n"
    "      --set PATH=V,V,...  values of a setting; commas within [], {} and \"\" do not count\n"
    "  -o, --output DIR        where to write (default out/sweep-NAME of the scene)\n"
    "      --jobs N            runs at a time (default: cores over threads)\n"
    "      --threads N         worker threads of each (default 1)\n"
    "      --plugin FILE       loads a plug-in before the scene\n"
    "      --frames            writes the frames of all runs\n"
    "      --print             runs nothing; prints one command for each run, for GNU parallel or\n"
    "                          an array of Slurm; then --collect\n"
    "      --point K           runs that one, from 0, and writes no table\n"
    "      --collect           runs nothing; gathers what has ended\n"
    "      --quiet             no progress\n"
    "  -h, --help              this text\n";

struct sweep {
    struct farm farm;
    struct choices choices;
    char *output; /* if none was given */
    long point;   /* -1: all */
    bool frames, print, collect;
};

/* ---- arguments ------------------------------------------------------------------------------- */

static bool accept_option(struct sweep *s, int option) {
    long number = 0;
    bool good = true;
    switch (option) {
    case 's':
        return choices_add(&s->choices, optarg);
    case 'P':
        return scene_plugin(&s->farm.scene, optarg);
    case 'o':
        return s->farm.output = optarg, true;
    case 'j':
        good = parse_whole("--jobs", optarg, 1, 1024, &number);
        return s->farm.jobs = (int)number, good;
    case 't':
        good = parse_whole("--threads", optarg, 1, 1024, &number);
        return s->farm.threads = (int)number, good;
    case 'k':
        return parse_whole("--point", optarg, 0, CHOICES_MOST - 1, &s->point);
    case 'f':
        return s->frames = true;
    case 'p':
        return s->print = true;
    case 'c':
        return s->collect = true;
    case 'q':
        return s->farm.quiet = true;
    default:
        return false;
    }
}

static int complete(struct sweep *s) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN), count = choices_count(&s->choices);
    if (count > CHOICES_MOST) {
        fprintf(stderr, "projdyn: sweep: expected at most %d runs\n", CHOICES_MOST);
        return EXIT_BAD_INPUT;
    }
    if (s->point >= count) {
        fprintf(stderr, "projdyn: --point: found %ld, expected at most %ld\n", s->point, count - 1);
        return EXIT_BAD_INPUT;
    }
    if (!s->farm.jobs) s->farm.jobs = cores > s->farm.threads ? (int)cores / s->farm.threads : 1;
    if (!s->farm.output) s->farm.output = s->output = default_output("sweep-", s->farm.scene.scene);
    return s->farm.output ? -1 : EXIT_FAILED;
}

/* -1: go on; otherwise the exit code. */
static int parse(struct sweep *s, int argc, char **argv) {
    static const struct option long_options[] = {
        {"set", required_argument, NULL, 's'},   {"output", required_argument, NULL, 'o'},
        {"jobs", required_argument, NULL, 'j'},  {"threads", required_argument, NULL, 't'},
        {"point", required_argument, NULL, 'k'}, {"frames", no_argument, NULL, 'f'},
        {"print", no_argument, NULL, 'p'},       {"collect", no_argument, NULL, 'c'},
        {"quiet", no_argument, NULL, 'q'},       {"plugin", required_argument, NULL, 'P'},
        {"help", no_argument, NULL, 'h'},        {0}};
    int option;
    while ((option = getopt_long(argc, argv, "o:h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (!accept_option(s, option)) return EXIT_BAD_INPUT;
    }
    if (argc - optind != 1 || !s->choices.axes) {
        fprintf(stderr, "projdyn: sweep: expected one scene file and at least one --set\n\n%s",
                usage);
        return EXIT_BAD_INPUT;
    }
    s->farm.scene.scene = argv[optind];
    return complete(s);
}

/* ---- commands for other machines ------------------------------------------------------------- */

/* As a shell reads it. */
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

static int print_commands(const struct sweep *s) {
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    for (long k = 0; k < s->farm.count; k++) {
        print_quoted(length > 0 ? program : "projdyn");
        printf(" sweep");
        print_argument("", s->farm.scene.scene);
        for (int a = 0; a < s->choices.axes; a++) {
            printf(" --set ");
            print_quoted(s->choices.axis[a].path);
            putchar('=');
            for (int v = 0; v < s->choices.axis[a].count; v++) {
                if (v) putchar(',');
                print_quoted(s->choices.axis[a].value[v]);
            }
        }
        for (int p = 0; p < s->farm.scene.plugins; p++)
            print_argument("--plugin", s->farm.scene.plugin[p]);
        print_argument("--output", s->farm.output);
        printf("%s --threads %d --point %ld\n", s->frames ? " --frames" : "", s->farm.threads, k);
    }
    return EXIT_GOOD;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bool make_runs(struct sweep *s) {
    long first = s->point < 0 ? 0 : s->point;
    s->farm.count = s->point < 0 ? choices_count(&s->choices) : 1;
    s->farm.run = calloc((size_t)s->farm.count, sizeof *s->farm.run);
    for (long k = 0; s->farm.run && k < s->farm.count; k++) {
        struct farm_run *run = &s->farm.run[k];
        *run =
            (struct farm_run){.set = choices_settings(&s->choices, first + k), .frames = s->frames};
        if (!run->set) return false;
        run->sets = s->choices.axes;
    }
    return s->farm.run;
}

static int sweep(struct sweep *s) {
    if (!make_runs(s)) return report_no_memory();
    int code = farm_survey(&s->farm);
    if (code != EXIT_GOOD || s->print) return code == EXIT_GOOD ? print_commands(s) : code;
    if (!s->collect) code = farm_work(&s->farm);
    return code == EXIT_GOOD && s->point < 0 ? table_write(&s->farm, &s->choices) : code;
}

int sweep_main(int argc, char **argv) {
    struct sweep s = {.farm.threads = 1, .point = -1};
    int code = parse(&s, argc, argv);
    if (code < 0) code = sweep(&s);
    for (long k = 0; s.farm.run && k < s.farm.count; k++)
        settings_free(s.farm.run[k].set, s.farm.run[k].sets);
    free(s.farm.run);
    scene_options_free(&s.farm.scene);
    free(s.output);
    choices_free(&s.choices);
    return code;
}
