#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static size_t taken;

static void *limited(void *user, void *block, size_t old_size, size_t new_size) {
    (void)user;
    if (taken - old_size + new_size > (size_t)64 << 20) return NULL;
    taken += new_size - old_size;
    if (new_size) return realloc(block, new_size);
    free(block);
    return NULL;
}

pdyn_context *fuzz_context(void) {
    pdyn_options options = pdyn_default_options();
    pdyn_context *context = NULL;
    options.threads = 1, options.allocate = limited;
    taken = 0;
    if (pdyn_create(&options, &context) != PDYN_OK) abort();
    return context;
}

void fuzz_end(pdyn_context *context, size_t most) {
    if (pdyn_bytes_in_use(context) || pdyn_peak_bytes(context) > most) {
        fprintf(stderr, "%zu bytes left, %zu at most, expected none and %zu\n",
                pdyn_bytes_in_use(context), pdyn_peak_bytes(context), most);
        abort();
    }
    pdyn_destroy(context);
}

size_t fuzz_bound(size_t size) { return 4096 + 200 * size; }

const char *fuzz_file(const uint8_t *data, size_t size, const char *ending) {
    static char path[128];
    snprintf(path, sizeof path, "/dev/shm/projdyn_fuzz_%d%s", (int)getpid(), ending);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file)) abort();
    return path;
}
