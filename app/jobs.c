/* Runs jobs in child processes, a fixed number at a time (jobs.h). */
#include "jobs.h"
#include "job_directory.h"
#include "job_result.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

struct worker {
    pid_t pid; /* child process that runs the job; 0: idle */
    int lock;  /* file descriptor, see job_lock() */
    struct job *job;
};

bool job_add_overrides(struct job *job, const char *const *set, int sets) {
    char **all = realloc(job->set, (size_t)(job->sets + sets + 1) * sizeof *all);
    if (!all) return false;
    job->set = all;
    for (int k = 0; k < sets; k++) all[job->sets++] = (char *)set[k];
    return true;
}

/* ---- one job --------------------------------------------------------------------------------- */

/* Executes `projdyn run` for the job; called in the child process. The child is killed if its
 * parent ends. */
static _Noreturn void execute(const struct jobs *jobs, const struct job *job, pid_t parent) {
    char part[JOB_PATH], threads[16];
    const char **argv = calloc(16 + 2 * (size_t)(job->sets + jobs->scene.plugins), sizeof *argv);
    int argc = 0;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent || !argv || !job_path(part, jobs, job, ".part")) _exit(EXIT_FAILED);
    snprintf(threads, sizeof threads, "%d", jobs->threads);
    const char *fixed[] = {"projdyn", "run",       jobs->scene.scene, "--output", part,
                           "--quiet", "--threads", threads,           "--save",   "0"};
    for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++) argv[argc++] = fixed[k];
    if (!job->frames) argv[argc++] = "--no-frames";
    for (int k = 0; k < jobs->scene.plugins; k++)
        argv[argc++] = "--plugin", argv[argc++] = jobs->scene.plugin[k];
    for (int k = 0; k < job->sets; k++) argv[argc++] = "--set", argv[argc++] = job->set[k];
    execv("/proc/self/exe", (char **)argv);
    _exit(EXIT_FAILED);
}

/* Sends stdout and stderr of the child process to log.txt in the job's directory. */
static bool redirect_output(const struct jobs *jobs, const struct job *job) {
    char path[JOB_PATH];
    if (!job_path(path, jobs, job, ".part/log.txt")) return false;
    int log = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    return log >= 0 && dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0;
}

/* Starts a job in an idle worker, which stays idle if another process has the job. */
static int start_job(const struct jobs *jobs, struct job *job, struct worker *worker) {
    int code = job_lock(jobs, job, &worker->lock);
    if (code != EXIT_GOOD || worker->lock < 0) return code;
    pid_t parent = getpid();
    fflush(NULL);
    worker->job = job;
    worker->pid = fork();
    if (worker->pid == 0) {
        if (!redirect_output(jobs, job)) _exit(EXIT_FAILED);
        execute(jobs, job, parent);
    }
    if (worker->pid > 0) return EXIT_GOOD;
    worker->pid = 0;
    return job_report_errno(jobs->output, "cannot start a process");
}

/* Writes result.json and renames OUTPUT/KEY.part to OUTPUT/KEY, so that this directory appears
 * only when it is complete. */
static int finish_job(const struct jobs *jobs, struct worker *worker, int status,
                      const struct rusage *usage) {
    char part[JOB_PATH], path[JOB_PATH];
    double cpu = (double)usage->ru_utime.tv_sec + 1e-6 * (double)usage->ru_utime.tv_usec +
                 (double)usage->ru_stime.tv_sec + 1e-6 * (double)usage->ru_stime.tv_usec;
    if (!job_path(part, jobs, worker->job, ".part") || !job_path(path, jobs, worker->job, ""))
        return EXIT_BAD_INPUT;
    int code = job_result_write(part, worker->job, status, cpu);
    if (code == EXIT_GOOD && rename(part, path))
        code = job_report_errno(path, "cannot rename the directory");
    if (code == EXIT_GOOD) worker->job->status = JOB_FINISHED;
    close(worker->lock);
    worker->pid = 0;
    return code;
}

/* ---- all jobs -------------------------------------------------------------------------------- */

/* The worker with this process id; pid 0 finds an idle worker. NULL if there is none. */
static struct worker *find_worker(struct worker *worker, int workers, pid_t pid) {
    for (int k = 0; k < workers; k++)
        if (worker[k].pid == pid) return &worker[k];
    return NULL;
}

static bool is_running(const struct jobs *jobs, const struct worker *worker,
                       const struct job *job) {
    for (int k = 0; k < jobs->processes; k++)
        if (worker[k].pid && worker[k].job == job) return true;
    return false;
}

/* Starts pending jobs that no process runs, while there are idle workers. */
static int start_pending(const struct jobs *jobs, struct worker *worker) {
    int code = EXIT_GOOD;
    for (long k = 0; code == EXIT_GOOD && k < jobs->count; k++) {
        struct worker *idle = find_worker(worker, jobs->processes, 0);
        if (!idle) break;
        if (jobs->job[k].status == JOB_PENDING && !is_running(jobs, worker, &jobs->job[k]))
            code = start_job(jobs, &jobs->job[k], idle);
    }
    return code;
}

/* Prints progress and result of a job that has finished, unless --quiet is given. */
static void print_finished(const struct jobs *jobs, const struct job *job) {
    long finished = 0;
    char path[JOB_PATH];
    for (long k = 0; k < jobs->count; k++) finished += jobs->job[k].status == JOB_FINISHED;
    if (jobs->quiet || !job_path(path, jobs, job, "")) return;
    printf("%ld/%ld ", finished, jobs->count);
    job_result_print(path, job);
    fflush(stdout);
}

/* Kills jobs (SIGXCPU) whose processor time exceeds their limit. RLIMIT_CPU would do the same,
 * but it reduces the resolution of the process's clock, which the job measures its steps with. */
static void kill_over_limit(const struct jobs *jobs, const struct worker *worker) {
    for (int k = 0; k < jobs->processes; k++) {
        clockid_t clock;
        struct timespec spent;
        if (!worker[k].pid || worker[k].job->limit_s == 0.0) continue;
        if (clock_getcpuclockid(worker[k].pid, &clock) || clock_gettime(clock, &spent)) continue;
        if ((double)spent.tv_sec > worker[k].job->limit_s) kill(worker[k].pid, SIGXCPU);
    }
}

/* Handles one child that has ended; if there is none, enforces the limits and sleeps for 5 ms. */
static int poll_children(const struct jobs *jobs, struct worker *worker) {
    const struct timespec interval = {.tv_nsec = 5000000};
    int status;
    struct rusage usage;
    pid_t pid = wait4(-1, &status, WNOHANG, &usage);
    struct worker *ended = pid > 0 ? find_worker(worker, jobs->processes, pid) : NULL;
    if (!ended) {
        kill_over_limit(jobs, worker);
        nanosleep(&interval, NULL);
        return EXIT_GOOD;
    }
    struct job *job = ended->job;
    int code = finish_job(jobs, ended, status, &usage);
    if (code == EXIT_GOOD) print_finished(jobs, job);
    return code;
}

static bool all_finished(const struct jobs *jobs) {
    for (long k = 0; k < jobs->count; k++)
        if (jobs->job[k].status != JOB_FINISHED) return false;
    return true;
}

/* Runs jobs until all are finished. Jobs that another process has locked are polled (every 100
 * ms if no own job runs) until that process has finished them or has ended. */
static int run_all(struct jobs *jobs, struct worker *worker) {
    const struct timespec interval = {.tv_nsec = 100000000};
    int code = EXIT_GOOD;
    while (code == EXIT_GOOD && !all_finished(jobs)) {
        code = start_pending(jobs, worker);
        bool busy = false;
        for (int k = 0; k < jobs->processes; k++) busy |= worker[k].pid > 0;
        if (code == EXIT_GOOD && busy) code = poll_children(jobs, worker);
        else nanosleep(&interval, NULL);
        for (long k = 0; code == EXIT_GOOD && k < jobs->count; k++)
            if (jobs->job[k].status == JOB_PENDING) code = job_update_status(jobs, &jobs->job[k]);
    }
    return code;
}

int jobs_run(struct jobs *jobs) {
    int code = job_make_directories(jobs->output);
    struct worker *worker = calloc((size_t)jobs->processes, sizeof *worker);
    if (code == EXIT_GOOD && !worker) code = report_no_memory();
    if (code == EXIT_GOOD) code = run_all(jobs, worker);
    free(worker);
    return code;
}
