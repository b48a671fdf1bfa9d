/* The thread pool: shares of blocks, and workers that spin briefly before they sleep.
 *
 * A job ends when its blocks are done, also while some workers still sleep. A share stores the pair
 * (job number, blocks left). A late worker compares the job number and takes no block of a newer
 * job. */
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
    _Alignas(64) atomic_ullong state; /* the job's number and the blocks not begun, as a pair */
};

struct worker {
    struct pool *pool;
    pthread_t thread;
    pthread_cond_t wake;
    atomic_bool asleep;
    int number; /* index of its share; the calling thread has share 0 */
};

struct pool {
    int threads;
    pthread_mutex_t caller; /* held by the thread whose job the workers run */
    pid_t process;          /* a forked child has no workers */
    struct worker *worker;  /* threads - 1 workers: the calling thread works, too */
    struct share *share;    /* one share per thread */
    pthread_mutex_t lock;   /* of threads that sleep */
    pthread_cond_t done;
    atomic_ullong job;     /* number of the current job and its shares, as a pair */
    atomic_int unfinished; /* blocks of the current job that are not done */
    atomic_bool stop;
    int count, grain, blocks; /* of the current job: constant while one of its blocks runs */
    pdyn_range_fn *fn;
    void *arg;
};

/* Two numbers that are read and written at once. */
static unsigned long long pair_of(unsigned number, int count) {
    return (unsigned long long)number << 32 | (unsigned)count;
}
static unsigned number_of(unsigned long long pair) { return (unsigned)(pair >> 32); }
static int count_of(unsigned long long pair) { return (int)(unsigned)pair; }

/* ---- work ------------------------------------------------------------------------------------ */

/* First block of share k. */
static int share_begin(const struct pool *pool, int shares, int k) {
    return (int)((long long)pool->blocks * k / shares);
}

/* Begins a block of a share in this job. Returns the number of its blocks that were not begun
 * before, 0: none, or the share has blocks of another job. */
static int take_block(struct share *share, unsigned job) {
    unsigned long long state = atomic_load_explicit(&share->state, memory_order_relaxed);
    while (number_of(state) == job && count_of(state))
        if (atomic_compare_exchange_weak_explicit(&share->state, &state, state - 1,
                                                  memory_order_acquire, memory_order_relaxed))
            return count_of(state);
    return 0;
}

/* Returns the number of blocks that it has run. */
static int run_share(struct pool *pool, int k, unsigned long long job) {
    int done = 0;
    for (int left; (left = take_block(&pool->share[k], number_of(job))); done++) {
        int block = share_begin(pool, count_of(job), k + 1) - left, first = block * pool->grain;
        int last = pool->count - first > pool->grain ? first + pool->grain : pool->count;
        pool->fn(pool->arg, first, last, block);
    }
    return done;
}

/* Runs the blocks of the thread's share, then blocks of other shares that no thread has begun.
 * Returns whether the job ended with one of them. */
static bool run_blocks(struct pool *pool, int number, unsigned long long job) {
    int done = 0, shares = count_of(job);
    for (int k = 0; k < shares; k++) done += run_share(pool, (number + k) % shares, job);
    return done && atomic_fetch_sub(&pool->unfinished, done) == done;
}

/* ---- workers --------------------------------------------------------------------------------- */

static bool has_share(const struct worker *w, unsigned long long job, unsigned long long seen) {
    return job != seen && w->number < count_of(job);
}

static void send_signal(struct pool *pool, pthread_cond_t *to) {
    pthread_mutex_lock(&pool->lock);
    pthread_cond_signal(to);
    pthread_mutex_unlock(&pool->lock);
}

/* Wakes up to two workers that sleep and have a share of the job. These do the same: the caller is
 * not held up, and all are awake after few rounds. */
static void wake_two(struct pool *pool, unsigned long long job) {
    for (int k = 1, woken = 0; k < count_of(job) && woken < 2; k++) {
        struct worker *w = &pool->worker[k - 1];
        if (!atomic_load(&w->asleep) || !atomic_exchange(&w->asleep, false)) continue;
        send_signal(pool, &w->wake);
        woken++;
    }
}

static void sleep_until_job(struct worker *w, unsigned long long seen) {
    pthread_mutex_lock(&w->pool->lock);
    for (;;) {
        atomic_store(&w->asleep, true);
        if (has_share(w, atomic_load(&w->pool->job), seen)) break;
        pthread_cond_wait(&w->wake, &w->pool->lock);
    }
    atomic_store(&w->asleep, false);
    pthread_mutex_unlock(&w->pool->lock);
}

/* Waits for a job other than `seen` in which the worker has a share. */
static unsigned long long wait_job(struct worker *w, unsigned long long seen) {
    for (int i = 0; i < LOOKS; pause_after(i++)) {
        unsigned long long job = atomic_load_explicit(&w->pool->job, memory_order_acquire);
        if (has_share(w, job, seen)) return job;
    }
    sleep_until_job(w, seen);
    unsigned long long job = atomic_load(&w->pool->job);
    if (atomic_load(&w->pool->unfinished)) wake_two(w->pool, job);
    return job;
}

static void *worker_main(void *arg) {
    struct worker *worker = arg;
    struct pool *pool = worker->pool;
    for (unsigned long long job = 0;;) {
        job = wait_job(worker, job);
        if (pool->stop) return NULL;
        if (run_blocks(pool, worker->number, job)) send_signal(pool, &pool->done);
    }
}

/* ---- jobs ------------------------------------------------------------------------------------ */

/* Divides the blocks of a job among as many threads as have one: others do not take part. */
static unsigned long long start_job(struct pool *pool, int shares) {
    unsigned long long job = pair_of(number_of(atomic_load(&pool->job)) + 1, shares);
    atomic_store(&pool->unfinished, pool->blocks);
    for (int k = 0; k < shares; k++) {
        int blocks = share_begin(pool, shares, k + 1) - share_begin(pool, shares, k);
        atomic_store_explicit(&pool->share[k].state, pair_of(number_of(job), blocks),
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
    unsigned long long job = start_job(pool, blocks < pool->threads ? blocks : pool->threads);
    wake_two(pool, job);
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
    pthread_cond_init(&pool->done, NULL);
    pool->threads = 1;
    pool->worker = calloc((size_t)threads, sizeof *pool->worker);
    pool->share = aligned_alloc(sizeof *pool->share, (size_t)threads * sizeof *pool->share);
    while (pool->worker && pool->share && pool->threads < threads) {
        struct worker *w = &pool->worker[pool->threads - 1];
        w->pool = pool, w->number = pool->threads;
        pthread_cond_init(&w->wake, NULL);
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
    start_job(pool, pool->threads);
    for (struct worker *w = pool->worker; w < pool->worker + pool->threads - 1; w++) {
        send_signal(pool, &w->wake);
        pthread_join(w->thread, NULL);
        pthread_cond_destroy(&w->wake);
    }
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
