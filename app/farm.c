/* A run works in OUTPUT/KEY.part, locked, which becomes OUTPUT/KEY when it has ended. Where a
 * process that held the lock is gone, its run begins anew. */
#include "farm.h"
#include "app.h"
#include "frames.h"
#include "result.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

struct worker {
    pid_t pid; /* 0: idle */
    int lock;
    struct farm_run *run;
};

static int fail(const char *path, const char *what) {
    fprintf(stderr, "projdyn: %s: %s: %s\n", path, what, strerror(errno));
    return EXIT_FAILED;
}

/* ---- names ----------------------------------------------------------------------------------- */

bool farm_path(char path[FARM_PATH], const struct farm *farm, const struct farm_run *run,
               const char *ending) {
    int length = snprintf(path, FARM_PATH, "%s/%s%s", farm->output, run->key, ending);
    if (length >= 0 && length < FARM_PATH) return true;
    fprintf(stderr, "projdyn: --output: the path is too long\n");
    return false;
}

bool farm_add(struct farm_run *run, const char *const *set, int sets) {
    char **all = realloc(run->set, (size_t)(run->sets + sets + 1) * sizeof *all);
    if (!all) return false;
    run->set = all;
    for (int k = 0; k < sets; k++) all[run->sets++] = (char *)set[k];
    return true;
}

/* FNV-1a, with the end of every text. */
static uint64_t add_text(uint64_t hash, const char *text, size_t length) {
    for (size_t k = 0; k <= length; k++)
        hash = (hash ^ (k < length ? (unsigned char)text[k] : 0xff)) * 0x100000001b3u;
    return hash;
}

static void name_run(const struct farm *farm, const char *scene, size_t size,
                     struct farm_run *run) {
    uint64_t hash = add_text(0xcbf29ce484222325u, scene, size);
    for (int k = 0; k < farm->scene.plugins; k++)
        hash = add_text(hash, farm->scene.plugin[k], strlen(farm->scene.plugin[k]));
    hash = add_text(hash, pdyn_version(), strlen(pdyn_version()));
    for (int k = 0; k < run->sets; k++) hash = add_text(hash, run->set[k], strlen(run->set[k]));
    if (run->frames) hash = add_text(hash, "", 0);
    if (run->limit_s > 0.0) {
        int length = snprintf(run->key, sizeof run->key, "%.9g", run->limit_s);
        hash = add_text(hash, run->key, (size_t)length);
    }
    snprintf(run->key, sizeof run->key, "%016llx", (unsigned long long)hash);
}

static int look_for(const struct farm *farm, struct farm_run *run) {
    char path[FARM_PATH];
    if (!farm_path(path, farm, run, "")) return EXIT_BAD_INPUT;
    run->status = access(path, F_OK) ? FARM_MISSING : FARM_ENDED;
    return EXIT_GOOD;
}

int farm_survey(struct farm *farm) {
    char *scene;
    size_t size;
    int code = file_read(farm->scene.scene, &scene, &size);
    for (long k = 0; code == EXIT_GOOD && k < farm->count; k++) {
        name_run(farm, scene, size, &farm->run[k]);
        code = look_for(farm, &farm->run[k]);
    }
    free(scene);
    return code;
}

/* ---- directories ----------------------------------------------------------------------------- */

static int make_directories(const char *path) {
    char part[FARM_PATH];
    for (size_t k = 1;; k++) {
        if (k >= sizeof part) return errno = ENAMETOOLONG, fail(path, "cannot make the directory");
        if (path[k] && path[k] != '/') continue;
        snprintf(part, sizeof part, "%.*s", (int)k, path);
        if (mkdir(part, 0777) && errno != EEXIST) return fail(part, "cannot make the directory");
        if (!path[k]) return EXIT_GOOD;
    }
}

/* What a run that was killed has left. */
static void empty_directory(const char *path) {
    DIR *directory = opendir(path);
    for (struct dirent *entry; directory && (entry = readdir(directory));)
        unlinkat(dirfd(directory), entry->d_name, 0);
    if (directory) closedir(directory);
}

/* Takes the run's directory: *lock is its descriptor, -1 where another process has it. */
static int claim(const struct farm *farm, struct farm_run *run, int *lock) {
    char part[FARM_PATH];
    *lock = -1;
    if (!farm_path(part, farm, run, ".part")) return EXIT_BAD_INPUT;
    if (mkdir(part, 0777) && errno != EEXIST) return fail(part, "cannot make the directory");
    int descriptor = open(part, O_RDONLY | O_DIRECTORY);
    if (descriptor < 0) return errno == ENOENT ? EXIT_GOOD : fail(part, "cannot open");
    if (flock(descriptor, LOCK_EX | LOCK_NB)) {
        close(descriptor);
        return EXIT_GOOD;
    }
    int code = look_for(farm, run); /* ended in another process, in this moment? */
    if (code == EXIT_GOOD && run->status == FARM_MISSING) {
        empty_directory(part);
        *lock = descriptor;
        return EXIT_GOOD;
    }
    rmdir(part);
    close(descriptor);
    return code;
}

/* ---- one run --------------------------------------------------------------------------------- */

/* In a process of its own, which ends with the one that started it: `projdyn run`. */
static void be_run(const struct farm *farm, const struct farm_run *run, pid_t parent) {
    char part[FARM_PATH], threads[16];
    const char **argv = calloc(16 + 2 * (size_t)(run->sets + farm->scene.plugins), sizeof *argv);
    int argc = 0;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent || !argv || !farm_path(part, farm, run, ".part")) _exit(EXIT_FAILED);
    snprintf(threads, sizeof threads, "%d", farm->threads);
    const char *fixed[] = {"projdyn", "run",       farm->scene.scene, "--output", part,
                           "--quiet", "--threads", threads,           "--save",   "0"};
    for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++) argv[argc++] = fixed[k];
    if (!run->frames) argv[argc++] = "--no-frames";
    for (int k = 0; k < farm->scene.plugins; k++)
        argv[argc++] = "--plugin", argv[argc++] = farm->scene.plugin[k];
    for (int k = 0; k < run->sets; k++) argv[argc++] = "--set", argv[argc++] = run->set[k];
    execv("/proc/self/exe", (char **)argv);
    _exit(EXIT_FAILED);
}

static int redirect(const struct farm *farm, const struct farm_run *run) {
    char path[FARM_PATH];
    if (!farm_path(path, farm, run, ".part/log.txt")) return -1;
    int log = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    return log < 0 || dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0 ? -1 : 0;
}

static int start(const struct farm *farm, struct farm_run *run, struct worker *worker) {
    int code = claim(farm, run, &worker->lock);
    if (code != EXIT_GOOD || worker->lock < 0) return code;
    pid_t parent = getpid();
    fflush(NULL);
    worker->run = run;
    worker->pid = fork();
    if (worker->pid < 0) return worker->pid = 0, fail(farm->output, "cannot start a process");
    if (worker->pid > 0) return EXIT_GOOD;
    if (redirect(farm, run)) _exit(EXIT_FAILED);
    be_run(farm, run, parent);
    return EXIT_FAILED; /* not reached */
}

/* Its directory becomes what it is called, whole. */
static int finish(const struct farm *farm, struct worker *worker, int status,
                  const struct rusage *usage) {
    char part[FARM_PATH], path[FARM_PATH];
    double cpu = (double)usage->ru_utime.tv_sec + 1e-6 * (double)usage->ru_utime.tv_usec +
                 (double)usage->ru_stime.tv_sec + 1e-6 * (double)usage->ru_stime.tv_usec;
    if (!farm_path(part, farm, worker->run, ".part") || !farm_path(path, farm, worker->run, ""))
        return EXIT_BAD_INPUT;
    int code = result_write(part, worker->run, status, cpu);
    if (code == EXIT_GOOD && rename(part, path)) code = fail(path, "cannot rename the directory");
    if (code == EXIT_GOOD) worker->run->status = FARM_ENDED;
    close(worker->lock);
    worker->pid = 0;
    return code;
}

/* ---- all of them ----------------------------------------------------------------------------- */

static struct worker *find(struct worker *worker, int jobs, pid_t pid) {
    for (int k = 0; k < jobs; k++)
        if (worker[k].pid == pid) return &worker[k];
    return NULL;
}

static bool is_running(const struct farm *farm, const struct worker *worker,
                       const struct farm_run *run) {
    for (int k = 0; k < farm->jobs; k++)
        if (worker[k].pid && worker[k].run == run) return true;
    return false;
}

/* Gives idle workers what has not ended and nobody works on. */
static int start_all(const struct farm *farm, struct worker *worker) {
    int code = EXIT_GOOD;
    for (long k = 0; code == EXIT_GOOD && k < farm->count; k++) {
        struct worker *idle = find(worker, farm->jobs, 0);
        if (!idle) break;
        if (farm->run[k].status == FARM_MISSING && !is_running(farm, worker, &farm->run[k]))
            code = start(farm, &farm->run[k], idle);
    }
    return code;
}

static void tell(const struct farm *farm, const struct farm_run *run) {
    long ended = 0;
    char path[FARM_PATH];
    for (long k = 0; k < farm->count; k++) ended += farm->run[k].status == FARM_ENDED;
    if (farm->quiet || !farm_path(path, farm, run, "")) return;
    printf("%ld/%ld ", ended, farm->count);
    result_print(path, run);
    fflush(stdout);
}

/* A limit of the system's own would make the clock of the process a coarse one. */
static void end_late(const struct farm *farm, const struct worker *worker) {
    for (int k = 0; k < farm->jobs; k++) {
        clockid_t clock;
        struct timespec spent;
        if (!worker[k].pid || worker[k].run->limit_s == 0.0) continue;
        if (clock_getcpuclockid(worker[k].pid, &clock) || clock_gettime(clock, &spent)) continue;
        if ((double)spent.tv_sec > worker[k].run->limit_s) kill(worker[k].pid, SIGXCPU);
    }
}

static int wait_for_one(const struct farm *farm, struct worker *worker) {
    const struct timespec moment = {.tv_nsec = 5000000};
    int status;
    struct rusage usage;
    pid_t pid = wait4(-1, &status, WNOHANG, &usage);
    struct worker *ended = pid > 0 ? find(worker, farm->jobs, pid) : NULL;
    if (!ended) {
        end_late(farm, worker);
        nanosleep(&moment, NULL);
        return EXIT_GOOD;
    }
    struct farm_run *run = ended->run;
    int code = finish(farm, ended, status, &usage);
    if (code == EXIT_GOOD) tell(farm, run);
    return code;
}

static bool all_ended(const struct farm *farm) {
    for (long k = 0; k < farm->count; k++)
        if (farm->run[k].status != FARM_ENDED) return false;
    return true;
}

/* Runs that another process works on are looked at again until they have ended, or it has. */
static int work(struct farm *farm, struct worker *worker) {
    const struct timespec moment = {.tv_nsec = 100000000};
    int code = EXIT_GOOD;
    while (code == EXIT_GOOD && !all_ended(farm)) {
        code = start_all(farm, worker);
        bool busy = false;
        for (int k = 0; k < farm->jobs; k++) busy |= worker[k].pid > 0;
        if (code == EXIT_GOOD && busy) code = wait_for_one(farm, worker);
        else nanosleep(&moment, NULL);
        for (long k = 0; code == EXIT_GOOD && k < farm->count; k++)
            if (farm->run[k].status == FARM_MISSING) code = look_for(farm, &farm->run[k]);
    }
    return code;
}

int farm_work(struct farm *farm) {
    int code = make_directories(farm->output);
    struct worker *worker = calloc((size_t)farm->jobs, sizeof *worker);
    if (code == EXIT_GOOD && !worker) code = report_no_memory();
    if (code == EXIT_GOOD) code = work(farm, worker);
    free(worker);
    return code;
}
