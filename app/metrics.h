/* The table of a run's steps, metrics.csv. */
#ifndef METRICS_H
#define METRICS_H

struct metrics {
    int columns;
    long rows;
    char **name;   /* columns */
    double *value; /* rows x columns; NAN where a cell is empty */
    char *text;    /* of the file, which the names lie in */
};

/* Of the run in a directory. EXIT_GOOD, or an exit code with a message and nothing to be freed. */
int metrics_read(const char *directory, struct metrics *metrics);
void metrics_free(struct metrics *metrics);

/* The column of this name; -1: none. */
int metrics_column(const struct metrics *metrics, const char *name);

#endif
