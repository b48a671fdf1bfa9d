/* A parallel loop on POSIX threads: each thread takes the next range until none is left. */
#include "parallel.h"

#include <pthread.h>
#include <stdatomic.h>

enum { MOST_THREADS = 1024 };

struct loop {
    atomic_long next; /* first index of the next range */
    int count, grain;
    void (*run)(void *self, int first, int last);
    void *self;
};

static void *work(void *data) {
    struct loop *loop = data;
    for (long first; (first = atomic_fetch_add(&loop->next, loop->grain)) < loop->count;) {
        long last = first + loop->grain;
        loop->run(loop->self, (int)first, last < loop->count ? (int)last : loop->count);
    }
    return NULL;
}

/* The calling thread works, too: the loop ends even if no thread can be started. */
void parallel_for(int threads, int count, int grain, void (*run)(void *self, int first, int last),
                  void *self) {
    struct loop loop = {.count = count, .grain = grain, .run = run, .self = self};
    pthread_t thread[MOST_THREADS];
    int started = 0, ranges = count / grain + 1;
    while (started + 1 < threads && started + 1 < ranges && started < MOST_THREADS &&
           !pthread_create(&thread[started], NULL, work, &loop))
        started++;
    work(&loop);
    while (started) pthread_join(thread[--started], NULL);
}
