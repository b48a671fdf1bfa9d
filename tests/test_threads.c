/* Simulations of one context on several threads, and in a forked child: the bits of a run alone. */
#include "support.h"

#include <pthread.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STEPS = 12, THREADS = 8 };

static const char water[] =
    SCENE("'duration': 1, 'time_step': {'fixed': 0.005}",
          FLUID_BOX("", "0.01", "0, 0, 0", "0.4, 0.4, 0.4", ", 'stiffness': 1e4"), "");
static const char sheet[] = SCENE("'duration': 1, 'time_step': {'fixed': 0.005}",
                                  GRID_SHEET("", "1, 1", "65, 65", "'area_density': 0.3",
                                             PAIR(SPRINGS("1000"), PINS("'vertices': [0]"))),
                                  "");

static void *run(void *sim) {
    for (int k = 0; k < STEPS; k++)
        if (pdyn_step(sim, NULL) != PDYN_OK) return NULL;
    return sim;
}

static uint64_t hash_alone(const char *text) {
    pdyn_sim *sim = test_open(text);
    assert_non_null(run(sim));
    uint64_t hash = pdyn_state_hash(sim);
    test_close(sim);
    return hash;
}

struct task {
    pdyn_context *context;
    const char *text;
    uint64_t hash; /* 0: failed */
};

/* Loads, steps and frees a simulation. */
static void *run_task(void *arg) {
    struct task *t = arg;
    pdyn_sim *sim = NULL;
    if (pdyn_load_text(t->context, t->text, "scene", NULL, 0, &sim) == PDYN_OK && run(sim))
        t->hash = pdyn_state_hash(sim);
    pdyn_free(sim);
    return NULL;
}

/* So many simulations of a context, each on a thread of its own. */
static void run_together(int workers, int threads, const uint64_t hash[2]) {
    pdyn_context *context = test_context(workers);
    struct task task[THREADS];
    pthread_t thread[THREADS];
    char text[2][1024];
    snprintf(text[0], sizeof text[0], "%s", quoted(water));
    snprintf(text[1], sizeof text[1], "%s", quoted(sheet));
    for (int k = 0; k < threads; k++) {
        task[k] = (struct task){context, text[k % 2], 0};
        assert_int_equal(pthread_create(&thread[k], NULL, run_task, &task[k]), 0);
    }
    for (int k = 0; k < threads; k++) {
        assert_int_equal(pthread_join(thread[k], NULL), 0);
        assert_true(task[k].hash == hash[k % 2]);
    }
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

static void test_one_context(void **state) {
    (void)state;
    const uint64_t hash[2] = {hash_alone(water), hash_alone(sheet)};
    static const int workers[] = {1, 2, 8};
    for (int w = 0; w < 3; w++) run_together(workers[w], 2, hash);
    run_together(2, THREADS, hash);
}

/* A call that fails; arg: the context. Returns NULL if the text is not that of this call. */
static void *run_bad_call(void *arg) {
    pdyn_sim *sim = NULL;
    if (*pdyn_last_error(arg)) return NULL;
    if (pdyn_load_text(arg, "}", "other", NULL, 0, &sim) != PDYN_BAD_INPUT) return NULL;
    return strncmp(pdyn_last_error(arg), "other:1:1: ", 11) ? NULL : arg;
}

/* Each thread has its own text of the last error, in one context and without one. */
static void test_errors(void **state) {
    (void)state;
    static const char expected[] = "pdyn_step: sim is NULL";
    pdyn_context *context = test_context(2);
    pthread_t thread;
    void *good;
    assert_int_equal(pdyn_step(NULL, NULL), PDYN_BAD_CALL);
    assert_int_equal(pthread_create(&thread, NULL, run_bad_call, context), 0);
    assert_int_equal(pthread_join(thread, &good), 0);
    assert_non_null(good);
    assert_string_equal(pdyn_last_error(context), expected);
    assert_string_equal(pdyn_last_error(NULL), expected);
    pdyn_destroy(context);
}

static int run_in_child(pdyn_sim *sim) {
    if (!run(sim) || pdyn_step(sim, NULL) != PDYN_OK) return 255;
    int code = (int)(pdyn_state_hash(sim) % 251);
    test_close(sim);
    return code;
}

/* A child has no workers: it steps, and frees its copy, without them. */
static void test_fork(void **state) {
    (void)state;
    pdyn_context *context = test_context(4);
    pdyn_sim *sim = test_load(context, sheet);
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
    pid_t child = fork();
    assert_true(child >= 0);
    if (!child) {
        alarm(60);
        _exit(run_in_child(sim));
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_non_null(run(sim));
    assert_int_equal(pdyn_step(sim, NULL), PDYN_OK);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), (int)(pdyn_state_hash(sim) % 251));
    test_close(sim);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_context),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_fork),
    };
    return cmocka_run_group_tests_name("threads", tests, NULL, NULL);
}
