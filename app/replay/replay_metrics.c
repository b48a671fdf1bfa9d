/* Reads the columns of metrics.csv that the page plots. */
#include "read_file.h"
#include "replay_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const columns[] = {
    "time_s",    "outer_iterations", "linear_iterations", "density_error_mean", "density_error_max",
    "kinetic_J", "potential_J",      "constraint_J"};

enum { COLUMNS = sizeof columns / sizeof *columns };

/* Index of a column name in columns[], COLUMNS if the page does not use it. */
static int find_column(const char *cell) {
    int k = 0;
    while (k < COLUMNS && strcmp(columns[k], cell)) k++;
    return k;
}

/* The number in a cell; JSON null for an empty cell, which stands for a value that is not
 * finite; NULL for text that is no number. */
static json_t *parse_cell(const char *cell) {
    char *end;
    if (!*cell) return json_null();
    double value = strtod(cell, &end);
    return *end || !isfinite(value) ? NULL : json_real(value);
}

/* Sets order[k] to the index in columns[] of column k of the file. */
static int parse_header(struct run *run, char *line, const char *path, json_t *order) {
    for (char *cell; (cell = strsep(&line, ","));) {
        int k = find_column(cell);
        json_array_append_new(order, json_integer(k));
        if (k < COLUMNS) json_object_set_new(run->metrics, columns[k], json_array());
    }
    for (int k = 0; k < COLUMNS; k++)
        if (!json_object_get(run->metrics, columns[k]))
            return run_error("%s:1: expected the column \"%s\"", path, columns[k]);
    return EXIT_GOOD;
}

/* Appends the values of a line to the columns of run->metrics. number: of the line, from 0. */
static int parse_row(struct run *run, char *line, const char *path, int number,
                     const json_t *order) {
    size_t cells = 0;
    for (char *cell; (cell = strsep(&line, ",")); cells++) {
        int k = (int)json_integer_value(json_array_get(order, cells));
        if (cells >= json_array_size(order) || k >= COLUMNS) continue;
        json_t *value = parse_cell(cell);
        if (!value)
            return run_error("%s:%d: %s: expected a number, found \"%.40s\"", path, number,
                             columns[k], cell);
        json_array_append_new(json_object_get(run->metrics, columns[k]), value);
    }
    if (cells != json_array_size(order))
        return run_error("%s:%d: expected %zu cells, found %zu", path, number,
                         json_array_size(order), cells);
    return EXIT_GOOD;
}

int replay_read_metrics(struct run *run) {
    char path[RUN_PATH], *text;
    size_t size;
    run_path(path, run, "metrics.csv");
    if (access(path, F_OK)) return EXIT_GOOD;
    int code = read_file(path, &text, &size);
    if (code != EXIT_GOOD) return code;
    run->metrics = json_object();
    json_t *order = json_array();
    int number = 0;
    char *rest = text;
    for (char *line; code == EXIT_GOOD && (line = strsep(&rest, "\n"));) {
        if (!rest && !*line && number) break; /* after the last newline */
        code = number++ ? parse_row(run, line, path, number, order)
                        : parse_header(run, line, path, order);
    }
    json_decref(order);
    free(text);
    return code;
}
