/* What the tests share: contexts, scenes from text, a random number that is the same everywhere. */
#ifndef TEST_SUPPORT_H
#define TEST_SUPPORT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "projdyn/projdyn.h"
#include "sim.h"

static inline pdyn_context *test_context(int threads) {
    pdyn_options options = pdyn_default_options();
    pdyn_context *context = NULL;
    options.threads = threads;
    assert_int_equal(pdyn_create(&options, &context), PDYN_OK);
    return context;
}

static inline pdyn_sim *test_load(pdyn_context *context, const char *text) {
    pdyn_sim *sim = NULL;
    pdyn_status status = pdyn_load_text(context, text, "test", NULL, 0, &sim);
    if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    return sim;
}

static inline pdyn_step_info test_step(pdyn_context *context, pdyn_sim *sim) {
    pdyn_step_info info;
    if (pdyn_step(sim, &info) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    return info;
}

/* In [-1, 1), from a linear congruential generator. */
static inline double test_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

/* Counts allocations; as the user of an allocator. */
struct counter {
    long calls, budget; /* budget < 0: no limit */
};

static inline void *count_allocation(void *user, void *block, size_t old_size, size_t new_size) {
    struct counter *counter = user;
    (void)old_size;
    if (!new_size) {
        free(block);
        return NULL;
    }
    __atomic_fetch_add(&counter->calls, 1, __ATOMIC_RELAXED);
    if (counter->budget >= 0 && counter->calls > counter->budget) return NULL;
    return realloc(block, new_size);
}

static inline double test_distance(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

#endif
