#include "support.h"

#include <ftw.h>
#include <string.h>
#include <unistd.h>

static char directory[512];

/* PROJDYN_ONLY and PROJDYN_SKIP: the names of tests that run, and that do not; a pattern with *. */
__attribute__((constructor)) static void choose_tests(void) {
    const char *only = getenv("PROJDYN_ONLY"), *skipped = getenv("PROJDYN_SKIP");
    if (only) cmocka_set_test_filter(only);
    if (skipped) cmocka_set_skip_filter(skipped);
}

static pdyn_context *create(const pdyn_options *options) {
    pdyn_context *context = NULL;
    assert_int_equal(pdyn_create(options, &context), PDYN_OK);
    return context;
}

pdyn_context *test_context(int threads) {
    pdyn_options options = pdyn_default_options();
    options.threads = threads;
    return create(&options);
}

static void count_warning(void *user, pdyn_log_level level, const char *message) {
    struct warnings *warnings = user;
    warnings->count += level == PDYN_LOG_WARNING && strstr(message, warnings->text);
}

pdyn_context *test_warned_context(int threads, struct warnings *warnings) {
    pdyn_options options = pdyn_default_options();
    options.threads = threads, options.log = count_warning, options.log_user = warnings;
    return create(&options);
}

const char *quoted(const char *text) {
    static char out[8192];
    assert_true(strlen(text) < sizeof out);
    memmove(out, text, strlen(text) + 1); /* text may be the result of a call */
    for (char *c = out; *c; c++)
        if (*c == '\'') *c = '"';
    return out;
}

pdyn_sim *test_load(pdyn_context *context, const char *text) {
    return test_load_with(context, text, NULL, 0);
}

pdyn_sim *test_load_with(pdyn_context *context, const char *text, const char *const *set,
                         int sets) {
    pdyn_sim *sim = NULL;
    pdyn_status status = pdyn_load_text(context, quoted(text), "test", set, sets, &sim);
    if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    return sim;
}

void assert_error(const char *expected) {
    const char *found = pdyn_last_error(NULL);
    if (!strstr(found, expected)) fail_msg("expected \"%s\" in \"%s\"", expected, found);
}

bool test_lacks_solver(const char *text) {
    return strstr(text, "cholesky") && !strstr(pdyn_solvers(), "cholesky");
}

pdyn_step_info test_step(pdyn_sim *sim) {
    pdyn_step_info info;
    if (pdyn_step(sim, &info) != PDYN_OK) fail_msg("%s", pdyn_last_error(NULL));
    return info;
}

pdyn_sim *test_open(const char *text) { return test_load(test_context(1), text); }

pdyn_sim *test_open_with(const char *text, const char *const *set, int sets) {
    return test_load_with(test_context(1), text, set, sets);
}

void test_close(pdyn_sim *sim) {
    pdyn_context *context = sim->context;
    pdyn_free(sim);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
}

/* ---- allocations ----------------------------------------------------------------------------- */

static void *count_allocation(void *user, void *block, size_t old_size, size_t new_size) {
    struct counter *counter = user;
    (void)old_size;
    if (!new_size) {
        free(block);
        return NULL;
    }
    long call = __atomic_add_fetch(&counter->calls, 1, __ATOMIC_RELAXED);
    long after = call - counter->last;
    if (counter->last >= 0 && after > 0 && (counter->fails < 0 || after <= counter->fails))
        return NULL;
    return realloc(block, new_size);
}

pdyn_context *test_counting_context(int threads, struct counter *counter) {
    pdyn_options options = pdyn_default_options();
    options.threads = threads;
    options.allocate = count_allocation;
    options.allocate_user = counter;
    *counter = (struct counter){.last = -1, .fails = -1};
    return create(&options);
}

void test_allow(struct counter *counter, long left) {
    counter->last = left < 0 ? -1 : counter->calls + left, counter->fails = -1;
}

void test_fail(struct counter *counter, long left, long fails) {
    test_allow(counter, left);
    counter->fails = fails;
}

long test_failing_allocations(pdyn_context *context, struct counter *counter, test_attempt *attempt,
                              const void *what) {
    size_t before = pdyn_bytes_in_use(context);
    for (long left = 0; left < 10000; left++) {
        test_allow(counter, left);
        pdyn_status status = attempt(what);
        test_allow(counter, -1);
        assert_int_equal(pdyn_bytes_in_use(context), before);
        if (status == PDYN_OK) return left;
        assert_int_equal(status, PDYN_NO_MEMORY);
        assert_memory_equal(pdyn_last_error(context), "out of memory", strlen("out of memory"));
    }
    fail_msg("never enough memory");
    return 0;
}

struct scene_text {
    pdyn_context *context;
    const char *text;
};

static pdyn_status load_and_step(const void *what) {
    const struct scene_text *scene = what;
    pdyn_sim *sim = NULL;
    pdyn_status status = pdyn_load_text(scene->context, quoted(scene->text), "test", NULL, 0, &sim);
    if (status == PDYN_OK) status = pdyn_step(sim, NULL);
    pdyn_free(sim);
    return status;
}

void test_failing_scene(const char *text) {
    struct counter counter;
    struct scene_text scene = {test_counting_context(1, &counter), text};
    test_failing_allocations(scene.context, &counter, load_and_step, &scene);
    pdyn_destroy(scene.context);
}

/* ---- files ----------------------------------------------------------------------------------- */

int test_enter_directory(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(directory, sizeof directory, "%s/projdyn_XXXXXX", base ? base : "/tmp");
    return mkdtemp(directory) ? chdir(directory) : -1;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *place) {
    (void)info, (void)kind, (void)place;
    return remove(path);
}

int test_leave_directory(void **state) {
    (void)state;
    if (chdir("/")) return -1;
    if (!rmdir(directory)) return 0;
    nftw(directory, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    return -1;
}

void test_write_file(const char *name, const char *data, size_t size) {
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

void test_write_text(const char *name, const char *text) {
    test_write_file(name, text, strlen(text));
}

void test_remove_file(const char *name) { assert_int_equal(unlink(name), 0); }

void test_damaged_copies(const char *data, size_t size, test_check_file *check, const void *what) {
    static const char replacement[] = {'\0', '\n', ' ', '-', '9', '/', '\x7f', '\xff'};
    uint32_t random = 1;
    char *copy = malloc(size);
    assert_non_null(copy);
    for (size_t left = 0; left < size; left++) check(what, data, left);
    for (size_t at = 0; at < size; at++) {
        random = random * 1664525u + 1013904223u;
        memcpy(copy, data, size);
        copy[at] = replacement[random >> 29];
        check(what, copy, size);
        copy[at] = (char)(data[at] ^ 1 << (random >> 26 & 7));
        check(what, copy, size);
    }
    free(copy);
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* A linear congruential generator. */
double test_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

double test_distance(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

double *test_vector(int n) {
    double *a = calloc((size_t)n + 1, sizeof *a);
    assert_non_null(a);
    return a;
}
