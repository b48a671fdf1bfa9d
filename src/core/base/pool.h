/* A thread pool (pthreads) with one operation: call a function on [0, count) in blocks of a fixed
 * grain.
 *
 * The grain does not depend on the number of threads: the blocks, and with them every partial sum,
 * are the same for any number. Work that fits one block runs on the calling thread alone. */
#ifndef PDYN_POOL_H
#define PDYN_POOL_H

#include "projdyn/module.h"

struct pool;

struct pool *pool_create(int threads); /* threads: the caller's included. NULL: no memory, or a
                                          thread could not be created. */
void pool_destroy(struct pool *pool);

/* Calls fn(arg, first, last, block) for every block, on all threads; returns when every block is
 * done. While the workers run a job of another thread, or from within a block, the calling thread
 * runs all blocks alone: the results are the same. */
void pool_for(struct pool *pool, int count, int grain, pdyn_range_fn *fn, void *arg);

/* The same on [first, last). Returns the number of blocks. */
int pool_for_between(struct pool *pool, int first, int last, int grain, pdyn_range_fn *fn,
                     void *arg);

/* Call it where a job may begin in a forked child: it has none of the workers, and runs alone. */
void pool_check_process(struct pool *pool);

/* Number of blocks that pool_for makes. */
static inline int pool_blocks(int count, int grain) { return (count + grain - 1) / grain; }

#endif
