#include "table.h"
#include "app.h"
#include "csv.h"
#include "result.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- cells ----------------------------------------------------------------------------------- */

static void put_number(FILE *file, const json_t *value) {
    fputc(',', file);
    if (json_is_number(value)) fprintf(file, "%.9g", json_number_value(value));
}

static void put_ratio(FILE *file, double over, double under) {
    fputc(',', file);
    if (over > 0.0 && under > 0.0) fprintf(file, "%.9g", over / under);
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* `columns`: an object with a member for each column of the metrics. */
static void put_header(FILE *file, const struct choices *choices, json_t *columns) {
    const char *name;
    json_t *unused;
    for (int a = 0; a < choices->axes; a++) csv_text(file, choices->axis[a].path), fputc(',', file);
    fputs("status,error,steps,simulated_s,wall_s,cpu_s,wall_s_per_s,cpu_s_per_s", file);
    json_object_foreach(columns, name, unused) fprintf(file, ",mean_%s", name);
    json_object_foreach(columns, name, unused) fprintf(file, ",max_%s", name);
    fputs(",state_hash,directory\n", file);
}

/* Times are those of the steps; without loading and writing. */
static void put_times(FILE *file, json_t *result) {
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
}

static void put_row(FILE *file, const struct farm *farm, const struct choices *choices, long point,
                    json_t *result, json_t *columns) {
    const char *name;
    json_t *unused, *report = json_object_get(result, "report");
    for (int a = 0; a < choices->axes; a++)
        csv_text(file, choices_value(choices, point, a)), fputc(',', file);
    const char *status = json_string_value(json_object_get(result, "status"));
    csv_text(file, status ? status : "missing");
    fputc(',', file);
    csv_text(file, json_string_value(json_object_get(result, "error")));
    put_times(file, result);
    json_object_foreach(columns, name, unused)
        put_number(file, json_object_get(json_object_get(result, "mean"), name));
    json_object_foreach(columns, name, unused)
        put_number(file, json_object_get(json_object_get(result, "max"), name));
    const char *hash = json_string_value(json_object_get(report, "state_hash"));
    fprintf(file, ",%s,%s\n", hash ? hash : "", farm->run[point].key);
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* The result of every run; null where it has none. */
static json_t *read_all(const struct farm *farm) {
    json_t *all = json_array();
    char path[FARM_PATH];
    for (long k = 0; k < farm->count; k++) {
        bool there = farm->run[k].status == FARM_ENDED && farm_path(path, farm, &farm->run[k], "");
        json_t *result = there ? result_read(path) : NULL;
        json_array_append_new(all, result ? result : json_null());
    }
    return all;
}

static json_t *find_columns(const json_t *all) {
    size_t k;
    json_t *result, *columns;
    json_array_foreach(all, k, result) if (json_object_size(columns = json_object_get(
                                                                result, "mean"))) return columns;
    return NULL;
}

static long count_good(const json_t *all) {
    size_t k;
    json_t *result;
    long good = 0;
    json_array_foreach(all, k, result) good += result_is(result, "good");
    return good;
}

static int write_all(const struct farm *farm, const struct choices *choices, json_t *all,
                     const char *path) {
    char aside[FARM_PATH + 32];
    json_t *columns = find_columns(all);
    snprintf(aside, sizeof aside, "%s.tmp", path);
    FILE *file = fopen(aside, "we");
    if (!file) return report_unwritten(path);
    put_header(file, choices, columns);
    for (long k = 0; k < farm->count; k++)
        put_row(file, farm, choices, k, json_array_get(all, (size_t)k), columns);
    bool bad = ferror(file);
    if (fclose(file) || bad || rename(aside, path)) return report_unwritten(path);
    return EXIT_GOOD;
}

int table_write(const struct farm *farm, const struct choices *choices) {
    char path[FARM_PATH + 16];
    snprintf(path, sizeof path, "%s/sweep.csv", farm->output);
    json_t *all = read_all(farm);
    int code = write_all(farm, choices, all, path);
    long good = count_good(all);
    json_decref(all);
    if (code != EXIT_GOOD) return code;
    if (!farm->quiet) printf("%ld of %ld runs are good; written to %s\n", good, farm->count, path);
    if (good == farm->count) return EXIT_GOOD;
    fprintf(stderr, "projdyn: sweep: %ld of %ld runs failed or are missing: see %s\n",
            farm->count - good, farm->count, path);
    return EXIT_FAILED;
}
