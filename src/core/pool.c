#include "pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { SPINS = 2000 }; /* some 50 microseconds: longer than between the regions of a CG iteration */

static void relax(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

struct pool {
    int threads;
    pthread_t *worker; /* threads - 1: the caller works too */
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    atomic_uint job; /* number of the current job; workers wait for it to move */
    atomic_int next; /* next block to take */
    atomic_int busy; /* workers still in the current job */
    bool stop;
    int count, grain, blocks;
    pdyn_range_fn *fn;
    void *arg;
};

static void work(struct pool *pool) {
    for (;;) {
        int block = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (block >= pool->blocks) return;
        int first = block * pool->grain;
        int last = pool->count - first > pool->grain ? first + pool->grain : pool->count;
        pool->fn(pool->arg, first, last, block);
    }
}

/* Waits for a job other than `seen`: spins a moment, then sleeps. */
static unsigned wait_job(struct pool *pool, unsigned seen) {
    for (int i = 0; i < SPINS; i++, relax())
        if (atomic_load_explicit(&pool->job, memory_order_acquire) != seen)
            return atomic_load_explicit(&pool->job, memory_order_acquire);
    pthread_mutex_lock(&pool->lock);
    while (atomic_load(&pool->job) == seen) pthread_cond_wait(&pool->wake, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
    return atomic_load(&pool->job);
}

static void *worker_main(void *arg) {
    struct pool *pool = arg;
    for (unsigned seen = 0;;) {
        seen = wait_job(pool, seen);
        if (pool->stop) return NULL;
        work(pool);
        if (atomic_fetch_sub(&pool->busy, 1) == 1) {
            pthread_mutex_lock(&pool->lock);
            pthread_cond_signal(&pool->done);
            pthread_mutex_unlock(&pool->lock);
        }
    }
}

static void post(struct pool *pool) {
    pthread_mutex_lock(&pool->lock);
    atomic_store(&pool->next, 0);
    atomic_store(&pool->busy, pool->threads - 1);
    atomic_fetch_add_explicit(&pool->job, 1, memory_order_release);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
}

static void wait_done(struct pool *pool) {
    for (int i = 0; i < SPINS; i++, relax())
        if (!atomic_load_explicit(&pool->busy, memory_order_acquire)) return;
    pthread_mutex_lock(&pool->lock);
    while (atomic_load(&pool->busy)) pthread_cond_wait(&pool->done, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

void pool_for(struct pool *pool, int count, int grain, pdyn_range_fn *fn, void *arg) {
    int blocks = pool_blocks(count, grain);
    if (pool->threads == 1 || blocks <= 1) {
        for (int b = 0; b < blocks; b++)
            fn(arg, b * grain, b + 1 < blocks ? (b + 1) * grain : count, b);
        return;
    }
    pool->count = count, pool->grain = grain, pool->blocks = blocks, pool->fn = fn, pool->arg = arg;
    post(pool);
    work(pool);
    wait_done(pool);
}

struct pool *pool_create(int threads) {
    struct pool *pool = calloc(1, sizeof *pool);
    if (!pool) return NULL;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool->threads = 1;
    pool->worker = calloc((size_t)threads, sizeof *pool->worker);
    while (pool->worker && pool->threads < threads &&
           !pthread_create(&pool->worker[pool->threads - 1], NULL, worker_main, pool))
        pool->threads++;
    if (pool->threads == threads && pool->worker) return pool;
    pool_destroy(pool);
    return NULL;
}

void pool_destroy(struct pool *pool) {
    pool->stop = true;
    post(pool);
    for (int i = 0; i + 1 < pool->threads; i++) pthread_join(pool->worker[i], NULL);
    pthread_cond_destroy(&pool->wake);
    pthread_cond_destroy(&pool->done);
    pthread_mutex_destroy(&pool->lock);
    free(pool->worker);
    free(pool);
}

int pool_threads(const struct pool *pool) { return pool->threads; }
