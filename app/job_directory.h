/* Directories of jobs: names, status and the lock that gives a job to one process. */
#ifndef JOB_DIRECTORY_H
#define JOB_DIRECTORY_H

#include "jobs.h"

/* Prints "PATH: WHAT: text of errno"; returns EXIT_FAILED. */
int job_report_errno(const char *path, const char *what);

/* Creates the directory and its parents. Returns an exit code. */
int job_make_directories(const char *path);

/* Sets the job's status: finished if OUTPUT/KEY exists. Returns an exit code. */
int job_update_status(const struct jobs *jobs, struct job *job);

/* Creates and locks the job's empty directory OUTPUT/KEY.part. *lock: file descriptor that holds
 * the lock until it is closed; -1 if another process runs or has finished the job. Returns an
 * exit code. */
int job_lock(const struct jobs *jobs, struct job *job, int *lock);

#endif
