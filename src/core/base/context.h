/* The context (pdyn_context): memory, log messages, thread pool and registered types.
 * Every object of the library belongs to one context. */
#ifndef PDYN_CONTEXT_H
#define PDYN_CONTEXT_H

#include "error.h"
#include "pool.h"
#include "projdyn/projdyn.h"

#include <pthread.h>
#include <stdarg.h>

enum { MAX_PLUGINS = 64 };

struct pdyn_context {
    pdyn_options options;
    struct pool *pool;
    pthread_mutex_t lock; /* of bytes and peak_bytes */
    size_t bytes, peak_bytes;
    int plugins;
    const struct pdyn_plugin *plugin[MAX_PLUGINS]; /* entry 0: the library's own types */
};

/* Allocates, resizes or frees memory through the user's allocator and counts the bytes in use.
 * block NULL allocates; new_size 0 frees and returns NULL. old_size is the size of `block`, so that
 * the count is exact. New bytes are zeroed. Returns NULL without memory; sets no error text. */
void *context_resize(pdyn_context *context, void *block, size_t old_size, size_t new_size);

/* Allocates count x size zeroed bytes. Returns NULL for 0 bytes, and NULL with the error
 * set (PDYN_NO_MEMORY) without memory. FREE_ARRAY of a NULL pointer does nothing. */
void *context_array(pdyn_context *context, size_t count, size_t size);

/* A copy of a text; NULL with the error set without memory. */
char *context_copy_text(pdyn_context *context, const char *text);
void context_free_text(pdyn_context *context, const char *text); /* NULL: does nothing */

/* Makes room for `need` elements in a growing array of *capacity elements: at least doubles the
 * capacity where it is too small. Returns the array, which may have moved; NULL with the
 * error set without memory, the array is then unchanged. */
void *context_grow(pdyn_context *context, void *array, size_t *capacity, size_t need, size_t size);

#define NEW_ARRAY(context, count, type)                                                            \
    ((type *)context_array(context, (size_t)(count), sizeof(type)))
#define FREE_ARRAY(context, pointer, count)                                                        \
    ((void)context_resize(context, (void *)(pointer), (size_t)(count) * sizeof *(pointer), 0),     \
     (pointer) = NULL)

/* A vector of 3 doubles per particle, plus one double: code that loads four doubles at once
 * (simd.h) may then read past the last particle. */
#define VECTOR_LENGTH(particles)       (3 * (size_t)(particles) + 1)
#define NEW_VECTOR(context, particles) NEW_ARRAY(context, VECTOR_LENGTH(particles), double)
#define FREE_VECTOR(context, pointer, particles)                                                   \
    FREE_ARRAY(context, pointer, VECTOR_LENGTH(particles))

/* Array tables. A struct with several arrays lists them once, and one function allocates or frees
 * them all:
 *
 *     static bool resize_arrays(struct mesh *m, enum array_action action) {
 *         const struct array_entry table[] = {ARRAY(m->vertex, 3 * m->vertices),
 *                                             ARRAY(m->triangle, 3 * m->triangles)};
 *         return context_arrays(m->context, table, ARRAY_ROWS(table), action);
 *     } */
struct array_entry {
    void *pointer; /* address of the pointer to the array */
    size_t count, size;
};
#define ARRAY(pointer, count)                                                                      \
    { &(pointer), (size_t)(count), sizeof *(pointer) }
#define ARRAY_ROWS(table) (sizeof(table) / sizeof *(table))

enum array_action { ARRAYS_ALLOCATE, ARRAYS_FREE };

/* Allocates (zeroed) or frees every array of a table. Returns false if memory is missing for one
 * array; the others are allocated and have to be freed by the caller. An array of count 0 stays
 * NULL, and a pointer that is freed becomes NULL. */
bool context_arrays(pdyn_context *context, const struct array_entry *table, size_t rows,
                    enum array_action action);

pdyn_status context_no_memory(pdyn_context *context);
void context_log(pdyn_context *context, pdyn_log_level level, const char *format, ...)
    PDYN_PRINTF(3, 4);

/* The functions that operators and solvers may call. */
pdyn_services context_services(pdyn_context *context);

#endif
