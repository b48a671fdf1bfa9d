/* The thread pool: shares of blocks, and workers that spin briefly before they sleep. */
#include "pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    SPINS = 2000
}; /* busy-wait of about 50 microseconds, longer than the gap between two parallel regions of a CG
    * iteration: threads then do not sleep within a solve */

static void pause_cpu(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

/* The blocks of a job that one thread runs first. They are the same blocks in every job of the same
 * size, so that the thread finds its data in its cache. A thread that has finished its share
 * continues with blocks that other threads have not begun. */
struct share {
    _Alignas(64) atomic_int next; /* next block to run */
    int end;
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
    atomic_uint job; /* number of the current job; workers wait for it to change */
    atomic_int busy; /* workers that have not finished the current job */
    bool stop;
    int count, grain, blocks;
    pdyn_range_fn *fn;
    void *arg;
};

static void run_share(struct pool *pool, struct share *share) {
    for (;;) {
        int block = atomic_fetch_add_explicit(&share->next, 1, memory_order_relaxed);
        if (block >= share->end) return;
        int first = block * pool->grain;
        int last = pool->count - first > pool->grain ? first + pool->grain : pool->count;
        pool->fn(pool->arg, first, last, block);
    }
}

/* Runs the blocks of the thread's share, then blocks of other shares that no thread has begun. */
static void run_blocks(struct pool *pool, int number) {
    for (int k = 0; k < pool->threads; k++)
        run_share(pool, &pool->share[(number + k) % pool->threads]);
}

/* Waits until the job number differs from `seen`; returns the new number. */
static unsigned wait_job(struct pool *pool, unsigned seen) {
    for (int i = 0; i < SPINS; i++, pause_cpu())
        if (atomic_load_explicit(&pool->job, memory_order_acquire) != seen)
            return atomic_load_explicit(&pool->job, memory_order_acquire);
    pthread_mutex_lock(&pool->lock);
    while (atomic_load(&pool->job) == seen) pthread_cond_wait(&pool->wake, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
    return atomic_load(&pool->job);
}

static void *worker_main(void *arg) {
    const struct worker *worker = arg;
    struct pool *pool = worker->pool;
    for (unsigned seen = 0;;) {
        seen = wait_job(pool, seen);
        if (pool->stop) return NULL;
        run_blocks(pool, worker->number);
        if (atomic_fetch_sub(&pool->busy, 1) == 1) {
            pthread_mutex_lock(&pool->lock);
            pthread_cond_signal(&pool->done);
            pthread_mutex_unlock(&pool->lock);
        }
    }
}

/* Divides the blocks of a job among the threads and wakes the workers. */
static void start_job(struct pool *pool) {
    pthread_mutex_lock(&pool->lock);
    for (int k = 0; k < pool->threads; k++) {
        struct share *share = &pool->share[k];
        int begin = (int)((long long)pool->blocks * k / pool->threads);
        atomic_store_explicit(&share->next, begin, memory_order_relaxed);
        share->end = (int)((long long)pool->blocks * (k + 1) / pool->threads);
    }
    atomic_store(&pool->busy, pool->threads - 1);
    atomic_fetch_add_explicit(&pool->job, 1, memory_order_release);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
}

static void wait_done(struct pool *pool) {
    for (int i = 0; i < SPINS; i++, pause_cpu())
        if (!atomic_load_explicit(&pool->busy, memory_order_acquire)) return;
    pthread_mutex_lock(&pool->lock);
    while (atomic_load(&pool->busy)) pthread_cond_wait(&pool->done, &pool->lock);
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
    start_job(pool);
    run_blocks(pool, 0);
    wait_done(pool);
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
    pool->stop = true, pool->blocks = 0;
    start_job(pool);
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
