/* Conformance of every registered constraint type and solver. No name is listed here: a new type is
 * covered without further lines. */
#include "support.h"

#include "base/registry.h"
#include "projdyn/conformance.h"

static void tell(void *user, const char *text) {
    (void)user;
    print_error("%s\n", text);
}

static void check(pdyn_context *context, const char *name) {
    int faults = -1;
    assert_int_equal(pdyn_conformance(context, name, tell, NULL, &faults), PDYN_OK);
    assert_int_equal(faults, 0);
}

static void test_constraints(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    for (const pdyn_constraint_type *const *t = registry_builtin.constraints; *t; t++)
        check(context, (*t)->name);
    pdyn_destroy(context);
}

static void test_solvers(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    for (const pdyn_global_solver *const *s = registry_builtin.solvers; *s; s++)
        check(context, (*s)->name);
    pdyn_destroy(context);
}

static void test_calls(void **state) {
    (void)state;
    int faults;
    pdyn_context *context = test_context(1);
    assert_int_equal(pdyn_conformance(NULL, "spring", NULL, NULL, &faults), PDYN_BAD_CALL);
    assert_int_equal(pdyn_conformance(context, "spring", NULL, NULL, NULL), PDYN_BAD_CALL);
    assert_int_equal(pdyn_conformance(context, "sprong", NULL, NULL, &faults), PDYN_BAD_INPUT);
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_constraints),
                                       cmocka_unit_test(test_solvers),
                                       cmocka_unit_test(test_calls)};
    return cmocka_run_group_tests_name("conformance", tests, NULL, NULL);
}
