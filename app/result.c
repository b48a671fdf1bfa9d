#include "result.h"
#include "app.h"
#include "frames.h"
#include "metrics.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static bool path_in(char path[FARM_PATH], const char *directory, const char *name) {
    int length = snprintf(path, FARM_PATH, "%s/%s", directory, name);
    return length >= 0 && length < FARM_PATH;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* The last message in the log that is no warning; "" for none. To be freed. */
static char *last_error(const char *directory) {
    static const char mark[] = "projdyn: ", warning[] = "projdyn: warning";
    char path[FARM_PATH], *log = NULL, *last = NULL;
    size_t size;
    if (!path_in(path, directory, "log.txt") || access(path, R_OK) ||
        file_read(path, &log, &size) != EXIT_GOOD)
        return strdup("");
    for (char *line = log, *rest = log; (line = strsep(&rest, "\n"));)
        if (!strncmp(line, mark, sizeof mark - 1) && strncmp(line, warning, sizeof warning - 1))
            last = line + sizeof mark - 1;
    char *copy = strdup(last ? last : "");
    free(log);
    return copy;
}

static const char *describe(int status) {
    if (WIFSIGNALED(status)) return "killed";
    switch (WEXITSTATUS(status)) {
    case EXIT_GOOD:
        return "good";
    case EXIT_BAD_INPUT:
        return "bad input";
    default:
        return "failed";
    }
}

static json_t *compose(const char *directory, const struct farm_run *run, int status, double cpu) {
    char *error = WIFSIGNALED(status) ? strdup(strsignal(WTERMSIG(status))) : last_error(directory);
    json_t *set = json_array(), *text = error ? json_string(error) : NULL;
    for (int k = 0; k < run->sets; k++) json_array_append_new(set, json_string(run->set[k]));
    if (error && !text) text = json_string("(no UTF-8)");
    free(error);
    return json_pack("{s:o, s:s, s:o, s:f}", "set", set, "status", describe(status), "error", text,
                     "cpu_s", cpu);
}

int result_write(const char *directory, const struct farm_run *run, int status, double cpu) {
    char path[FARM_PATH];
    json_t *root = compose(directory, run, status, cpu);
    errno = 0;
    bool good = root && path_in(path, directory, "result.json") &&
                !json_dump_file(root, path, JSON_INDENT(2));
    json_decref(root);
    if (good) return EXIT_GOOD;
    fprintf(stderr, "projdyn: %s/result.json: writing failed: %s\n", directory,
            errno ? strerror(errno) : "out of memory");
    return EXIT_FAILED;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Means and maxima of the columns of metrics.csv. */
static void add_metrics(json_t *result, const struct metrics *m) {
    json_t *means = json_object(), *maxima = json_object();
    for (int k = 0; k < m->columns && m->rows; k++) {
        double sum = 0.0, max = -INFINITY;
        for (long r = 0; r < m->rows; r++) {
            double value = m->value[r * m->columns + k];
            sum += value, max = fmax(max, value);
        }
        double mean = sum / (double)m->rows;
        if (isfinite(mean)) json_object_set_new(means, m->name[k], json_real(mean));
        if (isfinite(max)) json_object_set_new(maxima, m->name[k], json_real(max));
    }
    json_object_set_new(result, "mean", means);
    json_object_set_new(result, "max", maxima);
}

json_t *result_read(const char *directory) {
    char path[FARM_PATH];
    struct metrics metrics;
    json_error_t error;
    if (!path_in(path, directory, "result.json")) return NULL;
    json_t *result = json_load_file(path, 0, &error);
    if (!json_is_object(result) || !json_string_value(json_object_get(result, "status"))) {
        fprintf(stderr,
                "projdyn: %s: expected how a run ended: %s; remove the directory to run it "
                "again\n",
                path, result ? "no \"status\"" : error.text);
        json_decref(result);
        return NULL;
    }
    if (path_in(path, directory, "report.json"))
        json_object_set_new(result, "report", json_load_file(path, 0, &error));
    if (path_in(path, directory, "metrics.csv") && !access(path, R_OK) &&
        metrics_read(directory, &metrics) == EXIT_GOOD) {
        add_metrics(result, &metrics);
        metrics_free(&metrics);
    }
    return result;
}

bool result_is(const json_t *result, const char *status) {
    const char *own = json_string_value(json_object_get(result, "status"));
    return own && !strcmp(own, status);
}

double result_ms_per_second(const json_t *result) {
    const json_t *report = json_object_get(result, "report"),
                 *mean = json_object_get(result, "mean");
    double simulated = json_number_value(json_object_get(report, "simulated_s"));
    double ms = json_number_value(json_object_get(mean, "ms_cpu")) *
                json_number_value(json_object_get(report, "steps"));
    return simulated > 0.0 ? ms / simulated : 0.0;
}

void result_print(const char *directory, const struct farm_run *run) {
    json_t *result = result_read(directory);
    const char *error = json_string_value(json_object_get(result, "error"));
    printf("%s, %.1f s of processor time:", json_string_value(json_object_get(result, "status")),
           json_number_value(json_object_get(result, "cpu_s")));
    for (int k = 0; k < run->sets; k++) printf(" %s", run->set[k]);
    printf("%s%s\n", error && *error ? ": " : "", error ? error : "");
    json_decref(result);
}
