/* Shared by all tests: contexts, scenes from text, an allocator that fails, a directory for files,
 * reproducible random numbers. */
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
#include "sim/sim.h"

/* Returns a copy of text with " for ', valid until the next call. */
const char *quoted(const char *text);

pdyn_context *test_context(int threads);

/* A context that counts the warnings that contain `text`. */
struct warnings {
    const char *text;
    int count;
};
pdyn_context *test_warned_context(int threads, struct warnings *warnings);
/* Loads a scene from text with ' for ". */
pdyn_sim *test_load(pdyn_context *context, const char *text);
/* The same with overrides PATH=VALUE. */
pdyn_sim *test_load_with(pdyn_context *context, const char *text, const char *const *set, int sets);
/* Asserts that the text of the last error contains this one. */
void assert_error(const char *expected);
/* Whether a text names a solver that the build leaves out: cholesky, without CHOLMOD. */
bool test_lacks_solver(const char *text);
pdyn_step_info test_step(pdyn_sim *sim);
/* Loads a scene as test_load, into a context of its own with one thread; to be closed. */
pdyn_sim *test_open(const char *text);
pdyn_sim *test_open_with(const char *text, const char *const *set, int sets);
/* Frees a simulation and its context; asserts that it leaves no memory allocated. */
void test_close(pdyn_sim *sim);

/* An allocator that counts its calls. */
struct counter {
    long calls, last; /* calls after number `last` fail; negative: none fails */
    long fails;       /* this number of them; negative: all */
};
pdyn_context *test_counting_context(int threads, struct counter *counter); /* without a limit */
void test_allow(struct counter *counter,
                long left); /* `left` more calls succeed; negative: no limit */
/* After `left` more calls, `fails` calls fail; negative: all. */
void test_fail(struct counter *counter, long left, long fails);

/* Calls attempt with 0, 1, 2, ... successful allocations until it succeeds; returns that number.
 * Asserts that each failure is "out of memory", and that no attempt leaves memory allocated. */
typedef pdyn_status test_attempt(const void *what);
long test_failing_allocations(pdyn_context *context, struct counter *counter, test_attempt *attempt,
                              const void *what);
/* The same for loading a scene and taking a step. */
void test_failing_scene(const char *text);

/* Set-up and tear-down of a group: enters a new directory; leaves and removes it. Files that a
 * passing test leaves there are a failure. */
int test_enter_directory(void **state);
int test_leave_directory(void **state);

void test_write_file(const char *name, const char *data, size_t size);
void test_write_text(const char *name, const char *text);
void test_remove_file(const char *name);

/* Calls check with damaged copies of a file: every beginning of it, and every byte replaced by one
 * that a reader may stumble over, and with one bit turned. */
typedef void test_check_file(const void *what, const char *data, size_t size);
void test_damaged_copies(const char *data, size_t size, test_check_file *check, const void *what);

double test_random(uint64_t *state); /* in [-1, 1) */
double test_distance(const double *a, const double *b, int n);
/* n zeros, and one more, as vectors of particles have it; to be freed. */
double *test_vector(int n);

#endif
