/* Types whose elements come and go, with one fault each: conformance reports it. All are variants
 * of a correct floor, whose elements are the points below it. Its memory counts the steps that a
 * point has been below. */
#include "wrong_support.h"

#include <stdatomic.h>
#include <string.h>

enum fault {
    NONE,
    COUNT_CHANGES,
    COUNT_NEGATIVE,
    ORDER_CHANGES,
    BEYOND_ROOM,
    KEY_BEYOND_ROOM,
    KEYS_EQUAL,
    KEYS_MISSING,
    DATA_MISSING,
    WITHOUT_FIRST, /* begins at the first particle of the system */
    SELECTS_TWICE,
    APPEARS_WITH_ENERGY,
    END_BEYOND,
    END_OF_ALL,
    END_COUNTS_CALLS,
    END_WRITES_DATA,
    BEGIN_WRITES_P,
    NO_ANCHOR,
    NEVER, /* no point is below */
    NEVER_NEAR_OTHER,
    SELDOM /* correct: a point of a body of particles is below in one state only */
};

static enum fault now;
static bool always; /* PDYN_EVERY_ITERATION, without memory */
static atomic_int calls;

static double height(void) {
    return now == NEVER || now == NEVER_NEAR_OTHER ? -10.0 : now == SELDOM ? -0.03 : 0.1;
}

static bool is_below(double y) { return y < height() + (now == APPEARS_WITH_ENERGY ? 0.03 : 0.0); }

static void write_element(const pdyn_batch *b, int e, int i) {
    if (now != DATA_MISSING || e % 3) ((int *)b->data)[e] = i;
    if (b->key && (now != KEYS_MISSING || e % 3)) b->key[e] = now == KEYS_EQUAL ? 1u : 100u + i;
}

static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    int count = 0, first = now == WITHOUT_FIRST ? 0 : b->body->first;
    bool backwards = now == ORDER_CHANGES && atomic_fetch_add(&calls, 1) % 3 == 0;
    (void)par, (void)v;
    for (int k = 0; k < b->body->count; k++) {
        int i = first + (backwards ? b->body->count - 1 - k : k);
        if (!is_below(x[3 * i + 1])) continue;
        if (count < room || (room && now == BEYOND_ROOM)) write_element(b, count, i);
        if (room && count == room && now == KEY_BEYOND_ROOM) b->key[count] = 0;
        count++;
    }
    if (now == COUNT_CHANGES && count > 1) count -= atomic_fetch_add(&calls, 1) % 2;
    return now == COUNT_NEGATIVE ? -count : count;
}

static void select_points(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        for (int k = 0; k < 2; k++) { /* the second entry does not count */
            b->column[2 * e + k] = ((const int *)b->data)[e];
            b->coefficient[2 * e + k] = now == SELECTS_TWICE ? 0.5 : 1.0 - k;
        }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 1000.0;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    memcpy(b->p + 3 * first, b->u + 3 * first, 3 * (size_t)(last - first) * sizeof *b->p);
    for (int e = first; e < last; e++)
        if (is_below(b->u[3 * e + 1])) b->p[3 * e + 1] = height();
}

static void begin(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last && now == BEGIN_WRITES_P; e++) b->p[3 * e] = 0.0;
}

static void end(const void *par, const pdyn_batch *b, int first, int last) {
    double *steps = b->memory;
    (void)par;
    if (now == END_OF_ALL) first = 0, last = b->elements;
    for (int e = first; e < last; e++) {
        steps[e] = b->u[3 * e] + 1.0;
        if (now == END_BEYOND) steps[e + 1] = 0.0;
        if (now == END_COUNTS_CALLS) steps[e] = atomic_fetch_add(&calls, 1);
        if (now == END_WRITES_DATA) ((int *)b->data)[e]++;
    }
}

static bool is_reported(enum fault fault, bool every_iteration, const char *expected) {
    now = fault, always = every_iteration;
    atomic_store(&calls, 0);
    static const pdyn_param none[] = {{0}},
                            other[] = {{"to", PDYN_OTHER, 0, true, 0, 0, 0, "", "the other body"},
                                       {0}};
    const pdyn_constraint_type type = {.name = "floor",
                                       .summary = "holds points above a height",
                                       .flags = (now == NO_ANCHOR ? 0u : PDYN_ANCHORED) |
                                                (always ? PDYN_EVERY_ITERATION : 0u),
                                       .params_size = sizeof(pdyn_other),
                                       .params = now == NEVER_NEAR_OTHER ? other : none,
                                       .data_size = sizeof(int),
                                       .update = update,
                                       .rows = 1,
                                       .width = 2,
                                       .select = select_points,
                                       .weight = weight,
                                       .project = project,
                                       .begin = always ? NULL : begin,
                                       .memory_size = always ? 0 : sizeof(double),
                                       .end = always ? NULL : end};
    if (wrong_type_is_reported(type, expected)) return true;
    print_error("... of the fault %d, %s\n", (int)now, always ? "every iteration" : "every step");
    return false;
}

static void test_good(void **state) {
    (void)state;
    assert_true(is_reported(NONE, false, NULL));
    assert_true(is_reported(NONE, true, NULL));
    assert_true(is_reported(SELDOM, true, NULL));
}

static void test_wrong(void **state) {
    (void)state;
    static const struct {
        enum fault fault;
        bool every_iteration;
        const char *expected;
    } wrong[] = {
        {COUNT_CHANGES, false, "at the same positions"},
        {COUNT_CHANGES, true, "at the same positions"},
        {COUNT_NEGATIVE, false, "it has -"},
        {ORDER_CHANGES, true, "update gives other elements"},
        {BEYOND_ROOM, true, "update writes beyond the"},
        {KEY_BEYOND_ROOM, false, "update writes beyond the"},
        {KEYS_EQUAL, false, "update gives two elements the same key"},
        {KEYS_MISSING, false, "update gives other keys"},
        {DATA_MISSING, true, "element 0 selects particle 0"},
        {WITHOUT_FIRST, false, "selects particle"},
        {SELECTS_TWICE, false, "selects one particle twice"},
        {APPEARS_WITH_ENERGY, true, "is not the work"},
        {END_BEYOND, false, "end writes memory outside of its elements"},
        {END_OF_ALL, false, "end writes memory outside of its elements"},
        {END_COUNTS_CALLS, false, "end gives another memory"},
        {END_WRITES_DATA, false, "end writes data, which it may only read"},
        {BEGIN_WRITES_P, false, "begin writes p, which it may only read"},
        {NO_ANCHOR, false, "say PDYN_ANCHORED"},
        {NO_ANCHOR, true, "say PDYN_ANCHORED"},
        {NEVER, false, "not exercised: update gives no element"},
        {NEVER, true, "not exercised: update gives no element"},
        {NEVER_NEAR_OTHER, true, "the other body is a sheet 0.3 m above"},
    };
    size_t count = sizeof wrong / sizeof *wrong, reported = 0;
    for (size_t k = 0; k < count; k++)
        reported += is_reported(wrong[k].fault, wrong[k].every_iteration, wrong[k].expected);
    assert_int_equal(reported, count);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_good), cmocka_unit_test(test_wrong)};
    return cmocka_run_group_tests_name("wrong dynamic", tests, NULL, NULL);
}
