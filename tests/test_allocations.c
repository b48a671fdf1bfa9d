/* Failed allocations while six scenes are loaded, stepped, saved, restored and freed: every call
 * returns PDYN_NO_MEMORY and keeps the promises of projdyn.h, and no memory stays allocated.
 * PROJDYN_ALLOCATIONS=1 lets every allocation fail, instead of some of each scene. */
#include "small_scenes.h"
#include "support.h"

#include <errno.h>
#include <jansson.h>
#include <string.h>
#include <unistd.h>

enum { STEPS = 3 };
enum { SAMPLES = 8 }; /* places of failures, for each scene and kind of failure */

/* Kinds of failures: one allocation, two in a row, all from one on. */
static const long kind[] = {1, 2, -1};
enum { KINDS = sizeof kind / sizeof *kind };

struct walk {
    pdyn_context *context;
    struct counter counter;
    const char *text;
    uint64_t hash[STEPS + 2]; /* after 0, 1, 2 ... steps without a failure */
    double *x[STEPS + 2];     /* m: positions */
    unsigned char *one;       /* the state after one step */
    size_t size;              /* bytes of it */
};

/* Whether the call succeeded. Every failure must be "out of memory", not the text of another call.
 */
static bool succeeded(const struct walk *w, pdyn_status status) {
    static const char expected[] = "out of memory";
    if (status == PDYN_OK) return true;
    if (status != PDYN_NO_MEMORY ||
        strncmp(pdyn_last_error(w->context), expected, strlen(expected)))
        fail_msg("%s: %s", pdyn_status_text(status), pdyn_last_error(w->context));
    set_error(PDYN_OK, "not the text of the next call");
    return false;
}

/* A state saved now continues like the simulation without a failure after `steps` steps. Not with
 * the same bits: lists, and the regions of contact, are those of the step that failed. */
static void continues_from(struct walk *w, pdyn_sim *sim, int steps) {
    assert_true(pdyn_state_hash(sim) == w->hash[steps]);
    assert_true(succeeded(w, pdyn_save(sim, "saved")));
    pdyn_sim *other = test_load(w->context, w->text);
    assert_true(succeeded(w, pdyn_restore(other, "saved")));
    assert_true(pdyn_state_hash(other) == w->hash[steps]);
    test_step(other);
    for (int k = 0; k < 3 * other->objective.particles; k++)
        assert_true(fabs(other->x[k] - w->x[steps + 1][k]) < 1e-3);
    pdyn_free(other);
    test_remove_file("saved");
}

/* A restored state revives a simulation that has failed: its next step has the same bits. */
static void is_revived(struct walk *w, pdyn_sim *sim) {
    assert_true(succeeded(w, pdyn_restore_memory(sim, w->one, w->size)));
    for (int k = 1; k <= STEPS; k++) {
        assert_true(pdyn_state_hash(sim) == w->hash[k]);
        test_step(sim);
    }
    assert_true(pdyn_state_hash(sim) == w->hash[STEPS + 1]);
}

/* Takes up to STEPS steps; false if one failed: the state is that of the step before, and there is
 * no further step until a state is restored. */
static bool take_steps(struct walk *w, pdyn_sim *sim) {
    for (int k = 0; k < STEPS; k++) {
        if (!succeeded(w, pdyn_step(sim, NULL))) {
            test_allow(&w->counter, -1);
            assert_int_equal(pdyn_step(sim, NULL), PDYN_BAD_CALL);
            continues_from(w, sim, k);
            is_revived(w, sim);
            return false;
        }
        assert_true(pdyn_state_hash(sim) == w->hash[k + 1]);
    }
    return true;
}

/* Saves to a file and to memory. */
static void save(struct walk *w, pdyn_sim *sim) {
    size_t size = 0;
    if (succeeded(w, pdyn_save(sim, "saved"))) test_remove_file("saved");
    else assert_int_not_equal(access("saved", F_OK), 0);
    if (succeeded(w, pdyn_save_memory(sim, NULL, 0, &size))) assert_true(size > 0);
}

/* Saves, and restores the state after one step from memory and from its file. After a failed
 * restore, the simulation continues, or has no further step. */
static void save_and_restore(struct walk *w, pdyn_sim *sim) {
    save(w, sim);
    int steps = succeeded(w, pdyn_restore_memory(sim, w->one, w->size)) ? 1 : STEPS;
    bool both = steps == 1 && succeeded(w, pdyn_restore(sim, "one"));
    test_allow(&w->counter, -1);
    pdyn_status status = pdyn_step(sim, NULL);
    if (!both && status == PDYN_BAD_CALL) return;
    assert_int_equal(status, PDYN_OK);
    assert_true(pdyn_state_hash(sim) == w->hash[steps + 1]);
}

static void walk(struct walk *w) {
    pdyn_sim *sim = NULL;
    bool loaded = succeeded(w, pdyn_load_text(w->context, quoted(w->text), "test", NULL, 0, &sim));
    assert_true(loaded == (sim != NULL));
    if (loaded && take_steps(w, sim)) save_and_restore(w, sim);
    test_allow(&w->counter, -1);
    pdyn_free(sim);
    assert_int_equal(pdyn_bytes_in_use(w->context), 0);
}

static void keep_one(struct walk *w, pdyn_sim *sim) {
    assert_true(succeeded(w, pdyn_save(sim, "one")));
    assert_true(succeeded(w, pdyn_save_memory(sim, NULL, 0, &w->size)));
    w->one = malloc(w->size);
    assert_true(succeeded(w, pdyn_save_memory(sim, w->one, w->size, &w->size)));
}

/* Computes the hashes, writes the state "one", and returns the number of allocations of a walk. */
static long prepare(struct walk *w) {
    pdyn_sim *sim = test_load(w->context, w->text);
    w->hash[0] = pdyn_state_hash(sim);
    for (int k = 1; k < STEPS + 2; k++) {
        size_t size = 3 * (size_t)sim->objective.particles * sizeof(double);
        test_step(sim);
        w->hash[k] = pdyn_state_hash(sim);
        w->x[k] = memcpy(malloc(size), sim->x, size);
        if (k == 1) keep_one(w, sim);
    }
    pdyn_free(sim);
    long before = w->counter.calls;
    walk(w);
    return w->counter.calls - before;
}

static void test_scenes(void **state) {
    (void)state;
    long failures = 0;
    for (int k = 0; k < SMALL_SCENES; k++) {
        if (test_lacks_solver(small_scenes[k])) continue;
        struct walk w = {.text = small_scenes[k]};
        w.context = test_counting_context(1, &w.counter);
        long count = prepare(&w), stride = getenv("PROJDYN_ALLOCATIONS") ? 1 : count / SAMPLES;
        for (long left = 0; left < count; left += stride)
            for (int m = 0; m < KINDS; m++, failures++) {
                test_fail(&w.counter, left, kind[m]);
                walk(&w);
            }
        test_remove_file("one");
        for (int n = 1; n < STEPS + 2; n++) free(w.x[n]);
        free(w.one);
        pdyn_destroy(w.context);
    }
    if (getenv("PROJDYN_ALLOCATIONS")) printf("%ld failed allocations\n", failures);
}

/* ---- failures late in a run ------------------------------------------------------------------ */

/* Lists, contacts, their memory and the frictions of a sheet grow while things meet. */
static const char meeting[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'contact': "
    "{'thickness': 0.01, 'friction': 0.5}, 'bodies': [{'name': 'water', 'particles': {'radius': "
    "0.02, 'fill': [{'box': {'minimum': [0.04, 0.25, 0.04], 'maximum': [0.2, 0.41, 0.2]}}], "
    "'inlets': [{'rectangle': {'center': [0.3, 0.55, 0.2], 'size': [0.12, 0.12]}, 'direction': [0, "
    "-1, 0], 'speed': 2}]}, 'constraints': [{'type': 'fluid'}]}, {'name': 'sheet', 'surface': "
    "{'grid': {'size': [0.3, 0.3], 'vertices': [9, 9]}, 'translate': [0.2, 0.2, 0.2], "
    "'area_density': 0.5}, 'constraints': [{'type': 'spring', 'stretching_stiffness': 1000}]}, "
    "{'name': 'brick', 'rigid': {'box': {'minimum': [0.15, 0.22, 0.25], 'maximum': [0.21, 0.26, "
    "0.31]}, 'density': 500}}], 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], "
    "'maximum': [0.4, 0.6, 0.4]}}, {'name': 'ball', 'sphere': {'center': [0.2, 0.1, 0.2], "
    "'radius': 0.05}, 'motion': [{'time': 0}, {'time': 1, 'translate': [0, 0.2, 0]}]}]}";

enum { LATE = 30, LATE_STRIDE = 3 };

/* Restores the state "late" and makes a step; allocation `left` of one of the two fails. After a
 * failed restore the simulation goes on, or has no further step. It can be restored after both.
 * Returns whether nothing failed. */
static bool go_on_late(struct walk *w, long left, bool in_step) {
    pdyn_sim *sim = test_load(w->context, w->text);
    uint64_t before = pdyn_state_hash(sim);
    if (in_step) assert_true(succeeded(w, pdyn_restore(sim, "late"))), before = w->hash[0];
    test_fail(&w->counter, left, 1);
    bool good = succeeded(w, in_step ? pdyn_step(sim, NULL) : pdyn_restore(sim, "late"));
    test_allow(&w->counter, -1);
    if (!good) assert_true(pdyn_state_hash(sim) == before);
    if (!good && in_step) assert_true(succeeded(w, pdyn_save(sim, "saved")));
    else if (!good) pdyn_step(sim, NULL);
    assert_true(succeeded(w, pdyn_restore(sim, "late")));
    test_step(sim);
    assert_true(pdyn_state_hash(sim) == w->hash[1]);
    pdyn_free(sim);
    return good;
}

/* The saved state of a failed step: its lists, and what they grant, may be those of the step. */
static void goes_on_from_saved(struct walk *w) {
    pdyn_sim *sim = test_load(w->context, w->text);
    assert_true(succeeded(w, pdyn_restore(sim, "saved")));
    assert_true(pdyn_state_hash(sim) == w->hash[0]);
    test_step(sim);
    pdyn_free(sim);
    test_remove_file("saved");
}

static void test_late(void **state) {
    (void)state;
    struct walk w = {.text = meeting};
    w.context = test_counting_context(1, &w.counter);
    pdyn_sim *sim = test_load(w.context, w.text);
    for (int k = 0; k < LATE; k++) test_step(sim);
    assert_true(succeeded(&w, pdyn_save(sim, "late")));
    w.hash[0] = pdyn_state_hash(sim);
    test_step(sim);
    w.hash[1] = pdyn_state_hash(sim);
    pdyn_free(sim);
    long stride = getenv("PROJDYN_ALLOCATIONS") ? 1 : LATE_STRIDE;
    for (int in_step = 0; in_step < 2; in_step++)
        for (long left = 0; !go_on_late(&w, left, in_step); left += stride)
            if (in_step) goes_on_from_saved(&w);
    test_remove_file("late");
    pdyn_destroy(w.context);
}

/* ---- allocations of jansson ------------------------------------------------------------------ */

static long json_left; /* number of allocations before one that fails */

static void *json_allocate(size_t size) {
    if (json_left-- != 0) return malloc(size);
    errno = ENOMEM;
    return NULL;
}

/* jansson gives an error of syntax, or another value, after some of its failed allocations. Words
 * of this scene are at most 13 letters long: to grow its buffer for a word, jansson 2.14 needs
 * memory, and without it reads beyond the buffer. */
static void test_json(void **state) {
    (void)state;
    static const char scene[] =
        SCENE("'duration': 1", FLUID_BOX("", "0.02", "0, 0, 0", "0.1, 0.1, 0.1", ""), "");
    static const char *const set[] = {"duration=0.5", "bodies.0.name=water"};
    struct walk w = {.context = test_context(1)};
    bool failed = true;
    json_set_alloc_funcs(json_allocate, free);
    for (long left = 0; failed; left++) {
        pdyn_sim *sim = NULL;
        json_left = left;
        failed = !succeeded(&w, pdyn_load_text(w.context, quoted(scene), "test", set, 2, &sim));
        assert_true(failed == (json_left < 0));
        pdyn_free(sim);
        assert_int_equal(pdyn_bytes_in_use(w.context), 0);
    }
    json_set_alloc_funcs(malloc, free);
    pdyn_destroy(w.context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_scenes), cmocka_unit_test(test_late),
                                       cmocka_unit_test(test_json)};
    return cmocka_run_group_tests_name("allocations", tests, test_enter_directory,
                                       test_leave_directory);
}
