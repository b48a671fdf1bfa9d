/* The list of built-in solvers, and what a scene is told about one that the build leaves out. */
#include "support.h"

#include "base/registry.h"

#include <string.h>

#define SHEET(solver)                                                                              \
    SCENE("'duration': 1, 'solver': {'type': '" solver "'}",                                       \
          GRID_SHEET("", "1, 1", "5, 5", "'area_density': 0.2", SPRINGS("1000")), "")

static void test_names(void **state) {
    (void)state;
    char names[256] = "";
    for (const pdyn_global_solver *const *s = registry_builtin.solvers; *s; s++)
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", *names ? " " : "",
                 (*s)->name);
    assert_string_equal(pdyn_solvers(), names);
}

/* "auto" finds a solver in every build. */
static void test_auto(void **state) {
    (void)state;
    pdyn_sim *sim = test_open(SHEET("auto"));
    test_step(sim);
    assert_non_null(strstr(pdyn_solvers(), pdyn_solver_type(sim)));
    test_close(sim);
}

static void ignore(void *user, const char *text) { (void)user, (void)text; }

static void assert_refused(pdyn_context *context, pdyn_status status, const char *message) {
    assert_int_equal(status, PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), message);
}

static void test_left_out(void **state) {
    (void)state;
    if (!test_lacks_solver("cholesky")) skip();
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = NULL;
    assert_refused(context,
                   pdyn_load_text(context, quoted(SHEET("cholesky")), "test", NULL, 0, &sim),
                   "test:1:36: solver.type: this build has no solver \"cholesky\" (built without "
                   "CHOLMOD)");
    assert_null(sim);
    assert_refused(context, pdyn_describe(context, "cholesky", ignore, NULL),
                   "this build has no solver \"cholesky\" (built without CHOLMOD)");
    pdyn_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_auto),
        cmocka_unit_test(test_left_out),
    };
    return cmocka_run_group_tests_name("built solvers", tests, NULL, NULL);
}
