/* The context: creation, memory through the user's allocator, log messages, and the
 * services that modules get of all this. */
#include "context.h"

#include "bad_call.h"
#include "registry.h"
#include "sized.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *pdyn_version(void) { return PROJDYN_VERSION; }

const char *pdyn_status_text(pdyn_status status) {
    static const struct {
        pdyn_status status;
        const char *text;
    } table[] = {
#define STATUS_ROW(name, value, text) {name, text},
        PDYN_STATUS_LIST(STATUS_ROW)
#undef STATUS_ROW
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (table[i].status == status) return table[i].text;
    return "unknown status";
}

/* Bytes of a cache line: a SIMD load of aligned data touches a single line. */
enum { LINE = 64 };

static void *libc_allocate(void *user, void *block, size_t old_size, size_t new_size) {
    (void)user, (void)old_size;
    if (new_size && !block) return aligned_alloc(LINE, (new_size + LINE - 1) / LINE * LINE);
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

void pdyn_default_options_sized(pdyn_options *out, size_t size) {
    pdyn_options options = {.threads = 0, .allocate = libc_allocate};
    sized_copy(out, size, &options, sizeof options);
}

/* Cores that this process may use: `taskset` and batch systems grant a part of them. */
static int usable_cores(void) {
    cpu_set_t set;
    if (!sched_getaffinity(0, sizeof set, &set)) return CPU_COUNT(&set);
    return (int)sysconf(_SC_NPROCESSORS_ONLN); /* above 1024 cores */
}

pdyn_status pdyn_create_sized(const pdyn_options *options, size_t size, pdyn_context **out) {
    if (HAS_NULL(out)) return PDYN_BAD_CALL;
    *out = NULL;
    pdyn_options chosen = pdyn_default_options();
    if (options) memcpy(&chosen, options, size < sizeof chosen ? size : sizeof chosen);
    if (!chosen.allocate) chosen.allocate = libc_allocate;
    if (chosen.threads < 0 || chosen.threads > 1024)
        return bad_call(__func__, "options.threads: expected 0 to 1024, found %d", chosen.threads);
    if (!chosen.threads) {
        int cores = usable_cores();
        chosen.threads = cores < 1 ? 1 : cores > 64 ? 64 : cores;
    }
    pdyn_context *context = chosen.allocate(chosen.allocate_user, NULL, 0, sizeof *context);
    if (!context) return context_no_memory(NULL);
    memset(context, 0, sizeof *context);
    context->options = chosen;
    context->plugin[context->plugins++] = &registry_builtin;
    pthread_mutex_init(&context->lock, NULL);
    context->pool = pool_create(chosen.threads);
    if (!context->pool) {
        pdyn_destroy(context);
        return set_error(PDYN_NO_MEMORY, "out of memory, or %d threads cannot be made",
                         chosen.threads);
    }
    *out = context;
    return PDYN_OK;
}

void pdyn_destroy(pdyn_context *context) {
    if (!context) return;
    if (context->pool) pool_destroy(context->pool);
    pthread_mutex_destroy(&context->lock);
    context->options.allocate(context->options.allocate_user, context, sizeof *context, 0);
}

int pdyn_thread_count(const pdyn_context *context) {
    return context ? context->options.threads : 0;
}

/* A member that another thread may change. */
static size_t read_locked(const pdyn_context *context, const size_t *member) {
    pthread_mutex_t *lock = (pthread_mutex_t *)&context->lock;
    pthread_mutex_lock(lock);
    size_t value = *member;
    pthread_mutex_unlock(lock);
    return value;
}

size_t pdyn_bytes_in_use(const pdyn_context *context) {
    return context ? read_locked(context, &context->bytes) : 0;
}
size_t pdyn_peak_bytes(const pdyn_context *context) {
    return context ? read_locked(context, &context->peak_bytes) : 0;
}

void *context_resize(pdyn_context *context, void *block, size_t old_size, size_t new_size) {
    if (!block && !new_size) return NULL;
    const pdyn_options *o = &context->options;
    void *moved = o->allocate(o->allocate_user, block, old_size, new_size);
    if (new_size && !moved) return NULL;
    if (new_size > old_size) memset((char *)moved + old_size, 0, new_size - old_size);
    pthread_mutex_lock(&context->lock);
    context->bytes += new_size - old_size;
    if (context->bytes > context->peak_bytes) context->peak_bytes = context->bytes;
    pthread_mutex_unlock(&context->lock);
    return moved;
}

void *context_array(pdyn_context *context, size_t count, size_t size) {
    if (!count || !size) return NULL;
    void *block = count > SIZE_MAX / size ? NULL : context_resize(context, NULL, 0, count * size);
    if (!block) context_no_memory(context);
    return block;
}

char *context_copy_text(pdyn_context *context, const char *text) {
    char *copy = NEW_ARRAY(context, strlen(text) + 1, char);
    return copy ? strcpy(copy, text) : NULL;
}

void context_free_text(pdyn_context *context, const char *text) {
    if (text) FREE_ARRAY(context, text, strlen(text) + 1);
}

void *context_grow(pdyn_context *context, void *array, size_t *capacity, size_t need, size_t size) {
    if (need <= *capacity) return array;
    size_t grown = 2 * need + 1024;
    void *moved = context_resize(context, array, *capacity * size, grown * size);
    if (moved) *capacity = grown;
    else context_no_memory(context);
    return moved;
}

/* The pointers of a table have different types: memcpy reads and writes them whatever the type. */
bool context_arrays(pdyn_context *context, const struct array_entry *table, size_t rows,
                    enum array_action action) {
    bool complete = true;
    for (const struct array_entry *a = table; a < table + rows; a++) {
        void *array = NULL;
        memcpy(&array, a->pointer, sizeof array);
        if (action == ARRAYS_FREE)
            array = array ? context_resize(context, array, a->count * a->size, 0) : NULL;
        else array = context_array(context, a->count, a->size);
        complete &= array != NULL || !a->count;
        memcpy(a->pointer, &array, sizeof array);
    }
    return complete;
}

pdyn_status context_no_memory(pdyn_context *context) {
    return set_error(PDYN_NO_MEMORY, "out of memory (%zu bytes in use)",
                     pdyn_bytes_in_use(context));
}

void context_log(pdyn_context *context, pdyn_log_level level, const char *format, ...) {
    if (!context->options.log) return;
    char message[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    context->options.log(context->options.log_user, level, message);
}

/* ---- services of modules --------------------------------------------------------------------- */

static void service_for(pdyn_core *core, int count, int grain, pdyn_range_fn *fn, void *arg) {
    pool_for(((pdyn_context *)core)->pool, count, grain, fn, arg);
}
static void *service_allocate(pdyn_core *core, void *block, size_t old_size, size_t new_size) {
    void *moved = context_resize((pdyn_context *)core, block, old_size, new_size);
    if (!moved && new_size) context_no_memory((pdyn_context *)core);
    return moved;
}
static pdyn_status service_fail(pdyn_core *core, pdyn_status status, const char *message) {
    (void)core;
    return set_error(status, "%s", message);
}
pdyn_services context_services(pdyn_context *context) {
    return (pdyn_services){(pdyn_core *)context, service_for, service_allocate, service_fail};
}
