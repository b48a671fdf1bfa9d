/* projdyn: the command line over libprojdyn. */
#include "app.h"
#include "replay.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const struct command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} commands[] = {
    {"run", run_main, "simulate a scene and write frames, metrics and a report"},
    {"sweep", sweep_main, "simulate a scene with many settings, in parallel; one table"},
    {"compare", compare_main, "the same steps by several solvers: which is faster, from when on"},
    {"trade", trade_main, "what a millisecond buys: many settings against a converged reference"},
    {"check", check_main, "read a scene and say what is in it"},
    {"list", list_main, "constraint types and solvers, their parameters and units"},
    {"replay", replay_main, "pack the frames of a run into one HTML page"},
};

enum { COMMANDS = sizeof commands / sizeof *commands };

static void usage(FILE *out) {
    fprintf(out, "Usage: projdyn COMMAND [OPTIONS]\n\nProjective Dynamics for fluids and cloth in "
                 "one solve.\n\n");
    for (int k = 0; k < COMMANDS; k++)
        fprintf(out, "  %-8s %s\n", commands[k].name, commands[k].summary);
    fprintf(out,
            "\n'projdyn COMMAND --help' tells more; 'projdyn --version' prints the version.\n");
}

/* Whether `edits` letters inserted, removed or changed make one word the other. */
static bool is_near(const char *a, const char *b, int edits) {
    while (*a && *a == *b) a++, b++;
    if (!*a && !*b) return true;
    if (!edits) return false;
    return (*a && is_near(a + 1, b, edits - 1)) || (*b && is_near(a, b + 1, edits - 1)) ||
           (*a && *b && is_near(a + 1, b + 1, edits - 1));
}

static int unknown(const char *name) {
    const char *near = NULL;
    for (int edits = 1; edits <= 2 && !near; edits++)
        for (int k = 0; k < COMMANDS && !near; k++)
            if (is_near(name, commands[k].name, edits)) near = commands[k].name;
    fprintf(stderr, "projdyn: unknown command \"%s\"", name);
    if (near) fprintf(stderr, ", did you mean \"%s\"?", near);
    fprintf(stderr, "\n\n");
    usage(stderr);
    return EXIT_BAD_INPUT;
}

static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        usage(stderr);
        return EXIT_BAD_INPUT;
    }
    if (!strcmp(argv[1], "--version")) {
        printf("projdyn %s\n", pdyn_version());
        return EXIT_GOOD;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        usage(stdout);
        return EXIT_GOOD;
    }
    for (int k = 0; k < COMMANDS; k++)
        if (!strcmp(argv[1], commands[k].name)) return commands[k].run(argc - 1, argv + 1);
    return unknown(argv[1]);
}

/* What was printed but did not arrive, on a full disk say, is a failure. */
int main(int argc, char **argv) {
    int code = dispatch(argc, argv);
    errno = 0;
    if (!fflush(stdout) && !ferror(stdout)) return code;
    fprintf(stderr, "projdyn: standard output: writing failed: %s\n",
            strerror(errno ? errno : EIO));
    return code == EXIT_GOOD ? EXIT_FAILED : code;
}

/* ---- shared by the commands ---------------------------------------------------------------------
 */

bool parse_whole(const char *option, const char *text, long least, long most, long *out) {
    char *end;
    errno = 0;
    *out = strtol(text, &end, 10);
    if (!errno && !*end && end != text && *out >= least && *out <= most) return true;
    fprintf(stderr, "projdyn: %s: found \"%s\", expected a whole number from %ld to %ld\n", option,
            text, least, most);
    return false;
}

int report_no_memory(void) {
    fprintf(stderr, "projdyn: out of memory\n");
    return EXIT_FAILED;
}

int report_unwritten(const char *path) {
    fprintf(stderr, "projdyn: %s: writing failed: %s\n", path, strerror(errno));
    return EXIT_FAILED;
}

static double seconds_of(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double wall_seconds(void) { return seconds_of(CLOCK_MONOTONIC); }
double processor_seconds(void) { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }

bool scene_threads(struct scene_options *options, const char *text) {
    long threads;
    if (!parse_whole("--threads", text, 1, 1024, &threads)) return false;
    options->threads = (int)threads;
    return true;
}

static bool add_text(const char ***list, int *count, const char *text) {
    const char **longer = realloc(*list, (size_t)(*count + 1) * sizeof *longer);
    if (!longer) return report_no_memory(), false;
    *list = longer;
    longer[(*count)++] = text;
    return true;
}

char *default_output(const char *before, const char *scene) {
    const char *slash = strrchr(scene, '/'), *base = slash ? slash + 1 : scene;
    size_t length = strlen(base);
    char *path;
    if (length > 5 && !strcmp(base + length - 5, ".json")) length -= 5;
    if (asprintf(&path, "out/%s%.*s", before, (int)length, base) >= 0) return path;
    report_no_memory();
    return NULL;
}

bool scene_set(struct scene_options *options, const char *text) {
    return add_text(&options->set, &options->sets, text);
}

bool scene_plugin(struct scene_options *options, const char *file) {
    return add_text(&options->plugin, &options->plugins, file);
}

void scene_options_free(struct scene_options *options) {
    free(options->set);
    free(options->plugin);
}

void clear_progress(void) {
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
}

static void warn(void *user, pdyn_log_level level, const char *message) {
    (void)user;
    clear_progress();
    fprintf(stderr, "projdyn: %s%s\n", level == PDYN_LOG_WARNING ? "warning: " : "", message);
}

const char *status_message(const pdyn_context *context, pdyn_status status) {
    const char *error = pdyn_last_error(context);
    return *error ? error : pdyn_status_text(status);
}

int report_status(const pdyn_context *context, pdyn_status status) {
    clear_progress();
    fprintf(stderr, "projdyn: %s\n", status_message(context, status));
    return status == PDYN_BAD_INPUT || status == PDYN_BAD_CALL ? EXIT_BAD_INPUT : EXIT_FAILED;
}

int scene_context(const struct scene_options *options, pdyn_context **context) {
    pdyn_options settings = pdyn_default_options();
    settings.threads = options->threads;
    settings.log = options->silent ? NULL : warn;
    pdyn_status status = pdyn_create(&settings, context);
    for (int k = 0; k < options->plugins && status == PDYN_OK; k++)
        status = pdyn_load_plugin(*context, options->plugin[k]);
    return status == PDYN_OK ? EXIT_GOOD : report_status(*context, status);
}

int scene_load(const struct scene_options *options, pdyn_context **context, pdyn_sim **sim) {
    int failed = scene_context(options, context);
    *sim = NULL;
    if (failed) return failed;
    pdyn_status status = pdyn_load(*context, options->scene, options->set, options->sets, sim);
    if (status == PDYN_OK) return EXIT_GOOD;
    int code = report_status(*context, status);
    return status == PDYN_IO_FAILED ? EXIT_BAD_INPUT : code; /* a file that the scene names */
}
