/* The version macros of projdyn.h against the version of the build (PROJDYN_VERSION, meson.build).
 */
#include "support.h"

static void test_macros(void **state) {
    (void)state;
    char macros[64];
    snprintf(macros, sizeof macros, "%d.%d.%d", PDYN_VERSION_MAJOR, PDYN_VERSION_MINOR,
             PDYN_VERSION_PATCH);
    assert_string_equal(macros, PROJDYN_VERSION);
    assert_string_equal(macros, pdyn_version());
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_macros)};
    return cmocka_run_group_tests_name("version", tests, NULL, NULL);
}
