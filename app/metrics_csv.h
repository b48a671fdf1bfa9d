/* metrics.csv or probes.csv of a run as a table: one row per time step, one column per quantity. */
#ifndef METRICS_CSV_H
#define METRICS_CSV_H

struct metrics_csv {
    int columns;
    long rows;
    char **name;   /* columns; the names are parts of `text` */
    double *value; /* rows x columns; NAN for an empty cell */
    char *text;    /* content of the file, cut into cells */
};

/* Reads DIRECTORY/FILE, "metrics.csv" or "probes.csv". Returns EXIT_GOOD, or another exit code
 * after a message with nothing to be freed. */
int metrics_csv_read(const char *directory, const char *file, struct metrics_csv *metrics);
void metrics_csv_free(struct metrics_csv *metrics);

/* Index of the column with this name, -1 if there is none. */
int metrics_csv_column(const struct metrics_csv *metrics, const char *name);

#endif
