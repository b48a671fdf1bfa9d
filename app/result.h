/* How a run of a farm ended, in its directory: result.json; and the numbers beside it. */
#ifndef RESULT_H
#define RESULT_H

#include "farm.h"

#include <jansson.h>

/* status: as of wait(); cpu: processor time of the process, s. An exit code. */
int result_write(const char *directory, const struct farm_run *run, int status, double cpu);

/* One object: of result.json "status" ("good" or why not), "error", "cpu_s", of report.json
 * "report" if there is one, of metrics.csv "mean" and "max" of each column. NULL with a message. */
json_t *result_read(const char *directory);

/* Is that its "status"? NULL has none. */
bool result_is(const json_t *result, const char *status);

/* Processor time of the steps, ms, per simulated second; 0: unknown. */
double result_ms_per_second(const json_t *result);

/* One line for people. */
void result_print(const char *directory, const struct farm_run *run);

#endif
