/* Memory of a solver, by the services of its model: zeroed, and counted for the context; and the
 * sizes of its arrays. */
#ifndef PDYN_SOLVER_MEMORY_H
#define PDYN_SOLVER_MEMORY_H

#include "projdyn/module.h"

/* `count` zeroed numbers of a type; NULL: count is 0, or no memory. */
#define NEW(services, count, type)                                                                 \
    ((type *)(services)->allocate((services)->core, NULL, 0, (size_t)(count) * sizeof(type)))
/* The same `count`; FREE of NULL does nothing. */
#define FREE(services, pointer, count)                                                             \
    ((void)(services)->allocate((services)->core, (void *)(pointer),                               \
                                (size_t)(count) * sizeof *(pointer), 0),                           \
     (pointer) = NULL)

/* Numbers of a vector: particles x 3, with room to load the last particle's part as four. */
static inline size_t vector_size(const pdyn_model *model) {
    return 3 * (size_t)model->particles + 1;
}

/* Blocks of a parallel loop, e.g. for one partial sum each. */
static inline int block_count(int count, int grain) { return (count + grain - 1) / grain; }

#endif
