/* Calibration run: runs one job with no other job beside it, so that its processor times are not
 * disturbed, and stops it at a limit of processor time. */
#ifndef CALIBRATION_H
#define CALIBRATION_H

#include "jobs.h"
#include "metrics_csv.h"

/* Runs the job, whose limit_s is set, with the scene and output directory of `jobs`, and reads
 * its time steps up to the limit (at least one). Like every job, a finished calibration run is
 * not repeated. Returns EXIT_GOOD; or another exit code after a message with nothing to be freed
 * (EXIT_FAILED: the run failed, or its first step exceeds the limit). */
int calibration_run(const struct jobs *jobs, struct job *job, struct metrics_csv *steps);

/* Simulated time at the last step, s. */
double simulated_seconds(const struct metrics_csv *steps);
/* Processor time, ms, of all steps that end at or before the simulated time `time`, s. */
double cpu_ms_until(const struct metrics_csv *steps, double time);

#endif
