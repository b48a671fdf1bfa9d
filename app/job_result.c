/* result.json: how a job ended, written by the process that ran it and read for tables. */
#include "job_result.h"
#include "metrics_csv.h"
#include "read_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static bool path_in(char path[JOB_PATH], const char *directory, const char *name) {
    int length = snprintf(path, JOB_PATH, "%s/%s", directory, name);
    return length >= 0 && length < JOB_PATH;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* Last message in DIRECTORY/log.txt that is no warning; "" if there is none. The caller frees
 * it. */
static char *last_error(const char *directory) {
    static const char prefix[] = "projdyn: ", warning[] = "projdyn: warning";
    char path[JOB_PATH], *log = NULL, *last = NULL;
    size_t size;
    if (!path_in(path, directory, "log.txt") || access(path, R_OK) ||
        read_file(path, &log, &size) != EXIT_GOOD)
        return strdup("");
    for (char *line = log, *rest = log; (line = strsep(&rest, "\n"));)
        if (!strncmp(line, prefix, sizeof prefix - 1) && strncmp(line, warning, sizeof warning - 1))
            last = line + sizeof prefix - 1;
    char *copy = strdup(last ? last : "");
    free(log);
    return copy;
}

/* status: as wait() returns it */
static const char *status_name(int status) {
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

/* Why a job failed: the signal, or its last message; "" for a good one. The caller frees it. */
static char *error_of(const char *directory, int status) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) /* kill_over_limit() in jobs.c */
        return strdup("at the limit of its processor time");
    if (WIFSIGNALED(status)) return strdup(strsignal(WTERMSIG(status)));
    return WEXITSTATUS(status) == EXIT_GOOD ? strdup("") : last_error(directory);
}

/* The JSON object of result.json. */
static json_t *make_result(const char *directory, const struct job *job, int status, double cpu) {
    char *error = error_of(directory, status);
    json_t *set = json_array(), *text = error ? json_string(error) : NULL;
    for (int k = 0; k < job->sets; k++) json_array_append_new(set, json_string(job->set[k]));
    if (error && !text) text = json_string("(the message is not UTF-8)");
    free(error);
    return json_pack("{s:o, s:s, s:o, s:f}", "set", set, "status", status_name(status), "error",
                     text, "cpu_s", cpu);
}

int job_result_write(const char *directory, const struct job *job, int status, double cpu) {
    char path[JOB_PATH];
    json_t *root = make_result(directory, job, status, cpu);
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

const char *const job_statistics[JOB_STATISTICS] = {"mean", "max", "impulse"};

/* Sets a number of an object; one that is not finite is left out. */
static void set_finite(json_t *object, const char *key, double value) {
    if (isfinite(value)) json_object_set_new(object, key, json_real(value));
}

/* Adds mean and maximum of column k to "mean" and "max". */
static void add_column(json_t *result, const struct metrics_csv *m, int k) {
    double sum = 0.0, max = -INFINITY;
    for (long r = 0; r < m->rows; r++) {
        double value = m->value[r * m->columns + k];
        sum += value, max = fmax(max, value);
    }
    set_finite(json_object_get(result, "mean"), m->name[k], sum / (double)m->rows);
    set_finite(json_object_get(result, "max"), m->name[k], max);
}

/* Whether a column of probes.csv is a force or a moment: its unit is N or Nm. */
static bool is_force(const char *name) {
    const char *unit = strrchr(name, '_');
    return unit && (!strcmp(unit, "_N") || !strcmp(unit, "_Nm"));
}

/* Adds the integral of the force or moment in column k over time to "impulse": the sum of force x
 * length of the step. The unit in its name becomes Ns or Nms. Column 0 is the end of the step. */
static void add_impulse(json_t *result, const struct metrics_csv *m, int k) {
    double impulse = 0.0, start = 0.0;
    char *name;
    for (long r = 0; r < m->rows; r++) {
        const double *row = m->value + r * m->columns;
        impulse += (row[0] - start) * row[k];
        start = row[0];
    }
    if (asprintf(&name, "%ss", m->name[k]) < 0) return;
    set_finite(json_object_get(result, "impulse"), name, impulse);
    free(name);
}

/* Adds mean and max of the columns of a table of time steps, if the job wrote one; impulses: and
 * the impulse of its forces. */
static void add_table(json_t *result, const char *directory, const char *file, bool impulses) {
    char path[JOB_PATH];
    struct metrics_csv table;
    if (!path_in(path, directory, file) || access(path, R_OK) ||
        metrics_csv_read(directory, file, &table) != EXIT_GOOD)
        return;
    for (int k = 0; k < table.columns && table.rows; k++) {
        add_column(result, &table, k);
        if (impulses && is_force(table.name[k])) add_impulse(result, &table, k);
    }
    metrics_csv_free(&table);
}

json_t *job_result_read(const char *directory) {
    char path[JOB_PATH];
    json_error_t error;
    if (!path_in(path, directory, "result.json")) return NULL;
    json_t *result = json_load_file(path, 0, &error);
    if (!json_is_object(result) || !json_string_value(json_object_get(result, "status"))) {
        fprintf(stderr,
                "projdyn: %s: expected the result of a run: %s; to repeat the run, remove its "
                "directory\n",
                path, result ? "\"status\" is missing" : error.text);
        json_decref(result);
        return NULL;
    }
    if (path_in(path, directory, "report.json"))
        json_object_set_new(result, "report", json_load_file(path, 0, &error));
    for (int k = 0; k < JOB_STATISTICS; k++)
        json_object_set_new(result, job_statistics[k], json_object());
    add_table(result, directory, "metrics.csv", false);
    add_table(result, directory, "probes.csv", true);
    return result;
}

bool job_result_has_status(const json_t *result, const char *status) {
    const char *own = json_string_value(json_object_get(result, "status"));
    return own && !strcmp(own, status);
}

double job_result_ms_per_second(const json_t *result) {
    const json_t *report = json_object_get(result, "report"),
                 *mean = json_object_get(result, "mean");
    double simulated = json_number_value(json_object_get(report, "simulated_s"));
    double ms = json_number_value(json_object_get(mean, "ms_cpu")) *
                json_number_value(json_object_get(report, "steps"));
    return simulated > 0.0 ? ms / simulated : 0.0;
}

void job_result_print(const char *directory, const struct job *job) {
    json_t *result = job_result_read(directory);
    const char *error = json_string_value(json_object_get(result, "error"));
    printf("%s, %.1f s of processor time", json_string_value(json_object_get(result, "status")),
           json_number_value(json_object_get(result, "cpu_s")));
    for (int k = 0; k < job->sets; k++) printf("%s%s", k ? " " : ": ", job->set[k]);
    printf("%s%s\n", error && *error ? ": " : "", error ? error : "");
    json_decref(result);
}
