/* A parallel loop on POSIX threads. */
#ifndef MESH_PARALLEL_H
#define MESH_PARALLEL_H

/* Calls run(self, first, last) for consecutive ranges of at most `grain` indices that cover 0 to
 * count - 1, on up to `threads` threads. Ranges do not depend on the number of threads. */
void parallel_for(int threads, int count, int grain, void (*run)(void *self, int first, int last),
                  void *self);

#endif
