/* What the tests share: contexts, scenes from text, an allocator that fails, a directory for files,
 * a random number that is the same everywhere. */
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
#include "scene_text.h"
#include "step/sim.h"

/* A copy of a text with " for ', which is valid until the next call. */
const char *quoted(const char *text);

pdyn_context *test_context(int threads);

/* Counts the warnings that contain `text`. */
struct warnings {
    const char *text;
    int count;
};
pdyn_context *test_warned_context(int threads, struct warnings *warnings);
/* Loads a scene from text with ' for ". */
pdyn_sim *test_load(pdyn_context *context, const char *text);
pdyn_step_info test_step(pdyn_context *context, pdyn_sim *sim);

/* Counts allocations. */
struct counter {
    long calls, last; /* last: the call after which all fail; negative: none does */
};
pdyn_context *test_counting_context(int threads, struct counter *counter); /* no limit */
void test_allow(struct counter *counter, long left); /* so many more; negative: no limit */

/* Attempts with 0, 1, 2, ... allocations until these are enough, and returns how many were. Each
 * time before there is an error, and nothing stays allocated; as after an attempt that succeeds. */
typedef pdyn_status test_attempt(const void *what);
long test_failing_allocations(pdyn_context *context, struct counter *counter, test_attempt *attempt,
                              const void *what);
/* The same for loading a scene and taking a step. */
void test_failing_scene(const char *text);

/* For a group of tests: goes into a new directory; leaves and removes it, with all that a failed
 * test has left there. What tests that pass leave there is a failure. */
int test_enter_directory(void **state);
int test_leave_directory(void **state);

void test_write_file(const char *name, const char *data, size_t size);
void test_write_text(const char *name, const char *text);
void test_remove_file(const char *name);

double test_random(uint64_t *state); /* in [-1, 1) */
double test_distance(const double *a, const double *b, int n);

#endif
