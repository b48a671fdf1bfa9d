/* Directories of jobs: the key that names them, status and lock (jobs.h shows the layout). */
#include "job_directory.h"
#include "job_inputs.h"
#include "read_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

int job_report_errno(const char *path, const char *what) {
    fprintf(stderr, "projdyn: %s: %s: %s\n", path, what, strerror(errno));
    return EXIT_FAILED;
}

/* ---- names ----------------------------------------------------------------------------------- */

bool job_path(char path[JOB_PATH], const struct jobs *jobs, const struct job *job,
              const char *ending) {
    int length = snprintf(path, JOB_PATH, "%s/%s%s", jobs->output, job->key, ending);
    if (length >= 0 && length < JOB_PATH) return true;
    fprintf(stderr, "projdyn: --output: the path is too long\n");
    return false;
}

/* The files that the value of an override PATH=VALUE names. */
static uint64_t hash_override_files(uint64_t hash, const char *scene, const char *override) {
    const char *text = strchr(override, '=');
    if (!text) return hash;
    json_t *value = json_loads(text + 1, JSON_DECODE_ANY, NULL);
    if (!value) value = json_string(text + 1);
    hash = hash_named_files(hash, scene, value);
    json_decref(value);
    return hash;
}

/* The hash of what all jobs have. */
static int hash_jobs(const struct jobs *jobs, uint64_t *hash) {
    char *text;
    size_t size;
    int code = read_file(jobs->scene.scene, &text, &size);
    if (code != EXIT_GOOD) return code;
    *hash = hash_text(hash_start, text, size);
    json_t *scene = json_loadb(text, size, 0, NULL);
    *hash = hash_named_files(*hash, jobs->scene.scene, scene);
    json_decref(scene);
    free(text);
    for (int k = 0; k < jobs->scene.plugins; k++) {
        const char *path = jobs->scene.plugin[k];
        *hash = hash_file(hash_text(*hash, path, strlen(path)), path);
    }
    *hash = hash_text(*hash, pdyn_version(), strlen(pdyn_version()));
    return EXIT_GOOD;
}

static void compute_key(const struct jobs *jobs, uint64_t hash, struct job *job) {
    for (int k = 0; k < job->sets; k++) {
        hash = hash_text(hash, job->set[k], strlen(job->set[k]));
        hash = hash_override_files(hash, jobs->scene.scene, job->set[k]);
    }
    if (job->frames) hash = hash_text(hash, "", 0);
    if (job->limit_s > 0.0) {
        int length = snprintf(job->key, sizeof job->key, "%.9g", job->limit_s);
        hash = hash_text(hash, job->key, (size_t)length);
    }
    snprintf(job->key, sizeof job->key, "%016llx", (unsigned long long)hash);
}

/* ---- status ---------------------------------------------------------------------------------- */

int job_update_status(const struct jobs *jobs, struct job *job) {
    char path[JOB_PATH];
    if (!job_path(path, jobs, job, "")) return EXIT_BAD_INPUT;
    job->status = access(path, F_OK) ? JOB_PENDING : JOB_FINISHED;
    return EXIT_GOOD;
}

int jobs_find_finished(struct jobs *jobs) {
    uint64_t hash;
    int code = hash_jobs(jobs, &hash);
    for (long k = 0; code == EXIT_GOOD && k < jobs->count; k++) {
        compute_key(jobs, hash, &jobs->job[k]);
        code = job_update_status(jobs, &jobs->job[k]);
    }
    return code;
}

/* ---- directories ----------------------------------------------------------------------------- */

int job_make_directories(const char *path) {
    static const char what[] = "cannot make the directory";
    char part[JOB_PATH];
    for (size_t k = 1;; k++) {
        if (k >= sizeof part) return errno = ENAMETOOLONG, job_report_errno(path, what);
        if (path[k] && path[k] != '/') continue;
        snprintf(part, sizeof part, "%.*s", (int)k, path);
        if (mkdir(part, 0777) && errno != EEXIST) return job_report_errno(part, what);
        if (!path[k]) return EXIT_GOOD;
    }
}

/* Removes the files that a killed job left in its directory. */
static void empty_directory(const char *path) {
    DIR *directory = opendir(path);
    for (struct dirent *entry; directory && (entry = readdir(directory));)
        unlinkat(dirfd(directory), entry->d_name, 0);
    if (directory) closedir(directory);
}

int job_lock(const struct jobs *jobs, struct job *job, int *lock) {
    char part[JOB_PATH];
    *lock = -1;
    if (!job_path(part, jobs, job, ".part")) return EXIT_BAD_INPUT;
    if (mkdir(part, 0777) && errno != EEXIST)
        return job_report_errno(part, "cannot make the directory");
    int descriptor = open(part, O_RDONLY | O_DIRECTORY);
    /* ENOENT: another process has finished the job and renamed the directory. */
    if (descriptor < 0) return errno == ENOENT ? EXIT_GOOD : job_report_errno(part, "cannot open");
    if (flock(descriptor, LOCK_EX | LOCK_NB)) {
        close(descriptor);
        return EXIT_GOOD;
    }
    /* Another process may have finished the job after this process read its status. */
    int code = job_update_status(jobs, job);
    if (code == EXIT_GOOD && job->status == JOB_PENDING) {
        empty_directory(part);
        *lock = descriptor;
        return EXIT_GOOD;
    }
    rmdir(part);
    close(descriptor);
    return code;
}
