/* result.json in a job's directory: how the job ended; and the numbers in the files beside it. */
#ifndef JOB_RESULT_H
#define JOB_RESULT_H

#include "jobs.h"

#include <jansson.h>

/* Writes DIRECTORY/result.json. status: as wait() returns it; cpu: processor time of the
 * process, s. Returns an exit code. */
int job_result_write(const char *directory, const struct job *job, int status, double cpu);

/* Names of the statistics of columns: keys of a result. */
enum { JOB_STATISTICS = 3 };
extern const char *const job_statistics[JOB_STATISTICS];

/* Reads the result of a job into one JSON object with the keys
 *
 *     status, error, cpu_s   from result.json; status: "good", "bad input", "failed" or "killed"
 *     report                 content of report.json, if there is one
 *     mean, max              of each column of metrics.csv and probes.csv
 *     impulse                time integral of each force and moment of probes.csv, N s or N m s
 *
 * NULL after a message if result.json is missing or invalid. The caller releases the object. */
json_t *job_result_read(const char *directory);

/* Whether the result is not NULL and has this "status". */
bool job_result_has_status(const json_t *result, const char *status);

/* Processor time of the time steps, ms per simulated second; 0 if unknown. */
double job_result_ms_per_second(const json_t *result);

/* Prints the result and the overrides of the job as one line. */
void job_result_print(const char *directory, const struct job *job);

#endif
