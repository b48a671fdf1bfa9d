/* Jobs: runs of one scene with different overrides, several at a time, each in its own process
 * and its own directory OUTPUT/KEY.
 *
 *     OUTPUT/KEY.part   a job that runs (locked by its parent process), or one that was killed
 *     OUTPUT/KEY        a finished job: log.txt, result.json and the files of `projdyn run`
 *
 * A finished job is not run again. Several processes may work on one OUTPUT at the same time:
 * the lock gives each job to one of them. */
#ifndef JOBS_H
#define JOBS_H

#include "scene_options.h"

enum { JOB_KEY = 17, JOB_PATH = 4096 }; /* sizes of texts with their NUL */

enum job_status { JOB_PENDING, JOB_FINISHED };

struct job {
    char **set; /* sets: overrides PATH=VALUE */
    int sets;
    bool frames;    /* write frames */
    double limit_s; /* processor time after which the job is killed; 0: no limit */
    /* Directory name: 64-bit hash of scene, plug-ins, files that these name, version, overrides,
     * frames and limit. */
    char key[JOB_KEY];
    enum job_status status;
};

struct jobs {
    struct scene_options scene; /* of all jobs: the file and plug-ins; its overrides do not count */
    const char *output;
    int processes; /* jobs that run at the same time */
    int threads;   /* worker threads of each job */
    bool quiet;    /* prints no line per finished job */
    long count;
    struct job *job; /* count */
};

/* Appends overrides to a job. The texts are not copied and must outlive the job; the caller
 * frees job->set. false if memory ran out. */
bool job_add_overrides(struct job *job, const char *const *set, int sets);

/* Computes the key and the status of every job. Returns an exit code. */
int jobs_find_finished(struct jobs *jobs);
/* Runs all pending jobs. EXIT_GOOD: every job is finished, whether it succeeded or not. */
int jobs_run(struct jobs *jobs);

/* OUTPUT/KEY + ending; false with a message if the path is too long. */
bool job_path(char path[JOB_PATH], const struct jobs *jobs, const struct job *job,
              const char *ending);

#endif
