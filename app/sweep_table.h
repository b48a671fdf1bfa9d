/* OUTPUT/sweep.csv: one row per grid point of a sweep, with its parameters, status, times,
 * memory and metrics. */
#ifndef SWEEP_TABLE_H
#define SWEEP_TABLE_H

#include "jobs.h"
#include "parameter_grid.h"

/* Collects the results of all jobs and writes the table. EXIT_GOOD: every job is finished and
 * good. EXIT_FAILED after a message otherwise; the table is written in this case, too. */
int sweep_table_write(const struct jobs *jobs, const struct parameter_grid *grid);

#endif
