/* Writes OUTPUT/sweep.csv, the table of a sweep: one row per grid point. */
#include "sweep_table.h"
#include "csv.h"
#include "job_result.h"
#include "new_file.h"

#include <stdio.h>

/* ---- cells ----------------------------------------------------------------------------------- */

/* A comma and the number; an empty cell if the value is NULL or no number. */
static void put_number(FILE *file, const json_t *value) {
    fputc(',', file);
    if (json_is_number(value)) fprintf(file, "%.9g", json_number_value(value));
}

/* A comma and the ratio; an empty cell if one of the two is not positive. */
static void put_ratio(FILE *file, double numerator, double denominator) {
    fputc(',', file);
    if (numerator > 0.0 && denominator > 0.0) fprintf(file, "%.9g", numerator / denominator);
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* columns: as find_columns() returns it */
static void put_header(FILE *file, const struct parameter_grid *grid, json_t *columns) {
    for (int a = 0; a < grid->axes; a++) csv_write_text(file, grid->axis[a].path), fputc(',', file);
    fputs("status,error,steps,simulated_s,wall_s,cpu_s,wall_s_per_s,cpu_s_per_s,"
          "peak_memory_MB",
          file);
    for (int k = 0; k < JOB_STATISTICS; k++) {
        const char *name;
        json_t *unused;
        json_object_foreach(json_object_get(columns, job_statistics[k]), name, unused)
            fprintf(file, ",%s_%s", job_statistics[k], name);
    }
    fputs(",state_hash,directory\n", file);
}

/* Columns steps to peak_memory_MB. The times are sums over the time steps: loading the scene and
 * writing files are not included. */
static void put_costs(FILE *file, json_t *result) {
    json_t *report = json_object_get(result, "report"), *mean = json_object_get(result, "mean");
    static const char *const part[] = {"ms_neighbours", "ms_local", "ms_global", "ms_contact"};
    double steps = json_number_value(json_object_get(report, "steps")), wall = 0.0;
    double simulated = json_number_value(json_object_get(report, "simulated_s"));
    double cpu = 1e-3 * steps * json_number_value(json_object_get(mean, "ms_cpu"));
    for (int k = 0; k < 4; k++)
        wall += 1e-3 * steps * json_number_value(json_object_get(mean, part[k]));
    put_number(file, json_object_get(report, "steps"));
    put_number(file, json_object_get(report, "simulated_s"));
    put_ratio(file, wall, 1.0);
    put_ratio(file, cpu, 1.0);
    put_ratio(file, wall, simulated);
    put_ratio(file, cpu, simulated);
    put_ratio(file, json_number_value(json_object_get(report, "peak_memory_bytes")), 1e6);
}

/* The row of a grid point. result: as job_result_read() returns it, or JSON null. */
static void put_row(FILE *file, const struct jobs *jobs, const struct parameter_grid *grid,
                    long point, json_t *result, json_t *columns) {
    json_t *report = json_object_get(result, "report");
    for (int a = 0; a < grid->axes; a++)
        csv_write_text(file, parameter_grid_value(grid, point, a)), fputc(',', file);
    const char *status = json_string_value(json_object_get(result, "status"));
    csv_write_text(file, status ? status : "missing");
    fputc(',', file);
    csv_write_text(file, json_string_value(json_object_get(result, "error")));
    put_costs(file, result);
    for (int k = 0; k < JOB_STATISTICS; k++) {
        const char *name;
        json_t *unused, *own = json_object_get(result, job_statistics[k]);
        json_object_foreach(json_object_get(columns, job_statistics[k]), name, unused)
            put_number(file, json_object_get(own, name));
    }
    const char *hash = json_string_value(json_object_get(report, "state_hash"));
    fprintf(file, ",%s,%s\n", hash ? hash : "", jobs->job[point].key);
}

/* ---- the table ------------------------------------------------------------------------------- */

/* Array of the results of all jobs; JSON null for a job without a result. */
static json_t *read_results(const struct jobs *jobs) {
    json_t *all = json_array();
    char path[JOB_PATH];
    for (long k = 0; k < jobs->count; k++) {
        bool finished =
            jobs->job[k].status == JOB_FINISHED && job_path(path, jobs, &jobs->job[k], "");
        json_t *result = finished ? job_result_read(path) : NULL;
        json_array_append_new(all, result ? result : json_null());
    }
    return all;
}

/* For each statistic an object whose keys are the columns that some result has, so that runs with
 * different bodies and probes share a table. */
static json_t *find_columns(const json_t *all) {
    json_t *columns = json_object(), *result;
    size_t r;
    for (int k = 0; k < JOB_STATISTICS; k++) {
        json_t *keys = json_object();
        json_array_foreach(all, r, result)
            json_object_update_missing(keys, json_object_get(result, job_statistics[k]));
        json_object_set_new(columns, job_statistics[k], keys);
    }
    return columns;
}

static long count_good(const json_t *all) {
    size_t k;
    json_t *result;
    long good = 0;
    json_array_foreach(all, k, result) good += job_result_has_status(result, "good");
    return good;
}

/* all: as read_results() returns it */
static int write_table(const struct jobs *jobs, const struct parameter_grid *grid, json_t *all,
                       const char *path) {
    char *temporary;
    FILE *file = new_file_open(path, &temporary);
    if (!file) return report_write_error(path);
    json_t *columns = find_columns(all);
    put_header(file, grid, columns);
    for (long k = 0; k < jobs->count; k++)
        put_row(file, jobs, grid, k, json_array_get(all, (size_t)k), columns);
    json_decref(columns);
    return new_file_close(file, temporary, path, true) ? EXIT_GOOD : report_write_error(path);
}

int sweep_table_write(const struct jobs *jobs, const struct parameter_grid *grid) {
    char path[JOB_PATH + 16];
    snprintf(path, sizeof path, "%s/sweep.csv", jobs->output);
    json_t *all = read_results(jobs);
    int code = write_table(jobs, grid, all, path);
    long good = count_good(all);
    json_decref(all);
    if (code != EXIT_GOOD) return code;
    if (!jobs->quiet) printf("%ld of %ld runs are good; written to %s\n", good, jobs->count, path);
    if (good == jobs->count) return EXIT_GOOD;
    fprintf(stderr, "projdyn: sweep: %ld of %ld runs failed or are missing: see %s\n",
            jobs->count - good, jobs->count, path);
    return EXIT_FAILED;
}
