/* examples/memory.c makes the scene scenes/water_on_cloth.json: it prints the same hash of the
 * state after a step. Argument: the program. */
#include "support.h"

static const char *program;

static void test_hash(void **state) {
    (void)state;
    char path[1024], found[32] = "", expected[32];
    pdyn_context *context = test_context(0);
    pdyn_sim *sim = NULL;
    snprintf(path, sizeof path, "%s/scenes/water_on_cloth.json", getenv("PROJDYN_SOURCE_ROOT"));
    if (pdyn_load(context, path, NULL, 0, &sim) != PDYN_OK)
        fail_msg("%s", pdyn_last_error(context));
    test_step(sim);
    snprintf(expected, sizeof expected, "%016llx\n", (unsigned long long)pdyn_state_hash(sim));
    test_close(sim);
    snprintf(path, sizeof path, "'%s' 1", program);
    FILE *output = popen(path, "r");
    assert_non_null(output);
    assert_non_null(fgets(found, sizeof found, output));
    assert_int_equal(pclose(output), 0);
    assert_string_equal(found, expected);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hash)};
    program = argc > 1 ? argv[1] : "";
    return cmocka_run_group_tests_name("memory_example", tests, NULL, NULL);
}
