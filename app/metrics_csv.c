/* Reader for metrics.csv and probes.csv, the tables of a run's time steps. */
#include "metrics_csv.h"
#include "app.h"
#include "read_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int count_char(const char *text, char c) {
    int count = 0;
    for (; *text; text++) count += *text == c;
    return count;
}

static bool split_header(struct metrics_csv *m, char *header) {
    m->columns = count_char(header, ',') + 1;
    m->name = calloc((size_t)m->columns, sizeof *m->name);
    for (int k = 0; m->name && k < m->columns; k++) m->name[k] = strsep(&header, ",");
    return m->name;
}

static void split_row(struct metrics_csv *m, char *row) {
    double *value = m->value + m->rows++ * m->columns;
    for (int k = 0; k < m->columns; k++) {
        char *cell = strsep(&row, ",");
        value[k] = cell && *cell ? strtod(cell, NULL) : NAN;
    }
}

/* Cuts m->text into names and values; false if memory ran out. */
static bool split(struct metrics_csv *m) {
    char *rest = m->text;
    int lines = count_char(m->text, '\n');
    char *header = strsep(&rest, "\n");
    if (!split_header(m, header)) return false;
    m->value = calloc((size_t)lines * (size_t)m->columns + 1, sizeof *m->value);
    if (!m->value) return false;
    for (char *row; (row = strsep(&rest, "\n")) && *row && m->rows < lines;) split_row(m, row);
    return true;
}

int metrics_csv_read(const char *directory, const char *file, struct metrics_csv *metrics) {
    char *path;
    size_t size;
    *metrics = (struct metrics_csv){0};
    if (asprintf(&path, "%s/%s", directory, file) < 0) return report_no_memory();
    int code = read_file(path, &metrics->text, &size);
    free(path);
    if (code != EXIT_GOOD || split(metrics)) return code;
    metrics_csv_free(metrics);
    return report_no_memory();
}

void metrics_csv_free(struct metrics_csv *metrics) {
    free(metrics->name);
    free(metrics->value);
    free(metrics->text);
    *metrics = (struct metrics_csv){0};
}

int metrics_csv_column(const struct metrics_csv *metrics, const char *name) {
    for (int k = 0; k < metrics->columns; k++)
        if (!strcmp(metrics->name[k], name)) return k;
    return -1;
}
