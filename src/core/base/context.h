/* The context: memory, errors, messages, threads. Everything else in core hangs on one. */
#ifndef PDYN_CONTEXT_H
#define PDYN_CONTEXT_H

#include "pool.h"
#include "projdyn/projdyn.h"

#include <pthread.h>
#include <stdarg.h>

enum { MOST_PLUGINS = 64 };

struct pdyn_context {
    pdyn_options options;
    struct pool *pool;
    pthread_mutex_t memory_lock;
    size_t bytes, peak_bytes;
    char error[2048];
    int plugins;
    const struct pdyn_plugin
        *plugin[MOST_PLUGINS]; /* what is registered; the library's own first */
};

/* Memory. Sizes are given back on release, so that the live count is exact. New memory is zeroed.
 * context_resize: block NULL allocates, new_size 0 frees and returns NULL. */
void *context_resize(pdyn_context *context, void *block, size_t old_size, size_t new_size);

/* count x size zeroed bytes, or NULL with the context's error set; count 0 gives NULL too.
 * FREE_ARRAY of NULL does nothing. */
void *context_array(pdyn_context *context, size_t count, size_t size);

#define NEW_ARRAY(context, count, type)                                                            \
    ((type *)context_array(context, (size_t)(count), sizeof(type)))
#define FREE_ARRAY(context, pointer, count)                                                        \
    ((void)context_resize(context, (void *)(pointer), (size_t)(count) * sizeof *(pointer), 0),     \
     (pointer) = NULL)

/* A vector of the system, particles x 3, with room to load the last particle's part as four. */
#define NEW_VECTOR(context, particles) NEW_ARRAY(context, 3 * (size_t)(particles) + 1, double)
#define FREE_VECTOR(context, pointer, particles)                                                   \
    FREE_ARRAY(context, pointer, 3 * (size_t)(particles) + 1)

/* Sets the error text and returns the status. */
pdyn_status context_fail(pdyn_context *context, pdyn_status status, const char *format, ...)
    PDYN_PRINTF(3, 4);
pdyn_status context_no_memory(pdyn_context *context);
void context_log(pdyn_context *context, pdyn_log_level level, const char *format, ...)
    PDYN_PRINTF(3, 4);

#endif
