/* Messages, clocks and option parsing that all sub-commands share. */
#include "app.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* ---- option arguments ------------------------------------------------------------------------ */

/* getopt_long, whose messages begin with argv[0], under the name of the program. */
static int next_option(int argc, char **argv, const char *letters, const struct option *options) {
    static char program[] = "projdyn";
    char *command = argv[0];
    argv[0] = program;
    int option = getopt_long(argc, argv, letters, options, NULL);
    argv[0] = command;
    return option;
}

bool is_near(const char *a, const char *b, int edits) {
    while (*a && *a == *b) a++, b++;
    if (!*a && !*b) return true;
    if (!edits) return false;
    return (*a && is_near(a + 1, b, edits - 1)) || (*b && is_near(a, b + 1, edits - 1)) ||
           (*a && *b && is_near(a + 1, b + 1, edits - 1));
}

/* Prints the option that is at most two edits away from an unknown one, --NAME or --NAME=VALUE; one
 * edit for short names. Without one: how a command that has --set changes keys of the scene. */
static void suggest_option(const char *unknown, const struct option *options) {
    char name[32];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(unknown + 2, "="), unknown + 2);
    int most = strlen(name) < 5 ? 1 : 2;
    for (int edits = 1; edits <= most; edits++)
        for (const struct option *o = options; o->name; o++)
            if (is_near(name, o->name, edits)) {
                fprintf(stderr, "did you mean --%s? ", o->name);
                return;
            }
    for (const struct option *o = options; o->name; o++)
        if (!strcmp(o->name, "set")) fputs("--set PATH=VALUE changes the scene; ", stderr);
}

int parse_options(int argc, char **argv, const char *letters, const struct option *options,
                  const char *usage, bool (*accept)(void *self, int option), void *self) {
    int option;
    while ((option = next_option(argc, argv, letters, options)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (option == '?') {
            if (!optopt) suggest_option(argv[optind - 1], options);
            fprintf(stderr, "'projdyn help %s' prints the options.\n", argv[0]);
            return EXIT_BAD_INPUT;
        }
        errno = 0;
        if (!accept(self, option)) return errno == ENOMEM ? EXIT_FAILED : EXIT_BAD_INPUT;
    }
    return -1;
}

bool parse_integer(const char *option, const char *text, int min, int max, int *out) {
    char *end;
    errno = 0;
    long number = strtol(text, &end, 10);
    if (!errno && !*end && end != text && number >= min && number <= max)
        return *out = (int)number, true;
    fprintf(stderr, "projdyn: %s: found \"%s\", expected an integer from %d to %d\n", option, text,
            min, max);
    return false;
}

bool parse_frames(const char *text, long *first, long *last) {
    int end = 0;
    if (sscanf(text, "%9ld:%9ld%n", first, last, &end) == 2 && !text[end] && *first >= 0 &&
        *last >= *first)
        return true;
    fprintf(stderr, "projdyn: --frames: found \"%s\", expected A:B with 0 <= A <= B\n", text);
    return false;
}

bool parse_seconds(const char *option, const char *text, double longest, double *time) {
    char *end;
    *time = strtod(text, &end);
    if (!*end && end != text && isfinite(*time) && *time > 0.0 && *time <= longest) return true;
    fprintf(stderr, "projdyn: %s: found \"%s\", expected seconds above 0", option, text);
    if (isfinite(longest)) fprintf(stderr, ", at most %.9g", longest);
    fputc('\n', stderr);
    return false;
}

void print_shortest(char text[32], double value) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, value);
        if (strtod(text, NULL) == value) return;
    }
}

struct rounded_time rounded_time(double seconds) {
    struct rounded_time t;
    if (seconds < 10.0) snprintf(t.text, sizeof t.text, "%.2g s", seconds);
    else if (seconds < 120.0) snprintf(t.text, sizeof t.text, "%.0f s", seconds);
    else if (seconds < 7200.0) snprintf(t.text, sizeof t.text, "%.0f min", seconds / 60.0);
    else snprintf(t.text, sizeof t.text, "%.0f h", seconds / 3600.0);
    return t;
}

char *default_output(const char *prefix, const char *scene) {
    const char *slash = strrchr(scene, '/'), *base = slash ? slash + 1 : scene;
    size_t length = strlen(base);
    char *path;
    if (length > 5 && !strcmp(base + length - 5, ".json")) length -= 5;
    if (asprintf(&path, "out/%s%.*s", prefix, (int)length, base) >= 0) return path;
    report_no_memory();
    return NULL;
}

/* ---- clocks ---------------------------------------------------------------------------------- */

static double clock_seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int usable_cores(void) {
    cpu_set_t set;
    if (!sched_getaffinity(0, sizeof set, &set)) return CPU_COUNT(&set);
    return (int)sysconf(_SC_NPROCESSORS_ONLN); /* above 1024 cores */
}

double wall_seconds(void) { return clock_seconds(CLOCK_MONOTONIC); }
double processor_seconds(void) { return clock_seconds(CLOCK_PROCESS_CPUTIME_ID); }

/* ---- messages -------------------------------------------------------------------------------- */

int report_no_memory(void) {
    fprintf(stderr, "projdyn: out of memory\n");
    errno = ENOMEM;
    return EXIT_FAILED;
}

int report_write_error(const char *path) {
    fprintf(stderr, "projdyn: %s: writing failed: %s\n", path, strerror(errno));
    return EXIT_FAILED;
}

int report_usage(char **argv, const char *expected, const char *usage) {
    char **found = argv + optind;
    fprintf(stderr, "projdyn: %s: expected %s, found%s", argv[0], expected, *found ? "" : " none");
    for (; *found; found++) fprintf(stderr, " \"%s\"", *found);
    fprintf(stderr, "\n%.*s\n'projdyn help %s' prints the options.\n",
            (int)(strstr(usage, "\n\n") - usage), usage, argv[0]);
    return EXIT_BAD_INPUT;
}

/* Whether the shell takes the path as one word. */
static bool is_one_word(const char *path) {
    bool plain = *path;
    for (; *path; path++)
        plain &= isalnum((unsigned char)*path) || (unsigned char)*path > 127 ||
                 strchr("/._-+,:@%=", *path);
    return plain;
}

struct shell_word shell_word(const char *path) {
    struct shell_word word = {""};
    const char *quote = is_one_word(path) ? "" : "'", *last = word.text + sizeof word.text - 8;
    char *end = stpcpy(word.text, quote);
    for (; *path && end < last; path++)
        if (*path == '\'') end = stpcpy(end, "'\\''");
        else *end++ = *path;
    strcpy(end, quote);
    return word;
}

void clear_progress(void) {
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
}

int report_status(const pdyn_context *context, pdyn_status status) {
    clear_progress();
    fprintf(stderr, "projdyn: %s\n", pdyn_last_error(context));
    return status == PDYN_BAD_INPUT || status == PDYN_BAD_CALL ? EXIT_BAD_INPUT : EXIT_FAILED;
}

int body_end(const pdyn_sim *sim, int b) {
    pdyn_body_info next = pdyn_get_body(sim, b + 1);
    return next.name ? next.first : pdyn_get_state(sim).particles;
}
