/* The thread pool: shares of blocks, and workers that spin briefly before they sleep.
 *
 * A job ends when its blocks are done: nobody waits for workers that still sleep. A worker that
 * comes late finds no block of the job that it was called for; the number of the job beside the
 * count of blocks of every share keeps it from beginning a block of another. */
#include "pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

/* How often a waiting thread looks before it sleeps: 50 to 100 microseconds of pauses, longer than
 * the gap between two parallel regions of a CG iteration, then about half a millisecond in which
 * other processes may have its core. */
enum { PAUSES = 2000, LOOKS = PAUSES + 1000 };

static void pause_after(int look) {
    if (look >= PAUSES) sched_yield();
#if defined(__x86_64__) || defined(__i386__)
    else __builtin_ia32_pause();
#endif
}

/* The blocks of a job that one thread runs first. They are the same blocks in every job of the same
 * size, so that the thread finds its data in its cache. A thread that has finished its share
 * continues with blocks that other threads have not begun. */
struct share {
    _Alignas(64) atomic_ullong state; /* the job's number and the blocks not begun, 32 bits each */
};

struct worker {
    struct pool *pool;
    pthread_t thread;
    int number; /* index of its share; the calling thread has share 0 */
};

struct pool {
    int threads;
    pthread_mutex_t caller; /* held by the thread whose job the workers run */
    pid_t process;          /* a forked child has no workers */
    struct worker *worker;  /* threads - 1 workers: the calling thread works, too */
    struct share *share;    /* one share per thread */
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    atomic_uint job;       /* number of the current job; workers wait for it to change */
    atomic_int sleepers;   /* workers that wait for `wake` */
    atomic_int unfinished; /* blocks of the current job that are not done */
    atomic_bool stop;
    int count, grain, blocks; /* of the current job: constant while one of its blocks runs */
    pdyn_range_fn *fn;
    void *arg;
};

static unsigned long long share_state(unsigned job, int blocks) {
    return (unsigned long long)job << 32 | (unsigned)blocks;
}

/* First block of share k. */
static int share_begin(const struct pool *pool, int k) {
    return (int)((long long)pool->blocks * k / pool->threads);
}

/* Begins a block of a share in this job. Returns the number of its blocks that were not begun
 * before, 0: none, or the share has blocks of another job. */
static int take_block(struct share *share, unsigned job) {
    unsigned long long state = atomic_load_explicit(&share->state, memory_order_relaxed);
    while (state >> 32 == job && (unsigned)state)
        if (atomic_compare_exchange_weak_explicit(&share->state, &state, state - 1,
                                                  memory_order_acquire, memory_order_relaxed))
            return (int)(unsigned)state;
    return 0;
}

/* Returns the number of blocks that it has run. */
static int run_share(struct pool *pool, int k, unsigned job) {
    int done = 0;
    for (int left; (left = take_block(&pool->share[k], job)); done++) {
        int block = share_begin(pool, k + 1) - left, first = block * pool->grain;
        int last = pool->count - first > pool->grain ? first + pool->grain : pool->count;
        pool->fn(pool->arg, first, last, block);
    }
    return done;
}

/* Runs the blocks of the thread's share, then blocks of other shares that no thread has begun.
 * Returns whether the job ended with one of them. */
static bool run_blocks(struct pool *pool, int number, unsigned job) {
    int done = 0;
    for (int k = 0; k < pool->threads; k++)
        done += run_share(pool, (number + k) % pool->threads, job);
    return done && atomic_fetch_sub(&pool->unfinished, done) == done;
}

/* Wakes a worker, if one sleeps. */
static void wake_worker(struct pool *pool) {
    if (!atomic_load(&pool->sleepers)) return;
    pthread_mutex_lock(&pool->lock);
    pthread_cond_signal(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
}

static void sleep_until_job(struct pool *pool, unsigned seen) {
    pthread_mutex_lock(&pool->lock);
    atomic_fetch_add(&pool->sleepers, 1);
    while (atomic_load(&pool->job) == seen) pthread_cond_wait(&pool->wake, &pool->lock);
    atomic_fetch_sub(&pool->sleepers, 1);
    pthread_mutex_unlock(&pool->lock);
}

/* Waits until the job number differs from `seen`; returns the new number. A worker that slept wakes
 * two others: the caller is not held up by it, and all are awake after few rounds. */
static unsigned wait_job(struct pool *pool, unsigned seen) {
    for (int i = 0; i < LOOKS; pause_after(i++))
        if (atomic_load_explicit(&pool->job, memory_order_acquire) != seen)
            return atomic_load_explicit(&pool->job, memory_order_acquire);
    sleep_until_job(pool, seen);
    for (int k = 0; k < 2 && atomic_load(&pool->unfinished); k++) wake_worker(pool);
    return atomic_load(&pool->job);
}

static void *worker_main(void *arg) {
    const struct worker *worker = arg;
    struct pool *pool = worker->pool;
    for (unsigned seen = 0;;) {
        seen = wait_job(pool, seen);
        if (pool->stop) return NULL;
        if (run_blocks(pool, worker->number, seen)) {
            pthread_mutex_lock(&pool->lock);
            pthread_cond_signal(&pool->done);
            pthread_mutex_unlock(&pool->lock);
        }
    }
}

/* Divides the blocks of a job among the threads. Returns the number of the job. */
static unsigned start_job(struct pool *pool) {
    unsigned job = atomic_load(&pool->job) + 1;
    atomic_store(&pool->unfinished, pool->blocks);
    for (int k = 0; k < pool->threads; k++) {
        int blocks = share_begin(pool, k + 1) - share_begin(pool, k);
        atomic_store_explicit(&pool->share[k].state, share_state(job, blocks),
                              memory_order_release);
    }
    atomic_store(&pool->job, job);
    return job;
}

static void wait_done(struct pool *pool) {
    for (int i = 0; i < LOOKS; pause_after(i++))
        if (!atomic_load_explicit(&pool->unfinished, memory_order_acquire)) return;
    pthread_mutex_lock(&pool->lock);
    while (atomic_load(&pool->unfinished)) pthread_cond_wait(&pool->done, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

static void run_alone(int count, int grain, pdyn_range_fn *fn, void *arg) {
    int blocks = pool_blocks(count, grain);
    for (int b = 0; b < blocks; b++)
        fn(arg, b * grain, b + 1 < blocks ? (b + 1) * grain : count, b);
}

void pool_for(struct pool *pool, int count, int grain, pdyn_range_fn *fn, void *arg) {
    int blocks = pool_blocks(count, grain);
    if (pool->threads == 1 || blocks <= 1 || pthread_mutex_trylock(&pool->caller)) {
        run_alone(count, grain, fn, arg);
        return;
    }
    pool->count = count, pool->grain = grain, pool->blocks = blocks, pool->fn = fn, pool->arg = arg;
    unsigned job = start_job(pool);
    wake_worker(pool);
    if (!run_blocks(pool, 0, job)) wait_done(pool);
    pthread_mutex_unlock(&pool->caller);
}

struct shifted {
    pdyn_range_fn *fn;
    void *arg;
    int by;
};

static void run_shifted(void *arg, int first, int last, int block) {
    const struct shifted *s = arg;
    s->fn(s->arg, s->by + first, s->by + last, block);
}

int pool_for_between(struct pool *pool, int first, int last, int grain, pdyn_range_fn *fn,
                     void *arg) {
    pool_for(pool, last - first, grain, run_shifted, &(struct shifted){fn, arg, first});
    return pool_blocks(last - first, grain);
}

void pool_check_process(struct pool *pool) {
    if (pool->process == getpid()) return;
    pool->threads = 1, pool->process = getpid();
}

struct pool *pool_create(int threads) {
    struct pool *pool = calloc(1, sizeof *pool);
    if (!pool) return NULL;
    pool->process = getpid();
    pthread_mutex_init(&pool->lock, NULL);
    pthread_mutex_init(&pool->caller, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool->threads = 1;
    pool->worker = calloc((size_t)threads, sizeof *pool->worker);
    pool->share = aligned_alloc(sizeof *pool->share, (size_t)threads * sizeof *pool->share);
    while (pool->worker && pool->share && pool->threads < threads) {
        struct worker *w = &pool->worker[pool->threads - 1];
        *w = (struct worker){.pool = pool, .number = pool->threads};
        if (pthread_create(&w->thread, NULL, worker_main, w)) break;
        pool->threads++;
    }
    if (pool->threads == threads && pool->worker && pool->share) return pool;
    pool_destroy(pool);
    return NULL;
}

/* Not in a forked child: workers of its parent wait on the conditions, and to destroy a condition
 * waits for them. */
static void end_workers(struct pool *pool) {
    pool->stop = true;
    pool->blocks = 0;
    start_job(pool);
    pthread_mutex_lock(&pool->lock);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    for (int i = 0; i + 1 < pool->threads; i++) pthread_join(pool->worker[i].thread, NULL);
    pthread_cond_destroy(&pool->wake);
    pthread_cond_destroy(&pool->done);
    pthread_mutex_destroy(&pool->lock);
    pthread_mutex_destroy(&pool->caller);
}

void pool_destroy(struct pool *pool) {
    pool_check_process(pool);
    if (pool->threads > 1) end_workers(pool);
    free(pool->worker), free(pool->share);
    free(pool);
}
